// SPDX-License-Identifier: GPL-3.0-or-later
// Rigid bodies of several outlines.

#include "sim/compound.h"

#include <array>
#include <cmath>
#include <numbers>

#include "demos/scenes/shape_scenes.h"
#include "sim/diagnostics.h"
#include "sim/joints.h"
#include "sim/scene_error.h"
#include "tests/sim/random.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using std::numbers::pi;

Shape disc_at(double x, double y, double radius) {
  Shape shape;
  shape.properties.radius = radius;
  shape.place = {x, y};
  return shape;
}

Shape box_at(double x, double y, double width, double height) {
  Shape shape;
  const double a = 0.5 * width, b = 0.5 * height;
  shape.properties.corners = {{-a, -b}, {a, -b}, {a, b}, {-a, b}};
  shape.place = {x, y};
  return shape;
}

/// A compound that the scene does not have yet, at rest.
int add_compound(Scene& scene, const std::string& name, BodyKind kind, const Vec2& position,
                 double mass, std::span<const Shape> shapes) {
  scene.bodies.push_back(body(name, kind, position, 1.0, mass));
  const int compound = static_cast<int>(scene.bodies.size()) - 1;
  add_shapes(scene, compound, shapes);
  return compound;
}

double largest_difference(const World& a, int in_a, const World& b, int in_b) {
  const std::size_t i = index(in_a), k = index(in_b);
  return std::max((a.position[i] - b.position[k]).norm(), std::abs(a.angle[i] - b.angle[k]));
}

// Four quarters make the square, whichever way they are turned.
TEST(Compounds, PlatesAddUp) {
  const std::array<Vec2, 4> square{Vec2(-0.3, -0.3), Vec2(0.3, -0.3), Vec2(0.3, 0.3),
                                   Vec2(-0.3, 0.3)};
  std::array<Shape, 4> quarters;
  for (int k = 0; k < 4; ++k) {
    Shape& quarter = at(quarters, k);
    quarter = box_at(k % 2 == 0 ? -0.15 : 0.15, k < 2 ? -0.15 : 0.15, 0.3, 0.3);
    quarter.angle = 0.5 * pi * k;
  }
  // A shape's frame may have its origin anywhere.
  for (Vec2& corner : quarters[3].properties.corners) corner += Vec2(0.7, 0.2);
  quarters[3].place -= turned(Vec2(0.7, 0.2), quarters[3].angle);
  const Plate whole = plate_of(square, 0.0), sum = plate_of(quarters);
  EXPECT_NEAR(sum.area, whole.area, 1e-15);
  EXPECT_NEAR((sum.centre - whole.centre).norm(), 0.0, 1e-15);
  EXPECT_NEAR(sum.second_moment, whole.second_moment, 1e-15);

  Scene scene;
  const int compound = add_compound(scene, "square", BodyKind::free, {1.0, 2.0}, 3.0, quarters);
  EXPECT_NEAR(*at(scene.bodies, compound).inertia, 3.0 * 0.36 / 6.0, 1e-15);
  EXPECT_NEAR(at(scene.bodies, compound).radius, 0.3 * std::sqrt(2.0), 1e-15);
  EXPECT_EQ(scene.bodies[4].name, "square:4");
  EXPECT_NEAR((scene.bodies[4].position - Vec2(1.15, 2.15)).norm(), 0.0, 1e-15);
  EXPECT_EQ(scene.apart.size(), 6u);
}

/// A body of 2 kg that falls on a slack cable and on a wall, once as it is and once as the only
/// shape of a compound: the shape's index.
int add_faller(Scene& scene, const Shape& shape, bool as_compound) {
  if (as_compound) {
    const int compound =
        add_compound(scene, "faller", BodyKind::free, {0.1, 1.0}, 2.0, std::array{shape});
    at(scene.bodies, compound).angular_velocity = 2.0;
    return compound + 1;
  }
  Body faller = body("faller", BodyKind::free, 0.1, 1.0, shape.properties.radius, 2.0);
  if (is_polygon(shape.properties)) make_polygon(faller, shape.properties.corners, 0.0);
  faller.angular_velocity = 2.0;
  scene.bodies.push_back(faller);
  return static_cast<int>(scene.bodies.size()) - 1;
}

// Impacts, a span that is hit, rolling and a pinch: a compound of one shape is that shape.
TEST(Compounds, OfOneShapeIsThatShape) {
  for (const Shape& shape : {disc_at(0.0, 0.0, 0.2), box_at(0.0, 0.0, 0.5, 0.3)}) {
    std::array<World, 2> worlds;
    std::array<int, 2> moved{};
    for (const bool as_compound : {false, true}) {
      Scene scene;
      scene.bodies.push_back(body("left", BodyKind::fixed, -1.0, 0.0, 0.3));
      scene.bodies.push_back(body("right", BodyKind::fixed, 1.0, -0.1, 0.3));
      const int faller = add_faller(scene, shape, as_compound);
      scene.cables.push_back(cable(at(-1.6, -1.0), {{0, -1, 0}, {1, -1, 0}}, at(1.6, -1.0), 0.03));
      scene.cables[0].slack = 0.3;
      scene.walls.push_back({{-3.0, -0.6}, {3.0, -0.5}, 0.4, 0.0});
      World& world = at(worlds, as_compound ? 1 : 0);
      world = make_world(scene, measured());
      run(scene, world, 240);
      moved[as_compound ? 1 : 0] = faller;
      EXPECT_GT(world.diagnostics.events, 0);
    }
    EXPECT_LT(largest_difference(worlds[0], moved[0], worlds[1], moved[1]), 1e-9);
    EXPECT_NEAR(worlds[0].diagnostics.energy, worlds[1].diagnostics.energy, 1e-9);
  }
}

// A corner that a rope with mass comes on to takes up momentum, which the shape that it is of
// learns of at once.
TEST(Compounds, OfOneShapeCarriesARopeThatSlipsAsThatShape) {
  Shape pentagon;
  pentagon.properties.corners = build::regular_corners(5, 0.3);
  pentagon.properties.corner_radius = 0.02;
  for (const double mu : {0.0, 0.2}) {
    pentagon.properties.cable_friction = mu;
    std::array<World, 2> worlds;
    std::array<int, 2> moved{};
    for (const std::size_t as_compound : {0U, 1U}) {
      Scene scene;
      scene.bodies.push_back(body("left", BodyKind::free, -0.32, -1.5, 0.15, 2.0));
      scene.bodies.push_back(body("right", BodyKind::free, 0.36, -1.65, 0.15, 4.4));
      int sheave = 2;
      if (as_compound == 1) {
        sheave = 1 + add_compound(scene, "sheave", BodyKind::fixed_axle, Vec2::Zero(), 1.0,
                                  std::array{pentagon});
      } else {
        Body b = body("sheave", BodyKind::fixed_axle, 0.0, 0.0, 1.0, 1.0);
        make_polygon(b, pentagon.properties.corners, pentagon.properties.corner_radius);
        b.cable_friction = mu;
        scene.bodies.push_back(b);
      }
      scene.cables.push_back(cable(on(0), {{sheave, -1, 0}}, on(1), 0.02));
      scene.cables[0].mass_per_metre = 0.7;
      worlds[as_compound] = make_world(scene, measured());
      run(scene, worlds[as_compound], 120);
      moved[as_compound] = sheave;
    }
    EXPECT_GT(worlds[0].changes, 0);
    EXPECT_LT(largest_difference(worlds[0], moved[0], worlds[1], moved[1]), 1e-9) << mu;
    EXPECT_LT(largest_difference(worlds[0], 0, worlds[1], 0), 1e-9) << mu;
  }
}

// Two discs on a bar that has no mass of its own, hung up by one of them: a pendulum whose period
// is 4 sqrt(I / (m g d)) K(sin(th0 / 2)).
TEST(Compounds, ADumbbellSwingsInItsTime) {
  const double half = 0.5, radius = 0.1, start = 1.0, mass = 2.0;
  const double inertia = mass * (0.5 * radius * radius + half * half) + mass * half * half;
  const double period =
      4.0 * std::sqrt(inertia / (mass * g * half)) * std::comp_ellint_1(std::sin(0.5 * start));
  double before = 0.0;
  for (const int steps : {4, 8, 16}) {
    Scene scene;
    scene.frames_per_second = 64;
    scene.steps_per_frame = steps;
    scene.bodies.push_back(body("dumbbell", BodyKind::free,
                                half * Vec2(std::sin(start), -std::cos(start)), 1.0, mass));
    scene.bodies[0].angle = start;
    add_shapes(scene, 0, std::array{disc_at(0.0, half, radius), disc_at(0.0, -half, radius)});
    add_hinge(scene, "pin", 0, -1, Vec2::Zero());
    World world = make_world(scene, Method::pinch);
    Workspace work;
    double last = start;  // of the angle; the time at which it is 0 first is a quarter period
    double crossed = 0.0;
    while (crossed == 0.0) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      const double now = world.angle[0];
      if (now <= 0.0) crossed = world.time() - world.step_length * now / (now - last);
      last = now;
      EXPECT_NEAR((world.position[1] - world.position[2]).norm(), 2.0 * half, 1e-14);
    }
    const double error = std::abs(crossed - 0.25 * period);
    EXPECT_LT(error, 2e-3 / (steps * steps));
    if (before > 0.0) {
      EXPECT_GT(before / error, 3.5);
    }
    before = error;
  }
}

/// A drum with a fixed axle, whose cable lies over its rounded corners, and a bob that pulls.
Scene unwinding(bool as_compound, int steps_per_frame) {
  const double half = 0.3, rounding = 0.1;
  const std::vector<Vec2> corners{{-half, -half}, {half, -half}, {half, half}, {-half, half}};
  Scene scene;
  scene.steps_per_frame = steps_per_frame;
  Body drum = body("drum", BodyKind::fixed_axle, Vec2::Zero(), 1.0, 5.0);
  drum.inertia = 0.8;
  if (!as_compound) make_polygon(drum, corners, rounding);
  scene.bodies.push_back(drum);
  scene.bodies.push_back(body("bob", BodyKind::free, 0.75, -1.2, 0.02, 1.0));
  std::vector<Wrap> wraps = {{0, -1, 0}};
  Attachment start{0, {-half - rounding - 0.05, 0.0}};
  if (as_compound) {
    std::vector<Shape> discs;
    for (const Vec2& corner : corners) discs.push_back(disc_at(corner.x(), corner.y(), rounding));
    add_shapes(scene, 0, discs);
    wraps = {{5, -1, 0}, {4, -1, 0}};  // left and right above
    start = {2, {-rounding - 0.05, 0.3}};
  }
  scene.cables.push_back(cable(start, wraps, on(1)));
  return scene;
}

// A cable about four discs at the corners of a drum runs as it does about the square that is
// rounded there. Corners of the one come and go within a step, and links of the other at their
// time.
TEST(Compounds, FourDiscsAreARoundedSquare) {
  double before = 0.0;
  for (const int steps : {4, 16}) {
    std::array<World, 2> worlds;
    for (const bool as_compound : {false, true}) {
      const Scene scene = unwinding(as_compound, steps);
      World& world = at(worlds, as_compound ? 1 : 0);
      world = make_world(scene, measured());
      run(scene, world, 40 * steps);
      EXPECT_GT(std::abs(world.angle[0]), 1.0);
      EXPECT_LT(world.diagnostics.cable_length_error, 1e-12);
    }
    const double error = (worlds[0].position[1] - worlds[1].position[1]).norm();
    EXPECT_LT(error, 2e-3 / (steps * steps));
    if (before > 0.0) {
      EXPECT_GT(before / error, 10.0);
    }
    before = error;
  }
}

// A block of four sheaves without friction on one cable of four falls: the weight pulls by 4 T, and
// rises a quarter as fast as the cable's end sinks.
TEST(Compounds, ABlockHangsOnAllFallsOfItsCable) {
  for (const int steps : {1, 4}) {
    Scene scene;
    scene.steps_per_frame = steps;
    const std::array sheaves{disc_at(-0.3, 0.0, 0.15), disc_at(0.3, 0.0, 0.15)};
    const int block = add_compound(scene, "block", BodyKind::free, {0.0, -2.0}, 3.0, sheaves);
    scene.bodies.push_back(body("crown", BodyKind::fixed, 0.0, 0.0, 0.05));
    scene.bodies.push_back(body("end", BodyKind::fixed, 0.75, 0.0, 0.2));
    scene.bodies.push_back(body("load", BodyKind::free, 1.0, -1.0, 0.1, 1.0));
    for (const int b : {1, 2, 3, 4}) at(scene.bodies, b).cable_friction = 0.0;
    scene.cables.push_back(
        cable(at(-0.5, 0.0), {{1, 1, 0}, {3, -1, 0}, {2, 1, 0}, {4, -1, 0}}, on(5)));
    World world = make_world(scene, measured());
    run(scene, world, 20 * steps);
    // 4 T - M g = M a, m g - T = m 4 a.
    const double heavy = 3.0, light = 1.0;
    const double a = (4.0 * light - heavy) * g / (heavy + 16.0 * light), t = world.time();
    EXPECT_NEAR(world.position[index(block)].y(), -2.0 + 0.5 * a * t * t, 1e-10);
    EXPECT_NEAR(world.position[index(block)].x(), 0.0, 1e-10);
    EXPECT_NEAR(world.angle[index(block)], 0.0, 1e-10);
    EXPECT_NEAR(world.position[5].y(), -1.0 - 2.0 * a * t * t, 1e-10);
  }
}

// The capstan law over two discs of one body: both turnings count, and the span between them has
// what one leaves to the other.
TEST(Compounds, TheCapstanLawHoldsOverShapes) {
  const double mu = 0.25, light = 1.0, heavy = 4.0, k = std::exp(mu * pi);
  Scene scene;
  std::array discs{disc_at(-0.4, 0.0, 0.2), disc_at(0.4, 0.0, 0.2)};
  for (Shape& disc : discs) disc.properties.cable_friction = mu;
  add_compound(scene, "beam", BodyKind::fixed, Vec2::Zero(), 1.0, discs);
  scene.bodies.push_back(body("light", BodyKind::free, -0.65, -2.0, 0.1, light));
  scene.bodies.push_back(body("heavy", BodyKind::free, 0.65, -1.0, 0.1, heavy));
  scene.cables.push_back(cable(on(3), {{1, -1, 0}, {2, -1, 0}}, on(4)));
  World world = make_world(scene, Method::pinch);
  run(scene, world, 120);
  const double a = g * (heavy - k * light) / (heavy + k * light), t = world.time();
  EXPECT_NEAR(world.position[4].y(), -1.0 - 0.5 * a * t * t, 1e-12);
  const std::vector<Segment>& s = world.cables[0].segments;
  EXPECT_NEAR(s[3].tension / s[1].tension, k, 1e-9);
  EXPECT_NEAR(s[2].tension / s[1].tension, std::sqrt(k), 1e-9);
}

// A car, its body of two boxes and its wheels hinged to it, rolls down a slope: M g sin s = (M + 2
// I / r^2) a, M with the wheels.
TEST(Compounds, ACarRollsDownASlope) {
  const double slope = 0.2, r = 0.15, wheel = 0.5, chassis = 4.0;
  const Vec2 along(std::cos(slope), -std::sin(slope)), up(std::sin(slope), std::cos(slope));
  Scene scene;
  scene.bodies.push_back(body("car", BodyKind::free, 0.35 * up, 1.0, chassis));
  scene.bodies[0].angle = -slope;
  add_shapes(scene, 0, std::array{box_at(0.0, 0.0, 1.0, 0.2), box_at(0.1, 0.2, 0.4, 0.2)});
  for (const double x : {-0.35, 0.35}) {
    scene.bodies.push_back(
        body(x < 0 ? "rear" : "front", BodyKind::free, Vec2(r * up + x * along), r, wheel));
    scene.bodies.back().contact_friction = 5.0;
    const int number = static_cast<int>(scene.bodies.size()) - 1;
    add_hinge(scene, scene.bodies.back().name + " axle", 0, number, scene.bodies.back().position);
  }
  scene.walls.push_back({-1.0 * along, 20.0 * along, 5.0, 0.0});
  World world = make_world(scene, Method::pinch);
  const Vec2 start = world.position[0];
  run(scene, world, 240);
  const double t = world.time(), mass = chassis + 2.0 * wheel;
  const double a = mass * g * std::sin(slope) / (mass + 2.0 * 0.5 * wheel);
  EXPECT_NEAR((world.position[0] - start - 0.5 * a * t * t * along).norm(), 0.0, 1e-6);
  EXPECT_NEAR(world.angle[0], -slope, 1e-6);
}

// An L on its foot stands until its centre of mass is beyond it.
TEST(Compounds, AnAngleStandsOnItsFoot) {
  for (const double foot :
       {0.20, 0.30}) {  // m wide, below a post of 0.1 m at its left end with an arm
    const std::array given{box_at(0.0, 0.0, foot, 0.1), box_at(0.05 - 0.5 * foot, 0.45, 0.1, 0.8),
                           box_at(0.45 - 0.5 * foot, 0.9, 0.9, 0.1)};
    std::array shapes = given;
    const Plate plate = plate_of(given);
    for (Shape& shape : shapes) shape.place -= plate.centre;
    Scene scene;
    scene.walls.push_back({{-5.0, 0.0}, {5.0, 0.0}, 0.8, 0.0});
    add_compound(scene, "angle", BodyKind::free, {0.0, plate.centre.y() + 0.05}, 2.0, shapes);
    World world = make_world(scene, measured());
    run(scene, world, 240);
    const bool stands = plate.centre.x() < 0.5 * foot;
    EXPECT_EQ(stands, foot > 0.25);
    EXPECT_EQ(std::abs(world.angle[0]) < 1e-9, stands) << world.angle[0];
  }
}

/// Two to four shapes about their common centre.
std::vector<Shape> random_shapes(Random& random, double size) {
  std::vector<Shape> shapes;
  const int count = 2 + random.below(3);
  for (int k = 0; k < count; ++k) {
    const double x = size * random.uniform(-1.0, 1.0), y = size * random.uniform(-1.0, 1.0);
    Shape shape = random.below(2) == 0 ? disc_at(x, y, size * random.uniform(0.3, 0.6))
                                       : box_at(x, y, size * random.uniform(0.4, 1.2),
                                                size * random.uniform(0.4, 1.2));
    shape.angle = random.uniform(0.0, 6.0);
    shapes.push_back(shape);
  }
  const Vec2 centre = plate_of(shapes).centre;
  for (Shape& shape : shapes) shape.place -= centre;
  return shapes;
}

/// Compounds that fall on a cable over discs and compounds with fixed axles.
Scene falling_compounds(unsigned seed) {
  Random random(seed);
  Scene scene;
  const int pulleys = 2 + random.below(2), falling = 1 + random.below(3);
  const bool slips = random.below(2) == 0;
  std::vector<Wrap> wraps;
  for (int i = 0; i < pulleys; ++i) {
    const BodyKind kind = random.below(2) == 0 ? BodyKind::fixed : BodyKind::fixed_axle;
    scene.bodies.push_back(body(fmt::format("pulley {}", i), kind, 1.6 * i, 0.3 * (i % 2),
                                random.uniform(0.3, 0.45), 1.0));
    wraps.push_back({i, -1, 0});
  }
  for (int i = 0; i < falling; ++i) {
    const Vec2 place(random.uniform(-0.2, 1.6 * (pulleys - 1) + 0.2), 1.5 + 1.2 * i);
    const int compound = add_compound(scene, fmt::format("falling {}", i), BodyKind::free, place,
                                      std::pow(10.0, random.uniform(-1.0, 1.0)),
                                      random_shapes(random, random.uniform(0.15, 0.3)));
    at(scene.bodies, compound).angular_velocity = random.uniform(-3.0, 3.0);
  }
  for (Body& b : scene.bodies) {
    b.cable_friction = slips ? random.uniform(0.0, 0.6) : infinity;
    b.restitution = random.below(3) == 0 ? random.uniform(0.0, 1.0) : 0.0;
    b.contact_friction = random.uniform(0.0, 1.0);
  }
  const double right = 1.6 * (pulleys - 1) + 1.0;
  scene.cables.push_back(cable(at(-1.0, -1.5), wraps, at(right, -1.5), 0.04));
  scene.cables[0].slack = random.uniform(0.0, 0.5);
  scene.walls.push_back({{-10.0, -2.5}, {20.0, -2.5}, 0.5, 0.0});
  scene.walls.push_back({{-2.0, -3.0}, {-2.0, 5.0}, 0.5, 0.0});
  return scene;
}

// Energy may rise by leapfrog's own swing alone, which falls with the square of the step, and shows
// where a body rolls on to the cable without loss before anything else has taken energy.
TEST(RandomCompounds, StayFiniteAndMakeNoEnergy) {
  int ran = 0, squeezed = 0, stretched = 0, rises = 0;
  for (unsigned seed = 0; seed < seeds_of(300U); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = falling_compounds(seed);
      scene.steps_per_frame = steps;
      World world = make_world(scene, measured());
      Workspace work;
      double start = 0.0, gained = 0.0, at_play = 0.0, gap = 0.0, stretch = 0.0;
      for (int i = 0; i < 90 * steps; ++i) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok)
            << "seed " << seed << ", " << steps << " steps a frame: " << world.failure;
        const Diagnostics& d = world.diagnostics;
        if (i == 0) start = d.energy;
        gained = std::max(gained, d.energy - start);
        at_play = std::max(at_play, start - d.energy);
        gap = std::max(gap, d.largest_gap_violation);
        stretch = std::max(stretch, d.largest_stretch);
      }
      rises += gained > 1e-9 * at_play ? 1 : 0;
      EXPECT_LE(gained, 5e-3 / (steps * steps) * at_play)
          << "seed " << seed << ", " << steps << " steps a frame";
      ++ran;
      if (steps == 1) continue;
      const double w = scene.cables[0].half_width;
      squeezed += gap > 1e-3 * w ? 1 : 0;
      stretched += stretch > 1e-3 * w ? 1 : 0;
    }
  }
  EXPECT_EQ(ran, 3 * seeds_of(300));
  EXPECT_LE(rises, 2);
  EXPECT_EQ(squeezed, 0) << "of " << ran;
  EXPECT_EQ(stretched, 0) << "of " << ran;
}

TEST(RandomCompounds, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < seeds_of(40U); ++seed) {
    const Scene scene = falling_compounds(seed);
    EXPECT_TRUE(is_all_state(scene, Method::pinch, 200)) << seed;
  }
}

TEST(Compounds, RefuseWhatCannotBe) {
  Scene scene;
  add_compound(scene, "compound", BodyKind::free, Vec2::Zero(), 1.0,
               std::array{disc_at(-0.3, 0.0, 0.2), disc_at(0.3, 0.0, 0.2)});
  Scene round_it = scene;
  round_it.cables.push_back(cable(at(-1.0, 0.5), {{0, -1, 0}}, at(1.0, 0.5)));
  EXPECT_THROW(make_world(round_it, Method::pinch), SceneError);
  for (const int carrier : {7, 1, 2}) {
    Scene wrong = scene;
    wrong.bodies[2].carrier = carrier;
    EXPECT_THROW(make_world(wrong, Method::pinch), SceneError) << carrier;
  }
}

}  // namespace
}  // namespace pinchlab::testing
