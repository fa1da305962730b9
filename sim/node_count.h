// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How many nodes a cable with mass has that leaves it open: as many as steps can follow.
//
// Nodes a distance l apart on a cable of rho kg a metre and tension T swing fastest where each goes
// against the next: omega = 2 sqrt(T / rho) / l. The step takes tensions at its start, so that
// omega h must be below 2; and steps are divided where it is above 1, or above sqrt(2) of a cable
// between two points (cable/waves.h). So pieces are no shorter than
//
//     l = 2 h sqrt(T / rho) / (omega h),   with T the greatest tension that is to be expected.
//
// Between two points that stand that is the tension with which the cable hangs there, and omega h
// is sqrt(2). What an end that moves bears, M with the cable itself, swings about the other end, a
// length L away: at the lowest point T = M (g + v^2 / L). v^2 is that of the height it may fall
// through and the speed that it has; at least 2 g L, as of what is let go level, so that T is 3 M g
// or more; and omega h is 1, as it may jerk.
//
// Their number is even. Of a chain that hangs between two points at one height the node in the
// middle is the lowest place then, 0.5 / n^2 (taut) to about 1 / n^2 of the sag too low; with an
// odd number the middle is a level piece, and what nodes show of the sag lacks l^2 / 8 of the
// curvature.
//
// One that runs over bodies hangs between any two of its links. Of what hangs on it, at its ends or
// in its bights, it bears the heaviest, M with the cable itself, and swings it about the next link:
// 3 M g or more as above. Where all stands a span of the chord c sags by c sqrt(3 e / 8), as a
// parabola does, for the share e of its length that is slack, and so
//
//     T = W / (8 sqrt(3 e / 8)),  or T_0 + (EA W^2 / 24)^(1/3) of one that stretches, the less,
//
// with W its weight across the chord, half of which its upper end bears beside, and all that is
// along the chord; T_0 is what it is stretched with from the start.
//
// What catches a cable that is slack, a motor, or a body that falls on it may pull harder: then
// steps are divided.

#include <span>
#include <string>
#include <vector>

#include "base/at.h"
#include "sim/scene.h"

namespace pinchlab {

/// Of a cable that leaves it open: 200 pieces cost a row each and show its sag to 1 / n^2 of it,
/// 2.5e-5. Whoever wants more says so.
constexpr int most_nodes_chosen = 199;

/// Whether an end of a cable is on a body that can move.
inline bool end_moves(const Scene& scene, const Attachment& end) {
  return end.body >= 0 && can_move(at(scene.bodies, end.body));
}

/// What a cable is to expect that leaves the number of its nodes open.
struct Expected {
  double length = 0.0;   // m
  double tension = 0.0;  // N, the greatest
  double phase = 1.0;    // omega h, under that tension, at most; as above
};

/// The same of each of these cables, which spread_nodes is to give nodes; none comes twice. The
/// scene's other cables count as they are before that. Throws SceneError where one that runs over
/// bodies cannot be laid.
std::vector<Expected> expected_of(const Scene& scene, std::span<const std::size_t> cables);

/// m, that pieces between nodes must be longer than: the cable's width; of one in layers four times
/// that, as drums take hold of nodes half a width away and give them off at twice that or more. And
/// in words.
double least_piece(const Cable& cable);
std::string words_for_least_piece(const Cable& cable);

/// How many pieces such a cable is made of: as many as the scene says, or as steps can follow, an
/// even number. Throws SceneError where they do not fit, or bend faster than steps can follow.
int count_pieces(const Scene& scene, const Cable& cable, const Expected& expected,
                 const std::string& place);

}  // namespace pinchlab
