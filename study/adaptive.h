// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which level of a graded series to show next: the one whose answer is expected to tell most about
// threshold and width. The Psi method of Kontsevich and Tyler (Vision Research 39 (1999) 2729).
//
// Hits are psi(x) = 1/2 + (1/2 - lapse) G(2 ln 19 (x - threshold) / width), G logistic, as the
// analysis has it. A posterior over a grid of thresholds and widths starts even; each answer
// multiplies it by its likelihood. Of every level the entropy of the posterior after its answer is
// expected, and the level with the least is shown. Nothing is drawn: the same answers give the same
// level.

#include <vector>

#include "study/config.h"
#include "study/session.h"

namespace pinchlab::study {

/// One answer to a graded clip.
struct GradedAnswer {
  double level = 0.0;
  bool is_hit = false;
};

/// The level to show after these answers; `levels` are those that there are, at least two, none
/// twice. Of levels that would tell as much the lowest.
double next_level(const std::vector<double>& levels, const std::vector<GradedAnswer>& answers);

/// Mean and standard deviation of the threshold's posterior.
struct ThresholdEstimate {
  double mean = 0.0, deviation = 0.0;
};
ThresholdEstimate estimate_threshold(const std::vector<double>& levels,
                                     const std::vector<GradedAnswer>& answers);

/// The levels of a series, increasing.
std::vector<double> levels_of(const Config& config, const std::string& series);

/// Is the level of this trial not chosen yet?
bool is_open(const PlannedTrial& trial);

/// Chooses the level of a session's next trial by its answers so far, where it is not chosen yet.
void choose_level(Session& session, const Config& config);

}  // namespace pinchlab::study
