// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies too light for the steps to follow how they vibrate on taut spans.

#include "sim/solve/light_bodies.h"

#include "sim/parts.h"
#include "sim/solve/forces.h"
#include "sim/solve/part_system.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// 1 kg at the middle of a hanging line of 2 m with `ratio` kg at its end, `aside` m out of line.
Scene weighted_line(double ratio, double aside) {
  Scene scene;
  scene.bodies.push_back(body("light", BodyKind::free, aside, -1.0, 0.1, 1.0));
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.0, -2.0, 0.2, ratio));
  scene.cables.push_back(cable(at(0.0, 0.0), {}, on(0)));
  scene.cables.push_back(cable(on(0), {}, on(1)));
  scene.cables[1].name = "lower";
  return scene;
}

TEST(LightBodies, StayOnTheirLineWhateverItCarries) {
  for (int power = 0; power <= 9; ++power) {
    Scene scene = weighted_line(std::pow(10.0, power), 1e-3);
    for (Body& b : scene.bodies) b.linear_drag = 4.0;
    World world = make_world(scene, measured());
    for (int i = 0; i < 240 * 5; ++i) {
      run(scene, world, 1);
      ASSERT_LT(std::abs(world.position[0].x()), 2e-3) << "ratio 1e" << power << ", step " << i;
      ASSERT_LT(world.diagnostics.largest_stretch, 1e-4) << "ratio 1e" << power << ", step " << i;
    }
    EXPECT_LT(world.velocity[0].norm(), 1e-3) << power;
  }
}

// The damping is against the line's own motion: a light body rides along with a swinging line.
TEST(LightBodies, RideWithAMovingLine) {
  for (const double ratio : {1e4, 1e6}) {
    Scene scene = weighted_line(ratio, 0.0);
    scene.bodies[0].position = {1.0 * std::sin(1.0), -std::cos(1.0)};
    scene.bodies[1].position = {2.0 * std::sin(1.0), -2.0 * std::cos(1.0)};
    World world = make_world(scene, measured());
    for (int i = 0; i < 240 * 5; ++i) {
      run(scene, world, 1);
      const Vec2 middle = 0.5 * world.position[1];
      ASSERT_LT((world.position[0] - middle).norm(), 2e-3) << ratio << ", step " << i;
    }
  }
}

// The line ends where the heavy body holds it: on its rim, which turns with it as it swings.
TEST(LightBodies, RideWithALineThatIsHeldAtARim) {
  Scene scene = weighted_line(1e6, 0.0);
  const Vec2 along(std::sin(0.7), -std::cos(0.7));
  scene.bodies[0].position = along;
  scene.bodies[1].position = 2.2 * along;
  scene.cables[1].end.point = -0.2 * along;
  World world = make_world(scene, measured());
  Workspace work;
  double start = 0.0;
  for (int i = 0; i < 240 * 5; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (i == 0) start = world.diagnostics.energy;
    const double swing = 1e6 * g * 2.2 * (1.0 - std::cos(0.7));  // J
    ASSERT_LT(std::abs(world.diagnostics.energy - start), 2e-3 * swing) << i;
  }
}

TEST(LightBodies, NothingChangesWhereStepsCanFollow) {
  const Scene scene = weighted_line(100.0, 0.05);
  World world = make_world(scene, measured());
  Workspace work;
  for (int i = 0; i < 240; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    const Mobility& light = work.systems[0].mobility[0];
    ASSERT_EQ(light.xx, 1.0);
    ASSERT_EQ(light.xy, 0.0);
    ASSERT_EQ(light.yy, 1.0);
  }
}

// A bead on a rail across a taut line: only the rail's direction is open to it.
TEST(LightBodies, OnARailAcrossTheLine) {
  Scene scene = weighted_line(1e6, 1e-3);
  scene.bodies[0].kind = BodyKind::rail;
  scene.bodies[0].rail_axis = Vec2(1.0, 0.0);
  scene.bodies[1].kind = BodyKind::rail;
  World world = make_world(scene, measured());
  run(scene, world, 1200);
  EXPECT_LT(std::abs(world.position[0].x()), 2e-3);
}

// Beside a body that carries a rope, of which moving and turning are one: what a light body has
// gained is its own, whatever impulses cancel there. Of 1e15 N s round-off was far more.
TEST(LightBodies, GainIsToldBesideARopeWhateverImpulsesCancel) {
  Scene scene;
  scene.bodies = {body("light", BodyKind::free, 0.0, 0.0, 0.1, 0.2),
                  body("drum", BodyKind::free, 1.0, 0.0, 0.3, 6.0)};
  const World world = make_world(scene, Method::pinch);
  Parts parts;
  parts.bodies = {0, 1};
  Part part;
  part.bodies_end = 2;
  PartSystem s;
  s.mobility = {mobility_of(world.bodies[0], 1e-3), mobility_of(world.bodies[1], 1e-3), {}};
  s.mobility[1].xz = -0.02;
  s.span_masses.resize(3);
  s.span_masses[0].steadied = true;
  s.span_masses[0].own = s.mobility[0];
  s.mobility[0].yy *= 1e-12;
  s.free_velocity = s.velocity = {{0.1, 0.0, 0.2}, {2.0, -0.5, -7.0}, Eigen::Vector3d::Zero()};
  s.span_masses[0].velocity = {0.1, 0.0, 0.2};
  s.rows.resize(2);
  s.bodies.resize(2);
  s.responses.resize(2);
  for (const std::size_t r : {0, 1}) {
    s.rows[r].impulse = 1e15;
    s.bodies[r].a = 0;
    s.bodies[r].b = 1;
    s.bodies[r].ja = Eigen::Vector3d(r == 0 ? 1.0 : -1.0, 0.0, 0.0);
  }
  EXPECT_FALSE(gains_by_steadying(world, parts, part, s));
  s.velocity[0] = {290.0, 30.0, -1000.0};
  EXPECT_TRUE(gains_by_steadying(world, parts, part, s));
  s.velocity[0] = {0.05, 0.0, 0.2};
  EXPECT_FALSE(gains_by_steadying(world, parts, part, s));
  s.velocity[1].z() = -7.1;  // with the rope on it
  EXPECT_TRUE(gains_by_steadying(world, parts, part, s));
}

// A disc that lies on a straight taut rope, which its weight can hardly bend, rolls down it: along
// it nothing makes the disc heavier, whatever the rope weighs. With I for its inertia and R for the
// radius of the rope's centre line it falls by a t^2 / 2, a = g sin(slope) / (1 + I / (m R^2)).
TEST(LightBodies, RollDownATautRopeAsDownASlope) {
  const double r = 0.3, w = build::cable_half_width, m = 0.2, slope = 0.1, seconds = 0.5;
  const Vec2 down(std::cos(slope), -std::sin(slope));
  for (const double mass_per_metre : {0.0, 0.5}) {
    Scene scene;
    const Vec2 centre = (r + w) * Vec2(-down.y(), down.x());
    scene.bodies.push_back(body("disc", BodyKind::free, centre.x(), centre.y(), r, m));
    const Vec2 top = -1.0 * down, bottom = 2.0 * down;
    scene.cables.push_back(cable(at(top.x(), top.y()), {{0, 1, 0}}, at(bottom.x(), bottom.y())));
    scene.cables[0].mass_per_metre = mass_per_metre;
    const double R = r + w,
                 a = g * std::sin(slope) / (1.0 + inertia_of(scene.bodies[0]) / (m * R * R));
    for (const int n : {1, 4, 16}) {
      const World world = after(scene, n, seconds);
      EXPECT_NEAR((world.position[0] - centre).dot(down), 0.5 * a * seconds * seconds, 1e-5)
          << mass_per_metre << ", " << n;
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
