// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/partial_slip.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/relax.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// A rough rim that sticks between two spans.
class StickingRim {
 public:
  /// Of the link of that number, which is given as much to its spans as Rim::gives tells, as are
  /// those at their other ends.
  StickingRim(const World& world, const CableState& cable, int number)
      : given(at(cable.rims, number).gives),
        before_(at(cable.segments, number)),
        after_(at(cable.segments, next_link(cable, number))),
        has_before_(before_.rest_length + at(cable.rims, previous_link(cable, number)).gives[1]),
        has_after_(after_.rest_length + at(cable.rims, next_link(cable, number)).gives[0]),
        stored_(stored_length(at(cable.links, number))) {
    const RimSpan on = span_on_rim(world, cable, index(number));
    const double width = (on.head - on.tail) / rim_cells;
    each_piece(world, cable, index(number), [&](double from, double to, double slope) {
      for (int k = std::clamp(static_cast<int>((from - on.tail) / width), 0, rim_cells - 1);
           k < rim_cells && on.tail + k * width < to; ++k) {
        const double begins = std::max(from, on.tail + k * width);
        const double ends = std::min(to, on.tail + (k + 1) * width);
        at(was_, k) += (1.0 - slope) * std::max(ends - begins, 0.0) / width;
      }
    });
    constexpr double most_told = 600.0;  // ln
    const Link& link = at(cable.links, number);
    const double all = at(world.bodies, link.body).cable_friction * link.wrap;
    of_cell_ = std::min(all, most_told) / rim_cells;
    const double falls = std::exp(-of_cell_), grows = std::exp(of_cell_);
    at(falls_, 0) = std::exp(-0.5 * of_cell_);
    at(grows_, 0) = std::exp(0.5 * of_cell_);
    for (int k = 1; k < rim_cells; ++k) {
      at(falls_, k) = at(falls_, k - 1) * falls;
      at(grows_, k) = at(grows_, k - 1) * grows;
    }
    for (int k = 0; k < rim_cells; ++k) at(strain_, k) = at(was_, k) / (1.0 - at(was_, k));
  }

  /// Lets it slide, from as if it had not. Whether its spans are given other than they were, by
  /// more than `rounding` (m) and all that can be told.
  bool slide(double rounding) {
    const std::array<double, 2> before = given;
    const std::array<End, 2> ends = flow();
    const auto has_come = [&](std::size_t end) {
      return std::abs(ends[end].comes - given[end]) <= rounding;
    };
    if (has_come(0) && has_come(1)) return false;
    constexpr int most_rounds = 10;  // by turns
    const double near = std::max(rounding, 1e-12 * stored_);
    for (int round = 0; round < most_rounds; ++round) {
      const bool settled = share(0, near), still = share(1, near);
      if (round > 0 && settled && still) break;
    }
    double comes = 0.0;
    for (int k = 0; k < rim_cells; ++k) comes += stored_ / rim_cells * (at(now, k) - at(was_, k));
    given[1] = comes - given[0];
    constexpr double rounding_of_energy = 1e-9;
    if (energy(now, given) > (1.0 + rounding_of_energy) * energy(was_, {})) share_evenly();
    return std::abs(given[0] - before[0]) > near || std::abs(given[1] - before[1]) > near;
  }

  RimCells now{};               // after it
  std::array<double, 2> given;  // m of material, to the span before it and the one after it

 private:
  struct End {
    double comes = 0.0;  // m
    double falls = 0.0;  // by so much for a metre that is given
  };

  /// Energy (m, over EA) of spans with so much more material and of a rim so stretched.
  double energy(const RimCells& stretch, const std::array<double, 2>& more) const {
    double sum = energy_of(before_.length, has_before_ + more[0]) +
                 energy_of(after_.length, has_after_ + more[1]);
    for (const double one : stretch) sum += energy_of(1.0, 1.0 - one) * stored_ / rim_cells;
    return sum;
  }

  /// Where both spans are all but slack friction holds nothing: the least energy that all of their
  /// material and the rim's can have. What is to spare stays where some is.
  void share_evenly() {
    double material = has_before_ + stored_ + has_after_;
    for (const double one : was_) material -= one * stored_ / rim_cells;
    const double way = before_.length + stored_ + after_.length;
    const double strain = std::max(way / material - 1.0, 0.0),
                 spare = std::max(material - way, 0.0);
    const double loose[2] = {std::max(has_before_ - before_.length, 0.0),
                             std::max(has_after_ - after_.length, 0.0)};
    const double all = loose[0] + loose[1];
    const auto lacks = [&](const Segment& span, double has, double own) {
      const double gets = all > 0.0 ? spare * own / all : 0.5 * spare;
      return span.length / (1.0 + strain) + gets - has;
    };
    now.fill(strain / (1.0 + strain));
    given = {lacks(before_, has_before_, loose[0]), lacks(after_, has_after_, loose[1])};
  }

  static double strain_with(const Segment& span, double has, double more) {
    constexpr double least_share = 0.1;  // of its material, that a span keeps
    const double least =
        std::max(least_share * span.rest_length, span.length / (1.0 + most_strain));
    const double left = std::max(has + more, least);
    return left > 0.0 ? std::max(span.length / left - 1.0, 0.0) : 0.0;
  }

  /// Cells from the tail on to where what either span asks of the rim is the same, as strain falls
  /// (or grows) away from them: a e^(-c x) = b e^(-c (n - x)).
  double meeting(double a, double b, bool falling) const {
    if (a == b) return 0.5 * rim_cells;
    const double apart = (std::log(a) - std::log(b)) / of_cell_;
    return 0.5 * (rim_cells + (falling ? apart : -apart));
  }

  /// What comes to either span with what it is given: what is stretched too little gives to the one
  /// that pulls it more, what is stretched too much takes from the other. Either way material comes
  /// to where tension is more. A cell in which these meet gives to both.
  std::array<End, 2> flow() {
    const double a = strain_with(before_, has_before_, given[0]);
    const double b = strain_with(after_, has_after_, given[1]);
    const double met_low = meeting(a, b, true), met_top = meeting(a, b, false);
    std::array<End, 2> ends;
    now = was_;
    for (int k = 0; k < rim_cells; ++k) {
      const int from_head = rim_cells - 1 - k;
      const double was = at(strain_, k);
      const double low_a = a * at(falls_, k), low_b = b * at(falls_, from_head);
      const double top_a = a * at(grows_, k), top_b = b * at(grows_, from_head);
      const double low = std::max(low_a, low_b), top = std::max(low, std::min(top_a, top_b));
      if (was >= low && was <= top) continue;
      const bool gives = was < low;
      const double is = gives ? low : top;
      at(now, k) = is / (1.0 + is);
      const double tail = std::clamp((gives ? met_low : met_top) - k, 0.0, 1.0);
      const double comes = stored_ / rim_cells * (at(now, k) - at(was_, k));
      const double falls = stored_ / rim_cells * is / ((1.0 + is) * (1.0 + is));
      ends[0].comes += tail * comes;
      ends[0].falls += tail * falls;
      ends[1].comes += (1.0 - tail) * comes;
      ends[1].falls += (1.0 - tail) * falls;
      if (tail <= 0.0 || tail >= 1.0) continue;
      const double moves = 0.5 * std::abs(comes) / of_cell_;  // as they meet elsewhere
      for (End& end : ends) end.falls += moves;
    }
    ends[0].falls *= falls_with(before_, a);
    ends[1].falls *= falls_with(after_, b);
    return ends;
  }

  /// Gives an end as much as then comes to it, which falls with what it is given: by Newton's steps
  /// within what is known to be less and more. Whether that was so already.
  bool share(std::size_t end, double near) {
    constexpr int most_rounds = 60;
    double less = -infinity, more = infinity;
    double& gives = given[end];
    for (int round = 0; round < most_rounds; ++round) {
      const End now_there = flow()[end];
      const double left = now_there.comes - gives;
      if (std::abs(left) <= near) return round == 0;
      (left > 0.0 ? less : more) = gives;
      gives += left / (1.0 + now_there.falls);
      if (gives <= less || gives >= more) gives = 0.5 * (less + more);
    }
    return false;
  }

  /// By how much the logarithm of a span's strain falls for a metre that it is given.
  static double falls_with(const Segment& span, double strain) {
    return strain > 0.0 ? (1.0 + strain) * (1.0 + strain) / (strain * span.length) : 0.0;
  }

  const Segment &before_, &after_;
  double has_before_ = 0.0, has_after_ = 0.0;  // m of material, with what their other ends give
  double stored_ = 0.0;                        // m
  double of_cell_ = 0.0;                       // mu phi
  RimCells was_{}, strain_{};
  RimCells falls_{}, grows_{};  // e^(-mu phi), and e^(mu phi), at their middles, phi from the tail
};

bool is_given(const std::array<double, 2>& gives) {
  return gives[0] != 0.0 || gives[1] != 0.0;
}

/// Whether such a rim is at a link.
bool is_sticking(const World& world, const CableState& cable, int number) {
  const Link& link = at(cable.links, number);
  const int before = previous_link(cable, number), after = next_link(cable, number);
  if (before < 0 || after < 0 || at(cable.rims, number).laid.empty()) return false;
  if (link.pinch_middle || !(link.wrap > 0.0)) return false;
  if (link.slip != Slip::stick && cable.density == 0.0) return false;
  return std::isfinite(at(world.bodies, link.body).cable_friction) && !is_smooth(world, link) &&
         !is_pinched_beside(cable, number) && !is_side(at(cable.links, before), link) &&
         !is_side(link, at(cable.links, after));
}

}  // namespace

void slide_in_part(const World& world, CableState& cable) {
  constexpr int most_sweeps = 30;
  const double rounding = 1e-15 * cable.length;
  const int count = static_cast<int>(cable.links.size());
  for (Rim& rim : cable.rims) rim.gives = {};
  // Rims that share spans, by turns.
  bool any = false;
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    int sticking = 0;
    bool changed = false;
    for (int i = 0; i < count; ++i) {
      if (!is_sticking(world, cable, i)) continue;
      ++sticking;
      StickingRim rim(world, cable, i);
      if (!rim.slide(rounding)) continue;
      at(cable.rims, i).gives = rim.given;
      changed = true;
    }
    any = any || changed;
    if (!changed || sticking < 2) break;
  }
  if (!any) return;
  for (int i = 0; i < count; ++i) {
    if (!is_given(at(cable.rims, i).gives)) continue;
    StickingRim rim(world, cable, i);
    rim.slide(rounding);
    lay_on_rim(world, cable, i, rim.now, rim.given[0]);
    at(cable.rims, i).gives = rim.given;
  }
  for (int i = 0; i < count; ++i) {
    const std::array<double, 2>& gives = at(cable.rims, i).gives;
    if (!is_given(gives)) continue;
    at(cable.segments, i).rest_length += gives[0];
    at(cable.segments, next_link(cable, i)).rest_length += gives[1];
  }
  update_wraps_and_rest_lengths(world, cable);
}

}  // namespace pinchlab
