// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One row a participant.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab::study {

struct ParticipantsTable {
  std::vector<std::string> names, descriptions;  ///< of the columns; the first is `participant`
  std::vector<std::vector<std::string>> rows;  ///< as many cells as columns, in order of the files
};

/// Of answer files that were checked. `with_ids`: with the ids of the site that sent the
/// participants, if there are any.
ParticipantsTable participants_table(const std::vector<nlohmann::json>& files, bool with_ids);

}  // namespace pinchlab::study
