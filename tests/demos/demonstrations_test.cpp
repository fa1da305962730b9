// SPDX-License-Identifier: GPL-3.0-or-later
// The eight demonstrations: sound under every method, and what their baselines claim.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "demos/scene_json.h"
#include "sim/step.h"
#include "tests/sim/same_state.h"

namespace pinchlab {
namespace {

using testing::same_state;

struct Motion {
  double jerk = 0.0;  // m, mean over the frames of the largest third difference of a position
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

Motion play(const Scene& scene, Method method) {
  Configuration configuration = method;
  configuration.diagnostics = true;
  World world = make_world(scene, configuration);
  Workspace work;
  Motion motion;
  std::vector<std::vector<Vec2>> frames{world.position};
  for (int frame = 1; frame < scene.frame_count; ++frame) {
    for (int i = 0; i < scene.steps_per_frame; ++i) {
      EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      motion.gap_violation =
          std::max(motion.gap_violation, world.diagnostics.largest_gap_violation);
      motion.length_error = std::max(motion.length_error, world.diagnostics.cable_length_error);
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
    {"01-roll-over", 0x1c27a738a0fa418a, 0xd3e85fd1977bba25},
    {"02-stack", 0x6279f4e6a9675cd0, 0x7820a2ac0bb68cc1},
    {"03-drop", 0x9e143139d9c1c962, 0xdce3b9c0911a188e},
    {"04-two-blocking", 0x5767735f77dd3670, 0x5c556f48d9477a21},
    {"05-notch", 0x7a6a84a055f88a77, 0x871e6160ad0ad86b},
    {"06-windlass", 0x8015cba13a7140f4, 0xa7df6b8c613f189e},
    {"07-driven-roller", 0x3cf905786cf63aef, 0x5523930d78f26db7},
    {"08-driven-roller-weights", 0xaec508a92da1490d, 0xeadde69f6f8b7ccc},
};

class Demonstration : public ::testing::TestWithParam<Golden> {
 protected:
  Scene scene_ =
      read_scene_file(std::string(PINCHLAB_SOURCE_DIR "/demos/") + GetParam().name + ".json").scene;
};

TEST_P(Demonstration, LastsAsLongAsAParticipantWatches) {
  const double duration = static_cast<double>(scene_.frame_count) / scene_.frames_per_second;
  EXPECT_GE(duration, 8.0);
  EXPECT_LE(duration, 12.0);
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
  const double plain = play(scene_, Method::cable).jerk;
  const double stand_in = play(scene_, Method::pinch_no_contact).jerk;
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

}  // namespace
}  // namespace pinchlab
