// SPDX-License-Identifier: GPL-3.0-or-later
// Cables with mass that hang by nodes from drums: in layers, and where they fold back on discs.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "demos/scenes/shape_scenes.h"
#include "sim/cable/strung.h"
#include "sim/make_world.h"
#include "sim/nodes.h"
#include "sim/tangent.h"
#include "tests/sim/course.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A load on a rope of 2 kg/m that hangs from a drum of eight layers, beside it.
Scene hanging_hoist(bool begins_there, int nodes, int steps) {
  Scene scene = build::heavy_hoist(steps, begins_there);
  scene.cables[0].nodes = nodes;
  return scene;
}

/// m, of what lies on a drum in layers from where the first begins to the material `place`.
double length_on_drum(const CableState& rope, const Link& drum, double place) {
  return drum.layers.way > 0 ? place : rope.length - place;
}

// The drum stands, the load as well: nothing moves for a second, and what is wound up lies at the
// radius sqrt(inner^2 + 2 w l / pi) that the area of the rope below it asks for.
TEST(StrungLayers, HangsAtRestFromADrumThatFills) {
  for (const bool begins_there : {true, false}) {
    Scene scene = hanging_hoist(begins_there, 60, 4);
    for (std::size_t b = 0; b < 2; ++b) scene.bodies[b].kind = BodyKind::fixed;
    scene.cables[0].slack = 0.5;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    const std::vector<Vec2> start = world.position;
    const CableState& rope = world.cables[0];
    const auto on_drum = [](const Link& link) { return link.layers.way != 0 && link.body == 0; };
    const auto drum = std::find_if(rope.links.begin(), rope.links.end(), [&](const Link& link) {
      return link.orientation != 0 && on_drum(link);
    });
    ASSERT_NE(drum, rope.links.end());
    int wound = 0;
    for (int k = 0; k < rope.nodes; ++k) {
      const int node = rope.first_node + k;
      const double l = length_on_drum(rope, *drum, node_spacing(rope) * (k + 1));
      if (l > drum->layers.length(drum->wrap)) continue;
      const double inner = drum->layers.inner;
      const double radius = std::sqrt(inner * inner + 2.0 * rope.half_width * l / std::numbers::pi);
      EXPECT_NEAR((world.position[index(node)] - world.position[0]).norm(), radius, 1e-12) << k;
      ++wound;
    }
    EXPECT_GT(wound, 40);
    EXPECT_LT(wound, 58);
    run(scene, world, 240);
    for (std::size_t b = 0; b < start.size(); ++b) {
      EXPECT_LT((world.position[b] - start[b]).norm(), 1e-9) << b;
    }
  }
}

// The load swings under the drum, which it unwinds: to where finer nodes take it, with less and
// less energy lost where the drum gives them off, and none made beyond leapfrog's swing.
TEST(StrungLayers, UnwindsToWhereFinerNodesGo) {
  for (const bool begins_there : {true, false}) {
    std::vector<Vec2> ends;
    double before = infinity;
    for (const int nodes : {20, 40, 80}) {
      for (const int steps : {2, 8}) {
        Scene scene = hanging_hoist(begins_there, nodes, steps);
        spread_nodes(scene);
        World world = make_world(scene, measured());
        Workspace work;
        double start = 0.0, least = infinity, most = -infinity;
        for (int i = 0; i < 60 * steps; ++i) {
          ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
          const Diagnostics& d = world.diagnostics;
          if (i == 0) start = d.energy;
          least = std::min(least, d.energy);
          most = std::max(most, d.energy);
          ASSERT_LT(d.cable_length_error, 1e-12);
          ASSERT_LT(d.largest_stretch, 1e-9);
        }
        EXPECT_GT(world.diagnostics.node_changes, 0);
        EXPECT_LT(most - start, 0.02 / (steps * steps)) << nodes;  // J, of 200 that come into play
        if (steps < 8) continue;
        EXPECT_LT(start - least, 0.7 * before) << nodes;
        EXPECT_LT(start - least, 0.3 / nodes) << nodes;
        before = start - least;
        ends.push_back(world.position[1]);
      }
    }
    EXPECT_GT((ends[1] - ends[0]).norm(), 3.0 * (ends[2] - ends[1]).norm());
    EXPECT_LT((ends[2] - ends[1]).norm(), 2e-3);
  }
}

// Wound up and down again by a driven drum the rope hangs as it hung.
TEST(StrungLayers, HangsAsBeforeOnceItWasWoundUp) {
  Scene scene = hanging_hoist(true, 60, 4);
  scene.bodies[0].kind = BodyKind::fixed_axle;
  scene.bodies[1].kind = BodyKind::fixed;
  scene.cables[0].slack = 1.5;
  spread_nodes(scene);
  const int half = 240;  // steps, of a second
  World world = make_world(scene, measured());
  Workspace work;
  const double angle = world.angle[0];
  const auto live = [&world] {
    const CableState& rope = world.cables[0];
    return std::count_if(rope.links.begin(), rope.links.end(),
                         [&rope](const Link& link) { return is_strung(rope, link); });
  };
  const auto start = live();
  auto least = start;
  for (int i = 0; i < 2 * half; ++i) {
    scene.bodies[0].driven_angular_velocity = i < half ? 1.5 : -1.5;
    world.bodies[0].driven_angular_velocity = scene.bodies[0].driven_angular_velocity;
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    least = std::min(least, live());
    ASSERT_LT(world.diagnostics.largest_stretch, 1e-9);
  }
  EXPECT_LE(least + 2, start);
  EXPECT_NEAR(world.angle[0], angle, 1e-9);
  EXPECT_NEAR(static_cast<double>(live()), static_cast<double>(start), 1.0);
}

// Pieces are to be four times as long as the rope is wide: a drum takes hold of nodes half a width
// away.
TEST(StrungLayers, RefusesPiecesThatAreTooShort) {
  Scene scene = hanging_hoist(true, 180, 4);
  const std::string text = message_of<SceneError>([&scene] {
    spread_nodes(scene);
    make_world(scene, Method::pinch);
  });
  EXPECT_NE(text.find("are no longer than four times the width of a cable in layers; at most "),
            std::string::npos)
      << text;
}

// What comes on to layers is not stretched: of a short span they would take more than it has.
TEST(StrungLayers, RefusesWhatStretches) {
  Scene scene = hanging_hoist(true, 40, 4);
  scene.cables[0].axial_stiffness = 1e5;
  spread_nodes(scene);
  const std::string text = message_of<SceneError>([&scene] { make_world(scene, Method::pinch); });
  EXPECT_NE(text.find("stretches cannot lie in layers"), std::string::npos) << text;
}

/// m, how far a disc is in a span at most that neither ends on it nor is held by it.
double deepest_in_spans(const World& world) {
  double deepest = 0.0;
  const CableState& rope = world.cables[0];
  for (std::size_t s = 1; s < rope.segments.size(); ++s) {
    const Segment& span = rope.segments[s];
    if (span.pinched || !(span.length > 0.0)) continue;
    for (std::size_t b = 0; b < world.bodies.size(); ++b) {
      const auto body = static_cast<int>(b);
      const BodyProperties& disc = world.bodies[b];
      if (disc.node || !disc.corners.empty() || !disc.outlined) continue;
      if (rope.links[s].body == body || rope.links[s - 1].body == body) continue;
      if (is_within_end(world, rope, rope.links[s], body) ||
          is_within_end(world, rope, rope.links[s - 1], body)) {
        continue;
      }
      const Vec2 x = world.position[b] - span.tail;
      const double along = span.direction.dot(x);
      if (along <= 0.0 || along >= span.length) continue;
      const double side = std::abs(cross(span.direction, x));
      deepest = std::max(deepest, disc.radius + rope.half_width - side);
    }
  }
  return deepest;
}

void check_random_rope(const Scene& scene, double seconds, const std::string& what) {
  World world = make_world(scene, measured());
  Workspace work;
  double start = 0.0, gained = 0.0, at_play = 0.0, gap = 0.0, stretch = 0.0, deepest = 0.0;
  for (int i = 0; i < seconds * 60 * scene.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok) << what << world.failure;
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    gained = std::max(gained, d.energy - start);
    at_play = std::max(at_play, start - potential_energy(scene, world));
    gap = std::max(gap, d.largest_gap_violation);
    stretch = std::max(stretch, d.largest_stretch);
    deepest = std::max(deepest, deepest_in_spans(world));
    ASSERT_LT(d.cable_length_error, 1e-12) << what;
  }
  const double w = scene.cables[0].half_width;
  EXPECT_LE(gained, 1e-4 * at_play) << what;
  EXPECT_LE(gap, 1e-6 * w) << what;
  EXPECT_LE(stretch, 1e-6 * w) << what;
  EXPECT_LE(deepest, 1e-6) << what;
}

// Discs fall on ropes that braked drums pay out, many to the end; the rope folds back on discs and
// drums, and comes off them again. Where a node lay between, a disc was met by a span that came
// back to it only once it was up to 0.1 m inside.
TEST(RandomStrungLayers, KeepLengthsAndGapsAndMakeNoEnergy) {
  for (unsigned seed = 0; seed < seeds_of(100U); ++seed) {
    for (const bool layers : {true, false}) {
      for (const int steps : {1, 4, 16}) {
        if (steps == 16 && seed % 4 != 0) continue;
        Scene scene = strung_braked_rope(seed, layers);
        scene.steps_per_frame = steps;
        check_random_rope(scene, 1.5, fmt::format("{} {} at {}: ", seed, layers, steps));
      }
    }
  }
}

TEST(RandomStrungLayers, AClearedWorkspaceChangesNoBit) {
  for (unsigned seed = 0; seed < 12; ++seed) {
    EXPECT_TRUE(is_all_state(strung_braked_rope(seed, true), Method::pinch, 200)) << seed;
  }
}

// A drum flings off the whole of its rope, whose end then winds up on the other side: it folds back
// on drum and load.
TEST(StrungLayers, ARopeThatRunsOffItsDrumKeepsItsLength) {
  for (const bool begins_there : {true, false}) {
    for (const bool layers : {true, false}) {
      for (const int steps : {1, 4}) {
        Scene scene = hanging_hoist(begins_there, 60, steps);
        for (Attachment* end : {&scene.cables[0].start, &scene.cables[0].end}) {
          end->layers = end->layers && layers;
        }
        scene.bodies[0].angular_velocity = begins_there ? 25.0 : -25.0;
        scene.cables[0].slack = 1.0;
        spread_nodes(scene);
        const Course course = run_measured(scene, 3.0);
        EXPECT_LT(course.stretch, 1e-8) << begins_there << layers << steps;
        EXPECT_LT(course.gap, 1e-8);
        EXPECT_LT(course.gained, 1e-4 * course.at_play);
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
