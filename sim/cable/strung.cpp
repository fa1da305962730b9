// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/strung.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/links.h"
#include "sim/cable/mass.h"
#include "sim/cable/taking_in.h"
#include "sim/compound.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

/// m given off beyond a node's place, where it comes back: the header has the reasons.
double giving_distance(const CableState& cable) {
  return std::max(0.25 * node_spacing(cable), 2.0 * mooring_distance(cable));
}

/// Whether a node lies on a rim, or is moored there: else it is a body that moves by itself.
void set_wound(World& world, int node, bool wound) {
  BodyProperties& properties = at(world.bodies, node);
  properties.kind = wound ? BodyKind::fixed : BodyKind::free;
  properties.outlined = !wound;
}

/// m, where what is at x beside a segment was when the interval began, as if it had moved with it.
Vec2 place_before(const Segment& segment, const Vec2& x) {
  const Vec2 line = segment.head - segment.tail;
  const double squared = line.squaredNorm();
  const double share = squared > 0.0 ? line.dot(x - segment.tail) / squared : 0.0;
  return x + (1.0 - share) * (segment.previous_tail - segment.tail) +
         share * (segment.previous_head - segment.head);
}

/// Inserts a node, at that material coordinate (m). What comes upon either part of the segment has
/// seen the whole of it where it was when the interval began.
void insert(World& world, CableState& cable, std::size_t segment, int node, double material) {
  // As in insert_link: what closes a loop gets it last.
  const bool seam = segment == 0;
  const std::size_t position = seam ? cable.links.size() : segment;
  const Segment old = cable.segments[segment];
  const Vec2 was = place_before(old, at(world.position, node));
  Link link;
  link.body = node;
  link.material = material;
  Segment arriving = old;
  if (seam) arriving.alpha += cable.turning;
  const auto place = static_cast<std::ptrdiff_t>(position);
  cable.links.insert(cable.links.begin() + place, link);
  cable.segments.insert(cable.segments.begin() + place, arriving);
  if (!cable.rims.empty()) cable.rims.insert(cable.rims.begin() + place, Rim{});
  for (const std::size_t part : {position, seam ? 0 : position + 1}) {
    update_tangent(world, cable, part);
    begin_here(cable.segments[part]);
  }
  cable.segments[position].previous_tail = old.previous_tail;
  cable.segments[position].previous_head = was;
  cable.segments[seam ? 0 : position + 1].previous_tail = was;
  cable.segments[seam ? 0 : position + 1].previous_head = old.previous_head;
  count_changes(world, cable, 1);
  update_wraps_and_rest_lengths(world, cable);
  lay_down(world, cable);
}

/// Puts a node into a segment, at that material coordinate (m) as the segment's tail counts it.
void put_in(World& world, CableState& cable, std::size_t segment, int body, double material) {
  const int tail = previous_link(cable, static_cast<int>(segment));
  const double begins = head_material(cable, index(tail), body_angle(world, at(cable.links, tail)));
  const Segment& old = cable.segments[segment];
  const double share = (material - begins) / old.rest_length;
  free_node(world, body, old.tail + share * (old.head - old.tail),
            velocity_between(flow_at(world, cable, segment, false),
                             flow_at(world, cable, segment, true), share, old.direction));
  insert(world, cable, segment, body, material);
}

/// Numbers of nodes, counted on round a loop.
struct Numbers {
  long first = 0, last = -1;
};

/// m, of node k: (k + 1) l in an open cable, (k + 1/2) l in a loop, in any of its rounds.
double place_of_node(const CableState& cable, long k) {
  return node_spacing(cable) * (static_cast<double>(k) + (cable.closed ? 0.5 : 1.0));
}

/// Those from one material coordinate (m) to another.
Numbers nodes_within(const CableState& cable, double from, double to) {
  const double first = place_of_node(cable, 0), l = node_spacing(cable);
  const Numbers on{static_cast<long>(std::ceil((from - first) / l)),
                   static_cast<long>(std::floor((to - first) / l))};
  if (cable.closed) return on;
  return {std::max(on.first, 0L), std::min(on.last, static_cast<long>(cable.nodes) - 1)};
}

/// The body that node k is.
int body_of_node(const CableState& cable, long k) {
  const long nodes = cable.nodes;
  return cable.first_node + static_cast<int>(((k % nodes) + nodes) % nodes);
}

/// Those on a segment that are at least `margin` (m of material) away from its ends; none where it
/// lies along a body, or holds them itself.
Numbers nodes_on(const World& world, const CableState& cable, std::size_t segment, double margin) {
  const Segment& span = cable.segments[segment];
  const int tail = previous_link(cable, static_cast<int>(segment));
  if (span.pinched || !(span.rest_length > 2.0 * margin)) return {};
  if (is_side(at(cable.links, tail), cable.links[segment])) return {};
  if (is_held(cable, segment)) return {};
  const double begins = head_material(cable, index(tail), body_angle(world, at(cable.links, tail)));
  return nodes_within(cable, begins + margin, begins + span.rest_length - margin);
}

/// Of what lies on a rim, from where the cable meets it: rad, counter-clockwise positive, and the
/// signed radius there (m).
struct PlaceOnRim {
  double turned = 0.0, radius = 0.0;
};
PlaceOnRim place_on_rim(const World& world, const CableState& cable, std::size_t i,
                        double material) {
  const Link& link = cable.links[i];
  if (!cable.rims.empty() && !cable.rims[i].laid.empty()) {
    const double tail = span_on_rim(world, cable, i).tail;
    const double met = laid_material(cable.rims[i], tail);
    const double along = place_of_laid(cable.rims[i], met + material) - tail;
    return {along / link.signed_radius(), link.signed_radius()};
  }
  const Layers& layers = link.layers;
  if (layers.way == 0) return {material / link.signed_radius(), link.signed_radius()};
  const bool begins_there = layers.way > 0;  // the first layer is where the cable meets it
  const double from_begin = begins_there ? material : layers.length(link.wrap) - material;
  const double angle = layers.turned_at(std::max(from_begin, 0.0));
  return {link.orientation * (begins_there ? angle : link.wrap - angle),
          link.orientation * layers.radius(angle)};
}

/// Velocities (m/s) of those that a segment holds, for those of its ends.
void carry_velocities(const World& world, const CableState& cable, std::size_t segment,
                      std::vector<Vec2>& velocity) {
  const int before = cable.links[segment - 1].body;
  const Vec2 from = at(velocity, before), to = at(velocity, cable.links[segment].body);
  const Vec2 tail = cable.segments[segment].tail, line = cable.segments[segment].head - tail;
  const double turning = cross(line, to - from) / line.squaredNorm();
  for (int i = 1; i < held_at(cable, segment).pieces; ++i) {
    at(velocity, before + i) = from + turning * left(at(world.position, before + i) - tail);
  }
}

/// Those nodes, with it.
void carry_held_nodes(World& world, const CableState& cable, std::size_t segment) {
  const int before = cable.links[segment - 1].body;
  for (int i = 1; i < held_at(cable, segment).pieces; ++i) {
    at(world.position, before + i) = place_of_held(cable, segment, i);
  }
  carry_velocities(world, cable, segment, world.velocity);
}

}  // namespace

void string_all(World& world, CableState& cable, double margin) {
  for (std::size_t segment = cable.segments.size(); segment-- > first_segment(cable);) {
    const Numbers on = nodes_on(world, cable, segment, margin);
    // From the last on: then each is put into what is left before it.
    std::size_t s = segment;
    for (long k = on.last; k >= on.first; --k) {
      const std::size_t position = s == 0 ? cable.links.size() : s;
      put_in(world, cable, s, body_of_node(cable, k), place_of_node(cable, k));
      s = position;
    }
  }
}

double node_spacing(const CableState& cable) {
  return cable.length / (cable.closed ? cable.nodes : cable.nodes + 1);
}

int node_of(const CableState& cable, const Link& link) {
  const double from_first = link.material - place_of_node(cable, 0);
  return body_of_node(cable, std::lround(from_first / node_spacing(cable)));
}

void free_node(World& world, int node, const Vec2& position, const Vec2& velocity) {
  at(world.position, node) = position;
  at(world.velocity, node) = velocity;
  at(world.angular_velocity, node) = 0.0;
  at(world.still_steps, node) = 0;
  set_wound(world, node, false);
}

void lay_down_node(World& world, int node) {
  set_wound(world, node, true);
  at(world.velocity, node) = Vec2::Zero();
}

void insert_node(World& world, CableState& cable, std::size_t segment, int node,
                 const Vec2& position, const Vec2& velocity) {
  free_node(world, node, position, velocity);
  insert(world, cable, segment, node, place_of_node(cable, node - cable.first_node));
}

bool has_given_off(const World& world, const CableState& cable) {
  const double margin = giving_distance(cable);
  for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
    const Numbers on = nodes_on(world, cable, s, margin);
    if (on.first <= on.last) return true;
  }
  return false;
}

void give_off_nodes(World& world, CableState& cable) {
  string_all(world, cable, giving_distance(cable));
}

void sort_nodes(World& world, const CableState& cable) {
  for (int k = 0; k < cable.nodes; ++k) set_wound(world, cable.first_node + k, true);
  for (const Link& link : cable.links) {
    if (is_strung(cable, link)) set_wound(world, link.body, false);
  }
}

bool holds_end_inside(const World& world, const CableState& cable, int body) {
  const auto holds = [&](const Link& end) {
    return end.body == body && end.orientation == 0 && is_fastened_inside(world, cable, end);
  };
  return !cable.closed && (holds(cable.links.front()) || holds(cable.links.back()));
}

bool is_within_end(const World& world, const CableState& cable, const Link& node, int body) {
  if (cable.closed) return false;
  if (holds_end_inside(world, cable, body)) return true;
  const BodyProperties& outline = at(world.bodies, body);
  const auto reaches = [&](const Link& end, double left) {
    if (end.body < 0 || mover_of(world, end.body) != mover_of(world, body)) return false;
    if (end.body == body) return false;  // it is at the rim
    return left <= end.offset.norm() + outline.radius + outline.seat.norm() + cable.half_width;
  };
  return reaches(cable.links.front(), node.material) ||
         reaches(cable.links.back(), cable.length - node.material);
}

bool lies_beside(const World& world, int node, int body) {
  const auto holds_node = [&world, node](int c) {
    const CableState& cable = at(world.cables, c);
    return cable.first_node <= node && node < cable.first_node + cable.nodes;
  };
  const auto found = std::find_if(world.strung.begin(), world.strung.end(), holds_node);
  if (found == world.strung.end()) return false;
  const CableState& cable = at(world.cables, *found);
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    if (at(cable.links, i).body != node) continue;
    for (const int beside : {previous_link(cable, i), next_link(cable, i)}) {
      if (beside < 0) continue;
      const Link& rim = at(cable.links, beside);
      if (rim.body == body && (rim.corner < 0 || rim.moored)) return true;
    }
    return is_within_end(world, cable, at(cable.links, i), body);
  }
  return false;
}

void carry_velocities(const World& world, const CableState& cable, std::vector<Vec2>& velocity) {
  for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
    if (is_held(cable, s)) carry_velocities(world, cable, s, velocity);
  }
}

void carry_wound_nodes(World& world, const CableState& cable) {
  const auto is_wound = [&world](int body) { return !at(world.bodies, body).outlined; };
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    const Link& link = cable.links[i];
    const double angle = body_angle(world, link);
    const double leaves = head_material(cable, i, angle);
    if (link.moored) at(world.position, node_of(cable, link)) = link_centre(world, link);
    if (link.orientation != 0) {
      const double meets = tail_material(cable, i, angle), alpha = cable.segments[i].alpha;
      const Numbers on = nodes_within(cable, meets, leaves);
      for (long k = on.first; k <= on.last; ++k) {
        const int node = body_of_node(cable, k);
        if (!is_wound(node)) continue;
        const PlaceOnRim place = place_on_rim(world, cable, i, place_of_node(cable, k) - meets);
        const Vec2 e = turned(Vec2(0.0, 1.0), alpha + place.turned);
        at(world.position, node) = tangent_point(link_centre(world, link), place.radius, e);
      }
    }
    const int next = next_link(cable, static_cast<int>(i));
    if (next < 0) continue;
    const Segment& span = at(cable.segments, next);
    if (is_held(cable, index(next))) {
      carry_held_nodes(world, cable, index(next));
      continue;
    }
    const Numbers on = nodes_within(cable, leaves, leaves + span.rest_length);
    for (long k = on.first; k <= on.last; ++k) {
      const int node = body_of_node(cable, k);
      const double share = (place_of_node(cable, k) - leaves) / span.rest_length;
      if (!is_wound(node) || !(span.rest_length > 0.0)) continue;
      at(world.position, node) = span.tail + share * (span.head - span.tail);
    }
  }
}

double wave_at_node(const World& world, const CableState& cable, int link) {
  const int after = next_link(cable, link);
  double material = 0.0, stiffness = 0.0, turning = 0.0;  // m, N/m, rad/s
  const auto add = [&](int segment, int beyond) {
    const Segment& span = at(cable.segments, segment);
    material += std::max(span.rest_length, 0.0);
    const double neighbours = is_strung(cable, at(cable.links, beyond)) ? 2.0 : 1.0;
    if (span.tension > 0.0) stiffness += neighbours * span.tension / span.length;
    if (at(cable.links, beyond).orientation == 0) return;
    const Vec2 apart =
        velocity_of(world, at(cable.links, link)) - velocity_of(world, at(cable.links, beyond));
    turning = std::max(turning, std::abs(cross(span.direction, apart)) / span.length);
  };
  add(link, previous_link(cable, link));
  add(after, after);
  return std::max(stiffness / (0.5 * cable.density * material), turning * turning);
}

}  // namespace pinchlab
