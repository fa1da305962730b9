// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Options that several commands of the study have.

#include <cstdint>
#include <filesystem>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace pinchlab::study {

CLI::Option* add_seed(CLI::App& command, std::uint64_t& seed, const std::string& help);
CLI::Option* add_config(CLI::App& command, std::filesystem::path& config);
CLI::Option* add_no_webm(CLI::App& command, bool& no_webm);

// These two are required.
CLI::Option* add_clips(CLI::App& command, std::filesystem::path& clips);
CLI::Option* add_answers(CLI::App& command, std::filesystem::path& answers);

/// Throws std::invalid_argument where `out`, which is for `what`, is the configuration.
void refuse_to_overwrite(const std::filesystem::path& config, const std::filesystem::path& out,
                         const char* what);

}  // namespace pinchlab::study
