// SPDX-License-Identifier: GPL-3.0-or-later
// Neither the units of length and mass nor the order in which a scene lists its items matter: no
// tolerance of the simulator is so many metres or kilograms, and no choice hangs on what comes
// first.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "demos/scenes/scene_json.h"
#include "sim/make_world.h"
#include "sim/step.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/scaled.h"

namespace pinchlab::testing {
namespace {

const std::vector<std::string> demonstrations = {
    "01-roll-over",  "02-stack",           "03-drop",          "04-two-blocking",
    "05-notch",      "06-windlass",        "07-driven-roller", "08-driven-roller-weights",
    "more/09-crate", "more/10-drum",       "more/11-chain",    "more/12-linkage",
    "more/13-car",   "more/14-heavy-rope", "more/15-rope-way"};

Scene demonstration(const std::string& name) {
  return read_scene_file(PINCHLAB_SOURCE_DIR "/demos/" + name + ".json").scene;
}

/// Units of length and mass: thumbnails, houses, grams and freighters.
const std::vector<std::pair<double, double>> units = {
    {0x1p-10, 1.0}, {0x1p4, 1.0}, {1.0, 0x1p-10}, {0x1p3, 0x1p20}};

/// But for what is so small that doubles have fewer digits for it.
bool same(double x, double y) {
  return x == y || std::max(std::abs(x), std::abs(y)) < 1e-300;
}

bool same(const Vec2& x, const Vec2& y) {
  return same(x.x(), y.x()) && same(x.y(), y.y());
}

/// The first of so many steps after which a scene in units `l` and `m` is not, to the last bit,
/// where it is in its own; or -1.
int first_parted(const Scene& scene, const Configuration& method, double l, double m, int steps) {
  const Scene other = scaled(scene, l, m);
  World world = make_world(scene, method), scaled_world = make_world(other, method);
  Workspace work, scaled_work;
  for (int i = 1; i <= steps; ++i) {
    const StepStatus status = step(scene, world, work);
    if (step(other, scaled_world, scaled_work) != status || status != StepStatus::ok) return i;
    for (std::size_t b = 0; b < world.position.size(); ++b) {
      if (!same(scaled_world.position[b], l * world.position[b])) return i;
      if (!same(scaled_world.velocity[b], l * world.velocity[b])) return i;
      if (!same(scaled_world.angle[b], world.angle[b])) return i;
      if (!same(scaled_world.angular_velocity[b], world.angular_velocity[b])) return i;
    }
  }
  return -1;
}

TEST(Scale, DemonstrationsMoveAlikeInAllUnitsToTheLastBit) {
  for (const std::string& name : demonstrations) {
    const Scene scene = demonstration(name);
    const int steps = scene.frame_count * scene.steps_per_frame;
    for (const Configuration& method :
         {Configuration(Method::pinch), Configuration(Method::pinch_no_contact),
          Configuration(Method::cable), thesis_configuration()}) {
      for (const auto& [l, m] : units) {
        EXPECT_EQ(first_parted(scene, method, l, m, steps), -1)
            << name << ' ' << to_string(method) << ' ' << l << " m, " << m << " kg";
      }
    }
  }
}

TEST(Scale, RandomScenesMoveAlikeInAllUnitsToTheLastBit) {
  for (int seed = 0; seed < seeds_of(40); ++seed) {
    for (const Scene& scene :
         {random_scene(seed), slipping_elastic(seed), heavy_elastic(seed), linkage(seed)}) {
      for (const auto& [l, m] : units) {
        EXPECT_EQ(first_parted(scene, Method::pinch, l, m, 240), -1)
            << seed << ": " << l << " m, " << m << " kg";
      }
    }
  }
}

/// m, the largest distance between body b of one and body place[b] of the other over `seconds`.
double largest_apart(const Scene& scene, const Scene& other, const std::vector<int>& place,
                     const Configuration& method, double seconds) {
  World world = make_world(scene, method), other_world = make_world(other, method);
  Workspace work, other_work;
  double most = 0.0;
  while (world.time() < seconds) {
    const StepStatus status = step(scene, world, work);
    if (step(other, other_world, other_work) != status || status != StepStatus::ok) return infinity;
    for (std::size_t b = 0; b < place.size(); ++b) {
      const Vec2& x = pinchlab::at(other_world.position, place[b]);
      most = std::max(most, (world.position[b] - x).norm());
    }
  }
  return most;
}

constexpr double near_enough = 1e-9;  // m

bool moves_alike_in_any_order(const Scene& scene, const Configuration& method, double seconds) {
  std::vector<int> place;
  const Scene other = reversed(scene, place);
  return largest_apart(scene, other, place, method, seconds) <= near_enough;
}

/// Whether round-off decides the motion: what is nudged by some of it is elsewhere, too.
bool is_chaotic(const Scene& scene, const Configuration& method, double seconds) {
  std::vector<int> place(scene.bodies.size());
  std::iota(place.begin(), place.end(), 0);
  Scene heavier = scene, faster = scene;
  heavier.gravity *= 1.0 + 1e-13;
  for (Body& body : faster.bodies) {
    if (body.kind == BodyKind::free) body.velocity.x() += 1e-14;
  }
  return largest_apart(scene, heavier, place, method, seconds) > near_enough ||
         largest_apart(scene, faster, place, method, seconds) > near_enough;
}

// But sweeps, which solve one row after the other, and chains of nodes, which are a run of the
// list. Plain cable joints jitter in the stack, as its own baseline does not.
TEST(Order, DemonstrationsMoveAlikeInAnyOrder) {
  for (const std::string& name : demonstrations) {
    const Scene scene = demonstration(name);
    if (std::ranges::any_of(scene.bodies, &Body::node)) continue;
    const double clip = 1.0 * scene.frame_count / scene.frames_per_second;  // s
    for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
      if (name == "02-stack" && method == Method::cable) {
        EXPECT_TRUE(is_chaotic(scene, method, clip));
      } else {
        EXPECT_TRUE(moves_alike_in_any_order(scene, method, clip))
            << name << ' ' << to_string(method);
      }
    }
  }
}

// Discs that are thrown on each other and on cables go their ways by round-off, about one scene in
// five within a second; and one or two of these scenes by order alone, where slack cable that is
// pinched has several ways to slide (solve/complementary.h). Nothing of the kind happens to what is
// held together.
TEST(Order, RandomScenesMoveAlikeInAnyOrderUnlessChaotic) {
  int chaotic = 0, undecided = 0;
  for (int seed = 0; seed < seeds_of(60); ++seed) {
    const Scene thrown = random_scene(seed);
    if (!moves_alike_in_any_order(thrown, Method::pinch, 1.0)) {
      ++(is_chaotic(thrown, Method::pinch, 1.0) ? chaotic : undecided);
    }
    for (const Scene& scene : {random_elastic(seed), slipping_elastic(seed), linkage(seed)}) {
      EXPECT_TRUE(moves_alike_in_any_order(scene, Method::pinch, 1.0)) << seed;
    }
  }
  EXPECT_LE(chaotic, 15);
  EXPECT_LE(undecided, 2);
}

}  // namespace
}  // namespace pinchlab::testing
