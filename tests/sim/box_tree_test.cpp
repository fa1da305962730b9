// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/box_tree.h"

#include <gtest/gtest.h>

#include <random>

#include "base/at.h"

namespace pinchlab::testing {
namespace {

struct TestBox {
  Vec2 low, high;
};

/// Boxes of very different sizes, some of no width, some as long as all; on a grid, so that many
/// touch. Along x or y.
std::vector<TestBox> random_boxes(std::mt19937& random, int count, bool upright) {
  const auto at_most = [&random](int most) { return static_cast<int>(random() % (most + 1U)); };
  std::vector<TestBox> boxes;
  for (int i = 0; i < count; ++i) {
    const int along = at_most(9) == 0 ? 200 : at_most(3), across = at_most(3);
    Vec2 low(at_most(200), at_most(20)), size(along, across);
    if (upright) {
      std::swap(low.x(), low.y());
      std::swap(size.x(), size.y());
    }
    boxes.push_back({low, low + size});
  }
  return boxes;
}

TEST(BoxTree, FindsWhatOverlaps) {
  std::mt19937 random(5);
  BoxTree tree;
  std::vector<int> found;
  for (int round = 0; round < 60; ++round) {
    const std::vector<TestBox> boxes = random_boxes(random, 2 * round, round % 2 == 0);
    tree.clear();
    for (int i = 0; index(i) < boxes.size(); ++i) tree.add(at(boxes, i).low, at(boxes, i).high, i);
    tree.build();
    for (const TestBox& asked : random_boxes(random, 20, round % 2 == 0)) {
      std::vector<int> expected;
      for (int i = 0; index(i) < boxes.size(); ++i) {
        const TestBox& box = at(boxes, i);
        if ((box.low.array() <= asked.high.array()).all() &&
            (box.high.array() >= asked.low.array()).all()) {
          expected.push_back(i);
        }
      }
      tree.list(asked.low, asked.high, found);
      EXPECT_EQ(found, expected);
    }
  }
}

// Of many boxes beside one as long as all of them a few are looked at.
TEST(BoxTree, AsksFew) {
  BoxTree tree;
  constexpr int count = 4096;
  for (int i = 0; i < count; ++i) tree.add(Vec2(i, 0.0), Vec2(i + 0.5, 1.0), i);
  tree.add(Vec2(0.0, -1.0), Vec2(count, -0.5), count);
  tree.build();
  for (int i = 0; i < count; i += 37) {
    int asked = 0;
    const bool any = tree.any(Vec2(i + 0.1, -0.9), Vec2(i + 1.2, 0.2), [&asked](int) {
      ++asked;
      return false;
    });
    EXPECT_FALSE(any);
    EXPECT_EQ(asked, i + 1 < count ? 3 : 2);
  }
}

}  // namespace
}  // namespace pinchlab::testing
