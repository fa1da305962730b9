// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/detect/broad_phase.h"
#include "sim/lines.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

/// Corners of a polygon (m) where it starts.
std::vector<Vec2> corners_of(const World& world, int body) {
  std::vector<Vec2> corners;
  for (int k = 0; index(k) < at(world.bodies, body).corners.size(); ++k) {
    corners.push_back(place_of_point(world, body, k));
  }
  return corners;
}

/// Between a line from p to q and a polygon (m); 0 where it runs into it.
double distance_to(const std::vector<Vec2>& corners, const Vec2& p, const Vec2& q) {
  double least = std::min(outside_of(corners, p).distance, outside_of(corners, q).distance);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    least = std::min(least, distance_from_line(p, q, a));
    if (lines_cross(a, b, p, q)) return 0.0;
  }
  return std::max(least, 0.0);
}

/// How far a line from p to q, which runs into a polygon, is in it (m): by the shortest way that
/// parts them, out of one of the sides or to one side of the line.
double depth_in(const std::vector<Vec2>& corners, const Vec2& p, const Vec2& q) {
  double least = infinity;
  const auto note = [&least](double depth) { least = std::min(least, depth); };
  const Vec2 across = left((q - p).normalized());
  double over = -infinity, under = -infinity;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec2 &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const Vec2 out = -left((b - a).normalized());
    note(-std::min(out.dot(p - a), out.dot(q - a)));
    over = std::max(over, across.dot(a - p));
    under = std::max(under, -across.dot(a - p));
  }
  note(over);
  note(under);
  return least;
}

/// Between the outline of a polygon and a wall (m); below 0 they overlap by that.
double gap_to_wall(const World& world, int body, const Wall& wall) {
  const std::vector<Vec2> corners = corners_of(world, body);
  const double distance = distance_to(corners, wall.a, wall.b);
  return (distance > 0.0 ? distance : -depth_in(corners, wall.a, wall.b)) -
         at(world.bodies, body).corner_radius;
}

void refuse_impossible_outline(const BodyProperties& body, const std::string& place) {
  const auto refuse = [&place](bool wrong, const std::string& message) {
    if (wrong) throw SceneError(place, message);
  };
  refuse(!std::all_of(body.corners.begin(), body.corners.end(),
                      [](const Vec2& corner) { return corner.allFinite(); }) ||
             !(body.corner_radius >= 0.0 && body.corner_radius < infinity),
         "corners and their radius must be finite");
  refuse(body.corners.size() < 3 || body.corners.size() > most_corners,
         fmt::format("a polygon has 3 to {} corners", most_corners));
  refuse(
      !is_convex(body.corners),
      "the corners must go round a convex polygon counter-clockwise, with none on a straight side");
  const Vec2 centre = plate_of(body.corners, body.corner_radius).centre;
  refuse(centre.norm() > 1e-6 * body.radius,
         fmt::format(
             "corners are given from the centre of mass, which lies at [{}, {}] of these; take "
             "that away from each",
             centre.x(), centre.y()));
  refuse(!body.inertia && body.carrier < 0, "a polygon needs its inertia (make_polygon)");
}

/// Sleeves (cable/sleeve.h) are of discs, about their centres.
void refuse_impossible_mass(const Scene& scene, const Cable& cable, const std::string& place) {
  if (cable.mass_per_metre == 0.0) return;
  const auto refuse = [&place](bool wrong, const char* message) {
    if (wrong) throw SceneError(place, message);
  };
  refuse(!(cable.mass_per_metre > 0.0 && cable.mass_per_metre < infinity),
         "the mass of a metre must be a number of at least 0");
  refuse(becomes_nodes(cable), "a cable with mass needs its nodes (spread_nodes)");
  refuse(cable.start.layers || cable.end.layers, "a cable with mass cannot lie in layers");
  refuse(cable.creep, "a cable with mass cannot creep");
  for (const Body& body : scene.bodies) {
    if (body.cable_friction == infinity) continue;
    if (body.corners.empty() && body.carrier < 0) continue;
    throw SceneError(place,
                     fmt::format("a cable with mass slips on discs only, and could on body '{}', "
                                 "which is {}; leave out the body's cable_friction, or the "
                                 "cable's mass",
                                 body.name, body.carrier < 0 ? "a polygon" : "a shape of another"));
  }
}

void refuse(bool wrong, const std::string& place, const char* message) {
  if (wrong) throw SceneError(place, message);
}

bool positive(double x) {
  return x > 0.0 && x < infinity;
}

bool at_least_0(double x) {
  return x >= 0.0 && x < infinity;
}

/// What bodies and walls have in common.
void refuse_impossible_surface(double friction, double restitution, const std::string& place) {
  refuse(!at_least_0(friction), place, "the contact friction must be a number of at least 0");
  refuse(!(restitution >= 0.0 && restitution <= 1.0), place, "the restitution must be 0 to 1");
}

void refuse_impossible_body(const Scene& scene, int b) {
  const Body& body = at(scene.bodies, b);
  const std::string place = pointer("bodies", index(b));
  refuse(!positive(body.radius), place, "the radius must be a number above 0");
  if (is_polygon(body)) refuse_impossible_outline(body, place);
  const bool carried = body.carrier != -1;
  refuse(!positive(body.mass) && body.kind != BodyKind::fixed && !carried, place,
         "the mass must be a number above 0");
  refuse(carried && (body.carrier < 0 || body.carrier >= b || body.mass != 0.0 ||
                     at(scene.bodies, body.carrier).outlined ||
                     at(scene.bodies, body.carrier).carrier != -1),
         place, "a shape without mass needs a body before it that is no shape (add_shapes)");
  refuse(body.inertia && !positive(*body.inertia), place, "the inertia must be a number above 0");
  refuse(!body.position.allFinite() || !body.velocity.allFinite(), place,
         "position and velocity must be finite");
  refuse(!std::isfinite(body.angle) || !std::isfinite(body.angular_velocity) ||
             !std::isfinite(body.driven_angular_velocity.value_or(0.0)) ||
             !std::isfinite(body.torque),
         place, "angle, angular velocity and torque must be finite");
  refuse(!at_least_0(body.linear_drag) || !at_least_0(body.angular_drag), place,
         "drag must be a number of at least 0");
  refuse(!(body.cable_friction >= 0.0), place, "the cable friction must be at least 0");
  refuse_impossible_surface(body.contact_friction, body.restitution, place);
  refuse(!(body.torque_limit > 0.0), place, "a motor's torque limit must be above 0");
  for (std::size_t i = 0; i < body.motor.size(); ++i) {
    const MotorPoint& point = body.motor[i];
    const double before = i == 0 ? 0.0 : body.motor[i - 1].time;
    refuse(!std::isfinite(point.value) || !(point.time < infinity) ||
               !(i == 0 ? point.time >= 0.0 : point.time > before),
           place, "a motor's table must have finite values at ascending times from 0 on");
  }
  constexpr double rounding = 1e-9;
  refuse(body.kind == BodyKind::rail && !(std::abs(body.rail_axis.norm() - 1.0) <= rounding), place,
         "the rail's axis must be a unit vector");
}

void refuse_impossible_cable(const Scene& scene, std::size_t c) {
  const Cable& cable = scene.cables[c];
  const std::string place = pointer("cables", c);
  refuse(!positive(cable.half_width), place, "the half width must be a number above 0");
  refuse(!(cable.axial_stiffness > 0.0), place, "the axial stiffness must be above 0");
  refuse(!std::isfinite(cable.slack) || (cable.slack < 0.0 && cable.axial_stiffness == infinity),
         place, "the slack must be at least 0, or below that of an elastic cable");
  refuse(cable.creep && (cable.axial_stiffness == infinity || cable.rod), place,
         "only an elastic cable creeps");
  const int bodies = static_cast<int>(scene.bodies.size());
  const int cables = static_cast<int>(scene.cables.size());
  refuse(cable.bending_stiffness != 0.0, place,
         "a cable that bends needs its nodes (spread_nodes)");
  refuse(cable.bends_with >= cables || (cable.bends_with >= 0 && !(cable.bend >= 0.0)), place,
         "it bends against a cable that is not in the scene");
  refuse(!(cable.damping >= 0.0 && cable.damping < infinity), place,
         "the damping must be at least 0");
  refuse(!(cable.squeeze >= 0.0 && cable.squeeze <= 1.0), place, "squeeze must be 0 to 1");
  refuse(!(cable.grip >= 0.0 && cable.grip <= 1.0), place, "grip must be 0 to 1");
  refuse_impossible_mass(scene, cable, place);
  refuse(cable.closed && cable.wraps.size() < 2, place, "a closed cable needs two bodies");
  for (const Attachment* end : {&cable.start, &cable.end}) {
    const bool there = end->body >= -1 && end->body < bodies && end->point.allFinite();
    refuse(!cable.closed && !there, place, "an end is on a body that is not in the scene");
  }
  for (const Wrap& wrap : cable.wraps) {
    refuse(wrap.body < 0 || wrap.body >= bodies, place,
           "it runs round a body that is not in the scene");
    const Body& body = at(scene.bodies, wrap.body);
    if (!body.outlined) {
      throw SceneError(place, fmt::format("body '{0}' has shapes; say which the cable runs round, "
                                          "'{0}:1' for the first",
                                          body.name));
    }
    refuse(std::abs(wrap.orientation) != 1 || wrap.extra_turns < 0, place,
           "a wrap's orientation must be 1 or -1, and its extra turns at least 0");
  }
}

/// The cable of the scene's author that a node is part of, or -1: the first of the pieces that lead
/// up to it.
int cable_of_node(const Scene& scene, int node) {
  int cable = -1;
  while (node >= 0 && at(scene.bodies, node).node) {
    const auto piece =
        std::find_if(scene.cables.begin(), scene.cables.end(), [node](const Cable& candidate) {
          return candidate.end.body == node && candidate.wraps.empty() && !candidate.closed;
        });
    if (piece == scene.cables.end()) break;
    cable = static_cast<int>(piece - scene.cables.begin());
    node = piece->start.body;
  }
  return cable;
}

/// `what` is what a body overlaps, by `depth` (m). Nodes are in no scene file: of one it is told
/// what its cable does.
[[noreturn]] void refuse_overlap(const Scene& scene, int body, const std::string& what,
                                 double depth, const char* cure) {
  const int cable = cable_of_node(scene, body);
  if (cable < 0) {
    throw SceneError(pointer("bodies", index(body)),
                     fmt::format("body '{}' overlaps {} by {}; {}", at(scene.bodies, body).name,
                                 what, in_mm(depth), cure));
  }
  throw SceneError(pointer("cables", index(cable)),
                   fmt::format("as it hangs at the start the cable runs through {} ({} deep at its "
                               "node '{}'); give it another slack or other ends, or move that",
                               what, in_mm(depth), at(scene.bodies, body).name));
}

}  // namespace

void refuse_overlaps(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const BodyPair& pair : broad.body_pairs) {
    const Body &a = at(scene.bodies, pair.a), &b = at(scene.bodies, pair.b);
    const double gap = is_polygon(a) || is_polygon(b)
                           ? separation(world, pair.a, pair.b)
                           : (b.position - a.position).norm() - a.radius - b.radius;
    if (gap < -allowed) {
      const bool first = a.node && !b.node;
      refuse_overlap(scene, first ? pair.a : pair.b, name_of_body(scene, first ? pair.b : pair.a),
                     -gap, "move them apart");
    }
  }
  for (const WallPair& pair : broad.wall_pairs) {
    const Body& body = at(scene.bodies, pair.body);
    const Wall& wall = at(scene.walls, pair.wall);
    const double gap = is_polygon(body)
                           ? gap_to_wall(world, pair.body, wall)
                           : distance_from_line(wall.a, wall.b, body.position) - body.radius;
    if (gap < -allowed) {
      refuse_overlap(scene, pair.body, fmt::format("wall {}", pair.wall), -gap, "move it away");
    }
  }
}

void refuse_cables_through_bodies(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const SpanPair& pair : broad.span_pairs) {
    const CableState& cable = at(world.cables, pair.cable);
    const Segment& segment = at(cable.segments, pair.segment);
    const Body& body = at(scene.bodies, pair.body);
    const auto segment_number = index(pair.segment);
    const auto tail = index(previous_link(cable, pair.segment));
    if (cable.links[segment_number].body == pair.body || cable.links[tail].body == pair.body)
      continue;
    const double distance =
        is_polygon(body) ? distance_to(corners_of(world, pair.body), segment.tail, segment.head)
                         : distance_from_line(segment.tail, segment.head, body.position);
    const double overlap = rim_radius(body) + cable.half_width - distance;
    if (overlap > allowed) {
      throw SceneError(
          pointer("cables", index(pair.cable)),
          fmt::format("the cable runs through body '{}' ({} deep) on its way to {}; add the body "
                      "to the cable's wraps or move it",
                      body.name, in_mm(overlap),
                      name_of_body(scene, cable.links[segment_number].body)));
    }
  }
}

void refuse_squeezed_wraps(const Scene& scene, const World& world) {
  const double allowed = overlap_allowed(scene);
  for (const Contact& contact : world.contacts) {
    if (contact.b < 0) continue;  // no cable is between: refuse_overlaps has seen it
    if (contact.gap < contact.target - allowed) {
      const Body &a = at(scene.bodies, contact.a), &b = at(scene.bodies, contact.b);
      throw SceneError(
          pointer("bodies", index(contact.b)),
          fmt::format(
              "body '{}' squeezes a cable on body '{}': the gap is {} and the cable {} wide; "
              "move them apart",
              b.name, a.name, in_mm(contact.gap), in_mm(contact.target)));
    }
  }
}

void refuse_slip_of_mass(const Scene& scene, const Configuration& configuration) {
  if (configuration.solver == Solver::direct && configuration.pinch_rows == PinchRows::one) return;
  const auto slips = std::find_if(scene.bodies.begin(), scene.bodies.end(),
                                  [](const Body& body) { return body.cable_friction < infinity; });
  if (slips == scene.bodies.end()) return;
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    if (scene.cables[c].mass_per_metre == 0.0) continue;
    throw SceneError(pointer("cables", c),
                     fmt::format("a cable with mass slips by the direct solver with one row a "
                                 "pinch only, and could on body '{}'; choose that, or leave out "
                                 "the body's cable_friction or the cable's mass",
                                 slips->name));
  }
}

void refuse_impossible_figures(const Scene& scene) {
  refuse(scene.frames_per_second < 1 || scene.steps_per_frame < 1, "/frames_per_second",
         "frames per second and steps per frame must be at least 1");
  refuse(!scene.gravity.allFinite(), "/gravity_m_s2", "gravity must be finite");
  refuse(!(scene.error >= 0.0), "/error_m", "the error must be a number of at least 0");
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    refuse_impossible_body(scene, static_cast<int>(b));
  }
  for (std::size_t c = 0; c < scene.cables.size(); ++c) refuse_impossible_cable(scene, c);
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const double length = (scene.walls[w].b - scene.walls[w].a).norm();
    refuse(!positive(length), pointer("walls", w), "the wall must have a length");
    refuse_impossible_surface(scene.walls[w].contact_friction, scene.walls[w].restitution,
                              pointer("walls", w));
  }
}

}  // namespace pinchlab
