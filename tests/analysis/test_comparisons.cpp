// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs and reports of studies of three methods and more.
#include <gsl/gsl_randist.h>

#include "analysis/blocks.h"
#include "analysis/comparisons_table.h"
#include "analysis/gsl_support.h"
#include "analysis/levels_table.h"
#include "analysis/scale_report.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"
#include "tests/base/message_of.h"

namespace pinchlab::analysis {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string why(const fs::path& file, const ReadOptions& options = {}) {
  try {
    read_comparisons({file}, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

std::string answers_csv(int participants, bool reversed = false) {
  const std::vector<std::string> methods{"pinch", "cable", "thesis"};
  const Rng rng = make_rng(RandomUse::study, 3);
  std::vector<std::string> lines;
  for (int p = 0; p < participants; ++p) {
    for (const char* demonstration : {"01-a", "02-b"}) {
      for (size_t i = 0; i < 3; ++i) {
        for (size_t j = i + 1; j < 3; ++j) {
          const bool turned = gsl_rng_uniform_int(rng.get(), 2) == 1;
          const bool first = gsl_rng_uniform(rng.get()) < 0.7;
          lines.push_back(fmt::format("p{:02},{},{},{},{}\n", p, demonstration,
                                      methods[turned ? j : i], methods[turned ? i : j],
                                      methods[first ? i : j]));
        }
      }
    }
  }
  if (reversed) std::ranges::reverse(lines);
  return "participant,demonstration,left,right,choice\n" + fmt::format("{}", fmt::join(lines, ""));
}

TEST(Comparisons, SentencesSayHowSmallAProbabilityIs) {
  EXPECT_EQ(p_equation(0.04551), "p = 0.0455");
  EXPECT_EQ(p_equation(0.0), "p < 1e-300");
  const test::TemporaryFolder folder;
  const ComparisonsTable table =
      read_comparisons({folder.write("counts.csv",
                                     "left,right,left_wins,right_wins\na,b,9000000,1000\n"
                                     "b,c,9000000,1000\na,c,9000000,1000\n")},
                       {});
  const std::string words = scale_words(analyse_scale(table, {}), table);
  EXPECT_NE(words.find("independent, p < 1e-300)"), std::string::npos) << words;
}

TEST(Comparisons, ReadsCountsOfThePublishedTable) {
  const ComparisonsTable table =
      read_comparisons({fs::path(PINCHLAB_SOURCE_DIR) / "analysis/data/citations.csv"}, {});
  EXPECT_EQ(table.answers, 3727);
  EXPECT_EQ(table.methods,
            (std::vector<std::string>{"Biometrika", "Comm Statist", "JASA", "JRSS-B"}));
  EXPECT_TRUE(table.participants.empty());
  const json report = json::parse(scale_json(analyse_scale(table, {}), table));
  const auto value = [&](size_t i) { return report["scale"]["methods"][i]["value"].get<double>(); };
  EXPECT_NEAR(value(1) - value(0), -2.949072496844, 1e-8);
  EXPECT_NEAR(value(2) - value(0), -0.479569769752, 1e-8);
  EXPECT_NEAR(value(3) - value(0), 0.268954055819, 1e-8);
  EXPECT_TRUE(report["equal"]["p_sign_flip"].is_null());
  EXPECT_TRUE(report["left"]["value"].is_null());
  EXPECT_FALSE(report["left"]["value_reason"].get<std::string>().empty());
}

TEST(Comparisons, NoMethodIsCalledTie) {
  const test::TemporaryFolder folder;
  EXPECT_NE(why(folder.write("a.csv", "left,right,choice\na,b,a\na,tie,tie\n"))
                .find("a.csv:3: `tie` as `choice` is neither of the two"),
            std::string::npos);
  EXPECT_EQ(why(folder.write("b.csv", "left,right,left_wins,right_wins\na,tie,3,2\n")), "");
}

TEST(Comparisons, TiesAloneHaveNoScale) {
  const test::TemporaryFolder folder;
  EXPECT_NE(why(folder.write("a.csv", "left,right,choice\na,b,tie\nb,a,tie\n"))
                .find("all answers are ties; a scale needs choices"),
            std::string::npos);
}

TEST(Comparisons, WhereAllAreLeftOutThatIsSaid) {
  const test::TemporaryFolder folder;
  ReadOptions options;
  options.exclude_file = folder.write("out.csv", "participant,reason\np,late\n");
  const auto message = [&](const char* csv, const auto& read) {
    return pinchlab::test::message_of<InputError>(
        [&] { read({folder.write("a.csv", csv)}, options); });
  };
  const std::string expected = "all participants are left out, by --exclude or by the rules";
  EXPECT_NE(message("participant,left,right,choice\np,a,b,a\n", read_comparisons).find(expected),
            std::string::npos);
  EXPECT_NE(message("participant,level,correct\np,1,1\n", read_levels).find(expected),
            std::string::npos);
  EXPECT_NE(message("participant,demonstration,choice\np,a,pinch\n", read_answers).find(expected),
            std::string::npos);
}

TEST(Comparisons, TheOrderOfTheInputChangesNothing) {
  const test::TemporaryFolder folder;
  const ComparisonsTable one = read_comparisons({folder.write("a.csv", answers_csv(12))}, {});
  const ComparisonsTable other =
      read_comparisons({folder.write("b.csv", answers_csv(12, true))}, {});
  EXPECT_EQ(scale_json(analyse_scale(one, {}), one), scale_json(analyse_scale(other, {}), other));
}

TEST(Comparisons, WritesAWholeReport) {
  const test::TemporaryFolder folder;
  const ComparisonsTable table = read_comparisons({folder.write("a.csv", answers_csv(12))}, {});
  const ScaleReport report = analyse_scale(table, {});
  const auto written = write_scale_report(report, table, folder.path() / "report", false);
  for (const std::string& name : written) EXPECT_TRUE(fs::exists(folder.path() / "report" / name));
  const std::string page = test::read_text(folder.path() / "report/report.md");
  for (const char* words : {"pinch", "Circular triads", "sign flips over participants (exact)",
                            "Values by demonstration", "The left is chosen"}) {
    EXPECT_NE(page.find(words), std::string::npos) << words;
  }
  const std::string people = test::read_text(folder.path() / "report/participants.csv");
  EXPECT_EQ(std::ranges::count(people, '\n'), 13);
  const json document = json::parse(test::read_text(folder.path() / "report/report.json"));
  EXPECT_EQ(document["pairs"].size(), 3U);
  EXPECT_EQ(document["transitivity"]["rounds"], 24);
  EXPECT_EQ(document["scale"]["methods"][0]["name"], "cable");
}

std::string page_of(const ScaleReport& report, const ComparisonsTable& table) {
  const test::TemporaryFolder folder;
  write_scale_report(report, table, folder.path() / "report", false);
  return test::read_text(folder.path() / "report/report.md");
}

// Participants who choose alike tell nothing of how participants differ, and round-off must not
// pass for it: it gave p = 1e-95.
TEST(Comparisons, ThoseWhoAreOfOneMindGiveNoErrors) {
  const test::TemporaryFolder folder;
  std::string csv = "participant,left,right,choice\n";
  for (int i = 0; i < 7; ++i) {
    for (const char* row : {"x,y,x", "y,x,x", "x,y,y", "y,z,y", "z,y,y", "y,z,z", "x,z,x", "z,x,x",
                            "x,z,z", "z,x,x"}) {
      csv += fmt::format("p{},{}\n", i, row);
    }
  }
  const ComparisonsTable table = read_comparisons({folder.write("x.csv", csv)}, {});
  const ScaleReport report = analyse_scale(table, {});
  ASSERT_EQ(report.fit().why_not, "");
  for (const ScalePair& pair : report.pairs) {
    EXPECT_GT(pair.difference, 0.5);
    for (const Estimate& none : {pair.p, pair.p_holm, pair.low, pair.high})
      EXPECT_EQ(none.why_not, "participants do not differ at all");
  }
  EXPECT_FALSE(report.all.values[0].low || report.all.values[0].high || report.p_side);
  EXPECT_NE(scale_words(report, table).find("participants do not differ at all: x and y"),
            std::string::npos)
      << scale_words(report, table);
  const json document = json::parse(scale_json(report, table));
  EXPECT_GT(document["pairs"][0]["difference"].get<double>(), 0.5);
  EXPECT_TRUE(document["pairs"][0]["low"].is_null());
  EXPECT_NE(page_of(report, table).find("| x over y | 14 of 21 | 66.7 | 64.4 | 0.59 | – | – | – |"),
            std::string::npos)
      << page_of(report, table);
}

// Two methods make no triples, and of four participants none is far from the others for sure.
TEST(Comparisons, OfFewNothingIsSaidThatIsNotKnown) {
  const test::TemporaryFolder folder;
  const std::string head = "participant,left,right,choice\n";
  std::string csv = head + "a,x,y,x\nb,y,x,x\nc,x,y,y\nd,y,x,y\n";
  const auto page = [&] {
    const ComparisonsTable table = read_comparisons({folder.write("x.csv", csv)}, {});
    const ScaleReport report = analyse_scale(table, {});
    EXPECT_EQ(scale_json(report, table).find("\"far_out_reason\"") == std::string::npos,
              table.participants.size() > 4);
    return page_of(report, table);
  };
  const std::string few = page();
  EXPECT_EQ(few.find("nan"), std::string::npos) << few;
  EXPECT_EQ(few.find("Circular triads"), std::string::npos);
  EXPECT_EQ(few.find("No participant chooses far otherwise"), std::string::npos);
  EXPECT_NE(few.find("is not looked for: fewer than five participants"), std::string::npos);
  csv += "e,x,y,x\nf,y,x,x\n";
  EXPECT_NE(page().find("No participant chooses far otherwise"), std::string::npos);
}

TEST(Comparisons, RefusesWhatCannotBe) {
  const test::TemporaryFolder folder;
  const auto csv = [&](const std::string& text) { return folder.write("x.csv", text); };
  EXPECT_NE(why(csv("left,right\na,b\n")).find("need either a column `choice`"), std::string::npos);
  EXPECT_NE(why(csv("left,right,choice,left_wins,right_wins\na,b,a,1,2\n")).find("either"),
            std::string::npos);
  EXPECT_NE(why(csv("left,right,choice\na,a,a\n")).find("with itself"), std::string::npos);
  EXPECT_NE(why(csv("left,right,choice\na,b,c\n")).find("x.csv:2"), std::string::npos);
  EXPECT_NE(why(csv("left,right,left_wins,right_wins\na,b,-1,2\n")).find("whole number"),
            std::string::npos);
  EXPECT_NE(why(csv("left,right,choise\na,b,a\n")).find("choice"), std::string::npos);
  EXPECT_NE(why(csv("left,right,choice\n")).find("no answers"), std::string::npos);
  EXPECT_NE(why(csv("left,right,choice\na,b\n")).find("fields"), std::string::npos);
  EXPECT_NE(why(csv("participant,left,right,choice\np,a,b,a\n"),
                [&] {
                  ReadOptions options;
                  options.exclude_file = folder.write("out.csv", "participant,reason\nq,late\n");
                  return options;
                }())
                .find("`q`"),
            std::string::npos);
}

TEST(Comparisons, TiesAreCounted) {
  const test::TemporaryFolder folder;
  const ComparisonsTable table = read_comparisons(
      {folder.write("x.csv", "left,right,choice\na,b,a\nb,a,tie\nb,c,b\nc,b,c\na,c,tie\n")}, {});
  EXPECT_EQ(table.ties, 2);
  const ScaleReport report = analyse_scale(table, {});
  EXPECT_EQ(report.fit().why_not, "");
  EXPECT_GT(report.fit().tie.value, 0.0);
}

json answer_file(const std::string& who) {
  json file = json::parse(R"({"format": "pinchlab-answers", "version": 1,
    "plan": {"demonstrations": ["01-a"], "answers_per_demonstration": 3},
    "started_utc": "2026-11-20T12:00:00Z", "saved_utc": "2026-11-20T12:05:00Z",
    "software_version": "0", "trials": []})");
  file["participant"] = who;
  return file;
}

json trial(int position, const char* left, const char* right, const char* choice) {
  return {{"position", position}, {"kind", "main"},   {"demonstration", "01-a"}, {"left", left},
          {"right", right},       {"choice", choice}, {"reaction_time_s", 1.0}};
}

TEST(Comparisons, ReadsAnswerFilesOfNamedMethods) {
  const test::TemporaryFolder folder;
  for (const char* who : {"p1", "p2"}) {
    json file = answer_file(who);
    file["plan"]["methods"] = {"pinch", "cable", "thesis"};
    file["trials"] = {trial(1, "pinch", "cable", "left"), trial(2, "thesis", "pinch", "right"),
                      trial(3, "thesis", "cable", "left")};
    folder.write(fmt::format("answers/{}.json", who), file.dump());
  }
  ASSERT_TRUE(has_comparisons(folder.path() / "answers", {}));
  const ComparisonsTable table = read_comparisons({folder.path() / "answers"}, {});
  EXPECT_EQ(table.answers, 6);
  EXPECT_EQ(table.participants, (std::vector<std::string>{"p1", "p2"}));
  EXPECT_THROW(read_answers({folder.path() / "answers"}, {}), InputError);
  // A method that the plan does not know, and another plan.
  json file = answer_file("p3");
  file["plan"]["methods"] = {"pinch", "cable", "thesis"};
  file["trials"] = {trial(1, "pinch", "kable", "left")};
  EXPECT_THROW(parse_answer_file(file, "f"), InputError);
  file["plan"]["methods"] = {"pinch", "cable"};
  file["trials"] = {trial(1, "pinch", "cable", "left"), trial(2, "pinch", "cable", "left"),
                    trial(3, "pinch", "cable", "left")};
  folder.write("answers/p3.json", file.dump());
  EXPECT_NE(why(folder.path() / "answers").find("other methods"), std::string::npos);
}

// Whoever names an export beside its answer files, or a copy of it, does not have twice as many
// answers.
TEST(Comparisons, NoAnswerCountsTwice) {
  const test::TemporaryFolder folder;
  json file = answer_file("p1");
  file["plan"]["methods"] = {"pinch", "cable", "thesis"};
  file["trials"] = {trial(1, "pinch", "cable", "left"), trial(2, "thesis", "pinch", "right"),
                    trial(3, "thesis", "cable", "left")};
  folder.write("answers/p1.json", file.dump());
  const std::string rows = "p1,pinch,cable,pinch\np1,thesis,pinch,pinch\n";
  const auto answers = folder.path() / "answers";
  const auto table = folder.write("a.csv", "participant,left,right,choice\n" + rows);
  const auto copy = folder.write("b.csv", "participant,left,right,choice\n" + rows);
  const auto others =
      folder.write("c.csv", "participant,left,right,choice\np2,pinch,cable,pinch\n");
  const auto why_not = [](const std::vector<test::fs::path>& inputs) -> std::string {
    try {
      read_comparisons(inputs, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(why_not({answers, table}).find("participant `p1` has answers in"), std::string::npos);
  EXPECT_NE(why_not({table, answers}).find("participant `p1` has answers in"), std::string::npos);
  EXPECT_NE(why_not({table, copy}).find("holds the same answers as"), std::string::npos);
  EXPECT_NE(why_not({table, table}).find("named twice"), std::string::npos);
  EXPECT_EQ(why_not({answers, others}), "");
  EXPECT_EQ(why_not({table, others}), "");
}

TEST(Levels, NoAnswerCountsTwice) {
  const test::TemporaryFolder folder;
  json file = answer_file("p1");
  file["plan"]["graded_hit"] = "reference";
  file["plan"]["answers_per_demonstration"] = 1;
  file["trials"] = {trial(1, "reference", "graded", "left")};
  file["trials"][0]["level"] = 0.5;
  folder.write("answers/p1.json", file.dump());
  const auto answers = folder.path() / "answers";
  const std::string head = "participant,demonstration,level,correct\n";
  const auto table = folder.write("a.csv", head + "p1,01-a,0.5,1\n");
  const auto copy = folder.write("b.csv", head + "p1,01-a,0.5,1\n");
  const auto later = folder.write("c.csv", head + "p1,01-a,0.25,1\n");  // of another day
  EXPECT_THROW(read_levels({answers, table}, {}), InputError);
  EXPECT_THROW(read_levels({table, answers}, {}), InputError);
  EXPECT_THROW(read_levels({table, copy}, {}), InputError);
  EXPECT_EQ(read_levels({table, later}, {}).series[0].observers[0].cells.size(), 2U);
}

// What is the same by chance may be there twice; what is the same row may not.
TEST(Comparisons, NoRowCountsTwice) {
  const test::TemporaryFolder folder;
  const auto why_not = [&](const std::string& head, const std::string& rows) -> std::string {
    try {
      read_comparisons({folder.write("a.csv", head + "\n" + rows)}, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string single = "participant,left,right,choice,position";
  EXPECT_NE(why_not(single, "p,a,b,a,1\np,b,a,b,2\np,a,b,a,1\n")
                .find("a.csv:4: participant `p` has two answers at position 1 (also in line 2)"),
            std::string::npos);
  EXPECT_EQ(why_not(single, "p,a,b,a,1\np,a,b,a,2\nq,a,b,a,1\np,a,b,a,\np,a,b,a,\n"), "");
  EXPECT_NE(why_not(single, "p,a,b,a,0\n").find("position `0` is not a whole number from 1"),
            std::string::npos);
  const std::string totals = "left,right,left_wins,right_wins";
  EXPECT_NE(why_not(totals, "a,b,5,3\nb,a,5,3\na,b,5,3\n").find("a.csv:4: says the same as line 2"),
            std::string::npos);
  EXPECT_EQ(why_not(totals, "a,b,5,3\nb,a,5,3\na,b,5,4\na,b,1,0\na,b,1,0\n"), "");
}

TEST(Levels, NoRowCountsTwice) {
  const test::TemporaryFolder folder;
  const auto why_not = [&](const std::string& head, const std::string& rows) -> std::string {
    try {
      read_levels({folder.write("a.csv", head + "\n" + rows)}, {});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const std::string single = "participant,level,correct,position";
  EXPECT_NE(why_not(single, "p,0.5,1,1\np,0.5,1,2\np,0.5,1,1\n")
                .find("a.csv:4: participant `p` has two answers at position 1 (also in line 2)"),
            std::string::npos);
  EXPECT_EQ(why_not(single, "p,0.5,1,1\np,0.5,1,2\nq,0.5,1,1\np,0.5,1,\np,0.5,1,\n"), "");
  const std::string totals = "level,trials,correct";
  EXPECT_NE(why_not(totals, "1,10,9\n2,10,10\n1,10,9\n").find("a.csv:4: says the same as line 2"),
            std::string::npos);
  EXPECT_EQ(why_not(totals, "1,10,9\n1,10,8\n2,1,1\n2,1,1\n"), "");
}

TEST(Levels, ReadsAnswerFilesOfGradedClips) {
  const test::TemporaryFolder folder;
  for (const char* who : {"p1", "p2"}) {
    json file = answer_file(who);
    file["plan"]["graded_hit"] = "reference";
    file["trials"] = {trial(1, "reference", "graded", "left"),
                      trial(2, "graded", "reference", "left"),
                      trial(3, "graded", "reference", "right")};
    for (size_t i = 0; i < 3; ++i) file["trials"][i]["level"] = i == 0 ? 0.1 : 0.2;
    folder.write(fmt::format("answers/{}.json", who), file.dump());
    if (who == std::string("p2")) {
      file["trials"][1].erase("level");
      EXPECT_THROW(parse_answer_file(file, "f"), InputError);
    }
  }
  ASSERT_TRUE(has_levels(folder.path() / "answers", {}));
  const LevelsTable table = read_levels({folder.path() / "answers"}, {});
  EXPECT_TRUE(table.correct);
  ASSERT_EQ(table.series.size(), 1U);
  ASSERT_EQ(table.series[0].observers.size(), 2U);
  const std::vector<LevelCell>& cells = table.series[0].observers[0].cells;
  ASSERT_EQ(cells.size(), 2U);
  EXPECT_EQ(cells[0].hits, 1);
  EXPECT_EQ(cells[1].trials, 2);
  EXPECT_EQ(cells[1].hits, 1);
}

TEST(AnswerFiles, APilotIsNeverAnalysedWithTheRest) {
  const test::TemporaryFolder folder;
  for (const char* who : {"p1", "p2"}) {
    json file = answer_file(who);
    file["plan"]["answers_per_demonstration"] = 1;
    file["trials"] = {trial(1, "pinch", "baseline", "left")};
    if (who == std::string("p2")) file["pilot"] = true;
    folder.write(fmt::format("{}.json", who), file.dump());
  }
  EXPECT_NO_THROW(read_answers({folder.path() / "p2.json"}, {}));
  EXPECT_THROW(read_answers({folder.path()}, {}), InputError);
}

}  // namespace
}  // namespace pinchlab::analysis
