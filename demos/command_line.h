// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Options that several commands share.

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "base/number_option.h"

namespace pinchlab {

struct Size {
  int width = 0, height = 0;  // px
};

/// --size WxH.
void add_size(CLI::App& command, Size& size, const std::string& help);

/// --time-limit S.
void add_time_limit(CLI::App& command, std::optional<double>& seconds, const std::string& what);

/// The same of each simulation of `whose`, such as "a clip's".
void add_simulation_limit(CLI::App& command, std::optional<double>& seconds,
                          const std::string& whose);

/// What the command line has that no command knows, with the cure, once app.parse() has thrown;
/// empty if that was for another reason.
std::string unknown_words(const CLI::App& app);

/// What is wrong where app.parse() has thrown because an option is there more often than it may be;
/// empty if that was for another reason.
std::string given_too_often(const CLI::ParseError& error);

/// What commands take when no scene is named: demos/ of the current folder, or else the one that
/// was installed with the program. Nothing where there is neither; demos_folder then throws
/// std::runtime_error.
std::optional<std::filesystem::path> find_demos_folder();
std::filesystem::path demos_folder();

/// --method: a std::string, or a std::optional of one.
template <class Text>
void add_method(CLI::App& command, Text& method, const std::string& help,
                std::vector<std::string> names = {"pinch", "pinch_no_contact", "cable", "baseline",
                                                  "thesis"}) {
  command.add_option("--method", method, help)
      ->type_name("M")
      ->check(CLI::IsMember(std::move(names)));
}

}  // namespace pinchlab
