// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

#include "sim/world.h"

namespace pinchlab::experiments {

/// What the thesis counts in Tables 5.1 and 5.2.
struct ElementCounts {
  std::size_t bodies = 0, non_transitional = 0, transitional = 0, contacts = 0, joints = 0,
              segments = 0;
  bool operator==(const ElementCounts&) const = default;

  /// Joints that are there without pinches, and pinches of the non-transitional kind (Figure 5.3).
  /// A pinch of that kind brings two joints of its own.
  [[nodiscard]] std::size_t attachments() const { return joints - non_transitional; }
};

ElementCounts count_elements(const World& world);

}  // namespace pinchlab::experiments
