// SPDX-License-Identifier: GPL-3.0-or-later
// The eight demonstrations: sound under every method, and what their baselines claim.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "demos/scenes/scene_json.h"
#include "render/picture/cable_path.h"
#include "render/picture/scenery.h"
#include "sim/step.h"
#include "tests/sim/same_state.h"

namespace pinchlab {
namespace {

using testing::same_state;

struct Motion {
  // m, mean over the frames of the largest third difference of a position; of bodies that have not
  // touched a wall meanwhile, for a knock is as rough with any method
  double jerk = 0.0;
  double gap_violation = 0.0;  // m, largest
  double length_error = 0.0;   // m, largest
  std::int64_t fallbacks = 0;
  std::uint64_t hash =
      14695981039346656037u;  // FNV-1a of all positions and angles, in 0.1 mm and mrad
};

void add_to_hash(std::uint64_t& hash, double value, double unit) {
  auto rounded = static_cast<std::uint64_t>(std::llround(value / unit));
  for (int byte = 0; byte < 8; ++byte, rounded >>= 8)
    hash = (hash ^ (rounded & 0xff)) * 1099511628211u;
}

Motion play(const Scene& scene, Configuration configuration) {
  configuration.diagnostics = true;
  World world = make_world(scene, configuration);
  Workspace work;
  Motion motion;
  std::vector<std::vector<Vec2>> frames{world.position};
  std::vector<int> wall_frame(scene.bodies.size(), -4);  // the last in which the body touched one
  for (int frame = 1; frame < scene.frame_count; ++frame) {
    for (int i = 0; i < scene.steps_per_frame; ++i) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      motion.gap_violation =
          std::max(motion.gap_violation, world.diagnostics.largest_gap_violation);
      motion.length_error = std::max(motion.length_error, world.diagnostics.cable_length_error);
      for (const Contact& contact : world.contacts) {
        if (contact.wall >= 0 && contact.touching) {
          wall_frame[static_cast<std::size_t>(contact.a)] = frame;
        }
      }
    }
    frames.push_back(world.position);
    for (std::size_t b = 0; b < world.position.size(); ++b) {
      EXPECT_TRUE(world.position[b].allFinite());
      add_to_hash(motion.hash, world.position[b].x(), 1e-4);
      add_to_hash(motion.hash, world.position[b].y(), 1e-4);
      add_to_hash(motion.hash, world.angle[b], 1e-3);
    }
    if (frames.size() < 4) continue;
    double largest = 0.0;
    const std::size_t n = frames.size() - 1;
    for (std::size_t b = 0; b < world.position.size(); ++b) {
      if (frame - wall_frame[b] < 4) continue;
      largest = std::max(largest, (frames[n][b] - 3.0 * frames[n - 1][b] + 3.0 * frames[n - 2][b] -
                                   frames[n - 3][b])
                                      .norm());
    }
    motion.jerk += largest / scene.frame_count;
  }
  motion.fallbacks = world.diagnostics.fallbacks;
  return motion;
}

/// Hashes of the motions that the pair of clips shows. What changes one changes the clips: put the
/// printed value here and say so in CHANGELOG.md.
struct Golden {
  const char* name;
  std::uint64_t pinch, baseline;
};

void PrintTo(const Golden& golden, std::ostream* out) {
  *out << golden.name;
}

const Golden goldens[] = {
    {"01-roll-over", 0x386e403590a4eff2, 0x6643fdf97ec867e5},
    {"02-stack", 0xf8feeadc69e97f5b, 0x99bc292537cdf6b7},
    {"03-drop", 0x71bd50afc64b146b, 0x506cc218cee0dcd8},
    {"04-two-blocking", 0xed586bbf86aa32f4, 0x233dd9d203e1d99a},
    {"05-notch", 0x3b8969d74fd793a0, 0x3bfad9019bfe0b95},
    {"06-windlass", 0x62bbc228a41f09de, 0x9e4cc8b161dc2ea5},
    {"07-driven-roller", 0x68ce6a0b5241b8e1, 0xc7e6b5b7a971fe87},
    {"08-driven-roller-weights", 0x2765e3feb278ad96, 0x1a76d10c5b042e67},
};

class Demonstration : public ::testing::TestWithParam<Golden> {
 protected:
  SceneFile file_ =
      read_scene_file(std::string(PINCHLAB_SOURCE_DIR "/demos/") + GetParam().name + ".json");
  const Scene& scene_ = file_.scene;
};

TEST_P(Demonstration, LastsAsLongAsAParticipantWatches) {
  const double duration = static_cast<double>(scene_.frame_count) / scene_.frames_per_second;
  EXPECT_GE(duration, 4.0);
  EXPECT_LE(duration, 6.0);
}

// Within the first second something is pinched or the clips have come apart by a hundredth of the
// view, in place or at a rim: a participant must not watch two equal clips.
TEST_P(Demonstration, DiffersWithinTheFirstSecond) {
  const Scenery scenery = set_scenery(scene_, file_.look);
  const double visible = scenery.unit();  // m
  World pinch = make_world(scene_, Method::pinch), baseline = make_world(scene_, scene_.baseline);
  Workspace pinch_work, baseline_work;
  double apart = 0.0;
  for (int i = 0; i < scene_.frames_per_second * scene_.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene_, pinch, pinch_work), StepStatus::ok);
    ASSERT_EQ(step(scene_, baseline, baseline_work), StepStatus::ok);
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      apart = std::max({apart, (pinch.position[b] - baseline.position[b]).norm(),
                        scene_.bodies[b].radius * std::abs(pinch.angle[b] - baseline.angle[b])});
    }
  }
  EXPECT_GT(apart, visible);
}

// The clips are shown in loops: at the end nothing moves by more than a pixel a frame, neither a
// centre nor a rim.
TEST_P(Demonstration, EndsCalmly) {
  const double pixel = set_scenery(scene_, file_.look).unit() / 9.6;  // m, of a clip of 960 px
  for (const Method method : {Method::pinch, scene_.baseline}) {
    World world = make_world(scene_, method);
    Workspace work;
    for (int i = 0; i < (scene_.frame_count - 1) * scene_.steps_per_frame; ++i) {
      ASSERT_EQ(step(scene_, world, work), StepStatus::ok);
    }
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const double rim = scene_.bodies[b].radius * std::abs(world.angular_velocity[b]);
      EXPECT_LT(std::max(world.velocity[b].norm(), rim), scene_.frames_per_second * pixel)
          << scene_.bodies[b].name;
    }
  }
}

// Labels stand in the frame all the time.
TEST_P(Demonstration, LabelsStayInTheFrame) {
  const Scenery scenery = set_scenery(scene_, file_.look);
  for (const Method method : {Method::pinch, scene_.baseline}) {
    World world = make_world(scene_, method);
    Workspace work;
    for (int i = 0; i < scene_.frame_count * scene_.steps_per_frame; ++i) {
      ASSERT_EQ(step(scene_, world, work), StepStatus::ok);
      for (const SceneryLabel& label : scenery.labels) {
        const Vec2 centre = world.position[label.body] + label.offset;
        const Vec2 half(0.28 * scenery.text() * static_cast<double>(label.text.size()),
                        0.4 * scenery.text());
        ASSERT_TRUE(((centre - half).array() >= scenery.view.low.array()).all()) << label.text;
        ASSERT_TRUE(((centre + half).array() <= scenery.view.high.array()).all()) << label.text;
      }
    }
  }
}

TEST_P(Demonstration, PlatesOfAnchorsStandInTheFrame) {
  const Scenery scenery = set_scenery(scene_, file_.look);
  for (const Anchor& anchor : scenery.anchors) {
    const double r = anchor_radius(scenery, anchor.half_width);
    const Vec2 across(-anchor.outward.y(), anchor.outward.x());
    for (const double side : {-1.3, 0.0, 1.3}) {  // the far ends of the hatches
      const Vec2 end = anchor.point + r * (1.55 * anchor.outward + side * across);
      EXPECT_TRUE((end.array() >= scenery.view.low.array()).all()) << end.transpose();
      EXPECT_TRUE((end.array() <= scenery.view.high.array()).all()) << end.transpose();
    }
  }
}

TEST_P(Demonstration, NeverSqueezesTheCableWithPinchJoints) {
  const Motion motion = play(scene_, Method::pinch);
  double width = 1.0;
  for (const Cable& cable : scene_.cables) width = std::min(width, cable.half_width);
  EXPECT_LT(motion.gap_violation, 1e-3 * width);
  EXPECT_LT(motion.length_error, 1e-12);
  EXPECT_EQ(motion.fallbacks, 0);
}

// Plain cable joints jitter where transitional pinches occur. The yardstick is pinch_no_contact,
// under which bodies come equally close: plain joints serve as the baseline where they move as
// smoothly, and do not where they are at least three times as rough.
TEST_P(Demonstration, HasTheBaselineThatItsRoughnessAllows) {
  Configuration stand_in_method = Method::pinch_no_contact;
  stand_in_method.events =
      Events::at_steps;  // as plain joints have it: impacts located are sharper
  const double plain = play(scene_, Method::cable).jerk;
  const double stand_in = play(scene_, stand_in_method).jerk;
  RecordProperty("roughness_ratio", fmt::format("{:.3g}", plain / stand_in));
  if (scene_.baseline == Method::cable) {
    EXPECT_LT(plain, 1.2 * stand_in);
  } else {
    EXPECT_EQ(scene_.baseline, Method::pinch_no_contact);
    EXPECT_GT(plain, 3.0 * stand_in);
  }
}

TEST_P(Demonstration, MovesAlikeWithEitherDetection) {
  Configuration all_pairs;
  all_pairs.detection = Detection::all_pairs;
  World first = make_world(scene_, Method::pinch), second = make_world(scene_, all_pairs);
  Workspace first_work, second_work;
  for (int i = 0; i < scene_.frame_count * scene_.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene_, first, first_work), StepStatus::ok);
    ASSERT_EQ(step(scene_, second, second_work), StepStatus::ok);
    ASSERT_EQ(first.position, second.position) << i;
    ASSERT_EQ(first.angle, second.angle) << i;
  }
}

// Circles that were pinched are so within what gaps are right to, a share of coordinates: what was
// pinched a thousand metres from the origin was open, and 05 was off by 5 cm.
TEST_P(Demonstration, MovesAlikeAwayFromTheOrigin) {
  const Vec2 away(1000.0, 700.0);
  Scene moved = scene_;
  for (Body& body : moved.bodies) body.position += away;
  for (Wall& wall : moved.walls) {
    wall.a += away;
    wall.b += away;
  }
  for (Cable& cable : moved.cables) {
    for (Attachment* end : {&cable.start, &cable.end}) {
      if (end->body < 0) end->point += away;
    }
  }
  World here = make_world(scene_, Method::pinch), there = make_world(moved, Method::pinch);
  Workspace work_here, work_there;
  for (int i = 0; i < scene_.frames_per_second * scene_.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene_, here, work_here), StepStatus::ok);
    ASSERT_EQ(step(moved, there, work_there), StepStatus::ok);
  }
  for (std::size_t b = 0; b < here.position.size(); ++b) {
    EXPECT_LT((there.position[b] - away - here.position[b]).norm(), 1e-6) << b;
  }
}

TEST_P(Demonstration, AClearedWorkspaceChangesNoBit) {
  for (const Method method : {Method::pinch, scene_.baseline}) {
    World kept = make_world(scene_, method), cleared = kept;
    Workspace work;
    for (int i = 0; i < scene_.frame_count * scene_.steps_per_frame; ++i) {
      Workspace fresh;
      ASSERT_EQ(step(scene_, kept, work), StepStatus::ok);
      ASSERT_EQ(step(scene_, cleared, fresh), StepStatus::ok);
      ASSERT_TRUE(same_state(kept, cleared)) << i;
    }
  }
}

TEST_P(Demonstration, MovesAsItDidBefore) {
  const std::uint64_t pinch = play(scene_, Method::pinch).hash;
  const std::uint64_t baseline = play(scene_, scene_.baseline).hash;
  EXPECT_EQ(pinch, GetParam().pinch)
      << fmt::format("{} {:#018x}, {:#018x}", scene_.name, pinch, baseline);
  EXPECT_EQ(baseline, GetParam().baseline)
      << fmt::format("{} {:#018x}, {:#018x}", scene_.name, pinch, baseline);
}

INSTANTIATE_TEST_SUITE_P(All, Demonstration, ::testing::ValuesIn(goldens), [](const auto& test) {
  std::string name = test.param.name;
  for (char& c : name) c = c == '-' ? '_' : c;
  return name;
});

// Nor do a thousand metres more of a rope that is held there matter.
TEST(Demonstrations, AKilometreOfRopeChangesNothing) {
  const Scene scene = read_scene_file(PINCHLAB_SOURCE_DIR "/demos/05-notch.json").scene;
  World here = make_world(scene, Method::pinch);
  Scene longer = scene;
  longer.cables[0].start.point -= 1000.0 * here.cables[0].segments[1].direction;
  World there = make_world(longer, Method::pinch);
  Workspace work_here, work_there;
  for (int i = 0; i < scene.frames_per_second * scene.steps_per_frame; ++i) {
    ASSERT_EQ(step(scene, here, work_here), StepStatus::ok);
    ASSERT_EQ(step(longer, there, work_there), StepStatus::ok);
  }
  for (std::size_t b = 0; b < here.position.size(); ++b) {
    EXPECT_LT((there.position[b] - here.position[b]).norm(), 1e-5) << b;
  }
}

/// Where the first cable is drawn, at fixed places of its material.
std::vector<Vec2> drawn_places(const Scene& scene, const World& world, double smallest_sag) {
  std::vector<StripPoint> points;
  const CableState& cable = world.cables[0];
  append_cable_path(scene, world, cable, smallest_sag, points);
  std::vector<Vec2> places;
  std::size_t k = 1;
  constexpr int count = 500;
  for (int i = 0; i < count; ++i) {
    const double material = cable.length * (i + 0.5) / count;
    while (k + 1 < points.size() && points[k].material < material) ++k;
    const StripPoint &a = points[k - 1], &b = points[k];
    const double share = (material - a.material) / std::max(b.material - a.material, 1e-9);
    const double chord = (b.position - a.position).norm();
    places.emplace_back((1.0 - share) * a.position + share * b.position +
                        share * (1.0 - share) *
                            ((1.0 - share) * (chord * a.tangent - (b.position - a.position)) -
                             share * (chord * b.tangent - (b.position - a.position))));
  }
  return places;
}

/// By how much a place's step from a frame to the next differs from its steps before and after, at
/// most: a jump. In shares of the view.
double largest_jump(const SceneFile& file, const Configuration& method) {
  const Scenery scenery = set_scenery(file.scene, file.look);
  World world = make_world(file.scene, method);
  Workspace work;
  std::vector<std::vector<Vec2>> frames;
  double largest = 0.0;
  for (int frame = 0; frame < file.scene.frame_count; ++frame) {
    frames.push_back(drawn_places(file.scene, world, 5e-3 * scenery.unit()));
    for (std::size_t n = frames.size(), i = 0; n >= 4 && i < frames[0].size(); ++i) {
      const Vec2 before = frames[n - 3][i] - frames[n - 4][i];
      const Vec2 jump = frames[n - 2][i] - frames[n - 3][i];
      const Vec2 after = frames[n - 1][i] - frames[n - 2][i];
      largest = std::max(largest, std::min((jump - before).norm(), (jump - after).norm()));
    }
    for (int s = 0; s < file.scene.steps_per_frame; ++s) step(file.scene, world, work);
  }
  return largest / (100.0 * scenery.unit());
}

// Where a body is about to press a slack span against another, the slack is drawn on its way past
// them, before the pinch moves it there at once; and where bodies clip, the rope stays where it is
// as one of the wraps ends. What is left is a rope that goes taut (its sag is the root of its
// slack), and in 05 slack that a pinch moves into a span that bore a load.
TEST(Drawing, ARopeDoesNotJumpWhereItIsPinched) {
  const auto jump = [](const char* name, bool baseline) {
    const SceneFile file =
        read_scene_file(std::string(PINCHLAB_SOURCE_DIR "/demos/") + name + ".json");
    return largest_jump(file, baseline ? file.scene.baseline : Method::pinch);
  };
  EXPECT_LT(jump("01-roll-over", false), 0.010);
  EXPECT_LT(jump("01-roll-over", true), 0.010);
  EXPECT_LT(jump("02-stack", false), 0.010);
  EXPECT_LT(jump("05-notch", false), 0.030);
}

// With pinch joints no rope is seen to cut into a body, slack or not: its centre line keeps outside
// of the rims by its half width, within half a pixel. Bodies that hold its ends do not count.
TEST_P(Demonstration, RopesAreDrawnOutsideOfBodies) {
  const Scenery scenery = set_scenery(scene_, file_.look);
  const double pixel = scenery.unit() / 9.6;  // m, of a clip of 960 px
  World world = make_world(scene_, Method::pinch);
  Workspace work;
  const CableState& cable = world.cables[0];
  for (int frame = 0; frame < scene_.frame_count; ++frame) {
    const std::vector<Vec2> places = drawn_places(scene_, world, 5e-3 * scenery.unit());
    for (std::size_t b = 0; b < scene_.bodies.size(); ++b) {
      const int body = static_cast<int>(b);
      if (body == cable.links.front().body || body == cable.links.back().body) continue;
      const double rim = scene_.bodies[b].radius + cable.half_width;
      for (const Vec2& place : places) {
        ASSERT_GT((place - world.position[b]).norm(), rim - 0.5 * pixel)
            << "frame " << frame << ", " << scene_.bodies[b].name;
      }
    }
    for (int i = 0; i < scene_.steps_per_frame; ++i) {
      ASSERT_EQ(step(scene_, world, work), StepStatus::ok);
    }
  }
}

}  // namespace
}  // namespace pinchlab
