// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// When a run counts as failed. The limits are the same for all methods and scenes.

#include <string>

namespace pinchlab::experiments::stability {

/// The worst that a run has shown. What a case does not ask for stays 0.
struct Measures {
  bool finite = true;
  bool passed_through = false;  // a body has crossed a cable
  double strain = 0.0;          // cable in its spans beyond what it has, over its length
  double squeeze = 0.0;         // of the cable's full width, by a body that overlaps it
  double length = 0.0;          // wraps and spans against the cable's length, over its length
  double energy_gained = 0.0;   // of the energy at play
  double energy_lost = 0.0;     // likewise, where nothing may take any
  double end_speed_m_s = 0.0;   // of any body or rim in the last tenth of a run that ends at rest
  double error = 0.0;           // of the motion or force against the exact one
};

/// Why these: stability.md says it in full (page.cpp).
struct Limits {
  double strain = 1e-3;         // a third of a steel rope's at its working load
  double squeeze = 1e-3;        // a hundredth of a pixel of a drawn cable
  double length = 1e-6;         // a millimetre a kilometre
  double energy = 1e-2;         // half a percent of speed
  double end_speed_m_s = 1e-3;  // a pixel in some seconds
  double error = 1e-2;
};

enum class Failure {
  none,
  not_finite,
  passed_through,
  strain,
  squeeze,
  length,
  energy_gained,
  energy_lost,
  restless,
  wrong,
};

const char* to_string(Failure failure);

/// The worst measure over its limit, and which it is. Below or at 1 nothing has failed; infinity
/// where numbers are not finite or a body has passed through.
struct Verdict {
  double severity = 0.0;
  Failure worst = Failure::none;  ///< the measure that `severity` is of, failed or not

  bool failed() const { return !(severity <= 1.0); }
};

Verdict judge(const Measures& measures, const Limits& limits = {});

}  // namespace pinchlab::experiments::stability
