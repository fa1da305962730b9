// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Elastic cables without mass on rims that they slide over. What lies there is stretched like what
// is beside it, by the capstan law: from T at one end of an arc to rho T at the other,
// rho = e^(+-mu wrap), by the mean tension T (rho - 1) / ln rho.
// Of all that slides as one, spans of the lengths L_i and arcs of the lengths W_j, the material M
// is what it was. With tau = T / EA, and rho_i, rho_j relative to the first span,
//     M = sum L_i / (1 + rho_i tau) + sum W_j / (1 + rho_j tau)
// has one root, which Newton's method comes to from 0 without going past it.

#include "sim/world.h"

namespace pinchlab {

/// Whether cable slides over a link (or -1) now, and its rim can take it as it comes. Rims beside a
/// pinch, on which a cable sticks, or that carry layers keep what they have.
bool lies_relaxed(const World& world, const CableState& cable, int link);

/// Lets what slides come to that at an interval's end, wraps and rest lengths being up to date, as
/// they are afterwards. Other rims keep what they have. Where all is slack rims give up their
/// stretch as far as there is slack beside them.
void relax_rims(const World& world, CableState& cable);

}  // namespace pinchlab
