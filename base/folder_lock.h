// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

namespace pinchlab {

/// One process at a time in a folder. The lock is on the folder itself and goes with the process.
class FolderLock {
 public:
  /// Throws std::runtime_error if there is no such folder, and with the message `taken` if another
  /// process has the lock.
  FolderLock(const std::filesystem::path& folder, const std::string& taken);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

}  // namespace pinchlab
