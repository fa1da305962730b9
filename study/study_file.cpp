// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/study_file.h"

#include <fmt/format.h>

#include <charconv>
#include <stdexcept>

#include "base/durable_file.h"
#include "base/folder_lock.h"
#include "base/json_object.h"
#include "base/strict_json.h"
#include "study/secrets.h"
#include "study/shown.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t largest_file = 16U << 20U;  // bytes
constexpr std::size_t most_links = 1000000;

// What a study is counterbalanced by: participants of two plans must not come into one folder.
json fingerprint(const Config& config) {
  const PlanOptions options = plan_options(config);
  json plan = {{"demonstrations", options.demonstrations},
               {"training", options.training},
               {"attention_checks", options.attention_checks},
               {"repetitions", options.repetitions},
               {"both_orders", options.both_orders}};
  if (!options.methods.empty()) {
    plan["methods"] = options.methods;
    plan["pairs_per_demonstration"] = answers_per_demonstration(options);
  }
  if (!options.graded.empty()) {
    plan["graded_hit"] = config.graded_hit;
    for (const GradedClip& clip : options.graded) plan["graded"].push_back(clip_key(clip));
  }
  if (options.adaptive_trials > 0) plan["adaptive_trials"] = options.adaptive_trials;
  if (config.is_pilot) plan["pilot"] = true;
  if (!config.simulated_by.empty()) plan["simulated_by"] = config.simulated_by;
  return plan;
}

fs::path study_path(const fs::path& answers) {
  return running_folder(answers) / "study.json";
}

// Answers by one truth are not those by another, and neither are people's.
void check_simulated(const json& plan, const Config& config, const fs::path& answers) {
  const std::string before = plan.is_object() && plan.contains("simulated_by")
                                 ? plan["simulated_by"].dump()
                                 : json(std::string()).dump();
  if (before == json(config.simulated_by).dump()) return;
  throw std::runtime_error(fmt::format(
      "{}: {}; use another --answers", answers.string(),
      config.simulated_by.empty() ? "holds simulated participants, among whom nobody can take part"
      : before == "\"\""          ? "is not of simulated participants"
                                  : "was simulated by another truth"));
}

void check_pilot(const json& plan, const Config& config, const fs::path& answers) {
  const bool was_pilot = plan.is_object() && plan.contains("pilot");
  if (was_pilot == config.is_pilot) return;
  throw std::runtime_error(
      fmt::format("{}: {}, or use another --answers", answers.string(),
                  was_pilot ? "is the folder of a pilot; go on with that by `study serve --pilot`"
                            : "is the folder of a study that is no pilot; leave --pilot out"));
}

}  // namespace

fs::path running_folder(const fs::path& answers) {
  return answers / ".running";
}

namespace {

void check_made(const fs::path& answers, const std::error_code& problem) {
  if (!problem) return;
  throw std::runtime_error(fmt::format("{}: cannot be made: {}; use another --answers",
                                       answers.string(), problem.message()));
}

}  // namespace

void check_answers_folder(const fs::path& answers) {
  std::error_code none;
  fs::path there = fs::absolute(answers, none);
  while (!fs::exists(there, none) && there.has_relative_path()) there = there.parent_path();
  if (!fs::is_directory(there, none)) {
    check_made(answers, std::make_error_code(std::errc::not_a_directory));
  }
  const fs::path running = running_folder(answers);
  if (fs::is_directory(running, none)) const FolderLock is_free(running, in_use(answers));
}

std::string in_use(const fs::path& answers) {
  return fmt::format("{}: another server is using this folder; stop it or use another --answers",
                     answers.string());
}

void make_answers_folder(const fs::path& answers) {
  std::error_code problem;
  fs::create_directories(running_folder(answers), problem);
  check_made(answers, problem);
}

std::uint64_t random_seed() {
  std::uint64_t seed = 0;
  const std::string digits = random_hex(6);
  std::from_chars(digits.data(), digits.data() + digits.size(), seed, 16);
  return seed;
}

StudyFile open_study_file(const fs::path& answers, const Config& config, const json& shown,
                          std::optional<std::uint64_t> seed) {
  const fs::path path = study_path(answers);
  StudyFile study;
  if (!fs::exists(path)) {
    study.seed = seed.value_or(random_seed());
    study.link_secret = random_hex(32);
    write_study_file(answers, config, shown, study);
    return study;
  }
  const json file = read_json_file(path, largest_file);
  JsonObject object(file, path.string(), "");
  if (object.choice("format", {"pinchlab-running 1", "pinchlab-running 2"}) ==
      "pinchlab-running 1") {
    object.fail("format",
                "does not say what was asked and shown, as version 1 did not; end the study with "
                "the program that began it, or use another --answers");
  }
  study.seed = static_cast<std::uint64_t>(object.whole("seed", 0, static_cast<long>(largest_seed)));
  study.link_secret = object.text("link_secret", 64);
  for (const json& number : object.array("used_links", most_links)) {
    if (!number.is_number_unsigned()) {
      object.fail("used_links", "must hold participants' numbers");
    }
    study.used_links.insert(number.get<std::uint64_t>());
  }
  const json& plan = object.need("plan");
  check_simulated(plan, config, answers);
  check_pilot(plan, config, answers);
  if (seed && *seed != study.seed) {
    throw std::runtime_error(
        fmt::format("{1}: the study in this folder has the seed {0}, not {2}; say --seed {0}, "
                    "or use another --answers",
                    study.seed, answers.string(), *seed));
  }
  if (plan != fingerprint(config)) {
    throw std::runtime_error(
        fmt::format("{}: the study in this folder shows something else; use its configuration, or "
                    "another --answers",
                    answers.string()));
  }
  if (const json& before = object.need("shown"); before != shown) {
    throw std::runtime_error(
        fmt::format("{}: {} of the study in this folder changed; use what it began with, or "
                    "another --answers",
                    answers.string(), difference(before, shown)));
  }
  return study;
}

void write_study_file(const fs::path& answers, const Config& config, const json& shown,
                      const StudyFile& study) {
  const json file = {{"format", "pinchlab-running 2"},   {"seed", study.seed},
                     {"link_secret", study.link_secret}, {"used_links", study.used_links},
                     {"plan", fingerprint(config)},      {"shown", shown}};
  write_durably(study_path(answers), file.dump(2) + "\n");
}

}  // namespace pinchlab::study
