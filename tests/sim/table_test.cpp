// SPDX-License-Identifier: GPL-3.0-or-later
// What stands on a cable that lies flush along a table, and goes along with it.

#include "demos/scenes/shape_scenes.h"
#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double w = 0.02;  // m, the cable's half width

/// A smooth table; a cable from a cart, body 1, along its top and over its edge to a weight of 2
/// kg, body 2.
Scene table(int steps) {
  Scene scene;
  scene.steps_per_frame = steps;
  scene.bodies.push_back(body("table", BodyKind::fixed, 0.0, -0.2, 1.0));
  make_polygon(scene.bodies[0], build::box_corners(1.0, 0.4), 0.0);
  scene.bodies[0].cable_friction = 0.0;
  scene.bodies.push_back(body("cart", BodyKind::rail, -2.0, w, 0.1, 1.0));
  scene.bodies[1].rail_axis = {1.0, 0.0};
  scene.bodies.push_back(body("weight", BodyKind::rail, 0.5 + w, -1.0, 0.1, 2.0));
  scene.cables.push_back(cable(on(1), {{0, -1, 0}}, on(2), w));
  return scene;
}

/// A box of 5 kg on the cable, body 3, which it does not slip on.
void add_box(Scene& scene) {
  scene.bodies.push_back(body("box", BodyKind::free, -0.2, 2.0 * w + 0.1, 0.1, 5.0));
  make_polygon(scene.bodies[3], build::box_corners(0.3, 0.2), 0.0);
}

void move(Scene& scene, const Vec2& by) {
  for (Body& one : scene.bodies) one.position += by;
}

// It presses the span that lies along the table's side, next to the corner that it goes over: the
// cable takes it along. It was kept off the table by the cable's width, and stood still.
TEST(Table, ARollerOnACableThatLiesFlushRollsOnIt) {
  constexpr double mass = 5.0, r = 0.2;
  const double inertia = 0.5 * mass * r * r;
  for (const Vec2& place : {Vec2(0.0, 0.0), Vec2(3.0, 5.0)}) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = table(steps);
      scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 2.0 * w + r, r, mass));
      move(scene, place);
      World world = make_world(scene, Method::pinch);
      run(scene, world, 30 * steps);
      // 1 kg, 2 kg and the roller, whose face has the speed of the cable's centre line.
      const double faster = 2.0 * g / (3.0 + inertia / ((r + w) * (r + w)));
      const double way = 0.5 * faster * 0.25;
      EXPECT_NEAR(world.position[1].x(), place.x() - 2.0 + way, 1e-9) << steps;
      EXPECT_NEAR(world.angle[3], way / (r + w), 1e-8) << steps;
    }
  }
}

TEST(Table, ABoxOnACableThatLiesFlushRidesOnIt) {
  for (const int steps : {1, 4, 16}) {
    Scene scene = table(steps);
    add_box(scene);
    World world = make_world(scene, Method::pinch);
    run(scene, world, 30 * steps);
    const double way = 0.5 * 2.0 * g / 8.0 * 0.25;
    EXPECT_NEAR(world.position[3].x(), -0.2 + way, 1e-9) << steps;
    EXPECT_NEAR(world.angle[3], 0.0, 1e-9) << steps;
  }
}

// A cart that goes ahead at 0.2 m/s makes the cable behind the box slack until the box has come up
// with it, at t = 0.4 / 2.8 s; the box is jerked on to its front corner and rattles, and what it
// loses along the cable the cart and the weight have. Solves went round there, between a cable that
// the box pushes and one that it does not hold, and ended with one that sticks to the smooth table:
// three quarters of the momentum were gone.
TEST(Table, ABoxThatACatchJerksKeepsItsMomentumAlongTheCable) {
  for (const double restitution : {0.0, 0.5}) {
    for (const int steps : {1, 4, 16, 64}) {
      Scene scene = table(steps);
      add_box(scene);
      scene.bodies[1].velocity = {0.2, 0.0};
      scene.bodies[3].restitution = restitution;
      World world = make_world(scene, Method::pinch);
      run(scene, world, 15 * steps);
      const double before = 2.0 * g / 7.0, after = 2.0 * g / 8.0, caught = 0.4 / before;
      const double speed = (7.0 * before * caught + 0.2) / 8.0, left = 0.25 - caught;
      const double way = 0.2 * caught + speed * left + 0.5 * after * left * left;
      EXPECT_NEAR(world.position[3].x(), -0.2 + way, 1e-3) << steps << ", " << restitution;
      EXPECT_NEAR(world.position[1].x(), -2.0 + way, 1e-3) << steps << ", " << restitution;
      EXPECT_EQ(world.diagnostics.fallbacks, 0) << steps << ", " << restitution;
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
