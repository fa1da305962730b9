// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Where bodies and ends of walls meet the straight pieces between the nodes of hanging cables.
//
// A piece is a capsule: what is within the cable's half width of the line between its ends. What
// meets it does so with a point and a radius about it: a disc's centre, a corner of a polygon, the
// end of a wall. With the point at x, the nearest place of the line is its foot
//     (1 - s) x_tail + s x_head,     s in [0, 1],
// and the row of the contact has three bodies: the point's, and those that hold the two ends, by
// the shares 1 - s and s.
//
// Of a chain each place that is nearer to the point than those beside it is one contact. Where s is
// within (0, 1) that is the piece's. Where the chain bends away from the point at a node it may be
// the node, of the piece that ends there, which has s = 1; the contact goes from piece to node to
// piece as the point moves along the chain, all of which have one distance where they meet, and one
// row. Where the chain bends towards the point no node is such a place, and both pieces have a
// contact; what slides on over such a bend strikes the second piece at its time, like a wall.
// Other near pieces have contacts that are `away`: they bear nothing, and tell when the point comes
// to lie over them from a bend towards it.
//
// Where a chain runs round a disc over several pieces, all of them tangents of it, their forces are
// hardly known: half of each goes to either end, so that at the nodes forces that are greater and
// less in turn cancel, and pieces come off and on again in turn. Discs and rounded corners of a
// radius (to the cable's centre line) above a piece's length are met by the nodes alone, as a
// polygon's sides are. Cable sinks into them by no more than l^2 / 8 R.

#include <vector>

#include "sim/contact.h"

namespace pinchlab {

struct Obstacle;
struct World;

/// Notes which pieces meet in which nodes, and which bodies pass through which pieces:
/// World::pieces_at and World::passing. To be called where nodes have come or gone. What passes
/// through a piece holds an end of it, or passes one of its nodes by Scene::apart.
void join_pieces(const Scene& scene, World& world);

/// Notes that those bodies and walls pass through a chain's last piece which are where its end in
/// the world is at the start, by more than `allowed` (m).
void let_pass_at_ends(const Scene& scene, double allowed, World& world);

/// Finds which ends of walls stand out, so that pieces may lie over them: Obstacle::tips.
void find_tips(std::vector<Obstacle>& obstacles);

/// Whether the piece and the body, or with body = -1 the wall, are in each other's way.
bool meets_piece(const World& world, int cable, int body, int wall);

/// The node that stands for a piece in its contacts: at its tail, or else at its head; or -1.
int node_of_piece(const World& world, int cable);

/// Whether pieces meet all that could meet a node with its own disc: a disc, or a wall's end.
bool is_met_by_pieces(const World& world, int node, int body, int wall);

/// What touches a piece, of a contact with one: a body, or -1: a wall.
int body_at_piece(const World& world, const Contact& contact);

/// Where a contact with a piece has its three bodies now.
struct Foot {
  int cable = -1;             // the piece, which may be another of the chain than the contact's
  double share = 0.0;         // s
  Vec2 place = Vec2::Zero();  // m, of the point that touches it
  double radius = 0.0;        // m, about that
  Vec2 way = Vec2::Zero();    // unit, from there to the foot
  double gap = 0.0;           // m
};

/// Of a contact that is not away, along the chain from where it was found.
Foot foot_of(const World& world, const Contact& contact);

/// Of one that is away its gap where it has come over the piece from a bend towards it; else
/// infinity.
double gap_of_piece(const World& world, const Contact& contact);

/// Brings the gap and normal of a contact with a piece up to the present positions.
void measure_piece(const World& world, Contact& contact);

/// Appends the contacts of a body, or with body = -1 of the wall's ends, with a piece of gaps up to
/// `most` (m).
void append_at_piece(const World& world, int cable, int body, int wall, double most,
                     std::vector<Contact>& to);

/// Of a contact of a node with a polygon or a wall, whether the node is nearest to a corner or end
/// that pieces meet: then it is theirs.
bool is_left_to_pieces(const World& world, const Contact& contact);

/// Makes contacts that bore force those of the pieces to which they have gone on since; whether any
/// has changed.
bool follow_along_chains(const World& world, std::vector<Contact>& contacts);

}  // namespace pinchlab
