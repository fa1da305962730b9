// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that squeeze cables: gaps, rest, many bodies and cables, and the change between kinds of
// pinch.

#include <algorithm>

#include "sim/cable/cable.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double r = 0.5, w = 0.05, R = r + w;

double least_gap(const World& world, const Scene& scene, std::size_t a, std::size_t b) {
  return (world.position[b] - world.position[a]).norm() - scene.bodies[a].radius -
         scene.bodies[b].radius;
}

/// A drum with `count` rollers of 1 kg on a rail above it, falling from a little above one another.
/// With zig_zag the cable runs round all of them in turn; else it only lies over the drum.
Scene tower(int count, bool zig_zag, int cables = 1) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 10.0));
  for (int i = 0; i < count; ++i) {
    scene.bodies.push_back(body(fmt::format("roller {}", i), BodyKind::rail, 0.0,
                                r + 0.25 + 2.0 * w + 0.05 + i * (0.5 + 2.0 * w + 0.05), 0.25, 1.0));
  }
  for (int c = 0; c < cables; ++c) {
    if (zig_zag) {
      std::vector<Wrap> wraps{{0, -1, 0}};
      for (int i = 0; i < count; ++i) wraps.push_back({1 + i, i % 2 == 0 ? 1 : -1, 0});
      const double side = count % 2 == 1 ? -3.0 : 3.0;
      scene.bodies.push_back(body(fmt::format("weight {}", c), BodyKind::free, -R, -3.0, 0.2, 1.0));
      scene.cables.push_back(
          cable(on(static_cast<int>(scene.bodies.size()) - 1), wraps,
                at(side, scene.bodies[static_cast<std::size_t>(count)].position.y()), w));
    } else {
      scene.cables.push_back(cable(at(-1.0, -2.0), {{0, -1, 0}}, at(1.0, -2.0), w));
    }
    scene.cables.back().name = fmt::format("cable {}", c);
  }
  return scene;
}

/// A cable over body 0, a drum, with a load of its own on either side.
void add_loads(Scene& scene, int number, double left_mass, double right_mass) {
  const int left = static_cast<int>(scene.bodies.size());
  for (const double side : {-R, R}) {
    const double mass = side < 0.0 ? left_mass : right_mass;
    Body load =
        body(fmt::format("load {} {}", number, side), BodyKind::free, side, -2.0, 0.2, mass);
    load.outlined = false;  // the others' are in the same places
    scene.bodies.push_back(load);
  }
  scene.cables.push_back(cable(on(left), {{0, -1, 0}}, on(left + 1), w));
  scene.cables.back().name = fmt::format("cable {}", number);
}

class Stack : public ::testing::TestWithParam<int> {};

TEST_P(Stack, OfTenPinchingBodiesComesToRest) {
  Scene scene = tower(10, true);
  scene.steps_per_frame = GetParam();
  scene.bodies.back().linear_drag = scene.bodies.back().angular_drag = 5.0;
  World world = make_world(scene, measured());
  Workspace work;
  const int second = 60 * GetParam();
  for (int i = 0; i < 10 * second; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    ASSERT_LT(world.diagnostics.largest_gap_violation, 1e-6 * w) << "step " << i;
  }
  std::vector<Vec2> settled = world.position;
  const std::vector<double> turned = world.angle;
  run(scene, world, 10 * second);
  for (std::size_t b = 0; b <= 10; ++b) {
    EXPECT_LT(world.velocity[b].norm(), 1e-9);
    EXPECT_LT(std::abs(world.angular_velocity[b]), 1e-9);
    EXPECT_LT((world.position[b] - settled[b]).norm(), 1e-9);
    EXPECT_LT(std::abs(world.angle[b] - turned[b]), 1e-9);
    if (b > 0) {
      EXPECT_NEAR(least_gap(world, scene, b - 1, b), 2.0 * w, 1e-6 * w) << b;
    }
  }
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
}

INSTANTIATE_TEST_SUITE_P(StepsPerFrame, Stack, ::testing::Values(1, 2, 4, 8));

// Rollers that fall together have no speed between them until the lowest is stopped; then each
// meets the next within the same step or the one after.
TEST(Pinch, FallingTowerIsCaughtWithoutSqueezingAtOneStepAFrame) {
  for (const int frames_per_second : {15, 24, 60}) {
    Scene scene = tower(20, true);
    scene.frames_per_second = frames_per_second;
    scene.steps_per_frame = 1;
    World world = make_world(scene, measured());
    Workspace work;
    for (int i = 0; i < 2 * frames_per_second; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      for (std::size_t b = 1; b <= 20; ++b) {
        ASSERT_GT(least_gap(world, scene, b - 1, b), 2.0 * w * (1.0 - 1e-6)) << i << ", " << b;
      }
    }
  }
}

TEST(Pinch, TowerOnAWrapPressesWithItsWholeWeight) {
  Scene scene = tower(10, false);
  World world = make_world(scene, measured());
  run(scene, world, 240 * 4);
  ASSERT_EQ(world.contacts.size(), 10u);
  for (const Contact& contact : world.contacts) {
    EXPECT_NEAR(contact.normal_force, (10 - contact.a) * g, 1e-8);
    // Only the drum carries cable; the rollers above touch one another bare.
    EXPECT_NEAR(contact.gap, contact.a == 0 ? 2.0 * w : 0.0, 1e-12);
  }
}

// A roller that comes down pinches the cable from when it has come, not from a step before: until
// then cable may come off at its place, where there is no pinch to be left.
TEST(Pinch, IsMadeWhenItCloses) {
  for (const int steps : {1, 4}) {
    Scene scene = tower(1, false);
    scene.steps_per_frame = steps;
    scene.bodies[1].position.y() += 0.33;
    World world = make_world(scene, measured());
    Workspace work;
    int pinched = 0;
    for (int i = 0; i < 60 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      const std::vector<Link>& links = world.cables[0].links;
      const bool is = std::any_of(links.begin(), links.end(),
                                  [](const Link& link) { return link.pinch_middle; });
      if (!is) continue;
      ++pinched;
      ASSERT_LE(least_gap(world, scene, 0, 1), 2.0 * w * (1.0 + 5e-4)) << steps << ": " << i;
    }
    EXPECT_GT(pinched, 20 * steps);
  }
}

TEST(Pinch, NeverSqueezesTheCableWhileFalling) {
  for (const int steps_per_frame : {1, 2, 4}) {
    Scene scene = tower(1, false);
    scene.bodies[1].position.y() = 6.0;  // hits at 10 m/s
    scene.steps_per_frame = steps_per_frame;
    World world = make_world(scene, measured());
    Workspace work;
    for (int i = 0; i < 120 * steps_per_frame; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      ASSERT_GE(least_gap(world, scene, 0, 1), 2.0 * w - 1e-12);
    }
    EXPECT_NEAR(least_gap(world, scene, 0, 1), 2.0 * w, 1e-12);
  }
}

TEST(Pinch, WithoutContactBodiesSinkIntoTheCableButNotIntoEachOther) {
  Scene scene = tower(1, false);
  World world = make_world(scene, measured(Method::pinch_no_contact));
  run(scene, world, 480);
  EXPECT_NEAR(least_gap(world, scene, 0, 1), 0.0, 1e-12);
  EXPECT_EQ(world.cables[0].links.size(), 5u);
}

TEST(Pinch, PlainCableJointsDoNotSeeTheRoller) {
  Scene scene = tower(1, false);
  World world = make_world(scene, measured(Method::cable));
  run(scene, world, 480);
  EXPECT_NEAR(least_gap(world, scene, 0, 1), 0.0, 1e-12);
  EXPECT_EQ(world.cables[0].links.size(), 3u);
}

// A heavy roller that falls on a light one over a wrapped drum. The segments before and after the
// drum repeat one another, and the light roller's forces differ by one part in the mass ratio.
TEST(Pinch, HoldsWhateverMassLiesOnALightRoller) {
  for (const double mass : {1.0, 1e3, 1e6, 1e9}) {
    Scene scene = tower(2, false);
    scene.bodies[2].mass = mass;
    World world = make_world(scene, measured());
    for (int i = 0; i < 480; ++i) {
      run(scene, world, 1);
      ASSERT_LT(world.diagnostics.largest_gap_violation, 1e-6 * w) << mass << ", step " << i;
    }
    EXPECT_LT(world.velocity[1].norm(), 1e-6) << mass;
    EXPECT_EQ(world.diagnostics.fallbacks, 0) << mass;
  }
}

TEST(Pinch, SeveralCablesShareOneContact) {
  for (const int cables : {2, 5, 10}) {
    Scene scene = tower(1, false, cables);
    World world = make_world(scene, measured());
    run(scene, world, 480);
    ASSERT_EQ(world.contacts.size(), 1u);
    EXPECT_EQ(world.contacts[0].pinch_points, cables);
    EXPECT_NEAR(world.contacts[0].normal_force, g, 1e-9);
    EXPECT_NEAR(least_gap(world, scene, 0, 1), 2.0 * w, 1e-12);
    for (const CableState& c : world.cables) EXPECT_EQ(c.links.size(), 5u);
  }
}

// Of two cables between the same bodies the wider is pressed; what is narrower than the gap is not
// touched, and holds nothing: the roller turns by the centre line of the one, and the drum by all.
TEST(Pinch, AThinnerCableBesideThePressedOneIsFree) {
  for (const double thin : {0.0499, 0.03, 0.01}) {
    Scene scene = tower(1, false, 0);
    scene.bodies[1].position.y() = r + 0.25 + 2.0 * w;
    add_loads(scene, 0, 1.0, 1.5);
    add_loads(scene, 1, 1.0, 1.2);
    scene.cables[1].half_width = thin;
    const double narrow = r + thin;
    scene.bodies[4].position.x() = -narrow;
    scene.bodies[5].position.x() = narrow;
    const World world = after(scene, 4, 0.25);
    EXPECT_EQ(world.cables[0].links.size(), 5U);
    EXPECT_EQ(world.cables[1].links.size(), 3U) << thin;
    const double ratio = R / (0.25 + w);
    const double inertia = inertia_of(scene.bodies[0]) +
                           ratio * ratio * inertia_of(scene.bodies[1]) + R * R * 2.5 +
                           narrow * narrow * 2.2;
    const double faster = g * (R * 0.5 + narrow * 0.2) / inertia;
    EXPECT_NEAR(world.angle[0], -0.5 * faster * 0.25 * 0.25, 1e-9) << thin;
  }
}

TEST(Pinch, OnEveryTurnOfAWindingAtOnce) {
  Scene scene = tower(1, false);
  scene.cables[0].wraps[0].extra_turns = 9;
  World world = make_world(scene, measured());
  run(scene, world, 480);
  // The cable lies over the drum's crown ten times: ten middle links, eleven arcs.
  EXPECT_EQ(world.cables[0].links.size(), 2u + 11u + 10u);
  EXPECT_EQ(world.contacts[0].pinch_points, 10);
  EXPECT_NEAR(world.contacts[0].normal_force, g, 1e-9);
  EXPECT_LT(world.diagnostics.cable_length_error, 1e-12);
}

// A roller in the notch between two wrapped drums, pressing the slack cable on both: each contact
// bears m g / (2 cos(angle)).
TEST(Pinch, BodyRestingOnTwoWrappedBodies) {
  const double half = 0.7;
  Scene scene;
  scene.bodies.push_back(body("left", BodyKind::fixed_axle, -half, 0.0, r, 1.0));
  scene.bodies.push_back(body("right", BodyKind::fixed_axle, half, 0.0, r, 1.0));
  scene.bodies.push_back(body("roller", BodyKind::free, 0.0, 1.2, 0.4, 2.0));
  scene.cables.push_back(cable(at(-2.5, -2.0), {{0, -1, 0}, {1, -1, 0}}, at(2.5, -2.0)));
  scene.cables[0].slack = 0.6;
  World world = make_world(scene, measured());
  for (int i = 0; i < 240 * 5; ++i) {
    run(scene, world, 1);
    ASSERT_LT(world.diagnostics.largest_gap_violation, 1e-12) << i;
  }
  const double distance = r + 0.4 + 2.0 * w, height = std::sqrt(distance * distance - half * half);
  EXPECT_NEAR(world.position[2].y(), height, 1e-9);
  EXPECT_NEAR(world.position[2].x(), 0.0, 1e-9);
  EXPECT_LT(world.velocity[2].norm(), 1e-9);
  ASSERT_EQ(world.cables[0].links.size(), 5u) << "it lies on the span between the drums";
  int bearing = 0;
  for (const Contact& contact : world.contacts) {
    if (contact.b != 2) continue;
    ++bearing;
    EXPECT_NEAR(contact.normal_force, 2.0 * g / (2.0 * height / distance), 1e-6);
  }
  EXPECT_EQ(bearing, 2);
}

TEST(Pinch, MiddleLinkDoesNotChangeTheCable) {
  Scene scene = tower(1, false);
  World world = make_world(scene, measured());
  double before = 0.0;
  for (const Link& link : world.cables[0].links) before += link.radius * link.wrap;
  run(scene, world, 240);
  double after = 0.0;
  for (const Link& link : world.cables[0].links) after += link.radius * link.wrap;
  EXPECT_EQ(world.cables[0].links.size(), 5u);
  EXPECT_NEAR(before, after, 1e-12);
  EXPECT_NEAR(world.cables[0].segments[1].rest_length + world.cables[0].segments[4].rest_length,
              world.cables[0].segments[1].length + world.cables[0].segments[4].length, 1e-12);
}

// Rolling from a span over the wrap and off to the other span: ordinary link, transitional pinch,
// middle link, transitional pinch, ordinary link; and no cable is lost on the way.
TEST(Pinch, RollsOverAWrapThroughAllKindsOfPinch) {
  Scene scene;
  scene.steps_per_frame = 16;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, 0.33, 10.0));
  Body roller = body("roller", BodyKind::free, -1.7, 0.8, 0.164, 1.0);
  scene.bodies.push_back(roller);
  scene.cables.push_back(cable(at(-2.1, 0.95), {{1, 1, 0}, {0, -1, 0}}, at(2.0, -1.1)));
  World world = make_world(scene, measured());
  Workspace work;
  bool middle = false, before = false, behind = false;
  for (int i = 0; i < 60 * 16 * 2 && world.position[1].x() < 1.2; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    ASSERT_LT(world.diagnostics.largest_gap_violation, 1e-3 * w);
    ASSERT_LT(world.diagnostics.cable_length_error, 1e-12);
    const auto& links = world.cables[0].links;
    for (std::size_t k = 1; k + 1 < links.size(); ++k) {
      if (links[k].body != 1) continue;
      middle = middle || links[k].pinch_middle;
      before = before || (!links[k].pinch_middle && links[k + 1].body == 0);
      behind = behind || (!links[k].pinch_middle && links[k - 1].body == 0);
    }
  }
  EXPECT_TRUE(before);
  EXPECT_TRUE(middle);
  EXPECT_TRUE(behind);
  EXPECT_GT(world.position[1].x(), 1.0) << "the roller has crossed";
}

// Pinch friction is bounded by what presses: a driven roller drags slipping cables with mu N at
// most, each with as much of that as there are cables; not with all of it.
TEST(Pinch, DrivenRollerPullsWithItsFriction) {
  const double mu = 0.25, mass = 2.0;
  for (const int cables : {1, 2, 3}) {
    Scene scene;
    scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 5.0));
    scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, r + 0.25 + 2.0 * w, 0.25, mass));
    scene.bodies[0].cable_friction = 0.0;
    scene.bodies[1].cable_friction = mu;
    scene.bodies[1].driven_angular_velocity = -50.0;
    for (int c = 0; c < cables; ++c) add_loads(scene, c, 1.0, 1.0);
    World world = make_world(scene, measured());
    run(scene, world, 240);
    // The drum is frictionless, so the roller's mu N moves the loads alone: a = mu N / (2 m).
    // Driven clockwise, its lower side drags the cables to the left.
    const double a = mu * mass * g / (2.0 * cables);
    for (std::size_t c = 0; c < index(cables); ++c) {
      EXPECT_NEAR(-2.0 - world.position[2 + 2 * c].y(), 0.5 * a, 1e-10) << cables << ' ' << c;
    }
    EXPECT_NEAR(world.angle[0], 0.0, 1e-12);
  }
}

// Cables clamped between axles share the one row that turns the roller, each by the sign of its own
// direction: the drum accelerates the roller by I alpha / (r + w), half of it in either.
TEST(Clamp, CablesOfBothDirectionsShareWhatTurnsTheRoller) {
  constexpr double lever = 0.25 + w, drum_mass = 10.0, roller_mass = 2.0;
  for (const bool reversed : {false, true}) {
    Scene scene;
    scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, drum_mass));
    scene.bodies.push_back(
        body("roller", BodyKind::fixed_axle, 0.0, r + 0.25 + 2.0 * w, 0.25, roller_mass));
    add_loads(scene, 0, 1.0, 2.0);
    add_loads(scene, 1, 2.0, 3.0);
    if (reversed) std::swap(scene.cables[1].start, scene.cables[1].end);
    if (reversed) scene.cables[1].wraps[0].orientation = 1;
    World world = make_world(scene, measured());
    run(scene, world, 60);
    const double of_drum = 0.5 * drum_mass * r * r / (R * R);
    const double of_roller = 0.5 * roller_mass * 0.25 * 0.25 / (lever * lever);
    const double a = 2.0 * g / (8.0 + of_drum + of_roller), shared = 0.5 * of_roller * a;
    for (const std::size_t c : {0U, 1U}) {
      const CableState& cable = world.cables[c];
      ASSERT_EQ(cable.links.size(), 5U);
      EXPECT_NEAR(cable.segments[2].tension, c == 1 && reversed ? shared : -shared, 1e-9);
      const double light = 1.0 + static_cast<double>(c), heavy = light + 1.0;
      EXPECT_NEAR(cable.segments[reversed && c == 1 ? 4 : 1].tension, light * (g + a), 1e-9);
      EXPECT_NEAR(cable.segments[reversed && c == 1 ? 1 : 4].tension, heavy * (g - a), 1e-9);
    }
  }
}

// With friction on the drum too the cable carries it along, by the capstan law and the pinch
// together.
TEST(Pinch, SlippingCableUnderARollerTurnsTheDrum) {
  Scene scene;
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 5.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, r + 0.25 + 2.0 * w, 0.25, 2.0));
  scene.bodies.push_back(body("left", BodyKind::free, -R, -2.0, 0.2, 1.0));
  scene.bodies.push_back(body("right", BodyKind::free, R, -2.0, 0.2, 1.0));
  scene.bodies[0].cable_friction = 0.01;
  scene.bodies[1].cable_friction = 0.3;
  scene.bodies[1].driven_angular_velocity = -10.0;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3)));
  World world = make_world(scene, measured());
  Workspace work;
  double last = 0.0;
  for (int i = 0; i < 60; ++i) {
    run(scene, world, 1);
    EXPECT_GE(world.angle[0], last);
    last = world.angle[0];
  }
  const Velocities now = velocities_now(scene, world, work);
  const double cable_speed = -now.linear[2].y(), rim_speed = now.angular[0] * R;
  EXPECT_GT(rim_speed, 0.0);
  EXPECT_GT(cable_speed, rim_speed) << "the cable slips over the drum";
  EXPECT_LT(cable_speed, 10.0 * (0.25 + w)) << "and the roller over the cable";
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
}

/// A drum that turns clockwise under a roller of 2 kg on an upright rail: slack cable runs over the
/// drum and, from a transitional pinch at its top on, round the roller's underside.
Scene feeding(double of_drum, double of_roller) {
  Scene scene;
  scene.gravity = {0.0, -g};
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 5.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, 0.0, r + 0.25 + 2.0 * w, 0.25, 2.0));
  scene.bodies[0].driven_angular_velocity = -4.0;
  scene.bodies[0].cable_friction = of_drum;
  scene.bodies[1].cable_friction = of_roller;
  scene.cables.push_back(cable(at(-2.0, 0.0), {{0, -1, 0}, {1, 1, 0}}, at(1.5, 2.0), w));
  scene.cables[0].slack = 6.0;
  return scene;
}

/// Cable that nothing pulls is pushed through the pinch by what presses on it, and turns the roller
/// by the friction of whichever body holds it less: a constant force F = mu N on its lever, until
/// both rims are equally fast.
class Feed : public ::testing::TestWithParam<std::tuple<double, double, int>> {};

TEST_P(Feed, PushesSlackCableByFrictionOfThePressingForce) {
  const auto [of_drum, of_roller, steps_per_frame] = GetParam();
  Scene scene = feeding(of_drum, of_roller);
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  Workspace work;
  const double lever = 0.25 + w, inertia = 0.5 * 2.0 * 0.25 * 0.25, speed = 4.0 * R;
  const double acceleration = std::min(of_drum, of_roller) * 2.0 * g * lever / inertia;
  const double rest = world.cables[0].segments[3].rest_length;
  for (int i = 0; i < 60 * steps_per_frame; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    const double t = world.time(), even = speed / lever / acceleration;
    const double turned = t < even ? 0.5 * acceleration * t * t
                                   : 0.5 * acceleration * even * even + (t - even) * speed / lever;
    // Where the rims get even falls within a step, which is not divided there.
    const double off =
        t < even ? 1e-9 : 0.25 * acceleration * world.step_length * world.step_length;
    ASSERT_NEAR(world.angle[1], turned, off) << t;
    ASSERT_NEAR(world.cables[0].segments[2].rest_length, 0.0, 1e-12);
    // The cable goes with the body that holds it more.
    const double fed = of_drum > of_roller ? speed * t : turned * lever;
    ASSERT_NEAR(world.cables[0].segments[3].rest_length - rest, fed, 1e-9 + lever * off) << t;
  }
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
}

// Between axles nothing has to press.
TEST(Clamp, PushesSlackCableBetweenAxles) {
  Scene scene = feeding(infinity, infinity);
  scene.bodies[1].kind = BodyKind::fixed_axle;
  World world = make_world(scene, measured());
  run(scene, world, 240);
  EXPECT_NEAR(world.angle[1], 4.0 * R / (0.25 + w), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Clamp, Feed,
                         ::testing::Combine(::testing::Values(infinity, 0.5, 0.1),
                                            ::testing::Values(0.3, 0.2),
                                            ::testing::Values(1, 4, 16)));

/// A cart on a rail, which the rope from it to another one pulls along over a drum without wrap; a
/// roller lies on it, so far beside the drum's top.
Scene wringer(const Vec2& at, double beside) {
  constexpr double roller = 0.3;
  Scene scene;
  const double height = std::sqrt(std::pow(R + roller + w, 2) - beside * beside);
  scene.bodies.push_back(body("drum", BodyKind::fixed_axle, 0.0, 0.0, r, 3.0));
  scene.bodies.push_back(body("roller", BodyKind::rail, beside, height, roller, 5.0));
  scene.bodies[1].rail_axis = {0.0, 1.0};
  for (const double x : {-3.0, 3.0}) {
    scene.bodies.push_back(body(x < 0.0 ? "left" : "right", BodyKind::rail, x, R, 0.1, 1.0));
    scene.bodies.back().rail_axis = {1.0, 0.0};
    scene.bodies.back().velocity = {1.0, 0.0};
  }
  scene.bodies[0].angular_velocity = -1.0 / R;
  scene.bodies[1].angular_velocity = 1.0 / (roller + w);
  for (Body& one : scene.bodies) one.position += at;
  scene.cables.push_back(cable(on(2), {{0, -1, 0}}, on(3), w));
  return scene;
}

// Wherever it is in the plane, so that the drum's arc is longer or shorter than nothing by
// round-off, and when what it presses is next to the arc's end, in the span by less than a graze: a
// roller that lies on a cable rolls on it. It slid on it without friction, in half of these.
TEST(Pinch, ARollerPressesTheEndOfAnArcToo) {
  for (const Vec2& place : {Vec2(0.0, 0.0), Vec2(3.0, 3.0), Vec2(0.1, 0.7), Vec2(-2.3, 1.9)}) {
    for (const double beside : {0.0, 1e-7, 1e-6, 3e-6, 1e-5, -1e-6, -1e-5}) {
      Scene scene = wringer(place, beside);
      scene.bodies[1].angular_velocity = 0.0;  // it is taken along
      World world = make_world(scene, Method::pinch);
      run(scene, world, 60);
      const double rolled = (world.angle[1] - scene.bodies[1].angle) * (0.3 + w);
      const double come = world.position[3].x() - scene.bodies[3].position.x();
      EXPECT_NEAR(rolled, come, 1e-6) << place.transpose() << ", " << beside;
      EXPECT_NEAR(-(world.angle[0] - scene.bodies[0].angle) * R, come, 1e-6);
      EXPECT_GT(come, 0.05);
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
