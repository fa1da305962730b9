// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/lay.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/links.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

/// A cable being laid, and where each of its links comes from.
struct Course {
  const Cable& given;
  std::size_t number;  // of the cable
  double allowed;      // m, overlap_allowed
  CableState& cable;
  LayScratch& scratch;
};

std::string place_of_stop(const Course& course, int stop) {
  const std::string base = pointer("cables", course.number);
  if (stop < 0) return base + "/start";
  if (index(stop) == course.given.wraps.size()) return base + "/end";
  return fmt::format("{}/wraps/{}", base, stop);
}

std::string place_of(const Course& course, std::size_t link) {
  return place_of_stop(course, course.scratch.stops[link]);
}

/// An end whose layers have a way marks that its body's other link is to have them.
Link attached_link(const World& world, const Attachment& attachment, int way) {
  Link link;
  if (attachment.layers) link.layers.way = way;
  link.body = attachment.body;
  link.offset = attachment.point;
  link.still = link.body < 0 || (is_central(link) && !can_move(at(world.bodies, link.body)));
  return link;
}

/// Appends the links with which a wrap could begin or end: of a polygon one at each corner.
void append_choices(const World& world, const Cable& cable, const Wrap& wrap,
                    std::vector<Link>& links) {
  const BodyProperties& body = at(world.bodies, wrap.body);
  const int corners = static_cast<int>(body.corners.size());
  for (int k = corners == 0 ? -1 : 0; k < corners; ++k) {
    links.push_back(rolling_link(body, wrap.body, k, wrap.orientation, cable.half_width));
  }
}

/// Whether all corners of a link's polygon are on the inner side of a span along `direction`
/// through `point`.
bool is_beside(const World& world, const Link& link, const Vec2& point, const Vec2& direction,
               double allowed) {
  if (link.corner < 0) return true;
  const std::vector<Vec2>& corners = at(world.bodies, link.body).corners;
  return std::all_of(corners.begin(), corners.end(), [&](const Vec2& corner) {
    const Vec2 x =
        at(world.position, link.body) + turned(corner, at(world.angle, link.body)) - point;
    return link.orientation * cross(direction, x) >= link.radius - allowed;
  });
}

/// Of an end on a polygon that the cable is wound on: how far it is outside of that (m).
double distance_outside(const World& world, const Link& end) {
  const BodyProperties& body = at(world.bodies, end.body);
  return outside_of(body.corners, end.offset).distance - body.corner_radius;
}

/// Why there is none of these tangents.
[[noreturn]] void refuse_to_join(const Scene& scene, const World& world, const Course& course,
                                 int stop, const Link& leaves, const Link& arrives) {
  const bool at_start = leaves.orientation == 0;
  if (leaves.body != arrives.body || (!at_start && arrives.orientation != 0)) {
    throw SceneError(
        place_of_stop(course, stop),
        fmt::format("the cable finds no way from {} to {}, one of which is in its way; "
                    "move them apart or give the wrap the other `turn`",
                    name_of_body(scene, leaves.body), name_of_body(scene, arrives.body)));
  }
  const double distance = distance_outside(world, at_start ? leaves : arrives);
  throw SceneError(
      place_of_stop(course, at_start ? stop - 1 : stop),
      fmt::format("an end on the body that the cable is wound on must lie at its rim, {:.12g} m "
                  "outside of one of its sides (half width), not {:.12g} m{}",
                  course.given.half_width, std::abs(distance), distance < 0.0 ? " inside" : ""));
}

/// Of all tangents from one of the first links to one of the others, the one that leaves no corner
/// on its outer side; whether there is one.
bool join(const World& world, std::span<const Link> from, std::span<const Link> to, double allowed,
          Link& leaves, Link& arrives) {
  for (const Link& tail : from) {
    for (const Link& head : to) {
      const Vec2 a = link_centre(world, tail), b = link_centre(world, head);
      const Vec2 e = common_tangent(a, tail.signed_radius(), b, head.signed_radius()).direction;
      const Vec2 point = tangent_point(a, tail.signed_radius(), e);
      leaves = tail;
      arrives = head;
      if (is_beside(world, tail, point, e, allowed) && is_beside(world, head, point, e, allowed)) {
        return true;
      }
    }
  }
  return false;
}

/// Links of a wrap from the one at which the cable arrives to the one at which it leaves: on a
/// polygon those at the corners between them, and once more round for each extra turn.
void append_wrap(const World& world, int number, const Link& first, const Link& last,
                 Course& course) {
  const Wrap& wrap = at(course.given.wraps, number);
  const BodyProperties& body = at(world.bodies, wrap.body);
  const int corners = static_cast<int>(body.corners.size());
  int count = 1, corner = -1;
  if (corners > 0) {
    const int between = (wrap.orientation * (last.corner - first.corner) + corners) % corners;
    count += between + wrap.extra_turns * corners;
    corner = first.corner;
  }
  for (int i = 0; i < count; ++i) {
    course.cable.links.push_back(
        rolling_link(body, wrap.body, corner, wrap.orientation, course.given.half_width));
    course.scratch.stops.push_back(number);
    if (corners > 0) corner = (corner + wrap.orientation + corners) % corners;
  }
}

void lay_links(const Scene& scene, const World& world, Course& course) {
  const Cable& given = course.given;
  const int first_stop = given.closed ? 0 : -1;
  std::vector<Link>& choices = course.scratch.choices;
  std::vector<std::size_t>& begin = course.scratch.begin;
  std::vector<Link>&arrives = course.scratch.arrives, &leaves = course.scratch.leaves;
  std::vector<int>& stops = course.scratch.stops;
  choices.clear();
  begin.clear();
  stops.clear();
  begin.push_back(0);
  const auto end_stop = [&] { begin.push_back(choices.size()); };
  if (!given.closed) {
    choices.push_back(attached_link(world, given.start, 1));
    end_stop();
  }
  for (const Wrap& wrap : given.wraps) {
    append_choices(world, given, wrap, choices);
    end_stop();
  }
  if (!given.closed) {
    choices.push_back(attached_link(world, given.end, -1));
    end_stop();
  }
  const std::size_t count = begin.size() - 1;
  const auto choices_of = [&](std::size_t stop) {
    return std::span<const Link>(choices).subspan(begin[stop], begin[stop + 1] - begin[stop]);
  };
  arrives.resize(count);
  leaves.resize(count);
  for (std::size_t i = given.closed ? 0 : 1; i < count; ++i) {
    const std::size_t before = (i + count - 1) % count;
    if (join(world, choices_of(before), choices_of(i), course.allowed, leaves[before],
             arrives[i])) {
      continue;
    }
    refuse_to_join(scene, world, course, static_cast<int>(i) + first_stop, leaves[before],
                   arrives[i]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    const int stop = static_cast<int>(i) + first_stop;
    if (stop >= 0 && index(stop) < given.wraps.size()) {
      append_wrap(world, stop, arrives[i], leaves[i], course);
    } else {
      course.cable.links.push_back(choices_of(i).front());
      stops.push_back(stop);
    }
  }
  course.cable.segments.resize(course.cable.links.size());
}

/// Tangents of all segments; refuses those that cannot be.
void lay_tangents(const Scene& scene, const World& world, Course& course) {
  CableState& cable = course.cable;
  for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
    const auto tail = index(previous_link(cable, static_cast<int>(i)));
    const Link &from = cable.links[tail], &to = cable.links[i];
    const double distance = (link_centre(world, to) - link_centre(world, from)).norm();
    const double pressed = opposite(from, to) ? 2.0 * cable.half_width - cable.least_gap : 0.0;
    const double needed = std::abs(to.signed_radius() - from.signed_radius()) - pressed;
    if (wound_end(from, to) && std::abs(distance - needed) > course.allowed) {
      throw SceneError(
          place_of(course, from.orientation == 0 ? tail : i),
          fmt::format("an end on the body that the cable is wound on must lie at its rim, "
                      "{:.12g} m from the centre (radius + half width), not {:.12g} m",
                      needed, distance));
    }
    if (distance < needed - course.allowed) {
      const bool end = from.orientation == 0 || to.orientation == 0;
      throw SceneError(
          place_of(course, i),
          end ? fmt::format(
                    "the cable's end lies {} inside the circle on which the cable would run "
                    "round the neighbouring body; move the end or the body apart",
                    in_mm(needed - distance))
              : fmt::format(
                    "the cable does not fit between {} and {}: their surfaces are {} too near; "
                    "move them apart or make the cable thinner",
                    name_of_body(scene, from.body), name_of_body(scene, to.body),
                    in_mm(needed - distance)));
    }
    update_tangent(world, cable, i);
  }
}

/// From which those of the other spans follow.
void choose_first_heading(CableState& cable) {
  const auto rolls = std::find_if(cable.links.begin(), cable.links.end(),
                                  [](const Link& link) { return link.orientation != 0; });
  if (rolls == cable.links.end()) return;
  Segment& segment = cable.segments[first_segment(cable)];
  segment.alpha = first_heading(segment.direction, rolls->orientation);
}

/// Wrap angles from the turning of the tangents, in [0, 2 pi) plus the turns asked for.
void lay_wraps(const Scene& scene, Course& course) {
  // A cable that is to run nearly all the way round crosses itself there, which is rarely meant: a
  // body that it should pass just so on the other side asks for that. 30 degrees are more than such
  // a touch, and less than what pulleys beside one another leave of a turn.
  constexpr double suspicious = 330.0 / 360.0 * turn;
  CableState& cable = course.cable;
  choose_first_heading(cable);
  const std::size_t count = cable.links.size();
  double of_stop = 0.0;  // rad, of all links of a wrap so far
  for (std::size_t i = 0; i < count; ++i) {
    Link& link = cable.links[i];
    if (link.orientation == 0) continue;
    if (i == 0 || course.scratch.stops[i] != course.scratch.stops[i - 1]) of_stop = 0.0;
    const std::size_t leaving = (i + 1) % count;
    double wrap = link.orientation * (cable.segments[leaving].alpha - cable.segments[i].alpha);
    constexpr double rounding = 1e-9;  // rad: a wrap of nothing is no whole turn
    wrap -= turn * std::floor((wrap + rounding) / turn);
    wrap = std::max(wrap, 0.0);
    of_stop += wrap;
    link.wrap = wrap;  // without turns, until lay_material
    const int asked = at(course.given.wraps, course.scratch.stops[i]).extra_turns;
    const int turns = link.corner < 0 ? asked : 0;  // round a polygon they are links of their own
    if (of_stop > suspicious && asked == 0) {
      throw SceneError(
          place_of(course, i),
          fmt::format("the cable would have to run {:.0f} degrees round {}; does it pass on "
                      "the other side (the other `turn`), or not touch it at all?",
                      of_stop / turn * 360.0, name_of_body(scene, link.body)));
    }
    const double next = cable.segments[i].alpha + link.orientation * (wrap + turn * turns);
    if (cable.closed && leaving == 0) {
      cable.turning = turn * std::round((next - cable.segments[0].alpha) / turn);
    } else {
      cable.segments[leaving].alpha = unwrapped(cable.segments[leaving].alpha, next);
    }
  }
}

/// Layers on the drums that hold the ends: their radius moves the tangents, and so the wraps.
void lay_layers(const World& world, CableState& cable) {
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    if (const int way = way_of_layers(cable, i); way != 0) begin_layers(world, cable, i, way);
  }
  if (!cable.fills) return;
  for (std::size_t i = 1; i < cable.segments.size(); ++i) update_tangent(world, cable, i);
}

double wrap_between_tangents(const CableState& cable, std::size_t i) {
  return cable.links[i].orientation * (alpha_head(cable, i) - cable.segments[i].alpha);
}

/// The part of a turn beside the turns asked for is the tangent's to the layers. They raise it, by
/// th: a load hangs beside them, with no part of a turn, where that to the bare rim is -th, all but
/// one. So that such a load need not be placed to the last digit it may hang as far out as twice,
/// with a part of -th to the layers; whoever hangs it further out has nearly a turn more.
void drop_turns_of_bare_rims(const World& world, Course& course) {
  CableState& cable = course.cable;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    if (way_of_layers(cable, i) == 0) continue;
    const int asked = at(course.given.wraps, course.scratch.stops[i]).extra_turns;
    const double bare = cable.links[i].wrap - turn;
    if (asked == 0 || bare < -0.5 * turn) continue;  // th < pi / 2 does not make up for that
    const std::vector<Link> links = cable.links;
    const std::vector<Segment> segments = cable.segments;
    for (std::size_t k = i + 1; k < segments.size(); ++k)
      cable.segments[k].alpha -= cable.links[i].orientation * turn;
    lay_layers(world, cable);
    const double part = wrap_between_tangents(cable, i) - turn * asked;
    if (part >= bare - part) continue;  // -th
    cable.links = links;
    cable.segments = segments;
  }
}

/// Material coordinates: along the taut path, the slack shared among the spans by their lengths.
void lay_material(const World& world, Course& course) {
  CableState& cable = course.cable;
  const double slack = course.given.slack;
  double taut = 0.0, free_length = 0.0;
  // What is stretched from the start is so evenly, on rims that carry it over, too (creep.h).
  const bool evenly = cable.creeps && slack < 0.0;
  const auto is_free = [&](std::size_t i) {
    const Link& link = cable.links[i];
    const bool side = is_side(at(cable.links, previous_link(cable, static_cast<int>(i))), link);
    return !side || (evenly && may_carry(world, cable, i));
  };
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Link& link = cable.links[i];
    if (link.orientation != 0) {
      link.wrap = wrap_between_tangents(cable, i);
      (evenly && may_carry(world, cable, i) ? free_length : taut) += stored_length(link);
    }
    if (i < first_segment(cable)) continue;
    (is_free(i) ? free_length : taut) += cable.segments[i].length;
  }
  taut += free_length;
  cable.length = taut + slack;
  if (!(free_length + slack > 0.0)) {
    throw SceneError(pointer("cables", course.number),
                     fmt::format("the cable has no free length; give it slack or move its {} apart",
                                 cable.closed ? "bodies" : "ends"));
  }
  const double stretch = free_length > 0.0 ? 1.0 + slack / free_length : 0.0;
  double reached = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Link& link = cable.links[i];
    if (i > 0) reached += cable.segments[i].length * (is_free(i) ? stretch : 1.0);
    if (link.orientation == 0) {
      link.material = reached;
      continue;
    }
    link.material = 0.0;
    link.material = reached - tail_material(cable, i, body_angle(world, link));
    begin_to_carry(world, cable, i, evenly ? stretch : 1.0);
    reached += wrapped_material(world, cable, i);
  }
  if (!cable.closed) cable.links.back().material = cable.length;
}

/// Its storage serves again: of what is aligned so wide an allocation costs as much as the laying.
void make_empty(CableState& cable) {
  std::vector<Link> links = std::move(cable.links);
  std::vector<Segment> segments = std::move(cable.segments);
  cable = {};
  links.clear();
  segments.clear();
  cable.links = std::move(links);
  cable.segments = std::move(segments);
}

}  // namespace

void lay_cable(const Scene& scene, const World& world, double allowed, std::size_t c,
               CableState& cable, LayScratch& scratch) {
  const Cable& given = scene.cables[c];
  make_empty(cable);
  Course course{given, c, allowed, cable, scratch};
  cable.half_width = given.half_width;
  cable.density = given.mass_per_metre;
  if (world.configuration.method == Method::pinch) {
    cable.least_gap = 2.0 * given.half_width * (1.0 - given.squeeze);
  }
  cable.grip = given.grip;
  cable.closed = given.closed;
  cable.rod = given.rod;
  cable.piece = given.piece;
  cable.bends_with = given.bends_with;
  cable.bend = given.bend;
  cable.joint = given.joint;
  cable.elastic = given.axial_stiffness < infinity;
  cable.creeps = given.creep && cable.elastic && world.configuration.solver == Solver::direct;
  lay_links(scene, world, course);
  lay_tangents(scene, world, course);
  lay_wraps(scene, course);
  lay_layers(world, cable);
  if (cable.fills) drop_turns_of_bare_rims(world, course);
  lay_material(world, course);
  update_wraps_and_rest_lengths(world, cable);
  lay_down(world, cable);
  for (Segment& segment : cable.segments) begin_here(segment);
}

}  // namespace pinchlab
