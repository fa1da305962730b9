// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elastic cables without mass that slide over bodies. What lies there is stretched as it slides: by
// the tension T0 exp(mu phi) at the angle phi from where it is less, on smooth bodies like what is
// beside it, whatever slides and turns. A rim of the radius R and the angle theta has of material
//     R (theta - ln((1 + e1) / (1 + e0)) / mu)
// for the strains e0 and e1 at its ends (the integral of R dphi / (1 + e0 exp(mu phi))); so much it
// is given, each part of it as it is stretched there. Spans and rims between places that hold the
// cable share what material they have in all: e0 of the first follows from that.
//
// To share anew may move material from more tension to less, which takes energy. The balance of
// spans by sliding speeds (solve/slip_speeds.cpp) leaves rims as they are, and so moves too much;
// what goes back may take as much energy as friction has had of that sliding. Where it would take
// more, rough rims keep what they have.

#include "base/at.h"
#include "sim/world.h"

namespace pinchlab {

/// Whether cable slides over a link's body without friction.
inline bool is_smooth(const World& world, const Link& link) {
  return at(world.bodies, link.body).cable_friction == 0.0;
}

/// Energy (m, over EA) of so much material (m) on a way (m); infinity where none is left.
inline double energy_of(double way, double material) {
  const double stretch = way - material;
  if (!(stretch > 0.0)) return 0.0;
  return material > 0.0 ? stretch * stretch / (2.0 * material) : infinity;
}

/// Whether a link's cable goes into a pinch before it or after it.
bool is_pinched_beside(const CableState& cable, int link);

/// Whether what lies at a link (or -1) is so stretched. Beside a pinch it stays as it is.
bool lies_relaxed(const World& world, const CableState& cable, int link);

/// Of what lies on such a link what counts as part of the span after it, or with `after` false of
/// the one before it.
struct Beside {
  double material = 0.0;  // m
  double loose = 0.0;     // m, below 0: stretched
};

/// As much with either span as makes the stretch of the whole by the tensions of both: for small
/// strains R tanh(mu theta / 2) / mu, of R (T1 - T0) / (mu EA). Each has the stretch that its
/// tension asks for. On a smooth rim half of all.
Beside lies_beside(const World& world, const CableState& cable, int link, bool after);

/// Stretches all so at an interval's end, wraps and rest lengths being up to date, as they are
/// afterwards, and what sticks as partial_slip.h has it. Where all is slack nothing stays
/// stretched, and rims hold no more than they turn. The interval has lasted `time` (s).
void relax_rims(const World& world, CableState& cable, double time);

}  // namespace pinchlab
