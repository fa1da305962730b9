// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/scene_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/at.h"
#include "base/did_you_mean.h"
#include "demos/scenes/format_check.h"
#include "sim/configuration.h"

namespace pinchlab {
namespace {

using nlohmann::json;

Vec2 vector_of(const json& value) {
  return {value[0].get<double>(), value[1].get<double>()};
}

// Optional keys: what the file does not say keeps the default that the structure has.
void take(const json& from, const char* key, double& to) {
  if (from.contains(key)) {
    to = from[key].get<double>();
  }
}
void take(const json& from, const char* key, std::optional<double>& to) {
  if (from.contains(key)) {
    to = from[key].get<double>();
  }
}
void take(const json& from, const char* key, int& to) {
  if (from.contains(key)) {
    to = static_cast<int>(from[key].get<double>());  // 60.0 is a whole number too
  }
}
void take(const json& from, const char* key, Vec2& to) {
  if (from.contains(key)) {
    to = vector_of(from[key]);
  }
}

// Turns JSON of the right form into a Scene and collects what does not go together.
class Reader {
 public:
  explicit Reader(std::vector<SceneProblem>& problems) : problems_(problems) {}
  SceneContent read(const json& file);

 private:
  void problem(const std::string& place, std::string message) {
    problems_.push_back({place, std::move(message)});
  }
  void refuse_keys(const json& from, const std::string& place,
                   std::initializer_list<const char*> keys, const std::string& why);
  void claim_name(std::map<std::string, int>& names, const std::string& name, int index,
                  const char* list);
  int body_index(const json& name, const std::string& place);

  Body read_body(const json& from, const std::string& place);
  void check_kind(const json& from, const std::string& place);
  void read_rail(const json& from, Body& body, const std::string& place);
  void read_motor(const json& from, Body& body, const std::string& place);
  void check_grip(const json& cables, const Scene& scene);
  Attachment read_attachment(const json& from, const std::string& place, const Scene& scene,
                             double half_width);
  std::vector<Wrap> read_wraps(const json& from, const std::string& place, bool closed);
  Cable read_cable(const json& from, const std::string& place, const Scene& scene);
  Wall read_wall(const json& from, const std::string& place);
  View read_view(const json& from);
  void read_timing(const json& from, SceneContent& to);

  std::vector<SceneProblem>& problems_;
  std::map<std::string, int> body_names_, cable_names_;
};

void Reader::refuse_keys(const json& from, const std::string& place,
                         std::initializer_list<const char*> keys, const std::string& why) {
  for (const char* key : keys) {
    if (from.contains(key)) {
      problem(place + "/" + key, fmt::format("has no effect on {}; leave it out", why));
    }
  }
}

void Reader::claim_name(std::map<std::string, int>& names, const std::string& name, int index,
                        const char* list) {
  const auto [other, is_new] = names.emplace(name, index);
  if (!is_new) {
    problem(fmt::format("/{}/{}/name", list, index),
            fmt::format("\"{}\" is the name of /{}/{} already", name, list, other->second));
  }
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

// A key that would be read and then ignored is a mistake of the author's.
void Reader::check_kind(const json& from, const std::string& place) {
  const std::string& kind = from["kind"].get_ref<const std::string&>();
  if (kind == "fixed") {
    refuse_keys(from, place,
                {"mass_kg", "inertia_kg_m2", "velocity_m_s", "angular_velocity_rad_s",
                 "driven_angular_velocity_rad_s", "torque_n_m", "motor", "torque_limit_n_m",
                 "linear_drag_per_s", "angular_drag_per_s"},
                "a fixed body");
  } else if (!from.contains("mass_kg")) {
    problem(place, fmt::format("mass_kg is missing (a {} body needs one)", kind));
  }
  if (kind == "fixed_axle") {
    refuse_keys(from, place, {"velocity_m_s", "linear_drag_per_s"}, "a fixed_axle body");
  }
  if (kind != "rail") {
    refuse_keys(from, place, {"rail_axis"}, "a body that is not on a rail");
  }
  if (kind != "fixed" && from.contains("driven_angular_velocity_rad_s")) {
    refuse_keys(from, place, {"torque_n_m", "motor", "angular_drag_per_s"},
                "a body whose angular velocity is driven");
  }
}

void Reader::read_rail(const json& from, Body& body, const std::string& place) {
  if (!from.contains("rail_axis")) {
    problem(place, "rail_axis is missing (a rail body moves along it: [0, 1] is up and down)");
    return;
  }
  const Vec2 axis = vector_of(from["rail_axis"]);
  if (axis.norm() < 1e-6) {
    problem(place + "/rail_axis", "must have a direction: its length is zero or nearly so");
    return;
  }
  body.rail_axis = axis.normalized();
  const double across =
      body.rail_axis.x() * body.velocity.y() - body.rail_axis.y() * body.velocity.x();
  if (std::abs(across) > 1e-9 * body.velocity.norm()) {
    problem(place + "/velocity_m_s", "must point along rail_axis");
  }
}

// A table of angular velocities makes the body a driven one, a table of torques does not.
void Reader::read_motor(const json& from, Body& body, const std::string& place) {
  const json& points = from["motor"];
  const bool is_speed = points[0].contains("angular_velocity_rad_s");
  const char* wanted = is_speed ? "angular_velocity_rad_s" : "torque_n_m";
  const char* other = is_speed ? "torque_n_m" : "angular_velocity_rad_s";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const json& point = points[i];
    const std::string at = fmt::format("{}/motor/{}", place, i);
    if (point.contains(other) || !point.contains(wanted)) {
      problem(at, "needs time_s and either angular_velocity_rad_s or torque_n_m, the same in all");
      return;
    }
    body.motor.push_back({point["time_s"].get<double>(), point[wanted].get<double>()});
    if (i > 0 && body.motor[i].time <= body.motor[i - 1].time) {
      problem(at + "/time_s", fmt::format("must be after the one before, {}; a jump takes two "
                                          "points a little apart",
                                          body.motor[i - 1].time));
      return;
    }
  }
  if (is_speed) {
    refuse_keys(from, place, {"torque_n_m", "angular_drag_per_s"},
                "a body whose angular velocity is driven");
    body.driven_angular_velocity = body.motor.front().value;
  } else {
    refuse_keys(from, place, {"torque_n_m"}, "a body whose motor has a table of torques");
  }
}

Body Reader::read_body(const json& from, const std::string& place) {
  Body body;
  body.name = from["name"].get<std::string>();
  if (body.name == "world") {
    problem(place + "/name",
            "\"world\" is what tables call the fixed surroundings; choose another name");
  }
  const std::map<std::string, BodyKind> kinds = {{"free", BodyKind::free},
                                                 {"rail", BodyKind::rail},
                                                 {"fixed_axle", BodyKind::fixed_axle},
                                                 {"fixed", BodyKind::fixed}};
  body.kind = kinds.at(from["kind"].get<std::string>());
  take(from, "radius_m", body.radius);
  take(from, "mass_kg", body.mass);
  take(from, "inertia_kg_m2", body.inertia);
  take(from, "position_m", body.position);
  take(from, "angle_rad", body.angle);
  take(from, "velocity_m_s", body.velocity);
  take(from, "angular_velocity_rad_s", body.angular_velocity);
  take(from, "driven_angular_velocity_rad_s", body.driven_angular_velocity);
  take(from, "torque_limit_n_m", body.torque_limit);
  take(from, "torque_n_m", body.torque);
  take(from, "linear_drag_per_s", body.linear_drag);
  take(from, "angular_drag_per_s", body.angular_drag);
  if (from.contains("cable_friction") && from["cable_friction"].is_number()) {
    body.cable_friction = from["cable_friction"].get<double>();
  }
  take(from, "contact_friction", body.contact_friction);
  take(from, "restitution", body.restitution);
  check_kind(from, place);
  if (body.kind == BodyKind::rail) {
    read_rail(from, body, place);
  }
  if (from.contains("motor") && body.kind != BodyKind::fixed && !body.driven_angular_velocity) {
    read_motor(from, body, place);
  }
  if (body.driven_angular_velocity && !from.contains("torque_limit_n_m")) {
    refuse_keys(from, place, {"inertia_kg_m2", "angular_velocity_rad_s"},
                "a motor without torque_limit_n_m");
  } else if (!body.driven_angular_velocity && body.kind != BodyKind::fixed) {
    refuse_keys(from, place, {"torque_limit_n_m"},
                "a body without driven_angular_velocity_rad_s or a motor of angular velocities");
  }
  return body;
}

Attachment Reader::read_attachment(const json& from, const std::string& place, const Scene& scene,
                                   double half_width) {
  Attachment attachment;
  if (from.contains("world_m") == from.contains("body")) {
    problem(place, "give either world_m (a point that does not move) or body (and point_m on it)");
    return attachment;
  }
  if (from.contains("world_m")) {
    attachment.point = vector_of(from["world_m"]);
    for (const char* key : {"point_m", "rim_angle_rad"}) {
      if (from.contains(key)) {
        problem(place + "/" + key, "belongs to body, not to world_m; leave one out");
      }
    }
    return attachment;
  }
  attachment.body = body_index(from["body"], place + "/body");
  take(from, "point_m", attachment.point);
  const double radius = scene.bodies[static_cast<std::size_t>(attachment.body)].radius;
  if (from.contains("rim_angle_rad")) {
    if (from.contains("point_m")) {
      problem(place + "/rim_angle_rad",
              "and point_m both say where the end is fixed; leave one out");
    }
    const double angle = from["rim_angle_rad"].get<double>();
    attachment.point = (radius + half_width) * Vec2(std::cos(angle), std::sin(angle));
    return attachment;
  }
  if (attachment.point.norm() > radius * (1.0 + 1e-9)) {
    problem(place + "/point_m",
            fmt::format("lies {} m from the body's centre, outside of its radius of {} m",
                        attachment.point.norm(), radius));
  }
  return attachment;
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
  take(from, "squeeze", cable.squeeze);
  take(from, "grip", cable.grip);
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
  if ((wall.b - wall.a).norm() < 1e-6) {
    problem(place + "/to_m", "must differ from from_m: the wall's length is zero or nearly so");
  }
  return wall;
}

BodyLook read_body_look(const json& body) {
  BodyLook look;
  if (!body.contains("look")) return look;
  const json& from = body["look"];
  if (from.contains("colour")) look.colour = colour_from(from["colour"].get<std::string>());
  if (from.contains("label")) look.label = from["label"].get<std::string>();
  const std::map<std::string, LabelSide> sides = {{"automatic", LabelSide::automatic},
                                                  {"below", LabelSide::below},
                                                  {"above", LabelSide::above},
                                                  {"left", LabelSide::left},
                                                  {"right", LabelSide::right}};
  look.side = sides.at(from.value("label_side", "automatic"));
  look.marks = from.value("marks", true);
  return look;
}

CableLook read_cable_look(const json& cable) {
  CableLook look;
  if (!cable.contains("look")) return look;
  const json& from = cable["look"];
  if (from.contains("colour")) look.colour = colour_from(from["colour"].get<std::string>());
  look.marks = from.value("marks", true);
  return look;
}

View Reader::read_view(const json& from) {
  View view;
  take(from, "low_m", view.low);
  take(from, "high_m", view.high);
  for (int axis = 0; axis < 2; ++axis) {
    if (view.high[axis] - view.low[axis] < 1e-3) {
      problem(fmt::format("/view/high_m/{}", axis),
              "must be at least 0.001 above the one in low_m");
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
            fmt::format("must be a whole number of frames: {} at {} a second are {}; "
                        "the nearest is {}",
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

SceneContent Reader::read(const json& file) {
  SceneContent to;
  Scene& scene = to.scene;
  scene.title = file["title"].get<std::string>();
  take(file, "gravity_m_s2", scene.gravity);
  for (std::size_t i = 0; i < file["bodies"].size(); ++i) {
    scene.bodies.push_back(read_body(file["bodies"][i], fmt::format("/bodies/{}", i)));
    claim_name(body_names_, scene.bodies[i].name, static_cast<int>(i), "bodies");
  }
  const json cables = file.value("cables", json::array());
  for (std::size_t i = 0; i < cables.size(); ++i) {
    scene.cables.push_back(read_cable(cables[i], fmt::format("/cables/{}", i), scene));
    claim_name(cable_names_, scene.cables[i].name, static_cast<int>(i), "cables");
  }
  check_grip(cables, scene);
  const json walls = file.value("walls", json::array());
  for (std::size_t i = 0; i < walls.size(); ++i) {
    scene.walls.push_back(read_wall(walls[i], fmt::format("/walls/{}", i)));
  }
  read_timing(file, to);
  to.look.fit_view = file["view"] == "fit";
  if (!to.look.fit_view) scene.view = read_view(file["view"]);
  for (const json& body : file["bodies"]) to.look.bodies.push_back(read_body_look(body));
  for (const json& cable : cables) to.look.cables.push_back(read_cable_look(cable));
  const auto baseline = configuration_from_string(file["baseline"]["method"].get<std::string>());
  scene.baseline = baseline.value().method;
  scene.baseline_reason = file["baseline"]["reason"].get<std::string>();
  return to;
}

}  // namespace

SceneContent read_scene(const json& from, std::vector<SceneProblem>& problems) {
  return Reader(problems).read(from);
}

}  // namespace pinchlab
