// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Participants who are not there: they answer by a known truth, over HTTP as a browser does.

#include <cstdint>
#include <functional>

#include "study/desk.h"
#include "study/truth.h"

namespace pinchlab::study {

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
