// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How participants choose who are not there.

#include <filesystem>
#include <map>
#include <string>

#include "study/config.h"

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

}  // namespace pinchlab::study
