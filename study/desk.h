// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The study that is running: who takes part, and what of it is on the disk. Everything that a
// participant was told is done is on the disk, so that a restart loses nobody. Safe to use from
// many threads.
//
//   ANSWERS/<participant>.json            answers, analysis/answers.schema.json
//   ANSWERS/.running/<participant>.json   participants who have not finished
//   ANSWERS/.running/study.json           seed and configuration

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/folder_lock.h"
#include "study/clips.h"
#include "study/config.h"
#include "study/session.h"
#include "study/shown.h"
#include "study/study_file.h"

namespace pinchlab::study {

struct DeskOptions {
  Config config;  ///< with its demonstrations named
  Clips clips;
  std::filesystem::path answers;      ///< folder, made if missing
  std::optional<std::uint64_t> seed;  ///< none: the folder's own, or a random one
  std::size_t most_open = 1000;       ///< participants at a time
  std::size_t most_unanswered = 500;  ///< of one address, participants who have not answered yet
  std::chrono::seconds longest_idle{24 * 3600};  ///< without a sign, before a place is released
  std::function<std::string()> utc_now;
  /// How much time goes by, where nobody sets the clock: by it places are released.
  std::function<std::chrono::steady_clock::time_point()> steady_now;
  std::function<void(const std::string&)> tell;  ///< who started, finished, left
};

/// What a page is told of a running session; nothing in it names a method.
struct Progress {
  struct Trial {
    std::string media;  ///< opaque name of the clip
    bool is_practice = false;
  };
  std::vector<Trial> trials;
  bool has_webm = false;     ///< all of them do: one without would stand out
  bool is_adaptive = false;  ///< the clip of a trial can be had once those before are answered
  std::string language;      ///< of the page
  std::size_t next = 0;      ///< trial to show; trials.size(): all are answered
  std::vector<std::string> questionnaires;  ///< parts that are still to be answered
};

struct Overview {
  struct Participant {
    std::string id;
    std::uint64_t number = 0;
    std::size_t answered = 0, trials = 0;
    std::string started_utc, last_seen_utc;
  };
  std::vector<Participant> running;
  std::size_t finished = 0, left = 0;  ///< left: since the server started
};

class Desk {
 public:
  /// Takes up the participants who were running, and drops those who are idle. Throws
  /// std::runtime_error if the folder cannot be used, is in use by another server, or belongs to a
  /// study with another seed or plan.
  explicit Desk(DeskOptions options);

  [[nodiscard]] std::uint64_t seed() const { return study_.seed; }
  [[nodiscard]] const Config& config() const { return options_.config; }

  /// One-time links' secrets, by participant number; empty if the study has none.
  [[nodiscard]] std::vector<std::string> links() const;

  /// A new participant's token. Refused: 403 for a link that is unknown or used, or without the id
  /// of the site that the study recruits by; 422 for a language that the study is not in (none: its
  /// first); 410 where that id has a place already; 409 where the
  /// study is full; 503 where too many are running or the disk does not take it.
  ///
  /// A link is used up when its first clip is shown: until then opening it again begins anew, so
  /// that a start whose reply was lost costs nobody the link. An id is treated likewise; who leaves
  /// can come back with it.
  ///
  /// Where places are short, the newcomer takes that of somebody who has done nothing but start:
  /// the oldest one of the address that has most of them and more than the newcomer's own will
  /// have. Or else of one who has answered nothing, no question either, and was not seen for five
  /// minutes. So many starts from one address fill no study, and nobody who takes part has to go
  /// for others.
  std::string start(const std::string& link, const std::string& user_agent,
                    const std::string& address = "", const Recruited& recruited = {},
                    const std::string& language = "");

  // All of these refuse (401) a token that is not one of a running session.
  Progress progress(const std::string& token);
  Progress resume(const std::string& token);  ///< after a reload
  void show(const std::string& token, std::size_t index);
  void answer(const std::string& token, const SentAnswer& sent);

  void questionnaire(const std::string& token, const nlohmann::json& body);

  /// Keeps nothing. Refused (409) if the answers have been saved: they stay.
  void leave(const std::string& token);

  /// Saves the answers and returns the withdrawal code. Sent again, it saves nothing more and
  /// returns the same code, also after a restart. Refused (507) if the disk does not take them:
  /// then nothing is lost and it can be tried again.
  std::string save(const std::string& token, const std::map<std::string, std::string>& free_text);

  /// The clip of a name that a running participant was given; nullptr if there is none.
  const Clip* clip(const std::string& media, Encoding encoding);

  Overview overview();

  /// Ends the sessions of all who were not seen for longest_idle, and keeps nothing of them. What
  /// the disk does not let go is told, and tried again the next time.
  void drop_idle();

  // For the researcher.

  /// The number and the plan of somebody who is running. Refused (404) if nobody with that id is.
  std::pair<std::uint64_t, std::vector<PlannedTrial>> plan_of(const std::string& id);

  /// The trials of a participant number as a page is told them; their clips can be had until the
  /// next preview.
  Progress preview(std::uint64_t number);

  /// Removes the answers of who has this withdrawal code, and returns the participant's id. The
  /// number goes to the next who comes, as it does where `study withdraw` has removed them.
  /// Refused: 422 for what is no code, 404 where no answers have it.
  std::string withdraw(const std::string& code);

  [[nodiscard]] const std::filesystem::path& answers() const { return options_.answers; }

  /// Ends a participant's session for the researcher and keeps nothing of it; the place goes to
  /// the next who comes. Refused (404) if nobody with that id is running.
  void release(const std::string& id);

 private:
  struct Entry {
    std::mutex mutex;
    Session session;
    bool is_gone = false;
  };
  // What the desk knows of an entry without waiting for it.
  struct Place {
    std::shared_ptr<Entry> entry;
    std::string address;      // where the participant started; never on the disk
    std::uint64_t order = 0;  // of starting
    std::chrono::steady_clock::time_point seen;
    std::uint64_t signs = 0;    // of somebody there: requests since the start that are noted
    bool is_shown = false;      // the first clip, at least
    bool has_answered = false;  // a trial, or questions
  };
  struct Leaver {
    std::shared_ptr<Entry> entry;
    std::uint64_t signs = 0;  // when chosen; who has given another one since, stays
  };
  // What somebody takes up whose answers are saved.
  struct Finished {
    std::optional<std::uint64_t> number;  // none in files that tell none
    std::string recruited;                // id at the site that sent them; empty: none did
  };
  struct Media {
    const PairFiles* files;
    Side side;
    std::string participant;  // empty: of a preview
  };

  void read_finished();
  void read_running();
  void add(const std::shared_ptr<Entry>& entry, const std::string& address,
           std::chrono::seconds since_seen = {});
  void note(const Session& session);
  void see(const std::string& id);
  void offer(const Session& session, std::size_t trial);
  void remove(const Entry& entry);
  void drop(const std::shared_ptr<Entry>& entry, const std::string& why,
            std::optional<std::uint64_t> signs = std::nullopt);
  void forget(const std::string& id) const;
  void sweep() const;
  void free_withdrawn();
  void make_room(const std::string& link, const std::string& address, const Recruited& recruited);
  std::optional<Leaver> who_makes_room(const std::string& link, const std::string& address,
                                       const Recruited& recruited);
  void take(const Session& session);
  void give_back(const Session& session);
  void use_up_link(std::uint64_t number);
  std::uint64_t number_for(const std::string& link);
  std::string link_of(std::uint64_t number) const;
  std::shared_ptr<Entry> find(const std::string& token);
  void change(const std::string& token, const std::function<void(Session&)>& apply);
  [[nodiscard]] std::string saved_code(const std::string& id, const std::string& secret) const;
  Progress progress_of(const Session& session) const;
  [[nodiscard]] std::filesystem::path session_path(const std::string& id) const;

  DeskOptions options_;
  std::optional<FolderLock> lock_;
  std::mutex links_mutex_;  // of used links on the disk; held before mutex_, after an entry's
  std::mutex mutex_;        // of all below; held while waiting for nothing else
  nlohmann::json shown_;    // what_is_shown(); never changes
  StudyFile study_;         // its seed never changes
  std::map<std::string, Place> places_;  // by participant, who is running
  std::uint64_t starts_ = 0;
  std::map<std::string, Media> media_;
  std::set<std::uint64_t> taken_;             // numbers of running and finished participants
  std::set<std::uint64_t> starting_;          // of them, whose session is not on the disk yet
  std::set<std::string> recruited_;           // their ids at the site that sent them
  std::map<std::string, Finished> finished_;  // by participant
  std::size_t left_ = 0;
};

}  // namespace pinchlab::study
