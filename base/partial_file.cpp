// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/partial_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <system_error>
#include <utility>

#include "base/why_not_written.h"

namespace pinchlab {

namespace fs = std::filesystem;

namespace {

bool has_name(int file, const std::string& name) {
  struct stat held = {}, named = {};
  return ::fstat(file, &held) == 0 && ::lstat(name.c_str(), &named) == 0 &&
         held.st_dev == named.st_dev && held.st_ino == named.st_ino;
}

// Whoever has the lock of a file may rename or remove it.
bool lock(int file) {
  return ::flock(file, LOCK_EX | LOCK_NB) == 0;
}

// Whether there is a file that nobody has locked, and now there is none.
bool remove_left_over(const std::string& name) {
  const int file = ::open(name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return false;
  const bool is_removed = lock(file) && has_name(file, name) && ::unlink(name.c_str()) == 0;
  ::close(file);
  return is_removed;
}

}  // namespace

bool is_partial_of(std::string_view name, std::string_view path) {
  if (!name.ends_with(partial_ending)) return false;
  name.remove_suffix(partial_ending.size());
  if (name.ends_with(path)) return true;
  const std::size_t number = name.rfind('.');
  return number != std::string_view::npos && number + 1 < name.size() &&
         name.find_first_not_of("0123456789", number + 1) == std::string_view::npos &&
         name.substr(0, number).ends_with(path);
}

void make_folders(const fs::path& folder) {
  if (folder.empty()) {
    throw std::runtime_error("the name of a folder is empty; give it one, or . for this one");
  }
  std::error_code error;
  const fs::file_type there = fs::status(folder, error).type();
  if (there != fs::file_type::not_found && there != fs::file_type::none &&
      there != fs::file_type::directory) {
    throw std::runtime_error(folder.string() + ": is not a folder; name another one");
  }
  fs::create_directories(folder, error);
  if (error) {
    throw std::runtime_error(fmt::format("{}: the folder cannot be made: {}; name another one",
                                         folder.string(), error.message()));
  }
}

fs::path where_links_lead(const fs::path& path) {
  constexpr int most_links = 40;  // as the kernel has it
  fs::path place = path;
  std::error_code none;
  for (int i = 0; fs::is_symlink(fs::symlink_status(place, none)); ++i) {
    if (i == most_links) {
      throw std::runtime_error(path.string() +
                               ": is a symbolic link that leads nowhere; name a file");
    }
    place = place.parent_path() / fs::read_symlink(place);
  }
  return place;
}

PartialFile::PartialFile(std::string path, mode_t mode)
    : path_(std::move(path)), place_(where_links_lead(path_).string()) {
  if (path_.empty()) {
    throw std::runtime_error("the name of a file to write is empty; give it one");
  }
  const fs::path folder = fs::path(place_).parent_path();
  if (!folder.empty() && !fs::is_directory(folder)) {
    throw std::runtime_error(
        fmt::format("{}: the folder {} does not exist; create it first", path_, folder.string()));
  }
  if (fs::is_directory(path_)) {
    throw std::runtime_error(path_ + ": is a folder; give a file's name");
  }
  std::error_code none;
  const fs::file_type there = fs::status(place_, none).type();
  if (there != fs::file_type::regular && there != fs::file_type::not_found &&
      there != fs::file_type::none) {
    throw std::runtime_error(path_ +
                             ": is a device or a pipe, and not to be replaced; give a file's name");
  }
  // A store that links lead into is read only, that nobody may change what has its name there.
  const bool is_link = place_ != path_;
  if (is_link && ::access(place_.c_str(), F_OK) == 0 && ::access(place_.c_str(), W_OK) != 0) {
    throw error("cannot be written");
  }
  lock_ = make(mode);
}

// What has just been made may be taken for left over until it is locked: then once more.
int PartialFile::make(mode_t mode) {
  constexpr int most = 1000;
  for (int number = 1, attempts = 0; number <= most && attempts < 2 * most; ++attempts) {
    name_ = number == 1 ? place_ : fmt::format("{}.{}", place_, number);
    name_ += partial_ending;
    const int file = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (file >= 0) {
      const bool is_taken = !lock(file) && errno == EWOULDBLOCK;  // else there may be no locks here
      if (!is_taken && has_name(file, name_)) return file;
      ::close(file);
    } else if (errno != EEXIST) {
      throw error("cannot be written");
    } else if (!remove_left_over(name_)) {
      ++number;
    }
  }
  errno = EEXIST;
  throw error("cannot be written");
}

PartialFile::~PartialFile() {
  if (!kept_) {
    std::error_code ignored;
    fs::remove(name_, ignored);
  }
  ::close(lock_);
}

void PartialFile::keep() {
  std::error_code error;
  fs::rename(name_, place_, error);
  if (error) {
    throw std::runtime_error(path_ + ": cannot be put in place: " + error.message());
  }
  kept_ = true;
}

std::runtime_error PartialFile::error(std::string_view what) const {
  return std::runtime_error(fmt::format("{}: {}: {}", path_, what, why_not_written(errno)));
}

StagingFolder::StagingFolder(const fs::path& folder) : folder_(folder) {
  make_folders(folder);
  UnfinishedFolder::remove_left_over(folder);
  staging_.emplace(folder);
}

void StagingFolder::write(const std::string& name,
                          const std::function<void(std::ostream&)>& write_to) {
  std::ofstream file(path() / name, std::ios::binary);
  write_to(file);
  file.close();
  if (!file) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written; is the disk full?", (folder_ / name).string()));
  }
  add(name);
}

void StagingFolder::write(const std::string& name, std::string_view text) {
  write(name, [text](std::ostream& file) { file << text; });
}

std::vector<std::string> StagingFolder::keep() {
  for (const std::string& name : names_) {
    staging_->keep(name);
  }
  return std::exchange(names_, {});
}

}  // namespace pinchlab
