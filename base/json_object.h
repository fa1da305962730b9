// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Strict reading of JSON that comes from outside.

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace pinchlab {

/// One JSON object whose keys are asked for one by one: a missing or wrongly typed value throws
/// InputError with its place, and finish() throws for every key that nobody asked for.
class JsonObject {
 public:
  /// `file` and `pointer` ("" for the whole document) are for messages. Throws if `value` is not an
  /// object.
  JsonObject(const nlohmann::json& value, std::string file, std::string pointer);

  [[nodiscard]] bool has(const std::string& key);
  const nlohmann::json& need(const std::string& key);

  std::string name(const std::string& key);  ///< see why_not_a_name
  std::string text(const std::string& key, size_t limit_bytes);
  std::string choice(const std::string& key, const std::vector<std::string>& allowed);
  std::string utc(const std::string& key);     ///< "2026-11-20T12:05:01Z", fractions allowed
  std::string sha256(const std::string& key);  ///< 64 lower-case hexadecimal digits
  long whole(const std::string& key, long low, long high);
  double number(const std::string& key, double low, double high);
  bool flag(const std::string& key);
  const nlohmann::json& array(const std::string& key, size_t limit);
  JsonObject object(const std::string& key);

  /// The keys present, in order; they count as asked for.
  std::vector<std::string> all_keys();

  /// Throws for the first key that is not `known`, with the nearest one that is: ahead of
  /// everything else, so that a misspelt key is told as such. `cure` ends the message.
  void expect_only(const std::vector<std::string>& known, const std::string& cure) const;

  /// The same for keys that were not asked for.
  void finish(const std::string& cure = "") const;

  [[nodiscard]] std::string pointer_to(const std::string& key) const;
  [[noreturn]] void fail(const std::string& key, const std::string& message) const;

 private:
  const nlohmann::json& value_;
  std::string file_;
  std::string pointer_;
  std::set<std::string> asked_;
};

}  // namespace pinchlab
