// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random scenes that nobody has looked at before.

#include <cstdint>

#include "sim/scene.h"

namespace pinchlab::experiments {

/// One to six free discs, of masses up to 1e4 apart, that fall on one to four cables over two to
/// five pulleys: taut or slack, with weights or fixed ends, or closed round two pulleys; slipping
/// or not, restitution from 0 to 1, drag and drive in some. The same for the same seed everywhere.
Scene dropped_discs(std::uint64_t seed);

}  // namespace pinchlab::experiments
