// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/seams.h"

#include <array>
#include <cmath>

#include "base/at.h"
#include "sim/lines.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

// Of lengths, and rad: ends of walls that are meant to be one place, and are written with ten
// digits. Far above round-off, and no gap that anything could get into.
constexpr double near = 1e-9;

/// Notes a wall that goes on from an end of another by `on` (m), where it makes a nook that is
/// narrower than that which is known. `out` is the other's unit vector towards that end.
void note_nooks(const Vec2& out, const Vec2& on, std::array<double, 2>& turned_most,
                std::array<Nook, 2>& nooks) {
  const Vec2 way = on.normalized();
  const double across = cross(out, way), along = out.dot(way);
  const bool is_straight = std::abs(across) <= near;
  if (is_straight && along < 0.0) return;  // the two lie on each other
  for (const std::size_t side : {0U, 1U}) {
    const double turned = is_straight ? 0.0 : std::atan2(side == 0 ? across : -across, along);
    if (turned < 0.0 || turned <= turned_most[side]) continue;
    turned_most[side] = turned;
    nooks[side] = {way, on.norm(), is_straight};
  }
}

/// Where the way from `from` to `to`, at these distances (m) from a line, crosses that; its end if
/// it does not.
Vec2 crossing(const Vec2& from, double distance_from, const Vec2& to, double distance_to) {
  const double share = distance_to < 0.0 ? distance_from / (distance_from - distance_to) : 1.0;
  return from + share * (to - from);
}

/// Of a point beyond the wall's `end`, `out` being the unit vector along the wall to there and
/// `length` (m) the wall's.
bool is_held_in_nook(const Vec2& end, const Vec2& out, double length,
                     const std::array<Nook, 2>& nooks, const Vec2& centre, const Vec2& point) {
  const Vec2 c = centre - end, p = point - end;
  const double sign = cross(out, c) >= 0.0 ? 1.0 : -1.0;
  const Nook& nook = nooks[sign > 0.0 ? 0U : 1U];
  if (!(nook.length > 0.0)) return false;
  if (nook.straight) return nook.way.dot(p) < 0.0;  // beside neither of the two
  const double centre_before = sign * cross(nook.way, c), before = sign * cross(nook.way, p);
  if (centre_before <= 0.0 || before > near * length) return false;
  // Past the far end of either wall the way leads round them.
  if (nook.way.dot(crossing(c, centre_before, p, before)) > nook.length) return false;
  const double above = sign * cross(out, p);
  return above >= 0.0 || -out.dot(crossing(c, sign * cross(out, c), p, above)) <= length;
}

}  // namespace

void find_extents(const std::vector<Obstacle>& obstacles, BoxTree& tree) {
  tree.clear();
  for (int w = 0; index(w) < obstacles.size(); ++w) {
    const Obstacle& wall = at(obstacles, w);
    const Vec2 room = Vec2::Constant(wall.radius + near * (wall.b - wall.a).norm());
    tree.add(wall.a.cwiseMin(wall.b) - room, wall.a.cwiseMax(wall.b) + room, w);
  }
  tree.build();
}

void join_walls(std::vector<Obstacle>& obstacles) {
  BoxTree walls;
  find_extents(obstacles, walls);
  std::vector<int> beside;
  for (Obstacle& wall : obstacles) {
    const Vec2 d = wall.b - wall.a;
    for (const std::size_t end : {0U, 1U}) {
      const Vec2& here = end == 0 ? wall.a : wall.b;
      const Vec2 room = Vec2::Constant(near * d.norm());
      walls.list(here - room, here + room, beside);
      const Vec2 out = (end == 0 ? Vec2(-d) : d).normalized();
      std::array<double, 2> turned_most{-1.0, -1.0};
      for (const int number : beside) {
        const Obstacle& other = at(obstacles, number);
        if (&other == &wall) continue;
        const double allowed = near * (d.norm() + (other.b - other.a).norm());
        if (distance_from_line(other.a, other.b, here) > allowed) continue;
        for (const Vec2& far : {other.a, other.b}) {
          if ((far - here).norm() > allowed) {
            note_nooks(out, far - here, turned_most, wall.nooks[end]);
          }
        }
      }
    }
  }
}

bool is_beside(const Obstacle& wall, const Vec2& centre, const Vec2& point) {
  const Vec2 d = wall.b - wall.a;
  const double along = d.dot(point - wall.a), square = d.squaredNorm();
  if (along >= 0.0 && along <= square) return true;
  const std::size_t end = along < 0.0 ? 0 : 1;
  if (!(wall.nooks[end][0].length > 0.0 || wall.nooks[end][1].length > 0.0)) return false;
  const double length = std::sqrt(square);
  const Vec2 out = (end == 0 ? -1.0 : 1.0) / length * d;
  return is_held_in_nook(end == 0 ? wall.a : wall.b, out, length, wall.nooks[end], centre, point);
}

bool leads_round(const Obstacle& wall, const Vec2& centre, const Vec2& point) {
  const Vec2 d = wall.b - wall.a, c = centre - wall.a;
  const double above = cross(d, c);
  const Vec2 there =
      crossing(c, std::abs(above), point - wall.a, -std::abs(cross(d, point - wall.a)));
  const double along = d.dot(there);
  if (along >= 0.0 && along <= d.squaredNorm()) return false;
  const bool left_of_way_out = (above >= 0.0) == (along > 0.0);
  return !(wall.nooks[along < 0.0 ? 0U : 1U][left_of_way_out ? 0U : 1U].length > 0.0);
}

Outside outside_of_line(const Obstacle& wall, const Vec2& centre, const Vec2& point) {
  Vec2 normal = left((wall.b - wall.a).normalized());
  if (normal.dot(centre - wall.a) < 0.0) normal = -normal;
  const double distance = normal.dot(point - wall.a);
  if (distance < 0.0 && leads_round(wall, centre, point)) return {-distance, -normal};
  return {distance, normal};
}

Outside outside_of_end(const Obstacle& wall, const Vec2& point) {
  const Vec2 from = point - nearest_on_line(wall.a, wall.b, point);
  const double distance = from.norm();
  return {distance, distance > 0.0 ? Vec2(from / distance) : Vec2(1.0, 0.0), true};
}

}  // namespace pinchlab
