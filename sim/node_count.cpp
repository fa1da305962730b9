// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/node_count.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/at.h"
#include "sim/hanging.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"
#include "sim/trees.h"

namespace pinchlab {

namespace {

/// m: bending of the shortest wave, along which nodes alternate, has omega = 4 sqrt(EI / rho) /
/// l^2, and a leapfrog is stable to omega h = 2.
double shortest_that_bends(const Scene& scene, const Cable& cable) {
  const double speed = std::sqrt(cable.bending_stiffness / cable.mass_per_metre);  // m^2/s
  return std::sqrt(2.0 * step_length(scene) * speed);
}

/// m, of each piece, where the scene leaves it open.
double shortest_piece(const Scene& scene, const Cable& cable, double length, double tension) {
  const double wave = 2.0 * step_length(scene) * std::sqrt(tension / cable.mass_per_metre);
  return std::max({4.0 * cable.half_width, length / (most_nodes_chosen + 1.0), wave,
                   1.1 * shortest_that_bends(scene, cable)});
}

/// A power of two, as pieces become one in pairs.
int count_adaptive_pieces(const Cable& cable, int pieces, const std::string& place) {
  int power = 2;
  while (2 * power <= pieces) power *= 2;
  if (cable.nodes > 0 && power != pieces) {
    throw SceneError(place + "/nodes",
                     fmt::format("pieces of a cable whose number of nodes adapts become one in "
                                 "pairs, so that it has 1, 3, 7, 15 and so on at most; {} or {}, "
                                 "not {}",
                                 power - 1, 2 * power - 1, cable.nodes));
  }
  return power;
}

double length_of(const Scene& scene, const Cable& cable) {
  return (place_of(scene, cable.end) - place_of(scene, cable.start)).norm() + cable.slack;
}

/// What cables and joints hold together without one of the cables.
struct Held {
  std::vector<int> root;       // trees.h, of bodies
  std::vector<double> mass;    // kg, of what can move, at each root
  std::vector<bool> anchored;  // something of it is held up, at each root
};

/// Bodies that a cable is on; -1 for the world.
std::vector<int> bodies_on(const Cable& cable) {
  std::vector<int> bodies;
  if (!cable.closed) bodies = {cable.start.body, cable.end.body};
  for (const Wrap& wrap : cable.wraps) bodies.push_back(wrap.body);
  return bodies;
}

Held held_without(const Scene& scene, std::size_t without) {
  const std::size_t count = scene.bodies.size();
  Held held{std::vector<int>(count), std::vector<double>(count), std::vector<bool>(count)};
  for (std::size_t b = 0; b < count; ++b) held.root[b] = static_cast<int>(b);
  for (std::size_t b = 0; b < count; ++b) {
    if (scene.bodies[b].carrier >= 0) join(held.root, static_cast<int>(b), scene.bodies[b].carrier);
  }
  const auto visit = [&](auto&& note) {  // with a body of each, and whether all are bodies
    for (std::size_t c = 0; c < scene.cables.size(); ++c) {
      const std::vector<int> bodies = bodies_on(scene.cables[c]);
      const auto first = std::find_if(bodies.begin(), bodies.end(), [](int b) { return b >= 0; });
      if (c != without && first != bodies.end()) note(scene.cables[c], bodies, *first);
    }
  };
  visit([&held](const Cable&, const std::vector<int>& bodies, int first) {
    for (const int b : bodies) {
      if (b >= 0) join(held.root, first, b);
    }
  });
  for (std::size_t b = 0; b < count; ++b) {
    const Body& body = scene.bodies[b];
    const auto root = index(find_root(held.root, static_cast<int>(b)));
    if (can_move(body)) held.mass[root] += body.mass;
    if (body.carrier < 0 && body.kind != BodyKind::free) held.anchored[root] = true;
  }
  visit([&held, &scene](const Cable& cable, const std::vector<int>& bodies, int first) {
    const auto root = index(find_root(held.root, first));
    if (!cable.closed) held.mass[root] += cable.mass_per_metre * length_of(scene, cable);
    if (std::find(bodies.begin(), bodies.end(), -1) != bodies.end()) held.anchored[root] = true;
  });
  return held;
}

/// kg, what the cable has to hold: the lighter of what hangs at its ends; or all, where both are
/// held up by something else.
double hung_mass(const Scene& scene, std::size_t c) {
  Held held = held_without(scene, c);
  const Cable& cable = scene.cables[c];
  double least = infinity, all = 0.0;
  int before = -1;
  for (const Attachment* end : {&cable.start, &cable.end}) {
    if (end->body < 0) continue;
    const int root = find_root(held.root, end->body);
    if (root == before) continue;
    before = root;
    all += at(held.mass, root);
    if (!held.anchored[index(root)]) least = std::min(least, at(held.mass, root));
  }
  return std::min(least, all);
}

bool end_moves(const Scene& scene, const Attachment& end) {
  return end.body >= 0 && can_move(at(scene.bodies, end.body));
}

Vec2 velocity_of(const Scene& scene, const Attachment& end) {
  if (end.body < 0) return Vec2::Zero();
  const Body& body = at(scene.bodies, end.body);
  const Vec2 turning = body.angular_velocity * left(place_of(scene, end) - body.position);
  return (can_move(body) ? body.velocity : Vec2(Vec2::Zero())) + turning;
}

/// N, of a cable that hangs between two points that stand.
double hanging_tension(const Scene& scene, const Cable& cable) {
  constexpr int pieces = 64;
  const double length = length_of(scene, cable);
  const Vec2 d = place_of(scene, cable.end) - place_of(scene, cable.start);
  const Vec2 weight = cable.mass_per_metre * length * scene.gravity;
  if (!(cable.slack > 0.0)) return weight.norm();
  const Hanging chain = hang(std::vector<Vec2>(pieces - 1, weight / pieces), length / pieces, d);
  return chain.tension + 0.5 * weight.norm() / pieces;  // half of a piece hangs at either end
}

}  // namespace

double expected_tension(const Scene& scene, std::size_t c) {
  const Cable& cable = scene.cables[c];
  const double g = scene.gravity.norm(), length = length_of(scene, cable);
  if (!(length > 0.0)) return 0.0;  // which spread_nodes refuses
  const bool start_moves = end_moves(scene, cable.start), moves = end_moves(scene, cable.end);
  if (!start_moves && !moves) return g > 0.0 ? hanging_tension(scene, cable) : 0.0;
  const Vec2 d = place_of(scene, cable.end) - place_of(scene, cable.start);
  const double along = d.dot(scene.gravity);  // J/kg, by which the end lies lower than the start
  double fall = g * length;
  if (moves) fall = std::max(fall, g * length - along);
  if (start_moves) fall = std::max(fall, g * length + along);
  const double speed = (velocity_of(scene, cable.end) - velocity_of(scene, cable.start)).norm();
  const double mass = hung_mass(scene, c) + cable.mass_per_metre * length;
  return mass * (g + (2.0 * fall + speed * speed) / length);
}

int count_pieces(const Scene& scene, const Cable& cable, double length, double tension,
                 const std::string& place) {
  int pieces =
      cable.nodes > 0
          ? cable.nodes + 1
          : std::max(2, static_cast<int>(length / shortest_piece(scene, cable, length, tension)));
  if (cable.node_tolerance != 0.0) pieces = count_adaptive_pieces(cable, pieces, place);
  const double piece = length / pieces;
  if (piece <= 2.0 * cable.half_width) {
    throw SceneError(
        place + "/nodes",
        fmt::format(
            "pieces of {} between nodes are no longer than the cable is wide; at most {} nodes fit",
            in_mm(piece), static_cast<int>(length / (2.0 * cable.half_width)) - 1));
  }
  if (const double least = shortest_that_bends(scene, cable); piece < least) {
    throw SceneError(
        place + "/nodes",
        fmt::format("pieces of {} between nodes bend to and fro faster than {} steps a frame "
                    "follow; at most {} nodes, or more steps a frame",
                    in_mm(piece), scene.steps_per_frame,
                    std::max(static_cast<int>(length / least) - 1, 1)));
  }
  return pieces;
}

}  // namespace pinchlab
