// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/csv_inputs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "analysis/csv_columns.h"
#include "base/answer_columns.h"
#include "base/csv_reader.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/text_checks.h"

namespace pinchlab::analysis {

namespace {

using Fields = std::vector<std::string_view>;

// Where each of our columns stands in the file; -1: it has no such column.
struct Header {
  int participant = -1, demonstration = -1, choice = -1, group = -1, side = -1, position = -1;
  int reaction_time_s = -1, kind = -1, preference = -1, pilot = -1, pinch = -1, cable = -1;
  size_t width = 0;
};

struct ColumnName {
  const char* name;
  int Header::*index;
};

constexpr std::array<ColumnName, 10> tidy_columns{{{"participant", &Header::participant},
                                                   {"demonstration", &Header::demonstration},
                                                   {"choice", &Header::choice},
                                                   {"group", &Header::group},
                                                   {"side", &Header::side},
                                                   {"position", &Header::position},
                                                   {"reaction_time_s", &Header::reaction_time_s},
                                                   {"kind", &Header::kind},
                                                   {"preference", &Header::preference},
                                                   {"pilot", &Header::pilot}}};
constexpr std::array<ColumnName, 4> count_columns{{{"demonstration", &Header::demonstration},
                                                   {"pinch", &Header::pinch},
                                                   {"cable", &Header::cable},
                                                   {"group", &Header::group}}};

bool has_column(const Fields& fields, const std::string& name) {
  return std::find(fields.begin(), fields.end(), name) != fields.end();
}

// Finds the columns of one layout; every other column is an error unless it is to be ignored.
template <size_t n>
void find_columns(const std::array<ColumnName, n>& columns, const Fields& fields,
                  const ReadOptions& options, const std::string& place, Header& header) {
  std::vector<std::string> names;
  names.reserve(n);
  for (const ColumnName& column : columns) names.push_back(name_in_file(options, column.name));
  for (size_t i = 0; i < fields.size(); ++i) {
    const auto found = std::find(names.begin(), names.end(), fields[i]);
    if (found == names.end()) {
      if (options.ignore_other_columns || is_column_beside_answers(fields[i])) continue;
      throw InputError(place,
                       fmt::format("unknown column `{}`{}; columns are {}. Name columns with "
                                   "--map-column, or pass --ignore-other-columns",
                                   fields[i], did_you_mean(fields[i], names), one_of(names)));
    }
    int& index = header.*columns[static_cast<size_t>(found - names.begin())].index;
    if (index >= 0) throw InputError(place, fmt::format("column `{}` stands twice", fields[i]));
    index = static_cast<int>(i);
  }
}

void require_columns(const Header& header, std::initializer_list<ColumnName> columns,
                     const ReadOptions& options, const std::string& place) {
  for (const ColumnName& column : columns) {
    if (header.*column.index >= 0) continue;
    throw InputError(place, fmt::format("column `{}` is missing; if it has another name, pass "
                                        "--map-column {}=NAME",
                                        name_in_file(options, column.name), column.name));
  }
}

Header read_header(CsvReader& reader, const ReadOptions& options, bool& is_counts) {
  Fields fields;
  if (!reader.next(fields)) throw InputError(reader.place(), "the file is empty");
  const std::string place = reader.place();
  if (fields.size() == 1 && fields[0].find_first_of(";\t,|") != std::string_view::npos) {
    throw InputError(place,
                     fmt::format("only one column (`{}`); say what stands between columns with "
                                 "--separator",
                                 fields[0].substr(0, 60)));
  }
  Header header;
  header.width = fields.size();
  is_counts = !has_column(fields, name_in_file(options, "participant")) &&
              has_column(fields, name_in_file(options, "pinch"));
  if (is_counts) {
    find_columns(count_columns, fields, options, place, header);
    require_columns(header, {count_columns[0], count_columns[1], count_columns[2]}, options, place);
  } else {
    find_columns(tidy_columns, fields, options, place, header);
    require_columns(header, {tidy_columns[0], tidy_columns[1], tidy_columns[2]}, options, place);
  }
  return header;
}

// Reads the rows of one file; holds what every row needs.
class RowReader {
 public:
  RowReader(CsvReader& reader, const Header& header, const ReadOptions& options,
            SameStudy& same_study, TableBuilder& builder)
      : reader_(reader),
        header_(header),
        options_(options),
        same_study_(same_study),
        builder_(builder) {}

  void answer_row(const Fields& fields) {
    check_width(fields);
    const std::string_view participant = name(fields, header_.participant, "participant");
    if (builder_.excluded(participant)) return;
    check_pilot(fields);
    const std::string_view kind = header_.kind < 0 ? "main" : at(fields, header_.kind);
    if (kind == "training") return;
    if (kind == "attention") {
      builder_.add_attention_check(participant, attention_passed(fields));
      return;
    }
    if (kind != "main") fail_value("kind", kind, {"main", "training", "attention"});

    RawAnswer answer;
    answer.participant = participant;
    answer.demonstration = name(fields, header_.demonstration, "demonstration");
    answer.group = group(fields);
    if (header_.side >= 0) answer.pinch_side = side(at(fields, header_.side));
    if (header_.position >= 0) answer.position = position(at(fields, header_.position));
    answer.grade = preference(fields, answer.pinch_side);
    if (answer.grade != 0) answer.chose_pinch = chose_pinch(at(fields, header_.choice));
    if (header_.reaction_time_s >= 0) {
      answer.reaction_time_s = reaction_time(at(fields, header_.reaction_time_s));
    }
    builder_.add_answer(answer, reader_.line());
  }

  void counts_row(const Fields& fields) {
    check_width(fields);
    const std::string_view demonstration = name(fields, header_.demonstration, "demonstration");
    const Counts counts{count(at(fields, header_.pinch), "pinch"),
                        count(at(fields, header_.cable), "cable")};
    if (counts.total() == 0) {
      fail(fmt::format("demonstration `{}` has no answers; take the row out", demonstration));
    }
    builder_.add_counts(demonstration, group(fields), counts, reader_.line());
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(reader_.place(), message);
  }

  [[noreturn]] void fail_value(const char* column, std::string_view value,
                               const std::vector<std::string>& allowed) const {
    fail(fmt::format("{} `{}` is unknown{}; it must be {}", column, value.substr(0, 60),
                     did_you_mean(value, allowed), one_of(allowed)));
  }

  static std::string_view at(const Fields& fields, int index) {
    return fields[static_cast<size_t>(index)];
  }

  void check_width(const Fields& fields) const {
    if (fields.size() == header_.width) return;
    fail(fmt::format("{} fields, but the first line has {}", fields.size(), header_.width));
  }

  // A file without the column is of no pilot. Told once as long as it stays the same.
  void check_pilot(const Fields& fields) {
    const bool is_pilot =
        header_.pilot >= 0 && pilot_of(at(fields, header_.pilot), reader_.place());
    if (is_pilot_ == is_pilot) return;
    same_study_.check_pilot(is_pilot, reader_.place());
    is_pilot_ = is_pilot;
  }

  [[nodiscard]] std::string_view name(const Fields& fields, int index, const char* column) const {
    const std::string_view value = at(fields, index);
    const std::string why = why_not_a_name(value);
    if (!why.empty()) fail(fmt::format("bad {}: {}", column, why));
    return value;
  }

  // A group may be left empty: the demonstration is then in "all" only.
  [[nodiscard]] std::string_view group(const Fields& fields) const {
    if (header_.group < 0 || at(fields, header_.group).empty()) return "";
    const std::string_view value = name(fields, header_.group, "group");
    if (value == all_group)
      fail("group `all` always exists and holds every demonstration; name another group");
    return value;
  }

  [[nodiscard]] bool chose_pinch(std::string_view value) const {
    if (value == options_.pinch_value) return true;
    if (value == options_.cable_value) return false;
    if (value.empty()) {
      fail(
          "the choice is missing; take the row out and pass --allow-missing if there was no "
          "answer");
    }
    const std::vector<std::string> allowed{options_.pinch_value, options_.cable_value};
    fail(fmt::format(
        "choice `{}` is unknown{}; it must be {} (other names: --pinch-value, --cable-value)",
        value.substr(0, 60), did_you_mean(value, allowed), one_of(allowed)));
  }

  [[nodiscard]] bool attention_passed(const Fields& fields) const {
    const std::string_view value = at(fields, header_.choice);
    if (value != "pass" && value != "fail") {
      fail_value("choice of an attention check", value, {"pass", "fail"});
    }
    return value == "pass";
  }

  [[nodiscard]] Side side(std::string_view value) const {
    if (value.empty()) return Side::unknown;
    if (value != "left" && value != "right") fail_value("side", value, {"left", "right"});
    return value == "left" ? Side::left : Side::right;
  }

  // How much the method under test was preferred, where that was asked. Column `preference` counts
  // from left to right.
  [[nodiscard]] std::optional<int> preference(const Fields& fields, Side pinch_side) const {
    if (header_.preference < 0 || at(fields, header_.preference).empty()) return std::nullopt;
    const std::string_view value = at(fields, header_.preference);
    const auto number = parse_whole(value, -3, 3);
    if (!number) {
      fail(fmt::format("preference `{}` is not a whole number from -3 to 3", value.substr(0, 60)));
    }
    if (pinch_side == Side::unknown) {
      fail("a preference needs the column `side`: it counts from the left side to the right");
    }
    const int grade = static_cast<int>(pinch_side == Side::left ? -*number : *number);
    const std::string_view choice = at(fields, header_.choice);
    const bool agrees =
        grade == 0 ? choice == "tie" : choice != "tie" && chose_pinch(choice) == (grade > 0);
    if (!agrees) {
      fail(fmt::format("choice `{}` and preference {} say different things", choice.substr(0, 60),
                       value));
    }
    return grade;
  }

  [[nodiscard]] int position(std::string_view value) const {
    if (value.empty()) return 0;
    const auto number = parse_whole(value, 1, 65535);
    if (!number)
      fail(fmt::format("position `{}` is not a whole number from 1 to 65535", value.substr(0, 60)));
    return static_cast<int>(*number);
  }

  [[nodiscard]] double reaction_time(std::string_view value) const {
    if (value.empty()) return -1.0;
    const auto seconds = parse_number(value);
    if (!seconds || *seconds < 0.0 || *seconds > 86400.0) {
      fail(fmt::format(
          "reaction_time_s `{}` is not a number of seconds from 0 to 86400 (with a decimal "
          "point)",
          value.substr(0, 60)));
    }
    return *seconds;
  }

  [[nodiscard]] std::int64_t count(std::string_view value, const char* column) const {
    const auto number = parse_whole(value, 0, 1000000000);
    if (!number) {
      fail(fmt::format("{} `{}` is not a whole number from 0 to 1000000000", column,
                       value.substr(0, 60)));
    }
    return *number;
  }

  CsvReader& reader_;
  const Header& header_;
  const ReadOptions& options_;
  SameStudy& same_study_;
  TableBuilder& builder_;
  std::optional<bool> is_pilot_;  // of the rows before
};

}  // namespace

bool has_counts(const std::filesystem::path& path, const ReadOptions& options) {
  return has_columns(path, options, {"pinch"}) && !has_columns(path, options, {"participant"});
}

std::vector<std::string> input_columns() {
  std::vector<std::string> names;
  names.reserve(std::size(tidy_columns));
  for (const ColumnName& column : tidy_columns) names.emplace_back(column.name);
  names.insert(names.end(), {"pinch", "cable", "level", "correct", "trials", "left", "right",
                             "left_wins", "right_wins", "ties"});
  return names;
}

void read_csv_input(const std::filesystem::path& path, const ReadOptions& options,
                    SameStudy& same_study, TableBuilder& builder) {
  CsvReader reader(path, options.separator);
  bool is_counts = false;
  const Header header = read_header(reader, options, is_counts);
  if (!is_counts) builder.expect_answers_per_demonstration(options.repetitions, path.string());
  RowReader rows(reader, header, options, same_study, builder);
  Fields fields;
  while (reader.next(fields)) {
    is_counts ? rows.counts_row(fields) : rows.answer_row(fields);
  }
}

}  // namespace pinchlab::analysis
