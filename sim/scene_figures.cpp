// SPDX-License-Identifier: GPL-3.0-or-later
// Every field of a scene by itself, and the indices by which fields refer to one another.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/at.h"
#include "sim/cable/held.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/scene_checks.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"

namespace pinchlab {

namespace {

constexpr double rounding = 1e-9;  // of lengths that follow from others, as a share

/// In the scene; put into words only where it is told, as a scene may have many.
struct Place {
  const char* list;  // or a field, with its slash
  int item = -1;

  operator std::string() const { return item < 0 ? list : pointer(list, index(item)); }
};

void refuse(bool wrong, const Place& place, const char* message) {
  if (wrong) throw SceneError(place, message);
}

/// Of numbers so small that they are rounded to fewer digits the reciprocal overflows.
bool positive(double x) {
  return x > 0.0 && std::isnormal(x);
}

bool at_least_0(double x) {
  return x >= 0.0 && x < infinity;
}

template <class Item>
bool is_in(const std::vector<Item>& items, int i) {
  return i >= 0 && index(i) < items.size();
}

void refuse_impossible_outline(const BodyProperties& body, const Place& place) {
  refuse(!std::all_of(body.corners.begin(), body.corners.end(),
                      [](const Vec2& corner) { return corner.allFinite(); }) ||
             !at_least_0(body.corner_radius),
         place, "corners and their radius must be finite");
  if (body.corners.size() < 3 || body.corners.size() > most_corners) {
    throw SceneError(place, fmt::format("a polygon has 3 to {} corners", most_corners));
  }
  refuse(
      !is_convex(body.corners), place,
      "the corners must go round a convex polygon counter-clockwise, with none on a straight side");
  const Vec2 centre = plate_of(body.corners, body.corner_radius).centre;
  // Corners that are written with six digits have their centre so near.
  if (!(centre.norm() <= 1e-6 * body.radius)) {
    throw SceneError(
        place, fmt::format("corners are given from the centre of mass, which lies at [{}, {}] of "
                           "these; take that away from each",
                           centre.x(), centre.y()));
  }
  double furthest = 0.0;
  for (const Vec2& corner : body.corners) furthest = std::max(furthest, corner.norm());
  refuse(!(std::abs(furthest + body.corner_radius - body.radius) <= rounding * body.radius), place,
         "a polygon's radius must be that of the circle that holds it (make_polygon)");
  refuse(!body.inertia && body.carrier < 0, place, "a polygon needs its inertia (make_polygon)");
}

/// What bodies and walls have in common.
void refuse_impossible_surface(double friction, double restitution, const Place& place) {
  refuse(!at_least_0(friction), place, "the contact friction must be a number of at least 0");
  refuse(!(restitution >= 0.0 && restitution <= 1.0), place, "the restitution must be 0 to 1");
}

/// A shape of a compound is carried along by a body before it.
void refuse_impossible_shape(const Scene& scene, int b, const Place& place) {
  const Body& shape = at(scene.bodies, b);
  const bool carried =
      shape.carrier >= 0 && shape.carrier < b && !at(scene.bodies, shape.carrier).outlined &&
      at(scene.bodies, shape.carrier).carrier == -1 && shape.mass == 0.0 && shape.outlined;
  refuse(!carried, place,
         "a shape without mass needs a body before it that is no shape (add_shapes)");
  refuse(!shape.seat.allFinite() || !std::isfinite(shape.seat_angle), place,
         "the seat of a shape must be finite");
  const Body& compound = at(scene.bodies, shape.carrier);
  refuse(shape.kind != (is_static(compound) ? BodyKind::fixed : BodyKind::free), place,
         "a shape is fixed where the body that carries it never moves, and free elsewhere");
  refuse(shape.driven_angular_velocity || !shape.motor.empty() || shape.torque != 0.0, place,
         "a shape has no motor: the body that carries it has");
  refuse(!(shape.seat.norm() + shape.radius <= compound.radius * (1.0 + rounding)), place,
         "the radius of the body that carries it must reach round the shape (add_shapes)");
}

void refuse_impossible_mass(const Body& body, const Place& place) {
  if (body.kind == BodyKind::fixed) {
    refuse(!at_least_0(body.mass), place, "the mass must be a number of at least 0");
  } else if (body.node) {
    refuse(!positive(body.mass), place, "the mass must be a number above 0");
  } else if (!(body.mass >= lightest_body && body.mass <= heaviest_body)) {
    throw SceneError(place,
                     fmt::format("the mass must be {:g} to {:g} kg", lightest_body, heaviest_body));
  }
  refuse(body.inertia && !positive(*body.inertia), place, "the inertia must be a number above 0");
  refuse(body.kind != BodyKind::fixed && !positive(inertia_of(body)), place,
         "the inertia of such a disc is nothing; give it one, or more mass or radius");
}

void refuse_impossible_motor(const Body& body, const Place& place) {
  refuse(!std::isfinite(body.driven_angular_velocity.value_or(0.0)) || !std::isfinite(body.torque),
         place, "driven angular velocity and torque must be finite");
  refuse(!positive(body.torque_limit) && body.torque_limit != infinity, place,
         "a motor's torque limit must be above 0");
  for (std::size_t i = 0; i < body.motor.size(); ++i) {
    const MotorPoint& point = body.motor[i];
    const double before = i == 0 ? 0.0 : body.motor[i - 1].time;
    refuse(!std::isfinite(point.value) || !(point.time < infinity) ||
               !(i == 0 ? point.time >= 0.0 : point.time > before),
           place, "a motor's table must have finite values at ascending times from 0 on");
  }
}

void refuse_impossible_body(const Scene& scene, int b) {
  const Body& body = at(scene.bodies, b);
  const Place place{"bodies", b};
  refuse(body.kind != BodyKind::free && body.kind != BodyKind::rail &&
             body.kind != BodyKind::fixed_axle && body.kind != BodyKind::fixed,
         place, "the kind must be free, rail, fixed_axle or fixed");
  refuse(!positive(body.radius), place, "the radius must be a number above 0");
  refuse(!body.position.allFinite() || !body.velocity.allFinite(), place,
         "position and velocity must be finite");
  refuse(!std::isfinite(body.angle) || !std::isfinite(body.angular_velocity), place,
         "angle and angular velocity must be finite");
  if (is_polygon(body)) refuse_impossible_outline(body, place);
  if (body.carrier == -1) {
    refuse_impossible_mass(body, place);
  } else {
    refuse_impossible_shape(scene, b, place);
  }
  refuse(body.node && (is_polygon(body) || body.carrier != -1), place,
         "a node of a cable is a disc, and no shape");
  refuse_impossible_motor(body, place);
  refuse(!at_least_0(body.linear_drag) || !at_least_0(body.angular_drag), place,
         "drag must be a number of at least 0");
  refuse(!(body.cable_friction >= 0.0), place, "the cable friction must be at least 0");
  refuse_impossible_surface(body.contact_friction, body.restitution, place);
  refuse(body.kind == BodyKind::rail && !(std::abs(body.rail_axis.norm() - 1.0) <= rounding), place,
         "the rail's axis must be a unit vector");
}

/// A single segment that nothing hits.
bool is_straight(const Cable& cable) {
  return cable.rod || cable.piece || cable.joint != Joint::none;
}

void refuse_impossible_cable_mass(const Cable& cable, const Place& place) {
  refuse(cable.bending_stiffness != 0.0, place,
         "a cable that bends needs its nodes (spread_nodes)");
  refuse(cable.nodes != 0 && cable.first_node < 0, place,
         "nodes are of a cable with mass that has got them (spread_nodes)");
  refuse(cable.node_tolerance != 0.0 && !(cable.first_node >= 0 && cable.node_tolerance > 0.0 &&
                                          cable.node_tolerance < infinity && !cable.closed &&
                                          cable.axial_stiffness == infinity),
         place,
         "a node tolerance is of a cable with mass that neither stretches nor is closed, and has "
         "got its nodes "
         "(spread_nodes)");
  refuse(!at_least_0(cable.contact_friction), place,
         "the contact friction must be a number of at least 0");
  refuse(!at_least_0(cable.linear_drag), place, "drag must be a number of at least 0");
  if (cable.mass_per_metre == 0.0) return;
  refuse(!positive(cable.mass_per_metre), place,
         "the mass of a metre must be a number of at least 0");
  refuse(becomes_nodes(cable), place, "a cable with mass needs its nodes (spread_nodes)");
  const bool elastic = cable.axial_stiffness < infinity;
  refuse(
      (cable.start.layers || cable.end.layers) && cable.nodes != 0 && elastic, place,
      "a cable that hangs in nodes and stretches cannot lie in layers, which take it as if it did "
      "not; leave out its nodes, its axial stiffness or the layers");
}

void refuse_impossible_figures_of(const Cable& cable, const Place& place) {
  refuse(!positive(cable.half_width), place, "the half width must be a number above 0");
  refuse(!positive(cable.axial_stiffness) && cable.axial_stiffness != infinity, place,
         "the axial stiffness must be above 0");
  refuse(!std::isfinite(cable.slack) || (cable.slack < 0.0 && cable.axial_stiffness == infinity),
         place, "the slack must be at least 0, or below that of an elastic cable");
  refuse(!at_least_0(cable.damping), place, "the damping must be at least 0");
  refuse(!(cable.squeeze >= 0.0 && cable.squeeze <= 1.0), place, "squeeze must be 0 to 1");
  refuse(!(cable.grip >= 0.0 && cable.grip <= 1.0), place, "grip must be 0 to 1");
  refuse(cable.joint < Joint::none || cable.joint > Joint::stop, place,
         "the joint must be none, a bar, a pin, a spring or a stop");
  refuse(cable.closed && cable.wraps.size() < 2, place, "a closed cable needs two bodies");
  refuse(is_straight(cable) && (cable.closed || !cable.wraps.empty()), place,
         "rods, pieces between nodes and joints are one straight segment, which runs round no "
         "body");
}

/// `beside` is the wrap next to the end, or none.
void refuse_impossible_end(const Scene& scene, const Attachment& end, const Wrap* beside,
                           const Place& place) {
  refuse(end.body != -1 && !is_in(scene.bodies, end.body), place,
         "an end is on a body that is not in the scene");
  refuse(!end.point.allFinite(), place, "an end's point must be finite");
  refuse(end.layers && (end.body < 0 || is_polygon(at(scene.bodies, end.body)) ||
                        beside == nullptr || beside->body != end.body),
         place, "layers belong to an end on a disc's rim that the cable runs round beside it");
}

void refuse_impossible_wrap(const Scene& scene, const Wrap& wrap, const Place& place) {
  refuse(!is_in(scene.bodies, wrap.body), place, "it runs round a body that is not in the scene");
  const Body& body = at(scene.bodies, wrap.body);
  if (!body.outlined) {
    throw SceneError(place, fmt::format("body '{0}' has shapes; say which the cable runs round, "
                                        "'{0}:1' for the first",
                                        body.name));
  }
  refuse(wrap.orientation != 1 && wrap.orientation != -1, place,
         "a wrap's orientation must be 1 or -1");
  if (wrap.extra_turns < 0 || wrap.extra_turns > most_extra_turns) {
    throw SceneError(place, fmt::format("a wrap's extra turns must be 0 to {}", most_extra_turns));
  }
}

void refuse_impossible_course(const Scene& scene, const Cable& cable, const Place& place) {
  const std::vector<Wrap>& wraps = cable.wraps;
  for (const Wrap& wrap : wraps) refuse_impossible_wrap(scene, wrap, place);
  for (std::size_t i = cable.closed ? 0 : 1; i < wraps.size(); ++i) {
    refuse(wraps[i].body == wraps[(i + wraps.size() - 1) % wraps.size()].body, place,
           "two wraps in succession are on one body; give one of them extra turns instead");
  }
  if (cable.closed) return;
  const Wrap* first = wraps.empty() ? nullptr : &wraps.front();
  const Wrap* last = wraps.empty() ? nullptr : &wraps.back();
  refuse_impossible_end(scene, cable.start, first, place);
  refuse_impossible_end(scene, cable.end, last, place);
  const int body = cable.start.body;
  refuse(body >= 0 && cable.end.body == body &&
             std::all_of(wraps.begin(), wraps.end(),
                         [body](const Wrap& wrap) { return wrap.body == body; }),
         place, "it is on one body alone, where it can do nothing");
}

/// Pieces bend against one another about the node between them.
void refuse_impossible_bend(const Scene& scene, std::size_t c, const Place& place) {
  const Cable& cable = scene.cables[c];
  refuse(!at_least_0(cable.bend), place, "what it bends by must be a number of at least 0");
  if (cable.bends_with == -1) return;
  refuse(!is_in(scene.cables, cable.bends_with), place,
         "it bends against a cable that is not in the scene");
  const Cable& next = at(scene.cables, cable.bends_with);
  refuse(!is_straight(cable) || !is_straight(next) || cable.end.body < 0 ||
             !can_move(at(scene.bodies, cable.end.body)) || next.start.body != cable.end.body ||
             index(cable.bends_with) == c,
         place, "it bends against a cable that is no piece that goes on from its node");
}

/// Nodes that are strung on a cable (spread_nodes).
void refuse_impossible_strung_nodes(const Scene& scene, const Cable& cable, const Place& place) {
  if (cable.first_node == -1) return;
  bool are_nodes = cable.mass_per_metre > 0.0 && cable.nodes > 0 && cable.first_node >= 0 &&
                   index(cable.first_node) + index(cable.nodes) <= scene.bodies.size();
  for (int k = 0; are_nodes && k < cable.nodes; ++k) {
    const Body& node = at(scene.bodies, cable.first_node + k);
    are_nodes = node.node && node.kind == BodyKind::fixed && !node.outlined;
  }
  refuse(!are_nodes, place,
         "its nodes are not in the scene, one after another, as spread_nodes "
         "leaves them");
}

void refuse_impossible_cable(const Scene& scene, std::size_t c) {
  const Cable& cable = scene.cables[c];
  const Place place{"cables", static_cast<int>(c)};
  refuse_impossible_strung_nodes(scene, cable, place);
  refuse_impossible_figures_of(cable, place);
  refuse_impossible_cable_mass(cable, place);
  refuse_impossible_course(scene, cable, place);
  refuse_impossible_bend(scene, c, place);
}

void refuse_impossible_wall(const Scene& scene, std::size_t w) {
  const Wall& wall = scene.walls[w];
  const Place place{"walls", static_cast<int>(w)};
  refuse(!positive((wall.b - wall.a).norm()), place, "the wall must have a length");
  refuse_impossible_surface(wall.contact_friction, wall.restitution, place);
}

/// `bodies` is where the nodes of chains before it end. The cables have been checked.
void refuse_impossible_chain(const Scene& scene, std::size_t i, int bodies) {
  const NodeChain& chain = scene.chains[i];
  const Place place{"chains", static_cast<int>(i)};
  refuse(!positive(chain.piece_length) || !positive(chain.mass_per_metre) ||
             !positive(chain.tolerance),
         place, "length and mass of its pieces and their tolerance must be numbers above 0");
  refuse(scene.gravity == Vec2::Zero(), place, "nodes come and go by gravity, and there is none");
  const bool fits = chain.pieces >= 2 && std::has_single_bit(static_cast<unsigned>(chain.pieces)) &&
                    is_in(scene.cables, chain.cable) && chain.first_body >= bodies &&
                    chain.first_piece >= 0 &&
                    index(chain.first_body) + index(chain.pieces) - 1 <= scene.bodies.size() &&
                    index(chain.first_piece) + index(chain.pieces) - 1 <= scene.cables.size();
  refuse(!fits, place, "its pieces and nodes are not in the scene, two or a power of it");
  for (int k = 0; k < chain.pieces; ++k) {
    const Cable& piece = at(scene.cables, piece_of(chain, k));
    const int before = k > 0 ? node_before(chain, k) : piece.start.body;
    const int after = k + 1 < chain.pieces ? node_before(chain, k + 1) : piece.end.body;
    refuse(!piece.piece || piece.start.body != before || piece.end.body != after, place,
           "its pieces do not follow one another from node to node");
    if (k == 0) continue;
    const Body& node = at(scene.bodies, before);
    refuse(!node.node || node.kind != BodyKind::free, place, "one of its nodes is none");
  }
}

void refuse_impossible_view(const View& view) {
  const bool seen =
      view.low.allFinite() && view.high.allFinite() && (view.high.array() > view.low.array()).all();
  refuse(!seen, {"/view"}, "the view must be finite and its upper corner above its lower");
}

}  // namespace

void refuse_impossible_courses(const Scene& scene) {
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    refuse_impossible_course(scene, scene.cables[c], {"cables", static_cast<int>(c)});
  }
}

void refuse_impossible_figures(const Scene& scene) {
  refuse(scene.frames_per_second < 1 || scene.steps_per_frame < 1, {"/frames_per_second"},
         "frames per second and steps per frame must be at least 1");
  refuse(scene.frame_count < 1, {"/duration_s"}, "there must be at least one frame");
  refuse(!scene.gravity.allFinite(), {"/gravity_m_s2"}, "gravity must be finite");
  refuse(!at_least_0(scene.error), {"/error_m"}, "the error must be a number of at least 0");
  refuse(scene.baseline != Method::pinch && scene.baseline != Method::pinch_no_contact &&
             scene.baseline != Method::cable,
         {"/baseline"}, "the baseline must be one of the methods");
  refuse_impossible_view(scene.view);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    refuse_impossible_body(scene, static_cast<int>(b));
  }
  for (std::size_t c = 0; c < scene.cables.size(); ++c) refuse_impossible_cable(scene, c);
  for (std::size_t w = 0; w < scene.walls.size(); ++w) refuse_impossible_wall(scene, w);
  int bodies = 0;
  for (std::size_t i = 0; i < scene.chains.size(); ++i) {
    refuse_impossible_chain(scene, i, bodies);
    bodies = scene.chains[i].first_body + scene.chains[i].pieces - 1;
  }
  for (std::size_t i = 0; i < scene.apart.size(); ++i) {
    const std::array<int, 2>& pair = scene.apart[i];
    refuse(!is_in(scene.bodies, pair[0]) || !is_in(scene.bodies, pair[1]) || pair[0] >= pair[1] ||
               (i > 0 && pair <= scene.apart[i - 1]),
           {"apart", static_cast<int>(i)},
           "pairs of bodies must be in the scene, the lesser index first, and ascend "
           "(keep_apart)");
  }
}

}  // namespace pinchlab
