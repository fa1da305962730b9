// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "analysis/table_builder.h"
#include "base/answer_file.h"

namespace pinchlab::analysis {

/// Reads a CSV file into `builder`: a tidy one (columns participant, demonstration, choice;
/// optional group, side, position, reaction_time_s, kind, preference, pilot) or a table of counts
/// (demonstration, pinch, cable; optional group). The header decides which. Throws InputError, also
/// for an answer of a pilot among others, or one of no pilot among those of one (`same_study`).
void read_csv_input(const std::filesystem::path& path, const ReadOptions& options,
                    SameStudy& same_study, TableBuilder& builder);

/// Is it a table of counts?
bool has_counts(const std::filesystem::path& path, const ReadOptions& options);

}  // namespace pinchlab::analysis
