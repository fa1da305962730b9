// SPDX-License-Identifier: GPL-3.0-or-later
// The researcher's own questions: what can be asked, what can be answered, where it goes.
#include "study/questionnaire.h"

#include "analysis/pages.h"
#include "analysis/report.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "study/answers.h"
#include "study/results.h"
#include "study/shown.h"
#include "study/simulate.h"
#include "study/tables.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const json age = {{"name", "age"},   {"kind", "number"}, {"text", "How old are you?"},
                  {"min", 18},       {"max", 120},       {"whole", true},
                  {"required", true}};
const json sight = {{"name", "sight"},
                    {"kind", "choice"},
                    {"text", "Do you see well?"},
                    {"choices", {"yes", "with glasses", "no"}},
                    {"required", true}};
const json ease = {{"name", "ease"}, {"kind", "scale"}, {"text", "How easy was it?"},
                   {"points", 5},    {"low", "hard"},   {"high", "easy"}};
const json words = {{"name", "words"}, {"kind", "text"}, {"text", "What else?"}, {"longest", 10}};

Config asking(const json& before, const json& after) {
  json document = {{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}};
  if (!before.is_null()) document["questionnaire_before"] = before;
  if (!after.is_null()) document["questionnaire_after"] = after;
  return parse_config(document, "study.json");
}

DeskOptions asking_desk(const fs::path& folder) {
  DeskOptions options = desk_options(folder);
  options.config = asking({age, sight}, {ease, words});
  return options;
}

json before(int years = 44) {
  return {{"part", "before"}, {"answers", {{"age", years}, {"sight", "no"}}}};
}

json after(const json& answers = {{"ease", 5}}) {
  return {{"part", "after"}, {"answers", answers}};
}

void answer_trials(Desk& desk, const std::string& token) {
  for (std::size_t i = 0; i < demonstrations.size(); ++i) {
    desk.show(token, i);
    desk.answer(token, parse_answer(answer_body(i)));
  }
}

json without(json question, const char* key) {
  question.erase(key);
  return question;
}

json with(json question, const json& more) {
  question.update(more);
  return question;
}

TEST(Questionnaire, ErrorsNamePlaceAndCure) {
  const std::vector<std::pair<json, const char*>> bad = {
      {json::object(), "/questionnaire_before: must be an array"},
      {json::array(), "is empty; leave it out"},
      {json::array({7}), "/questionnaire_before/0: must be an object"},
      {json::array({without(age, "name")}), "`name` is missing"},
      {json::array({without(age, "text")}), "`text` is missing"},
      {json::array({without(age, "max")}), "`max` is missing"},
      {json::array({without(sight, "choices")}), "`choices` is missing"},
      {json::array({without(ease, "low")}), "`low` is missing"},
      {{age, age}, "/questionnaire_before/1/name: `age` stands twice"},
      {json::array({with(age, {{"name", "Age"}})}), "must be 1 to 40 of a-z"},
      {json::array({with(age, {{"name", ""}})}), "must be 1 to 40 of a-z"},
      {json::array({with(age, {{"name", "1a"}})}), "first a letter"},
      {json::array({with(age, {{"text", " \n"}})}), "/text: is empty"},
      {json::array({with(age, {{"kind", "slider"}})}), "/kind"},
      {json::array({with(age, {{"min", 120}})}), "must be more than min"},
      {json::array({with(age, {{"min", 18.2}, {"max", 18.4}})}), "leaves no whole number"},
      {json::array({with(age, {{"max", 1e300}})}), "/max: must be a number"},
      {json::array({with(age, {{"required", "yes"}})}), "true or false"},
      {json::array({with(age, {{"points", 5}})}), "unknown key"},
      {json::array({with(sight, {{"choices", {"one"}}})}), "two or more"},
      {json::array({with(sight, {{"choices", {"a", "a"}}})}), "none twice"},
      {json::array({with(sight, {{"choices", {"a", 2}}})}), "must hold texts"},
      {json::array({with(sight, {{"choices", {"a", std::string(501, 'x')}}})}), "1 to 500 bytes"},
      {json::array({with(ease, {{"points", 1}})}), "from 2 to 11"},
      {json::array({with(ease, {{"high", ""}})}), "/high: is empty"},
      {json::array({with(words, {{"longest", 0}})}), "from 1 to 5000"},
      {json::array({with(words, {{"text", std::string(2001, 'x')}})}), "longer than 2000"},
  };
  for (const auto& [questions, message] : bad) {
    try {
      asking(questions, nullptr);
      ADD_FAILURE() << questions << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
  EXPECT_THROW(asking(json::array({age}), json::array({age})), InputError)
      << "a name stands in both";
  json many = json::array();
  for (int i = 0; i < 9; ++i) {
    many.push_back(with(words, {{"name", "w" + std::to_string(i)}, {"longest", 5000}}));
  }
  EXPECT_THROW(asking(many, nullptr), InputError) << "more than a request can hold";
}

TEST(Questionnaire, AnswersAreChecked) {
  const Questionnaires asked = asking({age, sight}, {ease, words}).questionnaires;
  const auto status = [&](const json& answers, const char* part) {
    Session session;
    return refused([&] {
      answer_questionnaire(session, asked, {{"part", part}, {"answers", answers}});
    });
  };
  const json good = before()["answers"];
  EXPECT_EQ(status(good, "before"), 0);
  EXPECT_EQ(status({{"ease", 1}, {"words", "åäöåäöåäöå"}}, "after"), 0);
  EXPECT_EQ(status(json::object(), "after"), 0) << "all of it is optional";
  for (const json& bad :
       {json::array(), without(good, "age"), without(good, "sight"), with(good, {{"age", 17}}),
        with(good, {{"age", 121}}), with(good, {{"age", 44.5}}), with(good, {{"age", "44"}}),
        with(good, {{"age", nullptr}}), with(good, {{"sight", "maybe"}}),
        with(good, {{"sight", 1}}), with(good, {{"name", "x"}})}) {
    EXPECT_EQ(status(bad, "before"), 422) << bad;
  }
  for (const json& bad :
       {json{{"ease", 0}}, json{{"ease", 6}}, json{{"ease", 1.5}}, json{{"words", " "}},
        json{{"words", std::string(41, 'x')}}, json{{"words", 7}}}) {
    EXPECT_EQ(status(bad, "after"), 422) << bad;
  }
  EXPECT_EQ(status(good, "between"), 422);
  Session session;
  EXPECT_EQ(refused([&] { answer_questionnaire(session, {}, before()); }), 422)
      << "a study without questions";
}

TEST(Questionnaire, EachHasItsTurn) {
  const fs::path folder = scratch_folder();
  std::string token;
  {
    Desk desk(asking_desk(folder));
    token = desk.start("", "");
    EXPECT_EQ(desk.progress(token).questionnaires, (std::vector<std::string>{"before", "after"}));
    EXPECT_EQ(refused([&] { desk.show(token, 0); }), 409) << "questions come first";
    EXPECT_EQ(refused([&] { desk.questionnaire(token, after()); }), 409) << "not yet";
    desk.questionnaire(token, before());
    desk.questionnaire(token, before());  // sent again
    EXPECT_EQ(refused([&] { desk.questionnaire(token, before(45)); }), 409) << "nobody changes it";
  }
  Desk desk(asking_desk(folder));
  EXPECT_EQ(desk.progress(token).questionnaires, std::vector<std::string>{"after"});
  answer_trials(desk, token);
  EXPECT_EQ(refused([&] { desk.save(token, {}); }), 409) << "questions are left";
  desk.questionnaire(token, after({{"ease", 5}, {"words", "=SUM(A1)"}}));
  desk.save(token, {});
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["questionnaires"]["before"]["age"],
            (json{{"question", "How old are you?"}, {"answer", 44}}));
  EXPECT_EQ(file["questionnaires"]["after"]["ease"],
            (json{{"question", "How easy was it? (1: hard; 5: easy)"}, {"answer", 5}}));
  parse_answer_file(file, "file");
  const std::string csv = answers_csv(folder / "answers");
  EXPECT_NE(csv.find(",after_ease,after_words,before_age,before_sight\n"), std::string::npos);
  EXPECT_NE(csv.find(",5,'=SUM(A1),44,no\n"), std::string::npos) << csv;
  EXPECT_NE(participants_csv(folder / "answers").find(",5,'=SUM(A1),44,no\n"), std::string::npos);
  const auto psych_ds = psych_ds_files(folder / "answers");
  EXPECT_NE(psych_ds.at("dataset_description.json").find("\"before_age\""), std::string::npos);
  const auto bids = bids_files(folder / "answers");
  EXPECT_NE(bids.at("participants.tsv").find("\t44\tno\n"), std::string::npos);
  EXPECT_EQ(json::parse(bids.at("participants.json"))["before_age"]["Description"],
            "How old are you?");
}

TEST(Questionnaire, OtherQuestionsAreAnotherStudy) {
  const fs::path folder = scratch_folder();
  DeskOptions options = asking_desk(folder);
  const json shown = what_is_shown(options.config, options.clips);
  json other = what_is_shown(asking({age, sight}, json::array({words})), options.clips);
  EXPECT_NE(shown, other);
  EXPECT_EQ(difference(shown, other), "what is asked besides");
  EXPECT_FALSE(what_is_shown(small_config(), options.clips).contains("options_sha256"))
      << "a study without is as it was";
  { Desk desk(std::move(options)); }
  options = asking_desk(folder);
  options.config = asking(json::array({age}), {ease, words});
  EXPECT_THROW(Desk desk(std::move(options)), std::runtime_error);
}

// The page that measures the screen answers a questionnaire of its own.
TEST(Screen, IsMeasuredFirstAndReported) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  options.config = parse_config({{"format", "pinchlab-study 1"},
                                 {"demonstrations", demonstrations},
                                 {"measure_screen", true},
                                 {"questionnaire_before", json::array({age})}},
                                "study.json");
  const auto& texts = options.config.texts;
  EXPECT_TRUE(texts.at("information_rights").ends_with(texts.at("screen_rights")));
  Desk desk(std::move(options));
  for (const auto& [hz, good] : {std::pair{59.94, true}, {75.0, false}}) {
    const std::string token = desk.start("", "");
    EXPECT_EQ(desk.progress(token).questionnaires, (std::vector<std::string>{"screen", "before"}));
    const auto status = [&](const json& answers) {
      return refused([&] {
        desk.questionnaire(token, {{"part", "screen"}, {"answers", answers}});
      });
    };
    EXPECT_EQ(status({{"px_per_mm", 3.8}}), 422) << "the distance is missing";
    EXPECT_EQ(status({{"viewing_distance_mm", 100}}), 422);
    EXPECT_EQ(status({{"viewing_distance_mm", 600}, {"px_per_mm", 0.5}}), 422);
    EXPECT_EQ(status({{"viewing_distance_mm", 600}, {"refresh_rate_hz", 0}}), 422);
    EXPECT_EQ(status({{"viewing_distance_mm", 600}, {"refresh_rate_hz", hz}}), 0);
    EXPECT_EQ(refused([&] { desk.show(token, 0); }), 409) << "the other questions come first too";
    desk.questionnaire(token, {{"part", "before"}, {"answers", {{"age", 44}}}});
    answer_trials(desk, token);
    desk.save(token, {});
    const json read = Results(folder / "answers").read(false);
    EXPECT_EQ(read["warnings"].dump().find("refresh_rate") == std::string::npos, good) << read;
  }
  EXPECT_NE(participants_csv(folder / "answers")
                .find("screen_refresh_rate_hz,screen_viewing_distance_mm\n"),
            std::string::npos);
  const analysis::AnswersTable table = analysis::read_answers({folder / "answers"}, {});
  const analysis::Report report = analysis::analyse_table(table, {.bootstrap = 99});
  EXPECT_EQ(report.circumstances.screens_measured, 2);
  ASSERT_EQ(report.circumstances.uneven_screens.size(), 1U);
  EXPECT_TRUE(report.circumstances.uneven_screens[0].ends_with(" (75 Hz)"));
  EXPECT_NE(markdown_page(make_document(report, table), {}).find("1 of 2 measured screens"),
            std::string::npos);
  EXPECT_EQ(json::parse(report_json(report, table))["playback"]["screens_measured"], 2);
}

TEST(Screen, RatesThatShow60FramesEvenly) {
  for (const double hz : {59.0, 59.94, 60.0, 61.0, 119.9, 120.0, 180.0, 240.0}) {
    EXPECT_TRUE(shows_60_evenly(hz)) << hz;
  }
  for (const double hz :
       {0.0, 1.0, 24.0, 30.0, 48.0, 50.0, 57.0, 75.0, 90.0, 100.0, 144.0, 165.0}) {
    EXPECT_FALSE(shows_60_evenly(hz)) << hz;
  }
}

TEST(Questionnaire, SimulatedParticipantsAnswer) {
  const fs::path folder = scratch_folder();
  write_text(folder / "truth.json", R"({"format": "pinchlab-truth 1"})");
  Desk desk(asking_desk(folder));
  simulate(desk, read_truth(folder / "truth.json"),
           {.participants = 5, .seed = 3, .begin = {}, .progress = {}});
  for (const fs::path& path : answer_files(folder / "answers")) {
    const json file = json::parse(read_whole(path));
    EXPECT_EQ(file["questionnaires"]["before"].size(), 2U);
    EXPECT_EQ(file["questionnaires"]["after"]["words"]["answer"], "simulated");
  }
}

}  // namespace
}  // namespace pinchlab::study
