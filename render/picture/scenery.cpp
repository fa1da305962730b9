// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/scenery.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <tuple>

#include "base/at.h"
#include "render/picture/cable_path.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/step.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr int most_snapshots = 40;       // a configuration
constexpr std::size_t most_labels = 40;  // that are kept out of the way; more stand below
constexpr double unreadable = 3.0;       // off the view or on another; 1: on a body or line
constexpr double widening = 0.3;         // off a view that is fitted to the labels afterwards

bool is_driven(const Body& body) {
  return strongest_drive(body) != 0.0;
}

/// A moment of the rehearsal.
struct Snapshot {
  std::vector<Vec2> position;  // m, one a body
  std::vector<double> angle;   // rad
  struct Line {
    Vec2 a, b;          // m
    double half_width;  // m
  };
  std::vector<Line> lines;  // the cables' centre lines, walls and rails
};

struct Box {
  Vec2 low = Vec2::Constant(infinity), high = Vec2::Constant(-infinity);
  void add(const Vec2& p, double r) {
    low = low.cwiseMin(p - Vec2::Constant(r));
    high = high.cwiseMax(p + Vec2::Constant(r));
  }
  bool is_empty() const { return low.x() > high.x(); }
  bool touches(const Box& other) const {
    return (low.array() < other.high.array()).all() && (other.low.array() < high.array()).all();
  }
  bool within(const Box& other) const {
    return (low.array() >= other.low.array()).all() && (high.array() <= other.high.array()).all();
  }
  bool touches_disc(const Vec2& centre, double radius) const {
    return (centre.cwiseMax(low).cwiseMin(high) - centre).norm() < radius;
  }
  /// Whether a line of some width runs through it: the line is cut to the widened box.
  bool touches_line(const Snapshot::Line& line) const {
    double from = 0.0, to = 1.0;
    for (int axis = 0; axis < 2; ++axis) {
      const double d = line.b[axis] - line.a[axis];
      double enter = (low[axis] - line.half_width - line.a[axis]) / d;
      double leave = (high[axis] + line.half_width - line.a[axis]) / d;
      if (d == 0.0) {
        const bool beside = line.a[axis] < low[axis] - line.half_width ||
                            line.a[axis] > high[axis] + line.half_width;
        if (beside) return false;
        continue;
      }
      if (enter > leave) std::swap(enter, leave);
      from = std::max(from, enter);
      to = std::min(to, leave);
    }
    return from < to;
  }
};

/// m across.
double widest_cable(const Scene& scene) {
  double width = 0.0;
  for (const Cable& cable : scene.cables) width = std::max(width, 2.0 * cable.half_width);
  return width;
}

class Rehearsal {
 public:
  Rehearsal(const Scene& scene, Scenery& scenery) : scene_(scene), scenery_(scenery) {}

  void play(const Configuration& configuration, const OnStep& on_step) {
    World world = make_world(scene_, configuration);
    Workspace work;
    const int every = std::max(1, scene_.frame_count / most_snapshots);
    for (int frame = 0; frame < scene_.frame_count; ++frame) {
      look(world, frame % every == 0);
      for (int i = 0; i < scene_.steps_per_frame; ++i) {
        if (step(scene_, world, work) != StepStatus::ok) return;
        if (on_step) on_step(world);
      }
    }
  }

  void see_rails();
  void fit_view();
  void fit_labels();
  void place_arrows();
  void place_labels();

 private:
  void look(const World& world, bool keep);
  double overlap(const Box& box, const Vec2& offset, std::size_t body, bool is_label) const;
  bool is_on_body(const Box& box, std::size_t body, const Snapshot& snapshot) const;
  double reach(std::size_t body, const Vec2& way) const;
  Box label_box(const SceneryLabel& label) const;
  Vec2 arrow_centre(std::size_t body) const;
  std::vector<Vec2> label_places(std::size_t body, const Box& box, bool choose) const;

  const Scene& scene_;
  Scenery& scenery_;
  std::vector<Snapshot> snapshots_;
  Box all_;  // bodies and cables at all times
};

void Rehearsal::look(const World& world, bool keep) {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    all_.add(world.position[i], body.radius);
    if (body.kind != BodyKind::rail) continue;
    const double along = body.rail_axis.dot(world.position[i] - body.position);
    scenery_.travel[i].low = std::min(scenery_.travel[i].low, along);
    scenery_.travel[i].high = std::max(scenery_.travel[i].high, along);
  }
  for (const CableState& cable : world.cables) {
    if (!cable.fills) continue;
    for (const Link& link : cable.links) {
      if (link.body < 0) continue;
      double& fullest = at(scenery_.fullest, link.body);
      fullest = std::max(fullest, thickness_of_layers(link));
    }
  }
  if (!keep) return;
  Snapshot snapshot;
  snapshot.position = world.position;
  snapshot.angle = world.angle;
  for (const Wall& wall : scene_.walls) {
    snapshot.lines.push_back({wall.a, wall.b, 2.5 * scenery_.line()});
  }
  std::vector<StripPoint> points;
  for (const CableState& cable : world.cables) {
    if (cable.joint == Joint::pin || cable.joint == Joint::stop)
      continue;  // not where they are shown
    points.clear();
    append_cable_path(scene_, world, cable, 0.1 * cable.half_width, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      all_.add(points[i].position, cable.half_width);
      if (i == 0) continue;
      snapshot.lines.push_back({points[i - 1].position, points[i].position, cable.half_width});
    }
  }
  snapshots_.push_back(std::move(snapshot));
}

/// Rails, once it is known how far they go, are in the way of labels, too.
void Rehearsal::see_rails() {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    const Body& body = scene_.bodies[i];
    if (body.kind != BodyKind::rail || !scenery_.travel[i].own) continue;
    const auto [low, high] = rail_ends(scene_, scenery_, i);
    for (Snapshot& snapshot : snapshots_) {
      snapshot.lines.push_back({low, high, 1.5 * scenery_.line()});
    }
  }
}

/// The motion's extent with a margin of a twentieth.
void Rehearsal::fit_view() {
  for (const Wall& wall : scene_.walls) {
    all_.add(wall.a, 0.0);
    all_.add(wall.b, 0.0);
  }
  if (all_.is_empty()) return;
  const double margin = 0.05 * std::max((all_.high - all_.low).maxCoeff(), 1e-3);
  scenery_.view = {all_.low - Vec2::Constant(margin), all_.high + Vec2::Constant(margin)};
}

/// The same for labels, once they have their places, and for the plates that hold anchors.
void Rehearsal::fit_labels() {
  Box frame{scenery_.view.low, scenery_.view.high};
  for (const Anchor& anchor : scenery_.anchors) {
    const double r = anchor_radius(scenery_, anchor.half_width);
    const Vec2 foot = anchor.point + 1.1 * r * anchor.outward;
    for (const double side : {-1.3, 1.3})
      frame.add(foot + side * r * left(anchor.outward), 0.5 * r);
  }
  for (const SceneryLabel& label : scenery_.labels) {
    const Box box = label_box(label);
    for (const Snapshot& snapshot : snapshots_) {
      const Vec2 centre = snapshot.position[label.body] + label.offset;
      frame.add(centre + box.low, 0.2 * scenery_.text());
      frame.add(centre + box.high, 0.2 * scenery_.text());
    }
  }
  scenery_.view = {frame.low, frame.high};
}

/// Whether a box lies on a body's own outline.
bool Rehearsal::is_on_body(const Box& box, std::size_t body, const Snapshot& snapshot) const {
  const Body& b = scene_.bodies[body];
  const Vec2& centre = snapshot.position[body];
  if (!is_polygon(b)) return box.touches_disc(centre, b.radius);
  if (box.touches_disc(centre, inner_radius(b))) return true;
  const auto corner = [&](std::size_t k) {
    return Vec2(centre + turned(b.corners[k % b.corners.size()], snapshot.angle[body]));
  };
  for (std::size_t k = 0; k < b.corners.size(); ++k) {
    if (box.touches_line({corner(k), corner(k + 1), b.corner_radius})) return true;
  }
  return false;
}

/// m, how far a body's outlines ever come from its centre to one side, a unit vector.
double Rehearsal::reach(std::size_t body, const Vec2& way) const {
  double most = 0.0;
  for (const int i : outlines_of(scene_, static_cast<int>(body))) {
    const Body& outline = at(scene_.bodies, i);
    for (const Snapshot& snapshot : snapshots_) {
      const double middle = way.dot(at(snapshot.position, i) - snapshot.position[body]);
      if (!is_polygon(outline)) most = std::max(most, middle + outline.radius);
      for (const Vec2& corner : outline.corners) {
        const Vec2 here = turned(corner, at(snapshot.angle, i));
        most = std::max(most, middle + way.dot(here) + outline.corner_radius);
      }
    }
  }
  return most;
}

/// Share of the snapshots in which a box that goes with a body would lie on a cable, a wall, a rail
/// or another body, or a label on its own; out of the view counts as `unreadable`.
double Rehearsal::overlap(const Box& box, const Vec2& offset, std::size_t body,
                          bool is_label) const {
  const Box frame{scenery_.view.low, scenery_.view.high};
  const double outside = is_label && scenery_.look.fit_view ? widening : unreadable;
  double sum = 0.0;
  for (const Snapshot& snapshot : snapshots_) {
    const Vec2 centre = snapshot.position[body] + offset;
    const Box there{centre + box.low, centre + box.high};
    if (!there.within(frame)) sum += outside;
    sum += static_cast<double>(
        std::any_of(snapshot.lines.begin(), snapshot.lines.end(),
                    [&](const Snapshot::Line& line) { return there.touches_line(line); }));
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      if (!scene_.bodies[i].outlined || (i == body && !is_label)) continue;  // but its shapes
      sum += static_cast<double>(is_on_body(there, i, snapshot));
    }
  }
  return sum / static_cast<double>(std::max<std::size_t>(1, snapshots_.size()));
}

Box Rehearsal::label_box(const SceneryLabel& label) const {
  // A character of DejaVu Sans is about 0.6 em wide; in UTF-8 each begins with a byte other than
  // 10xxxxxx.
  const double height = scenery_.text();
  const auto characters =
      std::ranges::count_if(label.text, [](char c) { return (c & 0xC0) != 0x80; });
  const Vec2 half(0.5 * 0.6 * height * static_cast<double>(characters), 0.6 * height);
  return {-half, half};
}

/// A motor's arrow stands beside its rim, where cables leave room.
void Rehearsal::place_arrows() {
  for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
    if (!is_driven(scene_.bodies[i])) continue;
    double least = infinity;
    for (int k = 0; k < 8; ++k) {
      constexpr std::array<int, 8> order = {2, 1, 3, 0, 4, 7, 5, 6};  // from the top down
      const double middle = at(order, k) * 0.25 * std::numbers::pi;
      double sum = 0.0;
      for (int j = -2; j <= 2; ++j) {
        const double angle = middle + 0.28 * j;
        const double r = arrow_radius(scene_, scenery_, i);
        const Vec2 half = Vec2::Constant(1.2 * scenery_.unit());
        sum += overlap({-half, half}, r * Vec2(std::cos(angle), std::sin(angle)), i, false);
      }
      if (sum < least - 1e-9) {
        least = sum;
        scenery_.arrow_middle[i] = middle;
      }
    }
  }
}

/// The middle of a motor's arrow, m from the body's centre.
Vec2 Rehearsal::arrow_centre(std::size_t body) const {
  const double angle = scenery_.arrow_middle[body];
  return arrow_radius(scene_, scenery_, body) * Vec2(std::cos(angle), std::sin(angle));
}

/// Where a label may stand beside its body, the best place first: near its outline, then beyond the
/// cable that may run round it.
std::vector<Vec2> Rehearsal::label_places(std::size_t i, const Box& box, bool choose) const {
  using enum LabelSide;
  const LabelSide wanted = scenery_.look.bodies.empty() ? automatic : scenery_.look.bodies[i].side;
  const double gap = 0.5 * scenery_.text();
  std::vector<Vec2> places;
  for (const double beyond : {0.0, widest_cable(scene_)}) {
    constexpr std::array<std::tuple<LabelSide, int, int>, 8> sides = {{{below, 0, -1},
                                                                       {right, 1, 0},
                                                                       {left, -1, 0},
                                                                       {above, 0, 1},
                                                                       {automatic, 1, -1},
                                                                       {automatic, -1, -1},
                                                                       {automatic, 1, 1},
                                                                       {automatic, -1, 1}}};
    for (const auto& [side, x, y] : sides) {
      if (wanted != automatic ? side != wanted : !choose && side != below) continue;
      const bool diagonal = x != 0 && y != 0;
      const double off = reach(i, Vec2(x, y).normalized()) + beyond;
      const Vec2 away = box.high + Vec2::Constant(diagonal ? 0.72 * off + 0.5 * gap : off + gap);
      places.emplace_back(x * away.x(), y * away.y());
    }
  }
  return places;
}

void Rehearsal::place_labels() {
  const bool choose = scenery_.labels.size() <= most_labels;
  std::vector<std::pair<std::size_t, Box>> placed;
  for (SceneryLabel& label : scenery_.labels) {
    const Box box = label_box(label);
    double least = infinity;
    for (const Vec2& offset : label_places(label.body, box, choose)) {
      double sum = choose ? overlap(box, offset, label.body, true) : 0.0;
      const Box here{offset + box.low, offset + box.high};
      if (is_driven(scene_.bodies[label.body]) &&
          here.touches_disc(arrow_centre(label.body), 5.2 * scenery_.unit())) {
        sum += 2.0;
      }
      for (const auto& [other, other_box] : placed) {
        for (const Snapshot& snapshot : snapshots_) {
          const Vec2 apart = snapshot.position[other] - snapshot.position[label.body];
          const bool both = here.touches({apart + other_box.low, apart + other_box.high});
          sum += unreadable * static_cast<double>(both) / static_cast<double>(snapshots_.size());
        }
      }
      if (sum >= least - 1e-9) continue;
      least = sum;
      label.offset = offset;
    }
    if (choose) {
      placed.push_back({label.body, {label.offset + box.low, label.offset + box.high}});
    }
  }
}

/// By default the mass of what can move: it matters for what the cable does.
std::vector<SceneryLabel> find_labels(const Scene& scene, const SceneLook& look) {
  std::vector<SceneryLabel> labels;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    const Body& body = scene.bodies[i];
    if (body.node || body.carrier >= 0) continue;
    const BodyLook own = look.bodies.empty() ? BodyLook{} : look.bodies[i];
    std::string text = can_move(body) ? fmt::format("{:.4g} kg", own.mass.value_or(body.mass)) : "";
    if (own.label) text = *own.label;
    if (!text.empty()) labels.push_back({i, text, Vec2::Zero()});
  }
  return labels;
}

std::vector<Anchor> find_anchors(const Scene& scene) {
  std::vector<Anchor> anchors;
  if (scene.cables.empty()) return anchors;
  const World world = make_world(scene, scene.baseline);
  for (const CableState& cable : world.cables) {
    if (cable.closed || cable.links.size() < 2) continue;
    if (cable.joint == Joint::pin || cable.joint == Joint::stop)
      continue;  // not where they are shown
    const Segment &first = cable.segments[1], &last = cable.segments.back();
    if (cable.links.front().body < 0) {
      anchors.push_back({cable.links.front().offset, -first.direction, cable.half_width});
    }
    if (cable.links.back().body < 0) {
      anchors.push_back({cable.links.back().offset, last.direction, cable.half_width});
    }
  }
  return anchors;
}

/// Whether bodies are on one line, as far as `near` (m) tells.
bool on_one_line(const Body& a, const Body& b, double near) {
  constexpr double same = 1e-6;
  return a.kind == BodyKind::rail && b.kind == BodyKind::rail &&
         std::abs(cross(a.rail_axis, b.rail_axis)) <= same &&
         std::abs(cross(a.rail_axis, b.position - a.position)) <= same * near;
}

/// Bodies on one line whose ways meet run on one rail.
void share_rails(const Scene& scene, std::vector<Travel>& travel, double near) {
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    for (std::size_t j = 0; j < i;) {
      const Body &a = scene.bodies[i], &b = scene.bodies[j];
      const double shift = a.rail_axis.dot(b.position - a.position);
      const double sense = a.rail_axis.dot(b.rail_axis), reach = a.radius + b.radius;
      const double low = std::min(sense * travel[j].low, sense * travel[j].high) + shift;
      const double high = std::max(sense * travel[j].low, sense * travel[j].high) + shift;
      if (!travel[j].own || !on_one_line(a, b, near) || low - reach > travel[i].high ||
          high + reach < travel[i].low) {
        ++j;
        continue;
      }
      travel[i] = {std::min(travel[i].low, low), std::max(travel[i].high, high),
                   std::max(travel[i].reach, travel[j].reach), true};
      travel[j].own = false;
      j = 0;  // the longer way may meet others
    }
  }
}

}  // namespace

std::pair<Vec2, Vec2> rail_ends(const Scene& scene, const Scenery& scenery, std::size_t body) {
  const Body& b = scene.bodies[body];
  const Travel& travel = scenery.travel[body];
  const double beyond = 1.5 * travel.reach;
  return {b.position + (travel.low - beyond) * b.rail_axis,
          b.position + (travel.high + beyond) * b.rail_axis};
}

double anchor_radius(const Scenery& scenery, double half_width) {
  return std::max(1.7 * half_width, 0.6 * scenery.unit());
}

double arrow_radius(const Scene& scene, const Scenery& scenery, std::size_t body) {
  return scene.bodies[body].radius + widest_cable(scene) + scenery.fullest[body] +
         1.6 * scenery.unit();
}

Scenery set_scenery(const Scene& scene, const SceneLook& look, const Theme& theme,
                    std::span<const Configuration> configurations, const OnStep& on_step) {
  Scenery scenery;
  scenery.theme = theme;
  scenery.look = look;
  scenery.view = scene.view;
  for (const Body& body : scene.bodies) scenery.travel.push_back({0.0, 0.0, body.radius, true});
  scenery.fullest.resize(scene.bodies.size());
  scenery.arrow_middle.assign(scene.bodies.size(), 0.5 * std::numbers::pi);
  scenery.labels = find_labels(scene, look);
  scenery.anchors = find_anchors(scene);
  const bool asks = look.fit_view || !scenery.labels.empty() ||
                    std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
                      return body.kind == BodyKind::rail || is_driven(body);
                    });
  if (!asks) return scenery;
  Rehearsal rehearsal(scene, scenery);
  for (const Configuration& configuration : configurations) rehearsal.play(configuration, on_step);
  share_rails(scene, scenery.travel, scenery.unit());
  rehearsal.see_rails();
  if (look.fit_view) rehearsal.fit_view();
  rehearsal.place_arrows();
  rehearsal.place_labels();
  if (look.fit_view) rehearsal.fit_labels();
  return scenery;
}

Scenery set_scenery(const Scene& scene, const SceneLook& look, const Theme& theme,
                    const OnStep& on_step) {
  const std::array<Configuration, 2> pair = {Method::pinch, scene.baseline};
  return set_scenery(scene, look, theme, pair, on_step);
}

}  // namespace pinchlab
