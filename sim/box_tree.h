// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Boxes, to find those that overlap another without asking each: an interval tree of their extents
// along the axis in which they lie further apart (Cormen, Leiserson, Rivest & Stein 2009,
// *Introduction to Algorithms*, 14.3). It lies in a sorted array, the root in its middle, and knows
// of each subtree how far it reaches, so that one box as long as all does no harm.

#include <algorithm>
#include <cstddef>
#include <vector>

#include "sim/scene.h"

namespace pinchlab {

class BoxTree {
 public:
  void clear() { nodes_.clear(); }

  /// `number` is the caller's own.
  void add(const Vec2& low, const Vec2& high, int number) {
    nodes_.push_back({low, high, high.x(), number});
  }

  /// To be called when all have been added. Allocates nothing.
  void build() {
    Vec2 low = Vec2::Constant(infinity), high = -low;
    for (const Node& node : nodes_) {
      low = low.cwiseMin(node.low);
      high = high.cwiseMax(node.high);
    }
    axis_ = high.x() - low.x() >= high.y() - low.y() ? 0 : 1;
    std::sort(nodes_.begin(), nodes_.end(), [this](const Node& p, const Node& q) {
      return p.low[axis_] != q.low[axis_] ? p.low[axis_] < q.low[axis_] : p.number < q.number;
    });
    find_reach(0, nodes_.size());
  }

  /// Whether test(number) holds of any that overlaps with the box, or touches it.
  template <class Test>
  bool any(const Vec2& low, const Vec2& high, const Test& test) const {
    return any_of(0, nodes_.size(), low, high, test);
  }

  /// Lists the numbers of those, ascending.
  void list(const Vec2& low, const Vec2& high, std::vector<int>& to) const {
    to.clear();
    any(low, high, [&to](int number) {
      to.push_back(number);
      return false;
    });
    std::sort(to.begin(), to.end());
  }

 private:
  struct Node {
    Vec2 low, high;
    double reach;  // of its subtree, along the axis
    int number;
  };

  double find_reach(std::size_t begin, std::size_t end) {
    if (begin == end) return -infinity;
    const std::size_t root = begin + (end - begin) / 2;
    Node& node = nodes_[root];
    const double beside = std::max(find_reach(begin, root), find_reach(root + 1, end));
    node.reach = std::max(node.high[axis_], beside);
    return node.reach;
  }

  template <class Test>
  bool any_of(std::size_t begin, std::size_t end, const Vec2& low, const Vec2& high,
              const Test& test) const {
    if (begin == end) return false;
    const std::size_t root = begin + (end - begin) / 2;
    const Node& node = nodes_[root];
    if (node.reach < low[axis_]) return false;
    if (any_of(begin, root, low, high, test)) return true;
    if (node.low[axis_] > high[axis_]) return false;
    const bool overlaps =
        (node.high.array() >= low.array()).all() && (node.low.array() <= high.array()).all();
    return (overlaps && test(node.number)) || any_of(root + 1, end, low, high, test);
  }

  int axis_ = 0;  // 0: x, 1: y
  std::vector<Node> nodes_;
};

}  // namespace pinchlab
