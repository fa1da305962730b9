// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/element_counts.h"

namespace pinchlab::experiments {

ElementCounts count_elements(const World& world) {
  ElementCounts counts;
  counts.bodies = world.position.size();
  for (const Contact& contact : world.contacts) counts.contacts += contact.pinch_points > 0;
  for (const CableState& cable : world.cables) {
    counts.joints += cable.links.size();
    counts.segments += cable.links.size() - (cable.closed ? 0 : 1);
    for (std::size_t i = cable.closed ? 0 : 1; i < cable.links.size(); ++i) {
      const std::size_t before = i > 0 ? i - 1 : cable.links.size() - 1;
      const bool middle = cable.links[i].pinch_middle;
      counts.non_transitional += middle;
      counts.transitional +=
          cable.segments[i].pinched && !middle && !cable.links[before].pinch_middle;
    }
  }
  return counts;
}

}  // namespace pinchlab::experiments
