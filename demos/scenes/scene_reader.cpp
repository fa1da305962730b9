// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/at.h"
#include "base/did_you_mean.h"
#include "demos/scenes/body_reader.h"
#include "demos/scenes/compound_reader.h"
#include "demos/scenes/joint_reader.h"
#include "demos/scenes/json_values.h"
#include "demos/scenes/look_reader.h"
#include "demos/scenes/node_reader.h"
#include "demos/scenes/scene_format.h"
#include "sim/configuration.h"
#include "sim/outline.h"

namespace pinchlab {
namespace {

using nlohmann::json;

// Turns JSON of the right form into a Scene and collects what does not go together.
class Reader {
 public:
  Reader(const Timing& timing, std::vector<SceneProblem>& problems)
      : timing_(timing), problems_(problems) {}
  SceneContent read(const json& file, const std::string& name);

 private:
  void problem(const std::string& place, std::string message) {
    problems_.push_back({place, std::move(message)});
  }
  void refuse_keys(const json& from, const std::string& place,
                   std::initializer_list<const char*> keys, const std::string& why) {
    pinchlab::refuse_keys(from, place, keys, why, problems_);
  }
  void claim_name(std::map<std::string, int>& names, const std::string& name, int index,
                  const char* list);
  void claim_shape(const Scene& scene, std::size_t shape);
  int body_index(const json& name, const std::string& place);

  void check_grip(const json& cables, const Scene& scene);
  void check_rims(const json& cable, const std::string& place, const Scene& scene);
  void check_rim(const json& cable, const char* end, const std::string& place, const Scene& scene);
  void check_creep(const json& cables, const Scene& scene);
  Attachment read_attachment(const json& from, const std::string& place, const Scene& scene,
                             double half_width);
  std::vector<Wrap> read_wraps(const json& from, const std::string& place, bool closed);
  Cable read_cable(const json& from, const std::string& place, const Scene& scene);
  Wall read_wall(const json& from, const std::string& place);
  View read_view(const json& from);
  void read_timing(const json& from, SceneContent& to);
  void claim_joints(const json& joints);
  void read_joints(const json& file, SceneContent& to);

  const Timing& timing_;
  std::vector<SceneProblem>& problems_;
  std::map<std::string, int> body_names_, cable_names_;
  std::vector<Vec2> origins_;  // of the bodies' frames in the file: read_shapes
};

// The name of the joint, or of the body with a stop, that this cable of a table is a part of.
std::string place_of_part(const json& file, const std::string& part) {
  for (const char* list : {"joints", "bodies"}) {
    const json owners = file.value(list, json::array());
    for (std::size_t i = 0; i < owners.size(); ++i) {
      const std::string name = owners[i]["name"].get<std::string>();
      if (part == name || part.starts_with(name + ":")) return fmt::format("/{}/{}/name", list, i);
    }
  }
  return "/joints";
}

void Reader::claim_name(std::map<std::string, int>& names, const std::string& name, int index,
                        const char* list) {
  const auto [other, is_new] = names.emplace(name, index);
  if (!is_new) {
    problem(fmt::format("/{}/{}/name", list, index),
            fmt::format("\"{}\" is the name of /{}/{} already", name, list, other->second));
  }
}

void Reader::claim_shape(const Scene& scene, std::size_t shape) {
  const auto [other, is_new] =
      body_names_.emplace(scene.bodies[shape].name, static_cast<int>(shape));
  if (is_new) return;
  // Two bodies of one name have shapes of one name; the bodies' is told.
  if (at(scene.bodies, other->second).carrier >= 0) return;
  problem(fmt::format("/bodies/{}/name", other->second),
          fmt::format("\"{}\" is the name of a shape of body \"{}\"; choose another", other->first,
                      at(scene.bodies, scene.bodies[shape].carrier).name));
}

int Reader::body_index(const json& name, const std::string& place) {
  const auto found = body_names_.find(name.get<std::string>());
  if (found != body_names_.end()) {
    return found->second;
  }
  std::vector<std::string> known;
  for (const auto& [body, index] : body_names_) {
    known.push_back(body);
  }
  const std::string meant = nearest_word(name.get<std::string>(), known);
  problem(place, fmt::format("no body is called \"{}\"{}", name.get<std::string>(),
                             meant.empty() ? "" : fmt::format(" (did you mean \"{}\"?)", meant)));
  return 0;
}

Attachment Reader::read_attachment(const json& from, const std::string& place, const Scene& scene,
                                   double half_width) {
  Attachment attachment;
  const EndBy by = end_by(from, place, {"point_m", "rim_angle_rad", "layers"}, problems_);
  if (by == EndBy::neither) return attachment;
  if (by == EndBy::world_m) {
    attachment.point = vector_of(from["world_m"]);
    return attachment;
  }
  attachment.body = body_index(from["body"], place + "/body");
  attachment.layers = from.value("layers", false);
  if (from.contains("layers") && !from.contains("rim_angle_rad")) {
    problem(place + "/layers", "belongs to an end on a disc's rim; give rim_angle_rad too");
  }
  take(from, "point_m", attachment.point);
  const bool on_shapes = !at(scene.bodies, attachment.body).outlined;
  if (on_shapes) {
    const Vec2& origin = at(origins_, attachment.body);
    attachment = attached_to_shape(scene, attachment.body, origin + attachment.point);
  }
  if (attachment.body < 0) return attachment;  // its shapes are no good
  const Body& body = at(scene.bodies, attachment.body);
  const double radius = body.radius;
  if (from.contains("rim_angle_rad")) {
    if (on_shapes) {
      problem(
          place + "/rim_angle_rad",
          fmt::format("belongs to a disc; name one of the body's shapes, \"{}:1\" for the first",
                      from["body"].get<std::string>()));
    } else if (is_polygon(body)) {
      problem(place + "/rim_angle_rad", "belongs to a disc; say where on the polygon with point_m");
    } else if (from.contains("point_m")) {
      problem(place + "/rim_angle_rad",
              "and point_m both say where the end is fixed; leave one out");
    }
    const double angle = from["rim_angle_rad"].get<double>();
    attachment.point = (radius + half_width) * Vec2(std::cos(angle), std::sin(angle));
    return attachment;
  }
  if (is_polygon(body)) {
    // On its surface a cable lies half its width off, so that it can wind up there.
    const double distance =
        outside_of(body.corners, attachment.point).distance - body.corner_radius;
    if (distance > half_width * (1.0 + 1e-9)) {
      problem(
          place + "/point_m",
          fmt::format("lies {:.12g} m outside of the body; at most half_width_m, {}, is possible",
                      distance, half_width));
    }
  } else if (attachment.point.norm() > radius * (1.0 + 1e-9)) {
    problem(place + "/point_m",
            fmt::format("lies {:.12g} m from the body's centre, outside of its radius of {} m",
                        attachment.point.norm(), radius));
  }
  return attachment;
}

// Cable comes off a rim along its tangent, which the wrap beside the end begins at.
void Reader::check_rim(const json& cable, const char* end, const std::string& place,
                       const Scene& scene) {
  const json& from = cable[end];
  if (!from.contains("rim_angle_rad") || !from.contains("body")) return;
  const auto known = body_names_.find(from["body"].get<std::string>());
  if (known == body_names_.end()) return;  // told already, as is what has no rim
  if (const Body& body = at(scene.bodies, known->second); !body.outlined || is_polygon(body))
    return;
  const json wraps = cable.value("wraps", json::array());
  const bool is_start = end == std::string("start");
  if (!wraps.empty() && (is_start ? wraps.front() : wraps.back())["body"] == from["body"]) return;
  problem(fmt::format("{}/{}/rim_angle_rad", place, end),
          fmt::format("needs the cable to run round \"{}\": the {} of its wraps must be on that "
                      "body; add it, or give point_m instead",
                      from["body"].get<std::string>(), is_start ? "first" : "last"));
}

void Reader::check_rims(const json& cable, const std::string& place, const Scene& scene) {
  for (const char* end : {"start", "end"}) {
    if (cable.contains(end)) check_rim(cable, end, place, scene);
  }
}

std::vector<Wrap> Reader::read_wraps(const json& from, const std::string& place, bool closed) {
  std::vector<Wrap> wraps;
  for (std::size_t i = 0; i < from.size(); ++i) {
    Wrap wrap;
    wrap.body = body_index(from[i]["body"], fmt::format("{}/{}/body", place, i));
    wrap.orientation = from[i]["turn"] == "clockwise" ? -1 : 1;
    take(from[i], "extra_turns", wrap.extra_turns);
    wraps.push_back(wrap);
  }
  if (closed && wraps.size() < 2) {
    problem(place.substr(0, place.rfind('/')),
            fmt::format("a closed cable needs at least two wraps, not {}", wraps.size()));
    return wraps;
  }
  for (std::size_t i = 0; i < wraps.size(); ++i) {
    const bool is_first = i == 0;
    if (is_first && !closed) {
      continue;
    }
    if (from[i]["body"] == from[is_first ? wraps.size() - 1 : i - 1]["body"]) {
      problem(fmt::format("{}/{}", place, i),
              "is on the same body as the wrap before it; say extra_turns for more than one turn");
    }
  }
  return wraps;
}

Cable Reader::read_cable(const json& from, const std::string& place, const Scene& scene) {
  Cable cable;
  cable.name = from["name"].get<std::string>();
  take(from, "half_width_m", cable.half_width);
  take(from, "slack_m", cable.slack);
  take(from, "axial_stiffness_n", cable.axial_stiffness);
  cable.creep = from.value("creep", true);
  take(from, "squeeze", cable.squeeze);
  take(from, "grip", cable.grip);
  take(from, "mass_per_metre_kg", cable.mass_per_metre);
  if (from.value("nodes", json()) == "automatic") {
    cable.nodes = automatic_nodes;
  } else {
    take(from, "nodes", cable.nodes);
  }
  take(from, "node_tolerance_m", cable.node_tolerance);
  take(from, "bending_stiffness_n_m2", cable.bending_stiffness);
  take(from, "contact_friction", cable.contact_friction);
  take(from, "linear_drag_per_s", cable.linear_drag);
  if (!from.contains("mass_per_metre_kg")) {
    refuse_keys(from, place,
                {"nodes", "node_tolerance_m", "bending_stiffness_n_m2", "contact_friction",
                 "linear_drag_per_s"},
                "a cable without mass_per_metre_kg");
  } else if (from.contains("wraps")) {
    refuse_keys(from, place, {"bending_stiffness_n_m2"},
                "a cable with mass_per_metre_kg that runs over bodies");
    if (!from.contains("nodes")) {
      refuse_keys(from, place, {"node_tolerance_m", "contact_friction", "linear_drag_per_s"},
                  "a cable with mass_per_metre_kg that runs over bodies and has no nodes");
    }
  } else {
    refuse_keys(from, place, {"squeeze", "grip", "creep"}, "a cable with mass_per_metre_kg");
  }
  if (from.contains("creep") && !from.contains("axial_stiffness_n")) {
    problem(place + "/creep", "belongs to an elastic cable; give axial_stiffness_n too");
  }
  cable.closed = from.value("closed", false);
  for (const char* end : {"start", "end"}) {
    if (cable.closed && from.contains(end)) {
      problem(place + "/" + end, "a closed cable has no ends; leave it out, or leave out closed");
    } else if (!cable.closed && !from.contains(end)) {
      problem(place, fmt::format("{} is missing (or say \"closed\": true for a loop)", end));
    } else if (!cable.closed) {
      (end == std::string("start") ? cable.start : cable.end) =
          read_attachment(from[end], place + "/" + end, scene, cable.half_width);
    }
  }
  cable.wraps = read_wraps(from.value("wraps", json::array()), place + "/wraps", cable.closed);
  if (!cable.closed) check_rims(from, place, scene);
  const bool is_on_one_body =
      !cable.closed && cable.start.body >= 0 && cable.end.body == cable.start.body &&
      std::ranges::all_of(cable.wraps,
                          [&](const Wrap& wrap) { return wrap.body == cable.start.body; });
  if (is_on_one_body && from.contains("start") && from.contains("end")) {
    problem(place, fmt::format("is on body \"{}\" alone, where it can do nothing; let an end or a "
                               "wrap be elsewhere",
                               at(scene.bodies, cable.start.body).name));
  }
  if (cable.slack < 0.0 && !std::isfinite(cable.axial_stiffness)) {
    problem(
        place + "/slack_m",
        "a cable that cannot stretch cannot be shorter than its path; give axial_stiffness_n too");
  }
  return cable;
}

// Of a cable with mass a smooth body carries what is not stretched.
void Reader::check_creep(const json& cables, const Scene& scene) {
  for (std::size_t i = 0; i < scene.cables.size(); ++i) {
    const Cable& cable = scene.cables[i];
    if (!cables[i].contains("creep") || cable.wraps.empty()) continue;
    const bool creeps = std::ranges::any_of(cable.wraps, [&](const Wrap& wrap) {
      const Body& body = at(scene.bodies, wrap.body);
      const bool fills = (cable.start.layers && wrap.body == cable.start.body) ||
                         (cable.end.layers && wrap.body == cable.end.body);
      return !fills && (body.cable_friction > 0.0 || cable.mass_per_metre == 0.0);
    });
    if (creeps) continue;
    problem(
        fmt::format("/cables/{}/creep", i),
        "has no effect where all that the cable runs round is drums with layers or, of one with "
        "mass_per_metre_kg, bodies with cable_friction 0; leave it out");
  }
}

// Without slip, all of a pinch's friction and half of it are the same.
void Reader::check_grip(const json& cables, const Scene& scene) {
  const bool slips = std::ranges::any_of(scene.bodies, [](const Body& body) {
    return body.cable_friction > 0.0 && std::isfinite(body.cable_friction);
  });
  for (std::size_t i = 0; i < scene.cables.size(); ++i) {
    const double grip = scene.cables[i].grip;
    if (!cables[i].contains("grip") || slips || grip == 0.0 || grip == 1.0) continue;
    problem(fmt::format("/cables/{}/grip", i),
            "has no effect but as 0 or 1 where no body has a cable_friction above 0 other than "
            "\"no_slip\"; give one to the body that is to slip");
  }
}

Wall Reader::read_wall(const json& from, const std::string& place) {
  Wall wall;
  take(from, "from_m", wall.a);
  take(from, "to_m", wall.b);
  take(from, "contact_friction", wall.contact_friction);
  take(from, "restitution", wall.restitution);
  if ((wall.b - wall.a).norm() < least_length) {
    problem(place + "/to_m", "must differ from from_m: the wall's length is zero or nearly so");
  }
  return wall;
}

View Reader::read_view(const json& from) {
  View view;
  take(from, "low_m", view.low);
  take(from, "high_m", view.high);
  // Less is a slip of the pen in most scenes; those that are smaller have "fit", without a limit.
  constexpr double least_view = 1e-3;  // m
  for (int axis = 0; axis < 2; ++axis) {
    if (view.high[axis] - view.low[axis] < least_view) {
      problem(fmt::format("/view/high_m/{}", axis),
              fmt::format("must be at least {:g} above the one in low_m", least_view));
    }
  }
  return view;
}

// Frame i is step i * steps_per_frame, in whole numbers: no clip ends between two frames.
void Reader::read_timing(const json& from, SceneContent& to) {
  Scene& scene = to.scene;
  take(from, "frames_per_second", scene.frames_per_second);
  take(from, "steps_per_frame", scene.steps_per_frame);
  take(from, "error_m", scene.error);
  const double duration = from["duration_s"].get<double>();  // s
  const double frames = duration * scene.frames_per_second;
  const double whole = std::round(frames);
  if (whole < 1.0 || std::abs(frames - whole) > 1e-9 * frames) {
    const double nearest = std::max(whole, 1.0) / scene.frames_per_second;
    problem("/duration_s",
            fmt::format("must be a whole number of frames: {} at {} a second are {:.12g}; "
                        "the nearest is {:.12g}",
                        duration, scene.frames_per_second, frames, nearest));
    return;
  }
  if (whole > max_frame_count) {
    problem("/duration_s",
            fmt::format("asks for {} frames; at most {} can be made", whole, max_frame_count));
    return;
  }
  scene.frame_count = static_cast<int>(whole);
  to.poster_time = 0.5 * duration;
  take(from, "poster_time_s", to.poster_time);
  if (to.poster_time > duration) {
    problem("/poster_time_s", fmt::format("must be within duration_s, {}", duration));
  }
}

// Joints are cables in tables, and hinges two.
void Reader::claim_joints(const json& joints) {
  std::map<std::string, std::size_t> names;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string name = joints[i]["name"].get<std::string>();
    const auto cable = cable_names_.find(name);
    const auto [other, is_new] = names.emplace(name, i);
    const std::string whose = cable != cable_names_.end() ? fmt::format("/cables/{}", cable->second)
                              : is_new                    ? ""
                                       : fmt::format("/joints/{}", other->second);
    if (whose.empty()) continue;
    problem(fmt::format("/joints/{}/name", i),
            fmt::format("\"{}\" is the name of {} already", name, whose));
  }
}

// What joints become has names of its own in tables.
void Reader::read_joints(const json& file, SceneContent& to) {
  if (!problems_.empty()) return;
  const std::size_t before = to.scene.cables.size();
  pinchlab::read_joints(
      file, to.scene, to.look,
      [this](const json& name, const std::string& place) { return body_index(name, place); },
      origins_, problems_);
  for (std::size_t c = before; c < to.scene.cables.size(); ++c) {
    const std::string& name = to.scene.cables[c].name;
    const auto [other, is_new] = cable_names_.emplace(name, static_cast<int>(c));
    if (is_new) continue;
    problem(place_of_part(file, name),
            fmt::format("a part of it is called \"{}\" in tables, as something else is; choose "
                        "another name",
                        name));
  }
}

SceneContent Reader::read(const json& file, const std::string& name) {
  SceneContent to;
  Scene& scene = to.scene;
  scene.name = name;
  scene.title = file["title"].get<std::string>();
  take(file, "gravity_m_s2", scene.gravity);
  for (std::size_t i = 0; i < file["bodies"].size(); ++i) {
    scene.bodies.push_back(read_body(file["bodies"][i], fmt::format("/bodies/{}", i), problems_));
    claim_name(body_names_, scene.bodies[i].name, static_cast<int>(i), "bodies");
  }
  origins_ = read_shapes(file["bodies"], scene, problems_);
  for (std::size_t b = file["bodies"].size(); b < scene.bodies.size(); ++b) claim_shape(scene, b);
  const json cables = file.value("cables", json::array());
  for (std::size_t i = 0; i < cables.size(); ++i) {
    scene.cables.push_back(read_cable(cables[i], fmt::format("/cables/{}", i), scene));
    claim_name(cable_names_, scene.cables[i].name, static_cast<int>(i), "cables");
  }
  check_grip(cables, scene);
  check_creep(cables, scene);
  const json walls = file.value("walls", json::array());
  for (std::size_t i = 0; i < walls.size(); ++i) {
    scene.walls.push_back(read_wall(walls[i], fmt::format("/walls/{}", i)));
  }
  read_timing(file, to);
  to.look.fit_view = file["view"] == "fit";
  if (!to.look.fit_view) scene.view = read_view(file["view"]);
  for (const json& body : file["bodies"]) to.look.bodies.push_back(read_body_look(body));
  for (std::size_t b = file["bodies"].size(); b < scene.bodies.size(); ++b) {
    BodyLook look = at(to.look.bodies, scene.bodies[b].carrier);
    look.label = "";
    to.look.bodies.push_back(look);
  }
  for (const json& cable : cables) to.look.cables.push_back(read_cable_look(cable));
  claim_joints(file.value("joints", json::array()));
  read_joints(file, to);  // by which a cable with mass may hold more
  if (problems_.empty()) {
    scene = with_timing(scene, timing_);  // whose steps nodes are to follow
    read_nodes(to, body_names_, problems_);
  }
  const auto baseline = configuration_from_string(file["baseline"]["method"].get<std::string>());
  scene.baseline = baseline.value().method;
  scene.baseline_reason = file["baseline"]["reason"].get<std::string>();
  return to;
}

}  // namespace

SceneContent read_scene(const json& from, const std::string& name, const Timing& timing,
                        std::vector<SceneProblem>& problems) {
  return Reader(timing, problems).read(from, name);
}

}  // namespace pinchlab
