// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The manual page and the shell completion, both made from the command line's own description, so
// that they cannot say anything else than --help.

#include <CLI/CLI.hpp>
#include <string>

namespace pinchlab {

/// The manual page of `app` and all its commands, for man(1): `version` is the program's.
std::string manual_page(const CLI::App& app, const std::string& version);

/// A bash script that completes the commands of `app`, their options, and the values of options
/// that have a choice of them; file names elsewhere.
std::string bash_completion(const CLI::App& app);

/// Adds `manual` and `completion`, which print the two above about `app`.
void add_help_page_commands(CLI::App& app, const std::string& version);

}  // namespace pinchlab
