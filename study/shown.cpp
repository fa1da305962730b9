// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/shown.h"

#include "base/sha256.h"

namespace pinchlab::study {

using nlohmann::json;

namespace {

// What participants are asked besides the choices; empty where that is nothing.
json options_of(const Config& config) {
  json options = json::object();
  if (!config.questionnaires.empty()) options["questionnaires"] = to_json(config.questionnaires);
  if (config.trial != TrialOptions()) options["trials"] = to_json(config.trial);
  return options;
}

}  // namespace

json what_is_shown(const Config& config, const Clips& clips) {
  json consent = json::object();
  for (const char* key : {"information_heading", "information_body", "information_rights",
                          "information_questions", "consent"}) {
    consent[key] = config.texts.at(key);
  }
  json files = json::object();
  for (const auto& [name, pair] : clips) {
    files[name] = {pair.mp4.left->sha256(), pair.mp4.right->sha256()};
  }
  json shown = {{"language", config.language},
                {"question", config.texts.at("question")},
                {"consent_sha256", sha256(consent.dump())},
                {"texts_sha256", sha256(json(config.texts).dump())},
                {"clips_sha256", sha256(files.dump())}};
  if (const json options = options_of(config); !options.empty()) {
    shown["options_sha256"] = sha256(options.dump());
  }
  return shown;
}

std::string difference(const json& one, const json& other) {
  const std::pair<const char*, const char*> parts[] = {{"language", "the language"},
                                                       {"question", "the question"},
                                                       {"consent_sha256", "the consent text"},
                                                       {"clips_sha256", "the clips"},
                                                       {"options_sha256", "what is asked besides"},
                                                       {"texts_sha256", "a text of the page"}};
  std::string words;
  for (const auto& [key, what] : parts) {
    const bool is_other = one.value(key, json()) != other.value(key, json());
    // A text that has its own name is not told twice.
    if (is_other && (words.empty() || std::string(key) != "texts_sha256")) {
      words += (words.empty() ? "" : ", ") + std::string(what);
    }
  }
  return words;
}

}  // namespace pinchlab::study
