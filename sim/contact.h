// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Bodies that touch, or may do so within the next step.

#include <array>
#include <cstdint>

#include "sim/scene.h"

namespace pinchlab {

enum class Slip : std::int8_t { stick = 0, forward = 1, backward = -1 };

/// Which points of two bodies meet: touch.h.
enum class Touch : std::int8_t {
  circles,     // two discs, or a disc and a wall
  point_of_a,  // a corner of a, or a itself where it is a disc, meets the outline of b, or the wall
  point_of_b,  // likewise
  end_of_wall,  // meets the outline of a
  piece,  // of a hanging cable, of which a or b is a node, meets the other or the wall: pieces.h
};

/// By how much more than J v a row's condition has changed in the last interval, over its length
/// (m/s), and the backward differences of that: foresight.h.
using Curvature = std::array<double, 4>;

/// Two bodies, or a body and an obstacle, that touch or may touch within the next step. Where one
/// of them is a polygon there may be several of a pair.
struct Contact {
  int a = -1;     // body index
  int b = -1;     // body index > a, or -1: an obstacle
  int wall = -1;  // index into World::obstacles, or -1
  Touch touch = Touch::circles;
  std::int8_t point = 0;  // corner of the polygon, or end of the wall; 0 of a disc
  std::int8_t side = -1;  // of the other's outline, that a sharp corner was found on; -1: none
  std::int8_t away =
      0;  // a piece or node of a hanging cable: what is near it is nearer to what is before it
          // (-1) or after it (+1), and this bears nothing; 0: it is this
  int piece = -1;              // Touch::piece: the cable
  Vec2 normal = Vec2::Zero();  // unit, from a towards b
  double gap = 0.0;            // m, between the surfaces
  double target = 0.0;         // m, least gap allowed: the full width of a pinched cable, or 0
  int pinch_points = 0;        // cables (or turns of one) that share the contact's force
  int cable_between = -1;      // whose pinch takes the place of bare friction; -1: none
  double pressed_friction =
      0.0;                  // coefficient between a cable and what presses it without a link of its
                            // own: on to a polygon, with one, or on to layers
  int layers_cable = -1;    // whose layers are pressed, by whose thickness `target` grows; -1: none
  int slipping_cable = -1;  // pressed on to a body on which it may slip, without a link of its own
                            // for what presses; -1: none
  int slips_on = -1;        // that body, a or b;
  int slips_corner = -1;    // corner of the cable's link there, or -1;
  std::int8_t slips_way = 0;  // its orientation
  Slip slip = Slip::stick;    // of b along left(normal), where there is friction; by the active set
  bool touching = false;      // by the active set
  bool rebounds = false;      // rebounds, or hops: bears nothing until it has parted; by impact
  bool bare = false;          // it was there before, with no cable between; by find_contacts
  std::int64_t struck = -1;   // step in which it last did
  double normal_force = 0.0;  // N, of the last step, >= 0
  double tangent_force = 0.0;  // N, on b along left(normal)
  Curvature curvature{};       // of its normal row, by note_curvatures
};

}  // namespace pinchlab
