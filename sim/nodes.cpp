// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/nodes.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"

namespace pinchlab {

namespace {

bool ends_on_mobile(const Scene& scene, const Attachment& end) {
  return end.body >= 0 && can_move(at(scene.bodies, end.body));
}

/// Directions of a chain's pieces at rest, from its start on. The tension of piece k is t_k = t_0 -
/// sum of the weights before it, and the pieces l t_k / |t_k| add up to d: where the convex function
/// sum l |t_k| - t_0 . d is least, which Newton's method finds.
std::vector<Vec2> hanging_pieces(const std::vector<Vec2>& weights, double length, const Vec2& d) {
  constexpr int most_rounds = 200;
  const std::size_t pieces = weights.size() + 1;
  Vec2 total = Vec2::Zero();
  for (const Vec2& weight : weights) total += weight;
  std::vector<Vec2> directions(pieces);
  const auto value = [&](const Vec2& start) {
    Vec2 tension = start;
    double sum = tension.norm();
    for (const Vec2& weight : weights) sum += (tension -= weight).norm();
    return length * sum - start.dot(d);
  };
  // As if all its weight hung from the middle; a thousandth of the length where the ends meet, in
  // which no tension is needed across.
  Vec2 start = 0.5 * total +
               total.norm() * d / std::max(d.norm(), 1e-3 * length * static_cast<double>(pieces));
  for (int round = 0; round < most_rounds; ++round) {
    Vec2 gradient = -d, tension = start;
    Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
    for (std::size_t k = 0; k < pieces; ++k) {
      const double norm = std::max(tension.norm(), 1e-300);  // N: nothing divides by zero
      const Vec2 u = directions[k] = tension / norm;
      gradient += length * u;
      hessian += length / norm * (Eigen::Matrix2d::Identity() - u * u.transpose());
      if (k < weights.size()) tension -= weights[k];
    }
    if (gradient.norm() <= 1e-15 * length * static_cast<double>(pieces)) break;
    const Vec2 step = -hessian.inverse() * gradient;
    if (!step.allFinite()) break;
    const double before = value(start);
    double share = 1.0;
    while (share > 1e-12 && !(value(start + share * step) <= before)) share *= 0.5;
    if (share <= 1e-12) break;
    start += share * step;
  }
  return directions;
}

/// m: bending of the shortest wave, along which nodes alternate, has omega = 4 sqrt(EI / rho) / l^2, and a
/// leapfrog is stable to omega h = 2.
double shortest_that_bends(const Scene& scene, const Cable& cable) {
  const double speed = std::sqrt(cable.bending_stiffness / cable.mass_per_metre);  // m^2/s
  return std::sqrt(2.0 * step_length(scene) * speed);
}

/// m, of each piece, where the scene leaves it open.
double shortest_piece(const Scene& scene, const Cable& cable, double length) {
  const double wave = step_length(scene) * std::sqrt(scene.gravity.norm() * length);
  return std::max({4.0 * cable.half_width, length / (most_nodes_chosen + 1.0), wave,
                   1.1 * shortest_that_bends(scene, cable)});
}

void refuse_what_has_no_nodes(const Cable& cable, const std::string& place) {
  if (!(cable.mass_per_metre < infinity) || cable.nodes < 0) {
    throw SceneError(place, "mass_per_metre_kg must be finite and nodes at least 1");
  }
  if (!(cable.bending_stiffness >= 0.0 && cable.bending_stiffness < infinity)) {
    throw SceneError(place, "the bending stiffness must be finite and at least 0");
  }
}

Body node_of(const Cable& cable, int number, const Vec2& position, double mass) {
  Body node;
  node.name = cable.name + ":" + std::to_string(number);
  node.node = true;
  node.radius = cable.half_width;
  node.mass = mass;
  constexpr double unturned = 1e9;  // nothing turns it, and friction does not roll it
  node.inertia = unturned * mass * node.radius * node.radius;
  node.position = position;
  node.contact_friction = cable.contact_friction;
  node.linear_drag = cable.linear_drag;
  return node;
}

/// How many pieces a cable of that length (m) is made of: as many as the scene says, or as steps can follow.
int count_pieces(const Scene& scene, const Cable& cable, double length, const std::string& place) {
  const int pieces =
      cable.nodes > 0
          ? cable.nodes + 1
          : std::max(2, static_cast<int>(length / shortest_piece(scene, cable, length)));
  const double piece = length / pieces;
  if (piece <= 2.0 * cable.half_width) {
    throw SceneError(
        place + "/nodes",
        fmt::format(
            "pieces of {} between nodes are no longer than the cable is wide; at most {} nodes fit",
            in_mm(piece), static_cast<int>(length / (2.0 * cable.half_width)) - 1));
  }
  if (const double least = shortest_that_bends(scene, cable); piece < least) {
    throw SceneError(
        place + "/nodes",
        fmt::format("pieces of {} between nodes bend to and fro faster than {} steps a frame "
                    "follow; at most {} nodes, or more steps a frame",
                    in_mm(piece), scene.steps_per_frame,
                    std::max(static_cast<int>(length / least) - 1, 1)));
  }
  return pieces;
}

NodedCable spread(Scene& scene, std::size_t c) {
  const Cable whole = scene.cables[c];
  const std::string place = pointer("cables", c);
  refuse_what_has_no_nodes(whole, place);
  const Vec2 from = place_of(scene, whole.start), d = place_of(scene, whole.end) - from;
  const double straight = d.norm(), length = straight + whole.slack;
  if (!(length > 0.0))
    throw SceneError(place, "the cable has no length; give it slack or move its ends apart");
  const int pieces = count_pieces(scene, whole, length, place);
  const double piece = length / pieces;
  std::vector<double> masses(index(pieces - 1), whole.mass_per_metre * piece);
  if (ends_on_mobile(scene, whole.start)) masses.front() += 0.5 * whole.mass_per_metre * piece;
  if (ends_on_mobile(scene, whole.end)) masses.back() += 0.5 * whole.mass_per_metre * piece;

  std::vector<Vec2> directions(index(pieces), straight > 0.0 ? Vec2(d / straight) : Vec2(1.0, 0.0));
  const bool hangs = whole.slack > 0.0 && scene.gravity.norm() > 0.0;
  if (hangs) {
    std::vector<Vec2> weights;
    weights.reserve(masses.size());
    for (const double mass : masses) weights.push_back(mass * scene.gravity);
    directions = hanging_pieces(weights, piece, d);
  }
  NodedCable made{static_cast<int>(c), static_cast<int>(scene.bodies.size()), pieces - 1,
                  static_cast<int>(scene.cables.size()), pieces - 1};
  Vec2 position = from;
  for (int k = 0; k < pieces; ++k) {
    Cable part = whole;
    part.mass_per_metre = 0.0;
    part.nodes = 0;
    part.rod = part.axial_stiffness == infinity || part.bending_stiffness > 0.0;
    part.bending_stiffness = 0.0;
    if (whole.bending_stiffness > 0.0 && k + 1 < pieces) {
      part.bends_with = made.first_piece + k;
      part.bend = whole.bending_stiffness / piece;
    }
    // What a straight cable has to spare, its pieces share.
    part.slack = hangs ? 0.0 : whole.slack / pieces;
    if (k > 0) {
      part.name = whole.name + ":" + std::to_string(k);
      part.start = {made.first_body + k - 1, Vec2::Zero(), false};
    }
    if (k + 1 < pieces) {
      part.end = {made.first_body + k, Vec2::Zero(), false};
      position +=
          hangs ? Vec2(piece * at(directions, k)) : Vec2(straight / pieces * at(directions, k));
      scene.bodies.push_back(node_of(whole, k + 1, position, at(masses, k)));
    }
    if (k == 0) {
      scene.cables[c] = part;
    } else {
      scene.cables.push_back(part);
    }
  }
  return made;
}

}  // namespace

std::vector<NodedCable> spread_nodes(Scene& scene) {
  std::vector<NodedCable> made;
  const std::size_t given = scene.cables.size();
  for (std::size_t c = 0; c < given; ++c) {
    if (becomes_nodes(scene.cables[c])) made.push_back(spread(scene, c));
  }
  return made;
}

}  // namespace pinchlab
