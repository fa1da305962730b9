// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/json_object.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "base/did_you_mean.h"
#include "base/input_error.h"
#include "base/strict_json.h"
#include "base/text_checks.h"

namespace pinchlab {

using nlohmann::json;

namespace {

bool matches(const std::string& text, const char* pattern) {
  for (size_t i = 0; i < text.size(); ++i) {
    if (pattern[i] == '\0') return false;
    const bool digit = text[i] >= '0' && text[i] <= '9';
    if (pattern[i] == '#' ? !digit : text[i] != pattern[i]) return false;
  }
  return pattern[text.size()] == '\0';
}

std::string place(const std::string& file, const std::string& pointer) {
  return pointer.empty() ? file : fmt::format("{}: {}", file, pointer);
}

// The date and the time of day must exist: no 31 February, no 25 o'clock.
bool is_moment(const std::string& text) {
  const auto number = [&](size_t at) { return (text[at] - '0') * 10 + (text[at + 1] - '0'); };
  const int year = number(0) * 100 + number(2);
  const std::chrono::year_month_day date{std::chrono::year(year),
                                         std::chrono::month(static_cast<unsigned>(number(5))),
                                         std::chrono::day(static_cast<unsigned>(number(8)))};
  return date.ok() && number(11) < 24 && number(14) < 60 && number(17) < 61;
}

}  // namespace

JsonObject::JsonObject(const json& value, std::string file, std::string pointer)
    : value_(value), file_(std::move(file)), pointer_(std::move(pointer)) {
  if (!value.is_object()) {
    throw InputError(place(file_, pointer_),
                     fmt::format("must be an object, not {}", value.type_name()));
  }
}

void JsonObject::fail(const std::string& key, const std::string& message) const {
  throw InputError(place(file_, pointer_to(key)), message);
}

bool JsonObject::has(const std::string& key) {
  asked_.insert(key);
  return value_.contains(key);
}

const json& JsonObject::need(const std::string& key) {
  const auto found = value_.find(key);
  if (found == value_.end()) {
    std::vector<std::string> strange;  // what was asked for is meant as it is
    for (const auto& item : value_.items()) {
      if (!asked_.contains(item.key())) strange.push_back(item.key());
    }
    throw InputError(place(file_, pointer_),
                     fmt::format("key `{}` is missing{}", key, did_you_mean(key, strange)));
  }
  asked_.insert(key);
  return *found;
}

std::string JsonObject::text(const std::string& key, size_t limit_bytes) {
  const json& value = need(key);
  if (!value.is_string()) fail(key, fmt::format("must be a string, not {}", value.type_name()));
  const auto& text = value.get_ref<const std::string&>();
  if (text.size() > limit_bytes) fail(key, fmt::format("longer than {} bytes", limit_bytes));
  return text;
}

std::string JsonObject::name(const std::string& key) {
  std::string value = text(key, 4096);
  const std::string why = why_not_a_name(value);
  if (!why.empty()) fail(key, why);
  return value;
}

std::string JsonObject::choice(const std::string& key, const std::vector<std::string>& allowed) {
  std::string value = text(key, 4096);
  if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
    fail(key, fmt::format("`{}` is unknown{}; it must be {}", value.substr(0, 60),
                          did_you_mean(value, allowed), one_of(allowed)));
  }
  return value;
}

std::string JsonObject::utc(const std::string& key) {
  std::string value = text(key, 64);
  std::string body = value;
  // A fraction of the second does not matter to the pattern.
  if (const size_t dot = body.find('.'); dot == 19 && body.size() > 21) {
    const auto digit = [](char c) { return c >= '0' && c <= '9'; };
    if (std::all_of(body.begin() + 20, body.end() - 1, digit))
      body = body.substr(0, 19) + body.back();
  }
  if (!matches(body, "####-##-##T##:##:##Z") || !is_moment(body)) {
    fail(key, fmt::format("`{}` is not a moment in UTC like 2026-11-20T12:05:01Z", value));
  }
  return value;
}

std::string JsonObject::sha256(const std::string& key) {
  std::string value = text(key, 4096);
  const auto hexadecimal = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
  if (value.size() != 64 || !std::all_of(value.begin(), value.end(), hexadecimal)) {
    fail(key, "must be a SHA-256: 64 lower-case hexadecimal digits");
  }
  return value;
}

long JsonObject::whole(const std::string& key, long low, long high) {
  const json& value = need(key);
  const bool fits = value.is_number_unsigned()
                        ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(high)
                        : value.is_number_integer();
  if (!fits || value.get<long>() < low || value.get<long>() > high) {
    fail(key, fmt::format("must be a whole number from {} to {}", low, high));
  }
  return value.get<long>();
}

double JsonObject::number(const std::string& key, double low, double high) {
  const json& value = need(key);
  if (!value.is_number() || !(value.get<double>() >= low && value.get<double>() <= high)) {
    fail(key, fmt::format("must be a number from {} to {}", low, high));
  }
  return value.get<double>();
}

bool JsonObject::flag(const std::string& key) {
  const json& value = need(key);
  if (!value.is_boolean()) fail(key, "must be true or false");
  return value.get<bool>();
}

const json& JsonObject::array(const std::string& key, size_t limit) {
  const json& value = need(key);
  if (!value.is_array()) fail(key, fmt::format("must be an array, not {}", value.type_name()));
  if (value.size() > limit) fail(key, fmt::format("more than {} entries", limit));
  return value;
}

JsonObject JsonObject::object(const std::string& key) {
  return {need(key), file_, pointer_to(key)};
}

std::vector<std::string> JsonObject::all_keys() {
  std::vector<std::string> keys;
  for (const auto& item : value_.items()) keys.push_back(item.key());
  asked_.insert(keys.begin(), keys.end());
  return keys;
}

void JsonObject::expect_only(const std::vector<std::string>& known, const std::string& cure) const {
  for (const auto& item : value_.items()) {
    if (std::find(known.begin(), known.end(), item.key()) == known.end()) {
      fail(item.key(), fmt::format("unknown key{}{}", did_you_mean(item.key(), known), cure));
    }
  }
}

void JsonObject::finish(const std::string& cure) const {
  expect_only({asked_.begin(), asked_.end()}, cure);
}

std::string JsonObject::pointer_to(const std::string& key) const {
  return pointer_ + "/" + pointer_token(key);
}

}  // namespace pinchlab
