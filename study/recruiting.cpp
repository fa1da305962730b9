// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/recruiting.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

namespace pinchlab::study {
namespace {

using nlohmann::json;

constexpr std::size_t longest_id = 128, longest_parameter = 64, longest_url = 2000;  // bytes
constexpr const char* key_cure = "; study/README.md has the keys";

bool is_unreserved(char c) {
  return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || ('0' <= c && c <= '9') ||
         std::string_view("_.~-").find(c) != std::string_view::npos;
}

// What needs no quoting in an address, so that it is the same before and after.
std::string read_plain(JsonObject& object, const char* key, std::size_t longest) {
  std::string text = object.text(key, longest);
  if (text.empty() || !std::ranges::all_of(text, is_unreserved)) {
    object.fail(key, fmt::format("must be 1 to {} letters, digits, `_`, `.`, `~` or `-`", longest));
  }
  return text;
}

// The names in braces, which are the page's to fill in.
void check_slots(JsonObject& object, const char* key, const std::string& url,
                 const Recruiting& recruiting) {
  const std::array<std::pair<std::string_view, bool>, 3> slots = {
      {{"participant", true},
       {"study", !recruiting.study_parameter.empty()},
       {"session", !recruiting.session_parameter.empty()}}};
  for (std::size_t open = url.find_first_of("{}"); open != std::string::npos;
       open = url.find_first_of("{}", open + 1)) {
    const std::size_t close = url[open] == '{' ? url.find('}', open) : std::string::npos;
    const std::string_view name =
        close == std::string::npos ? "" : std::string_view(url).substr(open + 1, close - open - 1);
    const auto found = std::ranges::find(slots, name, [](const auto& slot) { return slot.first; });
    if (found == slots.end() || !found->second) {
      object.fail(key,
                  "can hold {participant}, and {study} and {session} where their parameters are "
                  "named, and no other braces");
    }
    open = close;
  }
}

std::string read_url(JsonObject& object, const char* key, const Recruiting& recruiting) {
  if (!object.has(key)) return "";
  constexpr std::string_view scheme = "https://";
  std::string url = object.text(key, longest_url);
  const bool is_printable = std::ranges::all_of(url, [](char c) {
    return '!' <= c && c <= '~' && std::string_view("\"<>\\^`|").find(c) == std::string_view::npos;
  });
  const std::string host =
      url.starts_with(scheme)
          ? url.substr(scheme.size(), url.find_first_of("/?#", scheme.size()) - scheme.size())
          : "";
  const bool is_host = !host.empty() && std::ranges::all_of(host, [](char c) {
    return is_unreserved(c) || c == ':';
  });
  if (!is_printable || !is_host) {
    object.fail(key, "must be an address such as https://app.example.org/done?id={participant}");
  }
  check_slots(object, key, url, recruiting);
  return url;
}

void read_parameters(JsonObject& object, Recruiting& recruiting) {
  const std::string preset =
      object.has("preset") ? object.choice("preset", {"prolific", "sona"}) : "";
  if (preset == "prolific") {
    recruiting.participant_parameter = "PROLIFIC_PID";
    recruiting.study_parameter = "STUDY_ID";
    recruiting.session_parameter = "SESSION_ID";
  } else if (preset == "sona") {
    recruiting.participant_parameter = "survey_code";
  }
  std::vector<std::string> names;
  for (const auto& [key, parameter] :
       {std::pair{"participant_parameter", &recruiting.participant_parameter},
        std::pair{"study_parameter", &recruiting.study_parameter},
        std::pair{"session_parameter", &recruiting.session_parameter}}) {
    if (object.has(key)) *parameter = read_plain(object, key, longest_parameter);
    if (parameter->empty()) continue;
    if (*parameter == "link" || std::ranges::find(names, *parameter) != names.end()) {
      object.fail(key, fmt::format("`{}` has another meaning already", *parameter));
    }
    names.push_back(*parameter);
  }
  if (recruiting.participant_parameter.empty()) {
    object.fail("participant_parameter",
                "is missing: name the parameter with the participant's id, or a preset "
                "(\"prolific\", \"sona\")");
  }
}

}  // namespace

Recruiting read_recruiting(JsonObject object) {
  object.expect_only(
      {"preset", "participant_parameter", "study_parameter", "session_parameter", "completion_url",
       "completion_code", "declined_url", "screen_out_url", "full_url"},
      key_cure);
  Recruiting recruiting;
  read_parameters(object, recruiting);
  recruiting.completion_url = read_url(object, "completion_url", recruiting);
  recruiting.declined_url = read_url(object, "declined_url", recruiting);
  recruiting.screen_out_url = read_url(object, "screen_out_url", recruiting);
  recruiting.full_url = read_url(object, "full_url", recruiting);
  if (object.has("completion_code")) {
    recruiting.completion_code = read_plain(object, "completion_code", longest_id);
  }
  return recruiting;
}

Recruited read_recruited(JsonObject object) {
  Recruited recruited;
  recruited.participant = read_plain(object, "participant", longest_id);
  if (object.has("study")) recruited.study = read_plain(object, "study", longest_id);
  if (object.has("session")) recruited.session = read_plain(object, "session", longest_id);
  object.finish();
  return recruited;
}

json to_json(const Recruited& recruited) {
  json object = {{"participant", recruited.participant}};
  if (!recruited.study.empty()) object["study"] = recruited.study;
  if (!recruited.session.empty()) object["session"] = recruited.session;
  return object;
}

json for_page(const Recruiting& recruiting) {
  json parameters = {{"participant", recruiting.participant_parameter}};
  if (!recruiting.study_parameter.empty()) parameters["study"] = recruiting.study_parameter;
  if (!recruiting.session_parameter.empty()) parameters["session"] = recruiting.session_parameter;
  json page = {{"parameters", parameters}};
  for (const auto& [key, url] : {std::pair{"declined_url", &recruiting.declined_url},
                                 {"screen_out_url", &recruiting.screen_out_url},
                                 {"full_url", &recruiting.full_url}}) {
    if (!url->empty()) page[key] = *url;
  }
  return page;
}

json completion(const Recruiting& recruiting) {
  json object;
  if (!recruiting.completion_url.empty()) object["url"] = recruiting.completion_url;
  if (!recruiting.completion_code.empty()) object["code"] = recruiting.completion_code;
  return object;
}

}  // namespace pinchlab::study
