// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Chains whose number of nodes adapts: pieces that hold the bend that they had, as rigid bodies.
//
// A piece is made of n of the finest pieces of its chain, n a power of two (CableState::pieces),
// those after the first dormant (0), and so are the nodes between them: they bear nothing, nothing
// meets them, and they are carried along. The finest keep their length l and the directions
// turned_i to the straight line between the ends that they had when they became one, so that the
// rod between these ends is c = |sum l e(turned_i)| long, a little less than n l: no cable is lost,
// and no node jumps. Half of its mass rho n l moves with either end. Where the nodes r_i really are
// off these ends' middle is its first moment
//     h = rho l (sum r_i - (n - 1) / 2 (c, 0))                     in the frame of the line, kg m,
// whose weight it has: V = -g . R(theta) h, and so n . (left(R h) . g) / c across its ends. Then
// its statics are those of the nodes, exactly: a cable that hangs at rest stays as it hangs,
// whatever becomes one. Of the kinetic energy h has no part.

#include <cmath>

#include "sim/tangent.h"
#include "sim/world.h"

namespace pinchlab {

/// From the frame of a piece's line into the plane.
inline Vec2 along_line(const Vec2& direction, const Vec2& v) {
  return v.x() * direction + v.y() * left(direction);
}

/// A piece of n of the finest: its rod's length c (m), and h / rho l in the frame of its line (m).
struct HeldLine {
  double length = 0.0;
  Vec2 moment = Vec2::Zero();
};

/// That of `count` of the finest, l (m) long. `turned(i)`, rad, of each, is changed to its own
/// direction to the line; `seat(i)`, m, is set to where the node before it is in the frame of the
/// line, but for the first.
template <typename Turned, typename Seat>
HeldLine lay_held(int count, double l, Turned turned, Seat seat) {
  Vec2 end = Vec2::Zero();
  for (int i = 0; i < count; ++i) end += l * Vec2(std::cos(turned(i)), std::sin(turned(i)));
  const double off = std::atan2(end.y(), end.x());
  Vec2 reached = Vec2::Zero(), sum = Vec2::Zero();
  for (int i = 0; i < count; ++i) {
    turned(i) -= off;
    if (i > 0) {
      seat(i) = reached;
      sum += reached;
    }
    reached += l * Vec2(std::cos(turned(i)), std::sin(turned(i)));
  }
  return {end.norm(), sum - Vec2(0.5 * (count - 1) * end.norm(), 0.0)};
}

/// Of the finest pieces, from the chain's start on.
inline int piece_of(const NodeChain& chain, int number) {
  return number == 0 ? chain.cable : chain.first_piece + number - 1;
}

/// Body of the node before that piece, which is not the first.
inline int node_before(const NodeChain& chain, int number) {
  return chain.first_body + number - 1;
}

/// Gives the piece that begins at that one its rod's length, first moment and nodes' seats, from
/// what its finest are turned by.
void settle_held(World& world, const NodeChain& chain, int first);

/// m, by which the piece is bent at most: its nodes' greatest distance from the line between its
/// ends.
double held_bend(const World& world, const NodeChain& chain, int first);

/// Places a chain's dormant nodes, and sets their velocities, by the ends of what they are part of.
void carry_held(World& world, const NodeChain& chain);

/// Such velocities by those of all bodies (m/s), which they are put among.
void carry_velocities(const World& world, const NodeChain& chain, std::vector<Vec2>& velocity);

/// Whether what holds an end of a piece has a centre that can move.
bool moves(const World& world, const Link& end);

/// Velocity of a body that holds an end of a piece at its centre, or not at all; 0 of what stands
/// (m/s).
Vec2 end_velocity(const World& world, const Link& end);

/// h in the plane (kg m).
Vec2 first_moment(const CableState& piece);

/// Of a chain's first moments, and of the mass that ends have which do not move (J): beside that of
/// bodies that do.
double potential_energy_held(const World& world, const NodeChain& chain, const Vec2& gravity);

/// Force that the weight of h (kg m, in the plane) has on the end of the line that holds it, and
/// its opposite on its start (N).
Vec2 held_force(const Vec2& moment, const Segment& line, const Vec2& gravity);

}  // namespace pinchlab
