// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A folder of clips that are no videos: the server does not look into them.

#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/sha256.h"
#include "study/desk.h"
#include "study/http_client.h"
#include "study/secrets.h"
#include "study/server.h"
#include "study/utc.h"
#include "tests/base/scratch_folder.h"
#include "tests/study/server_process.h"

namespace pinchlab::study {

inline const std::vector<std::string> demonstrations = {"01-first", "02-second", "03-third"};

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

inline void write_clips(const std::filesystem::path& folder) {
  write_clips(folder, demonstrations, 100000);
}

inline Config small_config() {
  Config config = default_config();
  config.demonstrations = demonstrations;
  return config;
}

inline DeskOptions desk_options(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "clips")) {
    write_clips(folder / "clips");
  }
  DeskOptions options;
  options.config = small_config();
  options.clips = open_clips(folder / "clips", options.config);
  options.answers = folder / "answers";
  options.seed = 7;
  return options;
}

/// A clock that nobody sets: what `utc` tells goes by.
template <class Utc>
void set_clock(DeskOptions& options, const Utc& utc) {
  options.utc_now = utc;
  options.steady_now = [utc] {
    return std::chrono::steady_clock::time_point(parse_utc(utc()).time_since_epoch());
  };
}

/// A desk and its server, on a free port.
class RunningServer {
 public:
  explicit RunningServer(DeskOptions desk_options, const ServerOptions& options = {})
      : desk(std::move(desk_options)), server(desk, options), thread_([this] { server.run(); }) {
    EXPECT_TRUE(HttpClient(server.address()).get("/api/study"));
  }
  ~RunningServer() {
    server.stop();
    thread_.join();
  }
  RunningServer(const RunningServer&) = delete;
  RunningServer& operator=(const RunningServer&) = delete;

  Desk desk;
  Server server;

 private:
  std::thread thread_;
};

/// Takes part with what answer_body() sends, changed by `change`; returns the withdrawal code.
template <class Change>
std::string take_part(Desk& desk, const Change& change) {
  const std::string token = desk.start("", "browser");
  const std::size_t trials = desk.progress(token).trials.size();
  for (std::size_t i = 0; i < trials; ++i) {
    desk.show(token, i);
    nlohmann::json body = answer_body(i);
    change(body);
    desk.answer(token, parse_answer(body));
  }
  return desk.save(token, {});
}

/// The status with which the desk refuses what `action` asks of it, or 0.
template <class Action>
int refused(const Action& action) {
  try {
    action();
  } catch (const Refused& error) {
    return error.status;
  }
  return 0;
}

}  // namespace pinchlab::study
