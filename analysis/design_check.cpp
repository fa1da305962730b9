// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/design_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/answers_table.h"
#include "base/answer_file.h"
#include "base/counted.h"
#include "base/input_error.h"

namespace pinchlab::analysis {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

struct NamedJson {
  std::string participant;
  json file;
};

// Every answer file, checked, with all that it holds.
std::vector<NamedJson> all_files(const std::vector<fs::path>& inputs) {
  std::vector<NamedJson> files;
  for (const fs::path& input : inputs) {
    if (!fs::is_directory(input) && input.extension() != ".json") {
      throw InputError(input.string(),
                       "a design is held against answer files, which this is not; name them, or "
                       "leave --design out");
    }
    for (const fs::path& path :
         fs::is_directory(input) ? files_of_folder(input) : std::vector<fs::path>{input}) {
      json file = read_answer_json(path);
      std::string participant = parse_answer_file(file, path.string()).participant;
      files.push_back({std::move(participant), std::move(file)});
    }
  }
  return files;
}

bool is_out(const ExclusionRule& rule, double limit, double value) {
  return !std::isnan(value) && (rule.is_under ? value < limit : value > limit);
}

std::string in_words(const ExclusionRule& rule, double limit) {
  return fmt::format(fmt::runtime(rule.words), limit);
}

// Deviations, each with who it is about, in order of first mention.
class Deviations {
 public:
  void add(const std::string& what, const std::string& participant) {
    const auto [found, is_new] = who_.try_emplace(what);
    if (is_new) order_.push_back(what);
    found->second.push_back(participant);
  }
  [[nodiscard]] std::vector<std::string> words(std::size_t all) const {
    std::vector<std::string> result;
    for (const std::string& what : order_) {
      const std::vector<std::string>& who = who_.at(what);
      constexpr std::size_t most_named = 5;
      std::string names;
      for (std::size_t i = 0; i < std::min(who.size(), most_named); ++i)
        names += (i == 0 ? "" : ", ") + who[i];
      if (who.size() > most_named) names += fmt::format(" and {} more", who.size() - most_named);
      result.push_back(
          fmt::format("{}: {} of {} ({})", what, who.size(), counted(all, "participant"), names));
    }
    return result;
  }

 private:
  std::vector<std::string> order_;
  std::map<std::string, std::vector<std::string>> who_;
};

void check_plan(const json& file, const Design& design, const std::string& who,
                Deviations& deviations) {
  const json& plan = file.at("plan");
  for (const auto& [key, value] : design.plan.items()) {
    if (plan.value(key, json()) != value) deviations.add("another plan (" + key + ")", who);
  }
  for (const auto& [key, value] : plan.items()) {
    if (!design.plan.contains(key)) deviations.add("another plan (" + key + ")", who);
  }
  if (file.value("seed", json()) != json(design.seed)) {
    deviations.add("another seed, so that order and sides are not the planned ones", who);
  }
  const auto answered = std::ranges::count_if(
      file.at("trials"), [](const json& trial) { return trial.at("kind") == "main"; });
  const auto planned = static_cast<std::int64_t>(plan.at("demonstrations").size()) *
                       plan.at("answers_per_demonstration").get<std::int64_t>();
  if (answered != planned) deviations.add("answers are missing", who);
}

void check_shown(const AnswerFile& file, const Design& design, Deviations& deviations) {
  static const std::map<std::string, std::string> words = {
      {"language", "another language"},
      {"question", "another question"},
      {"consent_sha256", "another consent text"},
      {"consent_version", "another version of the information"},
      {"texts_sha256", "another text of the page"},
      {"options_sha256", "other questions or options"},
      {"clips_sha256", "other clips"}};
  for (const auto& [key, value] : design.study) {
    const auto found = file.study.find(key);
    if (found == file.study.end() || found->second != value) {
      const auto word = words.find(key);
      deviations.add(word == words.end() ? "another " + key : word->second, file.participant);
    }
  }
  if (file.study.contains("options_sha256") && !design.study.contains("options_sha256")) {
    deviations.add(words.at("options_sha256"), file.participant);
  }
  for (const auto& [clip, hash] : file.clips_sha256) {
    const auto planned = design.clips_sha256.find(clip.first);
    const bool is_known = planned != design.clips_sha256.end() &&
                          std::ranges::any_of(planned->second, [&seen = hash](const auto& one) {
                            return one.second == seen;
                          });
    if (!is_known)
      deviations.add(fmt::format("another clip of `{}`", clip.first), file.participant);
  }
}

std::string list(const std::vector<std::int64_t>& numbers) {
  return fmt::format("{}", fmt::join(numbers, ", "));
}

// What the last look that so many participants have come to asks for; before the first one, that.
void note_bound(const Sample& sample, std::size_t analysed, DesignCheck& check) {
  if (sample.rule == "bayes-factor") {
    check.bayes_factor = sample.bayes_factor;
  } else if (sample.looks.size() > 1) {
    const auto next = std::ranges::upper_bound(sample.looks, static_cast<std::int64_t>(analysed));
    const auto passed = static_cast<std::size_t>(next - sample.looks.begin());
    const std::size_t last = std::max<std::size_t>(passed, 1) - 1;
    check.p_at_most = sample.p_at_most.at(last);
    check.look = sample.looks[last];
  }
}

// May the study stop with so many participants?
void check_sample(const Sample& sample, std::size_t analysed, const UsedAnalysis& used,
                  DesignCheck& check) {
  const auto look = std::ranges::find(sample.looks, static_cast<std::int64_t>(analysed));
  if (look == sample.looks.end()) {
    check.deviations.push_back(
        fmt::format("{} {} analysed, not {}{}", counted(analysed, "participant"),
                    analysed == 1 ? "was" : "were",
                    sample.looks.size() > 1 ? "as many as at a look: " : "", list(sample.looks)));
    return;
  }
  check.kept.push_back(counted(analysed, "participant"));
  if (look + 1 == sample.looks.end()) return;
  if (sample.rule == "bayes-factor") {
    if (!used.log_bayes_factor) return;
    if (std::abs(*used.log_bayes_factor) < std::log(sample.bayes_factor)) {
      check.deviations.push_back(fmt::format(
          "the study stopped at a look with the Bayes factor {:.3g}, which is neither {:g} or more "
          "nor 1/{:g} or less",
          std::exp(*used.log_bayes_factor), sample.bayes_factor, sample.bayes_factor));
    }
    return;
  }
  const double limit = sample.p_at_most.at(static_cast<std::size_t>(look - sample.looks.begin()));
  if (used.p && *used.p > limit) {
    check.deviations.push_back(
        fmt::format("the study stopped at a look where p had to be at most {:.3g}; it is {:.3g}",
                    limit, *used.p));
  }
}

void check_exclusions(const std::vector<Exclusion>& by_rule, const UsedAnalysis& used,
                      DesignCheck& check) {
  for (const Exclusion& exclusion : used.exclusions) {
    if (std::ranges::find(by_rule, exclusion.participant, &Exclusion::participant) ==
        by_rule.end()) {
      check.deviations.push_back(
          fmt::format("{} was left out ({}), which no rule of the design says",
                      exclusion.participant, exclusion.reason));
    }
  }
  check.kept.push_back(fmt::format("{} left out by the design's rules", by_rule.size()));
}

void check_options(const Design& design, const UsedAnalysis& used, DesignCheck& check) {
  for (const auto& [key, value] : design.rules.analysis) {
    const auto found = used.options.find(key);
    if (found != used.options.end() && found->second != value) {
      check.deviations.push_back(fmt::format("{} is {}, not {}", key, found->second, value));
    }
  }
}

}  // namespace

std::optional<Design> design_of(const std::vector<fs::path>& inputs, const fs::path& file) {
  if (!file.empty()) return read_design(file);
  std::optional<Design> design;
  std::string from;
  for (const fs::path& input : inputs) {
    if (!fs::is_directory(input) || !fs::exists(design_path(input))) continue;
    Design next = read_design(design_path(input));
    if (design && design->sha256 != next.sha256) {
      throw InputError(input.string(),
                       fmt::format("was frozen with another design than {}; analyse each study in "
                                   "a run of its own, or name one with --design",
                                   from));
    }
    design = std::move(next);
    from = input.string();
  }
  return design;
}

std::vector<Exclusion> exclusions_by_rule(const Design& design,
                                          const std::vector<fs::path>& inputs) {
  std::vector<Exclusion> exclusions;
  for (const NamedJson& named : all_files(inputs)) {
    std::string reasons;
    for (const ExclusionRule& rule : exclusion_rules()) {
      const auto limit = design.rules.exclusions.find(rule.key);
      if (limit == design.rules.exclusions.end()) continue;
      const double value = measure(rule, named.file);
      if (is_out(rule, limit->second, value)) {
        reasons += fmt::format("{}{}: {:.4g}", reasons.empty() ? "" : "; ",
                               in_words(rule, limit->second), value);
      }
    }
    if (!reasons.empty()) exclusions.push_back({named.participant, reasons});
  }
  return exclusions;
}

DesignCheck check_design(const Design& design, const std::vector<fs::path>& inputs,
                         const UsedAnalysis& used) {
  const std::vector<NamedJson> files = all_files(inputs);
  Deviations deviations;
  std::size_t analysed = 0;
  for (const NamedJson& named : files) {
    const AnswerFile file = parse_answer_file(named.file, named.participant);
    if (file.is_pilot) deviations.add("answers of a pilot", file.participant);
    if (named.file.at("started_utc").get<std::string>().substr(0, 19) <
        design.frozen_utc.substr(0, 19)) {
      deviations.add("began before the design was frozen", file.participant);
    }
    check_plan(named.file, design, file.participant, deviations);
    check_shown(file, design, deviations);
    if (std::ranges::find(used.exclusions, file.participant, &Exclusion::participant) ==
        used.exclusions.end()) {
      ++analysed;
    }
  }
  DesignCheck check{design.sha256, design.frozen_utc, {}, deviations.words(files.size()), {}, {}};
  if (check.deviations.empty()) {
    check.kept.emplace_back("plan, seed, question, texts, consent and clips of all participants");
  }
  note_bound(design.sample, analysed, check);
  check_sample(design.sample, analysed, used, check);
  check_exclusions(exclusions_by_rule(design, inputs), used, check);
  check_options(design, used, check);
  return check;
}

std::string design_words(const std::optional<DesignCheck>& check) {
  if (!check) return "";
  const std::string design = fmt::format(" The design that was frozen on {} (SHA-256 {}) was ",
                                         check->frozen_utc, check->sha256);
  if (check->deviations.empty()) {
    return design + fmt::format("followed: {}.", fmt::join(check->kept, "; "));
  }
  std::string words = design + "not followed:";
  for (std::size_t i = 0; i < check->deviations.size(); ++i) {
    words += fmt::format(" ({}) {}{}", i + 1, check->deviations[i],
                         i + 1 < check->deviations.size() ? ";" : ".");
  }
  return words;
}

nlohmann::ordered_json design_json(const DesignCheck& check) {
  nlohmann::ordered_json document = {{"sha256", check.sha256},
                                     {"frozen_utc", check.frozen_utc},
                                     {"followed", check.deviations.empty()},
                                     {"kept", check.kept},
                                     {"deviations", check.deviations}};
  if (check.p_at_most) document["p_at_most"] = *check.p_at_most;
  if (check.bayes_factor) document["bayes_factor"] = *check.bayes_factor;
  return document;
}

}  // namespace pinchlab::analysis
