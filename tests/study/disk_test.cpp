// SPDX-License-Identifier: GPL-3.0-or-later
// A disk that does not take the answers: that is told, nothing is lost, and it goes on when there
// is room again.
#include <linux/capability.h>
#include <sys/mount.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>

#include <cerrno>
#include <cstring>

#include "base/answer_file.h"
#include "base/strict_json.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;

// A small disk of its own at `folder`, where the system allows to mount one.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder) : folder_(folder) {
    fs::create_directories(folder);
    is_there_ = ::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=128k") == 0;
    why_ = std::strerror(errno);
  }
  ~SmallDisk() {
    if (is_there_) {
      ::umount2(folder_.c_str(), MNT_DETACH);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;

  [[nodiscard]] bool is_there() const { return is_there_; }
  [[nodiscard]] const std::string& why() const { return why_; }
  void fill() const {
    std::ofstream file(folder_ / "ballast", std::ios::binary);
    for (int i = 0; i < 1000 && file; ++i) {
      file << std::string(1024, 'x') << std::flush;
    }
    EXPECT_FALSE(file) << "the disk is not full";
  }
  void empty() const { fs::remove(folder_ / "ballast"); }
  void set_read_only(bool is_read_only) const {
    const unsigned long flags = MS_REMOUNT | (is_read_only ? MS_RDONLY : 0);
    EXPECT_EQ(::mount("", folder_.c_str(), "", flags, nullptr), 0) << std::strerror(errno);
  }

 private:
  fs::path folder_;
  bool is_there_;
  std::string why_;
};

#define NEED_A_DISK(disk) \
  if (!(disk).is_there()) GTEST_SKIP() << "no disk can be mounted here: " << (disk).why()

// While `break_it` holds nothing is taken and everything is told so; after `mend_it` all goes on.
template <class Break, class Mend>
void expect_nothing_is_lost(const fs::path& folder, const Break& break_it, const Mend& mend_it) {
  Desk desk(desk_options(folder));
  const std::string token = desk.start("", "");
  desk.show(token, 0);
  break_it();
  EXPECT_EQ(refused([&] { desk.start("", ""); }), 503);
  EXPECT_EQ(refused([&] { desk.answer(token, parse_answer(answer_body(0))); }), 507);
  EXPECT_EQ(desk.progress(token).next, 0U) << "an answer that is not kept does not count";
  mend_it();
  desk.answer(token, parse_answer(answer_body(0)));
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}}) {
    desk.show(token, i);
    desk.answer(token, parse_answer(answer_body(i)));
  }
  break_it();
  for (int attempt = 0; attempt < 3; ++attempt) {
    EXPECT_EQ(refused([&] { desk.save(token, {}); }), 507);
    EXPECT_TRUE(answer_files(folder / "answers").empty()) << "nothing is there by halves";
  }
  mend_it();
  EXPECT_NE(desk.save(token, {}), "");
  const std::vector<fs::path> files = answer_files(folder / "answers");
  ASSERT_EQ(files.size(), 1U);
  EXPECT_EQ(read_json_file(files[0], 1U << 20U)["trials"].size(), 3U);
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder / "answers")) {
    EXPECT_NE(entry.path().extension(), ".partial") << entry.path();
  }
}

TEST(Disk, Full) {
  const fs::path folder = scratch_folder();
  const SmallDisk disk(folder / "answers");
  NEED_A_DISK(disk);
  expect_nothing_is_lost(
      folder, [&] { disk.fill(); }, [&] { disk.empty(); });
}

TEST(Disk, ReadOnly) {
  const fs::path folder = scratch_folder();
  const SmallDisk disk(folder / "answers");
  NEED_A_DISK(disk);
  expect_nothing_is_lost(
      folder, [&] { disk.set_read_only(true); }, [&] { disk.set_read_only(false); });
}

// Root writes whatever the permissions say, by a capability, which this thread lays down or takes
// up. Other users have none to lay down.
void bind_by_permissions(bool is_bound) {
  __user_cap_header_struct header = {_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3> sets = {};
  ASSERT_EQ(::syscall(SYS_capget, &header, sets.data()), 0);
  const unsigned override = 1U << CAP_DAC_OVERRIDE & sets[0].permitted;
  sets[0].effective = is_bound ? sets[0].effective & ~override : sets[0].effective | override;
  ASSERT_EQ(::syscall(SYS_capset, &header, sets.data()), 0) << std::strerror(errno);
}

TEST(Disk, NoPermission) {
  const fs::path folder = scratch_folder();
  const auto permit = [&](bool is_permitted) {
    for (const fs::path& path : {folder / "answers", folder / "answers" / ".running"}) {
      fs::permissions(path, is_permitted ? fs::perms::all : static_cast<fs::perms>(0555));
    }
    bind_by_permissions(!is_permitted);
  };
  expect_nothing_is_lost(
      folder, [&] { permit(false); }, [&] { permit(true); });
}

TEST(Disk, FolderThatCannotBeMadeIsToldWithItsCure) {
  const fs::path folder = scratch_folder();
  write_text(folder / "answers", "a file");
  try {
    Desk desk(desk_options(folder));
    FAIL() << "a file is no folder";
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("use another --answers"), std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace pinchlab::study
