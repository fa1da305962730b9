// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>
#include <tuple>

#include "analysis/csv_columns.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/text_checks.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
namespace fs = std::filesystem;

TEST(AnswerFiles, OneFileHoldsAllThatTheFormatKnows) {
  const TemporaryFolder folder;
  folder.write("a.json", test::answer_document("p-1").dump());
  const AnswersTable table = read_answers({folder.path()}, {});
  ASSERT_EQ(table.answers.size(), 2U);
  ASSERT_EQ(table.demonstrations, (std::vector<std::string>{"01-roll-over", "07-driven-roller"}));
  EXPECT_TRUE(table.answers[0].chose_pinch);
  EXPECT_EQ(table.answers[0].pinch_side, Side::left);
  EXPECT_EQ(table.answers[0].position, 4);
  EXPECT_EQ(table.answers[0].reaction_time_s, 5.5);
  EXPECT_FALSE(table.answers[1].chose_pinch);  // `baseline` is the method called cable
  EXPECT_EQ(table.answers[1].pinch_side, Side::right);
  const Session& session = table.sessions.at(0);
  EXPECT_EQ(session.attention_passed, 1);
  EXPECT_EQ(session.attention_failed, 0);
  EXPECT_EQ(session.dropped_frames, 4);
  EXPECT_EQ(session.free_text.at("common_details"), "The cable, it \"clips\" <through>.");
}

TEST(AnswerFiles, FolderReadsJsonFilesButNotTheDescription) {
  const TemporaryFolder folder;
  folder.write("b.json", test::answer_document("p-2").dump());
  folder.write("a.json", test::answer_document("p-1").dump());
  folder.write("dataset_description.json", R"({"Name": "A study"})");
  folder.write(".half.json", "{");
  folder.write("notes.txt", "not an answer");
  EXPECT_EQ(read_answers({folder.path()}, {}).participants,
            (std::vector<std::string>{"p-1", "p-2"}));
}

// The documented schema and the strict reader know the same keys, required and optional.
TEST(AnswerFiles, SchemaAndReaderAgree) {
  const json schema =
      json::parse(test::read_text(fs::path(PINCHLAB_SOURCE_DIR) / "analysis/answers.schema.json"));
  const json full = test::answer_document();
  const auto check = [&](const json& described, const json::json_pointer& place) {
    for (const auto& [key, unused] : full.at(place).items()) {
      EXPECT_TRUE(described["properties"].contains(key)) << key << " is not in the schema";
    }
    for (const auto& [key, unused] : described["properties"].items()) {
      // Of attention trials only, and of other kinds of studies (test_comparisons.cpp,
      // test_graded.cpp).
      static const std::set<std::string> elsewhere = {
          "expected",   "methods", "graded_hit", "adaptive", "level",   "preference",
          "confidence", "reason",  "where_side", "where_x",  "where_y", "where_time_s"};
      if (elsewhere.contains(key)) continue;
      EXPECT_TRUE(full.at(place).contains(key)) << key << " is not in the test document";
      json without = full;
      without.at(place).erase(key);
      const auto& required = described["required"];
      const bool needed = std::find(required.begin(), required.end(), key) != required.end();
      if (needed) {
        EXPECT_THROW(parse_answer_file(without, "f"), InputError) << key;
      } else {
        EXPECT_NO_THROW(parse_answer_file(without, "f")) << key;
      }
    }
  };
  check(schema, json::json_pointer(""));
  check(schema["properties"]["plan"], json::json_pointer("/plan"));
  check(schema["$defs"]["trial"], json::json_pointer("/trials/1"));
}

TEST(Csv, QuotesCarriageReturnsAndByteOrderMarks) {
  const AnswersTable table = test::table_of(
      "\xEF\xBB\xBFparticipant,demonstration,choice\r\n\"Smith, "
      "\"\"J\"\"\",\"1\",pinch\r\n\r\nb,1,\"cable\"");
  EXPECT_EQ(table.participants, (std::vector<std::string>{"Smith, \"J\"", "b"}));
}

TEST(Csv, OtherNamesAndSeparators) {
  ReadOptions options;
  options.columns = {{"participant", "subject"}, {"demonstration", "scene"}, {"choice", "picked"}};
  options.pinch_value = "ours";
  options.cable_value = "theirs";
  options.separator = ';';
  options.ignore_other_columns = true;
  const AnswersTable table =
      test::table_of("age;subject;scene;picked\n31;a;ducks;ours\n32;b;ducks;theirs\n", options);
  EXPECT_EQ(table.counts[0].pinch, 1);
  EXPECT_EQ(table.counts[0].cable, 1);
  EXPECT_EQ(table.groups.size(), 1U);  // no group is guessed for names that are not the project's
}

TEST(Csv, RecordsLongerThanTheBufferAndFilesOfManyBuffers) {
  std::string csv = "participant,demonstration,choice\n";
  for (int i = 0; i < 200000; ++i)
    csv += fmt::format("participant-{:06},1,{}\n", i, i % 4 == 0 ? "cable" : "pinch");
  ASSERT_GT(csv.size(), size_t{3} << 20);
  EXPECT_EQ(test::table_of(csv).counts[0].pinch, 150000);
}

TEST(Groups, DefaultByLeadingNumberFileAndColumn) {
  const AnswersTable numbered = test::table_of(test::thesis_counts_csv());
  ASSERT_EQ(numbered.groups.size(), 3U);
  EXPECT_EQ(numbered.groups[0].name, "clipping");
  EXPECT_EQ(numbered.groups[0].demonstrations.size(), 6U);
  EXPECT_EQ(numbered.groups[1].name, "friction");
  EXPECT_EQ(numbered.groups[2].name, "all");

  const AnswersTable column =
      test::table_of("demonstration,pinch,cable,group\nx,3,1,soft\ny,2,2,hard\nz,1,1,\n");
  ASSERT_EQ(column.groups.size(), 3U);
  EXPECT_EQ(column.groups[0].name, "soft");

  const TemporaryFolder folder;
  ReadOptions options;
  options.groups_file =
      folder.write("groups.csv", "demonstration,group\n1,first\n2,first\n2,even\n");
  const AnswersTable file = test::table_of(test::thesis_counts_csv(), options);
  ASSERT_EQ(file.groups.size(), 3U);
  EXPECT_EQ(file.groups[0].name, "first");
  EXPECT_EQ(file.groups[1].demonstrations, (std::vector<std::uint16_t>{1}));
}

TEST(Columns, ThatAreMappedToAreThere) {
  const TemporaryFolder folder;
  const fs::path one = folder.write("one.csv", "subject,demonstration,choice,place\na,1,pinch,1\n");
  const fs::path other = folder.write("other.csv", "participant,demonstration,choice,rt\n");
  const auto why_not = [&](const std::string& ours, const std::string& theirs,
                           const std::vector<fs::path>& inputs) -> std::string {
    ReadOptions options;
    options.columns = {{ours, theirs}};
    try {
      check_mapped_columns(inputs, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(why_not("position", "plase", {one}),
            one.string() +
                ":1: --map-column position=plase: there is no column `plase` (did you "
                "mean `place`?); there are `subject`, `demonstration`, `choice`, "
                "`place`");
  EXPECT_EQ(why_not("position", "place", {one}), "");
  EXPECT_EQ(why_not("reaction_time_s", "rt", {one, other}), "") << "one of them has it";
  EXPECT_NE(why_not("reaction_time_s", "RT", {one, other}), "");
  EXPECT_EQ(why_not("reaction_time_s", "RT", {folder.path()}), "") << "told elsewhere";
}

// One hypothesis under two names is one of the family.
TEST(Groups, WithTheSameMembersCountOnce) {
  const TemporaryFolder folder;
  const auto groups_of = [&](const std::string& file) {
    ReadOptions options;
    options.groups_file = folder.write("groups.csv", "demonstration,group\n" + file);
    return analyse_table(test::table_of(test::thesis_counts_csv(), options), {}).groups;
  };
  const auto once = groups_of("1,first\n2,first\n7,other\n");
  const auto twice = groups_of("1,first\n2,first\n7,other\n2,again\n1,again\n");
  ASSERT_EQ(once.size(), 3U);
  ASSERT_EQ(twice.size(), 4U);
  const auto p_of = [](const std::vector<GroupResult>& groups, const std::string& name) {
    const auto found = std::ranges::find(groups, name, [](const auto& g) { return g.row.name; });
    return std::tuple(found->row.p_holm, found->row.p_bh, found->row.read.p_holm.value,
                      found->p_sign_flip_holm);
  };
  for (const char* name : {"first", "other", "all"}) {
    EXPECT_EQ(p_of(twice, name), p_of(once, name)) << name;
  }
  EXPECT_EQ(p_of(twice, "again"), p_of(twice, "first"));
  // Where a group is all that there is, nothing is adjusted.
  const auto all =
      groups_of("1,whole\n2,whole\n3,whole\n4,whole\n5,whole\n6,whole\n7,whole\n8,whole\n");
  EXPECT_EQ(all[0].row.p_holm, all[0].row.p_chi_square);
  EXPECT_EQ(p_of(all, "whole"), p_of(all, "all"));
}

TEST(Exclusions, LeaveOutAndAreKept) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.exclude_file =
      folder.write("out.csv", "participant,reason\np01,\"did not look, at all\"\n");
  const AnswersTable table = test::table_of(test::tidy_csv(test::clustered_rows()), options);
  EXPECT_EQ(table.participants.size(), 15U);
  ASSERT_EQ(table.exclusions.size(), 1U);
  EXPECT_EQ(table.exclusions[0].reason, "did not look, at all");
}

TEST(Missing, IsListedWhereItIsAllowed) {
  ReadOptions options;
  options.allow_missing = true;
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice\na,1,pinch\na,2,pinch\nb,1,cable\n", options);
  EXPECT_EQ(table.incomplete, (std::vector<std::string>{"b"}));
}

TEST(Repetitions, AreNoDoubles) {
  ReadOptions options;
  options.repetitions = 2;
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice,position\na,1,pinch,1\na,1,cable,2\nb,1,pinch,2\nb,1,pinch,"
      "1\n",
      options);
  EXPECT_EQ(table.counts[0].pinch, 3);
}

TEST(NaturalOrder, NumbersCompareAsNumbers) {
  EXPECT_TRUE(natural_less("2-stack", "10-drop"));
  EXPECT_TRUE(natural_less("a9b", "a10b"));
  EXPECT_FALSE(natural_less("10", "2"));
  EXPECT_TRUE(natural_less("1", "01") != natural_less("01", "1"));
  EXPECT_FALSE(natural_less("x", "x"));
}

// Everything below must be refused, with the file and a cure in the message.

}  // namespace
}  // namespace pinchlab::analysis
