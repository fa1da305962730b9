// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/results.h"

#include <algorithm>
#include <set>

#include "base/answer_file.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double many_dropped = 0.02, nearly_always = 0.9;
constexpr int small_clip = 900;  // CSS px, both clips together
constexpr int often_away = 5, fewest_for_sides = 8;

json warning(const char* code, const json& file, const json& value) {
  return {{"code", code}, {"participant", file["participant"]}, {"value", value}};
}

// Adds numbers, and those of objects in objects, to an object.
void add(json& sum, const json& more) {
  for (const auto& [key, value] : more.items()) {
    if (value.is_object()) {
      if (!sum.contains(key)) sum[key] = json::object();
      add(sum[key], value);
    } else {
      sum[key] = sum.value(key, 0) + value.get<int>();
    }
  }
}

// What is kept of a file: counts by demonstration, sides, warnings. Throws InputError where it is
// no answer file.
json summary_of(const fs::path& path) {
  const json file = read_answer_json(path);
  parse_answer_file(file, path.filename().string());
  json demonstrations = json::object();
  int left = 0, ties = 0, answers = 0, failed = 0, narrowest = 1 << 20;
  double frames = 0, dropped = 0, away = 0;
  for (const json& trial : file["trials"]) {
    frames += trial.value("frame_count", 0);
    dropped += trial.value("dropped_frames", 0);
    away += trial.value("focus_lost_count", 0);
    if (trial.contains("clip_width_px")) {
      narrowest = std::min(narrowest, trial["clip_width_px"].get<int>());
    }
    if (trial["kind"] == "attention" && trial["choice"] != trial["expected"]) ++failed;
    if (trial["kind"] != "main") continue;
    const std::string side = trial["choice"];
    const bool is_left = side == "left";
    ++answers;
    left += is_left ? 1 : 0;
    ties += side == "tie" ? 1 : 0;
    json one = {{"answers", 1}, {"left", is_left ? 1 : 0}};
    const std::string chosen = trial.value(side, side);  // a tie is none of the sides
    if (trial.contains("level")) {
      one["levels"] = {{trial["level"].dump(), {{chosen, 1}}}};
    } else {
      one["chosen"] = {{chosen, 1}};
    }
    add(demonstrations, {{trial["demonstration"].get<std::string>(), one}});
  }
  json warnings = json::array();
  if (frames > 0 && dropped / frames > many_dropped) {
    warnings.push_back(warning("dropped_frames", file, dropped / frames));
  }
  if (narrowest < small_clip) warnings.push_back(warning("small_clip", file, narrowest));
  if (failed > 0) warnings.push_back(warning("failed_check", file, failed));
  if (away > often_away) warnings.push_back(warning("focus_lost", file, away));
  const double one_side = std::max(left, answers - ties - left);
  if (answers >= fewest_for_sides && one_side >= nearly_always * answers) {
    warnings.push_back(warning("one_side", file, one_side / answers));
  }
  const json measured =
      file.value("/questionnaires/screen/refresh_rate_hz/answer"_json_pointer, json());
  if (measured.is_number() && !shows_60_evenly(measured.get<double>())) {
    warnings.push_back(warning("refresh_rate", file, measured));
  }
  return {{"demonstrations", demonstrations},
          {"left", left},
          {"right", answers - ties - left},
          {"warnings", warnings},
          {"version", file["software_version"]}};
}

}  // namespace

json Results::read(bool reveal) {
  const std::scoped_lock lock(mutex_);
  json demonstrations = json::object(), warnings = json::array();
  std::map<std::string, json> present;
  for (const fs::path& path : answer_files(answers_)) {
    const std::string name = path.filename().string();
    const auto known = summaries_.find(name);
    try {
      present[name] = known != summaries_.end() ? known->second : summary_of(path);
    } catch (const std::exception& error) {
      present.erase(name);
      if (!fs::exists(path)) continue;  // withdrawn since the folder was listed
      warnings.push_back(
          {{"code", "no_answer_file"}, {"participant", name}, {"value", error.what()}});
    }
  }
  summaries_ = std::move(present);
  std::set<std::string> versions;
  int left = 0, right = 0;
  for (const auto& [name, summary] : summaries_) {
    add(demonstrations, summary["demonstrations"]);
    left += summary["left"].get<int>();
    right += summary["right"].get<int>();
    versions.insert(summary["version"].get<std::string>());
    for (const json& one : summary["warnings"]) warnings.push_back(one);
  }
  if (versions.size() > 1) {
    warnings.push_back({{"code", "versions"}, {"participant", ""}, {"value", versions}});
  }
  json rows = json::array();
  for (auto& [name, one] : demonstrations.items()) {
    one["name"] = name;
    if (!reveal) {
      one.erase("chosen");
      one.erase("levels");
    }
    rows.push_back(one);
  }
  return {{"finished", summaries_.size()},
          {"demonstrations", rows},
          {"sides", {{"left", left}, {"right", right}}},
          {"warnings", warnings}};
}

}  // namespace pinchlab::study
