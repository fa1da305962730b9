// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/durable_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>

#include "base/partial_file.h"
#include "base/read_file.h"
#include "base/why_not_written.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const fs::path& path, const char* what) {
  throw std::runtime_error(fmt::format("{}: {}: {}", path.string(), what, why_not_written(errno)));
}

class File {
 public:
  /// Errors are about `path`, whatever the name is that it is opened by.
  File(const fs::path& path, const fs::path& opened, int flags, const char* what)
      : path_(path), file_(::open(opened.c_str(), flags | O_CLOEXEC)) {
    if (file_ < 0) {
      fail(path, what);
    }
  }
  ~File() {
    if (file_ >= 0) {
      ::close(file_);
    }
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void write(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(file_, bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) {
        fail(path_, "cannot be written");
      }
      bytes.remove_prefix(written > 0 ? static_cast<std::size_t>(written) : 0);
    }
  }
  void sync() const {
    if (::fsync(file_) != 0) {
      fail(path_, "cannot be brought to the disk");
    }
  }
  // Some file systems tell of a full disk only now.
  void close() {
    const int file = file_;
    file_ = -1;
    if (::close(file) != 0) {
      fail(path_, "cannot be written");
    }
  }

 private:
  fs::path path_;
  int file_;
};

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

void sync_folder(const fs::path& path) {
  const fs::path folder = folder_of(path);
  File(folder, folder, O_RDONLY | O_DIRECTORY, "cannot be opened").sync();
}

}  // namespace

void write_durably(const fs::path& path, std::string_view bytes, mode_t mode) {
  PartialFile partial(path.string(), mode);
  File file(path, partial.name(), O_WRONLY, "cannot be made");
  file.write(bytes);
  file.sync();
  file.close();
  if (read_whole(partial.name()) != bytes) {
    throw std::runtime_error(
        fmt::format("{}: the disk holds something else than was written", path.string()));
  }
  partial.keep();
  sync_folder(partial.name());
}

void remove_durably(const fs::path& path) {
  if (::unlink(path.c_str()) != 0 && errno != ENOENT) {
    fail(path, "cannot be removed");
  }
  sync_folder(path);
}

}  // namespace pinchlab
