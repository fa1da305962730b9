// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ostream>
#include <string>

#include "base/durable_file.h"
#include "base/folder_lock.h"
#include "base/input_error.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/read_file.h"
#include "base/why_not_written.h"
#include "tests/base/message_of.h"
#include "tests/base/temporary_folder.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using pinchlab::test::message_of;
using pinchlab::test::TemporaryFolder;

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(ReadFile, WholeAndByPieces) {
  const TemporaryFolder folder;
  const std::string text = std::string(200'000, 'x') + '\0' + "end";  // more than one piece
  const fs::path path = folder.write("a", text);
  EXPECT_EQ(read_whole(path), text);
  std::string pieces;
  read_by_pieces(path, [&](std::string_view piece) { pieces += piece; });
  EXPECT_EQ(pieces, text);
  EXPECT_EQ(read_whole(folder.write("empty", "")), "");
}

TEST(ReadFile, RefusesWhatIsTooLargeAbsentOrNoFile) {
  const TemporaryFolder folder;
  const fs::path path = folder.write("a", "12345");
  EXPECT_EQ(read_whole(path, 5), "12345");
  EXPECT_EQ(message_of<InputError>([&] { read_whole(path, 4); }),
            path.string() + ": is larger than 4 bytes");
  const std::string absent = (folder.path() / "b").string();
  EXPECT_EQ(message_of<InputError>([&] { read_whole(absent); }),
            absent + ": cannot be opened: No such file or directory");
  EXPECT_EQ(message_of<InputError>([&] { read_whole(folder.path()); }),
            folder.path().string() + ": cannot be read: Is a directory");
}

TEST(OutputFile, AppearsWhenItIsWhole) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.csv";
  {
    OutputFile file(path);
    file.write("one");
    EXPECT_FALSE(fs::exists(path));
    file.write("two");
    file.finish();
  }
  EXPECT_EQ(read_whole(path), "onetwo");
  {
    OutputFile file(path);
    file.write("three");
  }
  EXPECT_EQ(read_whole(path), "onetwo") << "what was not finished changed the file";
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, WritesDirectlyToWhatIsNoOrdinaryFile) {
  OutputFile file("/dev/null");
  file.write("x");
  EXPECT_NO_THROW(file.finish());
  OutputFile full("/dev/full");
  full.write("x");
  EXPECT_EQ(message_of<std::runtime_error>([&] { full.finish(); }),
            "/dev/full: cannot be written: No space left on device");
}

// As root a link in /dev would be gone for the whole machine.
TEST(OutputFile, GoesOnWithAFileThatIsOpenAlready) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "file";
  const fs::path link = folder.path() / "stdout";
  std::FILE* const open = std::fopen(file.c_str(), "wb");
  ASSERT_NE(open, nullptr);
  std::fputs("before, ", open);
  std::fflush(open);
  fs::create_symlink("/proc/self/fd/" + std::to_string(::fileno(open)), link);
  {
    OutputFile out(link);
    out.write("one, ");
    out.finish();
  }
  write_result(link, "two, ");
  std::fputs("after", open);
  std::fclose(open);
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(read_whole(file), "before, one, two, after");
  EXPECT_EQ(files_in(folder.path()), 2U);
}

TEST(PartialFile, WritesWhatALinkLeadsTo) {
  const TemporaryFolder folder;
  const fs::path inner = folder.path() / "inner";
  fs::create_directory(inner);
  fs::create_symlink("inner/second", folder.path() / "first");  // relative to where it lies
  fs::create_symlink("file", inner / "second");
  for (const char* text : {"not there yet", "there"}) {
    OutputFile out(folder.path() / "first");
    out.write(text);
    out.finish();
    EXPECT_EQ(read_whole(inner / "file"), text);
  }
  write_durably(folder.path() / "first", "durable");
  EXPECT_EQ(read_whole(inner / "file"), "durable");
  EXPECT_TRUE(fs::is_symlink(folder.path() / "first"));
  EXPECT_TRUE(fs::is_symlink(inner / "second"));
  EXPECT_FALSE(fs::is_symlink(inner / "file"));
  EXPECT_EQ(files_in(folder.path()), 2U);
  EXPECT_EQ(files_in(inner), 2U);
}

TEST(PartialFile, TwoWritersOfOneFileDoNotMix) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a";
  OutputFile first(path), second(path);
  first.write("first");
  second.write("second, which is longer");
  write_durably(path, "third");
  EXPECT_EQ(read_whole(path), "third");
  second.finish();
  EXPECT_EQ(read_whole(path), "second, which is longer");
  first.finish();
  EXPECT_EQ(read_whole(path), "first");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(PartialFile, WhatAKilledProcessLeftMakesRoom) {
  const TemporaryFolder folder;
  const std::string path = folder.file("a");
  const pid_t process = ::fork();
  if (process == 0) {
    const PartialFile file(path);
    ::raise(SIGKILL);
  }
  ASSERT_EQ(::waitpid(process, nullptr, 0), process);
  EXPECT_TRUE(fs::exists(path + ".partial"));
  EXPECT_FALSE(fs::exists(path));
  {
    const PartialFile file(path);
    EXPECT_EQ(file.name(), path + ".partial");
    EXPECT_EQ(PartialFile(path).name(), path + ".2.partial");
  }
  EXPECT_TRUE(folder.empty());
}

TEST(PartialFile, WritesNothingThatLiesUnderItsName) {
  const TemporaryFolder folder;
  const fs::path theirs = folder.write("theirs", "as it was");
  fs::create_symlink(theirs, folder.path() / "a.partial");
  fs::create_directory(folder.path() / "a.2.partial");
  write_result(folder.path() / "a", "mine");
  EXPECT_EQ(read_whole(folder.path() / "a"), "mine");
  EXPECT_EQ(read_whole(theirs), "as it was");
}

// As root they would be gone for the whole machine.
TEST(PartialFile, ReplacesNoDevices) {
  const TemporaryFolder folder;
  const std::string link = folder.file("link.png"), pipe = folder.file("pipe");
  fs::create_symlink("/dev/null", link);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {link, pipe}) {
    EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(path); }),
              path + ": is a device or a pipe, and not to be replaced; give a file's name");
  }
  EXPECT_EQ(files_in(folder.path()), 2U);
}

TEST(PartialFile, NamesTellWhatTheyAreOf) {
  EXPECT_TRUE(is_partial_of("a.json.partial", "a.json"));
  EXPECT_TRUE(is_partial_of("a.json.12.partial", ".json"));
  for (const char* other : {"a.json", "a.jso.partial", "a.json.x.partial", "a.json..partial"}) {
    EXPECT_FALSE(is_partial_of(other, ".json")) << other;
  }
}

TEST(PartialFile, ChangesNothingReadOnlyThatALinkLeadsTo) {
  if (::geteuid() == 0) GTEST_SKIP() << "root may write everything";
  const TemporaryFolder folder;
  const fs::path stored = folder.write("stored", "as it was");
  const std::string link = (folder.path() / "link").string();
  fs::create_symlink(stored, link);
  fs::permissions(stored, fs::perms::owner_read);
  EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(link); }),
            link + ": cannot be written: Permission denied; name a place that you may write to");
  EXPECT_EQ(read_whole(stored), "as it was");
}

TEST(PartialFile, TellsOfLinksThatLeadNowhere) {
  const TemporaryFolder folder;
  const std::string round = (folder.path() / "round").string();
  const std::string away = (folder.path() / "away").string();
  fs::create_symlink("round", round);
  fs::create_symlink("none/a", away);
  EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(round); }),
            round + ": is a symbolic link that leads nowhere; name a file");
  EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(away); }),
            away + ": the folder " + (folder.path() / "none").string() +
                " does not exist; create it first");
  EXPECT_TRUE(fs::is_symlink(round) && fs::is_symlink(away));
}

TEST(PartialFile, TellsWhereItCannotBe) {
  const TemporaryFolder folder;
  const std::string inside = (folder.path() / "none/a").string();
  EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(inside); }),
            inside + ": the folder " + (folder.path() / "none").string() +
                " does not exist; create it first");
  EXPECT_EQ(message_of<std::runtime_error>([&] { PartialFile file(folder.path().string()); }),
            folder.path().string() + ": is a folder; give a file's name");
}

TEST(Folders, AreMadeWithThoseAboveOrSayWhyNot) {
  const TemporaryFolder folder;
  make_folders(folder.path() / "a" / "b");
  make_folders(folder.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
  const std::string file = folder.write("file", "x").string();
  const auto mistake = [](const std::string& path) {
    return message_of<std::runtime_error>([&] { make_folders(path); });
  };
  EXPECT_EQ(mistake(file), file + ": is not a folder; name another one");
  EXPECT_EQ(mistake(file + "/below"),
            file + "/below: the folder cannot be made: Not a directory; name another one");
  EXPECT_EQ(mistake(""), "the name of a folder is empty; give it one, or . for this one");
}

TEST(Folders, ThatCannotBeWrittenIntoSayWhyAndTheCure) {
  EXPECT_EQ(why_not_written(EACCES), "Permission denied; name a place that you may write to");
  EXPECT_EQ(why_not_written(ENOSPC), "No space left on device");
  // Nobody makes a file there, not even root.
  const std::string message =
      message_of<std::runtime_error>([] { const StagingFolder staging("/proc/self"); });
  EXPECT_TRUE(message.starts_with("/proc/self: cannot be written into: ")) << message;
  EXPECT_EQ(message_of<std::runtime_error>([] { const FolderLock lock("/proc/none", ""); }),
            "/proc/none: the folder cannot be used: No such file or directory; name another one");
}

// A disk that is full, as the kernel plays one.
TEST(Results, OfEachKindSayAlikeThatTheDiskIsFull) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "there is no /dev/full";
  const std::string text(100'000, 'x');
  EXPECT_EQ(message_of<std::runtime_error>([&] { write_result("/dev/full", text); }),
            "/dev/full: cannot be written: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
  const TemporaryFolder folder;
  write_result(folder.path() / "file", text);
  EXPECT_EQ(read_whole(folder.path() / "file"), text);
}

TEST(StagingFolder, FilesAppearTogetherOrNotAtAll) {
  const TemporaryFolder folder;
  const fs::path out = folder.path() / "made/on the way";
  {
    StagingFolder staging(out);
    staging.write("a", "1");
  }
  EXPECT_EQ(files_in(out), 0U);
  {
    StagingFolder staging(out);
    staging.write("a", "1");
    staging.write("b", [](std::ostream& file) { file << 2; });
    fs::copy_file(staging.path() / "a", staging.path() / "c");
    staging.add("c");
    EXPECT_FALSE(fs::exists(out / "a"));
    EXPECT_EQ(staging.keep(), (std::vector<std::string>{"a", "b", "c"}));
  }
  EXPECT_EQ(read_whole(out / "b"), "2");
  EXPECT_EQ(read_whole(out / "c"), "1");
  EXPECT_EQ(files_in(out), 3U);
  EXPECT_THROW(StagingFolder{out / "a"}, std::runtime_error) << "a file is no folder";
}

// What an interrupted writer left goes; what another one is at work in stays.
TEST(StagingFolder, ClearsAwayWhatIsLeftOver) {
  const TemporaryFolder folder;
  folder.write(".unfinished-12345/report.html", "half");
  folder.write("a", "1");
  StagingFolder other(folder.path());
  other.write("b", "2");
  EXPECT_FALSE(fs::exists(folder.path() / ".unfinished-12345"));
  {
    StagingFolder staging(folder.path());
    EXPECT_TRUE(fs::exists(other.path() / "b"));
    staging.write("c", "3");
    staging.keep();
  }
  other.keep();
  EXPECT_EQ(read_whole(folder.path() / "b"), "2");
  EXPECT_EQ(read_whole(folder.path() / "a"), "1");
}

TEST(OutputFile, TellsBeforehandWhatCannotBeWritten) {
  const TemporaryFolder folder;
  const fs::path inside = folder.path() / "none/a";
  EXPECT_EQ(message_of<std::runtime_error>([&] { check_can_be_written(inside); }),
            inside.string() + ": the folder " + inside.parent_path().string() +
                " does not exist; create it first");
  const fs::path there = folder.write("there", "as it was");
  for (const fs::path& path : {there, folder.path() / "new", fs::path("-"), fs::path("/dev/null")})
    EXPECT_NO_THROW(check_can_be_written(path)) << path;
  EXPECT_EQ(read_whole(there), "as it was");
  EXPECT_EQ(files_in(folder.path()), 1U);
}

TEST(OutputFile, KnowsOneFileByItsNames) {
  const TemporaryFolder folder;
  const fs::path a = folder.path() / "a";
  EXPECT_TRUE(is_same_file(a, folder.path() / "." / "x" / ".." / "a"));
  EXPECT_TRUE(is_same_file("x.csv", "./x.csv"));
  EXPECT_TRUE(is_same_file("-", "-"));
  EXPECT_FALSE(is_same_file("-", "./-"));
  EXPECT_FALSE(is_same_file("", ""));
  EXPECT_FALSE(is_same_file(a, folder.path() / "b"));
  fs::create_symlink(folder.path(), folder.path() / "here");
  EXPECT_TRUE(is_same_file(a, folder.path() / "here" / "a"));
  fs::create_symlink("a", folder.path() / "link");  // a is not there yet
  EXPECT_TRUE(is_same_file(a, folder.path() / "link"));
}

TEST(DurableFile, FailureLeavesNothing) {
  const TemporaryFolder folder;
  EXPECT_THROW(write_durably(folder.path() / "missing/a.json", "x"), std::runtime_error);
  fs::create_directory(folder.path() / "a.json");
  EXPECT_THROW(write_durably(folder.path() / "a.json", "x"), std::runtime_error);
  EXPECT_EQ(files_in(folder.path()), 1U);
  // The name under which it is written for the time being is nobody's concern.
  const std::string path = (folder.path() / std::string(250, 'a')).string();
  EXPECT_EQ(message_of<std::runtime_error>([&] { write_durably(path, "x"); }),
            path + ": cannot be written: File name too long");
}

TEST(DurableFile, OnlyTheUserReads) {
  const TemporaryFolder folder;
  const fs::path path = folder.path() / "a.json";
  write_durably(path, "x");
  write_durably(path, "y");
  EXPECT_EQ(read_whole(path), "y");
  struct stat status = {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  remove_durably(path);
  remove_durably(path);
  EXPECT_EQ(files_in(folder.path()), 0U);
}

// Results are as public as the umask has other files; who writes answers says otherwise.
TEST(WriteResult, HasTheModeOfOtherFiles) {
  const TemporaryFolder folder;
  const mode_t before = ::umask(027);
  write_result(folder.path() / "result", "x");
  write_result(folder.path() / "answers", "x", only_the_user);
  ::umask(before);
  const auto mode = [&](const char* name) {
    struct stat status = {};
    EXPECT_EQ(::stat((folder.path() / name).c_str(), &status), 0);
    return status.st_mode & 0777U;
  };
  EXPECT_EQ(mode("result"), 0640U);
  EXPECT_EQ(mode("answers"), 0600U);
}

TEST(FolderLock, OneAtATime) {
  const TemporaryFolder folder;
  {
    const FolderLock lock(folder.path(), "taken");
    EXPECT_EQ(message_of<std::runtime_error>([&] { FolderLock(folder.path(), "taken"); }), "taken");
  }
  EXPECT_NO_THROW(FolderLock(folder.path(), "taken")) << "the lock went with its owner";
  EXPECT_THROW(FolderLock(folder.path() / "none", "taken"), std::runtime_error);
}

}  // namespace
}  // namespace pinchlab
