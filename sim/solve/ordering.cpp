// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/ordering.h"

#include <algorithm>
#include <array>

#include "base/at.h"
#include "sim/solve/solve_scratch.h"

namespace pinchlab {

namespace {

/// The bodies of a row that it couples with other rows, or -1; where none has a third, two.
template <std::size_t most>
std::array<int, most> coupled(const PartSystem& s, std::size_t r) {
  const RowBodies& row = s.bodies[r];
  std::array<int, most> bodies{at(s.mobile, row.a) ? row.a : -1, at(s.mobile, row.b) ? row.b : -1};
  if constexpr (most > 2) {
    const ThirdBody* third = third_of(s, r);
    bodies[2] = third && at(s.mobile, third->place) ? third->place : -1;
  }
  return bodies;
}

template <std::size_t most>
void list_rows_of_bodies(const PartSystem& s, OrderScratch& scratch) {
  auto& lists = scratch.rows_of_body;
  lists.begin.assign(s.mobility.size() + 1, 0);
  const auto each = [&s](auto&& visit) {
    for (std::size_t r = 0; r < s.rows.size(); ++r) {
      for (const int body : coupled<most>(s, r)) {
        if (body >= 0) visit(body, static_cast<int>(r));
      }
    }
  };
  each([&lists](int body, int) { ++at(lists.begin, body + 1); });
  for (std::size_t b = 0; b < s.mobility.size(); ++b) lists.begin[b + 1] += lists.begin[b];
  lists.items.resize(index(lists.begin.back()));
  scratch.fill = lists.begin;
  each([&](int body, int row) { at(lists.items, at(scratch.fill, body)++) = row; });
}

/// Breadth-first order of the rows coupled with `start`, appended to `order`; neighbours by degree.
template <std::size_t most>
void breadth_first(const PartSystem& s, OrderScratch& scratch, int start, int stamp,
                   std::vector<int>& order) {
  const Lists<int>& lists = scratch.rows_of_body;
  const auto degree = [&](int row) {
    int sum = 0;
    for (const int body : coupled<most>(s, index(row))) {
      if (body >= 0) sum += at(lists.begin, body + 1) - at(lists.begin, body);
    }
    return sum;
  };
  std::size_t head = order.size();
  order.push_back(start);
  at(scratch.row_stamp, start) = stamp;
  for (; head < order.size(); ++head) {
    const std::size_t pushed = order.size();
    for (const int body : coupled<most>(s, index(order[head]))) {
      if (body < 0 || at(scratch.body_stamp, body) == stamp) continue;
      at(scratch.body_stamp, body) = stamp;
      for (int k = at(lists.begin, body); k < at(lists.begin, body + 1); ++k) {
        const int other = at(lists.items, k);
        if (at(scratch.row_stamp, other) == stamp) continue;
        at(scratch.row_stamp, other) = stamp;
        order.push_back(other);
      }
    }
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(pushed), order.end(), [&](int p, int q) {
      const int dp = degree(p), dq = degree(q);
      return dp != dq ? dp < dq : p < q;
    });
  }
}

/// Each connected group of rows is walked once from any row, to find a far end, and once from
/// there.
template <std::size_t most>
void find_order(PartSystem& s, OrderScratch& scratch) {
  const std::size_t rows = s.rows.size();
  list_rows_of_bodies<most>(s, scratch);
  scratch.row_stamp.assign(rows, 0);
  scratch.body_stamp.assign(s.mobility.size(), 0);
  s.order.clear();
  int stamp = 1;
  for (std::size_t r = 0; r < rows; ++r) {
    if (scratch.row_stamp[r] != 0) continue;
    const std::size_t begin = s.order.size();
    breadth_first<most>(s, scratch, static_cast<int>(r), stamp++, s.order);
    const int far_end = s.order.back();
    s.order.resize(begin);
    breadth_first<most>(s, scratch, far_end, stamp++, s.order);
  }
  std::reverse(s.order.begin(), s.order.end());
}

/// Whether these are the bodies that the rows couple.
bool order_stands(const PartSystem& s) {
  const std::size_t rows = s.rows.size(), thirds = s.thirds.size();
  if (s.structure.size() != 2 * (rows + thirds)) return false;
  if (s.same_rows) return true;
  for (std::size_t r = 0; r < rows; ++r) {
    const auto [a, b] = coupled<2>(s, r);
    if (s.structure[2 * r] != a || s.structure[2 * r + 1] != b) return false;
  }
  for (std::size_t k = 0; k < thirds; ++k) {
    const std::size_t i = 2 * (rows + k);
    if (s.structure[i] != s.thirds[k].row || s.structure[i + 1] != s.thirds[k].place) return false;
  }
  return true;
}

}  // namespace

void order_rows(PartSystem& s, OrderScratch& scratch) {
  if (order_stands(s)) return;
  s.structure.clear();
  s.assembled.clear();
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const auto [a, b] = coupled<2>(s, r);
    s.structure.push_back(a);
    s.structure.push_back(b);
  }
  for (const ThirdBody& third : s.thirds) {
    s.structure.push_back(third.row);
    s.structure.push_back(third.place);
  }
  if (s.thirds.empty()) {
    find_order<2>(s, scratch);
  } else {
    find_order<3>(s, scratch);
  }
}

}  // namespace pinchlab
