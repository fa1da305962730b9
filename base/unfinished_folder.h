// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "base/folder_lock.h"

namespace pinchlab {

/// A folder of this object's own inside another one (so that renaming cannot cross file systems),
/// for files that are not finished. Its lock goes with the process, so that others know what is
/// left over. The destructor removes it with all that has not been kept.
class UnfinishedFolder {
 public:
  /// `folder` must exist. Throws std::runtime_error where it cannot be written into.
  explicit UnfinishedFolder(std::filesystem::path folder);
  ~UnfinishedFolder();
  UnfinishedFolder(const UnfinishedFolder&) = delete;
  UnfinishedFolder& operator=(const UnfinishedFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Moves a file of it to the folder around it. Throws std::filesystem::filesystem_error.
  void keep(const std::string& file) const;

  /// Removes those in `folder` of processes that have ended.
  static void remove_left_over(const std::filesystem::path& folder);

 private:
  std::filesystem::path folder_, path_;
  std::optional<FolderLock> lock_;
};

}  // namespace pinchlab
