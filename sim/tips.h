// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Sharp tips that come along a side.
//
// A box that slides from one wall on to the next, along a row of blocks, or over a ridge, comes
// with a side upon the end of what goes on there, which is in line with its underside: their
// outlines are apart by the way to go, and then by nothing, along two ways at once. Being apart
// along one of them is enough (touch.h), and that is the underside's, as long as the tip may lie
// on it.

#include "sim/contact.h"

namespace pinchlab {

struct World;

/// Of a contact that has just been found, in `side` that of a polygon in front of which a sharp tip
/// is: whether the tip is in line with the next side, within `near` (m), and may lie on that, so
/// that it stops nothing. Where the two tips have met, and come nearer, the contact becomes that
/// with the next side, if they come nearer less fast along its way out, and counts.
bool goes_past(const World& world, double near, Contact& contact);

}  // namespace pinchlab
