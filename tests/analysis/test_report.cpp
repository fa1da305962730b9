// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "analysis/document.h"
#include "analysis/gnuplot.h"
#include "analysis/pages.h"
#include "base/input_error.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
namespace fs = std::filesystem;

json json_of(const AnswersTable& table, const AnalysisOptions& options = {}) {
  return json::parse(report_json(analyse_table(table, options), table));
}

const TableBlock& table_named(const Document& document, const std::string& caption) {
  for (const Block& block : document.blocks) {
    const auto* table = std::get_if<TableBlock>(&block);
    if (table && table->caption == caption) return *table;
  }
  throw std::runtime_error("no table " + caption);
}

std::vector<std::string> texts(const std::vector<TextCell>& row) {
  std::vector<std::string> result;
  result.reserve(row.size());
  for (const TextCell& cell : row) result.push_back(cell.text);
  return result;
}

class Thesis : public testing::Test {
 protected:
  AnswersTable table =
      read_answers({fs::path(PINCHLAB_SOURCE_DIR) / "analysis/data/thesis-table-5.3.csv"}, {});
  Report report = analyse_table(table, {});
  Document document = make_document(report, table);
  using Strings = std::vector<std::string>;
};

TEST_F(Thesis, Table53ComesOutOfItsCounts) {
  const TableBlock& block = table_named(document, "2AFC results, chi-square analysis");
  EXPECT_EQ(block.header, (Strings{"", "1", "2", "3", "4", "5", "6", "7", "8"}));
  EXPECT_EQ(texts(block.rows[0]),
            (Strings{"pinch", "15", "12", "14", "13", "13", "13", "6", "10"}));
  EXPECT_EQ(texts(block.rows[1]), (Strings{"cable", "1", "4", "2", "3", "3", "3", "10", "6"}));
  EXPECT_EQ(texts(block.rows[2]),
            (Strings{"Expected distribution", "8", "8", "8", "8", "8", "8", "8", "8"}));
  // The thesis prints 0.045 in the second place; the value is 0.0455003, which rounds to 0.046.
  EXPECT_EQ(texts(block.rows[3]), (Strings{"Distribution probability (p-value)", "<0.001", "0.046",
                                           "0.003", "0.012", "0.012", "0.012", "0.317", "0.317"}));
  EXPECT_NEAR(report.demonstrations[1].row.p_chi_square, 0.0455003, 5e-8);
  for (size_t i = 1; i <= 8; ++i) EXPECT_EQ(block.rows[3][i].bold, i <= 6) << i;
}

TEST_F(Thesis, Table54ComesOutOfItsCounts) {
  const TableBlock& block = table_named(document, "2AFC results, chi-square analysis (aggregated)");
  EXPECT_EQ(block.header, (Strings{"", "clipping", "friction", "all"}));
  EXPECT_EQ(texts(block.rows[0]), (Strings{"pinch", "80", "16", "96"}));
  EXPECT_EQ(texts(block.rows[1]), (Strings{"cable", "16", "16", "32"}));
  EXPECT_EQ(texts(block.rows[2]), (Strings{"Expected distribution", "48", "16", "64"}));
  EXPECT_EQ(texts(block.rows[3]),
            (Strings{"Distribution probability (p-value)", "<0.0001", "1", "<0.0001"}));
  EXPECT_TRUE(block.rows[3][1].bold);
  EXPECT_FALSE(block.rows[3][2].bold);
}

TEST_F(Thesis, TheFirstParagraphAnswersTheQuestion) {
  const auto& first = std::get<Paragraph>(document.blocks.front()).text;
  EXPECT_TRUE(first.starts_with("Pinch was preferred to cable")) << first;
  EXPECT_NE(first.find("1 (15 of 16)"), std::string::npos);
  EXPECT_NE(first.find("80 of 96 clipping answers"), std::string::npos);
  EXPECT_NE(first.find("average of unlike cases"),
            std::string::npos);  // heterogeneity over the eight
}

TEST_F(Thesis, CountsSayWhatTheyCannotTell) {
  const json document_json = json_of(table);
  EXPECT_TRUE(document_json["pooled"]["rao_scott_chi_square"].is_null());
  EXPECT_NE(
      document_json["pooled"]["rao_scott_chi_square_reason"].get<std::string>().find("counts"),
      std::string::npos);
  EXPECT_TRUE(document_json["cochran_q"]["q"].is_null());
  EXPECT_TRUE(document_json["side_bias"]["p_mantel_haenszel"].is_null());
  EXPECT_FALSE(document_json["pooled"]["chi_square"].is_null());
}

TEST(ReportJson, HoldsTheDocumentedKeys) {
  const json document = json_of(test::clustered_table());
  for (const char* list : {"demonstrations", "groups"}) {
    for (const json& entry : document[list]) {
      for (const char* key : {"name", "pinch", "cable", "share", "chi_square", "p_chi_square",
                              "p_exact", "wilson_low", "wilson_high", "clopper_pearson_low",
                              "clopper_pearson_high", "cohens_h", "p_holm", "p_bh"}) {
        EXPECT_TRUE(entry.contains(key) && !entry[key].is_null()) << list << " " << key;
      }
    }
  }
  const auto holds = [&](const char* object, const std::vector<const char*>& keys) {
    for (const char* key : keys)
      EXPECT_TRUE(document[object].contains(key)) << object << " " << key;
  };
  holds("pooled", {"chi_square", "p_naive", "design_effect", "rao_scott_chi_square", "p_rao_scott",
                   "p_sign_flip"});
  holds("heterogeneity", {"chi_square", "df", "p"});
  holds("cochran_q", {"q", "df", "p"});
  holds("side_bias", {"left", "right", "bias", "p_mantel_haenszel", "p_sign_flip"});
  EXPECT_EQ(document["pooled"]["p_sign_flip"].get<double>(), 2.0 / 65536.0);
}

// Every null has its reason beside it, and no number is anything but finite.
void check_nulls(const json& value, const std::string& place) {
  if (value.is_number()) {
    EXPECT_TRUE(std::isfinite(value.get<double>())) << place;
  }
  if (!value.is_structured()) return;
  for (const auto& [key, child] : value.items()) {
    if (child.is_null()) {
      EXPECT_TRUE(value.is_object() && value.contains(key + "_reason") &&
                  !value[key + "_reason"].get<std::string>().empty())
          << place << "/" << key;
    }
    check_nulls(child, fmt::format("{}/{}", place, key));
  }
}

TEST(ReportJson, DegenerateStudiesHaveReasonsAndNoNaN) {
  const std::string head = "participant,demonstration,choice\n";
  for (const std::string& rows :
       std::vector<std::string>{
           "a,1,pinch\n",                                      // one answer
           "a,1,pinch\na,2,cable\n",                           // one participant
           "a,1,pinch\nb,1,pinch\nc,1,cable\n",                // one demonstration
           "a,1,pinch\na,2,pinch\nb,1,pinch\nb,2,pinch\n",     // one choice
           "a,1,cable\na,2,cable\nb,1,cable\nb,2,cable\n",     // the other one
           "a,1,pinch\na,2,cable\nb,1,cable\nb,2,pinch\n",     // no variance between participants
           "a,1,pinch\na,2,cable\nb,1,pinch\nb,2,cable\n"}) {  // complete separation by
                                                               // demonstration
    const AnswersTable table = test::table_of(head + rows);
    const Report report = analyse_table(table, {});
    const json document = json_of(table);
    check_nulls(document, "");
    EXPECT_EQ(document.dump().find("nan"), std::string::npos);
    EXPECT_EQ(report_markdown(report, table).find("nan "), std::string::npos);
    EXPECT_FALSE(plain_words(report, table).empty());
  }
}

TEST(ReportJson, OptionsOutOfRangeAreRefused) {
  const AnswersTable table = test::clustered_table();
  for (double alpha : {0.0, 1.0, -1.0, std::nan("")}) {
    AnalysisOptions options;
    options.alpha = alpha;
    EXPECT_THROW(analyse_table(table, options), InputError);
  }
  AnalysisOptions options;
  options.bootstrap = 98;
  EXPECT_THROW(analyse_table(table, options), InputError);
}

// What is read may be split over files and shuffled: the report is the same byte for byte.
TEST(Properties, SplittingAndShufflingChangesNothing) {
  std::vector<std::string> rows = test::clustered_rows();
  AnswersTable whole = test::table_of(test::tidy_csv(rows));
  const Report report = analyse_table(whole, {});
  const TemporaryFolder folder;
  for (size_t step : {3U, 5U, 37U}) {  // coprime to 128: a permutation
    std::vector<std::string> shuffled;
    for (size_t i = 0; i < rows.size(); ++i)
      shuffled.push_back(rows[(i * step + step) % rows.size()]);
    const auto middle = shuffled.begin() + 50;
    AnswersTable split =
        read_answers({folder.write("a.csv", test::tidy_csv({shuffled.begin(), middle})),
                      folder.write("b.csv", test::tidy_csv({middle, shuffled.end()}))},
                     {});
    EXPECT_EQ(split.participants, whole.participants);
    split.sources = whole.sources;  // the number of files is all that may differ
    EXPECT_EQ(report_json(analyse_table(split, {}), split), report_json(report, whole));
    EXPECT_EQ(report_markdown(analyse_table(split, {}), split), report_markdown(report, whole));
  }
}

TEST(Properties, SwappingTheMethodsFlipsSigns) {
  ReadOptions options;
  const std::string csv = test::tidy_csv(test::clustered_rows());
  const Report report = analyse_table(test::table_of(csv), {});
  std::swap(options.pinch_value, options.cable_value);
  const Report swapped = analyse_table(test::table_of(csv, options), {});
  for (size_t i = 0; i < report.groups.size(); ++i) {
    const GroupResult& a = report.groups[i];
    const GroupResult& b = swapped.groups[i];
    EXPECT_NEAR(a.row.cohens_h, -b.row.cohens_h, 1e-14);
    EXPECT_NEAR(a.scale.jod.value, -b.scale.jod.value, 1e-12);
    EXPECT_NEAR(a.scale.bradley_terry_log_odds.value, -b.scale.bradley_terry_log_odds.value, 1e-12);
    EXPECT_NEAR(a.heterogeneity.chi_square.value, b.heterogeneity.chi_square.value, 1e-9);
    EXPECT_EQ(a.row.p_holm, b.row.p_holm);
    EXPECT_EQ(a.pooled.sign_flip.p.value, b.pooled.sign_flip.p.value);
  }
}

TEST(Scale, OneJodIsThreeQuarters) {
  const ScaleValue value = scale_value({3, 1}, 0.5, 1.0);
  EXPECT_NEAR(value.jod.value, 1.0, 1e-12);
  EXPECT_NEAR(value.jod_low.value, 0.0, 1e-12);
  EXPECT_FALSE(value.jod_high);
  EXPECT_NEAR(value.bradley_terry_log_odds.value, std::log(3.0), 1e-12);
  EXPECT_NEAR(value.thurstone_d.value, std::sqrt(2.0) * 0.674489750196, 1e-9);
}

TEST(Effects, SideOrderAndTimes) {
  // Half of the participants see every pair the other way round. Pinch is chosen in the second half
  // of the session only, wherever it is: no side is preferred.
  std::string csv = "participant,demonstration,choice,side,position,reaction_time_s\n";
  for (int p = 0; p < 10; ++p) {
    for (int j = 1; j <= 4; ++j) {
      csv += fmt::format("p{},{},{},{},{},{}\n", p, j, j > 2 ? "pinch" : "cable",
                         (j > 2) == (p < 5) ? "left" : "right", 10 * j, j);
    }
  }
  const Report report = analyse_table(test::table_of(csv), {});
  EXPECT_EQ(report.side_bias.chosen.pinch, 20);
  EXPECT_EQ(report.side_bias.chosen.cable, 20);
  EXPECT_FALSE(report.side_bias.p);                       // within each demonstration all agree
  ASSERT_EQ(report.order_effect.by_position.size(), 4U);  // ranks, not the positions themselves
  EXPECT_EQ(report.order_effect.by_position[0].pinch, 0);
  EXPECT_EQ(report.order_effect.by_position[3].pinch, 10);
  // Cochran-Armitage by hand: N r^2 with r the correlation of 1, 2, 3, 4 with 0, 0, 1, 1.
  EXPECT_NEAR(report.order_effect.chi_square.value, 40.0 * 0.8, 1e-9);
  EXPECT_EQ(report.order_effect.p_sign_flip.value, 2.0 / 1024.0);
  EXPECT_NEAR(report.order_effect.share_by_place.value, 2.0 / 5.0, 1e-12);
  EXPECT_EQ(report.reaction_times[0].median_s.value, 2.5);
  EXPECT_EQ(report.reaction_times[0].longest_s.value, 4.0);
}

// Which way an order effect goes, and of how many answers side and place are not known.
TEST(Effects, SayTheirDirectionAndWhatTheyLeaveOut) {
  const auto page = [](const char* early, const char* late, const std::string& rest) {
    std::string csv = "participant,demonstration,choice,side,position\n";
    for (int p = 0; p < 10; ++p) {
      csv += fmt::format("p{0},a,{1},left,1\np{0},b,{2},right,2\n", p, p == 0 ? late : early, late);
    }
    ReadOptions options;
    options.allow_missing = true;
    const AnswersTable table = test::table_of(csv + rest, options);
    return report_markdown(analyse_table(table, {}), table);
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  const std::string rises = page("cable", "pinch", "q,a,pinch,,\nq,b,pinch,,2\n");
  // From 2 of 11 to 10 of 10.
  EXPECT_TRUE(has(rises, "answers for pinch changes by +81.8 percentage points")) << rises;
  EXPECT_TRUE(has(rises, "Of 2 answers the side is not known"));
  EXPECT_TRUE(has(rises, "Of 1 answer the place in the session is not known"));
  const std::string falls = page("pinch", "cable", "");
  EXPECT_TRUE(has(falls, "answers for pinch changes by -90.0 percentage points")) << falls;
  EXPECT_FALSE(has(falls, "not known"));
}

TEST(TidyCsv, ReadsBackToTheSameTable) {
  const TemporaryFolder folder;
  folder.write("in/a.json", test::answer_document("p-1").dump());
  folder.write("in/b.json", test::answer_document("a, \"b\"").dump());
  const AnswersTable table = read_answers({folder.path() / "in"}, {});
  std::ostringstream out;
  write_tidy_csv(table, out);
  const AnswersTable again = read_answers({folder.write("answers.csv", out.str())}, {});
  EXPECT_EQ(again.participants, table.participants);
  ASSERT_EQ(again.answers.size(), table.answers.size());
  for (size_t i = 0; i < table.answers.size(); ++i) {
    EXPECT_EQ(again.answers[i].chose_pinch, table.answers[i].chose_pinch);
    EXPECT_EQ(again.answers[i].pinch_side, table.answers[i].pinch_side);
    EXPECT_EQ(again.answers[i].position, table.answers[i].position);
    EXPECT_EQ(again.answers[i].reaction_time_s, table.answers[i].reaction_time_s);
  }
  EXPECT_EQ(again.sessions.at(0).attention_passed, 1);
  EXPECT_EQ(again.groups.size(), table.groups.size());
}

TEST(Pages, TextFromOutsideCannotBecomeMarkup) {
  const TemporaryFolder folder;
  ReadOptions options;
  options.exclude_file =
      folder.write("x.csv", "participant,reason\np01,<script>alert(1)</script> | *no*\n");
  options.pinch_value = "pinch";
  const AnswersTable table = test::table_of(test::tidy_csv(test::clustered_rows()), options);
  const Report report = analyse_table(table, {});
  const std::string html = html_page(make_document(report, table), {});
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_NE(html.find("&lt;script&gt;"), std::string::npos);
  const std::string markdown = report_markdown(report, table);
  EXPECT_EQ(markdown.find("<script"), std::string::npos);
  EXPECT_NE(markdown.find("\\| \\*no\\*"), std::string::npos);
}

TEST(Pages, LatexShowsWhatTheTablesSay) {
  Document document;
  document.title = "A\nB";
  document.blocks = {Heading{"h"}, Paragraph{"p"},
                     TableBlock{"50 % & more_", {"", "p"}, {{{"a\\b"}, {"<0.05", true}}, {{"–"}}}}};
  EXPECT_EQ(latex_tables(document),
            "% A B. Needs \\usepackage{booktabs}.\n\n"
            "\\begin{table}\n  \\centering\n  \\caption{50 \\% \\& more\\_}\n"
            "  \\label{tab:pinchlab-1}\n  \\begin{tabular}{lr}\n  \\toprule\n   & p \\\\\n"
            "  \\midrule\n  a\\textbackslash{}b & \\textbf{$<$0.05} \\\\\n  -- &  \\\\\n"
            "  \\bottomrule\n  \\end{tabular}\n\\end{table}\n");
}

TEST(Pages, LatexTakesNoNameForALengthOrStar) {
  Document document;
  document.blocks = {TableBlock{"c", {""}, {{{"[5pt] a"}}, {{"*b"}}, {{"`c`"}}}}};
  const std::string latex = latex_tables(document);
  EXPECT_NE(latex.find("\\midrule\n  {[}5pt] a \\\\\n  {*}b \\\\\n  \\textasciigrave{}c"),
            std::string::npos)
      << latex;
}

TEST(Pages, HtmlNeedsNothingFromElsewhere) {
  const AnswersTable table = test::clustered_table();
  const Report report = analyse_table(table, {});
  std::vector<Figure> figures = make_figures(report);
  for (Figure& figure : figures) figure.svg = "<svg/>";
  const std::string html = html_page(make_document(report, table), figures);
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_NE(html.find("data:image/svg+xml;base64,PHN2Zy8+"), std::string::npos);
}

TEST(Figures, SayWhatTheyHaveNoRoomFor) {
  std::string csv = "demonstration,pinch,cable\n";
  for (int i = 0; i < 61; ++i) csv += fmt::format("d{},3,1\n", i);
  const std::string more = " 60 of 61 demonstrations; the tables hold all.";
  const AnswersTable many = test::table_of(csv),
                     few = test::table_of("demonstration,pinch,cable\na,3,1\n");
  EXPECT_TRUE(make_figures(analyse_table(many, {})).front().caption.ends_with(more));
  EXPECT_TRUE(make_figures(analyse_table(few, {})).front().caption.ends_with("of all."));
}

TEST(Gnuplot, QuotedTextIsInert) {
  EXPECT_EQ(gnuplot_quote("it's"), "'it''s'");
  EXPECT_EQ(gnuplot_tic("50% slip"), "'50%% slip'");
  EXPECT_EQ(gnuplot_quote("`touch x`"), "'\"touch x\"'");
}

TEST(WriteReport, WritesEveryFileAndLeavesNothingUnfinished) {
  const TemporaryFolder folder;
  const AnswersTable table = test::table_of(
      "participant,demonstration,choice,side,position,reaction_time_s\n"
      "a,it's `a` @b <x>,pinch,left,1,2\nb,it's `a` @b <x>,cable,right,1,3\n");
  const Report report = analyse_table(table, {});
  const fs::path out = folder.path() / "deep" / "out";
  const auto written = write_report(report, table, out, true);
  for (const char* name :
       {"report.html", "report.md", "tables.tex", "report.json", "demonstrations.csv", "groups.csv",
        "answers.csv", "shares.svg", "shares.pdf", "groups.svg", "effects.svg"}) {
    EXPECT_NE(std::find(written.begin(), written.end(), name), written.end()) << name;
  }
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(out)) {
    ++files;
    EXPECT_GT(fs::file_size(entry.path()), 0U) << entry.path();
  }
  EXPECT_EQ(files, written.size());
  EXPECT_NE(test::read_text(out / "shares.svg").find("it's \"a\" @b &lt;x>"), std::string::npos);
}

// A folder holds one report: what only the earlier one had is gone, what is not its own stays.
TEST(WriteReport, RemovesWhatOnlyTheEarlierReportHad) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const AnswersTable answers = test::clustered_table();
  write_report(analyse_table(answers, {}), answers, out, true);
  folder.write("out/notes.csv", "mine");
  const AnswersTable counts = test::table_of("demonstration,pinch,cable\na,7,3\n");
  const auto written = write_report(analyse_table(counts, {}), counts, out, false);
  std::set<std::string> there, expected(written.begin(), written.end());
  for (const auto& entry : fs::directory_iterator(out)) there.insert(entry.path().filename());
  expected.insert("notes.csv");
  EXPECT_EQ(there, expected);
  EXPECT_FALSE(there.contains("answers.csv"));
}

TEST(WriteReport, KeepsWhatItReads) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const AnswersTable answers = test::clustered_table();
  write_report(analyse_table(answers, {}), answers, out, false);
  AnswersTable counts = test::table_of("demonstration,pinch,cable\na,7,3\n");
  counts.sources = {(out / "../out/answers.csv").string()};
  write_report(analyse_table(counts, {}), counts, out, false);
  EXPECT_TRUE(fs::exists(out / "answers.csv"));
}

// Another program's answers.csv has more columns than the report's.
TEST(WriteReport, ReplacesNothingThatItReads) {
  const TemporaryFolder folder;
  AnswersTable table = test::clustered_table();
  const Report report = analyse_table(table, {});
  const fs::path log = folder.write("logs/answers.csv", "participant,demonstration,choice,age\n");
  const fs::path answers = folder.write("answers/p-1.json", "{}");
  for (const auto& [source, out] :
       {std::pair(log, log.parent_path()), std::pair(answers, answers.parent_path()),
        std::pair(answers.parent_path(), folder.path() / "logs/../answers")}) {
    table.sources = {source.string()};
    EXPECT_THROW(write_report(report, table, out, false), InputError) << source;
    EXPECT_FALSE(fs::exists(out / "report.json")) << "no answer file, among answer files";
  }
  EXPECT_EQ(test::read_text(log), "participant,demonstration,choice,age\n");
}

TEST(WriteReport, RefusesAFileAsItsFolder) {
  const TemporaryFolder folder;
  const AnswersTable table = test::clustered_table();
  const Report report = analyse_table(table, {});
  EXPECT_THROW(write_report(report, table, folder.write("out", "x"), false), std::runtime_error);
}

}  // namespace
}  // namespace pinchlab::analysis
