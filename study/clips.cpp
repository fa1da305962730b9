// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/clips.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "base/did_you_mean.h"
#include "base/sha256.h"
#include "base/strict_json.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t largest_manifest = 16U << 20U;  // bytes

// The manifest's clips: file name to SHA-256.
std::map<std::string, std::string> read_hashes(const fs::path& folder) {
  const fs::path path = folder / "manifest.json";
  std::map<std::string, std::string> hashes;
  if (!fs::exists(path)) {
    return hashes;
  }
  const json manifest = read_json_file(path, largest_manifest);
  const bool is_ours = manifest.is_object() &&
                       manifest.value("format", json()) == "pinchlab clips 1" &&
                       manifest.value("clips", json()).is_array();
  if (!is_ours) {
    throw std::runtime_error(
        fmt::format("{}: is not a manifest of this program; render the clips anew", path.string()));
  }
  for (const json& entry : manifest["clips"]) {
    const bool is_entry = entry.is_object() && entry.value("file", json()).is_string() &&
                          entry.value("sha256", json()).is_string();
    if (!is_entry) {
      throw std::runtime_error(
          fmt::format("{}: a clip without file or sha256; render the clips anew", path.string()));
    }
    hashes[entry["file"]] = entry["sha256"];
  }
  return hashes;
}

// The file that has the method under test, or the right answer, on this side.
std::string file_name(const std::string& demonstration, PairKind kind, Side side,
                      Encoding encoding) {
  const char* role = kind == PairKind::check ? (side == Side::left ? "check-left" : "check-right")
                     : side == Side::left    ? "left-pinch"
                                             : "left-baseline";
  return fmt::format("{}.{}.{}", demonstration, role, to_string(encoding));
}

// What tells a player to skip the padding: an MP4 box of type "free" (ISO/IEC 14496-12, 8.1.2), or
// a Void element (RFC 8794, 11.3.2), both with a length of 8 bytes.
std::string padding_head(Encoding encoding, std::uint64_t size) {
  std::string head =
      encoding == Encoding::mp4 ? std::string("\0\0\0\1free", 8) : std::string("\xEC", 1);
  // An MP4 box counts its head, an EBML element does not and marks the length's own length.
  const std::uint64_t length =
      encoding == Encoding::mp4 ? size : (size - 9) | (std::uint64_t{1} << 56U);
  for (unsigned shift = 64; shift > 0; shift -= 8) {
    head += static_cast<char>((length >> (shift - 8)) & 0xFFU);
  }
  return head;
}

std::unique_ptr<Clip> open_checked(const fs::path& folder, const std::string& name,
                                   Encoding encoding,
                                   const std::map<std::string, std::string>& hashes) {
  auto clip = std::make_unique<Clip>(folder / name, encoding);
  const auto known = hashes.find(name);
  if (known != hashes.end() && known->second != clip->sha256()) {
    throw std::runtime_error(
        fmt::format("{}: is not the clip that manifest.json lists (another SHA-256); remove it to "
                    "have it rendered anew",
                    (folder / name).string()));
  }
  return clip;
}

ClipPair open_pair(const fs::path& folder, const std::string& left, const std::string& right,
                   Encoding encoding, const std::map<std::string, std::string>& hashes) {
  return {open_checked(folder, left, encoding, hashes),
          open_checked(folder, right, encoding, hashes)};
}

PairFiles open_rendered(const fs::path& folder, const std::string& name, PairKind kind,
                        const std::map<std::string, std::string>& hashes) {
  const auto open = [&](Encoding encoding) {
    return open_pair(folder, file_name(name, kind, Side::left, encoding),
                     file_name(name, kind, Side::right, encoding), encoding, hashes);
  };
  PairFiles files{open(Encoding::mp4), std::nullopt};
  if (hashes.contains(file_name(name, kind, Side::left, Encoding::webm)) &&
      hashes.contains(file_name(name, kind, Side::right, Encoding::webm))) {
    files.webm = open(Encoding::webm);
  }
  return files;
}

// A file that is the researcher's own to make; `cure` says how.
void need_file(const fs::path& path, const std::string& cure) {
  if (fs::exists(path)) return;
  throw std::runtime_error(fmt::format("{}: there is no such clip; {}", path.string(), cure));
}

// Every pair of methods in every demonstration; WebM where both of its files are there.
void open_comparisons(const fs::path& folder, const Config& config,
                      const std::map<std::string, std::string>& hashes, Clips& clips) {
  for (const std::string& demonstration : config.demonstrations) {
    for (std::size_t i = 0; i < config.methods.size(); ++i) {
      for (std::size_t j = i + 1; j < config.methods.size(); ++j) {
        const std::string &first = config.methods[i], &second = config.methods[j];
        const auto file = [&](bool is_left, Encoding encoding) {
          return comparison_file(demonstration, is_left ? first : second, is_left ? second : first,
                                 to_string(encoding));
        };
        const auto open = [&](Encoding encoding) {
          return open_pair(folder, file(true, encoding), file(false, encoding), encoding, hashes);
        };
        for (const bool is_left : {true, false}) {
          need_file(folder / file(is_left, Encoding::mp4),
                    fmt::format("pinchlab render demos/{}.json --pair {},{} --out {} makes it",
                                demonstration, first, second, folder.string()));
        }
        PlannedTrial trial;
        trial.demonstration = demonstration;
        trial.first = first;
        trial.second = second;
        PairFiles files{open(Encoding::mp4), std::nullopt};
        if (fs::exists(folder / file(true, Encoding::webm)) &&
            fs::exists(folder / file(false, Encoding::webm))) {
          files.webm = open(Encoding::webm);
        }
        clips.emplace(clip_key(trial), std::move(files));
      }
    }
  }
}

// All clips of an encoding get the size of the largest, so that a size tells neither the side of a
// method nor which demonstration it is.
void pad(const Clips& clips) {
  constexpr std::uint64_t head = 16;  // bytes of padding, at least
  const auto for_each = [&](Encoding encoding, const auto& visit) {
    for (const auto& [name, files] : clips) {
      const ClipPair* pair = encoding == Encoding::mp4 ? &files.mp4
                             : files.webm              ? &*files.webm
                                                       : nullptr;
      if (pair != nullptr) {
        visit(*pair->left);
        visit(*pair->right);
      }
    }
  };
  for (const Encoding encoding : {Encoding::mp4, Encoding::webm}) {
    std::uint64_t largest = 0;
    for_each(encoding, [&](const Clip& clip) { largest = std::max(largest, clip.file_size()); });
    for_each(encoding, [&](Clip& clip) { clip.pad_to(largest + head); });
  }
}

}  // namespace

const char* to_string(Encoding encoding) {
  return encoding == Encoding::mp4 ? "mp4" : "webm";
}

Clip::Clip(const fs::path& path, Encoding encoding)
    : name_(path.filename().string()), encoding_(encoding) {
  sha256_ = sha256_of_file(path);
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  struct stat status = {};
  const bool is_open = file_ >= 0 && ::fstat(file_, &status) == 0;
  if (!is_open || !S_ISREG(status.st_mode)) {
    const std::string why = is_open ? "is no ordinary file" : std::strerror(errno);
    if (file_ >= 0) ::close(file_);
    throw std::runtime_error(fmt::format("{}: cannot be opened: {}", path.string(), why));
  }
  file_size_ = served_size_ = static_cast<std::uint64_t>(status.st_size);
}

Clip::~Clip() {
  if (file_ >= 0) {
    ::close(file_);
  }
}

void Clip::pad_to(std::uint64_t served_size) {
  served_size_ = served_size;
  padding_head_ = padding_head(encoding_, served_size - file_size_);
}

std::string Clip::read(std::uint64_t offset, std::size_t length) const {
  std::string bytes;
  while (bytes.size() < length && offset + bytes.size() < file_size_) {
    const std::uint64_t at = offset + bytes.size();
    std::string part(std::min<std::uint64_t>(length - bytes.size(), file_size_ - at), '\0');
    const ssize_t got = ::pread(file_, part.data(), part.size(), static_cast<off_t>(at));
    if (got == 0 || (got < 0 && errno != EINTR)) {
      throw std::runtime_error(name_ + ": cannot be read any more");
    }
    bytes.append(part, 0, got > 0 ? static_cast<std::size_t>(got) : 0);
  }
  while (bytes.size() < length && offset + bytes.size() < served_size_) {
    const std::uint64_t in_padding = offset + bytes.size() - file_size_;
    if (in_padding < padding_head_.size()) {
      bytes += padding_head_[in_padding];
    } else {
      const std::uint64_t rest = served_size_ - offset - bytes.size();
      bytes.append(std::min<std::uint64_t>(length - bytes.size(), rest), '\0');
    }
  }
  return bytes;
}

std::vector<std::string> rendered_pairs(const fs::path& folder, PairKind kind, Encoding encoding) {
  const std::map<std::string, std::string> hashes = read_hashes(folder);
  const std::string ending = file_name("", kind, Side::left, encoding);
  std::vector<std::string> names;
  for (const auto& [file, sha] : hashes) {
    const std::string name =
        file.ends_with(ending) ? file.substr(0, file.size() - ending.size()) : "";
    if (name.empty()) {
      continue;
    }
    const std::string other = file_name(name, kind, Side::right, encoding);
    if (hashes.contains(other) && fs::exists(folder / file) && fs::exists(folder / other)) {
      names.push_back(name);
    }
  }
  return names;
}

Clips open_clips(const fs::path& folder, const Config& config) {
  const std::map<std::string, std::string> hashes = read_hashes(folder);
  const auto open = [&](const std::string& name, PairKind kind) {
    const std::vector<std::string> known = rendered_pairs(folder, kind, Encoding::mp4);
    if (std::ranges::find(known, name) == known.end()) {
      throw std::runtime_error(
          fmt::format("{}: has no {} of `{}`{}; pinchlab render {} makes them", folder.string(),
                      kind == PairKind::check ? "attention check" : "side-by-side clips", name,
                      did_you_mean(name, known),
                      kind == PairKind::check ? "--attention-checks" : "--side-by-side"));
    }
    return open_rendered(folder, name, kind, hashes);
  };
  Clips clips;
  const bool is_plain = config.methods.empty() && config.graded.empty();
  for (const auto* names : {&config.demonstrations, &config.training}) {
    for (const std::string& name : *names) {
      if (!clips.contains(name) && (is_plain || names == &config.training)) {
        clips.emplace(name, open(name, PairKind::methods));
      }
    }
  }
  open_comparisons(folder, config, hashes, clips);
  for (const GradedStimulus& stimulus : config.graded) {
    for (const std::string* file : {&stimulus.left, &stimulus.right}) {
      need_file(folder / *file,
                "`series` of the configuration names it; pinchlab render --only-side-by-side makes "
                "such clips (study/README.md, Thresholds)");
    }
    clips.emplace(clip_key(stimulus.clip),
                  PairFiles{open_pair(folder, stimulus.left, stimulus.right, Encoding::mp4, hashes),
                            std::nullopt});
  }
  for (const AttentionCheck& check : config.attention_checks) {
    for (const std::string* file : {&check.left, &check.right}) {
      if (check.demonstration.empty())
        need_file(folder / *file, "`attention_checks` of the configuration names it");
    }
    if (clips.contains(check.name)) {
      throw std::runtime_error(fmt::format(
          "attention check `{}` has the name of a demonstration; give it another", check.name));
    }
    clips.emplace(check.name,
                  check.demonstration.empty()
                      ? PairFiles{open_pair(folder, check.left, check.right, Encoding::mp4, hashes),
                                  std::nullopt}
                      : open(check.demonstration, PairKind::check));
  }
  pad(clips);
  return clips;
}

std::vector<std::string> same_clips(const Clips& clips) {
  std::vector<std::string> sentences;
  for (const auto& [name, files] : clips) {
    const Clip &left = *files.mp4.left, &right = *files.mp4.right;
    if (left.sha256() != right.sha256()) continue;
    sentences.push_back(
        fmt::format("the pair `{}` cannot be told apart: {} and {} are the same (SHA-256); look at "
                    "them, and render them anew or leave the pair out",
                    name, left.name(), right.name()));
  }
  return sentences;
}

}  // namespace pinchlab::study
