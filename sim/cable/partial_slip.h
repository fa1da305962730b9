// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Partial slip of elastic cables. What lies on a rough rim that the cable sticks to slides at its
// ends as far as friction cannot hold it there: tension changes along it by no more than
// e^(mu phi). With the tensions T0 and T1 before and after, at the angles phi and theta - phi from
// these, it is no less than
//     max(T0 e^(-mu phi), T1 e^(-mu (theta - phi))),
// and no more than the lesser of T0 e^(mu phi) and T1 e^(mu (theta - phi)); between these it is
// what it was. When T1 = T0 e^(mu theta) both are one, and all slides (relax.h). What has mass,
// whose slide as a whole is the sleeve's (sleeve.h), lies so then too; what it weighs on the rim,
// and the force that turns it, are left out here: they are in how it slides.
//
// What is stretched too little gives material to the span that pulls it more, what is stretched too
// much takes some from the other; either way that comes to where tension is more, which loses
// energy. So a load on a cable that friction holds swings less and less. Rims that share a span
// slide together: by turns, until none of them is given any more.

#include "sim/world.h"

namespace pinchlab {

/// Lets it slide so at an interval's end, wraps and rest lengths being up to date, as they are
/// afterwards.
void slide_in_part(const World& world, CableState& cable);

}  // namespace pinchlab
