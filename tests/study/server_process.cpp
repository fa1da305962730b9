// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/study/server_process.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <sstream>
#include <thread>

#include "base/sha256.h"

namespace pinchlab::study {

namespace fs = std::filesystem;

void write_clips(const fs::path& folder, const std::vector<std::string>& names, std::size_t bytes) {
  fs::create_directories(folder);
  nlohmann::json clips = nlohmann::json::array();
  for (const std::string& name : names) {
    for (const char* left : {"pinch", "baseline"}) {
      const std::string file = name + ".left-" + left + ".mp4";
      std::string content(bytes += 777, '\0');
      for (std::size_t i = 0; i < content.size(); ++i) {
        content[i] = static_cast<char>((i * i + bytes) % 251);
      }
      std::ofstream(folder / file, std::ios::binary) << content;
      clips.push_back({{"file", file}, {"sha256", sha256(content)}});
    }
  }
  std::ofstream(folder / "manifest.json")
      << nlohmann::json{{"format", "pinchlab clips 1"}, {"clips", clips}};
}

nlohmann::json answer_body(std::size_t index, const char* choice) {
  return {{"index", index},          {"choice", choice},
          {"reaction_time_s", 1.25}, {"loops_watched", 2},
          {"focus_lost_count", 0},   {"frame_count", 900},
          {"dropped_frames", 3},     {"loop_gap_median_s", 0.001},
          {"loop_gap_max_s", 0.017}, {"playback_errors", nlohmann::json::array()},
          {"input", "mouse"},        {"encoding", "mp4"},
          {"window_width_px", 1280}, {"window_height_px", 720},
          {"clip_width_px", 1200},   {"clip_height_px", 600},
          {"screen_width_px", 1920}, {"screen_height_px", 1080},
          {"device_pixel_ratio", 1}};
}

ServerProcess::ServerProcess(const std::string& program, const fs::path& folder)
    : out_(folder / "out.txt") {
  fs::remove(out_);
  process_ = ::fork();
  if (process_ == 0) {
    const int out = ::open(out_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::execl(program.c_str(), "pinchlab", "study", "serve", "--clips", (folder / "clips").c_str(),
            "--answers", (folder / "answers").c_str(), "--config", (folder / "study.json").c_str(),
            "--port", "0", "--no-webm", nullptr);
    ::_exit(127);
  }
}

ServerProcess::~ServerProcess() {
  kill();
}

std::string ServerProcess::address() const {
  for (bool has_ended = false; !has_ended;) {
    siginfo_t ended = {};
    has_ended =
        ::waitid(P_PID, static_cast<id_t>(process_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
        ended.si_pid == process_;
    std::ostringstream text;
    text << std::ifstream(out_).rdbuf();
    const std::string out = text.str();
    const std::size_t at = out.find("http://");
    if (out.find("Ctrl-C ends") != std::string::npos) {
      return out.substr(at, out.find("/\n", at) - at);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return "";
}

void ServerProcess::kill() {
  if (process_ > 0) {
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    process_ = -1;
  }
}

}  // namespace pinchlab::study
