// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// `pinchlab study serve` as it is run, so that it can be killed and looked at from outside.

#include <sys/types.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace pinchlab::study {

/// Pairs of files that are no videos (the server does not look into them), each of another size,
/// and their manifest. `bytes`: of the smallest.
void write_clips(const std::filesystem::path& folder, const std::vector<std::string>& names,
                 std::size_t bytes);

/// What a page sends with an answer.
nlohmann::json answer_body(std::size_t index, const char* choice = "left");

class ServerProcess {
 public:
  /// Serves `folder`/clips with `folder`/study.json; the answers go to `folder`/answers.
  ServerProcess(const std::string& program, const std::filesystem::path& folder);
  ~ServerProcess();  ///< kills it
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;

  /// Waits until it listens; empty if it does not. "http://127.0.0.1:40000"
  [[nodiscard]] std::string address() const;
  [[nodiscard]] pid_t id() const { return process_; }
  void kill();

 private:
  std::filesystem::path out_;
  pid_t process_;
};

}  // namespace pinchlab::study
