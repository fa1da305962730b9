// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How the cost of scenes of many independent things grows with their number.

#include <string>
#include <vector>

#include "analysis/experiments/step_cost.h"

namespace pinchlab::experiments {

/// One kind of scene at several sizes, two decades apart: the processor time of a step, or of
/// making the world. Beside it the same where every call finds its memory in no cache, so that
/// small scenes wait for theirs as large ones do; and what memory alone takes: of a copy of the
/// World over an old one, or of a new copy, which reads and writes the state once and does nothing
/// else.
struct GrowthResult {
  std::string what;
  std::vector<int> sizes;
  std::vector<double> seconds;       // medians, as are all
  std::vector<double> cold_seconds;  // in no cache
  std::vector<double> copy_seconds;

  double exponent() const { return exponent_of(seconds); }
  double cold_exponent() const { return exponent_of(cold_seconds); }
  /// s a unit, that a growth exponent of `most` leaves from the least size to the greatest.
  double left_by(double most) const;
  /// s a unit, by which a copy grows from the least size to the greatest.
  double taken_by_copy() const;

 private:
  double exponent_of(const std::vector<double>& of) const;
};

std::vector<GrowthResult> measure_growth(const Effort& effort);

/// What independent parts cost one another, each figure a median over one step of a resting cable.
struct IndependenceResult {
  double two_cables = 0.0;   // times, of two resting cables that share nothing
  double with_a_disc = 0.0;  // times, of one resting cable beside a falling disc
  double velocities = 0.0;   // times, of velocities_now against its step on a swinging chain
};
IndependenceResult measure_independence(const Effort& effort);

}  // namespace pinchlab::experiments
