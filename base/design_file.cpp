// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/design_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/json_object.h"
#include "base/rates.h"
#include "base/sha256.h"
#include "base/strict_json.h"
#include "base/text_checks.h"

namespace pinchlab {
namespace {

using nlohmann::json;

constexpr std::size_t largest_design = 16U << 20U;  // bytes
constexpr const char* rules_cure = "; study/README.md has the keys";
constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

bool is_main(const json& trial) {
  return trial.at("kind") == "main";
}

// The sum of a count over main trials; NaN where no trial holds it.
double sum_of(const json& answers, const char* key) {
  double sum = 0;
  bool is_there = false;
  for (const json& trial : answers.at("trials")) {
    if (!is_main(trial) || !trial.contains(key)) continue;
    sum += trial[key].get<double>();
    is_there = true;
  }
  return is_there ? sum : nothing;
}

std::vector<double> values_of(const json& answers, const char* key) {
  std::vector<double> values;
  for (const json& trial : answers.at("trials")) {
    if (is_main(trial) && trial.contains(key)) values.push_back(trial[key].get<double>());
  }
  std::ranges::sort(values);
  return values;
}

double failed_checks(const json& answers) {
  return static_cast<double>(std::ranges::count_if(answers.at("trials"), [](const json& trial) {
    return trial.at("kind") == "attention" && trial.at("choice") != trial.at("expected");
  }));
}

double share_of_one_side(const json& answers) {
  double left = 0, right = 0, all = 0;
  for (const json& trial : answers.at("trials")) {
    if (!is_main(trial)) continue;
    ++all;
    left += trial.at("choice") == "left" ? 1 : 0;
    right += trial.at("choice") == "right" ? 1 : 0;
  }
  return std::max(left, right) / all;
}

// A value of an option of `analyse` as text: a number as it is printed, or a word.
std::string text_of(JsonObject& object, const std::string& key,
                    const std::vector<std::string>& words, double low, double high, bool is_whole) {
  const json& value = object.need(key);
  if (value.is_string()) {
    if (words.empty()) object.fail(key, "must be a number");
    return object.choice(key, words);
  }
  if (high <= low) object.fail(key, fmt::format("must be one of {}", fmt::join(words, ", ")));
  if (is_whole) {
    return std::to_string(object.whole(key, static_cast<long>(low), static_cast<long>(high)));
  }
  return fmt::format("{}", object.number(key, low, high));
}

struct AnalysisOption {
  const char* key;
  std::vector<std::string> words;  // that the value can be
  double low, high;                // or the numbers
  bool is_whole;
};

const std::vector<AnalysisOption> analysis_options = {
    {"alpha", {}, 1e-6, 0.5, false},
    {"bootstrap", {}, 99, 1000000, true},
    {"seed", {}, 0, 9007199254740991.0, true},
    {"function", {"logistic", "normal", "weibull"}, 0, 0, false},
    {"guess", {"free"}, 0, most_fixed_guess, false},
    {"lapse", {"free"}, 0, most_fixed_lapse, false},
    {"threshold_at", {}, 0.01, 0.99, false},
    {"scale", {"bradley-terry", "thurstone"}, 0, 0, false}};

void read_analysis(JsonObject object, Rules& rules) {
  std::vector<std::string> known;
  for (const auto& [key, value] : rules.analysis) known.push_back(key);
  object.expect_only(known, rules_cure);
  for (const AnalysisOption& option : analysis_options) {
    if (!object.has(option.key)) continue;
    rules.analysis[option.key] =
        text_of(object, option.key, option.words, option.low, option.high, option.is_whole);
  }
}

// As `pinchlab analyse` refuses them.
void check_room(const JsonObject& object, const Rules& rules) {
  const auto guess = rules.analysis.find("guess"), lapse = rules.analysis.find("lapse");
  if (guess == rules.analysis.end()) return;  // of no levels
  const std::string why = why_no_room(parse_number(guess->second), parse_number(lapse->second));
  if (!why.empty()) object.fail("analysis", why);
}

void read_exclusions(JsonObject object, Rules& rules) {
  std::vector<std::string> known;
  for (const ExclusionRule& rule : exclusion_rules()) known.push_back(rule.key);
  object.expect_only(known, rules_cure);
  for (const ExclusionRule& rule : exclusion_rules()) {
    if (object.has(rule.key)) {
      rules.exclusions[rule.key] = object.number(rule.key, rule.low, rule.high);
    }
  }
}

void read_rules(JsonObject& object, Rules& rules) {
  if (object.has("hypotheses")) {
    for (const json& entry : object.array("hypotheses", 100)) {
      if (!entry.is_string() || entry.get_ref<const std::string&>().empty() ||
          entry.get_ref<const std::string&>().size() > 10000) {
        object.fail("hypotheses", "must hold texts");
      }
      rules.hypotheses.push_back(entry.get<std::string>());
    }
  }
  if (object.has("exclusions")) read_exclusions(object.object("exclusions"), rules);
  if (object.has("analysis")) read_analysis(object.object("analysis"), rules);
}

std::vector<std::int64_t> read_looks(JsonObject& object) {
  std::vector<std::int64_t> looks;
  for (const json& entry : object.array("participants", 1000)) {
    const bool is_good = entry.is_number_integer() && entry.get<std::int64_t>() > 0 &&
                         entry.get<std::int64_t>() <= 1000000 &&
                         (looks.empty() || entry.get<std::int64_t>() > looks.back());
    if (!is_good) object.fail("participants", "must hold increasing whole numbers from 1 on");
    looks.push_back(entry.get<std::int64_t>());
  }
  if (looks.empty()) object.fail("participants", "is empty");
  return looks;
}

void read_hashes(JsonObject clips, Design& design) {
  for (const std::string& name : clips.all_keys()) {
    JsonObject variants = clips.object(name);
    for (const std::string& variant : variants.all_keys()) {
      design.clips_sha256[name][variant] = variants.sha256(variant);
    }
  }
}

AnswersKind kind_of_plan(const json& plan) {
  return plan.contains("graded_hit") ? AnswersKind::graded
         : plan.contains("methods")  ? AnswersKind::comparisons
                                     : AnswersKind::two_methods;
}

}  // namespace

const std::vector<ExclusionRule>& exclusion_rules() {
  static const std::vector<ExclusionRule> rules = {
      {"failed_checks_over", 0, 1000, "more than {} attention checks failed"},
      {"dropped_frames_over", 0, 1, "more than {} of all frames were dropped (as a share)"},
      {"focus_lost_over", 0, 1e6, "the window was left more than {} times"},
      {"one_side_over", 0.5, 1, "one side was chosen in more than {} of the answers (as a share)"},
      {"clip_width_px_under", 0, 100000, "the clips were shown less than {} CSS pixels wide", true},
      {"median_reaction_time_s_under", 0, 3600,
       "the median time from the buttons to the answer was below {} s", true}};
  return rules;
}

double measure(const ExclusionRule& rule, const json& answers) {
  if (rule.key == "failed_checks_over") return failed_checks(answers);
  if (rule.key == "focus_lost_over") return sum_of(answers, "focus_lost_count");
  if (rule.key == "one_side_over") return share_of_one_side(answers);
  if (rule.key == "dropped_frames_over") {
    const double frames = sum_of(answers, "frame_count");
    return frames > 0 ? sum_of(answers, "dropped_frames") / frames : nothing;
  }
  if (rule.key == "clip_width_px_under") {
    const std::vector<double> widths = values_of(answers, "clip_width_px");
    return widths.empty() ? nothing : widths.front();
  }
  const std::vector<double> times = values_of(answers, "reaction_time_s");
  return times.empty() ? nothing : (times[(times.size() - 1) / 2] + times[times.size() / 2]) / 2;
}

std::map<std::string, std::string> usual_analysis(AnswersKind kind) {
  std::map<std::string, std::string> options = {
      {"alpha", "0.05"}, {"bootstrap", "9999"}, {"seed", "1"}};
  if (kind == AnswersKind::graded) {
    options["bootstrap"] = "399";
    options["function"] = "logistic";
    options["guess"] = "0.5";
    options["lapse"] = "free";
    options["threshold_at"] = "0.5";
  }
  if (kind == AnswersKind::comparisons) options["scale"] = "bradley-terry";
  return options;
}

Rules parse_rules(const json& document, const std::string& file, AnswersKind kind) {
  JsonObject object(document, file, "");
  object.expect_only({"format", "hypotheses", "exclusions", "analysis"}, rules_cure);
  object.choice("format", {"pinchlab-rules 1"});
  Rules rules;
  rules.analysis = usual_analysis(kind);
  read_rules(object, rules);
  check_room(object, rules);
  return rules;
}

Sample parse_stopping(const json& document, const std::string& file) {
  JsonObject object(document, file, "");
  object.choice("format", {"pinchlab-stopping 1"});
  Sample sample;
  sample.rule = object.choice("rule", {"fixed", "obrien-fleming", "pocock", "bayes-factor"});
  sample.looks = read_looks(object);
  const bool is_bayes = sample.rule == "bayes-factor";
  if (is_bayes) sample.bayes_factor = object.number("bayes_factor", 1, 1e6);
  const json& looks = object.array("looks", sample.looks.size());
  if (looks.size() != sample.looks.size()) {
    object.fail("looks", "must have as many entries as participants");
  }
  for (std::size_t i = 0; i < looks.size(); ++i) {
    JsonObject look(looks[i], file, fmt::format("/looks/{}", i));
    if (!is_bayes) sample.p_at_most.push_back(look.number("p_at_most", 0, 1));
  }
  object.number("alpha", 1e-9, 0.999);
  for (const char* which : {"without_difference", "at_share"}) {
    JsonObject result = object.object(which);
    for (const char* key : {"finds", "finds_none"}) result.number(key, 0, 1);
    result.number("participants", 0, 1e6);
  }
  object.number("share", 0, 1);
  object.whole("studies", 1, 1000000000);
  sample.stopping = document;
  return sample;
}

std::string design_hash(json document) {
  document.erase("sha256");
  return sha256(document.dump());
}

Design parse_design(const json& document, const std::string& file) {
  JsonObject object(document, file, "");
  object.choice("format", {"pinchlab-design 1"});
  Design design;
  design.sha256 = object.sha256("sha256");
  if (design.sha256 != design_hash(document)) {
    object.fail("sha256", "is not that of the rest: the design was changed after it was frozen");
  }
  design.frozen_utc = object.utc("frozen_utc");
  object.text("software_version", 256);
  design.seed = static_cast<std::uint64_t>(object.whole("seed", 0, (long{1} << 53) - 1));
  design.plan = object.need("plan");
  JsonObject plan = object.object("plan");
  const AnswersKind kind = kind_of_plan(design.plan);
  object.whole("trials", 1, 1000000);
  JsonObject study = object.object("study");
  for (const std::string& key : study.all_keys()) design.study[key] = study.text(key, 10000);
  read_hashes(object.object("clips_sha256"), design);
  JsonObject sample = object.object("sample");
  if (sample.has("stopping")) {
    design.sample = parse_stopping(sample.need("stopping"), file);
  } else {
    design.sample.looks = read_looks(sample);
  }
  sample.finish();
  JsonObject rules = object.object("rules");
  design.rules.analysis = usual_analysis(kind);
  read_rules(rules, design.rules);
  rules.finish();
  if (object.has("pilot_participants")) object.whole("pilot_participants", 0, 1000000);
  object.finish();
  return design;
}

Design read_design(const std::filesystem::path& path) {
  return parse_design(read_json_file(path, largest_design), path.string());
}

std::filesystem::path design_path(const std::filesystem::path& answers) {
  return answers / ".design.json";
}

}  // namespace pinchlab
