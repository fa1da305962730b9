// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/freeze.h"

#include <fmt/format.h>

#include <stdexcept>

#include "base/answer_file.h"
#include "base/durable_file.h"
#include "base/folder_lock.h"
#include "base/partial_file.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "study/answers.h"
#include "study/shown.h"
#include "study/study_file.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t largest_design = 16U << 20U;  // bytes

// Nobody may have taken part, or be taking part.
void check_nobody(const fs::path& answers) {
  if (fs::exists(design_path(answers))) {
    throw std::runtime_error(
        fmt::format("{}: a design is frozen here already; use another --answers for another study",
                    answers.string()));
  }
  for (const fs::path& path : answer_files(answers)) {
    const json file = read_answer_json(path);
    const bool is_pilot = file.is_object() && file.value("pilot", false);
    throw std::runtime_error(
        is_pilot
            ? fmt::format("{}: holds the answers of a pilot; freeze the study with an --answers "
                          "of its own, and name this folder with --pilot",
                          answers.string())
            : fmt::format("{}: holds answers already; a design is frozen before the first "
                          "participant",
                          answers.string()));
  }
  for (const fs::directory_entry& entry : fs::directory_iterator(running_folder(answers))) {
    const fs::path& path = entry.path();
    if (path.extension() == ".json" && path.filename() != "study.json") {
      throw std::runtime_error(
          fmt::format("{}: somebody is taking part already; a design is frozen before the first "
                      "participant",
                      answers.string()));
    }
  }
}

// Participants of a pilot, whose answers must say that they are of one.
std::size_t count_pilot(const fs::path& folder) {
  const std::vector<fs::path> files = answer_files(folder);
  for (const fs::path& path : files) {
    const json file = read_answer_json(path);
    if (!file.is_object() || !file.value("pilot", false)) {
      throw std::runtime_error(
          fmt::format("{}: is no answer of a pilot (study serve --pilot)", path.string()));
    }
  }
  return files.size();
}

json hashes_of(const Clips& clips) {
  json hashes = json::object();
  for (const auto& [name, files] : clips) {
    hashes[name] = {{"left", files.mp4.left->sha256()}, {"right", files.mp4.right->sha256()}};
    if (!files.webm) continue;
    hashes[name]["left_webm"] = files.webm->left->sha256();
    hashes[name]["right_webm"] = files.webm->right->sha256();
  }
  return hashes;
}

// A value of the analysis as JSON: a number where it is one.
json value_of(const std::string& text) {
  const json number = json::parse(text, nullptr, false);
  return number.is_number() ? number : json(text);
}

json rules_entry(const Rules& rules) {
  json analysis = json::object();
  for (const auto& [key, value] : rules.analysis) analysis[key] = value_of(value);
  return {
      {"hypotheses", rules.hypotheses}, {"exclusions", rules.exclusions}, {"analysis", analysis}};
}

json design_of(const FreezeOptions& options, const json& shown, std::uint64_t seed) {
  const PlanOptions plan = plan_options(options.config);
  json sample = json::object();
  if (options.sample.stopping.is_null()) {
    sample["participants"] = options.sample.looks;
  } else {
    sample["stopping"] = options.sample.stopping;
  }
  json design = {{"format", "pinchlab-design 1"},
                 {"frozen_utc", options.utc},
                 {"software_version", PINCHLAB_VERSION},
                 {"seed", seed},
                 {"plan", json(plan_entry(plan, options.config.graded_hit))},
                 {"trials", make_plan(seed, 0, plan).size()},
                 {"study", shown},
                 {"clips_sha256", hashes_of(options.clips)},
                 {"sample", sample},
                 {"rules", rules_entry(options.rules)}};
  if (!options.pilot.empty()) design["pilot_participants"] = count_pilot(options.pilot);
  design["sha256"] = design_hash(design);
  return design;
}

constexpr const char* design_file = "design.json";
constexpr const char* text_file = "preregistration.md";

[[noreturn]] void refuse_out(const fs::path& file) {
  throw std::runtime_error(fmt::format(
      "{}: is of another design, and may be registered; name another --out", file.string()));
}

// Nothing of another study may be in `out`. A study that nobody has begun to freeze has nothing
// there at all.
void check_nothing_is_there(const FreezeOptions& options) {
  if (fs::exists(running_folder(options.answers) / "study.json")) return;
  for (const char* name : {design_file, text_file}) {
    if (fs::exists(options.out / name)) refuse_out(options.out / name);
  }
}

// What a freeze of this very design that was interrupted has left in `out`; `design` if there is
// nothing. A text that may be registered is never made anew.
json begun_before(const fs::path& out, const json& design) {
  if (!fs::exists(out / design_file)) return design;
  json before = read_json_file(out / design_file, largest_design);
  json same = design;
  if (before.is_object()) same["frozen_utc"] = before.value("frozen_utc", json());
  same["sha256"] = design_hash(same);
  if (before != same) refuse_out(out / design_file);
  return before;
}

void write_or_keep(const fs::path& path, const std::string& text) {
  if (!fs::exists(path)) return write_durably(path, text);
  if (read_whole(path) != text) refuse_out(path);
}

}  // namespace

AnswersKind kind_of(const Config& config) {
  return !config.graded.empty()    ? AnswersKind::graded
         : !config.methods.empty() ? AnswersKind::comparisons
                                   : AnswersKind::two_methods;
}

void check_sample(const FreezeOptions& options) {
  const json& rule = options.sample.stopping;
  if (rule.is_null()) return;
  if (kind_of(options.config) != AnswersKind::two_methods) {
    throw std::invalid_argument(
        "--stopping: is for the comparison of two methods; give --participants");
  }
  const PlanOptions plan = plan_options(options.config);
  const auto answers =
      static_cast<std::int64_t>(plan.demonstrations.size()) * answers_per_demonstration(plan);
  if (rule.value("trials", json()) != json(answers)) {
    throw std::invalid_argument(
        fmt::format("--stopping: the rule is for {} answers a participant, and this study asks for "
                    "{}; run pinchlab stopping with --trials {}",
                    rule.value("trials", json()).dump(), answers, answers));
  }
  if (options.sample.rule == "bayes-factor") return;  // no level is tested at
  const std::string alpha = fmt::format("{}", rule.value("alpha", 0.0));
  if (alpha != options.rules.analysis.at("alpha")) {
    throw std::invalid_argument(fmt::format(
        "--stopping: the rule is for alpha = {}, and the analysis has {}; make them the "
        "same (pinchlab stopping --alpha, alpha in --rules)",
        alpha, options.rules.analysis.at("alpha")));
  }
}

void check_rules(const FreezeOptions& options) {
  const bool has_checks = !options.config.attention_checks.empty();
  if (options.rules.exclusions.contains("failed_checks_over") && !has_checks) {
    throw std::invalid_argument(
        "--rules: failed_checks_over is about attention checks, and this study has none; take it "
        "out, or give the study some (attention_checks in --config)");
  }
}

std::string freeze(const FreezeOptions& options) {
  check_nothing_is_there(options);
  make_answers_folder(options.answers);
  const FolderLock lock(
      running_folder(options.answers),
      fmt::format("{}: a server is using this folder; stop it first", options.answers.string()));
  check_nobody(options.answers);
  const json shown = what_is_shown(options.config, options.clips);
  const StudyFile study = open_study_file(options.answers, options.config, shown, options.seed);
  const json design = begun_before(options.out, design_of(options, shown, study.seed));
  parse_design(design, "design");  // as it will be read
  const std::string text = design.dump(2) + "\n";
  make_folders(options.out);
  write_or_keep(options.out / design_file, text);
  write_or_keep(options.out / text_file, preregistration(design, options.config));
  write_durably(design_path(options.answers), text);  // the last: from here on it is frozen
  return design.at("sha256");
}

}  // namespace pinchlab::study
