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

json consent_of(const std::map<std::string, std::string>& texts) {
  json consent = json::object();
  for (const char* key : {"information_heading", "information_body", "information_rights",
                          "information_questions", "consent"}) {
    consent[key] = texts.at(key);
  }
  return consent;
}

}  // namespace

json what_is_shown(const Config& config, const Clips& clips) {
  std::string languages = config.language, questions = config.texts.at("question");
  json consent = consent_of(config.texts), texts = config.texts;
  if (!config.translations.empty()) {
    consent = {{config.language, consent}};
    texts = {{config.language, texts}};
  }
  for (const auto& [language, translated] : config.translations) {
    languages += ", " + language;
    questions += " / " + translated.at("question");
    consent[language] = consent_of(translated);
    texts[language] = translated;
  }
  json files = json::object();
  for (const auto& [name, pair] : clips) {
    files[name] = {pair.mp4.left->sha256(), pair.mp4.right->sha256()};
  }
  json shown = {{"language", languages},
                {"question", questions},
                {"consent_sha256", sha256(consent.dump())},
                {"texts_sha256", sha256(texts.dump())},
                {"clips_sha256", sha256(files.dump())}};
  if (!config.consent_version.empty()) shown["consent_version"] = config.consent_version;
  if (const json options = options_of(config); !options.empty()) {
    shown["options_sha256"] = sha256(options.dump());
  }
  return shown;
}

std::string difference(const json& one, const json& other) {
  const std::pair<const char*, const char*> parts[] = {{"language", "the language"},
                                                       {"question", "the question"},
                                                       {"consent_version", "the consent's version"},
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
