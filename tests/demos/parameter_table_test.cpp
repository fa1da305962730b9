// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of values, ranges, and scenes with placeholders.

#include "demos/scenes/parameter_table.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>

#include "base/input_error.h"
#include "run_program.h"

namespace pinchlab {
namespace {

using nlohmann::json;
using Rows = std::vector<std::vector<std::string>>;

std::filesystem::path file_with(const std::string& name, const std::string& text) {
  const std::filesystem::path path = scratch_folder() / name;
  std::ofstream(path) << text;
  return path;
}

std::string table_error(const std::string& text) {
  const std::filesystem::path path = file_with("t.csv", text);
  try {
    read_parameter_table(path);
  } catch (const InputError& error) {
    return std::string(error.what()).substr(path.string().size() - 5);
  }
  return "no error";
}

std::string ranges_error(const std::vector<std::string>& ranges) {
  try {
    table_of_ranges(ranges);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no error";
}

TEST(ParameterTable, IsRead) {
  const ParameterTable table =
      read_parameter_table(file_with("t.csv", "squeeze,label\r\n0.5,\"a, b\"\r\n\r\n1,c\r\n"));
  EXPECT_EQ(table.columns, (std::vector<std::string>{"squeeze", "label"}));
  EXPECT_EQ(table.rows, (Rows{{"0.5", "a, b"}, {"1", "c"}}));
  EXPECT_EQ(*table.cell(1, "label"), "c");
  EXPECT_EQ(table.cell(1, "mass"), nullptr);
  EXPECT_TRUE(table.place(1).ends_with("t.csv:4 (squeeze=1, label=c)")) << table.place(1);
  EXPECT_EQ(to_csv(table), "squeeze,label\n0.5,\"a, b\"\n1,c\n");
}

TEST(ParameterTable, MistakesAreToldWithTheirLine) {
  EXPECT_EQ(table_error(""), "t.csv: is empty; its first line names columns");
  EXPECT_EQ(table_error("a,b\n"), "t.csv: has no rows below the columns' names");
  EXPECT_EQ(table_error("a,b\n1,2\n3\n"), "t.csv:3: has 1 cells, not 2 as the first line");
  EXPECT_EQ(table_error("a,b\n1,\n"), "t.csv:2: column `b` is empty");
  EXPECT_EQ(table_error("a,a\n1,2\n"), "t.csv:1: column `a` is there twice");
  EXPECT_EQ(table_error("a,b c\n1,2\n"),
            "t.csv:1: `b c` cannot name a column: use letters, digits and _");
}

TEST(ParameterTable, RangesGiveAllCombinations) {
  const ParameterTable table = table_of_ranges({"squeeze=0:1:3", "kind=a,b"});
  EXPECT_EQ(table.columns, (std::vector<std::string>{"squeeze", "kind"}));
  EXPECT_EQ(table.rows,
            (Rows{{"0", "a"}, {"0", "b"}, {"0.5", "a"}, {"0.5", "b"}, {"1", "a"}, {"1", "b"}}));
  EXPECT_EQ(table_of_ranges({"x=0:0.3:4"}).rows.back(), (std::vector<std::string>{"0.3"}));
  // Values are what a person would write, not sums of doubles: they become labels and names.
  EXPECT_EQ(table_of_ranges({"w=0.01:0.09:5"}).rows,
            (Rows{{"0.01"}, {"0.03"}, {"0.05"}, {"0.07"}, {"0.09"}}));
}

TEST(ParameterTable, RangesMustBeRanges) {
  const std::string form = " is not NAME=A,B,C or NAME=FROM:TO:COUNT, such as squeeze=0:1:5";
  for (const char* wrong :
       {"squeeze", "squeeze=", "squeeze=0:1", "squeeze=0:1:0", "squeeze=0:x:3", "squeeze=1,,2",
        "squeeze=0:1:2.5", "squeeze=nan:1:3", "squeeze=0:1:3:4"}) {
    EXPECT_EQ(ranges_error({wrong}), wrong + form);
  }
  EXPECT_EQ(ranges_error({"squeeze=0:1:1"}),
            "squeeze=0:1:1: a range has 2 to 100000 values, its ends among them; one value is "
            "squeeze=0");
  EXPECT_EQ(ranges_error({"a=1", "a=2"}), "a=2: column `a` is there twice");
  EXPECT_EQ(ranges_error({"a b=1"}),
            "a b=1: `a b` cannot name a column: use letters, digits and _");
  EXPECT_EQ(ranges_error({"a=0:1:1001", "b=0:1:1000"}), "more than 1000000 combinations");
}

SceneTemplate template_of(const json& value) {
  return {"s.json", value.dump(), value};
}

TEST(SceneTemplate, TakesValuesAsWhatTheyReadAs) {
  const SceneTemplate scene = template_of({{"title", "Squeeze ${s}, ${w} and ${s}"},
                                           {"a", {{{"b", "${s}"}}, "${w}", "${f}", "${t}"}},
                                           {"price", "5 $"},
                                           {"open", "${"}});
  ParameterTable table = table_of_ranges({"s=0.50", "w=no_slip", "f=true", "t=1e3"});
  check_columns(scene, table, {});
  EXPECT_EQ(fill(scene, table, 0), json({{"title", "Squeeze 0.50, no_slip and 0.50"},
                                         {"a", {{{"b", 0.5}}, "no_slip", true, 1000.0}},
                                         {"price", "5 $"},
                                         {"open", "${"}}));
}

TEST(SceneTemplate, AndTableMustFit) {
  const auto error = [](const json& scene, const std::vector<std::string>& ranges) {
    try {
      check_columns(template_of(scene), table_of_ranges(ranges), {"method"});
    } catch (const InputError& wrong) {
      return std::string(wrong.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(error({{"a", {"${sqeeze}"}}}, {"squeeze=1"}),
            "s.json: /a/0: the list of ranges has no column `sqeeze` (did you mean `squeeze`?)");
  EXPECT_EQ(error({{"a", "${squeeze}"}}, {"squeeze=1", "mass=2"}),
            "the list of ranges: column `mass` has no place: write ${mass} where it belongs in "
            "s.json, or "
            "leave it out");
  EXPECT_EQ(error({{"a", "${squeeze}"}}, {"squeeze=1", "method=pinch"}), "no error");
}

}  // namespace
}  // namespace pinchlab
