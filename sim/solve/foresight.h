// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What lengths and gaps will miss at an interval's end, foreseen.
//
// Over an interval of length h a condition changes by h (J v + c), where c is the curvature of the
// way: what SHAKE finds out at the interval's end and corrects, by solving and moving once or twice
// more. On a smooth way c is a smooth function of time, so that those of the last intervals of one
// length tell the next by their backward differences (Newton's extrapolation),
//     c_n+1 = c_n + D c_n + D^2 c_n + D^3 c_n + O(h^4).
// With that in the rows' bias the first solution already meets its end to round-off, mostly, and
// nothing is left to correct. It is but a first guess: what it misses is corrected as ever, and an
// interval that it does not serve is tried without it.

#include "sim/solve/part_system.h"
#include "sim/world.h"

namespace pinchlab {

/// Whether the interval before was as long as one of `length` (s), where velocities are `lag` (s)
/// behind now.
bool is_even(double lag, double length);

/// Whether an interval of a part follows on others of its length whose curvatures tell its own.
/// Those of straight ways are nothing to tell by. Where steps are divided by their `error` (m; 0:
/// they are not), which only the first correction tells, some in between are not foreseen.
bool is_foreseen(const Pace& pace, double error, const TimeSpan& t);

/// Adds the curvatures that are foreseen for an interval of `length` (s) to the biases of rows that
/// bear force.
void foresee(const World& world, double length, PartSystem& system);

/// What an interval of a part came to.
struct IntervalDone {
  double length = 0.0;  // s
  bool foreseen = false;
  double local_error = 0.0;  // m, of what was not foreseen; see IntervalTrial
  double allowed = 0.0;      // m, of that; 0: steps are not divided by their error
};

/// A part's pace after an interval that was met, as it was `before`; but for Pace::curved.
Pace pace_after(const Pace& before, const IntervalDone& done);

/// Notes the curvatures of a part's rows in an interval of `length` (s) that `known` like it came
/// before, of no curvature at all if not `curved`; whether any is more than 0.
bool note_curvatures(const PartSystem& system, double length, int known, bool curved, World& world);

}  // namespace pinchlab
