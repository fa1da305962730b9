// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/held.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// From the frame of a piece's line into the plane.
Vec2 along(const Vec2& direction, const Vec2& v) {
  return v.x() * direction + v.y() * left(direction);
}

}  // namespace

int piece_of(const NodeChain& chain, int number) {
  return number == 0 ? chain.cable : chain.first_piece + number - 1;
}

void settle_held(World& world, const NodeChain& chain, int first) {
  CableState& piece = at(world.cables, piece_of(chain, first));
  const int count = piece.pieces;
  const double l = chain.piece_length;
  Vec2 end = Vec2::Zero();
  for (int i = 0; i < count; ++i) {
    const double angle = at(world.cables, piece_of(chain, first + i)).turned;
    end += l * Vec2(std::cos(angle), std::sin(angle));
  }
  const double off = std::atan2(end.y(), end.x());
  Vec2 reached = Vec2::Zero(), sum = Vec2::Zero();
  for (int i = 0; i < count; ++i) {
    double& angle = at(world.cables, piece_of(chain, first + i)).turned;
    angle -= off;
    reached += l * Vec2(std::cos(angle), std::sin(angle));
    if (i + 1 == count) break;
    at(world.bodies, node_before(chain, first + i + 1)).seat = reached;
    sum += reached;
  }
  piece.length = end.norm();
  piece.links[1].material = piece.links[0].material + piece.length;
  piece.held = chain.mass_per_metre * l * (sum - Vec2(0.5 * (count - 1) * piece.length, 0.0));
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
    const Vec2 start = link_centre(world, piece.links[0]);
    const Vec2 direction = (link_centre(world, piece.links[1]) - start).normalized();
    for (int i = 1; i < piece.pieces; ++i) {
      const int node = node_before(chain, first + i);
      at(world.position, node) = start + along(direction, at(world.bodies, node).seat);
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
  return along(piece.segments[1].direction, piece.held);
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

Vec2 held_force(const CableState& piece, const Vec2& gravity) {
  const Segment& line = piece.segments[1];
  return gravity.dot(left(first_moment(piece))) / line.length * left(line.direction);
}

}  // namespace pinchlab
