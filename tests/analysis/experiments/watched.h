// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "sim/world.h"

namespace pinchlab::experiments {

/// Pinch joints, with what no motion may show looked for.
inline Configuration watched() {
  Configuration configuration = Method::pinch;
  configuration.diagnostics = true;
  return configuration;
}

}  // namespace pinchlab::experiments
