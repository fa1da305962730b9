// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What lengths and gaps miss at an interval's end: SHAKE.

namespace pinchlab {

struct Part;
struct Parts;
struct PartSystem;
struct Row;
struct SolveScratch;
struct TimeSpan;
struct IntervalTrial;
struct World;

/// Whether a row is of a length or a gap, which is to be exact: friction that slides is not.
bool is_exact_row(const Row& row);

/// Adds to the biases of a part's rows what their conditions have missed at the present positions;
/// returns the most (m). Notes in the trial whether one was violated from the start.
double add_missed(const World& world, const Parts& parts, const Part& part,
                  const SolveScratch& scratch, const TimeSpan& interval, PartSystem& system,
                  IntervalTrial& trial);

}  // namespace pinchlab
