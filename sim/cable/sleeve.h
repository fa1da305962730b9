// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables with mass that may slip on bodies (mass.h; bodies with a finite cable friction). What lies
// on such a disc, with half of either span beside it, turns about the disc's centre as a sleeve on
// it would: it moves along with the centre, and has an angular velocity of its own,
//     omega_s = omega + s / p,       s: slip speed, p: signed radius of the cable's centre line,
// so that its mass is inertia to the cable's own motion, and none to the disc's turning. What
// passes between the two is friction alone: solve/rubbing.h.
//
// On a polygon all that lies on it, round corners of one radius and along sides, moves at one speed
// s. Where the polygon is fixed it is as what lies on a disc of that radius: so much of a sleeve's
// mass, which is at the places z = p e of a circle, e being the cable's direction there. One that
// moves has a sleeve at each corner, about the corner's centre c (from the body's), of the velocity
//     V = v + omega left(c),   V' = v' + omega' left(c) - omega^2 c,
// and the same omega + s / p at all of them. What lies along a side between two is half at either
// end, as of any span. Discs that are shapes of a compound have their sleeves about such centres.

#include <Eigen/Core>
#include <vector>

#include "sim/world.h"

namespace pinchlab {

/// All links of a cable on one disc in succession: one, or the parts into which pinches divide it.
/// Or those at a corner of a polygon; at all corners, of one that is fixed.
struct Sleeve {
  int cable = 0, first = 0, last = 0;  // links; of a closed cable `last` may be before `first`
  int body = 0;
  bool goes_on = false;        // along a side, from the sleeve before it in the list
  Vec2 centre = Vec2::Zero();  // m, of what it turns about, from that of what moves its body
  // As it moves, and its mass, where these have been asked for.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, m/s, rad/s
  Eigen::Matrix3d mass = Eigen::Matrix3d::Zero();      // kg, kg m, kg m^2, for (x, y, angle)
};

/// Whether what lies at one link slips on along a side of a polygon to the other.
bool is_slipping_side(const World& world, const Link& from, const Link& to);

/// The same, where all of it is one sleeve.
bool is_side_of_sleeve(const World& world, const Link& from, const Link& to);

/// Whether any part of the cable is a sleeve.
bool has_sleeves(const World& world, const CableState& cable);

/// Appends a cable's sleeves, in its order. What is wound up on the body that holds the cable's end
/// is fast.
void list_sleeves(const World& world, int cable, std::vector<Sleeve>& to);

/// The spans before and after it, beyond nodes that are moored there.
int span_before(const CableState& cable, const Sleeve& sleeve);
int span_after(const CableState& cable, const Sleeve& sleeve);

/// The place in `sleeves`, which are in the order of their cables, of the one that link `link` of
/// the cable is part of, or -1.
int sleeve_at(const World& world, const std::vector<Sleeve>& sleeves, int cable, int link);

/// The sleeve that goes on from number k without end, and the one that begins so: itself mostly.
int tail_of(const std::vector<Sleeve>& sleeves, int k);
int head_of(const std::vector<Sleeve>& sleeves, int k);

/// Whether the link is part of a sleeve, or a node that is moored to one.
bool is_on_sleeve(const World& world, const CableState& cable, int link);

/// rad/s, of what lies at the link: of the sleeve, or of the body.
double turning_at(const World& world, int cable, int link);

/// m, what a link turns about, or what lies there: the centre of what moves its body, or of its
/// sleeve, which is that of the disc or of the corner that it is at, or is moored to.
Vec2 pivot_of_link(const World& world, const CableState& cable, int link);

/// Whether its centre is moved by the turning of what moves its body.
bool is_carried_round(const World& world, const Sleeve& sleeve);

/// Of what lies at a link of the cable, z off its pivot (m/s).
Vec2 velocity_at(const World& world, const CableState& cable, int link, const Vec2& z);

/// Velocity of a sleeve, with that of its centre where it was when it was listed.
Eigen::Vector3d velocity_of(const World& world, const Sleeve& sleeve);

/// Lets a sleeve slip at `speed` (m/s of material over the disc's surface, forward positive).
void set_slip(CableState& cable, const Sleeve& sleeve, Slip slip, double speed);

/// A scene says how bodies move at its start: cables that are not slack move along as they must,
/// where that is more than one speed as if they stretched evenly between.
void begin_slip(const Scene& scene, World& world);

}  // namespace pinchlab
