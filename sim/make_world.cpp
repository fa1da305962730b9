// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/make_world.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/lay.h"
#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/cable/strung.h"
#include "sim/compound.h"
#include "sim/detect/contacts.h"
#include "sim/detect/detect.h"
#include "sim/detect/pinch.h"
#include "sim/first_tensions.h"
#include "sim/pieces.h"
#include "sim/scene_checks.h"
#include "sim/scene_words.h"
#include "sim/seams.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

World bodies_of_scene(const Scene& scene) {
  World world;
  world.step_length = step_length(scene);
  for (const Wall& wall : scene.walls) world.obstacles.push_back({wall, 0.0, -1, {}, {}});
  const std::size_t count = scene.bodies.size();
  world.bodies.reserve(count);
  for (std::vector<Vec2>* list : {&world.position, &world.velocity}) list->reserve(count);
  for (std::vector<double>* list : {&world.angle, &world.angular_velocity}) list->reserve(count);
  world.still_steps.reserve(count);
  world.pace.resize(count + scene.cables.size());
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
    if (body.carrier >= 0) world.carried.push_back(static_cast<int>(world.bodies.size()) - 1);
  }
  carry(world, world.carried);
  if (std::any_of(scene.bodies.begin(), scene.bodies.end(), is_polygon)) {
    join_walls(world.obstacles);
  }
  return world;
}

namespace {

void lay_cables(const Scene& scene, World& world) {
  const double allowed = overlap_allowed(scene);
  world.cables.clear();
  world.cables.reserve(scene.cables.size());
  CableState laid;
  LayScratch scratch;
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    // A copy is of its size, and what laying takes beside it serves the next. With that between
    // them the steps of a scene of many cables would go through a third more pages of memory.
    lay_cable(scene, world, allowed, c, laid, scratch);
    world.cables.push_back(laid);
  }
}

/// Whether a body that may change gaps is where the last obstacle is, a cable's end, by more than
/// `allowed` (m). Any is in its box, with room.
bool is_covered(const World& world, const BroadPhase& broad, double allowed) {
  const Obstacle& end = world.obstacles.back();
  const Vec2 thick = Vec2::Constant(end.radius);
  Contact with_obstacle;
  with_obstacle.wall = static_cast<int>(world.obstacles.size()) - 1;
  bool covered = false;
  visit_overlapping(broad, {end.a - thick, end.a + thick}, [&](int body) {
    const BodyProperties& properties = at(world.bodies, body);
    if (covered || !may_change_gaps(properties) || !bars(end, properties)) return;
    with_obstacle.a = body;
    with_obstacle.touch = is_polygon(properties) ? Touch::end_of_wall : Touch::circles;
    covered = gap_of(world, with_obstacle) < -allowed;
  });
  return covered;
}

/// Ends of cables that are held in the world bar the way as their cables do; but for one over which
/// a body starts. That of a cable with mass stands out by a tenth of its half width w: to a rim of
/// radius r that comes upon it there is a span of sqrt(0.2 (r + w) w) at least. Of one that shrank
/// to nothing the turning, and with it what flows along it, would have no bound.
void add_ends(const Scene& scene, const BroadPhase& broad, World& world) {
  const double allowed = overlap_allowed(scene);
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    const Cable& cable = scene.cables[c];
    if (cable.closed || is_passed(world.cables[c])) continue;
    for (const Attachment& end : {cable.start, cable.end}) {
      if (end.body >= 0) continue;
      Obstacle obstacle;
      obstacle.a = obstacle.b = end.point;
      obstacle.contact_friction = 0.0;
      obstacle.radius = (is_massed(world.cables[c]) ? 1.1 : 1.0) * cable.half_width;
      obstacle.cable = static_cast<int>(c);
      world.obstacles.push_back(obstacle);
      if (is_covered(world, broad, allowed)) world.obstacles.pop_back();
    }
  }
}

/// Strings nodes on cables with mass that run over bodies; whether there are any. What follows
/// spans to their ends without events (Events::at_steps) has such cables straight.
bool string_cables(const Scene& scene, World& world) {
  if (!locates_events(world.configuration)) return false;
  for (std::size_t c = 0; c < scene.cables.size(); ++c) {
    const Cable& given = scene.cables[c];
    if (given.first_node < 0) continue;
    world.strung.push_back(static_cast<int>(c));
    CableState& cable = world.cables[c];
    refuse_crowded_nodes(given, cable, c);
    cable.first_node = given.first_node;
    cable.nodes = given.nodes;
    if (given.node_tolerance > 0.0) cable.finest.resize(index(given.nodes) + 1);
    string_nodes(world, cable, scene.gravity);
  }
  return !world.strung.empty();
}

}  // namespace

World make_world(const Scene& scene, Configuration configuration) {
  if (configuration.iterations < 1) {
    throw std::invalid_argument(fmt::format("configuration: iterations must be at least 1, not {}",
                                            configuration.iterations));
  }
  if (!(configuration.error >= 0.0 && configuration.error < infinity)) {
    throw std::invalid_argument("configuration: error must be a number of at least 0");
  }
  refuse_impossible_figures(scene);
  refuse_slip_of_mass(scene, configuration);
  World world = bodies_of_scene(scene);
  Workspace work;
  // A scene is judged by the full model, whatever it is run with.
  world.configuration = Method::pinch;
  find_body_pairs(scene, world, work);
  refuse_overlaps(scene, world, work.broad_phase);
  lay_cables(scene, world);
  if (configuration.method == Method::pinch && locates_events(configuration)) {
    add_ends(scene, work.broad_phase, world);
  }
  if (locates_events(configuration) && std::ranges::any_of(world.cables, &CableState::piece)) {
    join_walls(world.obstacles);
    find_tips(world.obstacles);
    let_pass_at_ends(scene, overlap_allowed(scene), world);
    work = {};  // nothing is known of what pieces meet
  }
  find_body_pairs(scene, world, work);
  find_span_pairs(world, work);
  refuse_cables_through_bodies(scene, world, work.broad_phase);
  find_contacts(scene, world, work);
  configure_pinches(world, work);
  find_parts(world, work.contacts.contacts_kept, work.parts, work.parts_before);
  assign_contacts(world, work);
  refuse_squeezed_wraps(scene, world);
  world.configuration = configuration;
  if (configuration.error == 0.0 && locates_events(configuration)) {
    world.configuration.error = scene.error;
  }
  const bool creeps = std::ranges::any_of(world.cables, &CableState::creeps);
  if (configuration.method != Method::pinch ||
      (configuration.solver == Solver::iterative && creeps)) {
    lay_cables(scene, world);
    world.contacts.clear();
    work = {};  // nothing is known of the new contacts
    detect(scene, world, work);
  }
  if (string_cables(scene, world)) {
    work = {};  // nothing is known of nodes
    detect(scene, world, work);
    refuse_what_cannot_hang(scene, world);
    refuse_hanging_into_others(scene, world, work.broad_phase);
  }
  begin_slip(scene, world);
  find_first_tensions(scene, world, work);
  return world;
}

}  // namespace pinchlab
