// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/clearance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/pieces.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Where a body was (m, rad) when the interval began. What never moves is in no part, and Start has
/// those only.
Vec2 place_before(const World& world, const Start& start, int body) {
  const bool stands = is_static(at(world.bodies, mover_of(world, body)));
  return at(stands ? world.position : start.position, body);
}
double angle_before(const World& world, const Start& start, int body) {
  return at(is_static(at(world.bodies, body)) ? world.angle : start.angle, body);
}

/// A body that moves in an interval, at any place on its way.
class OnItsWay {
 public:
  OnItsWay() = default;
  OnItsWay(World& world, const Start& start, int body)
      : world_(&world),
        shape_(body),
        mover_(mover_of(world, body)),
        from_(place_before(world, start, mover_)),
        to_(at(world.position, mover_)),
        turned_from_(angle_before(world, start, mover_)),
        turned_to_(at(world.angle, mover_)) {}

  Vec2 way() const { return to_ - from_; }
  /// m, by which its outline, and what it holds at `offset` (m) from its centre, move at most about
  /// the centre of what moves it.
  double turning(double offset) const {
    const double reach =
        std::max(at(world_->bodies, shape_).radius, offset) + seat_of(*world_, shape_).norm();
    return std::abs(turned_to_ - turned_from_) * reach;
  }
  /// After that share of the interval.
  void place(double share) {
    if (is_static(at(world_->bodies, mover_))) return;
    const double left = 1.0 - share;
    at(world_->position, mover_) = share == 1.0 ? to_ : Vec2(left * from_ + share * to_);
    at(world_->angle, mover_) =
        share == 1.0 ? turned_to_ : left * turned_from_ + share * turned_to_;
    if (shape_ != mover_) carry(*world_, shape_);
  }

 private:
  World* world_ = nullptr;
  int shape_ = -1, mover_ = -1;
  Vec2 from_ = Vec2::Zero(), to_ = from_;       // m
  double turned_from_ = 0.0, turned_to_ = 0.0;  // rad
};

/// All that a contact's gap depends on, and by how much the two that meet move towards each other
/// in the interval, at most (m).
struct Meeters {
  std::array<OnItsWay, 3> moving;  // at most: of a piece both ends, and what touches it
  std::size_t count = 0;
  double far = 0.0;

  const OnItsWay& add(const OnItsWay& one) { return moving[count++] = one; }
  void place(double share) {
    for (std::size_t i = 0; i < count; ++i) moving[i].place(share);
  }
};

Meeters meeters_of(World& world, const Start& start, const Contact& contact) {
  Meeters all;
  Vec2 way = Vec2::Zero();  // of what touches, or of b
  const bool of_piece = contact.touch == Touch::piece;
  const int toucher = of_piece ? body_at_piece(world, contact) : contact.b;
  if (toucher >= 0) {
    const OnItsWay& one = all.add({world, start, toucher});
    way = one.way();
    all.far = one.turning(0.0);
  }
  if (!of_piece) {
    const OnItsWay& one = all.add({world, start, contact.a});
    all.far += one.turning(0.0) + (way - one.way()).norm();
    return all;
  }
  double farthest = 0.0;
  for (const Link& end : at(world.cables, contact.piece).links) {
    double moves = way.norm();
    if (end.body >= 0) {
      const OnItsWay& one = all.add({world, start, end.body});
      moves = (way - one.way()).norm() + one.turning(end.offset.norm());
    }
    farthest = std::max(farthest, moves);
  }
  all.far += farthest;
  return all;
}

/// m, of what a contact's two are, where they meet: neither is passed by in less.
double thinnest_of(const World& world, const Contact& contact) {
  double thinnest = infinity, radii = 0.0;
  for (const int body : {contact.a, contact.b}) {
    if (body < 0) continue;
    const BodyProperties& b = at(world.bodies, body);
    if (is_polygon(b)) {
      thinnest = std::min(thinnest, inner_radius(b));
    } else if (!b.node) {
      radii += b.radius;
    }
  }
  if (contact.touch == Touch::piece) return radii + at(world.cables, contact.piece).half_width;
  return thinnest + radii;
}

/// The least distance of two discs, or of a disc and a wall, on straight ways, above that at which
/// they meet (m).
double least_of_circles(const World& world, const Start& start, const Contact& contact) {
  const Vec2 before = place_before(world, start, contact.a), now = at(world.position, contact.a);
  const double radius = at(world.bodies, contact.a).radius + target_of(world, contact);
  if (contact.b < 0) {
    const Obstacle& wall = at(world.obstacles, contact.wall);
    return distance_between_lines(before, now, wall.a, wall.b) - radius - wall.radius;
  }
  const Vec2 way_before = place_before(world, start, contact.b) - before;
  const Vec2 way_now = at(world.position, contact.b) - now;
  return distance_from_line(way_before, way_now, Vec2::Zero()) - radius -
         at(world.bodies, contact.b).radius;
}

}  // namespace

double clearance_of(const World& world, const Contact& contact) {
  return gap_of(world, contact) - target_of(world, contact);
}

double clearance_on_way(World& world, const Start& start, const Contact& contact, double before,
                        double now, double late) {
  if (contact.touch == Touch::circles) {
    const double least = least_of_circles(world, start, contact);
    return least < -late ? std::min(least, now) : now;
  }
  Meeters all = meeters_of(world, start, contact);
  constexpr double rounding = 1e-9;
  // Less than what it takes to get there.
  if (before + now > (1.0 + rounding) * all.far) return now;
  // What ends in the middle of an outline has not crossed it.
  const double thin = thinnest_of(world, contact);
  if (all.far <= thin) return now;
  constexpr double shortest = 1e-3;  // of the interval: as many tries are plenty
  const double least = std::max(0.5 * thin / all.far, shortest);
  double clearance = before;
  for (double share = 0.0;;) {
    share += std::max(clearance / all.far, least);
    if (share >= 1.0) break;
    all.place(share);
    clearance = clearance_of(world, contact);
    if (clearance < -late) break;
  }
  all.place(1.0);
  return clearance < -late ? clearance : now;
}

double reach_at(const World& world, int body) {
  return within_reach *
         (at(world.position, body).cwiseAbs().maxCoeff() + at(world.bodies, body).radius);
}

}  // namespace pinchlab
