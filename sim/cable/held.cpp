// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/held.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

void settle_held(World& world, const NodeChain& chain, int first) {
  CableState& piece = at(world.cables, piece_of(chain, first));
  const HeldLine line = lay_held(
      piece.pieces, chain.piece_length,
      [&](int i) -> double& { return at(world.cables, piece_of(chain, first + i)).turned; },
      [&](int i) -> Vec2& { return at(world.bodies, node_before(chain, first + i)).seat; });
  piece.length = line.length;
  piece.links[1].material = piece.links[0].material + piece.length;
  piece.held = chain.mass_per_metre * chain.piece_length * line.moment;
}

double held_bend(const World& world, const NodeChain& chain, int first) {
  const CableState& piece = at(world.cables, piece_of(chain, first));
  double bend = 0.0;
  for (int i = 1; i < piece.pieces; ++i) {
    bend = std::max(bend, std::abs(at(world.bodies, node_before(chain, first + i)).seat.y()));
  }
  return bend;
}

void carry_held(World& world, const NodeChain& chain) {
  for (int first = 0; first < chain.pieces;) {
    const CableState& piece = at(world.cables, piece_of(chain, first));
    if (piece.pieces > 1) {
      const Vec2 start = link_centre(world, piece.links[0]);
      const Vec2 direction = (link_centre(world, piece.links[1]) - start).normalized();
      for (int i = 1; i < piece.pieces; ++i) {
        const int node = node_before(chain, first + i);
        at(world.position, node) = start + along_line(direction, at(world.bodies, node).seat);
      }
    }
    first += piece.pieces;
  }
  carry_velocities(world, chain, world.velocity);
}

void carry_velocities(const World& world, const NodeChain& chain, std::vector<Vec2>& velocity) {
  const auto velocity_of = [&](const Link& end) {
    return moves(world, end) ? at(velocity, end.body) : Vec2(Vec2::Zero());
  };
  for (int first = 0; first < chain.pieces;) {
    const CableState& piece = at(world.cables, piece_of(chain, first));
    if (piece.pieces > 1) {
      const Vec2 start = link_centre(world, piece.links[0]), v = velocity_of(piece.links[0]);
      const Vec2 line = link_centre(world, piece.links[1]) - start;
      const double turning = cross(line, velocity_of(piece.links[1]) - v) / line.squaredNorm();
      for (int i = 1; i < piece.pieces; ++i) {
        const int node = node_before(chain, first + i);
        at(velocity, node) = v + turning * left(at(world.position, node) - start);
      }
    }
    first += piece.pieces;
  }
}

bool moves(const World& world, const Link& end) {
  return end.body >= 0 && can_move(at(world.bodies, end.body));
}

Vec2 end_velocity(const World& world, const Link& end) {
  return moves(world, end) ? at(world.velocity, end.body) : Vec2(Vec2::Zero());
}

Vec2 first_moment(const CableState& piece) {
  return along_line(piece.segments[1].direction, piece.held);
}

double potential_energy_held(const World& world, const NodeChain& chain, const Vec2& gravity) {
  Vec2 moment = Vec2::Zero();  // kg m
  for (int first = 0; first < chain.pieces;) {
    const CableState& piece = at(world.cables, piece_of(chain, first));
    if (piece.pieces > 1) moment += first_moment(piece);
    const double half = 0.5 * chain.mass_per_metre * chain.piece_length * piece.pieces;
    for (const Link& end : piece.links) {
      if (!moves(world, end)) moment += half * link_centre(world, end);
    }
    first += piece.pieces;
  }
  return -gravity.dot(moment);
}

Vec2 held_force(const Vec2& moment, const Segment& line, const Vec2& gravity) {
  return gravity.dot(left(moment)) / line.length * left(line.direction);
}

}  // namespace pinchlab
