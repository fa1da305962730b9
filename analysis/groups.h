// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which demonstrations are analysed together, and who is left out.

#include "analysis/answers_table.h"

namespace pinchlab::analysis {

/// Sets `table.groups` and `table.groups_from`: from `groups_file` (CSV `demonstration,group`) if
/// it is not empty, otherwise from the inputs' own `group` column, otherwise from the project's
/// names, whose leading numbers are 1 to 6 for clipping and 7 to 8 for friction (thesis 3.3.1). A
/// group "all" comes last.
void assign_groups(AnswersTable& table, const std::filesystem::path& groups_file,
                   const std::map<std::string, std::string>& column_groups);

/// Reads a list of participants to leave out: CSV `participant,reason`, both required.
std::vector<Exclusion> read_exclusions(const std::filesystem::path& path);

/// Who is left out: by a rule, and by the file where no rule does.
std::vector<Exclusion> exclusions_of(const ReadOptions& options);

}  // namespace pinchlab::analysis
