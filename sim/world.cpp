// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/tangent.h"
#include "sim/detect/pinch.h"
#include "sim/scene_error.h"
#include "sim/step.h"

namespace pinchlab {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;
/// Two things may overlap by this much (m) at the start, what decimal figures in a scene file
/// leave: a share of the scene's largest coordinate, length or radius.
double overlap_allowed(const Scene& scene) {
  constexpr double share = 1e-9;
  double size = 0.0;
  const auto include = [&size](const Vec2& x) { size = std::max(size, x.cwiseAbs().maxCoeff()); };
  for (const Body& body : scene.bodies) {
    include(body.position);
    size = std::max(size, body.radius);
  }
  for (const Cable& cable : scene.cables) {
    if (cable.closed) continue;
    include(cable.start.point);
    include(cable.end.point);
  }
  for (const Wall& wall : scene.walls) {
    include(wall.a);
    include(wall.b);
  }
  return share * size;
}

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
  link.offset = attachment.point;
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
  const double allowed = overlap_allowed(scene);
  for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
    const auto tail = static_cast<std::size_t>(previous_link(cable, static_cast<int>(i)));
    const Link &from = cable.links[tail], &to = cable.links[i];
    const double distance = (link_centre(world, to) - link_centre(world, from)).norm();
    const double pressed = opposite(from, to) ? 2.0 * cable.half_width - cable.least_gap : 0.0;
    const double needed = std::abs(to.signed_radius() - from.signed_radius()) - pressed;
    if (wound_end(from, to) && std::abs(distance - needed) > allowed) {
      throw SceneError(
          place_of(cable, c, from.orientation == 0 ? 0 : i),
          fmt::format("an end on the body that the cable is wound on must lie at its rim, "
                      "{} m from the centre (radius + half width), not {} m",
                      needed, distance));
    }
    if (distance < needed - allowed) {
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
  if (world.configuration.method == Method::pinch) {
    cable.least_gap = 2.0 * given.half_width * (1.0 - given.squeeze);
  }
  cable.grip = given.grip;
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

void refuse_overlaps(const Scene& scene, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const BodyPair& pair : broad.body_pairs) {
    const Body &a = scene.bodies[static_cast<std::size_t>(pair.a)],
               &b = scene.bodies[static_cast<std::size_t>(pair.b)];
    const double gap = (b.position - a.position).norm() - a.radius - b.radius;
    if (gap < -allowed) {
      throw SceneError(pointer("bodies", static_cast<std::size_t>(pair.b)),
                       fmt::format("body '{}' overlaps body '{}' by {}; move them apart", b.name,
                                   a.name, in_mm(-gap)));
    }
  }
  for (const WallPair& pair : broad.wall_pairs) {
    const Body& body = at(scene.bodies, pair.body);
    const Vec2 nearest = nearest_point(at(scene.walls, pair.wall), body.position);
    const double gap = (nearest - body.position).norm() - body.radius;
    if (gap < -allowed) {
      throw SceneError(pointer("bodies", index(pair.body)),
                       fmt::format("body '{}' overlaps wall {} by {}; move it away", body.name,
                                   pair.wall, in_mm(-gap)));
    }
  }
}

void refuse_cables_through_bodies(const Scene& scene, const World& world, const BroadPhase& broad) {
  const double allowed = overlap_allowed(scene);
  for (const SpanPair& pair : broad.span_pairs) {
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
    if (overlap > allowed) {
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
  const double allowed = overlap_allowed(scene);
  for (const Contact& contact : world.contacts) {
    if (contact.gap < contact.target - allowed) {
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

/// What a scene's reader checks too, for scenes that are made by a program: whatever the geometry
/// below takes for granted.
void refuse_impossible_figures(const Scene& scene) {
  const auto refuse = [](bool wrong, const std::string& place, const char* message) {
    if (wrong) throw SceneError(place, message);
  };
  const auto positive = [](double x) { return x > 0.0 && x < infinity; };
  const int bodies = static_cast<int>(scene.bodies.size());
  refuse(scene.frames_per_second < 1 || scene.steps_per_frame < 1, "/frames_per_second",
         "frames per second and steps per frame must be at least 1");
  refuse(!(scene.error >= 0.0), "/error_m", "the error must be a number of at least 0");
  for (int b = 0; b < bodies; ++b) {
    const Body& body = at(scene.bodies, b);
    const std::string place = pointer("bodies", index(b));
    refuse(!positive(body.radius), place, "the radius must be a number above 0");
    refuse(!positive(body.mass) && body.kind != BodyKind::fixed, place,
           "the mass must be a number above 0");
    refuse(body.inertia && !positive(*body.inertia), place, "the inertia must be a number above 0");
    refuse(!body.position.allFinite() || !body.velocity.allFinite(), place,
           "position and velocity must be finite");
    refuse(!(body.torque_limit > 0.0), place, "a motor's torque limit must be above 0");
    for (std::size_t i = 0; i < body.motor.size(); ++i) {
      const MotorPoint& point = body.motor[i];
      const double before = i == 0 ? 0.0 : body.motor[i - 1].time;
      refuse(!std::isfinite(point.value) || !(point.time < infinity) ||
                 !(i == 0 ? point.time >= 0.0 : point.time > before),
             place, "a motor's table must have finite values at ascending times from 0 on");
    }
    refuse(body.kind == BodyKind::rail && !(body.rail_axis.norm() > 0.0), place,
           "the rail's axis must have a direction");
  }
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    const Cable& cable = scene.cables[c];
    const std::string place = pointer("cables", c);
    refuse(!positive(cable.half_width), place, "the half width must be a number above 0");
    refuse(!(cable.axial_stiffness > 0.0), place, "the axial stiffness must be above 0");
    refuse(!(cable.squeeze >= 0.0 && cable.squeeze <= 1.0), place, "squeeze must be 0 to 1");
    refuse(!(cable.grip >= 0.0 && cable.grip <= 1.0), place, "grip must be 0 to 1");
    refuse(cable.closed && cable.wraps.size() < 2, place, "a closed cable needs two bodies");
    for (const Attachment* end : {&cable.start, &cable.end}) {
      const bool there = end->body >= -1 && end->body < bodies && end->point.allFinite();
      refuse(!cable.closed && !there, place, "an end is on a body that is not in the scene");
    }
    for (const Wrap& wrap : cable.wraps) {
      refuse(wrap.body < 0 || wrap.body >= bodies, place,
             "it runs round a body that is not in the scene");
      refuse(std::abs(wrap.orientation) != 1 || wrap.extra_turns < 0, place,
             "a wrap's orientation must be 1 or -1, and its extra turns at least 0");
    }
  }
  for (std::size_t w = 0; w < scene.walls.size(); ++w) {
    const double length = (scene.walls[w].b - scene.walls[w].a).norm();
    refuse(!positive(length), pointer("walls", w), "the wall must have a length");
  }
}

/// What a motor's table says at time t.
double drive_at(const std::vector<MotorPoint>& motor, double t) {
  if (t <= motor.front().time) return motor.front().value;
  for (std::size_t i = 1; i < motor.size(); ++i) {
    const MotorPoint &a = motor[i - 1], &b = motor[i];
    if (t < b.time) return a.value + (b.value - a.value) * (t - a.time) / (b.time - a.time);
  }
  return motor.back().value;
}

World bodies_of_scene(const Scene& scene) {
  World world;
  world.step_length = step_length(scene);
  for (const Body& body : scene.bodies) {
    world.bodies.push_back(body);
    world.position.push_back(body.position);
    world.angle.push_back(body.angle);
    world.still_steps.push_back(0);
    Vec2 v = can_move(body) ? body.velocity : Vec2::Zero();
    if (body.kind == BodyKind::rail) v = body.rail_axis * body.rail_axis.dot(v);
    world.velocity.push_back(v);
    const double turning = body.kind == BodyKind::fixed ? 0.0 : body.angular_velocity;
    const bool is_driven = body.driven_angular_velocity && body.torque_limit == infinity;
    world.angular_velocity.push_back(!is_driven           ? turning
                                     : body.motor.empty() ? *body.driven_angular_velocity
                                                          : drive_at(body.motor, 0.0));
  }
  return world;
}

/// Tensions at time 0, which the first step's steady_light_bodies goes by. A light body that is not
/// held yet gives way and lowers them, so that it takes some trials.
void find_first_tensions(const Scene& scene, World& world) {
  constexpr int most_trials = 10;
  for (int i = 0; i < most_trials; ++i) {
    World trial = world;
    Workspace work;
    trial.configuration.diagnostics = false;
    if (step(scene, trial, work) != StepStatus::ok) return;
    if (i > 0 && std::all_of(work.systems.begin(), work.systems.end(),
                             [](const PartSystem& s) { return s.span_masses.empty(); })) {
      return;  // no body is nearly too light
    }
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

// A line's mean is its value at the middle; the table's corners divide the time into lines.
double mean_drive(const std::vector<MotorPoint>& motor, double begin, double end) {
  double sum = 0.0, from = begin;
  const auto add_until = [&](double to) {
    sum += (to - from) * drive_at(motor, 0.5 * (from + to));
    from = to;
  };
  for (const MotorPoint& corner : motor) {
    if (corner.time > from && corner.time < end) add_until(corner.time);
  }
  add_until(end);
  return sum / (end - begin);
}

double strongest_drive(const Body& body) {
  double most = body.motor.empty() ? body.driven_angular_velocity.value_or(body.torque) : 0.0;
  for (const MotorPoint& point : body.motor) {
    if (std::abs(point.value) > std::abs(most)) most = point.value;
  }
  return most;
}

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
  if (!(configuration.error >= 0.0)) {
    throw std::invalid_argument("configuration: error must be at least 0");
  }
  refuse_impossible_figures(scene);
  World world = bodies_of_scene(scene);
  Workspace work;
  // A scene is judged by the full model, whatever it is run with.
  world.configuration = Method::pinch;
  find_body_pairs(scene, world, work);
  refuse_overlaps(scene, work.broad_phase);
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    world.cables.push_back(make_cable(scene, world, c));
  }
  find_body_pairs(scene, world, work);
  find_span_pairs(world, work);
  refuse_cables_through_bodies(scene, world, work.broad_phase);
  find_contacts(scene, world, work);
  configure_pinches(world, work);
  find_parts(world, work);
  assign_contacts(world, work);
  refuse_squeezed_wraps(scene, world);
  world.configuration = configuration;
  if (configuration.error == 0.0 && locates_events(configuration)) {
    world.configuration.error = scene.error;
  }
  if (configuration.method != Method::pinch) {
    world.cables.clear();
    for (std::size_t c = 0; c < scene.cables.size(); ++c) {
      world.cables.push_back(make_cable(scene, world, c));
    }
    world.contacts.clear();
    work = {};  // nothing is known of the new contacts
    detect(scene, world, work);
  }
  find_first_tensions(scene, world);
  return world;
}

}  // namespace pinchlab
