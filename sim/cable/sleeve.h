// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables with mass that may slip on bodies (mass.h; bodies with a finite cable friction). What lies
// on such a disc, with half of either span beside it, turns about the disc's centre as a sleeve on
// it would: it moves along with the centre, and has an angular velocity of its own,
//     omega_s = omega + s / p,       s: slip speed, p: signed radius of the cable's centre line,
// so that its mass is inertia to the cable's own motion, and none to the disc's turning. What
// passes between the two is friction alone: solve/rubbing.h.
//
// On a polygon that is fixed all that lies on it, round corners of one radius and along sides,
// moves at one speed, as what lies on a disc of that radius does: so much of a sleeve's mass, which
// is at the places z = p e of a circle, e being the cable's direction there.

#include <Eigen/Core>
#include <vector>

#include "sim/world.h"

namespace pinchlab {

/// All links of a cable on one disc in succession: one, or the parts into which pinches divide it.
/// Or those at the corners of a polygon.
struct Sleeve {
  int cable = 0, first = 0, last = 0;  // links; of a closed cable `last` may be before `first`
  int body = 0;
  // As it moves, and its mass, where these have been asked for.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s, m/s, rad/s
  Eigen::Matrix3d mass = Eigen::Matrix3d::Zero();      // kg, kg m, kg m^2, for (x, y, angle)
};

/// Whether a sleeve goes on from one link to the other, along a side of a polygon.
bool is_slipping_side(const World& world, const Link& from, const Link& to);

/// Whether any part of the cable is a sleeve.
bool has_sleeves(const World& world, const CableState& cable);

/// Appends a cable's sleeves, in its order. What is wound up on the body that holds the cable's end
/// is fast.
void list_sleeves(const World& world, int cable, std::vector<Sleeve>& to);

/// The spans before and after it, beyond nodes that are moored there.
int span_before(const CableState& cable, const Sleeve& sleeve);
int span_after(const CableState& cable, const Sleeve& sleeve);

/// The place in `sleeves` of the one that link `link` of the cable is part of, or -1.
int sleeve_at(const World& world, const std::vector<Sleeve>& sleeves, int cable, int link);

/// rad/s, of what lies at the link: of the sleeve, or of the body.
double turning_at(const World& world, int cable, int link);

/// m, what a link turns about, or what lies there: the centre of what moves its body; of a fixed
/// polygon, on which only a sleeve moves, that of the corner which it is at, or is moored to.
Vec2 pivot_of_link(const World& world, const Link& link);

/// Velocity of a sleeve, with that of its centre.
Eigen::Vector3d velocity_of(const World& world, const Sleeve& sleeve);

/// Lets a sleeve slip at `speed` (m/s of material over the disc's surface, forward positive).
void set_slip(CableState& cable, const Sleeve& sleeve, Slip slip, double speed);

/// A scene says how bodies move at its start: cables that are not slack move along as they must,
/// from their first link on.
void begin_slip(const Scene& scene, World& world);

}  // namespace pinchlab
