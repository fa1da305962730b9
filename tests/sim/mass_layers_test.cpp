// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass on drums that fill in layers.

#include <algorithm>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/make_world.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// The load below the drum; or swinging beside it, free or on its rail.
enum class Load { below, swinging, beside };

Scene heavy_hoist(bool begins_there, Load load, int steps) {
  Scene scene = build::heavy_hoist(steps, begins_there);
  if (load == Load::swinging) return scene;
  Body& hung = scene.bodies[1];
  hung.kind = BodyKind::rail;
  hung.mass = 2.0;
  hung.position = load == Load::below ? Vec2(0.3, -8.0) : Vec2(3.0, -3.0);
  return scene;
}

// Mass, first and second moment of z = left(x), and weight, against sums over thin slices of the
// spiral.
TEST(MassLayers, MomentsAreThoseOfTheSpiral) {
  for (const bool begins_there : {true, false}) {
    for (const int way_round : {1, -1}) {
      Scene scene = heavy_hoist(begins_there, Load::swinging, 4);
      scene.cables[0].wraps[0].orientation *= way_round;
      scene.bodies[0].position = {0.4, -0.7};
      const World world = make_world(scene, Method::pinch);
      const CableState& cable = world.cables[0];
      const Link& drum = cable.links[1];
      ASSERT_GT(drum.wrap, 12.0 * std::numbers::pi);
      const Segment& span = cable.segments[begins_there ? 2 : 1];
      const double rho = scene.cables[0].mass_per_metre;
      const double leaves = begins_there ? span.alpha : alpha_head(cable, 0);
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      double weight = 0.0;  // J
      constexpr int count = 200000;
      const double slice = drum.wrap / count;
      for (int i = 0; i < count; ++i) {
        const double turned = (i + 0.5) * slice, r = drum.layers.radius(turned);
        const double back = drum.layers.way * drum.orientation * (drum.wrap - turned);
        const Vec2 e(-std::sin(leaves - back), std::cos(leaves - back));
        const Vec2 z = drum.orientation * r * e, x = -left(z);
        const double mass = rho * r * slice;
        add_moments(sum, mass, mass * z, mass * z.squaredNorm());
        weight += mass * g * (scene.bodies[0].position + x).y();
      }
      const double end = 0.5 * rho * span.length;
      const Vec2 x = (begins_there ? span.tail : span.head) - scene.bodies[0].position;
      add_moments(sum, end, end * left(x), end * x.squaredNorm());
      weight += end * g * (span.tail + span.head).y();
      std::vector<Eigen::Matrix3d> carried;
      std::vector<Sleeve> sleeves;
      find_carried(world, carried, sleeves);
      EXPECT_LT((carried[0] - sum).cwiseAbs().maxCoeff(), 1e-8 * sum.maxCoeff());
      EXPECT_NEAR(potential_energy(world, cable, scene.gravity), weight, 1e-8 * std::abs(weight));
    }
  }
}

// With the moments above this is the motion: below and beside the drum it has one way to go.
TEST(MassLayers, EnergyIsKeptAndTheOrderIsTwo) {
  for (const bool begins_there : {true, false}) {
    for (const Load load : {Load::below, Load::swinging, Load::beside}) {
      std::vector<Vec2> ends;
      for (int n = 1; n <= 32; n *= 2) {
        const Scene scene = heavy_hoist(begins_there, load, n);
        World world = make_world(scene, measured());
        const double drift = energy_drift(scene, world, 60 * n, [&world] {
          ASSERT_LT(world.diagnostics.cable_length_error, 1e-12);
        });
        EXPECT_LT(world.cables[0].links[1].wrap, 16.2 * std::numbers::pi);  // some has come off
        EXPECT_LT(drift, 0.03 / (n * n));  // of 28 to 240 J that were at play
        ends.push_back(world.position[1]);
        if (ends.size() < 3) continue;
        const double now = (ends[ends.size() - 1] - ends[ends.size() - 2]).norm();
        const double before = (ends[ends.size() - 2] - ends[ends.size() - 3]).norm();
        EXPECT_GT(std::log2(before / now), 1.9) << n;
      }
    }
  }
}

// A drum that nothing holds unwinds in free flight: its momenta are the world's alone.
TEST(MassLayers, MomentumIsKeptInFreeFlight) {
  for (const bool begins_there : {true, false}) {
    Vec2 error = Vec2::Constant(infinity);
    for (const int steps : {4, 16, 64}) {
      Scene scene = heavy_hoist(begins_there, Load::swinging, steps);
      scene.gravity = Vec2::Zero();
      scene.bodies[0].kind = BodyKind::free;
      scene.bodies[0].angular_velocity = begins_there ? -6.0 : 6.0;
      World world = make_world(scene, Method::pinch);
      Workspace work, beside;
      Vec2 most = Vec2::Zero();
      Eigen::Vector3d first = Eigen::Vector3d::Zero();
      for (int i = 0; i < 40 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
        const Velocities now = velocities_now(scene, world, beside);
        std::vector<Eigen::Matrix3d> carried;
        std::vector<Sleeve> sleeves;
        find_carried(world, carried, sleeves);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (std::size_t b = 0; b < 2; ++b) {
          Eigen::Matrix3d all = carried[b];
          const BodyProperties& own = world.bodies[b];
          add_moments(all, own.mass, Vec2::Zero(), inertia_of(own));
          const Eigen::Vector3d p =
              all * Eigen::Vector3d(now.linear[b].x(), now.linear[b].y(), now.angular[b]);
          sum += p;
          sum.z() += cross(world.position[b], p.head<2>());
        }
        if (i == 0) first = sum;
        most = most.cwiseMax(Vec2((sum - first).head<2>().norm(), std::abs(sum.z() - first.z())));
      }
      EXPECT_GT(first.z() * world.angular_velocity[0], 0.0);
      EXPECT_GT(error.x() / most.x(), 12.0) << steps;
      EXPECT_GT(error.y() / most.y(), 12.0) << steps;
      error = most;
    }
    EXPECT_LT(error.x(), 1e-4);
    EXPECT_LT(error.y(), 1e-4);
  }
}

TEST(RandomMassLayers, StayFiniteAndMakeNoEnergy) {
  EXPECT_GT(run_heavy_ropes(braked_rope, 200), seeds_of(350));
}

TEST(RandomMassLayers, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < seeds_of(40U); ++seed) {
    EXPECT_TRUE(is_all_state(braked_rope(seed), Method::pinch, 150)) << seed;
  }
}

}  // namespace
}  // namespace pinchlab::testing
