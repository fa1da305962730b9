// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Scenes with placeholders, and the values that stand in their places.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab {

/// Values by column, a row a scene.
struct ParameterTable {
  std::string name;                            ///< for messages: the file, or "the ranges"
  std::vector<std::string> columns;            ///< letters, digits and _, each once
  std::vector<std::vector<std::string>> rows;  ///< as many cells as columns, none empty
  std::vector<std::size_t> lines;              ///< of the file, a row; 0: not from a file

  /// Column `name` of a row, or nothing.
  const std::string* cell(std::size_t row, const std::string& column) const;
  /// Where a row is, for messages: "grid.csv:7 (squeeze=0.5, width=0.03)".
  std::string place(std::size_t row) const;
};

constexpr std::size_t max_table_rows = 1'000'000;

/// A CSV file (RFC 4180) whose first record names the columns. Throws InputError with file and
/// line.
ParameterTable read_parameter_table(const std::filesystem::path& path);

/// All combinations of "name=a,b,c" (these values) and "name=from:to:count" (that many at equal
/// distances, the ends included); the last name varies fastest. Throws std::invalid_argument with
/// the form that is expected.
ParameterTable table_of_ranges(const std::vector<std::string>& ranges);

/// The table as CSV, the same bytes for the same values.
std::string to_csv(const ParameterTable& table);

/// A scene's JSON in which texts hold placeholders such as ${squeeze}.
// nlohmann's move, which is declared noexcept, checks itself.
struct SceneTemplate {  // NOLINT(bugprone-exception-escape)
  std::filesystem::path path;
  std::string text;  ///< the file
  nlohmann::json json;
};

/// Reads a template; it need not be a scene yet. Throws InputError.
SceneTemplate read_template(const std::filesystem::path& path);

/// Throws InputError where a placeholder has no column, or a column other than `known` no
/// placeholder.
void check_columns(const SceneTemplate& scene, const ParameterTable& table,
                   const std::vector<std::string>& known);

/// The template with a row's values. A text that is nothing but a placeholder becomes the value, as
/// a number, true or false if it reads as one; in longer texts the value stands as it is written.
nlohmann::json fill(const SceneTemplate& scene, const ParameterTable& table, std::size_t row);

/// A cell as JSON has it: a number, true, false, or a text.
nlohmann::json value_of_cell(const std::string& cell);

}  // namespace pinchlab
