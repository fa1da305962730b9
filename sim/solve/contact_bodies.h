// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the rows of contacts see of their bodies' velocities: where the forces act.

#include "sim/solve/part_system.h"

namespace pinchlab {

struct Parts;
struct World;

/// Levers of a row's forces where a contact's surfaces meet, on bodies one of which is a polygon.
void set_levers(const World& world, const Contact& contact, RowBodies& bodies);

/// Levers about what carries a shape, from those about the shape's own centre.
void add_seats(const World& world, const Contact& contact, RowBodies& bodies);

/// Both forces of bare friction act at one point, a share of the gap off the surfaces, so that they
/// have no moment.
void set_tangent_bodies(const World& world, const Contact& contact, const TimeSpan& interval,
                        RowBodies& bodies);

/// By how much the speed at which a contact's surfaces slide (m/s, of b along left(normal)) changes
/// from the start of an interval, where its row stands, to the interval's middle, where it counts:
/// as the point where they meet moves along an outline that turns. 0 of circles.
double change_of_sliding(const World& world, const Contact& contact, double length);

/// What a drum that winds does to what lies on its layers, by the row of that contact's normal: it
/// lifts it, and bears the work; so does what turns the span that leaves, the third body.
void add_growth_of_layers(const World& world, const Parts& parts, const Contact& contact,
                          PartSystem& s, int r);

/// The three bodies of the row of a contact with a piece: across it, or with `along` of friction,
/// whose forces both act at one point, as those of other contacts do.
void set_bodies_at_piece(const World& world, const Parts& parts, const Contact& contact, bool along,
                         PartSystem& s, int r);

}  // namespace pinchlab
