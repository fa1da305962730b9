// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Participants who are not there: they answer by a known truth, over HTTP as a browser does.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>

#include "study/desk.h"

namespace pinchlab::study {

/// A psychometric function: hits are 1/2 + (1/2 - lapses) G, G logistic with G(threshold) = 1/2 and
/// `width` from G = 0.05 to 0.95.
struct TrueThreshold {
  double threshold = 0, width = 1;  ///< levels
  double spread = 0;                ///< standard deviation of the participants' thresholds
};

/// How simulated participants choose.
struct Truth {
  std::string file = "truth";                   ///< for messages
  std::string sha256;                           ///< of what the file says
  std::map<std::string, double> shares;         ///< for pinch, by demonstration; 1/2 where none
  std::map<std::string, double> methods;        ///< values on Bradley and Terry's scale
  std::map<std::string, TrueThreshold> series;  ///< by name
  double spread = 0;  ///< standard deviation, log-odds, of a participant's values and shares
  double left = 0;    ///< log-odds for the left
  double lapses = 0;  ///< share of answers that are a throw of a coin; halves of it miss
};

/// Reads a truth file strictly (study/README.md). Throws InputError.
Truth read_truth(const std::filesystem::path& path);

/// Throws InputError if the truth does not tell about a method or series of the study, or names
/// what the study does not have.
void check_truth(const Config& config, const Truth& truth);

struct SimulationOptions {
  int participants = 1;  ///< that there are to be in the end
  int at_once = 8;
  std::uint64_t seed = 0;
  std::function<void(int to_come)> begin;      ///< once
  std::function<void(int finished)> progress;  ///< may be called from any thread
};

/// Lets participants take part in a study whose desk this is: consent, clips, answers, save. Serves
/// it on a free port of this computer meanwhile. Who has finished before counts, and who was broken
/// off begins anew, so that an interrupted simulation comes to the answers of one that was not.
/// Returns how many were added. Throws what check_truth does, and std::runtime_error for whatever
/// is not answered as it must be.
int simulate(Desk& desk, const Truth& truth, const SimulationOptions& options);

}  // namespace pinchlab::study
