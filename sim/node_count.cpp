// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/node_count.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/at.h"
#include "sim/hanging.h"
#include "sim/outline.h"
#include "sim/scene_error.h"
#include "sim/scene_words.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// m: bending of the shortest wave, along which nodes alternate, has
///     omega = 4 sqrt(EI / rho) / l^2,
/// and a leapfrog is stable to omega h = 2.
double shortest_that_bends(const Scene& scene, const Cable& cable) {
  const double speed = std::sqrt(cable.bending_stiffness / cable.mass_per_metre);  // m^2/s
  return std::sqrt(2.0 * step_length(scene) * speed);
}

/// m, of each piece, where the scene leaves it open; a tenth more than the least that bends stably,
/// since at omega h = 2 itself round-off grows.
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

/// Bodies that a cable is on; -1 for the world.
std::vector<int> bodies_on(const Cable& cable) {
  std::vector<int> bodies;
  if (!cable.closed) bodies = {cable.start.body, cable.end.body};
  for (const Wrap& wrap : cable.wraps) bodies.push_back(wrap.body);
  return bodies;
}

/// What cables and joints hold together: sets of bodies as trees. The lesser set's root becomes a
/// child of the other's and no path is shortened, so that what was added last can be taken back.
class Held {
 public:
  /// Without cables.
  explicit Held(const Scene& scene) : sets_(scene.bodies.size()) {
    for (std::size_t b = 0; b < sets_.size(); ++b) {
      const Body& body = scene.bodies[b];
      sets_[b] = {static_cast<int>(b), 1, can_move(body) ? body.mass : 0.0,
                  body.carrier < 0 && body.kind != BodyKind::free};
    }
    for (std::size_t b = 0; b < sets_.size(); ++b) {
      if (scene.bodies[b].carrier >= 0) join(static_cast<int>(b), scene.bodies[b].carrier);
    }
  }

  void add(const Scene& scene, const Cable& cable) {
    const std::vector<int> bodies = bodies_on(cable);
    const auto first = std::find_if(bodies.begin(), bodies.end(), [](int b) { return b >= 0; });
    if (first == bodies.end()) return;
    for (const int b : bodies) {
      if (b >= 0) join(*first, b);
    }
    Set& set = change(root_of(*first));
    if (!cable.closed) set.mass += cable.mass_per_metre * length_of(scene, cable);
    if (std::find(bodies.begin(), bodies.end(), -1) != bodies.end()) set.anchored = true;
  }

  std::size_t mark() const { return before_.size(); }

  void take_back(std::size_t mark) {
    for (; before_.size() > mark; before_.pop_back()) {
      at(sets_, before_.back().first) = before_.back().second;
    }
  }

  int root_of(int body) const {
    while (at(sets_, body).parent != body) body = at(sets_, body).parent;
    return body;
  }
  double mass(int root) const { return at(sets_, root).mass; }        // kg, of what can move
  bool anchored(int root) const { return at(sets_, root).anchored; }  // something holds it up

 private:
  struct Set {
    int parent = 0, size = 0;  // the rest of roots only
    double mass = 0.0;
    bool anchored = false;
  };

  Set& change(int place) {
    before_.emplace_back(place, at(sets_, place));
    return at(sets_, place);
  }

  void join(int a, int b) {
    a = root_of(a);
    b = root_of(b);
    if (a == b) return;
    if (at(sets_, a).size < at(sets_, b).size) std::swap(a, b);
    const Set& lesser = at(sets_, b);
    Set& greater = change(a);
    greater.size += lesser.size;
    greater.mass += lesser.mass;
    greater.anchored = greater.anchored || lesser.anchored;
    change(b).parent = a;
  }

  std::vector<Set> sets_;                    // one a body
  std::vector<std::pair<int, Set>> before_;  // places, and what was there before each change
};

/// kg, what the cable has to hold: the lighter of what hangs at its ends; or all, where both are
/// held up by something else. `held` is without it.
double hung_mass(const Cable& cable, const Held& held) {
  double least = infinity, all = 0.0;
  int before = -1;
  for (const Attachment* end : {&cable.start, &cable.end}) {
    if (end->body < 0) continue;
    const int root = held.root_of(end->body);
    if (root == before) continue;
    before = root;
    all += held.mass(root);
    if (!held.anchored(root)) least = std::min(least, held.mass(root));
  }
  return std::min(least, all);
}

/// The same of every cable of `asked`, at its place there; `held` is without any of them. Either
/// half is asked with the other added, and so on: n log n cables are added for n that are asked.
void find_hung_masses(const Scene& scene, std::span<const std::size_t> asked, Held& held,
                      std::span<double> masses) {
  if (asked.empty()) return;
  if (asked.size() == 1) {
    masses[0] = hung_mass(scene.cables[asked[0]], held);
    return;
  }
  const std::size_t half = asked.size() / 2, mark = held.mark();
  for (const std::size_t c : asked.subspan(half)) held.add(scene, scene.cables[c]);
  find_hung_masses(scene, asked.first(half), held, masses.first(half));
  held.take_back(mark);
  for (const std::size_t c : asked.first(half)) held.add(scene, scene.cables[c]);
  find_hung_masses(scene, asked.subspan(half), held, masses.subspan(half));
  held.take_back(mark);
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
  constexpr int pieces = 64;  // sag to 1 / n^2 of it; only the number of nodes comes of it
  const double length = length_of(scene, cable);
  const Vec2 d = place_of(scene, cable.end) - place_of(scene, cable.start);
  const Vec2 weight = cable.mass_per_metre * length * scene.gravity;
  if (!(cable.slack > 0.0)) return weight.norm();
  const Hanging chain = hang(std::vector<Vec2>(pieces - 1, weight / pieces),
                             std::vector<double>(pieces, length / pieces), {}, {d});
  return chain.tension + 0.5 * weight.norm() / pieces;  // half of a piece hangs at either end
}

/// `hung` (kg) is what the cable has to hold.
double expected_tension(const Scene& scene, const Cable& cable, double hung) {
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
  const double mass = hung + cable.mass_per_metre * length;
  return mass * (g + (2.0 * fall + speed * speed) / length);
}

}  // namespace

std::vector<double> expected_tensions(const Scene& scene, std::span<const std::size_t> cables) {
  Held held(scene);
  std::vector<bool> asked(scene.cables.size());
  for (const std::size_t c : cables) asked[c] = true;
  for (std::size_t c = 0; c < asked.size(); ++c) {
    if (!asked[c]) held.add(scene, scene.cables[c]);
  }
  std::vector<double> tensions(cables.size());
  find_hung_masses(scene, cables, held, tensions);
  for (std::size_t i = 0; i < cables.size(); ++i) {
    tensions[i] = expected_tension(scene, scene.cables[cables[i]], tensions[i]);
  }
  return tensions;
}

int count_pieces(const Scene& scene, const Cable& cable, double length, double tension,
                 const std::string& place) {
  const double most = length / shortest_piece(scene, cable, length, tension);
  int pieces = cable.nodes > 0 ? cable.nodes + 1 : 2 * std::max(1, static_cast<int>(most / 2.0));
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
