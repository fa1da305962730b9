// SPDX-License-Identifier: GPL-3.0-or-later
// Answers of a pilot are never analysed with the study's, in whatever form the two come.
#include <sstream>

#include "analysis/comparisons_table.h"
#include "analysis/levels_table.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

// A reader of inputs, and what two tables for it say of participants p and q.
struct Form {
  const char* header;
  const char* row;  // after the participant
  bool (*is_pilot)(const std::vector<fs::path>& inputs);
};
const Form forms[] = {
    {"participant,demonstration,choice", "1,pinch",
     [](const std::vector<fs::path>& inputs) { return read_answers(inputs, {}).is_pilot; }},
    {"participant,demonstration,left,right,choice", "1,a,b,a",
     [](const std::vector<fs::path>& inputs) { return read_comparisons(inputs, {}).is_pilot; }},
    {"participant,demonstration,level,correct", "1,0.5,1",
     [](const std::vector<fs::path>& inputs) { return read_levels(inputs, {}).is_pilot; }}};

TEST(Pilots, TablesOfAPilotAreReadAlone) {
  for (const Form& form : forms) {
    const TemporaryFolder folder;
    const auto table = [&](const char* participant, const std::string& pilot) {
      const bool column = pilot != "-";
      return folder.write(fmt::format("{}{}.csv", participant, pilot),
                          fmt::format("{}{}\n{},{}{}\n", form.header, column ? ",pilot" : "",
                                      participant, form.row, column ? "," + pilot : ""));
    };
    const auto why = [&](const std::vector<fs::path>& inputs) -> std::string {
      try {
        form.is_pilot(inputs);
      } catch (const InputError& error) {
        return error.what();
      }
      return "";
    };
    const fs::path pilot = table("p", "true"), real = table("q", "-"), said = table("r", "false");
    EXPECT_TRUE(form.is_pilot({pilot, table("s", "true")}));
    EXPECT_FALSE(form.is_pilot({real, said, table("t", "")}));
    EXPECT_EQ(why({pilot, real}),
              fmt::format("{}:2: is no answer of a pilot, and {}:2 is one; analyse the pilot in a "
                          "run of its own",
                          real.string(), pilot.string()))
        << form.header;
    EXPECT_NE(why({said, pilot}).find("is an answer of a pilot, and"), std::string::npos);
    EXPECT_NE(why({table("u", "yes")}).find("pilot `yes` is unknown"), std::string::npos);
    const fs::path both = folder.write(
        "both.csv", fmt::format("{0},pilot\np,{1},true\nq,{1},false\n", form.header, form.row));
    EXPECT_NE(why({both}).find("both.csv:3: is no answer of a pilot"), std::string::npos);
  }
}

TEST(Pilots, AFolderOfAPilotIsReadWithoutTables) {
  const TemporaryFolder folder;
  nlohmann::json file = test::answer_document("p-1");
  file["pilot"] = true;
  const fs::path pilot = folder.write("pilot/a.json", file.dump());
  const fs::path real = folder.write(
      "real.csv",
      "participant,demonstration,choice\nq,01-roll-over,pinch\nq,07-driven-roller,cable\n");
  EXPECT_THROW(read_answers({pilot, real}, {}), InputError);
  EXPECT_THROW(read_answers({real, pilot}, {}), InputError);

  // The report's own table says so too.
  const AnswersTable table = read_answers({pilot}, {});
  ASSERT_TRUE(table.is_pilot);
  std::ostringstream out;
  write_tidy_csv(table, out);
  const fs::path tidy = folder.write("tidy.csv", out.str());
  EXPECT_TRUE(read_answers({tidy}, {}).is_pilot);
  EXPECT_THROW(read_answers({tidy, real}, {}), InputError);
}

}  // namespace
}  // namespace pinchlab::analysis
