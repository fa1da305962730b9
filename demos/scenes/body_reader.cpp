// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/body_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "demos/scenes/json_values.h"
#include "sim/outline.h"
#include "sim/scene_checks.h"

namespace pinchlab {
namespace {

using nlohmann::json;

class BodyReader {
 public:
  BodyReader(const json& from, const std::string& place, std::vector<SceneProblem>& problems)
      : from_(from), place_(place), problems_(problems) {}
  Body read();

 private:
  void problem(const std::string& place, std::string message) {
    problems_.push_back({place, std::move(message)});
  }
  void refuse(std::initializer_list<const char*> keys, const std::string& what) {
    refuse_keys(from_, place_, keys, what, problems_);
  }
  void check_kind();
  void read_mass_and_outline(Body& body);
  void read_rail(Body& body);
  void read_motor(Body& body);

  const json& from_;
  const std::string& place_;
  std::vector<SceneProblem>& problems_;
};

// A key that would be read and then ignored is a mistake of the author's.
void BodyReader::check_kind() {
  const std::string& kind = from_["kind"].get_ref<const std::string&>();
  if (kind == "fixed") {
    refuse({"mass_kg", "density_kg_m2", "inertia_kg_m2", "velocity_m_s", "angular_velocity_rad_s",
            "driven_angular_velocity_rad_s", "torque_n_m", "motor", "torque_limit_n_m",
            "linear_drag_per_s", "angular_drag_per_s"},
           "a fixed body");
  } else if (from_.contains("mass_kg") == from_.contains("density_kg_m2")) {
    problem(place_,
            from_.contains("mass_kg")
                ? "mass_kg and density_kg_m2 both say how heavy it is; leave one out"
                : fmt::format("mass_kg is missing (a {} body needs one, or density_kg_m2)", kind));
  }
  if (kind == "fixed_axle") {
    refuse({"velocity_m_s", "linear_drag_per_s"}, "a fixed_axle body");
  }
  if (kind != "rail") {
    refuse({"rail_axis", "travel_m"}, "a body that is not on a rail");
  }
  if (kind != "fixed" && from_.contains("driven_angular_velocity_rad_s")) {
    refuse({"torque_n_m", "motor", "angular_drag_per_s"},
           "a body whose angular velocity is driven");
  }
}

// An outline, and what of the mass follows from it; of shapes, see compound_reader.h.
void BodyReader::read_mass_and_outline(Body& body) {
  take(from_, "mass_kg", body.mass);
  take(from_, "inertia_kg_m2", body.inertia);
  if (from_.contains("shapes")) {
    refuse({"radius_m", "corners_m", "corner_radius_m", "cable_friction", "contact_friction",
            "restitution"},
           "a body of shapes, each of which has its own");
    return;
  }
  if (!read_outline(from_, place_, body, problems_)) return;
  const double density = from_.value("density_kg_m2", 0.0);
  if (!is_polygon(body)) {
    if (density > 0.0) body.mass = density * std::numbers::pi * body.radius * body.radius;
    check_mass_of_density(from_, place_, body.mass, problems_);
    return;
  }
  if (density > 0.0) body.mass = density * plate_of(body.corners, body.corner_radius).area;
  check_mass_of_density(from_, place_, body.mass, problems_);
  std::vector<Vec2> corners = std::move(body.corners);
  make_polygon(body, std::move(corners), body.corner_radius);
}

void BodyReader::read_rail(Body& body) {
  if (!from_.contains("rail_axis")) {
    problem(place_, "rail_axis is missing (a rail body moves along it: [0, 1] is up and down)");
    return;
  }
  const Vec2 axis = vector_of(from_["rail_axis"]);
  if (axis.norm() < 1e-6) {  // of no unit: less is a slip of the pen
    problem(place_ + "/rail_axis", "must have a direction: its length is zero or nearly so");
    return;
  }
  body.rail_axis = axis.normalized();
  const double across =
      body.rail_axis.x() * body.velocity.y() - body.rail_axis.y() * body.velocity.x();
  if (std::abs(across) > 1e-9 * body.velocity.norm()) {
    problem(place_ + "/velocity_m_s", "must point along rail_axis");
  }
  if (!from_.contains("travel_m")) return;
  const Vec2 travel = vector_of(from_["travel_m"]);
  if (!(travel[0] <= 0.0 && travel[1] >= 0.0 && travel[1] - travel[0] >= least_length)) {
    problem(
        place_ + "/travel_m",
        "must be [low, high], how far it may go either way from where it starts: low at most 0, "
        "high at least 0, and room between them");
  }
}

// A table of angular velocities makes the body a driven one, a table of torques does not.
void BodyReader::read_motor(Body& body) {
  const json& points = from_["motor"];
  const bool is_speed = points[0].contains("angular_velocity_rad_s");
  const char* wanted = is_speed ? "angular_velocity_rad_s" : "torque_n_m";
  const char* other = is_speed ? "torque_n_m" : "angular_velocity_rad_s";
  for (std::size_t i = 0; i < points.size(); ++i) {
    const json& point = points[i];
    const std::string at = fmt::format("{}/motor/{}", place_, i);
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
    refuse({"torque_n_m", "angular_drag_per_s"}, "a body whose angular velocity is driven");
    body.driven_angular_velocity = body.motor.front().value;
  } else {
    refuse({"torque_n_m"}, "a body whose motor has a table of torques");
  }
}

Body BodyReader::read() {
  Body body;
  body.name = from_["name"].get<std::string>();
  if (body.name == "world") {
    problem(place_ + "/name",
            "\"world\" is what tables call the fixed surroundings; choose another name");
  }
  const std::map<std::string, BodyKind> kinds = {{"free", BodyKind::free},
                                                 {"rail", BodyKind::rail},
                                                 {"fixed_axle", BodyKind::fixed_axle},
                                                 {"fixed", BodyKind::fixed}};
  body.kind = kinds.at(from_["kind"].get<std::string>());
  read_mass_and_outline(body);
  take(from_, "position_m", body.position);
  take(from_, "angle_rad", body.angle);
  take(from_, "velocity_m_s", body.velocity);
  take(from_, "angular_velocity_rad_s", body.angular_velocity);
  take(from_, "driven_angular_velocity_rad_s", body.driven_angular_velocity);
  take(from_, "torque_limit_n_m", body.torque_limit);
  take(from_, "torque_n_m", body.torque);
  take(from_, "linear_drag_per_s", body.linear_drag);
  take(from_, "angular_drag_per_s", body.angular_drag);
  read_surface(from_, body);
  check_kind();
  if (body.kind == BodyKind::rail) {
    read_rail(body);
  }
  if (from_.contains("motor") && body.kind != BodyKind::fixed && !body.driven_angular_velocity) {
    read_motor(body);
  }
  if (body.driven_angular_velocity && !from_.contains("torque_limit_n_m")) {
    refuse({"inertia_kg_m2", "angular_velocity_rad_s"}, "a motor without torque_limit_n_m");
  } else if (!body.driven_angular_velocity && body.kind != BodyKind::fixed) {
    refuse({"torque_limit_n_m"},
           "a body without driven_angular_velocity_rad_s or a motor of angular velocities");
  }
  return body;
}

}  // namespace

bool read_outline(const json& from, const std::string& place, BodyProperties& to,
                  std::vector<SceneProblem>& problems) {
  const bool polygon = from.contains("corners_m");
  if (polygon == from.contains("radius_m")) {
    problems.push_back(
        {place, polygon ? "radius_m makes it a disc and corners_m a polygon; leave one out"
                        : "radius_m is missing (or corners_m, of a polygon)"});
    return false;
  }
  if (!polygon) {
    refuse_keys(from, place, {"corner_radius_m"}, "a disc", problems);
    take(from, "radius_m", to.radius);
    return true;
  }
  for (const json& corner : from["corners_m"]) to.corners.push_back(vector_of(corner));
  take(from, "corner_radius_m", to.corner_radius);
  if (is_convex(to.corners)) return true;
  to.corners.clear();
  problems.push_back(
      {place + "/corners_m",
       "must go round a convex polygon counter-clockwise, with no corner on a straight side"});
  return false;
}

void read_surface(const json& from, BodyProperties& to) {
  if (from.contains("cable_friction") && from["cable_friction"].is_number()) {
    to.cable_friction = from["cable_friction"].get<double>();
  }
  take(from, "contact_friction", to.contact_friction);
  take(from, "restitution", to.restitution);
}

void check_mass_of_density(const json& from, const std::string& place, double mass,
                           std::vector<SceneProblem>& problems) {
  if (!from.contains("density_kg_m2") || (mass >= lightest_body && mass <= heaviest_body)) return;
  problems.push_back(
      {place + "/density_kg_m2",
       fmt::format("makes a body of {:.3g} kg of it, whose mass must be {:g} to {:g} "
                   "kg",
                   mass, lightest_body, heaviest_body)});
}

Body read_body(const json& from, const std::string& place, std::vector<SceneProblem>& problems) {
  return BodyReader(from, place, problems).read();
}

void refuse_keys(const json& from, const std::string& place,
                 std::initializer_list<const char*> keys, const std::string& what,
                 std::vector<SceneProblem>& problems) {
  for (const char* key : keys) {
    if (from.contains(key)) {
      problems.push_back(
          {place + "/" + key, fmt::format("has no effect on {}; leave it out", what)});
    }
  }
}

EndBy end_by(const json& end, const std::string& place, std::initializer_list<const char*> of_body,
             std::vector<SceneProblem>& problems) {
  if (end.contains("world_m") == end.contains("body")) {
    problems.push_back(
        {place, "give either world_m (a point that does not move) or body (and point_m on it)"});
    return EndBy::neither;
  }
  if (end.contains("body")) return EndBy::body;
  for (const char* key : of_body) {
    if (end.contains(key)) {
      problems.push_back({place + "/" + key, "belongs to body, not to world_m; leave one out"});
    }
  }
  return EndBy::world_m;
}

}  // namespace pinchlab
