// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/desk.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/durable_file.h"
#include "base/input_error.h"
#include "base/partial_file.h"
#include "base/sha256.h"
#include "base/strict_json.h"
#include "study/answers.h"
#include "study/secrets.h"
#include "study/utc.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t largest_file = 16U << 20U;       // bytes
constexpr std::chrono::minutes longest_unanswered{5};  // without a sign, where places are short

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

}  // namespace

Desk::Desk(DeskOptions options) : options_(std::move(options)) {
  if (!options_.utc_now) {
    options_.utc_now = &utc_now;
  }
  if (!options_.tell) {
    options_.tell = [](const std::string&) {};
  }
  std::error_code problem;
  fs::create_directories(running_folder(options_.answers), problem);
  if (problem) {
    throw std::runtime_error(fmt::format("{}: cannot be made: {}; use another --answers",
                                         options_.answers.string(), problem.message()));
  }
  lock_.emplace(running_folder(options_.answers),
                fmt::format("{}: another server is using this folder; stop it or use another "
                            "--answers",
                            options_.answers.string()));
  sweep();
  shown_ = what_is_shown(options_.config, options_.clips);
  study_ = open_study_file(options_.answers, options_.config, shown_, options_.seed);
  read_finished();
  read_running();
}

void Desk::read_finished() {
  for (const fs::path& path : answer_files(options_.answers)) {
    const json file = read_json_file(path, largest_file);
    if (!file.is_object() || file.value("format", json()) != "pinchlab-answers") {
      throw std::runtime_error(
          fmt::format("{}: is no answer file; keep other files elsewhere", path.string()));
    }
    if (file.value("study", json()) != shown_) {
      throw std::runtime_error(
          fmt::format("{}: was answered in a study that asked or showed something else; use its "
                      "configuration and clips, or another --answers",
                      path.string()));
    }
    if (file.value("participant_number", json()).is_number_unsigned()) {
      taken_.insert(file["participant_number"].get<std::uint64_t>());
    }
    ++finished_;
  }
}

void Desk::read_running() {
  for (const fs::directory_entry& file : fs::directory_iterator(running_folder(options_.answers))) {
    const fs::path& path = file.path();
    if (path.extension() != ".json" || path.filename() == "study.json") {
      continue;
    }
    auto entry = std::make_shared<Entry>();
    try {
      entry->session = session_from_json(read_json_file(path, largest_file));
    } catch (const InputError& error) {
      throw std::runtime_error(
          fmt::format("{}: {}; remove the file to go on without this participant", path.string(),
                      error.what()));
    }
    // Killed between saving the answers and forgetting the session.
    if (fs::exists(answer_path(options_.answers, entry->session.id))) {
      remove_durably(path);
      continue;
    }
    add(entry, "");
  }
}

// What a killed server left half written is nobody's answer; it may hold what somebody wrote.
void Desk::sweep() const {
  for (const fs::path& folder : {options_.answers, running_folder(options_.answers)}) {
    std::vector<fs::path> partial;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
      if (file.path().filename().string().ends_with(".json" + std::string(partial_ending))) {
        partial.push_back(file.path());
      }
    }
    std::ranges::for_each(partial, remove_durably);
  }
}

void Desk::add(const std::shared_ptr<Entry>& entry, const std::string& address) {
  const Session& session = entry->session;
  for (std::size_t i = 0; i < session.plan.size(); ++i) {
    const auto files = options_.clips.find(session.plan[i].demonstration);
    if (files == options_.clips.end()) {
      throw std::runtime_error(fmt::format("{}: no clips of `{}`",
                                           session_path(session.id).string(),
                                           session.plan[i].demonstration));
    }
    media_[session.media[i]] = {&files->second, session.plan[i].pinch, session.id};
  }
  taken_.insert(session.number);
  places_[session.id] = {entry, address, ++starts_, {}, false, false};
  note(session);
}

// Under mutex_.
void Desk::note(const Session& session) {
  const auto place = places_.find(session.id);
  if (place != places_.end()) {
    place->second.seen = parse_utc(session.last_seen_utc);
    place->second.has_answered = !session.answers.empty();
    place->second.is_shown = place->second.has_answered || !session.shown_utc.empty();
  }
}

void Desk::remove(const Entry& entry) {
  for (const std::string& media : entry.session.media) {
    media_.erase(media);
  }
  places_.erase(entry.session.id);
}

// All that the disk holds of somebody who has not saved, half written files among it.
void Desk::forget(const std::string& id) const {
  const fs::path answers = answer_path(options_.answers, id);
  for (const fs::path& path : {answers, session_path(id)}) {
    const fs::path partial = path.string() + std::string(partial_ending);
    if (fs::exists(partial)) {
      remove_durably(partial);
    }
  }
  remove_durably(session_path(id));
}

// Nothing is kept of somebody who does not come back, and the number goes to somebody else.
void Desk::drop(const std::shared_ptr<Entry>& entry, const std::string& why,
                bool only_without_answers) {
  const std::scoped_lock entry_lock(entry->mutex);
  if (entry->is_gone || (only_without_answers && !entry->session.answers.empty())) {
    return;
  }
  forget(entry->session.id);
  entry->is_gone = true;
  const std::scoped_lock lock(mutex_);
  remove(*entry);
  taken_.erase(entry->session.number);
  ++left_;
  options_.tell(fmt::format("{} {}; nothing is kept", entry->session.id, why));
}

void Desk::drop_idle() {
  const auto now = parse_utc(options_.utc_now());
  std::vector<std::shared_ptr<Entry>> idle;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, place] : places_) {
      if (now - place.seen >= options_.longest_idle) {
        idle.push_back(place.entry);
      }
    }
  }
  for (const auto& entry : idle) {
    drop(entry, "was not seen for too long and is dropped");
  }
}

void Desk::release(const std::string& id) {
  std::shared_ptr<Entry> entry;
  {
    const std::scoped_lock lock(mutex_);
    const auto found = places_.find(id);
    if (found == places_.end()) {
      throw Refused(404, "nobody of that name is running");
    }
    entry = found->second.entry;
  }
  drop(entry, "was released by the researcher");
}

// Who has to go for somebody that starts from `address`; nullptr: nobody has to, or nobody can.
std::shared_ptr<Desk::Entry> Desk::who_makes_room(const std::string& link,
                                                  const std::string& address) {
  const auto now = parse_utc(options_.utc_now());
  const std::scoped_lock lock(mutex_);
  std::map<std::string, std::size_t> unanswered;  // by address
  for (const auto& [id, place] : places_) {
    if (!place.has_answered) {
      ++unanswered[place.address];
    }
  }
  const auto oldest = [&](const auto& may_go) {
    const Place* found = nullptr;
    for (const auto& [id, place] : places_) {
      const bool is_older = found == nullptr || place.order < found->order;
      if (!place.has_answered && is_older && may_go(place)) {
        found = &place;
      }
    }
    return found == nullptr ? nullptr : found->entry;
  };
  const auto is_away = [&](const Place& place) { return now - place.seen >= longest_unanswered; };
  if (options_.config.one_time_links) {
    return oldest([&](const Place& place) {
      return !place.is_shown && equal_in_constant_time(link, link_of(place.entry->session.number));
    });
  }
  if (unanswered[address] >= options_.most_unanswered) {
    return oldest([&](const Place& place) { return place.address == address && is_away(place); });
  }
  const auto limit = static_cast<std::size_t>(options_.config.participant_limit);
  const bool is_full =
      places_.size() >= options_.most_open || (limit > 0 && taken_.size() >= limit);
  if (!is_full) {
    return nullptr;
  }
  const auto busiest =
      std::ranges::max_element(unanswered, {}, [](const auto& entry) { return entry.second; });
  if (busiest->second > unanswered[address] + 1) {
    return oldest([&](const Place& place) { return place.address == busiest->first; });
  }
  return oldest(is_away);
}

std::string Desk::link_of(std::uint64_t number) const {
  return sha256(fmt::format("link {} {}", study_.link_secret, number)).substr(0, 32);
}

std::vector<std::string> Desk::links() const {
  std::vector<std::string> links;
  if (options_.config.one_time_links) {
    for (int i = 0; i < options_.config.participant_limit; ++i) {
      links.push_back(link_of(static_cast<std::uint64_t>(i)));
    }
  }
  return links;
}

// The smallest number that nobody has, or the link's. Under mutex_.
std::uint64_t Desk::number_for(const std::string& link) {
  const auto limit = static_cast<std::uint64_t>(options_.config.participant_limit);
  if (options_.config.one_time_links) {
    for (std::uint64_t number = 0; number < limit; ++number) {
      if (equal_in_constant_time(link, link_of(number))) {
        if (taken_.contains(number) || study_.used_links.contains(number)) {
          throw Refused(403, "this link was used");
        }
        return number;
      }
    }
    throw Refused(403, "this study needs a link");
  }
  std::uint64_t number = 0;
  while (taken_.contains(number)) {
    ++number;
  }
  if (limit > 0 && number >= limit) {
    throw Refused(409, "the study is full");
  }
  return number;
}

std::string Desk::start(const std::string& link, const std::string& user_agent,
                        const std::string& address) {
  try {
    drop_idle();
    if (const auto entry = who_makes_room(link, address)) {
      drop(entry, "had answered nothing and made room", true);
    }
  } catch (const std::exception& error) {
    options_.tell(fmt::format("a place cannot be released: {}", error.what()));
    throw Refused(503, "the disk does not take it");
  }
  const std::string secret = random_hex(16);
  auto entry = std::make_shared<Entry>();
  Session& session = entry->session;
  session.id = random_hex(8);
  session.secret_sha256 = sha256(secret);
  session.seed = study_.seed;
  session.language = options_.config.language;
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
    session.number = number_for(link);
    session.plan = make_plan(study_.seed, session.number, plan_options(options_.config));
    for (std::size_t i = 0; i < session.plan.size(); ++i) {
      session.media.push_back(random_hex(16));
    }
    // The number is taken before the disk is waited for, without holding up the others.
    taken_.insert(session.number);
  }
  try {
    write_durably(session_path(session.id), to_json(session).dump());
    const std::scoped_lock lock(mutex_);
    add(entry, address);
  } catch (const std::exception& error) {
    const std::scoped_lock lock(mutex_);
    taken_.erase(session.number);
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
  entry->session.shown_utc = std::move(next.shown_utc);
  entry->session.last_seen_utc = std::move(next.last_seen_utc);
  entry->session.resumed_count = next.resumed_count;
  const std::scoped_lock desk_lock(mutex_);
  note(entry->session);
}

Progress Desk::progress_of(const Session& session) const {
  Progress progress;
  for (std::size_t i = 0; i < session.plan.size(); ++i) {
    progress.trials.push_back({session.media[i], session.plan[i].kind == TrialKind::training});
  }
  progress.has_webm = std::ranges::all_of(session.plan, [&](const PlannedTrial& trial) {
    return options_.clips.at(trial.demonstration).webm.has_value();
  });
  progress.next = session.answers.size();
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

// Whoever has seen a clip has had the link's one session.
void Desk::use_up_link(const std::string& token) {
  const std::uint64_t number = find(token)->session.number;
  const std::scoped_lock lock(mutex_);
  if (!options_.config.one_time_links || !study_.used_links.insert(number).second) {
    return;
  }
  try {
    write_study_file(options_.answers, options_.config, shown_, study_);
  } catch (const std::exception& error) {
    study_.used_links.erase(number);
    options_.tell(fmt::format("a link cannot be marked as used: {}", error.what()));
    throw Refused(507, "the disk does not take it");
  }
}

void Desk::show(const std::string& token, std::size_t index) {
  use_up_link(token);
  change(token, [&](Session& session) { study::show(session, index, options_.utc_now()); });
}

void Desk::answer(const std::string& token, const SentAnswer& sent) {
  change(token, [&](Session& session) {
    const PairFiles* files = nullptr;
    if (sent.index < session.plan.size()) {
      files = &options_.clips.at(session.plan[sent.index].demonstration);
    }
    if (files != nullptr && sent.answer.encoding == Encoding::webm && !files->webm) {
      throw Refused(422, "request: /encoding: was not offered");
    }
    study::answer(session, sent.index, sent.answer);
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
  taken_.erase(entry->session.number);
  ++left_;
  options_.tell(fmt::format("{} left after {} of {} trials; nothing is kept", id,
                            entry->session.answers.size(), entry->session.plan.size()));
}

// The code of who has saved already; empty if that is not so.
std::string Desk::saved_code(const std::string& id, const std::string& secret) const {
  const fs::path path = answer_path(options_.answers, id);
  if (!fs::exists(path)) {
    return "";
  }
  const json file = read_json_file(path, largest_file);
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
  const auto shown = [&](const PlannedTrial& trial, Encoding encoding) {
    const Clip& clip = options_.clips.at(trial.demonstration).in(encoding).at(trial.pinch);
    return ShownFile{clip.name(), clip.sha256()};
  };
  const auto file = answer_file(entry->session, plan_options(options_.config), shown_, shown,
                                free_text, options_.utc_now(), withdrawal_hash(code));
  try {
    save_answers(answer_path(options_.answers, id), file);
  } catch (const std::exception& error) {
    options_.tell(fmt::format("{}: ANSWERS NOT SAVED: {}", id, error.what()));
    throw Refused(507, "the disk does not take it");
  }
  entry->is_gone = true;
  const std::scoped_lock lock(mutex_);
  remove(*entry);
  ++finished_;
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
  if (const auto place = places_.find(participant); place != places_.end()) {
    place->second.seen = parse_utc(options_.utc_now());
  }
  const bool is_there = encoding == Encoding::mp4 || files->webm;
  return is_there ? &files->in(encoding).at(side) : nullptr;
}

Overview Desk::overview() {
  std::vector<std::shared_ptr<Entry>> all;
  Overview overview;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, place] : places_) {
      all.push_back(place.entry);
    }
    overview.finished = finished_;
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

fs::path Desk::session_path(const std::string& id) const {
  return running_folder(options_.answers) / (id + ".json");
}

}  // namespace pinchlab::study
