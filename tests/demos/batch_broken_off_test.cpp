// SPDX-License-Identifier: GPL-3.0-or-later
// Batches that something ends, or tries to: full disks, signals, a second run.

#include <gtest/gtest.h>
#include <sys/file.h>

#include <algorithm>

#include "tests/demos/scene_folders.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

TEST(Batch, FullDiskLeavesNoHalfFile) {
  const fs::path folder = folder_with_demos();
  write_scene(folder / "demos/01-long.json", 20.0);
  const RunResult run = run_program(folder, render_with({"--codec", "ffv1"}), 20'000);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.err.find("01-long.pinch.mkv: not made: "), std::string::npos) << run.err;
  for (const auto& [name, bytes] : files_in(folder / "clips")) {
    EXPECT_FALSE(name.ends_with(".partial")) << name;
    EXPECT_NE(name, "01-long.pinch.mkv");
  }
}

// Waits until the folder has a file with this ending; false if the program ends before.
bool wait_for_file(pid_t process, const fs::path& folder, const std::string& ending) {
  return wait_until(process, [&] {
    std::error_code none;
    const fs::directory_iterator files(folder, none);
    return std::any_of(begin(files), end(files), [&](const fs::directory_entry& entry) {
      return entry.path().string().ends_with(ending);
    });
  });
}

fs::path folder_with_long_demo() {
  fs::path folder = folder_with_demos();
  write_scene(folder / "demos/01-long.json", 600.0);
  return folder;
}

// Waits until the first clip is being written; likewise.
bool wait_for_first_clip(pid_t process, const fs::path& folder) {
  return wait_for_file(process, folder / "clips", "01-long.pinch.mp4.unpadded.partial.partial");
}

TEST(Batch, KilledRunLeavesNoHalfFile) {
  const fs::path folder = folder_with_long_demo();
  const pid_t process = start_program(folder, render);
  ASSERT_TRUE(wait_for_first_clip(process, folder));
  ::kill(process, SIGKILL);
  EXPECT_EQ(wait_for_program(folder, process).signal, SIGKILL);
  EXPECT_FALSE(fs::exists(folder / "clips/01-long.pinch.mp4"));

  // The workers die too: they hold the folder's lock, which can be had only then.
  const int clips = ::open((folder / "clips").c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_EQ(::flock(clips, LOCK_EX), 0);
  ::close(clips);
  write_scene(folder / "demos/01-long.json", 2.0);
  const RunResult again = run_program(folder, render);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  ASSERT_EQ(run_program(folder, render_with({"--out", "fresh"})).exit_code, 0);
  EXPECT_EQ(files_in(folder / "clips"), files_in(folder / "fresh"));
}

TEST(Batch, InterruptedRunCleansUpAndDiesOfTheSignal) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const fs::path folder = folder_with_long_demo();
    const pid_t process = start_program(folder, render);
    ASSERT_TRUE(wait_for_first_clip(process, folder));
    ::kill(process, signal);
    EXPECT_EQ(wait_for_program(folder, process).signal, signal);
    for (const std::string& name : names_in(folder / "clips")) {
      EXPECT_FALSE(name.ends_with(".partial")) << name;
      EXPECT_FALSE(name.starts_with("01-long.pinch")) << name;
    }
  }
}

// As nohup starts it: who logs out does not end it.
TEST(Batch, IgnoredSignalsDoNotStopIt) {
  const fs::path folder = folder_with_demos();
  write_scene(folder / "demos/01-long.json", 20.0);
  ::signal(SIGHUP, SIG_IGN);
  const pid_t process = start_program(folder, render);
  ::signal(SIGHUP, SIG_DFL);
  ASSERT_TRUE(wait_for_file(process, folder / "clips", ".partial"));
  ::kill(process, SIGHUP);
  const RunResult run = wait_for_program(folder, process);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_TRUE(run.err.starts_with("clips: 6 made, 0 up to date already, 0 failed")) << run.err;
}

TEST(Batch, OneRunAtATimeInAFolder) {
  const fs::path folder = folder_with_long_demo();
  const pid_t first = start_program(folder, render);
  ASSERT_TRUE(wait_for_file(first, folder / "clips", ".partial"));
  fs::create_directory(folder / "other");
  const RunResult second =
      run_program(folder / "other", {"render", "../demos", "--out", "../clips"});
  ::kill(first, SIGTERM);
  wait_for_program(folder, first);
  EXPECT_EQ(second.exit_code, 1);
  EXPECT_EQ(second.err,
            "../clips: another process is rendering into it; wait for it or use another --out\n");
}

}  // namespace
}  // namespace pinchlab
