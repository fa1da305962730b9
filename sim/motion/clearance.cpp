// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/motion/clearance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// A body of a contact that moves in an interval, at any place on its way.
class OnItsWay {
 public:
  OnItsWay(World& world, const Start& start, int body)
      : world_(world),
        shape_(body),
        mover_(mover_of(world, body)),
        from_(at(world.position, mover_)),
        to_(from_),
        turned_from_(at(world.angle, mover_)),
        turned_to_(turned_from_) {
    if (is_static(at(world.bodies, mover_))) return;  // in no part, and Start has parts
    from_ = at(start.position, mover_);
    turned_from_ = at(start.angle, mover_);
  }

  Vec2 way() const { return to_ - from_; }
  /// m, by which its outline moves about the centre of what moves it, at most.
  double turning() const {
    const double reach = at(world_.bodies, shape_).radius + seat_of(world_, shape_).norm();
    return std::abs(turned_to_ - turned_from_) * reach;
  }
  /// After that share of the interval.
  void place(double share) {
    if (is_static(at(world_.bodies, mover_))) return;
    const double left = 1.0 - share;
    at(world_.position, mover_) = share == 1.0 ? to_ : Vec2(left * from_ + share * to_);
    at(world_.angle, mover_) = share == 1.0 ? turned_to_ : left * turned_from_ + share * turned_to_;
    if (shape_ != mover_) carry(world_, shape_);
  }

 private:
  World& world_;
  int shape_, mover_;
  Vec2 from_, to_;                  // m
  double turned_from_, turned_to_;  // rad
};

/// m, of the polygons of a contact; infinity: there is none.
double thinnest_of(const World& world, const Contact& contact) {
  double thinnest = infinity;
  for (const int body : {contact.a, contact.b}) {
    if (body < 0 || !is_polygon(at(world.bodies, body))) continue;
    thinnest = std::min(thinnest, inner_radius(at(world.bodies, body)));
  }
  return thinnest;
}

}  // namespace

double clearance_of(const World& world, const Contact& contact) {
  return gap_of(world, contact) - target_of(world, contact);
}

double clearance_on_way(World& world, const Start& start, const Contact& contact, double before,
                        double now, double late) {
  if (contact.touch == Touch::circles || contact.touch == Touch::piece) return now;
  std::array<OnItsWay, 2> pair{
      {{world, start, contact.a}, {world, start, contact.b >= 0 ? contact.b : contact.a}}};
  const std::span<OnItsWay> moving(pair.data(), contact.b >= 0 ? 2 : 1);
  Vec2 way = pair[0].way();
  double far = pair[0].turning();
  if (contact.b >= 0) {
    way -= pair[1].way();
    far += pair[1].turning();
  }
  far += way.norm();
  constexpr double rounding = 1e-9;
  if (before + now > (1.0 + rounding) * far) return now;  // less than what it takes to get there
  // What ends in the middle of an outline has not crossed it.
  const double thin = thinnest_of(world, contact);
  if (far <= thin) return now;
  constexpr double shortest = 1e-3;  // of the interval: as many tries are plenty
  const double least = std::max(0.5 * thin / far, shortest);
  double clearance = before;
  for (double share = 0.0;;) {
    share += std::max(clearance / far, least);
    if (share >= 1.0) break;
    for (OnItsWay& one : moving) one.place(share);
    clearance = clearance_of(world, contact);
    if (clearance < -late) break;
  }
  for (OnItsWay& one : moving) one.place(1.0);
  return clearance < -late ? clearance : now;
}

double reach_at(const World& world, int body) {
  return within_reach *
         (at(world.position, body).cwiseAbs().maxCoeff() + at(world.bodies, body).radius);
}

}  // namespace pinchlab
