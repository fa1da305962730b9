// SPDX-License-Identifier: GPL-3.0-or-later
// How rope that lies in layers, and what fastens cables, is drawn.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "demos/scenes/scene_json.h"
#include "render/picture/cable_path.h"
#include "render/picture/compose.h"
#include "sim/step.h"

namespace pinchlab {
namespace {

/// A rope from one drum that fills to another, over both or under both, `slack` m longer than its
/// taut path.
SceneFile reels(const std::string& slack, const std::string& way = "clockwise") {
  return parse_scene(R"({"title": "reels", "duration_s": 1, "view": "fit",
    "baseline": {"method": "cable", "reason": "none"},
    "bodies": [
      {"name": "a", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 1, "position_m": [-1, 0]},
      {"name": "b", "kind": "fixed_axle", "radius_m": 0.2, "mass_kg": 1, "position_m": [1, 0]}],
    "cables": [{"name": "rope", "half_width_m": 0.03, "slack_m": )" +
                         slack + R"(, "look": {"colour": "#3060ff"},
      "start": {"body": "a", "rim_angle_rad": 1, "layers": true},
      "wraps": [{"body": "a", "turn": ")" +
                         way + R"(", "extra_turns": 2},
                {"body": "b", "turn": ")" +
                         way + R"(", "extra_turns": 3}],
      "end": {"body": "b", "rim_angle_rad": 2, "layers": true}}]})",
                     "reels.json");
}

// The span leaves a turn of the spiral: where it hangs, further in or out than where it is taut. It
// left the circle of the taut one, with a step of up to a half width in the rope.
TEST(CablePath, SlackRopeLeavesALayeredDrumAlongItsTurns) {
  for (const auto& [slack, way] :
       std::vector<std::pair<std::string, std::string>>{{"0", "clockwise"},
                                                        {"0.05", "clockwise"},
                                                        {"2", "clockwise"},
                                                        {"0.4", "counter_clockwise"},
                                                        {"6", "counter_clockwise"}}) {
    const SceneFile file = reels(slack, way);
    const World world = make_world(file.scene, Method::pinch);
    std::vector<StripPoint> points;
    append_cable_path(file.scene, world, world.cables[0], 1e-4, points);
    double length = 0.0;
    for (std::size_t i = 1; i < points.size(); ++i) {
      const Vec2 chord = points[i].position - points[i - 1].position;
      length += chord.norm();
      EXPECT_GE(chord.dot(points[i].tangent), 0.9 * chord.norm() - 1e-4) << slack << ", " << i;
      EXPECT_GE(points[i].material, points[i - 1].material - 1e-9) << slack << ", " << i;
    }
    EXPECT_NEAR(length, world.cables[0].length, 0.02 * world.cables[0].length) << slack;
    EXPECT_NEAR(points.back().material - points.front().material, world.cables[0].length, 1e-6);
  }
}

// What lies under the rope between its turns showed beside it.
TEST(Compose, NothingShowsBesideTheTurnsOfSlackRope) {
  for (const char* slack : {"0.4", "6"}) {
    const SceneFile file = reels(slack, "counter_clockwise");
    const World world = make_world(file.scene, Method::pinch);
    Picture picture;
    compose(file.scene, set_scenery(file.scene, file.look), world, picture);
    const auto is_rope = [](const Strip& s) { return s.half_width == 0.03; };
    const auto rope = std::ranges::find_if(picture.strips, is_rope);
    ASSERT_NE(rope, picture.strips.end());
    for (const Strip& seam : picture.strips) {
      if (seam.half_width != 0.015) continue;
      for (std::size_t k = seam.first; k < seam.first + seam.count; ++k) {
        const Vec2& place = picture.points[k].position;
        const Vec2 up = (place - Vec2(place.x() < 0.0 ? -1.0 : 1.0, 0.0)).normalized();
        bool covered = false;  // by the turn outside of it
        for (std::size_t i = rope->first; i < rope->first + rope->count; ++i) {
          const Vec2 off = picture.points[i].position - place;
          covered |= off.norm() < 0.12 && off.dot(up) > 0.0;
        }
        EXPECT_TRUE(covered) << slack << ", " << k - seam.first;
      }
    }
  }
}

TEST(Compose, FasteningsHaveTheColourOfTheirCable) {
  const SceneFile file = reels("0");
  Picture picture;
  compose(file.scene, set_scenery(file.scene, file.look), make_world(file.scene, Method::pinch),
          picture);
  const Colour shade{0x30 * 2 / 5, 0x60 * 2 / 5, 255 * 2 / 5, 255};
  EXPECT_EQ(
      std::ranges::count_if(picture.strokes, [&shade](const Stroke& s) { return s.fill == shade; }),
      2);
}

/// A drum that turns until all of its rope has run off, and on.
SceneFile payout() {
  return parse_scene(R"({"title": "payout", "duration_s": 0.8, "view": "fit",
      "baseline": {"method": "cable", "reason": "none"},
      "bodies": [{"name": "d", "kind": "fixed_axle", "radius_m": 0.25, "mass_kg": 4,
                  "position_m": [0, 0], "driven_angular_velocity_rad_s": -7},
                 {"name": "l", "kind": "free", "radius_m": 0.15, "mass_kg": 3,
                  "position_m": [0.275, -1]}],
      "cables": [{"name": "r", "half_width_m": 0.03, "start": {"body": "l", "point_m": [0, 0.1]},
                  "wraps": [{"body": "d", "turn": "counter_clockwise"}],
                  "end": {"body": "d", "rim_angle_rad": 2, "layers": true}}]})",
                     "payout.json");
}

// The riser of a drum went with its rope: the drum got smaller in one frame.
TEST(Compose, ADrumKeepsItsRiserWhenAllHasRunOff) {
  const SceneFile file = payout();
  const Scenery scenery = set_scenery(file.scene, file.look);
  World world = make_world(file.scene, Method::pinch);
  Workspace work;
  std::size_t fewest = 99;
  double last = 0.0;  // m, how far a corner of the riser is from the axle
  for (int frame = 0; frame < 36; ++frame) {
    Picture picture;
    compose(file.scene, scenery, world, picture);
    ASSERT_GT(picture.corners.size(), 100U) << "frame " << frame;
    const double now = picture.corners[100].norm();
    if (frame > 0) {
      EXPECT_NEAR(now, last, 1e-3) << "frame " << frame;
    }
    last = now;
    fewest = std::min(fewest, world.cables[0].links.size());
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
  }
  EXPECT_EQ(fewest, 2U) << "all has run off";
}

/// m, how high a drum's riser reaches from the axle, every 52nd of a turn.
std::vector<double> riser_of(const Picture& picture, double angle) {
  std::vector<double> tops(52);
  for (const Vec2& corner : picture.corners) {
    const double place = (std::atan2(corner.y(), corner.x()) - angle) * 26.0 / std::numbers::pi;
    const double nearest = std::round(place - 0.5);
    if (std::abs(place - 0.5 - nearest) > 0.45) continue;
    double& top = tops[static_cast<std::size_t>(static_cast<int>(nearest) + 520) % 52];
    top = std::max(top, corner.norm());
  }
  return tops;
}

// When rope was wound on to it the other way, it climbed the other way in one frame.
TEST(Compose, ADrumsRiserStaysWhenRopeIsWoundTheOtherWay) {
  const SceneFile file = payout();
  const Scenery scenery = set_scenery(file.scene, file.look);
  World world = make_world(file.scene, Method::pinch);
  Workspace work;
  std::vector<double> last;
  for (int frame = 0; frame < 70; ++frame) {
    Picture picture;
    compose(file.scene, scenery, world, picture);
    const std::vector<double> now = riser_of(picture, world.angle[0]);
    for (std::size_t k = 0; k < last.size(); ++k) {
      EXPECT_NEAR(now[k], last[k], 0.006) << "frame " << frame << ", " << k;
    }
    last = now;
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(file.scene, world, work), StepStatus::ok);
  }
  ASSERT_EQ(world.cables[0].links.size(), 3U);
  EXPECT_EQ(world.cables[0].links[1].orientation, -1) << "it is wound the other way";
}

}  // namespace
}  // namespace pinchlab
