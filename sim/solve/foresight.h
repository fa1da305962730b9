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

namespace pinchlab {

struct Part;
struct Parts;
struct World;

/// Whether an interval follows on others of its length whose curvatures tell its own. Where steps
/// are divided by their error, which only the first correction tells, some in between are not
/// foreseen.
bool is_foreseen(const World& world, const Parts& parts, const Part& part, const TimeSpan& t);

/// Adds the curvatures that are foreseen for an interval of `length` (s) to the biases of rows that
/// bear force.
void foresee(const World& world, double length, PartSystem& system);

/// What an interval of a part came to.
struct IntervalDone {
  double length = 0.0, kick = 0.0;  // s
  bool foreseen = false;
  double local_error = 0.0;  // m, of what was not foreseen; see Trial
  double allowed = 0.0;      // m, of that; 0: steps are not divided by their error
};

/// Notes the curvatures of an interval that was met, for the next one, from its rows.
void note_curvature(const Parts& parts, const Part& part, const PartSystem& system,
                    const IntervalDone& done, World& world);

/// Notes that what the part did last tells nothing of its next interval.
void forget_curvature(const Parts& parts, const Part& part, World& world);

}  // namespace pinchlab
