// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Who sees what, in which order, on which side: a pure function of seed, participant number and
// configuration. Trials are counterbalanced over participants by their numbers.

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pinchlab::study {

enum class TrialKind { main, training, attention };
enum class Side { left, right };

const char* to_string(TrialKind kind);
const char* to_string(Side side);
Side opposite(Side side);

/// A clip of a graded series beside its reference.
struct GradedClip {
  std::string series;
  double level = 0.0;

  friend bool operator==(const GradedClip&, const GradedClip&) = default;
};

/// What a plan depends on besides seed and participant.
struct PlanOptions {
  std::vector<std::string> demonstrations;    ///< names, none twice, at least one
  std::vector<std::string> training;          ///< shown first, in this order; not analysed
  std::vector<std::string> attention_checks;  ///< names of pairs with an obvious answer
  int repetitions = 1;                        ///< times each demonstration is shown, 1 to 50
  bool both_orders = false;                   ///< each showing once more with the sides swapped
  /// Three and more that are compared two by two in each demonstration; empty: the method under
  /// test with its baseline. Then repetitions is 1 and both_orders false.
  std::vector<std::string> methods;
  int pairs_per_demonstration = 0;  ///< of methods, that a participant sees; 0: all
  /// Of a study of thresholds; `demonstrations` are then its series.
  std::vector<GradedClip> graded;
  /// Of each series, whose levels are chosen by the answers (adaptive.h); 0: each clip is shown
  /// `repetitions` times.
  int adaptive_trials = 0;
};

struct PlannedTrial {
  TrialKind kind = TrialKind::main;
  std::string demonstration;  ///< or the name of the attention check
  Side pinch = Side::left;    ///< side of the method under test; in a check, of the right answer
  int round = 0;              ///< of main trials: how often the demonstration came before
  /// What the sides show: `first` on the side `pinch`, `second` on the other.
  std::string first = "pinch", second = "baseline";
  std::optional<double> level = std::nullopt;  ///< of the graded clip; none: chosen later

  friend bool operator==(const PlannedTrial&, const PlannedTrial&) = default;
};

/// Largest seed: what JSON numbers carry exactly everywhere, 2^53 - 1.
inline constexpr std::uint64_t largest_seed = (std::uint64_t{1} << 53U) - 1;

/// The name that a trial's clips go by: the demonstration's, with methods or level where there are
/// any.
std::string clip_key(const PlannedTrial& trial);
std::string clip_key(const GradedClip& clip);

/// All pairs of m methods, as their places, in the order of a tournament in which each plays once a
/// round (the circle method), so that among neighbours all come about equally often.
std::vector<std::pair<std::size_t, std::size_t>> tournament(std::size_t methods);

/// Main trials of each demonstration (or series).
int answers_per_demonstration(const PlanOptions& options);

/// The trials of participant `number` (from 0), in the order they are shown.
///
/// With n demonstrations and in every round:
/// - participants 2k and 2k + 1 see each demonstration once with pinch left and once right;
/// - participants nk to nk + n - 1 see each demonstration once in every position (a Williams
///   square, Australian Journal of Scientific Research A 2 (1949) 149; for odd n and odd k the
///   mirrored square of k - 1), its labels and rows shuffled anew; so each follows every other
///   equally often, for odd n among 2n participants;
/// - a participant's order is uniform over all n! orders, and each side is a fair coin, yet
/// - each participant sees the method under test on both sides equally often, or once more on one
///   where the number is odd, and never more than three times running on one side;
/// - no demonstration is shown twice running (unless there is only one).
/// With methods, a participant sees pairs_per_demonstration of their P pairs in each demonstration,
/// another one in each round, and
/// - of 2P participants as many see each pair in each demonstration;
/// - each participant sees each pair equally often, or once more than another;
/// - each participant sees each method on both sides equally often, or once more on one; and each
///   method about equally often;
/// - participants 2k and 2k + 1 see the same pairs, with opposite sides.
/// With graded clips each is a demonstration of its own, and answers count by their series. Where
/// levels are chosen by the answers, series are the demonstrations, of adaptive_trials rounds, and
/// sides are balanced in every eight trials.
/// Attention checks are spread over the main trials, never first; each pair of participants sees
/// their right answer on both sides. Training trials come first, with fair sides.
std::vector<PlannedTrial> make_plan(std::uint64_t seed, std::uint64_t number,
                                    const PlanOptions& options);

}  // namespace pinchlab::study
