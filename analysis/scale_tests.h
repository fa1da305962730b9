// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Are the methods of one scale equal, do participants and demonstrations agree, and are choices
// transitive? README.md gives formulas and sources.

#include <cstdint>
#include <vector>

#include "analysis/scale_model.h"

namespace pinchlab::analysis {

/// Are all methods equal? The score statistic of Bradley and Terry's model, S = D' L^+ D with D the
/// wins minus the losses of each method and L the Laplacian of the numbers of comparisons without
/// ties. Each part of the methods that is not compared with the others takes one df.
struct EqualScale {
  double score = 0.0, df = 0.0;
  Estimate p_chi_square;  ///< takes all answers as independent; none where all are ties
  /// participants turn all their choices round or none: exact up to 16 participants, otherwise
  /// from random signs
  Estimate p_sign_flip;
  bool exact = false;
};
EqualScale equal_scale(std::size_t methods, const std::vector<PairChoices>& choices,
                       std::uint64_t seed, int resamples);

/// Do the demonstrations differ in their scales? Sum over demonstrations and methods of the squared
/// residual wins of the common fit; each participant's demonstrations are exchanged at random.
struct ScaleDifference {
  Estimate statistic, p;
};
ScaleDifference scale_difference(ScaleModel model, const ScaleFit& fit, std::size_t methods,
                                 std::size_t demonstrations,
                                 const std::vector<PairChoices>& choices, std::uint64_t seed,
                                 int resamples);

/// How often each number of circular triads comes among the 2^(m(m-1)/2) ways to choose among m
/// methods, 3 to 7 (Kendall and Babington Smith, Biometrika 31 (1940) 324, table).
std::vector<double> triad_counts(std::size_t methods);

/// Circular triads: A over B over C over A, in the choices of one participant who saw each pair of
/// a demonstration once and chose.
struct Transitivity {
  long rounds = 0;       ///< participants times demonstrations that can be judged
  long triads = 0;       ///< circular ones in all
  long without = 0;      ///< rounds without any
  double most = 0.0;     ///< of one round
  double by_chance = 0;  ///< of one round, on average, C(m, 3) / 4
  Estimate consistence;  ///< Kendall's zeta, mean over rounds: 1 none, 0 as many as can be
  Estimate p;            ///< that chance gives so few: exact up to 7 methods, otherwise normal
  std::vector<long> of_participant;         ///< circular triads by participant
  std::vector<long> rounds_of_participant;  ///< by participant
  /// triples of methods, by the shares of all answers, where a over b and b over c, but
  long triples = 0;
  long weak = 0;      ///< not a over c
  long moderate = 0;  ///< a over c less often than the rarer of the two
  long strong = 0;    ///< less often than the more frequent
};
Transitivity transitivity(std::size_t methods, std::size_t participants, std::size_t demonstrations,
                          const std::vector<PairChoices>& choices);

/// How well the scale of all others foretells one participant: log-likelihood an answer. Far out:
/// below the first quartile by 1.5 interquartile ranges (Perez-Ortiz and Mantiuk, arXiv
/// 1712.03686).
struct ObserverFit {
  std::uint32_t participant = 0;
  std::int64_t answers = 0;
  Estimate log_likelihood;  ///< an answer
  bool is_far_out = false;
};
constexpr std::size_t fewest_compared = 5;  ///< for quartiles to mean something; else nobody is
std::vector<ObserverFit> observer_fits(ScaleModel model, std::size_t methods,
                                       std::size_t participants,
                                       const std::vector<PairChoices>& choices);

/// Why it is not known who is far out; empty where it is.
std::string why_nobody_is_compared(const std::vector<ObserverFit>& fits);

}  // namespace pinchlab::analysis
