// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Answers and the clips that were shown as a research crate.

#include <filesystem>

namespace pinchlab::study {

/// Writes a crate (RO-Crate 1.1, Process Run Crate 0.4) to `out`, which must not exist or be empty:
/// data/answers.csv, data/participants.csv (without ids of a recruiting site), and in stimuli/ the
/// files of `clips` that the answers were given to, with the clips' manifest.json. Throws
/// InputError where a clip is not the one that was shown, by its SHA-256, and std::runtime_error.
void write_ro_crate(const std::filesystem::path& answers, const std::filesystem::path& clips,
                    const std::filesystem::path& out);

}  // namespace pinchlab::study
