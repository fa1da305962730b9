// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/config.h"
#include "study/shown.h"

#include "study/page_assets.h"
#include "tests/study/config_error.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

json with(const json& more) {
  json document = {{"format", "pinchlab-study 1"}};
  document.update(more);
  return document;
}

TEST(Config, EverythingIsOptional) {
  const Config config = parse_config(with(json::object()), "study.json");
  EXPECT_EQ(config.repetitions, 1);
  EXPECT_FALSE(config.both_orders);
  EXPECT_EQ(config.texts, default_config().texts);
}

TEST(Config, SwedishIsComplete) {
  const auto english = delivered_texts("en");
  const auto swedish = delivered_texts("sv");
  ASSERT_GT(english.size(), 50U);
  for (const auto& [key, text] : english) {
    ASSERT_TRUE(swedish.contains(key)) << key;
    EXPECT_NE(swedish.at(key), "") << key;
    for (const char* slot : {"{count}", "{percent}", "{width}", "{height}"}) {
      EXPECT_EQ(text.find(slot) == std::string::npos,
                swedish.at(key).find(slot) == std::string::npos)
          << key;
    }
  }
  EXPECT_EQ(english.size(), swedish.size());
}

TEST(Config, TheInformationNamesWhoIsResponsible) {
  const json named = {{"controller", "University of X"},
                      {"contact", "A. B., ab@x.org"},
                      {"consent_version", "2 (2026-11-01)"}};
  const Config config = parse_config(with(named), "study.json");
  const std::string& rights = config.texts.at("information_rights");
  for (const char* name : {"University of X", "A. B., ab@x.org", "2 (2026-11-01)"}) {
    EXPECT_NE(rights.find(name), std::string::npos) << name;
  }
  EXPECT_EQ(rights.find("{name}"), std::string::npos);
  const json shown = what_is_shown(config, {});
  EXPECT_EQ(shown["consent_version"], "2 (2026-11-01)");
  json other = named;
  other["contact"] = "C. D.";
  const json changed = what_is_shown(parse_config(with(other), "study.json"), {});
  EXPECT_EQ(difference(shown, changed), "the consent text");
  other = named;
  other["consent_version"] = "3";
  const json newer = what_is_shown(parse_config(with(other), "study.json"), {});
  EXPECT_EQ(difference(shown, newer), "the consent's version, the consent text");
  EXPECT_FALSE(what_is_shown(default_config(), {}).contains("consent_version"));
  for (const auto& [key, text] : default_config().texts) {
    EXPECT_FALSE(key.starts_with("responsible_") || key.starts_with("language_")) << key;
  }
}

TEST(Config, ParticipantsCanChooseTheLanguage) {
  const Config config = parse_config(
      with({{"languages", {"sv", "en"}}, {"texts", {{"en", {{"question", "Which is best?"}}}}}}),
      "study.json");
  EXPECT_EQ(config.language, "sv");
  EXPECT_EQ(config.texts.at("question"), delivered_texts("sv").at("question"));
  ASSERT_EQ(config.translations.size(), 1U);
  EXPECT_EQ(config.translations.at("en").at("question"), "Which is best?");
  EXPECT_EQ(config.translations.at("en").at("language_name"), "English");
  const json shown = what_is_shown(config, {});
  EXPECT_EQ(shown["language"], "sv, en");
  EXPECT_EQ(shown["question"], config.texts.at("question") + " / Which is best?");
  // A text of either language is one of the study's.
  const Config other = parse_config(
      with({{"languages", {"sv", "en"}},
            {"texts", {{"en", {{"question", "Which is best?"}, {"consent", "I agree."}}}}}}),
      "study.json");
  EXPECT_EQ(difference(shown, what_is_shown(other, {})), "the consent text");
}

TEST(Config, TextsNameNoMethod) {
  for (const char* language : {"en", "sv"}) {
    for (const auto& [key, text] : delivered_texts(language)) {
      for (const char* word : {"pinch", "Pinch", "baseline", "joint", "friction", "friktion"}) {
        EXPECT_EQ(text.find(word), std::string::npos) << language << " " << key;
      }
    }
  }
}

TEST(Config, QuestionCanBeReworded) {
  const Config config =
      parse_config(with({{"language", "sv"}, {"texts", {{"question", "Vilken?"}}}}), "study.json");
  EXPECT_EQ(config.texts.at("question"), "Vilken?");
  EXPECT_EQ(config.texts.at("left"), "Vänster");
}

TEST(Config, ErrorsNamePlaceAndCure) {
  const std::vector<std::pair<json, const char*>> bad = {
      {json::array(), "must be an object"},
      {json::object(), "`format` is missing"},
      {{{"format", "pinchlab-study 2"}}, "/format"},
      {with({{"languge", "sv"}}), "did you mean `language`?"},
      {with({{"language", "Swedish!"}}), "language tag"},
      {with({{"language", "de"}}), "all must be given"},
      {with({{"texts", {{"qestion", "?"}}}}), "did you mean `question`?"},
      {with({{"texts", {{"question", " "}}}}), "is empty"},
      {with({{"texts", {{"question", 3}}}}), "must be a string"},
      {with({{"texts", {{"question", std::string(20000, 'x')}}}}), "longer than"},
      {with({{"demonstrations", json::array()}}), "is empty"},
      {with({{"demonstrations", {"a", "a"}}}), "stands twice"},
      {with({{"demonstrations", {1}}}), "must hold names"},
      {with({{"demonstrations", {"../a"}}}), "no name"},
      {with({{"demonstrations", "a"}}), "must be an array"},
      {with({{"repetitions", 0}}), "from 1 to 50"},
      {with({{"repetitions", 1.5}}), "whole number"},
      {with({{"both_orders", 1}}), "true or false"},
      {with({{"participant_limit", -1}}), "from 1 to"},
      {with({{"attention_checks", {"a/b"}}}), "no name of a demonstration"},
      {with({{"contact", " "}}), "/contact: is empty"},
      {with({{"controller", 7}}), "/controller"},
      {with({{"languages", {"en"}}}), "/languages: must name two or more"},
      {with({{"languages", {"en", "en"}}}), "/languages"},
      {with({{"languages", {"en", "s v"}}}), "/languages"},
      {with({{"languages", {"en", "sv"}}, {"language", "en"}}), "/language: stands in"},
      {with({{"languages", {"en", "sv"}}, {"texts", {{"question", "Which?"}}}}),
       "texts stand under their language"},
      {with({{"languages", {"en", "sv"}}, {"texts", {{"sv", {{"qestion", "?"}}}}}}), "/texts/sv"},
      {with({{"languages", {"en", "de"}}}), "no texts are delivered in the language `de`"},
      {with({{"languages", {"en", "sv"}},
             {"questionnaire_before", {{{"name", "a"}, {"kind", "text"}, {"text", "?"}}}}}),
       "questions of your own are in one language"},
      {with({{"attention_checks", {"03-drop", "03-drop"}}}), "`03-drop-upside-down` stands twice"},
      {with({{"attention_checks", {7}}}), "must be an object"},
      {with({{"attention_checks", {{{"name", "c"}, {"left", "../a.mp4"}, {"right", "b.mp4"}}}}}),
       "in the clips' folder"},
      {with({{"attention_checks", {{{"name", "c"}, {"left", "a.mp4"}, {"right", "a.mp4"}}}}}),
       "the same file"},
      {with({{"attention_checks", {{{"name", "c"}, {"left", "a.mp4"}, {"rigt", "b.mp4"}}}}}),
       "did you mean `right`?"},
  };
  for (const auto& [document, message] : bad) {
    const std::string error = config_error(document);
    EXPECT_NE(error.find(message), std::string::npos) << document << "\n" << error;
    EXPECT_EQ(error.rfind("study.json", 0), 0U) << error;
  }
}

TEST(Config, TooManyTrialsAreRefused) {
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) {
    names.push_back("demo-" + std::to_string(i));
  }
  EXPECT_NE(
      config_error(with({{"demonstrations", names}, {"repetitions", 11}})).find("1100 trials"),
      std::string::npos);
}

}  // namespace
}  // namespace pinchlab::study
