// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where polygons touch discs, walls and one another.
//
// Whatever touches a polygon, one of the two does so with a point: a corner, a disc's centre, a
// wall's end (each with its radius), at some distance from the other's outline. So a pair has a
// contact for every such point that is near enough: a box that lies on a wall has two, and edge on
// edge the corners that are over the other's side. The distance is exact for any motion, and smooth
// but where the point passes the other's corner.

#include <vector>

#include "sim/contact.h"

namespace pinchlab {

struct World;

/// Whether the body's motion can change gaps: its centre moves, or it turns and is not round.
bool may_change_gaps(const BodyProperties& body);

/// Whether a body of the contact can.
bool can_give(const World& world, const Contact& contact);

/// Whether all that a contact can move is one body's turning: its normal row says all about that.
bool only_turns_one(const World& world, const Contact& contact);

/// Where a contact's two surfaces are now.
struct Meeting {
  double gap = 0.0;            // m, below 0: they overlap
  Vec2 normal = Vec2::Zero();  // unit, from a towards b
  Vec2 point = Vec2::Zero();   // m, midway between the surfaces
  double apart = 0.0;          // m, where both are round there: between their centres; else 0
  int side = -1;               // of the outline, where the point is on one and both are sharp
};

/// Whether it is with the end of a cable that is held in the world.
bool is_end_of_cable(const World& world, const Contact& contact);

/// Of a contact that is not of circles.
Meeting meeting_of(const World& world, const Contact& contact);

/// Where a corner of a polygon is, or the centre of a disc (whatever `point`).
Vec2 place_of_point(const World& world, int body, int point);

/// Of a contact of two bodies that is not of circles, what of `body` is nearest to the other: the
/// corner or the disc's centre with which it touches, or the place within its rounding that the
/// other's touches.
Vec2 nearest_place(const World& world, const Contact& contact, int body);

/// How far the place where a point touches a wall or polygon is from where its outline begins to
/// bend, for such places of bodies (m and rad, as of World): above 0 on a straight part of it,
/// below 0 round a corner, or beyond a sharp one. Infinity for contacts of anything else.
double on_straight(const World& world, const Contact& contact, const std::vector<Vec2>& position,
                   const std::vector<double>& angle);

/// Whether its point touches nothing beyond there: of sharp corners, and of a corner and a wall.
bool ends_beyond(const Contact& contact);

/// Velocity of b, or of a wall, less that of a, at that place (m/s).
Vec2 relative_velocity(const World& world, const Contact& contact, const Vec2& place);

/// Brings a contact's gap and normal up to the bodies' present positions.
void measure(const World& world, Contact& contact);

/// That gap alone (m).
double gap_of(const World& world, const Contact& contact);

/// Appends the contacts of a pair one of which is a polygon, of gaps up to `most` (m), in the order
/// of world.contacts.
void append_touches(const World& world, int a, int b, int wall, double most,
                    std::vector<Contact>& to);

/// The distance of the outlines of two bodies one of which is a polygon (m); below 0 they overlap
/// by that, along the direction in which they do least.
double separation(const World& world, int a, int b);

}  // namespace pinchlab
