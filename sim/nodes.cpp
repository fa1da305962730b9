// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/nodes.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"

namespace pinchlab {

namespace {

bool ends_on_mobile(const Scene& scene, const Attachment& end) {
  return end.body >= 0 && can_move(at(scene.bodies, end.body));
}

/// Directions of a chain's pieces at rest, from its start on. The tension of piece k is t_k = t_0 -
/// sum of the weights before it, and the pieces l t_k / |t_k| add up to d: where the convex
/// function sum l |t_k| - t_0 . d is least, which Newton's method finds.
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

/// m: bending of the shortest wave, along which nodes alternate, has omega = 4 sqrt(EI / rho) /
/// l^2, and a leapfrog is stable to omega h = 2.
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

/// What an end of a cable whose number of nodes adapts may be held by: it takes over the mass of
/// nodes that go.
void refuse_ends_that_turn(const Scene& scene, const Cable& cable, const std::string& place) {
  for (const Attachment* end : {&cable.start, &cable.end}) {
    if (end->body < 0 || is_static(at(scene.bodies, end->body))) continue;
    const Body& body = at(scene.bodies, end->body);
    if (end->point == Vec2::Zero() && body.carrier < 0) continue;
    throw SceneError(
        place + (end == &cable.start ? "/start" : "/end"),
        "a cable whose number of nodes adapts must be held at a body's centre, where its "
        "mass turns nothing; or give the cable a number of nodes, and no tolerance");
  }
}

void refuse_what_does_not_adapt(const Scene& scene, const Cable& cable, const std::string& place) {
  const std::string key = place + "/node_tolerance_m";
  if (!(cable.node_tolerance > 0.0 && cable.node_tolerance < infinity))
    throw SceneError(key, "must be finite and above 0");
  if (cable.axial_stiffness < infinity || cable.bending_stiffness > 0.0) {
    throw SceneError(key,
                     "only cables that neither stretch nor resist bending adapt their number of "
                     "nodes; leave out the stiffness, or the tolerance");
  }
  if (scene.gravity.norm() == 0.0)
    throw SceneError(key, "asks for gravity, by which it tells what motion matters; leave it out");
  refuse_ends_that_turn(scene, cable, place);
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

/// A power of two, as pieces become one in pairs.
int count_adaptive_pieces(const Cable& cable, int pieces, const std::string& place) {
  int power = 2;
  while (2 * power <= pieces) power *= 2;
  if (cable.nodes > 0 && power != pieces) {
    throw SceneError(place + "/nodes",
                     fmt::format("pieces of a cable whose number of nodes adapts become one in "
                                 "pairs, so that it has 1, 3, 7, 15 and so on at most; {} or {}, "
                                 "not {}",
                                 power - 1, 2 * power - 1, cable.nodes));
  }
  return power;
}

/// How many pieces a cable of that length (m) is made of: as many as the scene says, or as steps
/// can follow.
int count_pieces(const Scene& scene, const Cable& cable, double length, const std::string& place) {
  int pieces = cable.nodes > 0
                   ? cable.nodes + 1
                   : std::max(2, static_cast<int>(length / shortest_piece(scene, cable, length)));
  if (cable.node_tolerance != 0.0) pieces = count_adaptive_pieces(cable, pieces, place);
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

/// Nodes that are nearer along the cable to the body that holds an end than that is large are never
/// clear of it.
void keep_off_end(Scene& scene, const NodeChain& chain, const Attachment& end, bool is_start) {
  if (end.body < 0) return;
  for (const int body : outlines_of(scene, end.body)) {
    const Body& outline = at(scene.bodies, body);
    const double reach = (place_of(scene, end) - outline.position).norm() + outline.radius +
                         at(scene.cables, chain.cable).half_width;
    for (int i = 1; i < chain.pieces && i * chain.piece_length <= reach; ++i) {
      keep_apart(scene, chain.first_body + (is_start ? i : chain.pieces - i) - 1, body);
    }
  }
}

/// A body that holds an end has the end's half piece.
void load_end(Scene& scene, const Attachment& end, double mass) {
  if (!ends_on_mobile(scene, end)) return;
  Body& body = at(scene.bodies, end.body);
  body.inertia = inertia_of(body);
  body.mass += mass;
}

/// kg, of each node; the ends' half pieces are theirs, or of bodies that hold a cable whose number
/// of nodes adapts.
std::vector<double> weigh_nodes(Scene& scene, const Cable& whole, int pieces, double piece) {
  std::vector<double> masses(index(pieces - 1), whole.mass_per_metre * piece);
  const double half = 0.5 * whole.mass_per_metre * piece;
  if (whole.node_tolerance != 0.0) {
    load_end(scene, whole.start, half);
    load_end(scene, whole.end, half);
    return masses;
  }
  if (ends_on_mobile(scene, whole.start)) masses.front() += half;
  if (ends_on_mobile(scene, whole.end)) masses.back() += half;
  return masses;
}

/// Lets a cable's number of nodes adapt.
void add_chain(Scene& scene, const NodedCable& made, const Cable& whole, double piece) {
  scene.chains.push_back({made.cable, made.first_piece, made.first_body, made.pieces + 1, piece,
                          whole.mass_per_metre, whole.node_tolerance});
  keep_off_end(scene, scene.chains.back(), whole.start, true);
  keep_off_end(scene, scene.chains.back(), whole.end, false);
}

NodedCable spread(Scene& scene, std::size_t c) {
  const Cable whole = scene.cables[c];
  const std::string place = pointer("cables", c);
  refuse_what_has_no_nodes(whole, place);
  if (whole.node_tolerance != 0.0) refuse_what_does_not_adapt(scene, whole, place);
  const Vec2 from = place_of(scene, whole.start), d = place_of(scene, whole.end) - from;
  const double straight = d.norm(), length = straight + whole.slack;
  if (!(length > 0.0))
    throw SceneError(place, "the cable has no length; give it slack or move its ends apart");
  const int pieces = count_pieces(scene, whole, length, place);
  const double piece = length / pieces;
  const std::vector<double> masses = weigh_nodes(scene, whole, pieces, piece);
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
    part.node_tolerance = 0.0;
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
  if (whole.node_tolerance != 0.0) add_chain(scene, made, whole, piece);
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
