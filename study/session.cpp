// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/session.h"

#include <fmt/format.h>

#include "base/input_error.h"
#include "base/json_object.h"
#include "base/told_trial.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::size_t longest_free_text = 20000;  // bytes
constexpr std::size_t longest_error = 500;        // bytes
constexpr long most_counted = 1000000;
constexpr long most_frames = 1000000000;
constexpr long most_pixels = 100000;

Side side_from(const std::string& word) {
  return word == "left" ? Side::left : Side::right;
}

TrialKind kind_from(const std::string& word) {
  return word == "main"       ? TrialKind::main
         : word == "training" ? TrialKind::training
                              : TrialKind::attention;
}

int whole(JsonObject& object, const char* key, long high) {
  return static_cast<int>(object.whole(key, 0, high));
}

// A browser may round its clock, so that a gap is a little less than nothing.
std::optional<double> optional_seconds(JsonObject& object, const char* key) {
  return object.has(key) ? std::optional(object.number(key, -1, 86400)) : std::nullopt;
}

std::string word_of(std::optional<Side> choice) {
  return choice ? to_string(*choice) : "tie";
}

void read_besides(JsonObject& object, TrialAnswer& answer) {
  if (object.has("confidence")) {
    answer.confidence = static_cast<int>(object.whole("confidence", 1, 9));
  }
  if (object.has("reason")) {
    answer.reason = object.text("reason", std::size_t{4} * longest_reason);
    if (answer.reason.empty()) object.fail("reason", "is empty; leave it out");
  }
  if (!object.has("where_side")) return;  // then the rest of a place is unknown too
  answer.where = Where{side_from(object.choice("where_side", {"left", "right"})),
                       object.number("where_x", 0, 1), object.number("where_y", 0, 1),
                       object.number("where_time_s", 0, 86400)};
}

// The answer proper, without what goes around it; used for requests and for session files.
TrialAnswer read_answer(JsonObject& object) {
  TrialAnswer answer;
  const ToldChoice told = read_choice(object);
  if (told.word != "tie") answer.choice = side_from(told.word);
  answer.preference = told.preference;
  read_besides(object, answer);
  answer.reaction_time_s = object.number("reaction_time_s", 0, 86400);
  answer.loops_watched = whole(object, "loops_watched", most_counted);
  answer.focus_lost_count = whole(object, "focus_lost_count", most_counted);
  answer.frame_count = whole(object, "frame_count", most_frames);
  answer.dropped_frames = whole(object, "dropped_frames", most_frames);
  check_frames(object, answer.frame_count, answer.dropped_frames);
  answer.loop_gap_median_s = optional_seconds(object, "loop_gap_median_s");
  answer.loop_gap_max_s = optional_seconds(object, "loop_gap_max_s");
  for (const json& entry : object.array("playback_errors", 100)) {
    if (!entry.is_string() || entry.get_ref<const std::string&>().size() > longest_error) {
      object.fail("playback_errors", "must hold short strings");
    }
    answer.playback_errors.push_back(entry.get<std::string>());
  }
  answer.input = object.choice("input", {"mouse", "keyboard", "touch"});
  answer.encoding =
      object.choice("encoding", {"mp4", "webm"}) == "mp4" ? Encoding::mp4 : Encoding::webm;
  answer.window_width_px = whole(object, "window_width_px", most_pixels);
  answer.window_height_px = whole(object, "window_height_px", most_pixels);
  answer.clip_width_px = whole(object, "clip_width_px", most_pixels);
  answer.clip_height_px = whole(object, "clip_height_px", most_pixels);
  answer.screen_width_px = whole(object, "screen_width_px", most_pixels);
  answer.screen_height_px = whole(object, "screen_height_px", most_pixels);
  answer.device_pixel_ratio = object.number("device_pixel_ratio", 0.01, 100);
  return answer;
}

template <class Read>
auto refusing(const Read& read) {
  try {
    return read();
  } catch (const InputError& error) {
    throw Refused(422, error.what());
  }
}

void read_plan(const json& plan, const std::string& file, Session& session) {
  for (std::size_t i = 0; i < plan.size(); ++i) {
    JsonObject object(plan[i], file, fmt::format("/plan/{}", i));
    PlannedTrial trial{kind_from(object.choice("kind", {"main", "training", "attention"})),
                       object.name("demonstration"),
                       side_from(object.choice("pinch", {"left", "right"})),
                       static_cast<int>(object.whole("round", 0, 1000))};
    if (object.has("first")) trial.first = object.name("first");
    if (object.has("second")) trial.second = object.name("second");
    if (object.has("level")) trial.level = object.number("level", -1e9, 1e9);
    session.plan.push_back(std::move(trial));
    session.media.push_back(object.name("media"));
    object.finish();
  }
}

}  // namespace

bool is_finished(const Session& session) {
  return session.answers.size() == session.plan.size();
}

void show(Session& session, std::size_t index, const std::string& utc) {
  if (is_finished(session) || index != session.answers.size()) {
    throw Refused(409, fmt::format("trial {} is not the next one", index));
  }
  session.shown_utc = utc;
}

void answer(Session& session, std::size_t index, const TrialAnswer& given) {
  if (index + 1 == session.answers.size() && session.answers[index].answer == given) {
    return;  // sent again, because the confirmation was lost
  }
  if (is_finished(session) || index != session.answers.size() || session.shown_utc.empty()) {
    throw Refused(409, fmt::format("trial {} is not being shown", index));
  }
  session.answers.push_back({session.shown_utc, given});
  session.shown_utc.clear();
}

std::vector<std::string> open_questionnaires(const Session& session, const Questionnaires& asked) {
  std::vector<std::string> open;
  for (const char* part : questionnaire_parts) {
    if (asked.find(part) != nullptr && !session.questionnaires.contains(part)) {
      open.emplace_back(part);
    }
  }
  return open;
}

void answer_questionnaire(Session& session, const Questionnaires& asked, const json& body) {
  const auto [part, answers] = refusing([&] {
    JsonObject object(body, "request", "");
    std::string name =
        object.choice("part", {questionnaire_parts.begin(), questionnaire_parts.end()});
    const Questionnaire* questionnaire = asked.find(name);
    if (questionnaire == nullptr) object.fail("part", "this study has no such questionnaire");
    json checked = check_answers(*questionnaire, object.object("answers"));
    object.finish();
    return std::pair(std::move(name), std::move(checked));
  });
  const auto before = session.questionnaires.find(part);
  if (before != session.questionnaires.end() && before->second == answers) return;  // sent again
  const bool is_due =
      part == "after" ? is_finished(session) : session.answers.empty() && session.shown_utc.empty();
  if (!is_due || before != session.questionnaires.end()) {
    throw Refused(409, "these questions are not being asked");
  }
  session.questionnaires[part] = answers;
}

SentAnswer parse_answer(const json& body) {
  return refusing([&] {
    JsonObject object(body, "request", "");
    SentAnswer sent;
    sent.index = static_cast<std::size_t>(object.whole("index", 0, 100000));
    sent.answer = read_answer(object);
    object.finish();
    return sent;
  });
}

void check_asked(const TrialAnswer& answer, const TrialOptions& options) {
  const auto refuse = [](const char* key, const char* why) {
    throw Refused(422, std::string("request: /") + key + ": " + why);
  };
  if (answer.preference.has_value() != options.is_graded) {
    refuse("preference", options.is_graded ? "is missing" : "was not asked");
  }
  if (answer.confidence.has_value() != (options.confidence > 0)) {
    refuse("confidence", options.confidence > 0 ? "is missing" : "was not asked");
  }
  if (answer.confidence && *answer.confidence > options.confidence) {
    refuse("confidence", "is beyond the scale");
  }
  constexpr std::size_t bytes_a_character = 4;
  if (answer.reason.size() > bytes_a_character * static_cast<std::size_t>(options.reason)) {
    refuse("reason", options.reason > 0 ? "is too long" : "was not asked");
  }
  if (answer.where && !options.click_where) refuse("where_side", "was not asked");
}

std::map<std::string, std::string> parse_free_text(const json& body) {
  return refusing([&] {
    JsonObject object(body, "request", "");
    JsonObject texts = object.object("free_text");
    std::map<std::string, std::string> result;
    for (const char* question : {"common_details", "thoughts"}) {
      if (texts.has(question)) {
        result[question] = texts.text(question, longest_free_text);
      }
    }
    texts.finish();
    object.finish();
    return result;
  });
}

Recruited parse_recruited(const json& body) {
  if (!body.contains("recruited")) return {};
  return refusing(
      [&] { return read_recruited(JsonObject(body["recruited"], "request", "/recruited")); });
}

ordered_json to_json(const TrialAnswer& answer) {
  ordered_json object = {
      {"choice", word_of(answer.choice)},      {"reaction_time_s", answer.reaction_time_s},
      {"loops_watched", answer.loops_watched}, {"focus_lost_count", answer.focus_lost_count},
      {"frame_count", answer.frame_count},     {"dropped_frames", answer.dropped_frames}};
  if (answer.loop_gap_median_s) object["loop_gap_median_s"] = *answer.loop_gap_median_s;
  if (answer.loop_gap_max_s) object["loop_gap_max_s"] = *answer.loop_gap_max_s;
  object.update({{"playback_errors", answer.playback_errors},
                 {"input", answer.input},
                 {"encoding", to_string(answer.encoding)},
                 {"window_width_px", answer.window_width_px},
                 {"window_height_px", answer.window_height_px},
                 {"clip_width_px", answer.clip_width_px},
                 {"clip_height_px", answer.clip_height_px},
                 {"screen_width_px", answer.screen_width_px},
                 {"screen_height_px", answer.screen_height_px},
                 {"device_pixel_ratio", answer.device_pixel_ratio}});
  if (answer.preference) object["preference"] = *answer.preference;
  if (answer.confidence) object["confidence"] = *answer.confidence;
  if (!answer.reason.empty()) object["reason"] = answer.reason;
  if (answer.where) {
    object.update({{"where_side", to_string(answer.where->side)},
                   {"where_x", answer.where->x},
                   {"where_y", answer.where->y},
                   {"where_time_s", answer.where->time_s}});
  }
  return object;
}

json to_json(const PlannedTrial& trial, const std::string& media) {
  json object = {{"kind", to_string(trial.kind)},
                 {"demonstration", trial.demonstration},
                 {"pinch", to_string(trial.pinch)},
                 {"round", trial.round},
                 {"media", media}};
  if (clip_key(trial) != trial.demonstration) {
    object["first"] = trial.first;
    object["second"] = trial.second;
  }
  if (trial.level) object["level"] = *trial.level;
  return object;
}

json to_json(const Session& session) {
  json plan = json::array();
  for (std::size_t i = 0; i < session.plan.size(); ++i) {
    plan.push_back(to_json(session.plan[i], session.media[i]));
  }
  json answers = json::array();
  for (const AnsweredTrial& trial : session.answers) {
    answers.push_back(json(to_json(trial.answer)));
    answers.back()["shown_utc"] = trial.shown_utc;
  }
  json file = {{"format", "pinchlab-session 1"},
               {"id", session.id},
               {"secret_sha256", session.secret_sha256},
               {"number", session.number},
               {"seed", session.seed},
               {"language", session.language},
               {"user_agent", session.user_agent},
               {"started_utc", session.started_utc},
               {"last_seen_utc", session.last_seen_utc},
               {"resumed_count", session.resumed_count},
               {"shown_utc", session.shown_utc},
               {"plan", plan},
               {"answers", answers}};
  if (!session.questionnaires.empty()) file["questionnaires"] = session.questionnaires;
  if (!session.recruited.participant.empty()) file["recruited"] = to_json(session.recruited);
  return file;
}

Session session_from_json(const json& document) {
  const std::string file = "session";
  JsonObject object(document, file, "");
  object.choice("format", {"pinchlab-session 1"});
  Session session;
  session.id = object.name("id");
  session.secret_sha256 = object.sha256("secret_sha256");
  session.number = static_cast<std::uint64_t>(object.whole("number", 0, 1000000000));
  session.seed =
      static_cast<std::uint64_t>(object.whole("seed", 0, static_cast<long>(largest_seed)));
  if (object.has("recruited")) session.recruited = read_recruited(object.object("recruited"));
  session.language = object.text("language", 64);
  session.user_agent = object.text("user_agent", 4096);
  session.started_utc = object.utc("started_utc");
  session.last_seen_utc = object.utc("last_seen_utc");
  session.resumed_count = whole(object, "resumed_count", most_counted);
  session.shown_utc = object.text("shown_utc", 64);
  read_plan(object.array("plan", 100000), file, session);
  const json& answers = object.array("answers", session.plan.size());
  for (std::size_t i = 0; i < answers.size(); ++i) {
    JsonObject trial(answers[i], file, fmt::format("/answers/{}", i));
    session.answers.push_back({trial.utc("shown_utc"), read_answer(trial)});
    trial.finish();
  }
  if (object.has("questionnaires")) {
    JsonObject questionnaires = object.object("questionnaires");
    for (const char* part : questionnaire_parts) {
      if (questionnaires.has(part)) session.questionnaires[part] = questionnaires.need(part);
    }
    questionnaires.finish();
  }
  object.finish();
  return session;
}

}  // namespace pinchlab::study
