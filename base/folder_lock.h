// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>

namespace pinchlab {

/// Another process has the lock.
struct FolderTaken : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// One process at a time in a folder. The lock is on the folder itself and goes with the process.
class FolderLock {
 public:
  /// Throws FolderTaken with the message `taken` if another process has the lock, and
  /// std::runtime_error if there is no such folder or it cannot be locked.
  FolderLock(const std::filesystem::path& folder, const std::string& taken);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int folder_;
};

}  // namespace pinchlab
