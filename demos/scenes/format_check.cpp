// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/format_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/did_you_mean.h"
#include "base/strict_json.h"
#include "base/text_checks.h"

namespace pinchlab {
namespace {

using nlohmann::json;
using Problems = std::vector<SceneProblem>;

std::string type_name(const json& value) {
  switch (value.type()) {
    case json::value_t::null:
      return "null";
    case json::value_t::object:
      return "an object";
    case json::value_t::array:
      return "a list";
    case json::value_t::string:
      return "a string";
    case json::value_t::boolean:
      return "a boolean";
    default:
      return "a number";
  }
}

std::string either(const std::vector<std::string>& words) {
  if (words.size() < 2) {
    return fmt::format("{}", fmt::join(words, ""));
  }
  return fmt::format("{} or {}", fmt::join(words.begin(), words.end() - 1, ", "), words.back());
}

std::string suggestion(const std::string& word, const std::vector<std::string>& known) {
  const std::string meant = nearest_word(word, known);
  return meant.empty() ? "" : fmt::format(" (did you mean {}?)", meant);
}

// What stands where something else must: a text as it is, as long as it is a word.
std::string quoted_or_type(const json& value) {
  constexpr std::size_t longest = 40;  // bytes
  if (!value.is_string() || value.get_ref<const std::string&>().size() > longest) {
    return type_name(value);
  }
  return "\"" + pointer_token(value.get_ref<const std::string&>()) + "\"";
}

/// "one" or "two".
std::string in_quotes(const std::vector<std::string>& words) {
  return fmt::format("\"{}\"", fmt::join(words, "\" or \""));
}

bool in_range(const json& value, const KeyFormat& key) {
  const double number = value.get<double>();  // never NaN or infinite: JSON has neither
  return key.low <= number && number <= key.high;
}

void check_number(const json& value, const KeyFormat& key, const std::string& place,
                  Problems& problems) {
  const bool whole = key.type == KeyType::integer || key.type == KeyType::integer_or_word;
  if (!value.is_number() && key.type == KeyType::integer_or_word) {
    problems.push_back({place, fmt::format("must be a whole number or {}, not {}",
                                           in_quotes(key.choices), quoted_or_type(value))});
  } else if (!value.is_number() && key.type == KeyType::friction) {
    problems.push_back({place, fmt::format("must be {:g} to {:g} or \"no_slip\", not {}", key.low,
                                           key.high, quoted_or_type(value))});
  } else if (!value.is_number()) {
    problems.push_back(
        {place, fmt::format("must be {}, not {}", whole ? "a whole number" : "a number",
                            type_name(value))});
  } else if (!in_range(value, key)) {
    problems.push_back(
        {place, fmt::format("must be {:g} to {:g}, not {}", key.low, key.high, value.dump())});
  } else if (whole && std::trunc(value.get<double>()) != value.get<double>()) {
    problems.push_back({place, fmt::format("must be a whole number, not {}", value.dump())});
  }
}

void check_vector(const json& value, const KeyFormat& key, const std::string& place,
                  Problems& problems) {
  if (!value.is_array() || value.size() != 2 || !value[0].is_number() || !value[1].is_number()) {
    problems.push_back({place, "must be a list of two numbers, [x, y]"});
    return;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (!in_range(value[i], key)) {
      problems.push_back(
          {fmt::format("{}/{}", place, i),
           fmt::format("must be {:g} to {:g}, not {}", key.low, key.high, value[i].dump())});
    }
  }
}

bool has_wanted_size(const json& value, const KeyFormat& key, const std::string& place,
                     Problems& problems) {
  if (!value.is_array()) {
    problems.push_back({place, fmt::format("must be a list, not {}", type_name(value))});
    return false;
  }
  const auto size = static_cast<double>(value.size());
  if (size >= key.low && size <= key.high) return true;
  problems.push_back(
      {place, fmt::format("must have {} to {} entries, not {}", key.low, key.high, value.size())});
  return false;
}

void check_points(const json& value, const KeyFormat& key, const std::string& place,
                  Problems& problems) {
  if (!has_wanted_size(value, key, place, problems)) return;
  KeyFormat point;
  point.low = -most_coordinate;
  point.high = most_coordinate;
  for (std::size_t i = 0; i < value.size(); ++i) {
    check_vector(value[i], point, fmt::format("{}/{}", place, i), problems);
  }
}

void check_text(const json& value, const KeyFormat& key, const std::string& place,
                Problems& problems) {
  if (!value.is_string()) {
    problems.push_back({place, fmt::format("must be a string, not {}", type_name(value))});
    return;
  }
  const std::string& text = value.get_ref<const std::string&>();
  const auto starts_character = [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  };
  const auto length = static_cast<double>(std::ranges::count_if(text, starts_character));
  if (length < key.low || length > key.high) {
    problems.push_back({place, fmt::format("must be {} to {} characters long, not {}", key.low,
                                           key.high, length)});
  } else if (has_control_character(text)) {
    problems.push_back({place, "must be one line without control characters"});
  } else if (key.type == KeyType::name && (text.find_first_of(",\"") != std::string::npos ||
                                           text.front() == ' ' || text.back() == ' ')) {
    problems.push_back({place, "a name must have no comma, no quote and no space at its ends"});
  }
}

bool is_choice(const json& value, const KeyFormat& key) {
  return value.is_string() &&
         std::ranges::find(key.choices, value.get_ref<const std::string&>()) != key.choices.end();
}

void check_choice(const json& value, const KeyFormat& key, const std::string& place,
                  Problems& problems) {
  if (!value.is_string()) {
    problems.push_back(
        {place, fmt::format("must be {}, not {}", either(key.choices), type_name(value))});
  } else if (!is_choice(value, key)) {
    const auto& word = value.get_ref<const std::string&>();
    problems.push_back({place, fmt::format("must be {}, not \"{}\"{}", either(key.choices),
                                           pointer_token(word), suggestion(word, key.choices))});
  }
}

void check_list(const json& value, const KeyFormat& key, const std::string& place,
                Problems& problems) {
  if (!has_wanted_size(value, key, place, problems)) return;
  for (std::size_t i = 0; i < value.size(); ++i) {
    check_format(value[i], *key.child, fmt::format("{}/{}", place, i), problems);
  }
}

void check_object_or_word(const json& value, const KeyFormat& key, const std::string& place,
                          Problems& problems) {
  if (value.is_object()) return check_format(value, *key.child, place, problems);
  if (is_choice(value, key)) return;
  std::vector<std::string> keys;
  for (const KeyFormat& child : key.child->keys) keys.push_back(child.name);
  problems.push_back(
      {place, fmt::format("must be {} or an object with {}, not {}", in_quotes(key.choices),
                          fmt::join(keys, " and "), quoted_or_type(value))});
}

void check_value(const json& value, const KeyFormat& key, const std::string& place,
                 Problems& problems) {
  switch (key.type) {
    case KeyType::number:
    case KeyType::integer:
      return check_number(value, key, place, problems);
    case KeyType::integer_or_word:
      return is_choice(value, key) ? void() : check_number(value, key, place, problems);
    case KeyType::friction:
      return value == "no_slip" ? void() : check_number(value, key, place, problems);
    case KeyType::vector:
      return check_vector(value, key, place, problems);
    case KeyType::points:
      return check_points(value, key, place, problems);
    case KeyType::text:
    case KeyType::name:
      return check_text(value, key, place, problems);
    case KeyType::choice:
      return check_choice(value, key, place, problems);
    case KeyType::colour:
      if (!value.is_string() || !colour_from(value.get_ref<const std::string&>())) {
        problems.push_back({place, "must be a colour, \"#rrggbb\" or \"#rrggbbaa\""});
      }
      return;
    case KeyType::object:
      return check_format(value, *key.child, place, problems);
    case KeyType::object_or_word:
      return check_object_or_word(value, key, place, problems);
    case KeyType::list:
      return check_list(value, key, place, problems);
    case KeyType::boolean:
      if (!value.is_boolean()) {
        problems.push_back({place, fmt::format("must be true or false, not {}", type_name(value))});
      }
      return;
  }
}

}  // namespace

std::optional<Colour> colour_from(const std::string& text) {
  const auto is_digit = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#' ||
      !std::all_of(text.begin() + 1, text.end(), is_digit)) {
    return std::nullopt;
  }
  const auto part = [&](std::size_t i) {
    return i < text.size() ? static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16))
                           : std::uint8_t{255};
  };
  return Colour{part(1), part(3), part(5), part(7)};
}

void check_format(const json& value, const ObjectFormat& format, const std::string& place,
                  Problems& problems) {
  if (!value.is_object()) {
    problems.push_back({place, fmt::format("must be an object, not {}", type_name(value))});
    return;
  }
  std::vector<std::string> known;
  for (const KeyFormat& key : format.keys) {
    known.push_back(key.name);
    if (key.required && !value.contains(key.name)) {
      problems.push_back({place, fmt::format("{} is missing", key.name)});
    }
  }
  for (const auto& [name, child] : value.items()) {
    const std::string child_place = place + "/" + pointer_token(name);
    const auto key = std::ranges::find(format.keys, name, &KeyFormat::name);
    if (key != format.keys.end()) {
      check_value(child, *key, child_place, problems);
      continue;
    }
    const std::string meant = nearest_word(name, known);
    problems.push_back(
        {child_place, meant.empty()
                          ? fmt::format("unknown key (known here: {})", fmt::join(known, ", "))
                          : fmt::format("unknown key (did you mean {}?)", meant)});
  }
}

}  // namespace pinchlab
