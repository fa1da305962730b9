// SPDX-License-Identifier: GPL-3.0-or-later
// The methods that can be compared: what the thesis describes against our own choices.

#include <stdexcept>

#include "demos/scenes/library.h"
#include "tests/sim/random_scene.h"

namespace pinchlab::testing {
namespace {

constexpr double w = 0.05, R = 0.5 + w;

struct Elements {
  int joints = 0, segments = 0, contacts = 0, middles = 0, transitional = 0;
  bool operator==(const Elements&) const = default;
};

void PrintTo(const Elements& e, std::ostream* out) {
  *out << fmt::format("joints {}, segments {}, contacts {}, non-transitional {}, transitional {}",
                      e.joints, e.segments, e.contacts, e.middles, e.transitional);
}

Elements count_elements(const World& world) {
  Elements e;
  const CableState& c = world.cables[0];
  for (std::size_t i = 0; i < c.links.size(); ++i) {
    ++e.joints;
    if (c.links[i].pinch_middle) ++e.middles;
    if (i == 0) continue;
    ++e.segments;
    const bool at_middle = c.links[i].pinch_middle || c.links[i - 1].pinch_middle;
    if (c.segments[i].pinched && !at_middle) ++e.transitional;
  }
  for (const Contact& contact : world.contacts) {
    if (contact.cable_between >= 0) ++e.contacts;
  }
  return e;
}

TEST(Methods, StressScenesHaveTheElementsOfTheThesis) {
  for (const int n : {1, 2, 5, 10, 20}) {
    for (const Configuration& configuration :
         {Configuration(Method::pinch), thesis_configuration()}) {
      const Scene pinched = slack_stress_scene(n, pinched_spacing);
      const Scene apart = slack_stress_scene(n, free_spacing);
      World world = make_world(pinched, configuration);
      const Elements table_5_1{12 * n - 2, 12 * n - 3, 4 * n - 1, 4 * n - 2, 2 * n};
      EXPECT_EQ(count_elements(world), table_5_1) << to_string(configuration) << ' ' << n;
      run(pinched, world, 60);
      EXPECT_EQ(count_elements(world), table_5_1) << to_string(configuration) << ' ' << n;
      World free = make_world(apart, configuration);
      run(apart, free, 60);
      EXPECT_EQ(count_elements(free), (Elements{4 * n + 2, 4 * n + 1, 0, 0, 0})) << n;
    }
  }
}

TEST(Methods, AllPairsFindWhatTheSweepFinds) {
  for (int seed = 1; seed <= seeds_of(30); ++seed) {
    const Scene scene = random_scene(seed);
    for (const Method method : {Method::pinch, Method::cable}) {
      Configuration all = method;
      all.detection = Detection::all_pairs;
      World first = make_world(scene, method), second = make_world(scene, all);
      for (int i = 0; i < 480; ++i) {
        run(scene, first, 1);
        run(scene, second, 1);
        ASSERT_EQ(first.position, second.position) << seed << ": step " << i;
        ASSERT_EQ(first.angle, second.angle) << seed << ": step " << i;
      }
    }
  }
}

double velocity_error(const World& world, const World& exact) {
  double error = 0.0;
  for (std::size_t b = 0; b < world.velocity.size(); ++b) {
    error = std::max({error, (world.velocity[b] - exact.velocity[b]).norm(),
                      std::abs(world.angular_velocity[b] - exact.angular_velocity[b])});
  }
  return error;
}

/// Error of the first step, in which nothing is violated that the thesis' gains would steer.
double first_step_error(const Scene& scene, PinchRows rows, int iterations) {
  Configuration configuration;
  configuration.pinch_rows = rows;
  World exact = make_world(scene, configuration);
  configuration.solver = Solver::iterative;
  configuration.iterations = iterations;
  World world = make_world(scene, configuration);
  run(scene, exact, 1);
  run(scene, world, 1);
  return velocity_error(world, exact);
}

/// A roller of 2 kg that lies on the cable over a drum, two loads on the cable's ends.
Scene pinched_drum(double friction, double left_mass, double right_mass) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.5, 5.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, 0.85, 0.25, 2.0));
  scene.bodies.push_back(body("left", BodyKind::free, -R, -2.0, 0.2, left_mass));
  scene.bodies.push_back(body("right", BodyKind::free, R, -2.0, 0.2, right_mass));
  scene.bodies[0].cable_friction = scene.bodies[1].cable_friction = friction;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3)));
  return scene;
}

TEST(Methods, SweepsConvergeToTheDirectSolution) {
  for (const PinchRows rows : {PinchRows::one, PinchRows::three}) {
    for (const Scene& scene : {load_chain(3, 3.0, 2.0, 1.0), load_chain(1, 3.0, 2.0, 1.0, 0.05),
                               pinched_drum(infinity, 1.0, 1.5), pinched_drum(0.05, 1.0, 3.0)}) {
      double error = first_step_error(scene, rows, 10);
      EXPECT_GT(error, 1e-12);
      double factor = 0.5;  // geometric: each doubling squares it
      for (const int iterations : {20, 40, 80}) {
        const double next = first_step_error(scene, rows, iterations);
        EXPECT_LT(next, std::max(factor * error, 1e-12)) << to_string(rows) << ' ' << iterations;
        error = next;
        factor *= factor;
      }
      EXPECT_LT(first_step_error(scene, rows, 1000), 1e-11) << to_string(rows);
    }
  }
}

TEST(Methods, ThesisHoldsALoadAndAPinchedRoller) {
  Configuration thesis = thesis_configuration();
  thesis.diagnostics = true;
  const Scene scene = pinched_drum(infinity, 1.0, 1.0);
  World world = make_world(scene, thesis);
  for (int i = 0; i < 240 * 5; ++i) {
    run(scene, world, 1);
    ASSERT_LT(world.diagnostics.largest_stretch, 1e-3) << i;
    ASSERT_LT(world.diagnostics.largest_gap_violation, 1e-4) << i;
    ASSERT_LT(world.diagnostics.cable_length_error, 1e-12) << i;
  }
  ASSERT_EQ(world.cables[0].links.size(), 5u);  // the pinch stays
  EXPECT_NEAR(world.cables[0].segments[1].tension, g, 1e-3 * g);
  EXPECT_NEAR(world.contacts[0].normal_force, 2.0 * g, 1e-3 * 2.0 * g);
  for (const Vec2& v : world.velocity) EXPECT_LT(v.norm(), 1e-3);
}

TEST(Methods, IterativeSlidingObeysTheCapstanLaw) {
  constexpr double mu = 0.2;
  Scene scene = load_chain(1, 3.0, 1.0, 1.0, mu);
  scene.bodies[2].kind = BodyKind::fixed;
  Configuration iterative;
  iterative.solver = Solver::iterative;
  iterative.iterations = 50;
  World world = make_world(scene, iterative);
  run(scene, world, 60);
  const double ratio = std::exp(mu * std::numbers::pi);
  const auto& segments = world.cables[0].segments;
  EXPECT_NEAR(segments[1].tension / segments[2].tension, ratio, 1e-6 * ratio);
  // Both loads share |a| where 3 (g - a) = ratio (g + a).
  const double a = g * (3.0 - ratio) / (3.0 + ratio), t = world.time();
  EXPECT_NEAR(scene.bodies[0].position.y() - world.position[0].y(), 0.5 * a * t * t, 1e-4 * a);
  EXPECT_NEAR(world.position[1].y() - scene.bodies[1].position.y(), 0.5 * a * t * t, 1e-4 * a);
}

// Plain cable joints let pulleys sink into each other as far as the cable between them is long,
// backwards: the upper one comes to rest there, and is neither let through nor thrown off.
TEST(Methods, PlainCableHoldsAPulleyByTheLengthOfItsOverlap) {
  Scene scene;
  scene.bodies.push_back(body("low", BodyKind::fixed_axle, 0.0, 0.0, 0.3, 1.0));
  scene.bodies.push_back(body("high", BodyKind::rail, 0.0, 0.72, 0.3, 1.0));
  scene.cables.push_back(cable(at(-1.0, -1.0), {{0, -1, 0}, {1, 1, 0}}, at(1.5, 2.0), 0.05));
  scene.cables[0].slack = 0.05;
  scene.steps_per_frame = 4;
  World world = make_world(scene, Method::cable);
  run(scene, world, 480);
  EXPECT_NEAR(world.position[1].y(), 0.694431148, 1e-8);
  EXPECT_NEAR(world.cables[0].segments[2].rest_length, 0.7 - world.position[1].y(), 1e-9);
}

/// Ten sweeps where no cable slides; where one does, enough to converge (sim/README.md).
TEST(Methods, SweepsMakeNoEnergy) {
  for (int seed = 1; seed <= seeds_of(60); ++seed) {
    Configuration thesis = thesis_configuration();
    thesis.diagnostics = true;
    if (seed % 3 != 0) thesis.iterations = 100;
    const Scene scene = random_scene(seed);
    World world = make_world(scene, thesis);
    run(scene, world, 1);
    const double start = world.diagnostics.energy;
    for (int i = 0; i < 960; ++i) {
      run(scene, world, 1);
      ASSERT_LT(world.diagnostics.energy, start + 0.05) << "seed " << seed << " step " << i;
      ASSERT_LT(world.diagnostics.cable_length_error, 1e-12) << i;
    }
  }
}

TEST(Methods, EveryCombinationStaysFinite) {
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    for (const Solver solver : {Solver::direct, Solver::iterative}) {
      for (const PinchRows rows : {PinchRows::one, PinchRows::three}) {
        Configuration configuration = method;
        configuration.solver = solver;
        configuration.pinch_rows = rows;
        for (const int seed : {3, 4, 6, 8}) {
          const Scene scene = random_scene(seed);
          World world = make_world(scene, configuration);
          run(scene, world, 480);
        }
      }
    }
  }
}

TEST(Methods, NamesAndChecks) {
  for (const char* name : {"pinch", "pinch_no_contact", "cable", "thesis"}) {
    ASSERT_TRUE(configuration_from_string(name)) << name;
    EXPECT_STREQ(to_string(*configuration_from_string(name)), name);
  }
  EXPECT_FALSE(configuration_from_string("baseline"));
  Configuration none = thesis_configuration();
  none.iterations = 0;
  EXPECT_THROW(make_world(load_chain(1, 1.0, 1.0, 1.0), none), std::invalid_argument);
}

}  // namespace
}  // namespace pinchlab::testing
