// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/answer_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/counted.h"
#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/json_object.h"
#include "base/strict_json.h"
#include "base/text_checks.h"
#include "base/told_trial.h"

namespace pinchlab {

namespace fs = std::filesystem;

namespace {

constexpr size_t largest_answer_file = size_t{16} << 20;  // bytes
constexpr long billion = 1000000000;
constexpr const char* format_cure = "; see analysis/README.md for the format";

Side side_of(const std::string& word) {
  return word == "left" ? Side::left : Side::right;
}

long optional_count(JsonObject& object, const std::string& key) {
  return object.has(key) ? object.whole(key, 0, billion) : 0;
}

// What the page records beside the answer. The analysis has no use for most of it, yet a wrong
// type is a sign of a broken log.
void read_circumstances(JsonObject& object, Trial& trial) {
  trial.focus_lost_count = optional_count(object, "focus_lost_count");
  trial.dropped_frames = optional_count(object, "dropped_frames");
  if (object.has("playback_errors")) {
    const auto& errors = object.array("playback_errors", 1000);
    for (const auto& error : errors) {
      if (!error.is_string()) object.fail("playback_errors", "must hold strings");
    }
    trial.playback_errors = static_cast<long>(errors.size());
  }
  optional_count(object, "loops_watched");
  trial.frame_count = optional_count(object, "frame_count");
  if (object.has("frame_count")) check_frames(object, trial.frame_count, trial.dropped_frames);
  for (const char* key : {"loop_gap_median_s", "loop_gap_max_s"}) {
    if (object.has(key)) object.number(key, -1.0, 86400.0);
  }
  if (object.has("clip")) object.text("clip", 1024);
  if (object.has("shown_utc")) object.utc("shown_utc");
  if (object.has("input")) object.choice("input", {"mouse", "keyboard", "touch"});
  const auto size = [&](const char* key) {
    return object.has(key) ? static_cast<int>(object.whole(key, 0, 100000)) : 0;
  };
  for (const char* key : {"window_width_px", "window_height_px", "clip_height_px"}) size(key);
  trial.clip_width_px = size("clip_width_px");
  trial.screen_width_px = size("screen_width_px");
  trial.screen_height_px = size("screen_height_px");
  if (object.has("device_pixel_ratio")) object.number("device_pixel_ratio", 0.01, 100.0);
}

// What a study can ask in each trial besides.
void read_besides(JsonObject& object, Trial& trial) {
  if (object.has("confidence")) {
    trial.confidence = static_cast<int>(object.whole("confidence", 1, 9));
  }
  if (object.has("reason")) object.text("reason", 8000);
  if (!object.has("where_side")) return;  // then the rest of a place is unknown too
  trial.where = {side_of(object.choice("where_side", {"left", "right"})),
                 object.number("where_x", 0, 1), object.number("where_y", 0, 1),
                 object.number("where_time_s", 0, 86400)};
}

// What the sides can show.
std::vector<std::string> sides_of(const AnswerFile& file) {
  if (!file.graded_hit.empty()) return {"reference", "graded"};
  return file.methods.empty() ? std::vector<std::string>{"pinch", "baseline"} : file.methods;
}

Trial read_trial(JsonObject object, const AnswerFile& file) {
  Trial trial;
  trial.position = static_cast<int>(object.whole("position", 1, 65535));
  const std::string kind = object.choice("kind", {"main", "training", "attention"});
  trial.kind = kind == "main"       ? TrialKind::main
               : kind == "training" ? TrialKind::training
                                    : TrialKind::attention;
  trial.demonstration = object.name("demonstration");

  std::vector<std::string> methods = sides_of(file);
  if (trial.kind == TrialKind::attention) methods.emplace_back("check");
  trial.left = object.choice("left", methods);
  trial.right = object.choice("right", methods);
  if (trial.kind != TrialKind::attention && trial.left == trial.right) {
    object.fail("right",
                fmt::format("`{}` on both sides; a pair shows each method once", trial.right));
  }
  const ToldChoice told = read_choice(object);
  trial.choice = told.word == "tie" ? Side::unknown : side_of(told.word);
  trial.preference = told.preference;
  if (trial.preference && !file.graded_hit.empty()) {
    object.fail("preference", "has no place in a study of levels");
  }
  read_besides(object, trial);
  if (trial.kind == TrialKind::attention) {
    trial.expected = side_of(object.choice("expected", {"left", "right"}));
  }
  if (!file.graded_hit.empty() && trial.kind != TrialKind::attention) {
    trial.level = object.number("level", -1e9, 1e9);
  }
  trial.reaction_time_s = object.number("reaction_time_s", 0.0, 86400.0);
  read_circumstances(object, trial);
  object.finish(format_cure);
  return trial;
}

void read_methods(JsonObject& plan, AnswerFile& file) {
  for (const auto& entry : plan.array("methods", 100)) {
    const bool good =
        entry.is_string() && why_not_a_name(entry.get_ref<const std::string&>()).empty();
    if (!good) plan.fail("methods", "must hold names of methods");
    file.methods.push_back(entry.get<std::string>());
  }
  const std::set<std::string> different(file.methods.begin(), file.methods.end());
  if (different.size() < 2 || different.size() != file.methods.size())
    plan.fail("methods", "must hold two methods or more, none twice");
}

void read_plan(JsonObject plan, AnswerFile& file) {
  std::set<std::string> seen;
  for (const auto& entry : plan.array("demonstrations", 10000)) {
    const bool good =
        entry.is_string() && why_not_a_name(entry.get_ref<const std::string&>()).empty();
    if (!good) plan.fail("demonstrations", "must hold names of demonstrations");
    file.planned.push_back(entry.get<std::string>());
    if (!seen.insert(file.planned.back()).second) {
      plan.fail("demonstrations",
                fmt::format("`{}` is planned twice; say how often each is answered with "
                            "answers_per_demonstration",
                            file.planned.back()));
    }
  }
  if (file.planned.empty()) plan.fail("demonstrations", "is empty");
  if (plan.has("methods")) read_methods(plan, file);
  if (plan.has("graded_hit")) {
    file.graded_hit = plan.choice("graded_hit", {"reference", "graded"});
    if (!file.methods.empty()) plan.fail("graded_hit", "a plan has either levels or methods");
  }
  if (plan.has("adaptive")) plan.choice("adaptive", {"psi"});
  const long most = file.methods.empty() && file.graded_hit.empty() ? 100 : 10000;
  file.answers_per_demonstration =
      static_cast<int>(plan.whole("answers_per_demonstration", 1, most));
  if (plan.has("both_orders")) plan.flag("both_orders");
  optional_count(plan, "training_trials");
  optional_count(plan, "attention_checks");
  plan.finish(format_cure);
}

void read_study(JsonObject study, AnswerFile& file) {
  file.study["language"] = study.text("language", 64);
  file.study["question"] = study.text("question", 10000);
  for (const char* key : {"consent_sha256", "texts_sha256", "clips_sha256"}) {
    file.study[key] = study.sha256(key);
  }
  if (study.has("consent_version")) {
    file.study["consent_version"] = study.text("consent_version", 1000);
  }
  if (study.has("options_sha256")) file.study["options_sha256"] = study.sha256("options_sha256");
  study.finish();
}

// Ids of a site that sent the participant.
void check_recruited(JsonObject recruited) {
  recruited.name("participant");
  for (const char* key : {"study", "session"}) {
    if (recruited.has(key)) recruited.name(key);
  }
  recruited.finish(format_cure);
}

// Answers to the researcher's own questions, by part and name.
void read_questionnaires(JsonObject questionnaires, AnswerFile& file) {
  for (const std::string part : {"screen", "before", "after"}) {
    if (!questionnaires.has(part)) continue;
    JsonObject answers = questionnaires.object(part);
    for (const std::string& name : answers.all_keys()) {
      const std::string why = why_not_a_name(name);
      if (!why.empty()) answers.fail(name, fmt::format("bad key: {}", why));
      JsonObject entry = answers.object(name);
      entry.text("question", 10000);
      if (entry.need("answer").is_string()) {
        entry.text("answer", 100000);
      } else {
        const double number = entry.number("answer", -1e9, 1e9);
        if (part == "screen" && name == "refresh_rate_hz") file.refresh_rate_hz = number;
      }
      entry.finish(format_cure);
    }
  }
  questionnaires.finish(format_cure);
}

void read_trials(const nlohmann::json& trials, const std::string& file_name, AnswerFile& file) {
  std::map<int, size_t> positions;
  for (size_t i = 0; i < trials.size(); ++i) {
    const std::string pointer = fmt::format("/trials/{}", i);
    const std::string trial_place = fmt::format("{}: {}", file_name, pointer);
    file.trials.push_back(read_trial(JsonObject(trials[i], file_name, pointer), file));
    const Trial& trial = file.trials.back();
    const auto [before, is_new] = positions.emplace(trial.position, i);
    if (!is_new) {
      throw InputError(trial_place + "/position",
                       fmt::format("trial {} has position {} too", before->second, trial.position));
    }
    const bool planned = std::find(file.planned.begin(), file.planned.end(), trial.demonstration) !=
                         file.planned.end();
    if (trial.kind == TrialKind::main && !planned) {
      throw InputError(trial_place + "/demonstration",
                       fmt::format("`{}` is not in the plan{}", trial.demonstration,
                                   did_you_mean(trial.demonstration, file.planned)));
    }
  }
}

void read_texts(JsonObject& document, AnswerFile& file) {
  if (document.has("free_text")) {
    JsonObject texts = document.object("free_text");
    for (const std::string& key : texts.all_keys()) {
      const std::string why = why_not_a_name(key);
      if (!why.empty()) texts.fail(key, fmt::format("bad key: {}", why));
      file.free_text[key] = texts.text(key, 100000);
    }
  }
  if (document.has("clips_sha256")) {
    JsonObject clips = document.object("clips_sha256");
    for (const std::string& demonstration : clips.all_keys()) {
      JsonObject variants = clips.object(demonstration);
      for (const std::string& variant : variants.all_keys()) {
        file.clips_sha256[{demonstration, variant}] = variants.sha256(variant);
      }
    }
  }
}

}  // namespace

bool shows_60_evenly(double hz) {
  const double times = std::round(hz / 60);
  return times >= 1 && std::abs(hz - 60 * times) <= 0.02 * hz;
}

AnswerFile parse_answer_file(const nlohmann::json& document, const std::string& file_name) {
  JsonObject object(document, file_name, "");
  object.choice("format", {"pinchlab-answers"});
  if (object.whole("version", 0, billion) != 1) {
    object.fail("version", "this program reads version 1; use the program that wrote the file");
  }
  AnswerFile file;
  file.participant = object.name("participant");
  if (object.has("participant_number")) object.whole("participant_number", 0, billion);
  if (object.has("pilot")) file.is_pilot = object.flag("pilot");
  if (object.has("seed")) object.whole("seed", 0, (long{1} << 53) - 1);
  read_plan(object.object("plan"), file);
  const std::string started = object.utc("started_utc");
  if (object.utc("saved_utc").substr(0, 19) < started.substr(0, 19)) {
    object.fail("saved_utc", fmt::format("is before started_utc ({})", started));
  }
  object.text("software_version", 256);
  if (object.has("study")) read_study(object.object("study"), file);
  if (object.has("recruited")) check_recruited(object.object("recruited"));
  if (object.has("questionnaires")) read_questionnaires(object.object("questionnaires"), file);
  if (object.has("language")) object.text("language", 64);
  if (object.has("user_agent")) object.text("user_agent", 4096);
  if (object.has("withdrawal_code_sha256")) object.sha256("withdrawal_code_sha256");
  optional_count(object, "resumed_count");
  read_texts(object, file);
  read_trials(object.array("trials", 65535), file_name, file);
  const bool answered = std::any_of(file.trials.begin(), file.trials.end(), [](const Trial& trial) {
    return trial.kind == TrialKind::main;
  });
  if (!answered) object.fail("trials", "holds no answer of kind `main`; take the file out");
  object.finish(format_cure);
  return file;
}

namespace {

// The page saves whole sessions only, so the answers are those of the plan.
void check_plan(const AnswerFile& file, const std::string& name, bool allow_missing) {
  for (const std::string& demonstration : file.planned) {
    const auto count =
        std::count_if(file.trials.begin(), file.trials.end(), [&](const Trial& trial) {
          return trial.kind == TrialKind::main && trial.demonstration == demonstration;
        });
    const bool fewer = count < file.answers_per_demonstration;
    if (count == file.answers_per_demonstration || (fewer && allow_missing)) continue;
    throw InputError(
        name,
        fmt::format("participant `{}` gave {} to demonstration `{}`, but the plan has {}; "
                    "leave the participant out with --exclude{}",
                    file.participant, counted(count, "answer"), demonstration,
                    file.answers_per_demonstration, fewer ? ", or pass --allow-missing" : ""));
  }
}

}  // namespace

nlohmann::json read_answer_json(const fs::path& path) {
  return read_json_file(path, largest_answer_file);
}

AnswersKind kind_of_answers(const fs::path& path) {
  try {
    const fs::path file = fs::is_directory(path) ? files_of_folder(path).front() : path;
    if (file.extension() != ".json") return AnswersKind::none;
    const nlohmann::json document = read_answer_json(file);
    const nlohmann::json plan = document.value("plan", nlohmann::json());
    if (!plan.is_object()) return AnswersKind::none;
    return plan.contains("graded_hit") ? AnswersKind::graded
           : plan.contains("methods")  ? AnswersKind::comparisons
                                       : AnswersKind::two_methods;
  } catch (const std::exception&) {
    return AnswersKind::none;
  }
}

std::vector<fs::path> answer_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool hidden = name.starts_with('.');
    if (!entry.is_regular_file() || hidden || entry.path().extension() != ".json") continue;
    if (name != "dataset_description.json") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> files_of_folder(const fs::path& folder) {
  std::vector<fs::path> files = answer_files(folder);
  if (files.empty()) {
    throw InputError(folder.string(),
                     "no answer files (*.json) in this folder; name the folder that the study "
                     "page saves to");
  }
  return files;
}

std::vector<NamedAnswerFile> read_answer_files(
    const fs::path& path, bool allow_missing, SameStudy& same_study,
    const std::function<bool(const std::string&)>& excluded) {
  std::vector<NamedAnswerFile> files;
  for (const fs::path& place :
       fs::is_directory(path) ? files_of_folder(path) : std::vector<fs::path>{path}) {
    const std::string name = place.string();
    AnswerFile file = parse_answer_file(read_answer_json(place), name);
    if (excluded(file.participant)) continue;
    same_study.check(file, name);
    check_plan(file, name, allow_missing);
    files.push_back({name, std::move(file)});
  }
  return files;
}

void SameStudy::check_pilot(bool is_pilot, const std::string& place) {
  if (pilot_of_.empty()) {
    is_pilot_ = is_pilot;
    pilot_of_ = place;
  }
  if (is_pilot == is_pilot_) return;
  throw InputError(place, fmt::format("is {} of a pilot, and {} is {}; analyse the pilot in a run "
                                      "of its own",
                                      is_pilot ? "an answer" : "no answer", pilot_of_,
                                      is_pilot_ ? "one" : "none"));
}

void SameStudy::check(const AnswerFile& file, const std::string& name) {
  const auto [before_file, is_first] = file_of_.emplace(file.participant, name);
  if (!is_first) {
    throw InputError(name,
                     fmt::format("participant `{}` has a file already: {}; keep one of the two",
                                 file.participant, before_file->second));
  }
  check_pilot(file.is_pilot, name);
  if (study_of_.empty()) {
    study_ = file.study;
    methods_ = file.methods;
    graded_hit_ = file.graded_hit;
    study_of_ = name;
  }
  if (file.methods != methods_ || file.graded_hit != graded_hit_) {
    throw InputError(name, fmt::format("compares other methods than {}; analyse each study in a "
                                       "run of its own",
                                       study_of_));
  }
  if (file.study != study_) {
    const std::map<std::string, std::string> words = {{"language", "the language"},
                                                      {"question", "the question"},
                                                      {"consent_sha256", "the consent text"},
                                                      {"texts_sha256", "the texts of the page"},
                                                      {"clips_sha256", "the clips"},
                                                      {"options_sha256", "what is asked besides"},
                                                      {"consent_version", "the consent's version"}};
    std::string what;
    const auto value = [](const std::map<std::string, std::string>& study, const std::string& key) {
      const auto found = study.find(key);
      return found == study.end() ? "" : found->second;
    };
    for (const auto& [key, word] : words) {
      if (value(file.study, key) != value(study_, key)) what += (what.empty() ? "" : ", ") + word;
    }
    throw InputError(name, fmt::format("was answered in another study than {}: {} differ; analyse "
                                       "each study in a run of its own",
                                       study_of_, what));
  }
  for (const auto& [clip, hash] : file.clips_sha256) {
    const auto [before, is_new] = clips_.emplace(clip, std::pair(hash, name));
    if (is_new || before->second.first == hash) continue;
    throw InputError(
        name, fmt::format("clip `{}` of `{}` is not the one of {} (other SHA-256); analyse the "
                          "participants who saw the same clips in one run",
                          clip.second, clip.first, before->second.second));
  }
}

}  // namespace pinchlab
