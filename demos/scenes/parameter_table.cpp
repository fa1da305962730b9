// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/parameter_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <set>
#include <stdexcept>

#include "base/csv.h"
#include "base/csv_reader.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "base/text_checks.h"
#include "demos/scenes/scene_format.h"

namespace pinchlab {
namespace {

using nlohmann::json;

constexpr std::size_t max_columns = 100;
constexpr long max_values = 100'000;  // of one range

bool is_name(std::string_view text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !text.empty() && text.size() <= 64 && std::ranges::all_of(text, fits);
}

void add_column(ParameterTable& table, const std::string& name, const std::string& place) {
  if (!is_name(name)) {
    throw InputError(place, fmt::format("`{}` cannot name a column: use letters, digits and _",
                                        pointer_token(name)));
  }
  if (std::ranges::find(table.columns, name) != table.columns.end()) {
    throw InputError(place, fmt::format("column `{}` is there twice", name));
  }
  table.columns.push_back(name);
}

std::vector<std::string> values_of_range(const std::string& text, const std::string& range) {
  const auto wrong = [&] {
    return std::invalid_argument(
        fmt::format("{} is not NAME=A,B,C or NAME=FROM:TO:COUNT, such as squeeze=0:1:5", range));
  };
  std::vector<std::string> parts;
  const char separator = text.find(':') != std::string::npos ? ':' : ',';
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    if (parts.back().empty()) throw wrong();
    begin = end + 1;
  }
  if (separator == ',') return parts;
  if (parts.size() != 3) throw wrong();
  const auto from = parse_number(parts[0]), to = parse_number(parts[1]);
  const auto count = parse_whole(parts[2], 1, max_values);
  if (!from || !to || !count) throw wrong();
  if (*count == 1) {
    const std::string name = range.substr(0, range.find('='));
    throw std::invalid_argument(
        fmt::format("{0}: a range has 2 to {1} values, its ends among them; one value is {2}={3}",
                    range, max_values, name, parts[0]));
  }
  std::vector<std::string> values;
  for (long i = 0; i < *count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(*count - 1);
    // To 15 digits: 0.07, where sums of doubles give 0.06999999999999999.
    values.push_back(fmt::format("{:.15g}", *from + (*to - *from) * share));
  }
  values.back() = fmt::format("{}", *to);
  return values;
}

/// Calls `use` with each placeholder's name; gives the text with what it returns in their places.
std::string replace(const std::string& text,
                    const std::function<std::string(const std::string&)>& use) {
  std::string result;
  std::size_t at = 0;
  while (true) {
    const std::size_t begin = text.find("${", at);
    const std::size_t end = begin == std::string::npos ? begin : text.find('}', begin);
    if (end == std::string::npos) return result + text.substr(at);
    result += text.substr(at, begin - at) + use(text.substr(begin + 2, end - begin - 2));
    at = end + 1;
  }
}

bool is_one_placeholder(const std::string& text) {
  return text.starts_with("${") && text.find('}') == text.size() - 1;
}

/// Calls `visit` with every text of the scene and its JSON pointer.
void for_each_text(json& value, const std::string& place,
                   const std::function<void(json& text, const std::string& place)>& visit) {
  if (value.is_string()) return visit(value, place);
  if (value.is_object()) {
    for (auto& [key, child] : value.items()) {
      for_each_text(child, place + "/" + pointer_token(key), visit);
    }
  } else if (value.is_array()) {
    for (std::size_t i = 0; i < value.size(); ++i) {
      for_each_text(value[i], fmt::format("{}/{}", place, i), visit);
    }
  }
}

}  // namespace

const std::string* ParameterTable::cell(std::size_t row, const std::string& column) const {
  const auto found = std::ranges::find(columns, column);
  if (found == columns.end()) return nullptr;
  return &rows[row][static_cast<std::size_t>(found - columns.begin())];
}

std::string ParameterTable::place(std::size_t row) const {
  std::vector<std::string> values;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    values.push_back(fmt::format("{}={}", columns[c], rows[row][c]));
  }
  return fmt::format("{}:{} ({})", name, lines[row] > 0 ? lines[row] : row + 1,
                     fmt::join(values, ", "));
}

ParameterTable read_parameter_table(const std::filesystem::path& path) {
  CsvReader reader(path, ',');
  ParameterTable table;
  table.name = path.string();
  std::vector<std::string_view> fields;
  if (!reader.next(fields)) throw InputError(table.name, "is empty; its first line names columns");
  if (fields.size() > max_columns) {
    throw InputError(reader.place(), fmt::format("has more than {} columns", max_columns));
  }
  for (const std::string_view field : fields) {
    add_column(table, std::string(field), reader.place());
  }
  while (reader.next(fields)) {
    if (fields.size() != table.columns.size()) {
      throw InputError(reader.place(), fmt::format("has {} cells, not {} as the first line",
                                                   fields.size(), table.columns.size()));
    }
    for (std::size_t c = 0; c < fields.size(); ++c) {
      if (fields[c].empty()) {
        throw InputError(reader.place(), fmt::format("column `{}` is empty", table.columns[c]));
      }
      if (!is_utf8(fields[c])) {
        throw InputError(reader.place(),
                         fmt::format("column `{}` is not valid UTF-8 (save the file as UTF-8)",
                                     table.columns[c]));
      }
    }
    if (table.rows.size() == max_table_rows) {
      throw InputError(reader.place(), fmt::format("more than {} rows", max_table_rows));
    }
    table.rows.emplace_back(fields.begin(), fields.end());
    table.lines.push_back(reader.line());
  }
  if (table.rows.empty()) throw InputError(table.name, "has no rows below the columns' names");
  return table;
}

ParameterTable table_of_ranges(const std::vector<std::string>& ranges) {
  ParameterTable table;
  table.name = "the list of ranges";
  table.rows = {{}};
  for (const std::string& range : ranges) {
    const std::size_t equals = range.find('=');
    const std::vector<std::string> values =
        values_of_range(equals == std::string::npos ? "" : range.substr(equals + 1), range);
    try {
      add_column(table, range.substr(0, equals), range);
    } catch (const InputError& error) {
      throw std::invalid_argument(error.what());
    }
    if (values.size() * table.rows.size() > max_table_rows) {
      throw std::invalid_argument(fmt::format("more than {} combinations", max_table_rows));
    }
    std::vector<std::vector<std::string>> rows;
    for (const std::vector<std::string>& row : table.rows) {
      for (const std::string& value : values) {
        rows.push_back(row);
        rows.back().push_back(value);
      }
    }
    table.rows = std::move(rows);
  }
  table.lines.assign(table.rows.size(), 0);
  return table;
}

std::string to_csv(const ParameterTable& table) {
  std::string text = fmt::format("{}\n", fmt::join(table.columns, ","));
  for (const std::vector<std::string>& row : table.rows) {
    for (std::size_t c = 0; c < row.size(); ++c) text += (c == 0 ? "" : ",") + csv_cell(row[c]);
    text += "\n";
  }
  return text;
}

SceneTemplate read_template(const std::filesystem::path& path) {
  SceneTemplate scene;
  scene.path = path;
  scene.text = read_whole(path, max_scene_bytes);
  try {
    scene.json = parse_strict_json(scene.text);
  } catch (const JsonError& error) {
    throw InputError(path.string() + ": " + error.place, error.what());
  }
  return scene;
}

void check_columns(const SceneTemplate& scene, const ParameterTable& table,
                   const std::vector<std::string>& known) {
  std::set<std::string> used;
  json copy = scene.json;
  for_each_text(copy, "", [&](json& text, const std::string& place) {
    replace(text.get<std::string>(), [&](const std::string& name) {
      if (std::ranges::find(table.columns, name) == table.columns.end()) {
        throw InputError(fmt::format("{}: {}", scene.path.string(), place),
                         fmt::format("{} has no column `{}`{}", table.name, pointer_token(name),
                                     did_you_mean(name, table.columns)));
      }
      used.insert(name);
      return name;
    });
  });
  for (const std::string& column : table.columns) {
    if (used.contains(column) || std::ranges::find(known, column) != known.end()) continue;
    throw InputError(table.name,
                     fmt::format("column `{0}` has no place: write ${{{0}}} where it belongs in "
                                 "{1}, or leave it out",
                                 column, scene.path.string()));
  }
}

json value_of_cell(const std::string& cell) {
  if (const auto number = parse_number(cell)) return *number;
  if (cell == "true" || cell == "false") return cell == "true";
  return cell;
}

json fill(const SceneTemplate& scene, const ParameterTable& table, std::size_t row) {
  json filled = scene.json;
  for_each_text(filled, "", [&](json& text, const std::string&) {
    const auto& before = text.get_ref<const std::string&>();
    if (is_one_placeholder(before)) {
      text = value_of_cell(*table.cell(row, before.substr(2, before.size() - 3)));
    } else {
      text = replace(before, [&](const std::string& name) { return *table.cell(row, name); });
    }
  });
  return filled;
}

}  // namespace pinchlab
