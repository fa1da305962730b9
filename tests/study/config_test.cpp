// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/config.h"

#include "base/input_error.h"
#include "study/page_assets.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

std::string error_of(const json& document) {
  try {
    parse_config(document, "study.json");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

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
    const std::string error = error_of(document);
    EXPECT_NE(error.find(message), std::string::npos) << document << "\n" << error;
    EXPECT_EQ(error.rfind("study.json", 0), 0U) << error;
  }
}

TEST(Config, TooManyTrialsAreRefused) {
  std::vector<std::string> names;
  for (int i = 0; i < 100; ++i) {
    names.push_back("demo-" + std::to_string(i));
  }
  EXPECT_NE(error_of(with({{"demonstrations", names}, {"repetitions", 11}})).find("1100 trials"),
            std::string::npos);
}

}  // namespace
}  // namespace pinchlab::study
