// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/answers.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/answer_file.h"
#include "base/durable_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "study/secrets.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// In a check the right answer and the wrong one are no methods.
std::pair<std::string, std::string> sides(const PlannedTrial& trial) {
  if (trial.kind == TrialKind::attention) {
    return {"check", "check"};
  }
  return trial.pinch == Side::left ? std::pair{trial.first, trial.second}
                                   : std::pair{trial.second, trial.first};
}

ordered_json trial_entry(const PlannedTrial& trial, std::size_t position,
                         const AnsweredTrial& answered, const std::string& clip) {
  const ordered_json told = to_json(answered.answer);
  const auto [left, right] = sides(trial);
  ordered_json entry = {{"position", position},
                        {"kind", to_string(trial.kind)},
                        {"demonstration", trial.demonstration},
                        {"left", left},
                        {"right", right},
                        {"choice", told.at("choice")}};
  if (trial.kind == TrialKind::attention) {
    entry["expected"] = to_string(trial.pinch);
  }
  if (trial.level) entry["level"] = *trial.level;
  entry["shown_utc"] = answered.shown_utc;
  entry["clip"] = clip;
  entry.update(told);
  entry.erase("encoding");  // the clip's name tells it
  return entry;
}

std::string variant(const PlannedTrial& trial, Encoding encoding) {
  const char* role = trial.kind == TrialKind::attention ? "check"
                     : trial.first == "pinch"           ? "pinch"
                                                        : "first";
  return fmt::format("{}_{}{}", role, to_string(trial.pinch),
                     encoding == Encoding::mp4 ? "" : "_webm");
}

void check(const std::string& bytes, const fs::path& path) {
  parse_answer_file(nlohmann::json::parse(bytes), path.string());
}

}  // namespace

ordered_json plan_entry(const PlanOptions& options, const std::string& graded_hit) {
  ordered_json entry = {{"demonstrations", options.demonstrations},
                        {"answers_per_demonstration", answers_per_demonstration(options)},
                        {"both_orders", options.both_orders},
                        {"training_trials", options.training.size()},
                        {"attention_checks", options.attention_checks.size()}};
  if (!options.methods.empty()) entry["methods"] = options.methods;
  if (!options.graded.empty()) entry["graded_hit"] = graded_hit;
  if (options.adaptive_trials > 0) entry["adaptive"] = "psi";
  return entry;
}

ordered_json answer_file(const Session& session, const AnsweredStudy& study,
                         const ShownFiles& shown,
                         const std::map<std::string, std::string>& free_text,
                         const std::string& saved_utc, const std::string& code_hash) {
  if (!is_finished(session)) {
    throw Refused(409, "there are trials left to answer");
  }
  ordered_json hashes = ordered_json::object();
  ordered_json trials = ordered_json::array();
  for (std::size_t i = 0; i < session.plan.size(); ++i) {
    const PlannedTrial& trial = session.plan[i];
    const Encoding encoding = session.answers[i].answer.encoding;
    const ShownFile file = shown(trial, encoding);
    hashes[clip_key(trial)][variant(trial, encoding)] = file.sha256;
    trials.push_back(trial_entry(trial, i + 1, session.answers[i], file.name));
  }
  ordered_json file = {{"format", "pinchlab-answers"},
                       {"version", 1},
                       {"participant", session.id},
                       {"participant_number", session.number},
                       {"seed", session.seed},
                       {"plan", plan_entry(study.plan, study.graded_hit)},
                       {"study", study.shown},
                       {"started_utc", session.started_utc},
                       {"saved_utc", std::max(saved_utc, session.started_utc)},
                       {"software_version", PINCHLAB_VERSION},
                       {"language", session.language},
                       {"user_agent", session.user_agent},
                       {"resumed_count", session.resumed_count},
                       {"withdrawal_code_sha256", code_hash},
                       {"clips_sha256", hashes},
                       {"trials", trials},
                       {"free_text", free_text}};
  if (study.is_pilot) file["pilot"] = true;
  if (!session.questionnaires.empty()) file["questionnaires"] = session.questionnaires;
  if (!session.recruited.participant.empty()) file["recruited"] = to_json(session.recruited);
  return file;
}

fs::path answer_path(const fs::path& folder, const std::string& id) {
  return folder / (id + ".json");
}

void save_answers(const fs::path& path, const ordered_json& file) {
  const std::string bytes = file.dump(2) + "\n";
  check(bytes, path);
  try {
    write_durably(path, bytes);
    check(read_whole(path), path);
  } catch (const std::exception&) {
    // Who is told that nothing is saved may leave, and then nothing may be there.
    std::error_code ignored;
    fs::remove(path, ignored);
    throw;
  }
}

std::optional<std::string> withdraw(const fs::path& folder, const std::string& code) {
  const std::string hash = withdrawal_hash(code);
  if (hash.empty()) {
    throw std::invalid_argument(fmt::format(
        "`{}` is no withdrawal code; it looks like 7K3M-9Q2X-0BVA", code.substr(0, 60)));
  }
  for (const fs::path& path : answer_files(folder)) {
    nlohmann::json file;
    try {
      file = read_answer_json(path);
    } catch (const InputError&) {
      if (!fs::exists(path)) continue;  // withdrawn since the folder was listed
      throw;
    }
    if (file.is_object() && file.value("withdrawal_code_sha256", nlohmann::json()) == hash) {
      remove_durably(path);
      return path.stem().string();
    }
  }
  return std::nullopt;
}

}  // namespace pinchlab::study
