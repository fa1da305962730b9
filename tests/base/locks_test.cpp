// SPDX-License-Identifier: GPL-3.0-or-later
// Folders and files where the file system has no locks, as some of networks have none.
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

#include "base/folder_lock.h"
#include "base/partial_file.h"
#include "base/read_file.h"
#include "base/unfinished_folder.h"
#include "tests/base/message_of.h"
#include "tests/base/temporary_folder.h"

namespace {

bool has_no_locks = false;

// While it lives.
class NoLocks {
 public:
  NoLocks() { has_no_locks = true; }
  ~NoLocks() { has_no_locks = false; }
  NoLocks(const NoLocks&) = delete;
  NoLocks& operator=(const NoLocks&) = delete;
};

}  // namespace

// In the place of the C library's.
extern "C" int flock(int file, int operation) noexcept {
  if (has_no_locks) {
    errno = ENOLCK;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_flock, file, operation));
}

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using pinchlab::test::message_of;
using pinchlab::test::TemporaryFolder;

TEST(FolderLock, TellsWhyItCannotBeHad) {
  const TemporaryFolder folder;
  const NoLocks here;
  EXPECT_EQ(message_of<std::runtime_error>([&] { FolderLock(folder.path(), "taken"); }),
            folder.path().string() +
                ": the folder cannot be locked: No locks available; name another one");
}

TEST(UnfinishedFolder, NeedsNoLocks) {
  const TemporaryFolder folder;
  const NoLocks here;
  {
    StagingFolder staging(folder.path());
    staging.write("a", "x");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1);
    staging.keep();
  }
  EXPECT_EQ(read_whole(folder.path() / "a"), "x");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "nothing is left";
}

}  // namespace
}  // namespace pinchlab
