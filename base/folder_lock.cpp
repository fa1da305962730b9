// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/folder_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace pinchlab {

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& taken)
    : folder_(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  if (folder_ < 0) {
    throw std::runtime_error(fmt::format("{}: the folder cannot be used: {}; name another one",
                                         folder.string(), std::strerror(errno)));
  }
  if (::flock(folder_, LOCK_EX | LOCK_NB) != 0) {
    const int why = errno;
    ::close(folder_);
    if (why == EWOULDBLOCK) throw FolderTaken(taken);
    throw std::runtime_error(fmt::format("{}: the folder cannot be locked: {}; name another one",
                                         folder.string(), std::strerror(why)));
  }
}

FolderLock::~FolderLock() {
  ::close(folder_);
}

}  // namespace pinchlab
