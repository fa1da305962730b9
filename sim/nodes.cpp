// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/nodes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/mass.h"
#include "sim/compound.h"
#include "sim/hanging.h"
#include "sim/make_world.h"
#include "sim/node_count.h"
#include "sim/outline.h"
#include "sim/scene_checks.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

void refuse_what_has_no_nodes(const Cable& cable, const std::string& place) {
  if (!(cable.mass_per_metre < infinity) || cable.nodes < automatic_nodes) {
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
  if (cable.closed) {
    throw SceneError(key, "only cables with two ends adapt their number of nodes; leave it out");
  }
  if (scene.gravity.norm() == 0.0)
    throw SceneError(key, "asks for gravity, by which it tells what motion matters; leave it out");
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

/// How far into the outline of a body the end is held (m); below 0 outside of it.
double depth_of(const Scene& scene, const Attachment& end, int body) {
  const Body& outline = at(scene.bodies, body);
  const Vec2 from_centre = place_of(scene, end) - outline.position;
  if (!is_polygon(outline)) return outline.radius - from_centre.norm();
  return outline.corner_radius -
         outside_of(outline.corners, turned(from_centre, -outline.angle)).distance;
}

/// Of a cable whose number of nodes adapts pieces reach further than the nodes that they are made
/// of, so that these may come back within the body's reach.
double reach_of_pieces(const Scene& scene, const Attachment& end, int body) {
  const Body& outline = at(scene.bodies, body);
  return (place_of(scene, end) - outline.position).norm() + outline.radius;
}

/// Nodes that are nearer along the cable to the end than the outline that holds it reaches are
/// never clear of that outline; nor is the node after them at the start, where the cable is bent.
void keep_off_end(Scene& scene, const NodedCable& made, const Cable& whole, double piece,
                  bool is_start) {
  const Attachment& end = is_start ? whole.start : whole.end;
  if (end.body < 0) return;
  const double half_width = whole.half_width;
  const bool adapts = whole.node_tolerance != 0.0;
  for (const int body : outlines_of(scene, end.body)) {
    const double reach =
        half_width + (adapts ? reach_of_pieces(scene, end, body) : depth_of(scene, end, body));
    for (int i = 1; i <= made.bodies; ++i) {
      const int node = made.first_body + (is_start ? i - 1 : made.bodies - i);
      if (i * piece > reach) {
        const bool follows = i > 1 && (i - 1) * piece <= reach;
        const Attachment centre{node, Vec2::Zero(), false};
        if (!follows || depth_of(scene, centre, body) + half_width <= 0.0) break;
      }
      keep_apart(scene, node, body);
    }
  }
}

/// A body that holds an end has the end's half piece.
void load_end(Scene& scene, const Attachment& end, double mass) {
  if (!end_moves(scene, end)) return;
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
  if (end_moves(scene, whole.start)) masses.front() += half;
  if (end_moves(scene, whole.end)) masses.back() += half;
  return masses;
}

/// Lets a cable's number of nodes adapt.
void add_chain(Scene& scene, const NodedCable& made, const Cable& whole, double piece) {
  scene.chains.push_back({made.cable, made.first_piece, made.first_body, made.pieces + 1, piece,
                          whole.mass_per_metre, whole.node_tolerance});
}

bool stands(const Scene& scene, const Attachment& end) {
  if (end.body < 0) return true;
  const Body& body = at(scene.bodies, end.body);
  return is_static(body) || (!can_move(body) && end.point == Vec2::Zero());
}

/// Straight across gravity between two points that stand, a cable that cannot stretch bears its
/// weight by no tension: a sag s asks for rho g L^2 / 8 s.
void refuse_what_cannot_sag(const Scene& scene, const Cable& cable, const Vec2& d,
                            const std::string& place) {
  constexpr double rounding = 1e-12;  // rad: of directions between places that are decimal figures
  if (cable.slack > 0.0 || cable.axial_stiffness < infinity) return;
  if (!stands(scene, cable.start) || !stands(scene, cable.end)) return;
  if (std::abs(cross(d, scene.gravity)) <= rounding * d.norm() * scene.gravity.norm()) return;
  throw SceneError(
      place + "/slack_m",
      "between two points that stand a cable with mass hangs, and no tension bears its "
      "weight where it is only as long as their distance; give it slack, or an axial "
      "stiffness");
}

/// Whether its pieces bear force both ways.
bool is_of_rods(const Cable& cable) {
  return cable.axial_stiffness == infinity || cable.bending_stiffness > 0.0;
}

/// How pieces of that length (m) hang at rest between nodes of these masses (kg). A slack one,
/// which no rod is, is shorter.
Hanging hang_pieces(const Scene& scene, const Cable& whole, const std::vector<double>& masses,
                    double piece, const Vec2& reach, const std::string& place) {
  // Without gravity it is at rest in any shape.
  const Vec2 gravity = scene.gravity.norm() > 0.0 ? scene.gravity : Vec2(0.0, -1.0);
  std::vector<Vec2> weights;
  weights.reserve(masses.size());
  for (const double mass : masses) weights.push_back(mass * gravity);
  const std::vector<double> lengths(masses.size() + 1, piece);
  if (!is_of_rods(whole)) return hang(weights, lengths, {}, {reach});
  if (auto hanging = hang_rods(weights, lengths, reach)) return *std::move(hanging);
  throw SceneError(place,
                   "finds no rest between ends that are so near to each other; move them apart, or "
                   "give the cable another number of nodes");
}

/// Piece k of the cable that `made` tells of, which has `spare` (m) to give, between its nodes.
Cable piece_of(const Cable& whole, const NodedCable& made, int k, double piece, double spare) {
  const bool is_last = k == made.pieces;
  Cable part = whole;
  part.node_tolerance = 0.0;
  part.mass_per_metre = 0.0;
  part.nodes = 0;
  part.piece = true;
  part.rod = is_of_rods(part);
  part.bending_stiffness = 0.0;
  if (whole.bending_stiffness > 0.0 && !is_last) {
    part.bends_with = made.first_piece + k;
    part.bend = whole.bending_stiffness / piece;
  }
  part.slack = spare;
  if (k > 0) {
    part.name = whole.name + ":" + std::to_string(k);
    part.start = {made.first_body + k - 1, Vec2::Zero(), false};
  }
  if (!is_last) part.end = {made.first_body + k, Vec2::Zero(), false};
  return part;
}

/// How an end moves with what holds it, by these bodies of the scene as they start.
Flow flow_at(const Scene& scene, const World& bodies, const Attachment& end) {
  if (end.body < 0) return {};
  const Vec2 lever = place_of(scene, end) - at(bodies.position, end.body);
  return {at(bodies.velocity, end.body) + at(bodies.angular_velocity, end.body) * left(lever), 0.0};
}

/// `bodies`: those of the scene, without nodes.
NodedCable spread(Scene& scene, const World& bodies, std::size_t c, Expected expected) {
  const Cable whole = scene.cables[c];
  const std::string place = pointer("cables", c);
  refuse_what_has_no_nodes(whole, place);
  if (whole.node_tolerance != 0.0) {
    refuse_what_does_not_adapt(scene, whole, place);
    refuse_ends_that_turn(scene, whole, place);
  }
  const Vec2 from = place_of(scene, whole.start), d = place_of(scene, whole.end) - from;
  const double straight = d.norm(), length = straight + whole.slack;
  expected.length = length;
  if (!(length > 0.0))
    throw SceneError(place, "the cable has no length; give it slack or move its ends apart");
  refuse_what_cannot_sag(scene, whole, d, place);
  const int pieces = count_pieces(scene, whole, expected, place);
  const double piece = length / pieces;
  const std::vector<double> masses = weigh_nodes(scene, whole, pieces, piece);
  // What a straight cable has to spare, its pieces share.
  Hanging laid;
  laid.directions.assign(index(pieces), straight > 0.0 ? Vec2(d / straight) : Vec2(1.0, 0.0));
  laid.lengths.assign(index(pieces), straight / pieces);
  const bool hangs = whole.slack > 0.0;
  if (hangs) laid = hang_pieces(scene, whole, masses, piece, d, place);
  NodedCable made{static_cast<int>(c), static_cast<int>(scene.bodies.size()), pieces - 1,
                  static_cast<int>(scene.cables.size()), pieces - 1};
  const Flow tail = flow_at(scene, bodies, whole.start), head = flow_at(scene, bodies, whole.end);
  Vec2 position = from;
  for (int k = 0; k < pieces; ++k) {
    const double spare = hangs ? piece - at(laid.lengths, k) : whole.slack / pieces;
    const Cable part = piece_of(whole, made, k, piece, spare);
    if (k + 1 < pieces) {
      const Vec2& along = at(laid.directions, k);
      position += at(laid.lengths, k) * along;
      Body& node = scene.bodies.emplace_back(node_of(whole, k + 1, position, at(masses, k)));
      node.velocity = velocity_between(tail, head, (k + 1.0) / pieces, along);
    }
    if (k == 0) {
      scene.cables[c] = part;
    } else {
      scene.cables.push_back(part);
    }
  }
  if (whole.node_tolerance != 0.0) add_chain(scene, made, whole, piece);
  keep_off_end(scene, made, whole, piece, true);
  keep_off_end(scene, made, whole, piece, false);
  return made;
}

/// Nodes for a cable that runs over bodies: they have the mass of what they have of it, which is
/// none at the start, and are on the rims until make_world strings them.
NodedCable add_strung_nodes(Scene& scene, std::size_t c, const Expected& expected) {
  constexpr double next_to_nothing = 1e-9;  // of the cable's mass along its half width
  Cable& cable = scene.cables[c];
  const std::string place = pointer("cables", c);
  refuse_what_has_no_nodes(cable, place);
  if (cable.node_tolerance != 0.0) refuse_what_does_not_adapt(scene, cable, place);
  if (cable.nodes == automatic_nodes) {
    const int pieces = count_pieces(scene, cable, expected, place);
    cable.nodes = cable.closed ? pieces : pieces - 1;
  }
  NodedCable made{static_cast<int>(c), static_cast<int>(scene.bodies.size()), cable.nodes, 0, 0};
  cable.first_node = made.first_body;
  const Cable whole = cable;
  for (int k = 0; k < whole.nodes; ++k) {
    Body node = node_of(whole, k + 1, Vec2::Zero(),
                        next_to_nothing * whole.mass_per_metre * whole.half_width);
    node.kind = BodyKind::fixed;
    node.outlined = false;
    scene.bodies.push_back(node);
  }
  return made;
}

}  // namespace

std::vector<NodedCable> spread_nodes(Scene& scene) {
  std::vector<NodedCable> made;
  const auto gets_nodes = [](const Cable& cable) {
    return becomes_nodes(cable) || becomes_strung(cable);
  };
  if (std::ranges::none_of(scene.cables, gets_nodes)) return made;
  refuse_impossible_courses(scene);
  const std::size_t count = scene.cables.size();
  std::vector<std::size_t> open;  // cables that leave the number of their nodes open
  for (std::size_t c = 0; c < count; ++c) {
    if (gets_nodes(scene.cables[c]) && scene.cables[c].nodes <= 0) open.push_back(c);
  }
  std::vector<Expected> expected(count);
  if (!open.empty()) {
    const std::vector<Expected> found = expected_of(scene, open);  // before there are nodes
    for (std::size_t i = 0; i < open.size(); ++i) expected[open[i]] = found[i];
  }
  const World bodies = bodies_of_scene(scene);
  for (std::size_t c = 0; c < count; ++c) {
    if (becomes_strung(scene.cables[c])) made.push_back(add_strung_nodes(scene, c, expected[c]));
  }
  for (std::size_t c = 0; c < count; ++c) {
    if (becomes_nodes(scene.cables[c])) made.push_back(spread(scene, bodies, c, expected[c]));
  }
  return made;
}

}  // namespace pinchlab
