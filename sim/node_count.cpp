// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/node_count.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/lay.h"
#include "sim/compound.h"
#include "sim/hanging.h"
#include "sim/make_world.h"
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
double shortest_piece(const Scene& scene, const Cable& cable, const Expected& expected) {
  const double wave = 2.0 * step_length(scene) *
                      std::sqrt(expected.tension / cable.mass_per_metre) / expected.phase;
  return std::max({2.0 * least_piece(cable), expected.length / (most_nodes_chosen + 1.0), wave,
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

/// kg, what a cable that runs over bodies has to hold: the heaviest of what hangs on it, or all,
/// where all is held up by something else. `held` is without it.
double hung_mass_over_bodies(const Cable& cable, const Held& held) {
  std::vector<int> roots;
  for (const int body : bodies_on(cable)) {
    if (body >= 0) roots.push_back(held.root_of(body));
  }
  std::ranges::sort(roots);
  roots.erase(std::unique(roots.begin(), roots.end()), roots.end());
  double heaviest = 0.0, all = 0.0;
  for (const int root : roots) {
    all += held.mass(root);
    if (!held.anchored(root)) heaviest = std::max(heaviest, held.mass(root));
  }
  return heaviest > 0.0 ? heaviest : all;
}

/// kg, what the cable has to hold: the lighter of what hangs at its ends; or all, where both are
/// held up by something else. `held` is without it.
double hung_mass(const Cable& cable, const Held& held) {
  if (!cable.wraps.empty()) return hung_mass_over_bodies(cable, held);
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

/// N, of one whose ends hold `hung` (kg).
double swinging_tension(const Scene& scene, const Cable& cable, double hung) {
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

/// N, where a span between what stands bears most: at its upper end. Its chord is `chord` (m), and
/// `slack` the share of its length that it is longer.
double sagging_tension(const Scene& scene, const Cable& cable, const Vec2& chord, double slack) {
  const double along = cable.mass_per_metre * std::abs(chord.dot(scene.gravity));      // N
  const double across = cable.mass_per_metre * std::abs(cross(chord, scene.gravity));  // N
  constexpr double rounding = 1e-9;  // of lengths of what is to be as long as its way
  double tension = slack > rounding ? across / (8.0 * std::sqrt(0.375 * slack)) : infinity;
  if (cable.axial_stiffness < infinity) {
    const double taut = std::max(-slack, 0.0) * cable.axial_stiffness;
    tension = std::min(tension, taut + std::cbrt(cable.axial_stiffness * across * across / 24.0));
  }
  if (tension == infinity)
    tension = 0.0;  // what cannot sag does not stand, or has no weight across
  return std::hypot(tension + along, 0.5 * across);
}

/// Whether a segment lies along a polygon's side.
bool is_laid_along(const CableState& laid, std::size_t segment) {
  const int before = previous_link(laid, static_cast<int>(segment));
  return is_side(at(laid.links, before), laid.links[segment]);
}

bool can_swing(const World& world, const Link& link) {
  return link.body >= 0 && can_move(at(world.bodies, mover_of(world, link.body)));
}

/// N, of one that runs over bodies and holds `hung` (kg), as it is laid.
double tension_over_bodies(const Scene& scene, const World& world, const Cable& cable,
                           const CableState& laid, double hung) {
  const double g = scene.gravity.norm(), mass = hung + cable.mass_per_metre * laid.length;
  double sagging = 0.0, swinging = 0.0;
  bool swings = false;
  for (std::size_t i = first_segment(laid); i < laid.segments.size(); ++i) {
    const Segment& span = laid.segments[i];
    if (!(span.length > 0.0) || is_laid_along(laid, i)) continue;
    const double slack = span.rest_length / span.length - 1.0;
    sagging = std::max(sagging, sagging_tension(scene, cable, span.length * span.direction, slack));
    const Link &from = at(laid.links, previous_link(laid, static_cast<int>(i))),
               &to = laid.links[i];
    if (!can_swing(world, from) && !can_swing(world, to)) continue;
    swings = true;
    const Vec2 apart = velocity_of(world, to) - velocity_of(world, from);
    swinging = std::max(swinging, mass * (3.0 * g + apart.squaredNorm() / span.length));
  }
  return swings ? swinging : sagging;
}

}  // namespace

double least_piece(const Cable& cable) {
  return (cable.start.layers || cable.end.layers ? 8.0 : 2.0) * cable.half_width;
}

std::string words_for_least_piece(const Cable& cable) {
  if (least_piece(cable) == 2.0 * cable.half_width) return "the cable is wide";
  return "four times the width of a cable in layers";
}

std::vector<Expected> expected_of(const Scene& scene, std::span<const std::size_t> cables) {
  Held held(scene);
  std::vector<bool> asked(scene.cables.size());
  for (const std::size_t c : cables) asked[c] = true;
  for (std::size_t c = 0; c < asked.size(); ++c) {
    if (!asked[c]) held.add(scene, scene.cables[c]);
  }
  std::vector<double> hung(cables.size());
  find_hung_masses(scene, cables, held, hung);
  std::optional<World> world;  // to lay what runs over bodies
  CableState laid;
  LayScratch scratch;
  std::vector<Expected> expected;
  for (std::size_t i = 0; i < cables.size(); ++i) {
    const Cable& cable = scene.cables[cables[i]];
    if (cable.wraps.empty()) {
      const bool stands = !end_moves(scene, cable.start) && !end_moves(scene, cable.end);
      expected.push_back({length_of(scene, cable), swinging_tension(scene, cable, hung[i]),
                          stands ? std::numbers::sqrt2 : 1.0});
      continue;
    }
    if (!world) world = bodies_of_scene(scene);
    lay_cable(scene, *world, overlap_allowed(scene), cables[i], laid, scratch);
    expected.push_back({laid.length, tension_over_bodies(scene, *world, cable, laid, hung[i])});
  }
  return expected;
}

int count_pieces(const Scene& scene, const Cable& cable, const Expected& expected,
                 const std::string& place) {
  const double length = expected.length;
  int pieces = cable.nodes + 1;
  if (cable.nodes <= 0) {
    const double most = length / shortest_piece(scene, cable, expected);
    pieces = 2 * std::max(1, static_cast<int>(most / 2.0));
  }
  if (cable.node_tolerance != 0.0 && cable.wraps.empty())
    pieces = count_adaptive_pieces(cable, pieces, place);
  const double piece = length / pieces;
  if (const double least = least_piece(cable); piece <= least) {
    throw SceneError(
        place + "/nodes",
        fmt::format("pieces of {} between nodes are no longer than {}; at most {} nodes fit",
                    in_mm(piece), words_for_least_piece(cable),
                    static_cast<int>(length / least) - 1));
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
