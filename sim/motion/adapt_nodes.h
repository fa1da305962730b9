// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The number of nodes of hanging cables adapts: two pieces become one where their node has next to
// nothing to do, and one becomes two again where it has (Servin et al. 2011 adapt a cable to its
// tension; Coevoet et al. 2020 merge what moves as one rigid body). What a piece is that several
// have become, and that its place and weight are theirs, is in cable/held.h.
//
// Pieces of n of the finest each meet in the node k, of mass m = rho n l, between the ends a and b.
// Where they become one, halves of m move with a and b, with half of its momentum each:
//     v_a' = (m_a v_a + m/2 v_k) / (m_a + m/2), and b likewise.
// So mass and momentum are kept, and the angular momentum, of m at the middle between a and b,
// where the first moment counts it. The kinetic energy falls, as in any inelastic meeting, by
//     sum over a and b of 1/2 m_a (m/2) / (m_a + m/2) |v_a - v_k|^2.
// No less can be lost: two points have the moment of inertia of three about their common centre
// only if none of them is the middle one; they have m c^2 / 4 more, and at one angular momentum the
// energy falls as that rises.
//     Where one becomes two, a and b keep their velocities and give m/2 each, and the node moves as
// the middle between them does. Mass and momentum are kept again, the energy falls by
//     1/2 m |v_b - v_a|^2 / 4,
// and the angular momentum by as much as the two had too much of inertia: at one angular momentum
// the energy would rise. An end that cannot move takes its share out of the system, and gives it
// back, at rest.
//     Afterwards an impact (impact.h) fits velocities to the pieces that there are: along them, and
// only ever losing. Positions are not touched, nor is the potential energy.
//
// When. A piece of the length c under the curvature kappa sags by kappa c^2 / 8, where chords of
// lengths c_1 and c_2 that meet at the angle theta tell kappa = 2 theta / (c_1 + c_2); one that is
// alone by w c^2 / 8 T, with its weight w a metre across it. One becomes two where it would sag by
// more than the tolerance; where its ends move apart so fast, across or along, that the energy lost
// to the node's inertia would lift the node by more than that, |v_b - v_a|^2 / 8 > g tolerance;
// where it is pushed by more than its own weight, since a cable gives way; and where a body or wall
// is near, whose place on it only nodes can tell. Two become one where all of that is below half of
// its limit, the node (with the bends that both hold) within half of the tolerance of the straight
// line, and neither is pushed. The node's own swing is reckoned with as well: its motion, v^2 / 2,
// and where it is off its balance under the tensions T, by a force f across the line, f^2 / 2 k m
// with k = T_1 / c_1 + T_2 / c_2: their sum stays the same as a wave passes, so that no node goes
// each time that it turns back. So nothing comes and goes at one border.
//
// A bend that is held does not give by itself as the tension T rises. At equilibrium the least
// energy -T c - R(theta) h . g has, of a bend f times as great (to second order in it),
//     f = G / (2 T D),   D = n l - c,   G = n . g h_y   the moment's weight across.
// Where that is less than 1 for half of the last tension, the bend is let out to it, by the
// critically damped
//     f'' = (f_0 - f) w^2 - 2 w f',   w^2 = g / c:
// at no more than D g / c, so slowly that the rest of the cable hardly feels it. The ends gain
// length under at least the tension that this needs, and lose what energy is over. So a cable that
// is drawn taut becomes as long as it is.

#include "sim/world.h"

namespace pinchlab {

struct Workspace;

/// Whether a chain, or a cable that runs over bodies (adapt_spans.h), is to get other pieces at the
/// end of a step.
bool wants_other_nodes(const Scene& scene, const World& world, Workspace& work);

/// Gives them those pieces, the velocities being those of the positions' time. What the workspace
/// knows of parts and pairs is then to be found anew, and velocities are to meet the new pieces.
void change_nodes(const Scene& scene, World& world, Workspace& work);

/// Lets out bends that tension straightens, and carries dormant nodes along.
void follow_chains(const Scene& scene, World& world, const Workspace& work);

}  // namespace pinchlab
