// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/truth.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/json_object.h"
#include "base/sha256.h"
#include "base/strict_json.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t largest_truth = 1U << 20U;  // bytes

std::map<std::string, double> read_numbers(JsonObject& truth, const char* key, double low,
                                           double high) {
  std::map<std::string, double> numbers;
  if (!truth.has(key)) return numbers;
  JsonObject object = truth.object(key);
  for (const std::string& name : object.all_keys()) numbers[name] = object.number(name, low, high);
  return numbers;
}

// A name that the study does not have would have no effect.
template <class Value>
void check_names(const std::map<std::string, Value>& given, const std::vector<std::string>& known,
                 const Truth& truth, const char* key, const char* what) {
  for (const auto& [name, value] : given) {
    if (std::ranges::find(known, name) != known.end()) continue;
    throw InputError(
        fmt::format("{}: /{}/{}", truth.file, key, name),
        fmt::format("the study has no {} of this name{}", what, did_you_mean(name, known)));
  }
}

template <class Value>
void need_name(const std::map<std::string, Value>& given, const std::string& name,
               const Truth& truth, const char* key, const char* what) {
  if (given.contains(name)) return;
  throw InputError(fmt::format("{}: /{}", truth.file, key),
                   fmt::format("the {} of the study is missing: `{}`", what, name));
}

}  // namespace

void check_truth(const Config& config, const Truth& truth) {
  std::vector<std::string> series;
  for (const GradedStimulus& stimulus : config.graded) series.push_back(stimulus.clip.series);
  for (const std::string& method : config.methods) {
    need_name(truth.methods, method, truth, "methods", "method");
  }
  for (const std::string& name : series) {
    need_name(truth.series, name, truth, "series", "series");
  }
  std::vector<std::string> demonstrations = config.demonstrations;
  demonstrations.insert(demonstrations.end(), config.training.begin(), config.training.end());
  check_names(truth.shares, demonstrations, truth, "shares", "demonstration");
  check_names(truth.methods, config.methods, truth, "methods", "method");
  check_names(truth.series, series, truth, "series", "series");
}

Truth read_truth(const fs::path& path) {
  const json document = read_json_file(path, largest_truth);
  JsonObject object(document, path.string(), "");
  object.choice("format", {"pinchlab-truth 1"});
  Truth truth;
  truth.file = path.string();
  truth.sha256 = sha256(document.dump());
  truth.shares = read_numbers(object, "shares", 0.001, 0.999);
  truth.methods = read_numbers(object, "methods", -20, 20);
  if (object.has("series")) {
    JsonObject all = object.object("series");
    for (const std::string& name : all.all_keys()) {
      JsonObject one = all.object(name);
      TrueThreshold& series = truth.series[name];
      series.threshold = one.number("threshold", -1e9, 1e9);
      series.width = one.number("width", 1e-9, 1e9);
      if (one.has("spread")) series.spread = one.number("spread", 0, 1e9);
      one.finish();
    }
  }
  if (object.has("spread")) truth.spread = object.number("spread", 0, 10);
  if (object.has("left")) truth.left = object.number("left", -10, 10);
  if (object.has("lapses")) truth.lapses = object.number("lapses", 0, 1);
  object.finish("; study/README.md has the keys");
  return truth;
}

}  // namespace pinchlab::study
