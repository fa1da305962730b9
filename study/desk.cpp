// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/answer_file.h"
#include "base/counted.h"
#include "base/durable_file.h"
#include "base/sha256.h"
#include "study/adaptive.h"
#include "study/answers.h"
#include "study/secrets.h"
#include "study/utc.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// "<id>.<secret>"
std::pair<std::string, std::string> split(const std::string& token) {
  const std::size_t dot = token.find('.');
  const auto is_hex = [](const std::string& text, std::size_t length) {
    return text.size() == length && text.find_first_not_of("0123456789abcdef") == std::string::npos;
  };
  std::string id = token.substr(0, dot);
  std::string secret = dot == std::string::npos ? "" : token.substr(dot + 1);
  if (!is_hex(id, 16) || !is_hex(secret, 32)) {
    throw Refused(401, "no session");
  }
  return {std::move(id), std::move(secret)};
}

// A header that any bytes may stand in.
std::string printable(const std::string& text) {
  std::string clean = text.substr(0, 1000);
  std::ranges::replace_if(
      clean, [](char c) { return c < ' ' || c > '~'; }, '?');
  return clean;
}

// The clips of a trial; where its level is not chosen yet, of one of its series, in turn.
std::string any_clip_key(const Config& config, const PlannedTrial& trial, std::size_t turn) {
  if (!is_open(trial)) return clip_key(trial);
  const std::vector<double> levels = levels_of(config, trial.demonstration);
  return clip_key(GradedClip{trial.demonstration, levels[turn % levels.size()]});
}

}  // namespace

Desk::Desk(DeskOptions options) : options_(std::move(options)) {
  if (!options_.utc_now) {
    options_.utc_now = &utc_now;
  }
  if (!options_.steady_now) {
    options_.steady_now = &std::chrono::steady_clock::now;
  }
  if (!options_.tell) {
    options_.tell = [](const std::string&) {};
  }
  make_answers_folder(options_.answers);
  lock_.emplace(running_folder(options_.answers), in_use(options_.answers));
  sweep();
  shown_ = what_is_shown(options_.config, options_.clips);
  study_ = open_study_file(options_.answers, options_.config, shown_, options_.seed);
  read_finished();
  read_running();
  drop_idle();
}

std::string Desk::start(const std::string& link, const std::string& user_agent,
                        const std::string& address, const Recruited& recruited,
                        const std::string& language) {
  const Config& config = options_.config;
  if (!language.empty() && language != config.language && !config.translations.contains(language)) {
    throw Refused(422, "the study is not in this language");
  }
  if (options_.config.recruiting && recruited.participant.empty()) {
    throw Refused(403, "this study needs the id of the site that it recruits by");
  }
  drop_idle();
  free_withdrawn();
  make_room(link, address, recruited);
  const std::string secret = random_hex(16);
  auto entry = std::make_shared<Entry>();
  Session& session = entry->session;
  session.id = random_hex(8);
  session.secret_sha256 = sha256(secret);
  session.seed = study_.seed;
  if (options_.config.recruiting) session.recruited = recruited;
  session.language = language.empty() ? config.language : language;
  session.user_agent = printable(user_agent);
  session.started_utc = session.last_seen_utc = options_.utc_now();
  {
    const std::scoped_lock lock(mutex_);
    const auto unanswered = std::ranges::count_if(places_, [&](const auto& place) {
      return place.second.address == address && !place.second.has_answered;
    });
    if (places_.size() >= options_.most_open ||
        static_cast<std::size_t>(unanswered) >= options_.most_unanswered) {
      throw Refused(503, "too many participants at a time");
    }
    if (recruited_.contains(session.recruited.participant)) {
      throw Refused(410, "this id has a place already");
    }
    session.number = number_for(link);
    session.plan = make_plan(study_.seed, session.number, plan_options(options_.config));
    choose_level(session, options_.config);
    for (std::size_t i = 0; i < session.plan.size(); ++i) {
      session.media.push_back(random_hex(16));
    }
    // The number is taken before the disk is waited for, without holding up the others.
    take(session);
    starting_.insert(session.number);
  }
  try {
    write_durably(session_path(session.id), to_json(session).dump());
    const std::scoped_lock lock(mutex_);
    add(entry, address);
    starting_.erase(session.number);
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    starting_.erase(session.number);
    give_back(session);
    options_.tell(fmt::format("a participant could not start: {}", error.what()));
    throw Refused(503, "the disk does not take it");
  }
  options_.tell(fmt::format("{} started (number {})", session.id, session.number));
  return session.id + "." + secret;
}

std::shared_ptr<Desk::Entry> Desk::find(const std::string& token) {
  const auto [id, secret] = split(token);
  std::shared_ptr<Entry> entry;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = places_.find(id);
    if (found == places_.end()) {
      throw Refused(401, "no session");
    }
    entry = found->second.entry;
  }
  // The secret's hash never changes, so that it can be read without the entry's lock.
  if (!equal_in_constant_time(entry->session.secret_sha256, sha256(secret))) {
    throw Refused(401, "no session");
  }
  return entry;
}

// Applies to a copy, brings that to the disk, and only then counts it as done.
void Desk::change(const std::string& token, const std::function<void(Session&)>& apply) {
  const std::shared_ptr<Entry> entry = find(token);
  const std::scoped_lock lock(entry->mutex);
  if (entry->is_gone) {
    throw Refused(401, "no session");
  }
  Session next = entry->session;
  apply(next);
  next.last_seen_utc = options_.utc_now();
  try {
    write_durably(session_path(next.id), to_json(next).dump());
  } catch (const std::exception& error) {
    options_.tell(fmt::format("{}: not kept: {}", next.id, error.what()));
    throw Refused(507, "the disk does not take it");
  }
  entry->session.answers = std::move(next.answers);
  entry->session.plan = std::move(next.plan);
  entry->session.shown_utc = std::move(next.shown_utc);
  entry->session.questionnaires = std::move(next.questionnaires);
  entry->session.last_seen_utc = std::move(next.last_seen_utc);
  entry->session.resumed_count = next.resumed_count;
  const std::scoped_lock desk_lock(mutex_);
  note(entry->session);
  see(next.id);
  offer(entry->session, entry->session.answers.size());
}

Progress Desk::progress_of(const Session& session) const {
  Progress progress;
  for (std::size_t i = 0; i < session.plan.size(); ++i) {
    progress.trials.push_back({session.media[i], session.plan[i].kind == TrialKind::training});
  }
  progress.has_webm = std::ranges::all_of(session.plan, [&](const PlannedTrial& trial) {
    return options_.clips.at(any_clip_key(options_.config, trial, 0)).webm.has_value();
  });
  progress.is_adaptive = options_.config.adaptive_trials > 0;
  progress.language = session.language;
  progress.next = session.answers.size();
  progress.questionnaires = open_questionnaires(session, options_.config.questionnaires);
  return progress;
}

Progress Desk::progress(const std::string& token) {
  const std::shared_ptr<Entry> entry = find(token);
  const std::scoped_lock lock(entry->mutex);
  return progress_of(entry->session);
}

Progress Desk::resume(const std::string& token) {
  change(token, [](Session& session) { ++session.resumed_count; });
  options_.tell(fmt::format("{} resumed", split(token).first));
  return progress(token);
}

// Whoever has seen a clip has had the link's one session. Nobody but who uses up a link too waits
// for the disk here.
void Desk::use_up_link(std::uint64_t number) {
  if (!options_.config.one_time_links) return;
  const std::scoped_lock writing(links_mutex_);
  StudyFile next;
  {
    const std::scoped_lock lock(mutex_);
    if (study_.used_links.contains(number)) return;
    next = study_;
  }
  next.used_links.insert(number);
  try {
    write_study_file(options_.answers, options_.config, shown_, next);
    const std::scoped_lock lock(mutex_);
    study_.used_links.insert(number);
  } catch (const std::exception& error) {
    options_.tell(fmt::format("a link cannot be marked as used: {}", error.what()));
    throw Refused(507, "the disk does not take it");
  }
}

void Desk::show(const std::string& token, std::size_t index) {
  change(token, [&](Session& session) {
    const auto open = open_questionnaires(session, options_.config.questionnaires);
    if (!open.empty() && open.front() != "after") {
      throw Refused(409, "the questions before the trials are not answered");
    }
    study::show(session, index, options_.utc_now());
    use_up_link(session.number);
  });
}

void Desk::questionnaire(const std::string& token, const json& body) {
  change(token, [&](Session& session) {
    answer_questionnaire(session, options_.config.questionnaires, body);
  });
}

void Desk::answer(const std::string& token, const SentAnswer& sent) {
  change(token, [&](Session& session) {
    const PairFiles* files = nullptr;
    if (sent.index < session.plan.size() && !is_open(session.plan[sent.index])) {
      files = &options_.clips.at(clip_key(session.plan[sent.index]));
    }
    if (files != nullptr && sent.answer.encoding == Encoding::webm && !files->webm) {
      throw Refused(422, "request: /encoding: was not offered");
    }
    check_asked(sent.answer, options_.config.trial);
    study::answer(session, sent.index, sent.answer);
    choose_level(session, options_.config);
  });
}

void Desk::leave(const std::string& token) {
  const auto [id, secret] = split(token);
  const auto refuse_if_saved = [&, &id = id, &secret = secret] {
    if (!saved_code(id, secret).empty()) {
      throw Refused(409, "the answers are saved");
    }
  };
  std::shared_ptr<Entry> entry;
  try {
    entry = find(token);
  } catch (const Refused&) {
    refuse_if_saved();
    throw;
  }
  const std::scoped_lock entry_lock(entry->mutex);
  if (entry->is_gone) {
    return refuse_if_saved();
  }
  try {
    forget(id);
  } catch (const std::exception& error) {
    options_.tell(fmt::format("{}: cannot be removed: {}", id, error.what()));
    throw Refused(507, "the disk does not take it");
  }
  entry->is_gone = true;
  const std::scoped_lock lock(mutex_);
  remove(*entry);
  give_back(entry->session);
  ++left_;
  options_.tell(fmt::format("{} left after {} of {}; nothing is kept", id,
                            entry->session.answers.size(),
                            counted(entry->session.plan.size(), "trial")));
}

// The code of who has saved already; empty if that is not so.
std::string Desk::saved_code(const std::string& id, const std::string& secret) const {
  const fs::path path = answer_path(options_.answers, id);
  if (!fs::exists(path)) {
    return "";
  }
  const json file = read_answer_json(path);
  const std::string code = withdrawal_code(secret);
  const json kept = file.is_object() ? file.value("withdrawal_code_sha256", json()) : json();
  return kept.is_string() && equal_in_constant_time(kept.get<std::string>(), withdrawal_hash(code))
             ? code
             : "";
}

std::string Desk::save(const std::string& token,
                       const std::map<std::string, std::string>& free_text) {
  const auto [id, secret] = split(token);
  std::shared_ptr<Entry> entry;
  try {
    entry = find(token);
  } catch (const Refused&) {
    std::string code = saved_code(id, secret);
    if (code.empty()) {
      throw;
    }
    return code;
  }
  const std::scoped_lock entry_lock(entry->mutex);
  std::string code = withdrawal_code(secret);
  if (entry->is_gone) {
    return saved_code(id, secret) == code ? code : throw Refused(401, "no session");
  }
  if (is_finished(entry->session) &&
      !open_questionnaires(entry->session, options_.config.questionnaires).empty()) {
    throw Refused(409, "there are questions left to answer");
  }
  {
    const std::scoped_lock lock(mutex_);
    see(id);  // who waits for a disk that is full is not idle
  }
  const auto shown = [&](const PlannedTrial& trial, Encoding encoding) {
    const Clip& clip = options_.clips.at(clip_key(trial)).in(encoding).at(trial.pinch);
    return ShownFile{clip.name(), clip.sha256()};
  };
  const AnsweredStudy study{plan_options(options_.config), shown_, options_.config.graded_hit,
                            options_.config.is_pilot};
  const auto file = answer_file(entry->session, study, shown, free_text, options_.utc_now(),
                                withdrawal_hash(code));
  try {
    save_answers(answer_path(options_.answers, id), file);
  } catch (const std::exception& error) {
    options_.tell(fmt::format("{}: ANSWERS NOT SAVED: {}", id, error.what()));
    throw Refused(507, "the disk does not take it");
  }
  entry->is_gone = true;
  {
    const std::scoped_lock lock(mutex_);
    remove(*entry);
    finished_[id] = {entry->session.number, entry->session.recruited.participant};
  }
  options_.tell(fmt::format("{} finished; the answers are saved", id));
  try {
    remove_durably(session_path(id));
  } catch (const std::exception&) {
    options_.tell(fmt::format("{}: is still there, and will go at the next start",
                              session_path(id).string()));
  }
  return code;
}

const Clip* Desk::clip(const std::string& media, Encoding encoding) {
  const std::scoped_lock lock(mutex_);
  const auto found = media_.find(media);
  if (found == media_.end()) {
    return nullptr;
  }
  const auto& [files, side, participant] = found->second;
  see(participant);
  const bool is_there = encoding == Encoding::mp4 || files->webm;
  return is_there ? &files->in(encoding).at(side) : nullptr;
}

Overview Desk::overview() {
  free_withdrawn();
  std::vector<std::shared_ptr<Entry>> all;
  Overview overview;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, place] : places_) {
      all.push_back(place.entry);
    }
    overview.finished = finished_.size();
    overview.left = left_;
  }
  for (const auto& entry : all) {
    const std::scoped_lock lock(entry->mutex);
    const Session& session = entry->session;
    overview.running.push_back({session.id, session.number, session.answers.size(),
                                session.plan.size(), session.started_utc, session.last_seen_utc});
  }
  return overview;
}

std::pair<std::uint64_t, std::vector<PlannedTrial>> Desk::plan_of(const std::string& id) {
  std::shared_ptr<Entry> entry;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = places_.find(id);
    if (found == places_.end()) {
      throw Refused(404, "nobody of that name is running");
    }
    entry = found->second.entry;
  }
  const std::scoped_lock lock(entry->mutex);
  return {entry->session.number, entry->session.plan};
}

Progress Desk::preview(std::uint64_t number) {
  const std::vector<PlannedTrial> plan =
      make_plan(study_.seed, number, plan_options(options_.config));
  Progress progress;
  const std::scoped_lock lock(mutex_);
  std::erase_if(media_, [](const auto& entry) { return entry.second.participant.empty(); });
  for (const PlannedTrial& trial : plan) {
    const std::string media = random_hex(16);
    const std::string key =
        any_clip_key(options_.config, trial, static_cast<std::size_t>(trial.round));
    media_[media] = {&options_.clips.at(key), trial.pinch, ""};
    progress.trials.push_back({media, trial.kind == TrialKind::training});
  }
  return progress;
}

std::string Desk::withdraw(const std::string& code) {
  std::optional<std::string> withdrawn;
  try {
    withdrawn = study::withdraw(options_.answers, code);
  } catch (const std::invalid_argument&) {
    throw Refused(422, "is no withdrawal code");
  }
  if (!withdrawn) {
    throw Refused(404, "no answers have this code");
  }
  free_withdrawn();
  return *withdrawn;
}

fs::path Desk::session_path(const std::string& id) const {
  return running_folder(options_.answers) / (id + ".json");
}

}  // namespace pinchlab::study
