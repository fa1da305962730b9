// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "demos/scenes/scene_json.h"
#include "sim/promises.h"
#include "sim/step.h"
#include "tests/fuzz/targets.h"

namespace pinchlab::fuzz {
namespace {

using nlohmann::json;

constexpr const char* file = "scene.json";

/// What follows this word makes scenes of all shapes; inputs without it stay what they were.
constexpr std::string_view shapes_word = "shapes:";

std::string_view after_word(std::string_view bytes) {
  if (bytes.starts_with(shapes_word)) bytes.remove_prefix(shapes_word.size());
  return bytes;
}

/// Bytes as choices; zeros when there are no more, so that small inputs make simple scenes.
class Choices {
 public:
  explicit Choices(std::string_view bytes) : bytes_(bytes) {}

  unsigned byte() {
    if (next_ >= bytes_.size()) return 0;
    return static_cast<unsigned char>(bytes_[next_++]);
  }
  /// 0 to n - 1.
  unsigned below(unsigned n) { return byte() % n; }
  bool one_in(unsigned n) { return byte() % n == 1; }
  /// low to high, in 65536 steps; 0 bytes give `low`.
  double between(double low, double high) {
    const unsigned value = 256 * byte() + byte();
    return low + (high - low) * static_cast<double>(value) / 65535.0;
  }
  /// 10^low to 10^high; 0 bytes give 1 where that is between.
  double magnitude(double low, double high) {
    const unsigned value = (256 * byte() + byte() + 32768) % 65536;
    return std::pow(10.0, low + (high - low) * static_cast<double>(value) / 65535.0);
  }

 private:
  std::string_view bytes_;
  std::size_t next_ = 0;
};

/// In cells of a grid, where most bodies find room, or anywhere.
json place(Choices& choices, unsigned index) {
  if (choices.one_in(16)) return {choices.between(-3.0, 3.0), choices.between(-3.0, 3.0)};
  constexpr double cell = 1.5;
  const unsigned column = index % 3, row = index / 3;
  return {cell * column - cell + choices.between(-0.3, 0.3),
          cell * row - cell + choices.between(-0.3, 0.3)};
}

json body(Choices& choices, unsigned index) {
  const char* kinds[] = {"free", "fixed_axle", "rail", "fixed"};
  const std::string kind = kinds[choices.below(4)];
  json b = {
      {"name", fmt::format("b{}", index)},
      {"kind", kind},
      {"radius_m", choices.one_in(16) ? choices.magnitude(-3.0, 1.0) : choices.between(0.1, 0.5)},
      {"position_m", place(choices, index)}};
  if (kind == "rail") b["rail_axis"] = {choices.between(-1.0, 1.0), 1.0};
  if (choices.one_in(3)) b["cable_friction"] = choices.between(0.0, 2.0);
  if (choices.one_in(5)) b["contact_friction"] = choices.between(0.0, 2.0);
  if (choices.one_in(5)) b["restitution"] = choices.between(0.0, 1.0);
  if (kind == "fixed") return b;
  b["mass_kg"] = choices.one_in(4) ? choices.magnitude(-9.0, 12.0) : choices.magnitude(-1.0, 1.0);
  if (choices.one_in(6)) {
    b["driven_angular_velocity_rad_s"] = choices.between(-20.0, 20.0);
    if (choices.one_in(2)) b["torque_limit_n_m"] = choices.magnitude(-6.0, 6.0);
  } else {
    if (choices.one_in(6)) b["torque_n_m"] = choices.between(-100.0, 100.0);
    if (choices.one_in(6)) b["angular_velocity_rad_s"] = choices.between(-50.0, 50.0);
    if (choices.one_in(8)) b["angular_drag_per_s"] = choices.magnitude(-2.0, 4.0);
  }
  if (kind == "fixed_axle") return b;
  if (choices.one_in(4)) {
    const double x = choices.between(-30.0, 30.0), y = choices.between(-30.0, 30.0);
    b["velocity_m_s"] = kind == "rail" ? json{x * b["rail_axis"][0].get<double>(), x} : json{x, y};
  }
  if (choices.one_in(8)) b["linear_drag_per_s"] = choices.magnitude(-2.0, 4.0);
  return b;
}

/// `wound` is the body that the cable is wound on there, null if on none: on that it can end at its
/// rim only.
json attachment(Choices& choices, unsigned bodies, const json& wound) {
  const unsigned kind = choices.below(4);
  if (kind == 0) return {{"world_m", {choices.between(-4.0, 4.0), choices.between(-4.0, 4.0)}}};
  const std::string name = fmt::format("b{}", choices.below(bodies));
  if (!wound.is_null() && (kind == 1 || wound == name)) {
    return {{"body", wound}, {"rim_angle_rad", choices.between(-4.0, 4.0)}};
  }
  return {{"body", name}, {"point_m", {choices.between(0.0, 0.07), choices.between(0.0, 0.07)}}};
}

json cable(Choices& choices, unsigned index, unsigned bodies) {
  json c = {{"name", fmt::format("c{}", index)},
            {"half_width_m",
             choices.one_in(8) ? choices.magnitude(-4.0, 0.0) : choices.between(0.01, 0.08)},
            {"wraps", json::array()}};
  const bool closed = choices.one_in(4) && bodies > 1;
  const unsigned wraps = bodies == 1 ? choices.below(2) : choices.below(5) + (closed ? 2 : 0);
  unsigned on = choices.below(bodies);
  for (unsigned i = 0; i < wraps; ++i) {
    // Never twice running on the same body, which extra turns are for.
    if (i > 0) on = (on + 1 + choices.below(bodies - 1)) % bodies;
    json wrap = {{"body", fmt::format("b{}", on)},
                 {"turn", choices.one_in(2) ? "counter_clockwise" : "clockwise"}};
    if (choices.one_in(8)) wrap["extra_turns"] = 1 + choices.below(3);
    c["wraps"].push_back(wrap);
  }
  if (closed) {
    c["closed"] = true;
  } else {
    const json none;
    c["start"] = attachment(choices, bodies, wraps > 0 ? c["wraps"].front()["body"] : none);
    c["end"] = attachment(choices, bodies, wraps > 0 ? c["wraps"].back()["body"] : none);
  }
  const bool elastic = choices.one_in(4);
  if (elastic) c["axial_stiffness_n"] = choices.magnitude(-3.0, 15.0);
  if (choices.one_in(2)) c["slack_m"] = choices.between(elastic ? -0.1 : 0.0, 1.0);
  return c;
}

json scene(Choices& choices) {
  const unsigned bodies = 1 + choices.below(8), cables = choices.below(4), walls = choices.below(3);
  const unsigned steps_per_frame[] = {4, 1, 2, 16};
  json s = {{"title", "Made of bytes"},
            {"duration_s", 1},
            {"frames_per_second", 60},
            {"steps_per_frame", steps_per_frame[choices.below(4)]},
            {"view", {{"low_m", {-5, -5}}, {"high_m", {5, 5}}}},
            {"baseline", {{"method", "cable"}, {"reason", "It must hold too."}}},
            {"bodies", json::array()},
            {"cables", json::array()},
            {"walls", json::array()}};
  if (choices.one_in(6))
    s["gravity_m_s2"] = {choices.between(-20.0, 20.0), choices.between(-20.0, 20.0)};
  for (unsigned i = 0; i < bodies; ++i) s["bodies"].push_back(body(choices, i));
  for (unsigned i = 0; i < cables; ++i) s["cables"].push_back(cable(choices, i, bodies));
  for (unsigned i = 0; i < walls; ++i) {
    const double x = choices.between(-6.0, 2.0), y = choices.between(-2.5, -6.0);
    s["walls"].push_back(
        {{"from_m", {x, y}}, {"to_m", {x + choices.between(1.0, 8.0), choices.between(y, -6.0)}}});
  }
  return s;
}

/// Whether an end of a cable is on that body's rim.
bool holds_a_rim(const json& scene, const json& body) {
  for (const json& cable : scene["cables"]) {
    for (const char* end : {"start", "end"}) {
      if (cable.contains(end) && cable[end].contains("rim_angle_rad") &&
          cable[end]["body"] == body["name"]) {
        return true;
      }
    }
  }
  return false;
}

/// Polygons in place of discs, layers on drums, and mass in cables.
void add_shapes(json& scene, Choices& choices) {
  for (json& body : scene["bodies"]) {
    const unsigned corners = 3 + choices.below(6);
    const double first = choices.between(0.0, 7.0), rounding = choices.between(0.0, 0.05);
    if (corners == 8 || holds_a_rim(scene, body)) continue;
    const double radius = body["radius_m"].get<double>();
    body.erase("radius_m");
    body["corner_radius_m"] = rounding;
    for (unsigned k = 0; k < corners; ++k) {
      const double angle = first + 2.0 * std::numbers::pi * k / corners;
      body["corners_m"].push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  for (json& cable : scene["cables"]) {
    const bool heavy = choices.one_in(2);
    const double mass = choices.magnitude(-3.0, 3.0);
    const unsigned nodes = choices.below(20);
    for (const char* end : {"start", "end"}) {
      if (cable.contains(end) && cable[end].contains("rim_angle_rad")) {
        cable[end]["layers"] = choices.one_in(2);
      }
    }
    if (!heavy || cable.contains("closed") || !cable["wraps"].empty()) continue;
    cable["mass_per_metre_kg"] = mass;
    if (nodes > 0) cable["nodes"] = nodes;
  }
}

/// Cables with mass over bodies, of which discs alone let them slip, some of which hang by nodes;
/// and those that hang between points bend. No bytes: none.
void add_heavy_cables(json& scene, Choices& choices) {
  bool any = false;
  for (json& cable : scene["cables"]) {
    const bool chosen = choices.below(3) == 1;
    if (chosen && cable.contains("mass_per_metre_kg")) {
      cable["bending_stiffness_n_m2"] = choices.magnitude(-9.0, 2.0);
    }
    if (!chosen || cable["wraps"].empty()) continue;
    cable["mass_per_metre_kg"] = choices.magnitude(-3.0, 3.0);
    any = true;
  }
  if (!any) return;
  for (json& body : scene["bodies"]) {
    if (body.contains("corners_m") || choices.one_in(2)) body.erase("cable_friction");
    if (!body.contains("shapes")) continue;
    for (json& shape : body["shapes"]) shape.erase("cable_friction");
  }
  for (json& cable : scene["cables"]) {
    if (cable["wraps"].empty() || !cable.contains("mass_per_metre_kg")) continue;
    const unsigned nodes = choices.below(40);
    if (nodes > 0) cable["nodes"] = nodes;
  }
}

json joint_end(Choices& choices, std::size_t bodies) {
  if (choices.one_in(3))
    return {{"world_m", {choices.between(-4.0, 4.0), choices.between(-4.0, 4.0)}}};
  return {{"body", fmt::format("b{}", choices.byte() % bodies)},
          {"point_m", {choices.between(0.0, 0.6), choices.between(-0.6, 0.6)}}};
}

/// Bars, hinges and springs between bodies, and stops on rails.
void add_joints(json& scene, Choices& choices) {
  const std::size_t bodies = scene["bodies"].size();
  const unsigned joints = choices.below(6);
  for (unsigned i = 0; i < joints; ++i) {
    const char* kinds[] = {"distance", "hinge", "spring"};
    json joint = {{"name", fmt::format("j{}", i)}, {"kind", kinds[choices.below(3)]}};
    if (joint["kind"] == "hinge") {
      joint["body"] = fmt::format("b{}", choices.byte() % bodies);
      if (choices.one_in(2)) joint["other"] = fmt::format("b{}", choices.byte() % bodies);
      joint["at_m"] = {choices.between(-2.0, 2.0), choices.between(-2.0, 2.0)};
    } else {
      joint["start"] = joint_end(choices, bodies);
      joint["end"] = joint_end(choices, bodies);
    }
    if (joint["kind"] == "spring") {
      joint["stiffness_n_m"] = choices.magnitude(-6.0, 15.0);
      if (choices.one_in(2)) joint["natural_length_m"] = choices.magnitude(-3.0, 1.0);
      if (choices.one_in(2)) joint["damping_n_s_m"] = choices.magnitude(-6.0, 12.0);
    }
    scene["joints"].push_back(joint);
  }
  for (json& body : scene["bodies"]) {
    if (body["kind"] != "rail" || !choices.one_in(2)) continue;
    body["travel_m"] = {-choices.between(0.0, 1.0), choices.between(0.01, 1.0)};
  }
}

/// Compounds of a body's outline and others about it, its centre of mass still its centre. What
/// lies on the body lies on the outline that it had.
void add_compounds(json& scene, Choices& choices) {
  for (json& body : scene["bodies"]) {
    const unsigned more = choices.below(4);
    if (more == 0) continue;
    json first;
    for (const char* key : {"radius_m", "corners_m", "corner_radius_m", "cable_friction",
                            "contact_friction", "restitution"}) {
      if (body.contains(key)) first[key] = body[key];
      body.erase(key);
    }
    body["shapes"] = json::array({first});
    for (unsigned k = 1; k < more; ++k) {
      json shape = {{"at_m", {choices.between(-0.7, 0.7), choices.between(-0.7, 0.7)}},
                    {"angle_rad", choices.between(0.0, 7.0)}};
      const double size = choices.magnitude(-2.0, 0.0);
      if (choices.one_in(2)) {
        shape["radius_m"] = size;
      } else {
        shape["corners_m"] = {{-size, -size}, {size, -size}, {0.0, 2.0 * size}};
      }
      body["shapes"].push_back(shape);
    }
    if (body["kind"] != "fixed") body["inertia_kg_m2"] = choices.magnitude(-3.0, 3.0);
    const std::string name = body["name"], outline = name + ":1";
    for (json& cable : scene["cables"]) {
      for (json& wrap : cable["wraps"]) {
        if (wrap["body"] == name) wrap["body"] = outline;
      }
      for (const char* end : {"start", "end"}) {
        if (cable.contains(end) && cable[end].value("body", "") == name)
          cable[end]["body"] = outline;
      }
    }
  }
}

/// Every number that leaves the simulator.
bool is_finite(const World& world) {
  for (std::size_t b = 0; b < world.position.size(); ++b) {
    if (!world.position[b].allFinite() || !world.velocity[b].allFinite()) return false;
    if (!std::isfinite(world.angle[b] + world.angular_velocity[b])) return false;
  }
  for (const CableState& cable : world.cables) {
    for (const Segment& segment : cable.segments) {
      if (!std::isfinite(segment.length + segment.rest_length + segment.tension)) return false;
    }
  }
  return true;
}

std::vector<std::string> run(const SceneFile& source, const Configuration& configuration,
                             int steps) {
  World world = start_world(source.scene, file, configuration);
  Workspace work;
  Promises promises(source.scene, world);
  for (int i = 0; i < steps; ++i) {
    if (step(source.scene, world, work) != StepStatus::ok) {
      if (world.failure.empty()) throw Finding("a failure that says nothing");
      return {world.failure};
    }
    if (!is_finite(world)) throw Finding(fmt::format("step {} was ok and is not finite", i + 1));
    promises.note(source.scene, world);
  }
  return promises.broken(source.scene, world);
}

/// What the first byte says.
Configuration configuration_of(std::string_view bytes) {
  const Configuration configurations[] = {Method::pinch, Method::cable, Method::pinch_no_contact,
                                          thesis_configuration()};
  const unsigned first = Choices(after_word(bytes)).byte();
  return configurations[first % 8 > 3 ? 0 : first % 8];
}

}  // namespace

std::string scene_of(std::string_view bytes) {
  const bool shapes = bytes.starts_with(shapes_word);
  bytes = after_word(bytes);
  Choices choices(bytes.substr(std::min<std::size_t>(1, bytes.size())));
  json made = scene(choices);
  if (shapes) {
    add_shapes(made, choices);
    add_joints(made, choices);
    add_compounds(made, choices);
    for (json& cable : made["cables"]) {
      const bool elastic =
          cable.contains("axial_stiffness_n") && !cable.contains("mass_per_metre_kg");
      if (choices.one_in(2) && elastic) cable["creep"] = false;
    }
    add_heavy_cables(made, choices);
  }
  return made.dump(1);
}

bool fuzz_world(std::string_view bytes) {
  try {
    run(parse_scene(scene_of(bytes), file), configuration_of(bytes), 240);
    return true;
  } catch (const SceneFileError& error) {
    must_name(error, file);
    return false;
  }
}

std::vector<std::string> told_of_world(std::string_view bytes, int steps) {
  return run(parse_scene(scene_of(bytes), file), configuration_of(bytes), steps);
}

bool fuzz_scene(std::string_view bytes) {
  try {
    const SceneFile source = parse_scene(bytes, file);
    const bool is_small = source.scene.bodies.size() <= 40 && source.scene.cables.size() <= 10;
    if (is_small) run(source, Method::pinch, 8);
    return true;
  } catch (const SceneFileError& error) {
    must_name(error, file);
    return false;
  }
}

}  // namespace pinchlab::fuzz
