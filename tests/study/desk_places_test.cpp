// SPDX-License-Identifier: GPL-3.0-or-later
// Who has which place, and how it is had again.
#include "base/read_file.h"
#include "base/sha256.h"
#include "study/desk.h"

#include <sys/stat.h>

#include <atomic>
#include <regex>
#include <sstream>
#include <thread>

#include "analysis/answers_table.h"
#include "base/answer_file.h"
#include "base/input_error.h"
#include "study/answers.h"
#include "study/tables.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

TEST(Desk, WhoLeavesIsReplaced) {
  const fs::path folder = scratch_folder();
  Desk desk(desk_options(folder));
  const std::string first = desk.start("", "");
  const std::string second = desk.start("", "");
  desk.leave(first);
  EXPECT_EQ(refused([&] { desk.progress(first); }), 401);
  EXPECT_EQ(refused([&] { desk.save(first, {}); }), 401);
  desk.start("", "");
  std::set<std::uint64_t> numbers;
  for (const auto& participant : desk.overview().running) {
    numbers.insert(participant.number);
  }
  EXPECT_EQ(numbers, (std::set<std::uint64_t>{0, 1}));
  EXPECT_TRUE(answer_files(folder / "answers").empty());
}

TEST(Desk, IdleSessionsEndAfterADay) {
  DeskOptions options = desk_options(scratch_folder());
  auto now = std::make_shared<std::string>("2026-11-20T12:00:00.000Z");
  set_clock(options, [now] { return *now; });
  Desk desk(std::move(options));
  const std::string token = desk.start("", "");
  *now = "2026-11-21T11:59:59.000Z";
  desk.start("", "");
  EXPECT_EQ(desk.overview().running.size(), 2U);
  *now = "2026-11-21T12:00:00.000Z";
  desk.start("", "");
  EXPECT_EQ(desk.overview().running.size(), 2U);
  EXPECT_EQ(refused([&] { desk.progress(token); }), 401);
}

bool is_kept(const fs::path& folder, const std::string& token) {
  return fs::exists(folder / "answers/.running" / (token.substr(0, 16) + ".json"));
}

TEST(Desk, IdleSessionsEndAlsoWhileNobodyComes) {
  const fs::path folder = scratch_folder();
  auto is_next_day = std::make_shared<std::atomic<bool>>(false);
  DeskOptions options = desk_options(folder);
  set_clock(options, [is_next_day] {
    return *is_next_day ? "2026-11-21T12:00:00.000Z" : "2026-11-20T12:00:00.000Z";
  });
  ServerOptions often;
  often.idle_check = std::chrono::milliseconds(5);
  RunningServer running(std::move(options), often);
  const std::string token = running.desk.start("", "");
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_TRUE(is_kept(folder, token));
  *is_next_day = true;
  for (int i = 0; i < 1000 && is_kept(folder, token); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  EXPECT_FALSE(is_kept(folder, token));
}

TEST(Desk, IdleSessionsEndAtARestart) {
  const fs::path folder = scratch_folder();
  const auto at = [&](const char* now) {
    DeskOptions options = desk_options(folder);
    set_clock(options, [now] { return now; });
    return options;
  };
  const std::string first = Desk(at("2026-11-20T12:00:00.000Z")).start("", "");
  const std::string second = Desk(at("2026-11-20T18:00:00.000Z")).start("", "");
  Desk desk(at("2026-11-21T12:00:00.000Z"));
  EXPECT_FALSE(is_kept(folder, first));
  EXPECT_TRUE(is_kept(folder, second));
  EXPECT_EQ(desk.overview().left, 1U);
}

// Set by a network, or by hand: nobody has been away for a day.
TEST(Desk, AClockThatIsSetEndsNoSession) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  std::string now = "2026-11-20T12:00:00.000Z";
  options.utc_now = [&] { return now; };
  options.config.participant_limit = 2;
  Desk desk(std::move(options));
  const std::string before = desk.start("", "");
  for (const char* set : {"2026-11-22T12:00:00.000Z", "2026-11-18T12:00:00.000Z"}) {
    now = set;
    desk.drop_idle();
    EXPECT_EQ(refused([&] { desk.resume(before); }), 0) << set;
  }
  const std::string after = desk.start("", "");
  now = "2026-11-20T12:00:00.000Z";
  desk.drop_idle();
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409) << "nobody is away for five minutes either";
  EXPECT_EQ(refused([&] { desk.progress(before); }), 0);
  EXPECT_EQ(refused([&] { desk.progress(after); }), 0);
}

TEST(Desk, WhoWaitsForAFullDiskIsNotIdle) {
  const fs::path folder = scratch_folder();
  std::string now = "2026-11-20T12:00:00.000Z";
  DeskOptions options = desk_options(folder);
  set_clock(options, [&] { return now; });
  options.longest_idle = std::chrono::minutes(30);
  Desk desk(std::move(options));
  const std::string token = desk.start("", "");
  for (std::size_t i = 0; i < demonstrations.size(); ++i) {
    desk.show(token, i);
    desk.answer(token, parse_answer(answer_body(i)));
  }
  now = "2026-11-20T12:20:00.000Z";
  fs::rename(folder / "answers", folder / "away");
  EXPECT_EQ(refused([&] { desk.save(token, {}); }), 507);
  fs::rename(folder / "away", folder / "answers");
  now = "2026-11-20T12:40:00.000Z";
  desk.drop_idle();
  EXPECT_EQ(refused([&] { desk.save(token, {}); }), 0);
}

TEST(Desk, LimitsAndLinks) {
  DeskOptions options = desk_options(scratch_folder());
  options.config.participant_limit = 2;
  options.config.one_time_links = true;
  Desk desk(std::move(options));
  const auto links = desk.links();
  ASSERT_EQ(links.size(), 2U);
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 403);
  EXPECT_EQ(refused([&] { desk.start("guess", ""); }), 403);
  const std::string token = desk.start(links[1], "");
  EXPECT_EQ(desk.overview().running.front().number, 1U);
  desk.show(token, 0);
  EXPECT_EQ(refused([&] { desk.start(links[1], ""); }), 403);
  desk.leave(token);
  EXPECT_EQ(refused([&] { desk.start(links[1], ""); }), 403) << "used is used";
  desk.start(links[0], "");
}

// Who is refused a clip has seen none.
TEST(Desk, WhatIsRefusedUsesUpNoLink) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  options.config.participant_limit = 1;
  options.config.one_time_links = true;
  Desk desk(std::move(options));
  const std::string link = desk.links()[0], first = desk.start(link, "");
  EXPECT_EQ(refused([&] { desk.show(first, 1); }), 409);
  const std::string second = desk.start(link, "");
  EXPECT_EQ(refused([&] { desk.progress(first); }), 401);
  fs::rename(folder / "answers", folder / "away");
  EXPECT_EQ(refused([&] { desk.show(second, 0); }), 507) << "the link cannot be marked";
  fs::rename(folder / "away", folder / "answers");
  const std::string third = desk.start(link, "");
  desk.show(third, 0);
  EXPECT_EQ(refused([&] { desk.start(link, ""); }), 403);
}

// Nothing was shown by it yet: who comes in between is to try again.
TEST(Desk, ALinkThatIsJustBeingOpenedIsNotUsed) {
  DeskOptions options = desk_options(scratch_folder());
  options.config.participant_limit = 1;
  options.config.one_time_links = true;
  Desk desk(std::move(options));
  std::vector<int> statuses(16, -1);
  std::vector<std::thread> threads;
  for (int& status : statuses) {
    threads.emplace_back([&] { status = refused([&] { desk.start(desk.links()[0], ""); }); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const int status : statuses) EXPECT_TRUE(status == 0 || status == 503) << status;
  EXPECT_EQ(desk.overview().running.size(), 1U);
}

TEST(Desk, AStartThatFailedCostsNobodyTheLink) {
  const fs::path folder = scratch_folder();
  const auto options = [&] {
    DeskOptions result = desk_options(folder);
    result.config.participant_limit = 2;
    result.config.one_time_links = true;
    return result;
  };
  std::string link, second;
  {
    Desk desk(options());
    link = desk.links()[0];
    fs::rename(folder / "answers", folder / "away");
    EXPECT_EQ(refused([&] { desk.start(link, ""); }), 503);
    fs::rename(folder / "away", folder / "answers");
    const std::string first = desk.start(link, "");  // the reply is lost
    second = desk.start(link, "");
    EXPECT_EQ(refused([&] { desk.progress(first); }), 401);
    EXPECT_EQ(desk.overview().running.size(), 1U);
  }
  Desk desk(options());  // killed between the start and its reply
  const std::string third = desk.start(link, "");
  EXPECT_EQ(refused([&] { desk.progress(second); }), 401);
  desk.show(third, 0);
  EXPECT_EQ(refused([&] { desk.start(link, ""); }), 403) << "a clip was seen";
  desk.leave(third);
  EXPECT_EQ(refused([&] { desk.start(link, ""); }), 403) << "used is used";
}

TEST(Desk, PlacesAreReleased) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  auto now = std::make_shared<std::string>("2026-11-20T12:00:00.000Z");
  set_clock(options, [now] { return *now; });
  options.config.participant_limit = 1;
  options.longest_idle = std::chrono::minutes(30);
  Desk desk(std::move(options));
  const auto answer_one = [&](const std::string& token) {
    desk.show(token, 0);
    desk.answer(token, parse_answer(answer_body(0)));
  };
  const std::string first = desk.start("", "");
  answer_one(first);
  *now = "2026-11-20T12:29:59.000Z";
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  *now = "2026-11-20T12:30:00.000Z";
  const std::string second = desk.start("", "");
  EXPECT_EQ(refused([&] { desk.progress(first); }), 401);
  answer_one(second);
  EXPECT_EQ(refused([&] { desk.release("0123456789abcdef"); }), 404);
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  desk.release(second.substr(0, 16));
  EXPECT_EQ(refused([&] { desk.progress(second); }), 401);
  desk.start("", "");
}

// As `study withdraw` does it, which tells a running server nothing.
TEST(Desk, ThePlaceOfAnswersThatAreGoneIsFree) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  options.config.participant_limit = 2;
  Desk desk(std::move(options));
  const auto take_part_as_is = [&] { return take_part(desk, [](json&) {}); };
  const std::string code = take_part_as_is();
  take_part_as_is();
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  fs::rename(folder / "answers", folder / "away");
  EXPECT_NE(refused([&] { desk.start("", ""); }), 0) << "a disk that is gone is nobody's wish";
  fs::rename(folder / "away", folder / "answers");
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
  EXPECT_TRUE(withdraw(folder / "answers", code));
  EXPECT_EQ(desk.overview().finished, 1U);
  desk.start("", "");
  EXPECT_EQ(desk.overview().running.at(0).number, 0U);
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 409);
}

// Files that another one removes meanwhile are nobody's concern.
TEST(Withdraw, SeveralAtOnce) {
  const fs::path folder = scratch_folder();
  constexpr int people = 128, threads = 4;
  std::vector<std::string> codes;
  for (int i = 0; i < people; ++i) {
    codes.push_back(withdrawal_code(random_hex(16)));
    write_text(folder / (std::to_string(i) + ".json"),
               json{{"withdrawal_code_sha256", withdrawal_hash(codes.back())}}.dump());
  }
  std::atomic<int> removed = 0, failed = 0;
  const auto withdraw_every = [&](int first) {
    for (int i = first; i < people; i += threads) {
      try {
        removed += withdraw(folder, codes.at(static_cast<std::size_t>(i))) ? 1 : 0;
      } catch (const std::exception&) {
        ++failed;
      }
    }
  };
  std::vector<std::thread> running;
  for (int i = 0; i < threads; ++i) running.emplace_back(withdraw_every, i);
  for (std::thread& thread : running) thread.join();
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(removed, people);
}

TEST(Desk, ManyStartsFromOneAddressFillNoStudy) {
  const fs::path folder = scratch_folder();
  DeskOptions options = desk_options(folder);
  auto now = std::make_shared<std::string>("2026-11-20T12:00:00.000Z");
  set_clock(options, [now] { return *now; });
  options.config.participant_limit = 16;
  options.most_unanswered = 20;
  Desk desk(std::move(options));
  const std::string answered = desk.start("", "", "crowd");
  desk.show(answered, 0);
  desk.answer(answered, parse_answer(answer_body(0)));
  const std::string honest = desk.start("", "", "home");
  int started = 0;
  for (int i = 0; i < 1000; ++i) {
    started += refused([&] { desk.start("", "", "crowd"); }) == 0 ? 1 : 0;
  }
  EXPECT_EQ(started, 14) << "no address takes its own places anew";
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(refused([&] { desk.start("", "", "address " + std::to_string(i)); }), 0);
  }
  EXPECT_EQ(refused([&] { desk.start("", "", "crowd"); }), 409);
  EXPECT_EQ(desk.progress(answered).next, 1U) << "who has answered stays";
  EXPECT_EQ(desk.progress(honest).next, 0U);
  *now = "2026-11-20T12:05:00.000Z";
  EXPECT_EQ(refused([&] { desk.start("", "", "crowd"); }), 0) << "those not seen for five minutes";
}

// A desk of three places, with a question before the trials, and a clock.
struct SmallStudy {
  explicit SmallStudy(const fs::path& folder, bool has_links = false)
      : desk([&] {
          DeskOptions options = desk_options(folder);
          set_clock(options, [this] { return now; });
          options.config.participant_limit = 3;
          options.config.one_time_links = has_links;
          Question age;
          age.name = age.text = "age";
          age.longest = 9;
          options.config.questionnaires.before = {age};
          return options;
        }()) {}
  std::string start(const std::string& address) { return desk.start("", "", address); }
  void answer_questions(const std::string& token) {
    desk.questionnaire(token, {{"part", "before"}, {"answers", {{"age", "44"}}}});
  }
  int status(const std::string& token) {
    return refused([&] { desk.progress(token); });
  }

  std::string now = "2026-11-20T12:00:00.000Z";
  Desk desk;
};

TEST(Desk, WhoHasAnsweredQuestionsMakesNoRoom) {
  SmallStudy study(scratch_folder());
  const std::string first = study.start("lab"), second = study.start("lab");
  for (const std::string& token : {first, second, study.start("lab")}) {
    study.answer_questions(token);
  }
  study.desk.show(first, 0);
  EXPECT_EQ(refused([&] { study.start("home"); }), 409);
  study.now = "2026-11-20T12:05:00.000Z";
  EXPECT_EQ(refused([&] { study.start("home"); }), 409);
  EXPECT_EQ(study.status(first), 0);
  EXPECT_EQ(study.status(second), 0);
}

TEST(Desk, WhoFetchesClipsMakesRoomOnlyWhenAway) {
  SmallStudy study(scratch_folder());
  const std::string first = study.start("lab"), second = study.start("lab");
  study.start("lab");
  const std::string clip = study.desk.progress(first).trials[0].media;
  EXPECT_NE(study.desk.clip(clip, Encoding::mp4), nullptr);
  const std::string other = study.start("home");  // in the place of who has only started
  EXPECT_EQ(study.status(second), 401);
  EXPECT_EQ(study.status(first), 0);
  study.now = "2026-11-20T12:05:00.000Z";
  study.answer_questions(other);
  study.start("home");
  EXPECT_EQ(study.status(first), 401);
  EXPECT_EQ(study.status(other), 0);
}

TEST(Desk, LinksBeginAnewUntilAClipIsShownAlsoAfterQuestions) {
  SmallStudy study(scratch_folder(), true);
  const std::string link = study.desk.links()[0];
  const std::string first = study.desk.start(link, "");
  study.answer_questions(first);
  const std::string second = study.desk.start(link, "");
  EXPECT_EQ(study.status(first), 401);
  study.answer_questions(second);
  study.desk.show(second, 0);
  EXPECT_EQ(refused([&] { study.desk.start(link, ""); }), 403);
}

}  // namespace
}  // namespace pinchlab::study
