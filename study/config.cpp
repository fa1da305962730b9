// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/config.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/input_error.h"
#include "base/json_object.h"
#include "base/strict_json.h"
#include "base/text_checks.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

constexpr std::size_t largest_file = 1U << 20U;  // bytes
constexpr std::size_t most_trials = 1000;        // of one participant
constexpr const char* key_cure = "; study/README.md has the keys";

void check_demonstration(JsonObject& object, const std::string& key, const std::string& name) {
  const std::string why = why_not_a_name(name);
  if (!why.empty() || name.find('/') != std::string::npos) {
    object.fail(key, fmt::format("`{}` is no name of a demonstration{}{}", name.substr(0, 60),
                                 why.empty() ? "" : ": ", why));
  }
}

std::vector<std::string> read_names(JsonObject& object, const std::string& key) {
  std::vector<std::string> names;
  for (const json& entry : object.array(key, most_trials)) {
    if (!entry.is_string()) {
      object.fail(key, "must hold names of demonstrations, such as \"03-drop\"");
    }
    names.push_back(entry.get<std::string>());
    check_demonstration(object, key, names.back());
    if (std::count(names.begin(), names.end(), names.back()) > 1) {
      object.fail(key, fmt::format("`{}` stands twice; to show it more often, use repetitions",
                                   names.back()));
    }
  }
  return names;
}

// A file in the folder of the clips, not a way out of it.
std::string read_clip_name(JsonObject& object, const std::string& key) {
  std::string name = object.name(key);
  const std::filesystem::path path = name;
  if (path != path.filename() || path.extension() != ".mp4") {
    object.fail(key, fmt::format("`{}` must be the name of an .mp4 file in the clips' folder",
                                 name.substr(0, 60)));
  }
  return name;
}

AttentionCheck read_own_check(const json& document, const std::string& file,
                              const std::string& pointer) {
  JsonObject entry(document, file, pointer);
  entry.expect_only({"name", "left", "right"}, key_cure);
  AttentionCheck check;
  check.name = entry.name("name");
  check.left = read_clip_name(entry, "left");
  check.right = read_clip_name(entry, "right");
  if (check.left == check.right) {
    entry.fail("right", "the same file as left; its right answer must be on the other side");
  }
  return check;
}

std::vector<AttentionCheck> read_checks(JsonObject& object, const std::string& file) {
  std::vector<AttentionCheck> checks;
  std::set<std::string> names;
  const json& entries = object.array("attention_checks", 100);
  for (std::size_t i = 0; i < entries.size(); ++i) {
    if (entries[i].is_string()) {
      const auto demonstration = entries[i].get<std::string>();
      check_demonstration(object, "attention_checks", demonstration);
      checks.push_back({demonstration + "-upside-down", demonstration, "", ""});
    } else {
      checks.push_back(read_own_check(entries[i], file, fmt::format("/attention_checks/{}", i)));
    }
    if (!names.insert(checks.back().name).second) {
      object.fail("attention_checks", fmt::format("`{}` stands twice", checks.back().name));
    }
  }
  return checks;
}

void read_methods(JsonObject& object, Config& config) {
  static const std::set<std::string> taken = {"baseline", "check", "reference", "graded", "tie"};
  for (const json& entry : object.array("methods", 20)) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : "";
    const bool is_name = !name.empty() && why_not_a_name(name).empty() &&
                         name.find_first_of("/.-") == std::string::npos && !taken.contains(name);
    if (!is_name || std::ranges::find(config.methods, name) != config.methods.end()) {
      object.fail("methods",
                  fmt::format("must hold names of methods, none twice, without `/`, `.` and `-`, "
                              "and not {}; see `{}`",
                              fmt::join(taken, ", "), name.substr(0, 60)));
    }
    config.methods.push_back(name);
  }
  if (config.methods.size() < 3) {
    object.fail("methods", "needs three or more; leave it out to compare pinch with the baseline");
  }
  if (config.demonstrations.empty()) {
    object.fail("demonstrations", "must be named in a study of methods");
  }
  if (object.has("repetitions") || object.has("both_orders")) {
    object.fail("methods",
                "cannot be combined with repetitions or both_orders; say with "
                "pairs_per_demonstration how much of the pairs a participant sees");
  }
  const auto pairs = static_cast<long>(config.methods.size() * (config.methods.size() - 1) / 2);
  if (object.has("pairs_per_demonstration")) {
    config.pairs_per_demonstration =
        static_cast<int>(object.whole("pairs_per_demonstration", 1, pairs));
  }
}

void read_one_series(JsonObject series, const std::string& file, const std::string& pointer,
                     Config& config) {
  series.expect_only({"name", "clips"}, key_cure);
  const std::string name = series.name("name");
  check_demonstration(series, "name", name);
  if (std::ranges::find(config.demonstrations, name) != config.demonstrations.end()) {
    series.fail("name", fmt::format("`{}` stands twice", name));
  }
  config.demonstrations.push_back(name);
  const json& clips = series.array("clips", most_trials);
  for (std::size_t i = 0; i < clips.size(); ++i) {
    JsonObject clip(clips[i], file, fmt::format("{}/clips/{}", pointer, i));
    clip.expect_only({"level", "left", "right"}, key_cure);
    GradedStimulus stimulus{{name, clip.number("level", -1e9, 1e9)},
                            read_clip_name(clip, "left"),
                            read_clip_name(clip, "right")};
    if (stimulus.left == stimulus.right) {
      clip.fail("right", "the same file as left; its reference must be on the other side");
    }
    if (std::ranges::find(config.graded, stimulus.clip, &GradedStimulus::clip) !=
        config.graded.end()) {
      clip.fail("level", "stands twice; to show it more often, use repetitions");
    }
    config.graded.push_back(std::move(stimulus));
  }
}

void read_series(JsonObject& object, const std::string& file, Config& config) {
  if (object.has("demonstrations") || object.has("methods")) {
    object.fail("series", "cannot be combined with demonstrations or methods");
  }
  const json& entries = object.array("series", 100);
  std::size_t levels = 0;
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const std::string pointer = fmt::format("/series/{}", i);
    const std::size_t before = config.graded.size();
    read_one_series(JsonObject(entries[i], file, pointer), file, pointer, config);
    const std::size_t own = config.graded.size() - before;
    if (own < 2 || (i > 0 && own != levels)) {
      object.fail("series", "needs two clips or more in each series, and in all as many");
    }
    levels = own;
  }
  if (entries.empty()) object.fail("series", "is empty");
  if (object.has("graded_hit")) {
    config.graded_hit = object.choice("graded_hit", {"reference", "graded"});
  }
  if (object.has("adaptive_trials")) {
    if (object.has("repetitions") || object.has("both_orders")) {
      object.fail("adaptive_trials", "cannot be combined with repetitions or both_orders");
    }
    config.adaptive_trials = static_cast<int>(object.whole("adaptive_trials", 2, most_trials));
  }
}

TextOptions text_options(const Config& config) {
  TextOptions options;
  options.recruiting = config.recruiting.has_value();
  options.questionnaires = !config.questionnaires.empty();
  options.screen = !config.questionnaires.screen.empty();
  options.graded = config.trial.is_graded;
  options.confidence = config.trial.confidence > 0;
  options.click_where = config.trial.click_where;
  options.reason = config.trial.reason > 0;
  options.controller = config.controller;
  options.contact = config.contact;
  options.consent_version = config.consent_version;
  return options;
}

void check_language(JsonObject& object, const char* key, const std::string& language) {
  const auto is_tag = [](char c) {
    return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') || c == '-';
  };
  if (language.size() > 35 || !std::ranges::all_of(language, is_tag)) {
    object.fail(key, "must be a language tag such as en, sv or pt-BR");
  }
}

// The language, or the languages that participants choose from, and their texts.
void read_all_texts(JsonObject& object, const json& document, const std::string& file,
                    Config& config) {
  TextOptions options = text_options(config);
  const json own = document.value("texts", json::object());
  if (!object.has("languages")) {
    if (object.has("language")) {
      config.language = object.name("language");
      check_language(object, "language", config.language);
    }
    config.texts = read_texts(own, file, "/texts", config.language, options);
    return;
  }
  const std::vector<std::string> languages = read_names(object, "languages");
  if (languages.size() < 2) object.fail("languages", "must name two or more; or give `language`");
  if (object.has("language")) object.fail("language", "stands in `languages`, as the first");
  if (!config.questionnaires.before.empty() || !config.questionnaires.after.empty()) {
    object.fail("languages",
                "questions of your own are in one language; leave them out, or run a "
                "study of its own in each language");
  }
  options.languages = true;
  JsonObject by_language(own, file, "/texts");
  by_language.expect_only(languages, "; with `languages`, texts stand under their language");
  for (const std::string& language : languages) {
    check_language(object, "languages", language);
    config.translations[language] = read_texts(own.value(language, json::object()), file,
                                               "/texts/" + language, language, options);
  }
  config.language = languages.front();
  config.texts = config.translations.at(config.language);
  config.translations.erase(config.language);
}

void check_number_of_trials(const Config& config, const std::string& file) {
  PlanOptions options = plan_options(config);
  if (options.demonstrations.empty()) options.demonstrations.emplace_back();
  const std::size_t trials =
      options.demonstrations.size() * static_cast<std::size_t>(answers_per_demonstration(options));
  if (trials > most_trials) {
    throw InputError(file, fmt::format("{} trials a participant; at most {} can be asked for",
                                       trials, most_trials));
  }
}

const std::vector<std::string> known_keys = {"format",
                                             "language",
                                             "languages",
                                             "controller",
                                             "contact",
                                             "consent_version",
                                             "demonstrations",
                                             "training",
                                             "attention_checks",
                                             "repetitions",
                                             "both_orders",
                                             "participant_limit",
                                             "one_time_links",
                                             "texts",
                                             "methods",
                                             "pairs_per_demonstration",
                                             "series",
                                             "graded_hit",
                                             "adaptive_trials",
                                             "shared_computer",
                                             "recruiting",
                                             "measure_screen",
                                             "questionnaire_before",
                                             "questionnaire_after",
                                             "confidence",
                                             "preference",
                                             "reason",
                                             "click_where"};

// What the information names.
void read_responsible(JsonObject& object, Config& config) {
  for (const auto& [key, text] : {std::pair{"controller", &config.controller},
                                  {"contact", &config.contact},
                                  {"consent_version", &config.consent_version}}) {
    if (!object.has(key)) continue;
    *text = object.text(key, 1000);
    if (text->find_first_not_of(" \n") == std::string::npos) object.fail(key, "is empty");
  }
}

}  // namespace

Config default_config() {
  Config config;
  config.texts = read_texts(json::object(), "", "/texts", config.language, {});
  return config;
}

Config parse_config(const json& document, const std::string& file) {
  JsonObject object(document, file, "");
  object.expect_only(known_keys, key_cure);
  object.choice("format", {"pinchlab-study 1"});
  Config config;
  read_responsible(object, config);
  if (object.has("demonstrations")) {
    config.demonstrations = read_names(object, "demonstrations");
    if (config.demonstrations.empty()) {
      object.fail("demonstrations", "is empty; leave it out to show all");
    }
  }
  if (object.has("methods")) read_methods(object, config);
  if (object.has("pairs_per_demonstration") && config.methods.empty()) {
    object.fail("pairs_per_demonstration", "needs methods");
  }
  if (object.has("series")) read_series(object, file, config);
  for (const char* key : {"graded_hit", "adaptive_trials"}) {
    if (object.has(key) && config.graded.empty()) object.fail(key, "needs series");
  }
  if (object.has("shared_computer")) config.shared_computer = object.flag("shared_computer");
  if (object.has("training")) config.training = read_names(object, "training");
  if (object.has("attention_checks")) config.attention_checks = read_checks(object, file);
  if (object.has("repetitions")) {
    config.repetitions = static_cast<int>(object.whole("repetitions", 1, 50));
  }
  if (object.has("both_orders")) config.both_orders = object.flag("both_orders");
  if (object.has("participant_limit")) {
    config.participant_limit = static_cast<int>(object.whole("participant_limit", 1, 100000));
  }
  if (object.has("one_time_links")) config.one_time_links = object.flag("one_time_links");
  if (object.has("recruiting")) {
    config.recruiting = read_recruiting(object.object("recruiting"));
    if (config.one_time_links || config.shared_computer) {
      object.fail("recruiting",
                  "cannot be combined with one_time_links or shared_computer: the site's ids let "
                  "each participant start once");
    }
  }
  config.trial = read_trial_options(object);
  config.questionnaires = read_questionnaires(object, file);
  read_all_texts(object, document, file, config);
  check_number_of_trials(config, file);
  return config;
}

Config read_config(const std::filesystem::path& path) {
  return parse_config(read_json_file(path, largest_file), path.string());
}

std::string comparison_file(const std::string& demonstration, const std::string& first,
                            const std::string& second, const std::string& ending) {
  return fmt::format("{}.{}-{}.{}", demonstration, first, second, ending);
}

PlanOptions plan_options(const Config& config) {
  PlanOptions options;
  options.demonstrations = config.demonstrations;
  options.training = config.training;
  for (const AttentionCheck& check : config.attention_checks) {
    options.attention_checks.push_back(check.name);
  }
  options.methods = config.methods;
  options.pairs_per_demonstration = config.pairs_per_demonstration;
  for (const GradedStimulus& stimulus : config.graded) options.graded.push_back(stimulus.clip);
  options.adaptive_trials = config.adaptive_trials;
  options.repetitions = config.repetitions;
  options.both_orders = config.both_orders;
  return options;
}

}  // namespace pinchlab::study
