// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The scene format as tables: every key, its type, its range and whether it must be there. The
// reader (scene_json.cpp) obeys them; README.md and scene.schema.json are tested against them.

#include <string>
#include <vector>

namespace pinchlab {

enum class KeyType {
  number,           // low..high
  integer,          // low..high
  integer_or_word,  // low..high, or one of `choices`
  vector,           // [x, y], each low..high
  points,           // low..high entries, each [x, y] of -most_coordinate..most_coordinate
  text,             // low..high characters
  name,             // text that can stand in a CSV cell and be referred to
  boolean,
  choice,          // one of `choices`
  friction,        // number low..high, or "no_slip"
  colour,          // "#rrggbb" or "#rrggbbaa"
  object,          // `child`
  object_or_word,  // `child`, or one of `choices`
  list,            // low..high entries, each a `child`
};

constexpr double most_coordinate = 1e4;  // m, of KeyType::points

struct ObjectFormat;

struct KeyFormat {
  std::string name;
  KeyType type = KeyType::number;
  bool required = false;
  double low = 0.0, high = 0.0;  // inclusive; meaning as KeyType says
  std::vector<std::string> choices = {};
  const ObjectFormat* child = nullptr;
};

struct ObjectFormat {
  std::string name;  // of the definition in scene.schema.json
  std::vector<KeyFormat> keys;
};

/// The whole file; its objects hang below it.
const ObjectFormat& scene_format();

/// A theme's file (theme.h).
const ObjectFormat& theme_format();

/// Bytes; a larger file is refused unread.
constexpr std::size_t max_scene_bytes = 4'000'000;

/// Frames; duration_s * frames_per_second.
constexpr int max_frame_count = 216'000;

}  // namespace pinchlab
