// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// START HERE for files: what is written gets its name only when it is whole. OutputFile,
// write_durably and every writer of pictures, videos and archives do it by this class.

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/unfinished_folder.h"

namespace pinchlab {

/// Ending of what is not finished; a leftover of an interrupted write is never a result.
inline constexpr std::string_view partial_ending = ".partial";

/// Makes a folder for results, and those above it, where they are missing. Throws
/// std::runtime_error with its name, the reason and the cure.
void make_folders(const std::filesystem::path& folder);

/// The path itself, or where it leads to in the end if it is a symbolic link, there or not yet.
/// Throws std::runtime_error where links go round.
std::filesystem::path where_links_lead(const std::filesystem::path& path);

/// Whether `name` is one under which PartialFile writes `path`, or any file whose name ends so:
/// "a.json.partial" and "a.json.2.partial" of "a.json" and of ".json".
bool is_partial_of(std::string_view name, std::string_view path);

/// The file is written as name() in the folder of its final path; keep() renames it, the destructor
/// removes it otherwise. A symbolic link stays one: what it leads to is written, if that may be.
///
/// The name is its final one with ".partial", or ".2.partial" and so on where others write that
/// file at the same time; the last to be kept stays. A lock that goes with the process tells what
/// is in use from what is left over, which makes room.
class PartialFile {
 public:
  /// Makes it, empty, with this mode less the umask. Throws std::runtime_error if it cannot be
  /// made, the folder does not exist, or the path is a folder, a device, a pipe or empty.
  explicit PartialFile(std::string path, mode_t mode = 0666);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& path() const { return path_; }
  const std::string& name() const { return name_; }

  void keep();  ///< Throws std::runtime_error.

  /// An error about this file with the system's reason (errno).
  std::runtime_error error(std::string_view what) const;

 private:
  int make(mode_t mode);

  std::string path_, place_, name_;  // the place: without links
  int lock_ = -1;                    // a descriptor of the file
  bool kept_ = false;
};

/// Takes files that belong together, in an UnfinishedFolder inside `folder`, until all are whole.
class StagingFolder {
 public:
  /// Makes `folder` too if it is missing, and clears it of what interrupted writers left. Throws
  /// std::runtime_error.
  explicit StagingFolder(const std::filesystem::path& folder);

  const std::filesystem::path& path() const { return staging_->path(); }
  /// Where the files will be.
  const std::filesystem::path& folder() const { return folder_; }
  /// What it has taken so far.
  const std::vector<std::string>& names() const { return names_; }

  /// Writes a file. Throws std::runtime_error.
  void write(const std::string& name, const std::function<void(std::ostream&)>& write_to);
  void write(const std::string& name, std::string_view text);
  /// Takes note of a file that another program has put here.
  void add(const std::string& name) { names_.push_back(name); }

  /// Moves all files to `folder` and returns their names, in the order in which they came.
  std::vector<std::string> keep();

 private:
  std::filesystem::path folder_;
  std::optional<UnfinishedFolder> staging_;
  std::vector<std::string> names_;
};

}  // namespace pinchlab
