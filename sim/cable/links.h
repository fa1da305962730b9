// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Links of a cable that come and go.

#include <cstddef>
#include <span>

namespace pinchlab {

struct BodyProperties;
struct CableState;
struct Link;
struct Workspace;
struct World;

/// Whether without link i a closed cable would lie on one body only: there would be no tangent.
bool needed(const CableState& cable, std::size_t i);

/// Whether the cable has lost its wrap on a link that it rolls on and does not need.
bool has_come_off(const CableState& cable, std::size_t i);

/// Takes a cable off the body of a link, and notes that in Workspace::released.
void take_off(World& world, Workspace& work, int cable, int link);

/// Removes rolling links whose wrap is gone and merges neighbours on one body (thesis:
/// RemoveJoints). Returns whether there were any.
bool remove_links(World& world, Workspace& work);

/// Takes link i out of the cable. If its neighbours lie on one body they become one link.
void remove_link(World& world, CableState& cable, int link);

/// Puts a rolling link on `body`, or on that corner of it, into free segment i, between its tail
/// and head links, and shares the segment's material so that both parts are stretched alike
/// (thesis: AddJoints); a part that then lies along a polygon gets as much as it is long.
void insert_link(World& world, CableState& cable, std::size_t segment, int body, int corner,
                 int orientation);

/// The circle on which a cable rolls round a body, or round that corner of it: all of a new link
/// but its material.
Link rolling_link(const BodyProperties& properties, int body, int corner, int orientation,
                  double half_width);

/// A body that presses link `link`, `arc` rad after its tail.
struct NewPinch {
  int link;
  double arc;
  int body;
};

/// Splits links by middle links on the bodies that press them: i, middle, i + 2 (thesis 4.2.2). The
/// pinches are sorted by link and arc.
void insert_pinches(World& world, CableState& cable, std::span<const NewPinch> pinches);

}  // namespace pinchlab
