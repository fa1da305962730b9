// SPDX-License-Identifier: GPL-3.0-or-later
// The text that is registered before the first participant: every figure comes from the design.
#include <fmt/format.h>

#include <cmath>

#include "base/counted.h"
#include "study/freeze.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100 * share);
}

std::string quote(const std::string& text) {
  std::string quoted = "> ";
  for (const char c : text) quoted += c == '\n' ? std::string("\n> ") : std::string(1, c);
  return quoted + "\n";
}

std::string hypotheses(const json& design, const Config& config) {
  const std::vector<std::string> stated = design.at("rules").at("hypotheses");
  std::string text = "## Question and hypotheses\n\nParticipants are asked:\n\n" +
                     quote(config.texts.at("question")) + "\n";
  for (std::size_t i = 0; i < stated.size(); ++i) {
    text += fmt::format("{}. {}\n", i + 1, stated[i]);
  }
  return text + (stated.empty() ? "No hypotheses were stated.\n" : "");
}

std::string data_so_far(const json& design) {
  std::string text =
      fmt::format("## Data so far\n\nNone: when this was written, on {}, no participant had begun.",
                  design.at("frozen_utc").get<std::string>());
  if (design.contains("pilot_participants")) {
    text += fmt::format(
        " A pilot with {} went before; its answers are marked as such and are not analysed with "
        "the study's.",
        counted(design["pilot_participants"].get<long>(), "participant"));
  }
  return text + "\n";
}

std::string what_varies(const json& design, const Config& config) {
  const json& plan = design.at("plan");
  const std::size_t shown = plan.at("demonstrations").size();
  const int each = plan.at("answers_per_demonstration");
  if (config.adaptive_trials > 0) {
    return fmt::format(
        "Thresholds of {} graded series: in each, {} with a graded clip beside its reference, "
        "at the level whose answer is expected to tell most about the participant's threshold and "
        "width (Psi method, Kontsevich and Tyler 1999). It is a hit to choose the {}.",
        shown, counted(each, "trial"),
        config.graded_hit == "reference" ? "reference" : "graded one");
  }
  if (!config.graded.empty()) {
    return fmt::format(
        "Thresholds of {} graded series: in each, {} with a graded clip beside its reference. "
        "It is a hit to choose the {}.",
        shown, counted(each, "trial"),
        config.graded_hit == "reference" ? "reference" : "graded one");
  }
  if (!config.methods.empty()) {
    return fmt::format(
        "{} methods ({}) are compared two by two in {}; each participant sees {} of "
        "the pairs of methods in each demonstration. Over participants pairs are balanced within "
        "demonstrations, and within participants methods are balanced over pairs and sides.",
        config.methods.size(), fmt::join(config.methods, ", "), counted(shown, "demonstration"),
        each);
  }
  return fmt::format(
      "{}, each with pinch joints and with its baseline side by side; each "
      "participant "
      "answers each demonstration {}.",
      counted(shown, "demonstration"),
      each == 1 ? std::string("once") : fmt::format("{} times", each));
}

std::string asked_besides(const Config& config) {
  std::string text;
  const TrialOptions& trial = config.trial;
  if (trial.is_graded) {
    text +=
        "Preferences are given in seven grades, from the left by far to the right by far; the "
        "middle one is a tie, which counts as no choice.\n\n";
  }
  std::vector<std::string> besides;
  if (trial.confidence > 0) {
    besides.push_back(fmt::format("how sure they are (1 to {})", trial.confidence));
  }
  if (trial.click_where) besides.emplace_back("to click on where it looks wrong");
  if (trial.reason > 0) besides.emplace_back("for a reason in words");
  if (!besides.empty()) {
    text += fmt::format("In each trial participants are asked besides: {}.\n\n",
                        fmt::join(besides, "; "));
  }
  if (!config.questionnaires.screen.empty()) {
    text +=
        "The size of a pixel (by a card held to the screen), the viewing distance (as estimated) "
        "and the refresh rate are measured first.\n\n";
  }
  for (const char* part : {"before", "after"}) {
    const Questionnaire* questionnaire = config.questionnaires.find(part);
    if (questionnaire == nullptr) continue;
    text += fmt::format("Questions {} the trials:\n\n", part);
    for (const Question& question : *questionnaire) {
      text += fmt::format("* {}{}\n", question.text, question.is_required ? "" : " (optional)");
    }
    text += "\n";
  }
  return text;
}

std::string procedure(const json& design, const Config& config) {
  const json& plan = design.at("plan");
  std::string text = fmt::format(
      "## Design\n\nWithin participants, forced choice between two clips side by side in one "
      "video, "
      "which repeats; the choice can be made once the first loop has been shown. {}\n\n"
      "A session has {}",
      what_varies(design, config), counted(design.at("trials").get<int>(), "trial"));
  const int training = plan.at("training_trials"), checks = plan.at("attention_checks");
  if (training + checks > 0) {
    text += fmt::format(", {} for practice and {} among them", training,
                        counted(checks, "attention check"));
  }
  text += fmt::format(
      ". Order and sides follow from the seed {} and the participant's number: orders are balanced "
      "over participants by Williams squares, and each participant sees both sides equally often "
      "(once more on one for odd numbers), none more than three times running. Participants cannot "
      "know which method a clip shows; nothing that a browser receives names one.\n\n",
      design.at("seed").get<std::uint64_t>());
  text += asked_besides(config);
  text += fmt::format(
      "Language of the page: `{}`. SHA-256 of the consent text: `{}`; of all texts: `{}`.\n",
      design.at("study").at("language").get<std::string>(),
      design.at("study").at("consent_sha256").get<std::string>(),
      design.at("study").at("texts_sha256").get<std::string>());
  return text;
}

std::string stopping_words(const json& rule) {
  const std::string name = rule.at("rule");
  const std::vector<long> looks = rule.at("participants");
  const bool is_bayes = name == "bayes-factor";
  std::string text;
  if (name == "fixed") {
    text = fmt::format("{} whose answers are analysed, looked at once.\n",
                       counted(looks.back(), "participant"));
  } else {
    text = fmt::format(
        "{} at most whose answers are analysed, looked at {} ({}). The study stops {}.\n",
        counted(looks.back(), "participant"), counted(looks.size(), "time"),
        is_bayes                   ? "Bayes factor of a share other than one half, Beta(1, 1)"
        : name == "obrien-fleming" ? "Lan and DeMets' spending after O'Brien and Fleming"
                                   : "Lan and DeMets' spending after Pocock",
        is_bayes ? fmt::format(
                       "at a look where the Bayes factor is {:g} or more, or 1/{:g} or less",
                       rule.at("bayes_factor").get<double>(), rule.at("bayes_factor").get<double>())
                 : "at the first look where p is at most that of the table");
  }
  if (!is_bayes) {
    text += "\n| participants | p at most | alpha spent |\n|--:|--:|--:|\n";
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const json& look = rule.at("looks").at(i);
      text += fmt::format("| {} | {:.4g} | {:.4g} |\n", looks[i],
                          look.at("p_at_most").get<double>(), look.at("spent").get<double>());
    }
  }
  const auto characteristics = [&](const json& result) {
    return fmt::format(
        "{}{}, with {:.1f} participants on average", percent(result.at("finds").get<double>()),
        is_bayes ? fmt::format(" (none in {})", percent(result.at("finds_none").get<double>()))
                 : "",
        result.at("participants").get<double>());
  };
  return text +
         fmt::format(
             "\nIn {} simulated studies of {} a participant (intraclass correlation "
             "{:g}) it finds a preference, where there is none, in {}; at a share of {:g} in "
             "{}.\n",
             rule.at("studies").get<long>(), counted(rule.at("trials").get<int>(), "answer"),
             rule.at("icc").get<double>(), characteristics(rule.at("without_difference")),
             rule.at("share").get<double>(), characteristics(rule.at("at_share")));
}

std::string sample(const json& design) {
  const json& entry = design.at("sample");
  const std::string heading = "## Sample size\n\n";
  return heading +
         (entry.contains("stopping")
              ? stopping_words(entry.at("stopping"))
              : fmt::format("{} whose answers are analysed; no look before.\n",
                            counted(entry.at("participants").at(0).get<long>(), "participant")));
}

std::string exclusions(const json& design) {
  const json& limits = design.at("rules").at("exclusions");
  std::string text = "## Exclusions\n\n";
  if (limits.empty()) return text + "None: the answers of all who save them are analysed.\n";
  text += "The answers of a participant are not analysed if\n\n";
  for (const ExclusionRule& rule : exclusion_rules()) {
    if (limits.contains(rule.key)) {
      text += fmt::format("* {},\n",
                          fmt::format(fmt::runtime(rule.words), limits[rule.key].get<double>()));
    }
  }
  text.replace(text.size() - 2, 2, ".\n");
  return text + "\nAnswers of practice do not count for these rules. Nobody else is left out.\n";
}

std::string analysis(const json& design, const Config& config) {
  const json& options = design.at("rules").at("analysis");
  std::string text = "## Analysis\n\n";
  const auto word = [&](const char* key) {
    const json& value = options.at(key);
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  const auto rate = [&](const char* key) {
    return options.at(key) == "free" ? std::string("estimated") : "fixed at " + word(key);
  };
  if (!config.graded.empty()) {
    text += fmt::format(
        "For each series a {} psychometric function is fitted by maximum likelihood, with guesses "
        "{} "
        "and lapses {}, and the participants' thresholds normally distributed; the threshold is "
        "where the function has {} of its height. Intervals are by profile likelihood and by {} "
        "simulated studies; fit by the deviance against these.",
        word("function"), rate("guess"), rate("lapse"), word("threshold_at"), word("bootstrap"));
  } else if (!config.methods.empty()) {
    text += fmt::format(
        "Methods are put on one scale ({}) by maximum likelihood with intervals; equal scales are "
        "tested by sign flips over participants ({} resamples), pairs of methods by Wald's test "
        "with Holm's correction.",
        word("scale") == "thurstone" ? "Thurstone's case V" : "Bradley and Terry's",
        word("bootstrap"));
  } else {
    text += fmt::format(
        "A preference over all demonstrations is tested by sign flips over participants, "
        "two-sided; "
        "each demonstration by the exact binomial test (where each participant answers once) or "
        "sign flips, with Holm's correction. Intervals are Wilson's of demonstrations that each "
        "participant answers once, and otherwise by {} resamples of participants.",
        word("bootstrap"));
  }
  return text + fmt::format(
                    " alpha = {}, seed of the analysis {}. `pinchlab analyse ANSWERS --out report` "
                    "does this, and names each deviation from this design.\n",
                    word("alpha"), word("seed"));
}

std::string stimuli(const json& design) {
  std::string text =
      "## Stimuli\n\nSHA-256 of the files; left and right: the side of the method under test, of "
      "the "
      "first method, of the reference, or in an attention check of the right answer.\n\n"
      "| | side | SHA-256 |\n|:--|:--|:--|\n";
  for (const auto& [name, files] : design.at("clips_sha256").items()) {
    for (const auto& [variant, hash] : files.items()) {
      text += fmt::format("| {} | {} | `{}` |\n", name, variant, hash.get<std::string>());
    }
  }
  return text;
}

}  // namespace

std::string preregistration(const json& design, const Config& config) {
  const std::string parts[] = {
      data_so_far(design), hypotheses(design, config), procedure(design, config),
      sample(design),      exclusions(design),         analysis(design, config),
      stimuli(design)};
  return fmt::format(
      "# Preregistration: {}\n\nWritten by `pinchlab study freeze` (Pinchlab {}) from the design "
      "whose SHA-256 is `{}`.\n\n{}",
      config.texts.at("title"), design.at("software_version").get<std::string>(),
      design.at("sha256").get<std::string>(), fmt::join(parts, "\n"));
}

}  // namespace pinchlab::study
