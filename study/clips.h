// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The stimuli: side-by-side clips as manifest.json lists them.

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "study/config.h"

namespace pinchlab::study {

enum class Encoding { mp4, webm };

const char* to_string(Encoding encoding);  ///< "mp4", "webm": also the ending of the file

/// One file that participants are shown, open and checked. What is served is the file followed by
/// padding that a player skips, so that all clips of a study have the same size.
class Clip {
 public:
  /// Opens the file, and takes its SHA-256. Throws std::runtime_error.
  Clip(const std::filesystem::path& path, Encoding encoding);
  ~Clip();
  Clip(const Clip&) = delete;
  Clip& operator=(const Clip&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::string& sha256() const { return sha256_; }
  [[nodiscard]] std::uint64_t file_size() const { return file_size_; }      ///< bytes
  [[nodiscard]] std::uint64_t served_size() const { return served_size_; }  ///< bytes
  void pad_to(std::uint64_t served_size);

  /// `length` bytes of what is served from `offset` on, fewer at the end. Throws
  /// std::runtime_error if the file cannot be read any more.
  [[nodiscard]] std::string read(std::uint64_t offset, std::size_t length) const;

 private:
  std::string name_, sha256_, padding_head_;
  Encoding encoding_;
  int file_ = -1;
  std::uint64_t file_size_ = 0, served_size_ = 0;
};

/// The files of one pair in one encoding, by the side of the method under test (in attention
/// checks: of the right answer).
struct ClipPair {
  std::unique_ptr<Clip> left, right;
  [[nodiscard]] const Clip& at(Side side) const { return side == Side::left ? *left : *right; }
};

struct PairFiles {
  ClipPair mp4;
  std::optional<ClipPair> webm;
  [[nodiscard]] const ClipPair& in(Encoding encoding) const {
    return encoding == Encoding::mp4 ? mp4 : webm.value();
  }
};

/// All pairs of a study, by clip_key() of their trials: the name of the demonstration or attention
/// check, with methods or level where there are any.
using Clips = std::map<std::string, PairFiles>;

/// What is rendered of a demonstration: its two methods, or an attention check.
enum class PairKind { methods, check };

/// Names of the demonstrations of which a folder's manifest.json lists both files of that kind, in
/// order. Empty if there is no manifest. Throws std::runtime_error if it is not one of ours.
std::vector<std::string> rendered_pairs(const std::filesystem::path& folder, PairKind kind,
                                        Encoding encoding);

/// Opens all clips that `config` needs and checks each against the manifest's SHA-256. WebM is
/// offered for the pairs that have it. All clips of an encoding are padded to one size. Throws
/// std::runtime_error with the file and the cure.
Clips open_clips(const std::filesystem::path& folder, const Config& config);

/// A sentence a pair whose two files are the same: nobody can tell by them which method, or which
/// answer, is on which side.
std::vector<std::string> same_clips(const Clips& clips);

}  // namespace pinchlab::study
