// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/compound_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "demos/scenes/body_reader.h"
#include "demos/scenes/json_values.h"
#include "sim/compound.h"

namespace pinchlab {
namespace {

using nlohmann::json;

std::vector<Shape> shapes_of(const json& from, const std::string& place,
                             std::vector<SceneProblem>& problems) {
  std::vector<Shape> shapes;
  for (std::size_t i = 0; i < from.size(); ++i) {
    Shape shape;
    read_outline(from[i], fmt::format("{}/{}", place, i), shape.properties, problems);
    read_surface(from[i], shape.properties);
    take(from[i], "at_m", shape.place);
    take(from[i], "angle_rad", shape.angle);
    shapes.push_back(shape);
  }
  return shapes;
}

/// Gives the compound the mass of its density, and its centre of mass to its shapes and its
/// position; where that is in the file's frame (m). A compound of both mass and inertia has it at
/// that frame's origin, and so has one that a motor turns about an axle whatever that takes: its
/// weight moves nothing.
Vec2 weigh(const json& from, const std::string& place, std::vector<Shape>& shapes, Body& body,
           std::vector<SceneProblem>& problems) {
  const Plate plate = plate_of(shapes);
  if (from.contains("density_kg_m2")) {
    body.mass = from["density_kg_m2"].get<double>() * plate.area;
    check_mass_of_density(from, place, body.mass, problems);
  }
  if (body.kind == BodyKind::fixed || (from.contains("mass_kg") && body.inertia)) {
    return Vec2::Zero();
  }
  if (body.kind == BodyKind::fixed_axle && body.driven_angular_velocity &&
      body.torque_limit == infinity) {
    const double second_moment = plate.second_moment + plate.area * plate.centre.squaredNorm();
    body.inertia = body.mass / plate.area * second_moment;
    return Vec2::Zero();
  }
  if (body.kind == BodyKind::fixed_axle && plate.centre.norm() > 1e-6 * std::sqrt(plate.area)) {
    problems.push_back(
        {place + "/shapes",
         fmt::format(
             "have their centre of mass at [{}, {}], off the axle; take that away from each "
             "at_m, hold a free body by a hinge, or give mass_kg and inertia_kg_m2",
             plate.centre.x(), plate.centre.y())});
  }
  for (Shape& shape : shapes) shape.place -= plate.centre;
  body.position += turned(plate.centre, body.angle);
  return plate.centre;
}

/// m, of a point of the shape's frame from its outline; below 0: inside.
double distance_to(const BodyProperties& shape, const Vec2& point) {
  if (!is_polygon(shape)) return point.norm() - shape.radius;
  return outside_of(shape.corners, point).distance - shape.corner_radius;
}

}  // namespace

std::vector<Vec2> read_shapes(const json& bodies, Scene& scene,
                              std::vector<SceneProblem>& problems) {
  std::vector<Vec2> origins(bodies.size(), Vec2::Zero());
  constexpr std::size_t most_shapes = 10'000;
  std::size_t count = 0;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (!bodies[b].contains("shapes")) continue;
    const std::string place = fmt::format("/bodies/{}", b);
    count += bodies[b]["shapes"].size();
    if (count > most_shapes) {
      problems.push_back({place + "/shapes",
                          fmt::format("bodies up to this one have more than {} shapes; give them "
                                      "fewer",
                                      most_shapes)});
      return origins;
    }
    const std::size_t before = problems.size();
    std::vector<Shape> shapes = shapes_of(bodies[b]["shapes"], place + "/shapes", problems);
    if (problems.size() > before) continue;
    origins[b] = -weigh(bodies[b], place, shapes, scene.bodies[b], problems);
    add_shapes(scene, static_cast<int>(b), shapes);
  }
  return origins;
}

Attachment attached_to_shape(const Scene& scene, int compound, const Vec2& point) {
  Attachment nearest;
  double least = infinity;
  for (const int shape : outlines_of(scene, compound)) {
    const Body& body = at(scene.bodies, shape);
    const Vec2 here = turned(Vec2(point - body.seat), -body.seat_angle);
    const double distance = distance_to(body, here);
    if (distance >= least) continue;
    least = distance;
    nearest.body = shape;
    nearest.point = here;
  }
  return nearest;
}

}  // namespace pinchlab
