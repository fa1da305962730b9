// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/texts.h"

#include <fmt/format.h>

#include <vector>

#include "base/input_error.h"
#include "base/json_object.h"
#include "study/page_assets.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;
using Texts = std::map<std::string, std::string>;

constexpr std::size_t longest_text = 10000;  // bytes
constexpr const char* key_cure = "; study/README.md has the keys";

// Does the study ask for more than choices and two optional texts?
bool collects_more(const TextOptions& options) {
  return options.recruiting || options.questionnaires;
}

// Texts that only studies with an option have, by how their keys begin.
bool is_used(const std::string& key, const TextOptions& options) {
  const std::pair<const char*, bool> parts[] = {
      {"recruiting_", options.recruiting},
      {"questionnaire_", options.questionnaires},
      {"screen_", options.screen},
      {"graded_", options.graded},
      {"confidence_", options.confidence},
      {"click_", options.click_where},
      {"reason_", options.reason},
      {"collected_", collects_more(options)},
      {"language_", options.languages},
      {"responsible_controller", !options.controller.empty()},
      {"responsible_contact", !options.contact.empty()},
      {"responsible_version", !options.consent_version.empty()}};
  for (const auto& [beginning, is_on] : parts) {
    if (key.starts_with(beginning)) return is_on;
  }
  return true;
}

// What participants are told is kept must be what is kept.
void tell_what_is_kept(const json& own, const TextOptions& options, Texts& texts) {
  if (collects_more(options) && !own.contains("information_rights")) {
    texts["information_rights"] = texts.at("collected_rights");
  }
  if (options.screen) texts["information_rights"] += "\n\n" + texts.at("screen_rights");
  if (options.recruiting) texts["information_rights"] += "\n\n" + texts.at("recruiting_rights");
  const std::pair<const char*, std::string> responsible[] = {
      {"responsible_controller", options.controller},
      {"responsible_contact", options.contact},
      {"responsible_version", options.consent_version}};
  for (const auto& [key, name] : responsible) {
    if (name.empty()) continue;
    std::string text = texts.at(key);
    const std::size_t slot = text.find("{name}");
    if (slot == std::string::npos) {
      text.append(" ").append(name);
    } else {
      text.replace(slot, 6, name);
    }
    texts["information_rights"].append("\n\n").append(text);
  }
}

}  // namespace

Texts delivered_texts(const std::string& language) {
  const PageAsset* asset = find_asset("texts/" + language + ".json");
  return asset == nullptr ? Texts() : json::parse(asset->bytes).get<Texts>();
}

// Texts of a language that is not delivered must be complete: half a translation is worse than
// none.
Texts read_texts(const json& own, const std::string& file, const std::string& pointer,
                 const std::string& language, const TextOptions& options) {
  Texts texts = delivered_texts(language);
  const Texts english = delivered_texts("en");
  std::vector<std::string> known;
  known.reserve(english.size());
  for (const auto& [key, text] : english) {
    known.push_back(key);
  }
  JsonObject object(own, file, pointer);
  object.expect_only(known, key_cure);
  for (const std::string& key : object.all_keys()) {
    texts[key] = object.text(key, longest_text);
    if (texts[key].find_first_not_of(" \n") == std::string::npos) {
      object.fail(key, "is empty");
    }
  }
  std::erase_if(texts, [&](const auto& text) { return !is_used(text.first, options); });
  for (const std::string& key : known) {
    if (is_used(key, options) && !texts.contains(key)) {
      throw InputError(fmt::format("{}: {}", file, pointer),
                       fmt::format("no texts are delivered in the language `{}`, so all must be "
                                   "given; `{}` is missing (English: \"{}\")",
                                   language, key, english.at(key)));
    }
  }
  tell_what_is_kept(own, options, texts);
  return texts;
}

}  // namespace pinchlab::study
