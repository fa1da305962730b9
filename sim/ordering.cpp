// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/ordering.h"

#include <algorithm>

namespace pinchlab {

namespace {

/// The body's place in its part, or -1: what it does is not up to the rows.
int mobile(const Scratch& s, int body) {
  return body >= 0 ? s.parts.mobile[static_cast<std::size_t>(body)] : -1;
}

void list_rows_of_bodies(Scratch& s, std::size_t bodies) {
  auto& lists = s.rows_of_body;
  lists.begin.assign(bodies + 1, 0);
  const auto each = [&s](auto&& visit) {
    for (std::size_t r = 0; r < s.rows.size(); ++r) {
      for (const int body : {mobile(s, s.rows[r].a), mobile(s, s.rows[r].b)}) {
        if (body >= 0) visit(static_cast<std::size_t>(body), static_cast<int>(r));
      }
    }
  };
  each([&lists](std::size_t body, int) { ++lists.begin[body + 1]; });
  for (std::size_t b = 0; b < bodies; ++b) lists.begin[b + 1] += lists.begin[b];
  lists.items.resize(static_cast<std::size_t>(lists.begin.back()));
  s.fill = lists.begin;
  each([&s, &lists](std::size_t body, int row) {
    lists.items[static_cast<std::size_t>(s.fill[body]++)] = row;
  });
}

/// Breadth-first order of the rows coupled with `start`, appended to `order`; neighbours by degree.
void breadth_first(Scratch& s, int start, int stamp, std::vector<int>& order) {
  const auto degree = [&s](int row) {
    int sum = 0;
    for (const int body : {mobile(s, s.rows[static_cast<std::size_t>(row)].a),
                           mobile(s, s.rows[static_cast<std::size_t>(row)].b)}) {
      if (body < 0) continue;
      const auto b = static_cast<std::size_t>(body);
      sum += s.rows_of_body.begin[b + 1] - s.rows_of_body.begin[b];
    }
    return sum;
  };
  std::size_t head = order.size();
  order.push_back(start);
  s.row_stamp[static_cast<std::size_t>(start)] = stamp;
  for (; head < order.size(); ++head) {
    const Row row = s.rows[static_cast<std::size_t>(order[head])];
    const std::size_t pushed = order.size();
    for (const int body : {mobile(s, row.a), mobile(s, row.b)}) {
      if (body < 0 || s.body_stamp[static_cast<std::size_t>(body)] == stamp) continue;
      s.body_stamp[static_cast<std::size_t>(body)] = stamp;
      const auto b = static_cast<std::size_t>(body);
      for (int k = s.rows_of_body.begin[b]; k < s.rows_of_body.begin[b + 1]; ++k) {
        const int other = s.rows_of_body.items[static_cast<std::size_t>(k)];
        if (s.row_stamp[static_cast<std::size_t>(other)] == stamp) continue;
        s.row_stamp[static_cast<std::size_t>(other)] = stamp;
        order.push_back(other);
      }
    }
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(pushed), order.end(), [&](int p, int q) {
      const int dp = degree(p), dq = degree(q);
      return dp != dq ? dp < dq : p < q;
    });
  }
}

/// Reverse Cuthill-McKee; each connected group of rows is walked once from any row, to find a far
/// end, and once from there.
void find_order(Scratch& s, std::size_t bodies) {
  const std::size_t rows = s.rows.size();
  list_rows_of_bodies(s, bodies);
  s.row_stamp.assign(rows, 0);
  s.body_stamp.assign(bodies, 0);
  s.order.clear();
  int stamp = 1;
  for (std::size_t r = 0; r < rows; ++r) {
    if (s.row_stamp[r] != 0) continue;
    const std::size_t begin = s.order.size();
    breadth_first(s, static_cast<int>(r), stamp++, s.order);
    const int far_end = s.order.back();
    s.order.resize(begin);
    breadth_first(s, far_end, stamp++, s.order);
  }
  std::reverse(s.order.begin(), s.order.end());
}

/// Whether these are the bodies that the rows couple.
bool has_structure(const Scratch& s, const std::vector<int>& structure) {
  if (structure.size() != 2 * s.rows.size()) return false;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    if (structure[2 * r] != mobile(s, s.rows[r].a)) return false;
    if (structure[2 * r + 1] != mobile(s, s.rows[r].b)) return false;
  }
  return true;
}

}  // namespace

void order_rows(World& world, int part) {
  Scratch& s = world.scratch;
  if (s.rows_stand && s.order.size() == s.rows.size()) return;
  const auto p = static_cast<std::size_t>(part);
  if (s.orders.size() <= p) s.orders.resize(s.parts.list.size());
  if (!has_structure(s, s.orders[p].structure)) {
    std::vector<int>& structure = s.orders[p].structure;
    structure.clear();
    for (const Row& row : s.rows) {
      structure.push_back(mobile(s, row.a));
      structure.push_back(mobile(s, row.b));
    }
    find_order(s, bodies_of(s.parts, s.parts.list[p]).size());
    s.orders[p].order = s.order;
  } else {
    s.order = s.orders[p].order;
  }
}

}  // namespace pinchlab
