// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "sim/cable.h"
#include "sim/pinch.h"
#include "sim/scene_error.h"
#include "sim/step.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;
/// Two things may overlap by this much (m) at the start: what decimal figures in a scene file
/// leave.
constexpr double overlap_allowed = 1e-9;

std::string in_mm(double metres) {
  return fmt::format("{:.3g} mm", 1000.0 * metres);
}

std::string pointer(const char* list, std::size_t i) {
  return fmt::format("/{}/{}", list, i);
}

Link rolling_link(const Scene& scene, const Cable& cable, const Wrap& wrap) {
  Link link;
  link.body = wrap.body;
  link.orientation = wrap.orientation;
  link.radius = scene.bodies[static_cast<std::size_t>(wrap.body)].radius + cable.half_width;
  return link;
}

Link attached_link(const Attachment& attachment) {
  Link link;
  link.body = attachment.body;
  link.attachment = attachment.point;
  return link;
}

/// Name of what link i is on, and its place in the scene.
std::string name_of(const Scene& scene, const Link& link) {
  return link.body < 0 ? "the world"
                       : "body '" + scene.bodies[static_cast<std::size_t>(link.body)].name + "'";
}

std::string place_of(const CableState& cable, std::size_t cable_index, std::size_t link) {
  const std::string base = pointer("cables", cable_index);
  if (cable.closed) return fmt::format("{}/wraps/{}", base, link);
  if (link == 0) return base + "/start";
  if (link + 1 == cable.links.size()) return base + "/end";
  return fmt::format("{}/wraps/{}", base, link - 1);
}

/// Tangents of all segments; refuses those that cannot be.
void lay_tangents(const Scene& scene, const World& world, std::size_t c, CableState& cable) {
  for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
    const auto tail = static_cast<std::size_t>(previous_link(cable, static_cast<int>(i)));
    const Link &from = cable.links[tail], &to = cable.links[i];
    const double distance = (link_centre(world, to) - link_centre(world, from)).norm();
    const double needed = std::abs(to.signed_radius() - from.signed_radius());
    if (wound_end(from, to) && std::abs(distance - needed) > overlap_allowed) {
      throw SceneError(
          place_of(cable, c, from.orientation == 0 ? 0 : i),
          fmt::format("an end on the body that the cable is wound on must lie at its rim, "
                      "{} m from the centre (radius + half width), not {} m",
                      needed, distance));
    }
    if (distance < needed - overlap_allowed) {
      const bool end = from.orientation == 0 || to.orientation == 0;
      throw SceneError(
          place_of(cable, c, i),
          end ? fmt::format(
                    "the cable's end lies {} inside the circle on which the cable would run "
                    "round the neighbouring body; move the end or the body apart",
                    in_mm(needed - distance))
              : fmt::format(
                    "the cable does not fit between {} and {}: their surfaces are {} too near; "
                    "move them apart or make the cable thinner",
                    name_of(scene, from), name_of(scene, to), in_mm(needed - distance)));
    }
    update_tangent(world, cable, i);
  }
}

/// Wrap angles from the turning of the tangents, in [0, 2 pi) plus the turns asked for.
void lay_wraps(const Scene& scene, std::size_t c, CableState& cable) {
  constexpr double suspicious = 330.0 / 360.0 * turn;
  const std::size_t count = cable.links.size();
  const std::vector<Wrap>& wraps = scene.cables[c].wraps;
  for (std::size_t i = 0; i < count; ++i) {
    Link& link = cable.links[i];
    if (link.orientation == 0) continue;
    const std::size_t leaving = (i + 1) % count;
    double wrap = link.orientation * (cable.segments[leaving].alpha - cable.segments[i].alpha);
    wrap -= turn * std::floor((wrap + 1e-9) / turn);
    wrap = std::max(wrap, 0.0);
    const int turns = wraps[cable.closed ? i : i - 1].extra_turns;
    if (wrap > suspicious && turns == 0) {
      throw SceneError(
          place_of(cable, c, i),
          fmt::format("the cable would have to run {:.0f} degrees round {}; does it pass on "
                      "the other side (turn the orientation round), or not touch it at all?",
                      wrap / turn * 360.0, name_of(scene, link)));
    }
    const double next = cable.segments[i].alpha + link.orientation * (wrap + turn * turns);
    if (cable.closed && leaving == 0) {
      cable.turning = turn * std::round((next - cable.segments[0].alpha) / turn);
    } else {
      cable.segments[leaving].alpha = next;
    }
  }
}

/// Material coordinates: along the taut path, the slack shared among the spans by their lengths.
void lay_material(const Scene& scene, const World& world, std::size_t c, CableState& cable) {
  const Cable& given = scene.cables[c];
  double taut = 0.0, free_length = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Link& link = cable.links[i];
    if (link.orientation != 0) {
      link.wrap = link.orientation * (alpha_head(cable, i) - cable.segments[i].alpha);
      taut += link.radius * link.wrap;
    }
    if (i >= first_segment(cable)) free_length += cable.segments[i].length;
  }
  taut += free_length;
  cable.length = taut + given.slack;
  if (!(free_length + given.slack > 0.0)) {
    throw SceneError(pointer("cables", c),
                     "the cable has no free length; give it slack or move its ends apart");
  }
  const double stretch = free_length > 0.0 ? 1.0 + given.slack / free_length : 0.0;
  double reached = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    Link& link = cable.links[i];
    if (i > 0) reached += cable.segments[i].length * stretch;
    link.material =
        reached - link.signed_radius() * (cable.segments[i].alpha - body_angle(world, link));
    if (link.orientation == 0) link.material = reached;
    reached += link.radius * link.wrap;
  }
  if (!cable.closed) cable.links.back().material = cable.length;
}

CableState make_cable(const Scene& scene, const World& world, std::size_t c) {
  const Cable& given = scene.cables[c];
  CableState cable;
  cable.half_width = given.half_width;
  cable.closed = given.closed;
  if (!given.closed) cable.links.push_back(attached_link(given.start));
  for (const Wrap& wrap : given.wraps) cable.links.push_back(rolling_link(scene, given, wrap));
  if (!given.closed) cable.links.push_back(attached_link(given.end));
  cable.segments.resize(cable.links.size());
  lay_tangents(scene, world, c, cable);
  lay_wraps(scene, c, cable);
  lay_material(scene, world, c, cable);
  update_wraps_and_rest_lengths(world, cable);
  for (Segment& segment : cable.segments) {
    segment.previous_tail = segment.tail;
    segment.previous_head = segment.head;
  }
  return cable;
}

void refuse_overlaps(const Scene& scene, const World& world) {
  for (const BodyPair& pair : world.scratch.broad_phase.body_pairs) {
    const Body &a = scene.bodies[static_cast<std::size_t>(pair.a)],
               &b = scene.bodies[static_cast<std::size_t>(pair.b)];
    const double gap = (b.position - a.position).norm() - a.radius - b.radius;
    if (gap < -overlap_allowed) {
      throw SceneError(pointer("bodies", static_cast<std::size_t>(pair.b)),
                       fmt::format("body '{}' overlaps body '{}' by {}; move them apart", b.name,
                                   a.name, in_mm(-gap)));
    }
  }
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const Wall& wall = scene.walls[w];
    const Vec2 d = wall.b - wall.a;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      const Body& body = scene.bodies[i];
      const double t = std::clamp((body.position - wall.a).dot(d) / d.squaredNorm(), 0.0, 1.0);
      const double gap = (wall.a + t * d - body.position).norm() - body.radius;
      if (gap < -overlap_allowed) {
        throw SceneError(pointer("bodies", i),
                         fmt::format("body '{}' overlaps wall {} by {}; move it away", body.name, w,
                                     in_mm(-gap)));
      }
    }
  }
}

void refuse_cables_through_bodies(const Scene& scene, const World& world) {
  for (const SpanPair& pair : world.scratch.broad_phase.span_pairs) {
    const CableState& cable = world.cables[static_cast<std::size_t>(pair.cable)];
    const Segment& segment = cable.segments[static_cast<std::size_t>(pair.segment)];
    const Body& body = scene.bodies[static_cast<std::size_t>(pair.body)];
    const auto segment_number = static_cast<std::size_t>(pair.segment);
    const auto tail = static_cast<std::size_t>(previous_link(cable, pair.segment));
    if (cable.links[segment_number].body == pair.body || cable.links[tail].body == pair.body)
      continue;
    const Vec2 x = body.position - segment.tail;
    const double along = std::clamp(segment.direction.dot(x), 0.0, segment.length);
    const double overlap = body.radius + cable.half_width - (x - along * segment.direction).norm();
    if (overlap > overlap_allowed) {
      throw SceneError(
          pointer("cables", static_cast<std::size_t>(pair.cable)),
          fmt::format("the cable runs through body '{}' ({} deep) on its way to {}; add the body "
                      "to the cable's wraps or move it",
                      body.name, in_mm(overlap),
                      place_of(cable, static_cast<std::size_t>(pair.cable),
                               static_cast<std::size_t>(pair.segment))));
    }
  }
}

void refuse_squeezed_wraps(const Scene& scene, const World& world) {
  for (const Contact& contact : world.contacts) {
    if (contact.gap < contact.target - overlap_allowed) {
      const Body &a = scene.bodies[static_cast<std::size_t>(contact.a)],
                 &b = scene.bodies[static_cast<std::size_t>(contact.b)];
      throw SceneError(
          pointer("bodies", static_cast<std::size_t>(contact.b)),
          fmt::format(
              "body '{}' squeezes a cable on body '{}': the gap is {} and the cable {} wide; "
              "move them apart",
              b.name, a.name, in_mm(contact.gap), in_mm(contact.target)));
    }
  }
}

/// Tensions at time 0, which the first step's steady_light_bodies goes by. A light body that is not
/// held yet gives way and lowers them, so that it takes some trials.
void find_first_tensions(const Scene& scene, World& world) {
  constexpr int most_trials = 10;
  for (int i = 0; i < most_trials; ++i) {
    World trial = world;
    trial.configuration.diagnostics = false;
    if (step(scene, trial) != StepStatus::ok) return;
    if (i > 0 && trial.scratch.span_masses.empty()) return;  // no body is nearly too light
    for (std::size_t c = 0; c < world.cables.size(); ++c) {
      std::vector<Segment>& segments = world.cables[c].segments;
      if (segments.size() != trial.cables[c].segments.size()) continue;
      for (std::size_t s = 0; s < segments.size(); ++s) {
        segments[s].tension = trial.cables[c].segments[s].tension;
      }
    }
  }
}

}  // namespace

const char* to_string(Method method) {
  switch (method) {
    case Method::pinch:
      return "pinch";
    case Method::pinch_no_contact:
      return "pinch_no_contact";
    case Method::cable:
      return "cable";
  }
  return "unknown";
}

World make_world(const Scene& scene, Configuration configuration) {
  if (configuration.iterations < 1) {
    throw std::invalid_argument(fmt::format("configuration: iterations must be at least 1, not {}",
                                            configuration.iterations));
  }
  World world;
  // A scene is judged by the full model, whatever it is run with.
  world.configuration = Method::pinch;
  world.step_length = step_length(scene);
  for (const Body& body : scene.bodies) {
    world.position.push_back(body.position);
    world.angle.push_back(body.angle);
    world.still_steps.push_back(0);
    const bool moves = body.kind == BodyKind::free || body.kind == BodyKind::rail;
    Vec2 v = moves ? body.velocity : Vec2::Zero();
    if (body.kind == BodyKind::rail) v = body.rail_axis * body.rail_axis.dot(v);
    world.velocity.push_back(v);
    world.angular_velocity.push_back(
        body.kind == BodyKind::fixed
            ? 0.0
            : body.driven_angular_velocity.value_or(body.angular_velocity));
  }
  find_body_pairs(scene, world);
  refuse_overlaps(scene, world);
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    world.cables.push_back(make_cable(scene, world, c));
  }
  find_body_pairs(scene, world);
  find_span_pairs(scene, world);
  refuse_cables_through_bodies(scene, world);
  find_contacts(scene, world);
  configure_pinches(scene, world);
  find_parts(scene, world);
  assign_contacts(world);
  refuse_squeezed_wraps(scene, world);
  world.configuration = configuration;
  if (configuration.method != Method::pinch) {
    world.cables.clear();
    for (std::size_t c = 0; c < scene.cables.size(); ++c) {
      world.cables.push_back(make_cable(scene, world, c));
    }
    world.contacts.clear();
    world.scratch.parts = {};  // nothing is known of the new contacts
    detect(scene, world);
  }
  find_first_tensions(scene, world);
  return world;
}

}  // namespace pinchlab
