// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/unfinished_folder.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "base/why_not_written.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = ".unfinished-";

fs::path make(const fs::path& folder) {
  std::string name = (folder / prefix).string() + "XXXXXX";
  if (::mkdtemp(name.data()) == nullptr) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written into: {}", folder.string(), why_not_written(errno)));
  }
  return name;
}

}  // namespace

UnfinishedFolder::UnfinishedFolder(fs::path folder) : folder_(std::move(folder)) {
  // Until it is locked, another process may take it for left over.
  for (int attempts = 100; attempts > 0; --attempts) {
    path_ = make(folder_);
    std::error_code ignored;
    try {
      lock_.emplace(path_, "");
    } catch (const FolderTaken&) {
      fs::remove(path_, ignored);
      continue;
    } catch (const std::runtime_error&) {  // there may be no locks here, or it has just gone
    }
    if (fs::exists(path_)) return;
    lock_.reset();
  }
  throw std::runtime_error(path_.string() + ": is in use");
}

UnfinishedFolder::~UnfinishedFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void UnfinishedFolder::keep(const std::string& file) const {
  fs::rename(path_ / file, folder_ / file);
}

void UnfinishedFolder::remove_left_over(const fs::path& folder) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with(prefix)) found.push_back(entry.path());
  }
  for (const fs::path& path : found) {
    try {
      const FolderLock lock(path, "");
      fs::remove_all(path);
    } catch (const std::runtime_error&) {  // somebody is at work in it, or it has just gone
    }
  }
}

}  // namespace pinchlab
