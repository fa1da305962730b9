// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Stopping rules: looking at a study several times without finding more than there is.

#include <cstdint>
#include <string>
#include <vector>

#include "analysis/power.h"

namespace pinchlab::analysis {

/// How fast the error is spent (Lan and DeMets, Biometrika 70 (1983) 659), of each side's alpha:
/// 2 - 2 Phi(z_(alpha/2) / sqrt t) as O'Brien and Fleming's bounds do, or alpha ln(1 + (e - 1) t)
/// as Pocock's.
enum class Spending : std::uint8_t { obrien_fleming, pocock };

/// One look at the data.
struct Look {
  double fraction = 1.0;   ///< of the participants, in (0, 1]
  double z = 0.0;          ///< stop from |z| on
  double nominal_p = 1.0;  ///< two-sided: stop at p up to here
  double spent = 0.0;      ///< of alpha, so far
};

/// The bounds at increasing fractions, the last of which is 1: two-sided and symmetric, such that
/// a Brownian motion leaves them with probability alpha, by numerical integration (Armitage,
/// McPherson and Rowe, J. R. Stat. Soc. A 132 (1969) 235).
std::vector<Look> sequential_bounds(Spending spending, double alpha,
                                    const std::vector<double>& fractions);

/// What is stopped by.
enum class StoppingRule : std::uint8_t { fixed, obrien_fleming, pocock, bayes_factor };

struct StoppingQuestion {
  StoppingRule rule = StoppingRule::obrien_fleming;
  std::vector<std::int64_t> participants;  ///< at each look, increasing; fixed: the last one only
  double bayes_factor = 10.0;  ///< stop from it on, or from 1 / it down; one answer a participant
  PowerQuestion truth;         ///< share, alpha, trials, icc
};

/// What a rule does in simulated studies.
struct Characteristics {
  double finds = 0.0;              ///< share of studies that find a preference
  double finds_none = 0.0;         ///< that stop since there is none (Bayes factor)
  double participants = 0.0;       ///< on average
  std::vector<double> stopped_at;  ///< share of studies that stop at each look
};

struct StoppingAnswer {
  std::vector<Look> looks;        ///< with bounds of the rule; none for the Bayes factor
  Characteristics without, with;  ///< at a share of one half, and at the share asked for
  int studies = 0;
};

/// Simulates studies of participants whose answers resemble each other (beta-binomial), read by
/// sign flips over participants (exact; the exact binomial test where each answers once). Throws
/// InputError for a question out of range.
StoppingAnswer stopping_rule(const StoppingQuestion& question, int studies, std::uint64_t seed);

/// The answer in words, as `pinchlab stopping` prints it.
std::string stopping_text(const StoppingQuestion& question, const StoppingAnswer& answer);

/// The answer for `pinchlab study freeze` (base/design_file.h reads it).
std::string stopping_json(const StoppingQuestion& question, const StoppingAnswer& answer);

}  // namespace pinchlab::analysis
