// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Links and segments: geometry and transport. (How links come and go: links.h.)

#include <algorithm>

#include "base/at.h"
#include "sim/world.h"

namespace pinchlab {

struct Parts;
struct Workspace;

/// Whether a link's circle lies about its body's centre.
inline bool is_central(const Link& link) {
  return link.offset.x() == 0.0 && link.offset.y() == 0.0;
}

/// Whether one link is a node that the rim at another holds (taking_in.h).
inline bool is_moored_to(const Link& node, const Link& rim) {
  return node.moored && node.body == rim.body && rim.orientation != 0;
}

/// The link of the rim that holds a moored node.
int rim_of(const CableState& cable, int link);

/// Link::slid of a moored node, from how far the rim's material has slipped.
double slid_by(const World& world, const CableState& cable, int link);

/// Centre of a link's circle where that is off its body's centre (m).
Vec2 offset_centre(const World& world, const Link& link);

/// Centre of the circle that the cable touches at a link (m).
inline Vec2 link_centre(const World& world, const Link& link) {
  if (link.body < 0) return link.offset;
  if (!is_central(link)) return offset_centre(world, link);
  return at(world.position, link.body);
}

/// Velocity of that (m/s).
Vec2 velocity_of(const World& world, const Link& link);

/// Angle (rad) of the body that carries the link; 0 for the world.
inline double body_angle(const World& world, const Link& link) {
  return link.body >= 0 ? at(world.angle, link.body) : 0.0;
}

/// Notes that links of a cable have been inserted or removed.
inline void count_changes(World& world, CableState& cable, int count) {
  cable.changes += count;
  world.changes += count;
  cable.changed_at = world.changes;
}

/// An interval begins with the segment where it is.
inline void begin_here(Segment& segment) {
  segment.previous_tail = segment.tail;
  segment.previous_head = segment.head;
  segment.alpha_before = segment.alpha;
}

/// First segment that exists: 1 in an open cable, 0 in a closed one.
inline std::size_t first_segment(const CableState& cable) {
  return cable.closed ? 0 : 1;
}

/// Index of the link before or after `link`, around a closed cable; -1 beyond an end.
inline int previous_link(const CableState& cable, int link) {
  if (link > 0) return link - 1;
  return cable.closed ? static_cast<int>(cable.links.size()) - 1 : -1;
}
inline int next_link(const CableState& cable, int link) {
  if (link + 1 < static_cast<int>(cable.links.size())) return link + 1;
  return cable.closed ? 0 : -1;
}

/// How far apart it keeps bodies at most (m): its width, and the layers on a drum.
inline double thickness(const CableState& cable) {
  double layers = 0.0;
  if (cable.fills) {
    for (const Link& link : cable.links) layers = std::max(layers, thickness_of_layers(link));
  }
  return 2.0 * cable.half_width + layers;
}

/// Of its material, that a cable is stretched by at most: no rubber bears more. Rims take up what
/// is not stretched, so that the last of a span that vanishes has all of its stretch.
constexpr double most_strain = 10.0;

/// Material (m) that a segment of an elastic cable stretches as. Springs have no bound.
inline double elastic_material(const CableState& cable, const Segment& segment) {
  const double stretch = cable.rod ? 0.0 : segment.length - segment.rest_length;
  return std::max({segment.rest_length, stretch / most_strain, 0.0});
}

/// Material (m) that a closed pinch may hold: round-off of the cable's length.
inline double material_rounding(const CableState& cable) {
  return 1e-15 * cable.length;
}

/// Whether segments beside a pinch are to take material from it, or of a cable that stretches give
/// it what it lacks, but for `rounding` (m).
inline bool is_misfilled(const CableState& cable, const Segment& segment, double rounding) {
  const double material = segment.rest_length;
  return segment.pinched && (!(material <= rounding) || (cable.elastic && material < -rounding));
}

/// What a body that presses the cable in a pinch holds it by, as a share of the force that presses;
/// infinity: without slip. The law that it is part of: solve/friction.h.
inline double friction_in_pinch(const World& world, const CableState& cable, int body) {
  if (cable.grip == 0.0) return 0.0;  // of no slip too: 0 times infinity
  return cable.grip * at(world.bodies, body).cable_friction;
}

/// Whether bodies that pinch the cable sink into it.
inline bool yields(const CableState& cable) {
  return cable.least_gap < 2.0 * cable.half_width;
}

/// Whether it never comes to run over a body: a joint; or a piece between nodes, which bodies touch
/// (pieces.h).
inline bool is_passed(const CableState& cable) {
  return cable.rod || cable.piece || cable.joint != Joint::none;
}

/// Whether it is part of another piece of its chain (held.h).
inline bool is_dormant(const CableState& cable) {
  return cable.pieces == 0;
}

/// Whether links i and j roll in opposite senses, so that a segment between them can be pinched.
inline bool opposite(const Link& a, const Link& b) {
  return a.orientation * b.orientation < 0;
}

/// Whether a pinched span is between bodies whose centres are so far apart (m) that touch, have not
/// sunk into it, and may part.
inline bool is_let_go(const World& world, const Segment& span, const Link& tail, const Link& head,
                      double distance) {
  constexpr double rounding = 1e-9;
  if (!opposite(tail, head) || tail.pinch_middle || head.pinch_middle) return false;
  if (span.contact >= 0 && at(world.contacts, span.contact).touching) return false;
  return distance >= (1.0 - rounding) * (tail.radius + head.radius);
}

/// Whether the segment between the two only fastens the cable's end to the rim of the body that it
/// is wound on. It has no length and exerts nothing.
inline bool wound_end(const Link& a, const Link& b) {
  return a.body >= 0 && a.body == b.body && (a.orientation == 0) != (b.orientation == 0) &&
         a.corner < 0 && b.corner < 0 && !a.moored && !b.moored;
}

/// Whether the segment between the two lies along a polygon that both are on, or goes from a rim to
/// a node that it holds. It is rigid.
inline bool is_side(const Link& a, const Link& b) {
  return (a.corner >= 0 || b.corner >= 0 || a.moored || b.moored) && a.body == b.body;
}

/// Whether an end of the cable on a body is further in than on its rim.
bool is_fastened_inside(const World& world, const CableState& cable, const Link& end);

/// Whether the span that ends at link `end` is held by `body` there, and cannot be hit by it:
/// always so but for an end that is held at the body's rim, and for polygons, whose other corners
/// it may meet.
inline bool holds_span(const World& world, const CableState& cable, const Link& end, int body) {
  if (end.body != body || (end.corner >= 0 && !end.moored)) return false;
  return end.orientation != 0 || end.moored || is_fastened_inside(world, cable, end);
}

/// +1 or -1 where a link is on the drum in layers that holds the cable's start or end; or 0.
int way_of_layers(const CableState& cable, std::size_t link);

/// The number of the drum's link whose layers a contact presses (Contact::layers_cable): next to
/// one of the cable's ends.
inline int number_of_pressed_layers(const World& world, const Contact& contact) {
  const std::vector<Link>& links = at(world.cables, contact.layers_cable).links;
  const Link& first = links[1];
  const bool is_first =
      first.layers.way > 0 && (first.body == contact.a || first.body == contact.b);
  return is_first ? 1 : static_cast<int>(links.size()) - 2;
}

inline const Link& pressed_layers(const World& world, const Contact& contact) {
  return at(at(world.cables, contact.layers_cable).links, number_of_pressed_layers(world, contact));
}

/// The least gap of a contact as its layers now lie (m).
inline double target_of(const World& world, const Contact& contact) {
  if (contact.layers_cable < 0 || contact.target == 0.0) return contact.target;
  const CableState& cable = at(world.cables, contact.layers_cable);
  return cable.least_gap + thickness_of_layers(pressed_layers(world, contact));
}

/// Whether a span is short to the circles at its ends: a longer one hardly turns as it vanishes.
inline bool is_short(const Segment& span, const Link& tail, const Link& head) {
  constexpr double share = 0.5;  // of the sum of the radii
  return span.length < share * (tail.radius + head.radius);
}

/// Arc (rad after the tail) at which the direction `u` from the body's centre meets the cable
/// stored on link i, in [-tolerance, 2 pi - tolerance); the same plus whole turns up to link.wrap
/// also do.
double arc_of_direction(const CableState& cable, std::size_t link, const Vec2& u);

/// rad: what presses at the very end of an arc, where its span leaves, presses it, however that end
/// moves within a step. About a degree: no other turn, 2 pi away, comes near, and over so much of
/// an arc a span is off its body by 2e-4 of the radius only.
constexpr double arc_tolerance = 0.02;

/// Makes it lie in layers, of way_of_layers, the tangents being up to date.
void begin_layers(const World& world, CableState& cable, std::size_t link, int way);

/// New tangents, directions, wraps and rest lengths for the bodies' present positions (thesis:
/// UpdateSegments). Material stays where it is on every body.
void update_segments(World& world, Workspace& work);

/// The same for one cable; whether it has moved. `begins`: since now; otherwise since it last
/// began. `known`: what cannot move has not been moved by hand.
bool update_cable(const World& world, CableState& cable, bool begins, bool known);

/// Headings of pieces between nodes (Segment::alpha), which nothing asks for within a step.
void turn_pieces(const Parts& parts, World& world);

/// Tangent, direction and length of segment i alone; its angle is kept continuous.
void update_tangent(const World& world, CableState& cable, std::size_t segment);

/// Material coordinate (m) of the point where a cable of direction `alpha` (rad) leaves link i's
/// body, which is turned by `angle` (rad), or with `at_head` where it comes on to it.
double material_at(const CableState& cable, std::size_t i, bool at_head, double alpha,
                   double angle);

/// Wraps of all links and rest lengths of all segments of a cable whose tangents are up to date.
void update_wraps_and_rest_lengths(const World& world, CableState& cable);

/// Whether the cable touches a body that it may slide over.
bool slides_somewhere(const World& world, const CableState& cable);

/// Whether it touches a body of some friction.
bool rubs_somewhere(const World& world, const CableState& cable);

/// Whether it has mass, and may slide over a link's body.
inline bool slides_with_mass(const World& world, const CableState& cable, const Link& link) {
  return cable.density > 0.0 && at(world.bodies, link.body).cable_friction < infinity;
}

/// Whether it slides over any without mass, by the capstan law alone. What has mass slides as
/// sleeves do (sleeve.h).
inline bool slides_without_mass(const World& world, const CableState& cable) {
  return cable.density == 0.0 && slides_somewhere(world, cable);
}

}  // namespace pinchlab
