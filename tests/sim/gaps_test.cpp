// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps between bodies, with a cable between them or none: the least scenes of what made them fall
// short in random ones.

#include "demos/scenes/shape_scenes.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/touch.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

// A disc touches a box with its centre: whether the box is over a span that leaves the disc is a
// matter of the box's nearest place, not of that centre.
TEST(Gaps, ABoxOverTheSpanThatLeavesAPulleyKeepsTheCablesWidth) {
  Scene scene;
  scene.bodies.push_back(body("pulley", BodyKind::fixed, 0.0, 0.0, 0.4));
  scene.bodies.push_back(body("other", BodyKind::fixed, 2.0, 0.0, 0.4));
  for (const double turn :
       {-0.03, -0.02, -0.01, 0.1}) {  // the box faces the pulley over the span, or the arc
    Body box = body("box", BodyKind::free, 0.0, 0.0, 0.3, 1.0);
    make_polygon(box, {{-0.01, -0.1}, {0.01, -0.1}, {0.01, 0.1}, {-0.01, 0.1}}, 0.0);
    const double gap = 0.081;
    box.position = (0.4 + gap + 0.1) * Vec2(-std::sin(turn), std::cos(turn));
    box.angle = turn;
    Scene with = scene;
    with.bodies.push_back(box);
    with.cables.push_back(cable(at(-0.8, -1.5), {{0, -1, 0}, {1, -1, 0}}, at(2.8, -1.5), 0.04));
    const World world = make_world(with, Method::pinch);
    int found = 0;
    for (const Contact& contact : world.contacts) {
      if (contact.a != 0 || contact.b != 2 || contact.gap > gap + 1e-9) continue;
      EXPECT_EQ(contact.touch, Touch::point_of_a);
      EXPECT_NEAR(contact.gap, gap, 1e-12);
      EXPECT_EQ(contact.target, 0.08) << turn;
      ++found;
    }
    EXPECT_EQ(found, 1) << turn;
  }
}

TEST(Gaps, AContactThatIsMeasuredAnewIsWhereItsBodiesAre) {
  Scene scene;
  scene.bodies.push_back(body("disc", BodyKind::free, 0.0, 0.0, 0.2));
  scene.bodies.push_back(body("other", BodyKind::free, 0.401, 0.0, 0.2));
  Body box = body("box", BodyKind::free, 0.0, 0.351, 0.3, 1.0);
  make_polygon(box, {{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.1}, {-0.2, 0.1}}, 0.05);
  scene.bodies.push_back(box);
  World world = make_world(scene, Method::pinch);
  world.position[0] = {0.02, 0.003};
  int measured = 0;
  for (Contact contact : world.contacts) {
    if (contact.a != 0) continue;
    measure(world, contact);
    const bool discs = contact.b == 1;
    const double gap = discs ? std::hypot(0.381, 0.003) - 0.4 : 0.351 - 0.003 - 0.1 - 0.05 - 0.2;
    const Vec2 normal = discs ? Vec2(0.381, -0.003).normalized() : Vec2(0.0, 1.0);
    if (!discs && contact.touch != Touch::point_of_a) continue;
    EXPECT_NEAR(contact.gap, gap, 1e-15);
    EXPECT_LE((contact.normal - normal).norm(), 1e-15);
    ++measured;
  }
  EXPECT_EQ(measured, 2);
}

// Contacts are found for the speeds that bodies have. An impact that makes one faster finds them
// anew.
TEST(Gaps, ABodyThatIsStruckWithinTheStepMeetsTheNext) {
  Scene scene;
  scene.gravity = Vec2::Zero();
  scene.bodies.push_back(body("heavy", BodyKind::free, -1.0, 0.0, 0.2, 100.0));
  scene.bodies.push_back(body("light", BodyKind::free, 0.0, 0.0, 0.1, 0.01));
  scene.bodies.push_back(body("fixed", BodyKind::fixed, 0.6, 0.0, 0.2));
  scene.bodies[0].velocity = {30.0, 0.0};
  scene.bodies[0].restitution = 1.0;
  for (const int steps : {1, 2, 4}) {
    scene.steps_per_frame = steps;
    World world = make_world(scene, Method::pinch);
    Workspace work;
    for (int i = 0; i < 2 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      EXPECT_LE(world.position[1].x(), 0.3 + 1e-9) << steps;
    }
  }
}

// A box stands with a corner on a cable that lies along the top of another and round its corner,
// turns flat, and tips over that corner. It presses the cable there from the moment on at which it
// is flat; until then the corner only comes nearer.
TEST(Gaps, ABoxThatTurnsFlatOnACablePressesItAtTheCornerToo) {
  Scene scene;
  scene.bodies.push_back(body("base", BodyKind::fixed, 0.0, 0.0, 1.0));
  make_polygon(scene.bodies[0], build::box_corners(2.0, 0.4), 0.0);
  scene.bodies.push_back(body("box", BodyKind::free, 0.0, 0.0, 1.0));
  make_polygon(scene.bodies[1], build::box_corners(1.2, 0.5), 0.0);
  scene.cables.push_back(cable(at(-3.0, -0.5), {{0, -1, 0}}, at(3.0, -2.0), 0.05));
  for (int k = 0; k < 20; ++k) {
    const double angle = 0.1 + 0.002 * k;
    Body& box = scene.bodies[1];
    const Vec2 corner(0.6, 0.3), arm = turned(Vec2(0.6, 0.25), angle);
    box.angle = angle;
    box.position = corner + arm;
    box.angular_velocity = -1.1;
    box.velocity = box.angular_velocity * left(arm);
    for (const int steps : {1, 4, 16}) {
      scene.steps_per_frame = steps;
      World world = make_world(scene, Method::pinch);
      Workspace work;
      for (int i = 0; i < 10 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok);
        for (const Contact& contact : world.contacts) {
          EXPECT_GE(contact.gap, 0.1 - 1e-9) << angle << " " << steps << " " << i;
        }
      }
      EXPECT_LT(world.angle[1], -0.1);
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
