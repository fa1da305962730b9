// SPDX-License-Identifier: GPL-3.0-or-later
// Who has which place: what is on the disk at start, who goes, who makes room, one-time links.
#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "base/answer_file.h"
#include "base/durable_file.h"
#include "base/input_error.h"
#include "base/json_object.h"
#include "base/partial_file.h"
#include "base/sha256.h"
#include "study/adaptive.h"
#include "study/answers.h"
#include "study/desk.h"
#include "study/secrets.h"
#include "study/utc.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::chrono::minutes longest_unanswered{5};  // without a sign, where places are short

}  // namespace

void Desk::read_finished() {
  for (const fs::path& path : answer_files(options_.answers)) {
    const json file = read_answer_json(path);
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
    if (file.value("pilot", false) != options_.config.is_pilot) {
      throw std::runtime_error(fmt::format(
          "{}: {}; keep a pilot and the study in folders of their own (--answers)", path.string(),
          options_.config.is_pilot ? "is of the study, and this is a pilot"
                                   : "is of a pilot, and this is the study"));
    }
    Finished& finished = finished_[path.stem().string()];
    if (file.value("participant_number", json()).is_number_unsigned()) {
      finished.number = file["participant_number"].get<std::uint64_t>();
      taken_.insert(*finished.number);
    }
    if (file.contains("recruited")) {
      finished.recruited =
          read_recruited(JsonObject(file["recruited"], path.string(), "/recruited")).participant;
      recruited_.insert(finished.recruited);
    }
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
      entry->session = session_from_json(read_answer_json(path));
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
    // By the calendar: how much time has gone by since the server ended, no other clock knows.
    const auto last_seen = parse_utc(entry->session.last_seen_utc);
    const std::chrono::seconds since = parse_utc(options_.utc_now()) - last_seen;
    add(entry, "", std::clamp(since, std::chrono::seconds(0), options_.longest_idle));
  }
}

// What a killed server left half written is nobody's answer; it may hold what somebody wrote. So
// may archives for a download.
void Desk::sweep() const {
  for (const fs::path& folder : {options_.answers, running_folder(options_.answers)}) {
    std::vector<fs::path> partial;
    for (const fs::directory_entry& file : fs::directory_iterator(folder)) {
      const std::string name = file.path().filename().string();
      const bool is_archive =
          folder != options_.answers && (name.ends_with(".zip") || is_partial_of(name, ".zip"));
      if (is_archive || is_partial_of(name, ".json")) partial.push_back(file.path());
    }
    std::ranges::for_each(partial, remove_durably);
  }
}

// Whoever's answers are gone has withdrawn them, here or by `study withdraw`, and holds no place
// any more, as after a restart. Where the folder itself is away, nobody has.
void Desk::free_withdrawn() {
  std::vector<std::string> gone;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, finished] : finished_) gone.push_back(id);
  }
  std::erase_if(gone, [&](const std::string& id) {
    std::error_code unknown;
    return fs::exists(answer_path(options_.answers, id), unknown) || unknown;
  });
  std::error_code unknown;
  if (gone.empty() || !fs::exists(running_folder(options_.answers), unknown)) return;
  const std::scoped_lock lock(mutex_);
  for (const std::string& id : gone) {
    const auto finished = finished_.extract(id);
    if (finished.empty()) continue;  // by somebody else meanwhile
    if (finished.mapped().number) taken_.erase(*finished.mapped().number);
    recruited_.erase(finished.mapped().recruited);
    options_.tell(fmt::format("the answers of {} are withdrawn; the place is free", id));
  }
}

void Desk::add(const std::shared_ptr<Entry>& entry, const std::string& address,
               std::chrono::seconds since_seen) {
  const Session& session = entry->session;
  for (std::size_t i = 0; i < session.plan.size(); ++i) offer(session, i);
  take(session);
  const auto seen = options_.steady_now() - since_seen;
  places_[session.id] = {entry, address, ++starts_, seen, 0, false, false};
  note(session);
}

// Nobody else gets the number, and nobody the id once more. Under mutex_.
void Desk::take(const Session& session) {
  taken_.insert(session.number);
  if (!session.recruited.participant.empty()) recruited_.insert(session.recruited.participant);
}

void Desk::give_back(const Session& session) {
  taken_.erase(session.number);
  recruited_.erase(session.recruited.participant);
}

// Lets the clip of a trial be had, once its level is chosen. Under mutex_.
void Desk::offer(const Session& session, std::size_t trial) {
  if (trial >= session.plan.size() || is_open(session.plan[trial])) return;
  const auto files = options_.clips.find(clip_key(session.plan[trial]));
  if (files == options_.clips.end()) {
    throw std::runtime_error(fmt::format("{}: no clips of `{}`", session_path(session.id).string(),
                                         clip_key(session.plan[trial])));
  }
  media_[session.media[trial]] = {&files->second, session.plan[trial].pinch, session.id};
}

// Under mutex_.
void Desk::note(const Session& session) {
  const auto place = places_.find(session.id);
  if (place != places_.end()) {
    place->second.is_shown = !session.answers.empty() || !session.shown_utc.empty();
    place->second.has_answered = !session.answers.empty() || !session.questionnaires.empty();
  }
}

// A sign of somebody. Under mutex_.
void Desk::see(const std::string& id) {
  if (const auto place = places_.find(id); place != places_.end()) {
    place->second.seen = options_.steady_now();
    ++place->second.signs;
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
                std::optional<std::uint64_t> signs) {
  const std::scoped_lock entry_lock(entry->mutex);
  if (entry->is_gone) {
    return;
  }
  if (signs) {
    const std::scoped_lock lock(mutex_);
    if (places_.at(entry->session.id).signs != *signs) return;
  }
  forget(entry->session.id);
  entry->is_gone = true;
  const std::scoped_lock lock(mutex_);
  remove(*entry);
  give_back(entry->session);
  ++left_;
  options_.tell(fmt::format("{} {}; nothing is kept", entry->session.id, why));
}

void Desk::drop_idle() {
  const auto now = options_.steady_now();
  std::vector<Leaver> idle;
  {
    const std::scoped_lock lock(mutex_);
    for (const auto& [id, place] : places_) {
      if (now - place.seen >= options_.longest_idle) {
        idle.push_back({place.entry, place.signs});
      }
    }
  }
  for (const auto& [entry, signs] : idle) {
    try {
      drop(entry, "was not seen for too long and is dropped", signs);
    } catch (const std::exception& error) {
      options_.tell(fmt::format("a place cannot be released: {}", error.what()));
    }
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

// Who has to go for somebody that starts from `address`; none: nobody has to, or nobody can.
std::optional<Desk::Leaver> Desk::who_makes_room(const std::string& link,
                                                 const std::string& address,
                                                 const Recruited& recruited) {
  const auto now = options_.steady_now();
  const std::scoped_lock lock(mutex_);
  const auto has_only_started = [](const Place& place) {
    return place.signs == 0 && !place.is_shown && !place.has_answered;
  };
  const auto is_away = [&](const Place& place) {
    return !place.has_answered && now - place.seen >= longest_unanswered;
  };
  std::size_t unanswered = 0;                  // of this address
  std::map<std::string, std::size_t> started;  // by address, and nothing else
  started[address] = 0;
  for (const auto& [id, place] : places_) {
    unanswered += place.address == address && !place.has_answered ? 1 : 0;
    if (has_only_started(place)) ++started[place.address];
  }
  const auto oldest = [&](const auto& may_go) {
    const Place* found = nullptr;
    for (const auto& [id, place] : places_) {
      const bool is_older = found == nullptr || place.order < found->order;
      if (is_older && may_go(place)) found = &place;
    }
    return found == nullptr ? std::nullopt : std::optional(Leaver{found->entry, found->signs});
  };
  if (options_.config.one_time_links) {
    return oldest([&](const Place& place) {
      return !place.is_shown && equal_in_constant_time(link, link_of(place.entry->session.number));
    });
  }
  if (options_.config.recruiting && recruited_.contains(recruited.participant)) {
    return oldest([&](const Place& place) {
      return !place.is_shown && place.entry->session.recruited.participant == recruited.participant;
    });
  }
  if (unanswered >= options_.most_unanswered) {
    return oldest([&](const Place& place) { return place.address == address && is_away(place); });
  }
  const auto limit = static_cast<std::size_t>(options_.config.participant_limit);
  const bool is_full =
      places_.size() >= options_.most_open || (limit > 0 && taken_.size() >= limit);
  if (!is_full) {
    return std::nullopt;
  }
  const auto busiest =
      std::ranges::max_element(started, {}, [](const auto& entry) { return entry.second; });
  if (busiest->second > started[address] + 1) {
    return oldest([&](const Place& place) {
      return place.address == busiest->first && has_only_started(place);
    });
  }
  return oldest(is_away);
}

void Desk::make_room(const std::string& link, const std::string& address,
                     const Recruited& recruited) {
  try {
    if (const auto leaver = who_makes_room(link, address, recruited)) {
      drop(leaver->entry, "had answered no trial and made room", leaver->signs);
    }
  } catch (const std::exception& error) {
    options_.tell(fmt::format("a place cannot be released: {}", error.what()));
    throw Refused(503, "the disk does not take it");
  }
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
        // Since who_makes_room() was asked.
        const bool is_just_opened =
            starting_.contains(number) || std::ranges::any_of(places_, [&](const auto& place) {
              return place.second.entry->session.number == number && !place.second.is_shown;
            });
        if (is_just_opened) throw Refused(503, "this link is just being opened");
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

}  // namespace pinchlab::study
