// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <ctime>

namespace pinchlab {

/// Processor time that this process has used so far, s. Unlike the wall clock it does not count
/// what others do on the machine meanwhile.
inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace pinchlab
