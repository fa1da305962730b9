// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/promises.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/mass.h"
#include "sim/compound.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {
namespace {

/// "12 %", "0.3 %", "4.12e+05 %".
std::string percent(double share) {
  return fmt::format("{:.3g} %", 100.0 * share);
}

std::string name_of_side(const Scene& scene, const World& world, int side) {
  if (side >= 0) return fmt::format("body '{}'", at(scene.bodies, side).name);
  const int cable = at(world.obstacles, -1 - side).cable;
  return cable < 0 ? fmt::format("wall {}", -1 - side)
                   : fmt::format("the end of cable '{}'", at(scene.cables, cable).name);
}

/// A body, or, counted on after all bodies, a cable.
std::string name_of_item(const Scene& scene, int item) {
  const auto bodies = static_cast<int>(scene.bodies.size());
  return item < bodies ? fmt::format("body '{}'", at(scene.bodies, item).name)
                       : fmt::format("cable '{}'", at(scene.cables, item - bodies).name);
}

}  // namespace

Promises::Promises(const Scene& scene, const World& world) {
  const bool direct = world.configuration.solver == Solver::direct;
  most_strain_ = direct ? limits_.strain : limits_.sweeps_strain;
  watches_gaps_ = direct && world.configuration.method == Method::pinch;
  watches_energy_ = direct;
  watches_loss_ = direct && locates_events(world.configuration);
  if (watches_energy_) energy_.start(scene, world);
}

void Promises::note_value(Promise promise, double value, double limit, std::int64_t step, int item,
                          int other) {
  Worst& now = now_[static_cast<std::size_t>(promise)];
  if (value <= limit || (now.steps_broken > 0 && value <= now.value)) return;  // NaN is noted
  now = {value, step, step, 1, item, other};
}

// Per cable, what its spans have too much, and what it has in all.
void Promises::note_cables(const Scene& scene, const World& world) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    double length = 0.0, excess = 0.0;
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      length += wrapped_material(world, cable, i);
      if (i < first_segment(cable)) continue;
      const Segment& segment = cable.segments[i];
      length += material_of_span(cable, i);
      if (!segment.pinched) excess += std::max(segment.length - segment.rest_length, 0.0);
    }
    note_value(Promise::length, std::abs(length - cable.length) / cable.length, limits_.length,
               world.step, static_cast<int>(c), -1);
    if (scene.cables[c].axial_stiffness < infinity) continue;
    note_value(Promise::strain, excess / cable.length, most_strain_, world.step,
               static_cast<int>(c), -1);
  }
}

namespace {

/// Whether a span is between two places of one rigid body: it has no tension of its own.
bool is_within_body(const World& world, const CableState& cable, std::size_t span) {
  const int tail = at(cable.links, previous_link(cable, static_cast<int>(span))).body;
  const int head = cable.links[span].body;
  return tail >= 0 && head >= 0 && mover_of(world, tail) == mover_of(world, head);
}

/// N, of a span; within a rigid body the lesser of those on either side of it, between which it is
/// by the capstan law.
double least_tension(const World& world, const CableState& cable, std::size_t span) {
  if (!is_within_body(world, cable, span)) return cable.segments[span].tension;
  const std::size_t first = first_segment(cable), count = cable.links.size() - first;
  double least = infinity;
  for (const std::size_t way : {std::size_t{1}, count - 1}) {
    std::size_t i = span;
    for (std::size_t k = 1; k < count && is_within_body(world, cable, i); ++k) {
      const std::size_t next = first + (i - first + way) % count;
      if (!cable.closed && (way == 1 ? next < i : next > i)) break;  // beyond an end
      i = next;
    }
    if (!is_within_body(world, cable, i)) least = std::min(least, cable.segments[i].tension);
  }
  return least < infinity ? least : 0.0;
}

/// Of a span's length: a parabola's sag, w l^2 / 8 T by the weight w of a metre across the span.
/// Where nothing pulls, that of a parabola with the cable that it has to spare, whose length is
/// l + 8 s^2 / 3 l.
double sag_of(const Segment& span, double tension, double weight_of_metre) {
  if (tension > 0.0) return std::min(0.125 * weight_of_metre * span.length / tension, 1.0);
  const double spare = std::max(span.rest_length - span.length, 0.0);
  return std::min(std::sqrt(0.375 * spare / span.length), 1.0);
}

}  // namespace

void Promises::note_sag(const Scene& scene, const World& world) {
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    if (!is_massed(cable) || cable.nodes > 0) continue;
    double sag = 0.0;
    for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
      const Segment& span = cable.segments[i];
      const Link& tail = at(cable.links, previous_link(cable, static_cast<int>(i)));
      if (!(span.length > 0.0) || is_side(tail, cable.links[i])) continue;
      const double weight = cable.density * std::abs(cross(span.direction, scene.gravity));
      if (weight > 0.0) sag = std::max(sag, sag_of(span, least_tension(world, cable, i), weight));
    }
    note_value(Promise::straight, sag, limits_.sag, world.step, static_cast<int>(c), -1);
  }
}

namespace {

/// How much nearer a contact is than it may be (m). Of two polygons the first of their contacts has
/// that by which they overlap, whatever points they are found to touch with.
double depth_of(const World& world, std::size_t number) {
  const Contact& contact = world.contacts[number];
  const double depth = contact.target - contact.gap;
  if (contact.b < 0 || contact.touch == Touch::circles || contact.touch == Touch::piece) {
    return depth;
  }
  const bool is_first = number == 0 || world.contacts[number - 1].a != contact.a ||
                        world.contacts[number - 1].b != contact.b;
  return is_first ? std::max(depth, -separation(world, contact.a, contact.b)) : depth;
}

}  // namespace

void Promises::note_contacts(const Scene& scene, const World& world) {
  for (std::size_t i = 0; i < world.contacts.size(); ++i) {
    const Contact& contact = world.contacts[i];
    const double depth = depth_of(world, i);
    if (!(depth > 0.0)) continue;
    double size = contact.target;
    if (!(size > 0.0)) {
      size = at(scene.bodies, contact.a).radius;
      if (contact.b >= 0) size = std::min(size, at(scene.bodies, contact.b).radius);
    }
    note_value(Promise::squeeze, depth / size, limits_.squeeze, world.step, contact.a,
               contact.b >= 0 ? contact.b : -1 - contact.wall);
  }
}

void Promises::note(const Scene& scene, const World& world) {
  now_.fill({});
  note_cables(scene, world);
  note_sag(scene, world);
  if (watches_gaps_) note_contacts(scene, world);
  if (watches_energy_) {
    const auto [gained, lost] = energy_.note(scene, world);
    note_value(Promise::energy, gained.share, limits_.energy, world.step, gained.item, -1);
    if (watches_loss_) {
      note_value(Promise::loss, lost.share, limits_.loss, world.step, lost.item, -1);
    }
  }
  if (world.diagnostics.fallbacks > fallbacks_) {
    note_value(Promise::settled, 1.0, 0.0, world.step, -1, -1);
    fallbacks_ = world.diagnostics.fallbacks;
  }
  for (std::size_t i = 0; i < worst_.size(); ++i) {
    if (now_[i].steps_broken == 0) continue;
    Worst& worst = worst_[i];
    const std::int64_t first = worst.steps_broken == 0 ? world.step : worst.first_step;
    const std::int64_t steps = worst.steps_broken + 1;
    if (worst.steps_broken == 0 || !(now_[i].value <= worst.value)) worst = now_[i];
    worst.first_step = first;
    worst.steps_broken = steps;
  }
}

std::vector<std::string> Promises::broken(const Scene& scene, const World& world) const {
  std::vector<std::string> lines;
  for (std::size_t i = 0; i < worst_.size(); ++i) {
    const Worst& w = worst_[i];
    if (w.steps_broken == 0) continue;
    const auto energy_changed = [&](const char* how, const char* why, double limit) {
      return fmt::format(
          "{} and what has acted on it {} {} of the energy at play there, and {} (limit {})",
          name_of_item(scene, w.item), how, percent(w.value), why, percent(limit));
    };
    std::string what;
    switch (static_cast<Promise>(i)) {
      case Promise::strain:
        what = fmt::format("cable '{}' was stretched by {} of its length (limit {})",
                           at(scene.cables, w.item).name, percent(w.value), percent(most_strain_));
        break;
      case Promise::squeeze:
        what = fmt::format(
            "body '{}' and {} came too near by {} of the cable between them, or of "
            "the smaller radius (limit {})",
            at(scene.bodies, w.item).name, name_of_side(scene, world, w.other), percent(w.value),
            percent(limits_.squeeze));
        break;
      case Promise::length:
        what =
            fmt::format("cable '{}' lost or gained {} of its length (limit {})",
                        at(scene.cables, w.item).name, percent(w.value), percent(limits_.length));
        break;
      case Promise::energy:
        what = energy_changed("gained", "nothing drives them", limits_.energy);
        break;
      case Promise::loss:
        what = energy_changed("lost", "nothing took it", limits_.loss);
        break;
      case Promise::straight:
        what = fmt::format(
            "cable '{}', whose spans have mass and are straight, would have hung by {} of one's "
            "length (limit {}); {}",
            at(scene.cables, w.item).name, percent(w.value), percent(limits_.sag), nodes_cure);
        break;
      default:
        what =
            "the solver did not settle and took its fallback, or no repair met what was too long "
            "or too near";
    }
    lines.push_back(fmt::format(
        "{}: first in step {} (t = {:.6g} s), in {} of {} steps{}", what, w.first_step,
        static_cast<double>(w.first_step) * world.step_length, w.steps_broken, world.step,
        w.step == w.first_step ? ""
                               : fmt::format(", most at t = {:.6g} s",
                                             static_cast<double>(w.step) * world.step_length)));
  }
  return lines;
}

}  // namespace pinchlab
