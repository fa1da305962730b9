// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/strict_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "base/input_error.h"
#include "base/read_file.h"

namespace pinchlab {
namespace {

using nlohmann::json;

// Columns count characters, not bytes, as editors do.
std::string line_and_column(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t line = 1 + static_cast<std::size_t>(std::ranges::count(before, '\n'));
  const std::string_view in_line = before.substr(before.rfind('\n') + 1);  // npos + 1 == 0
  const auto is_start = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
  const std::size_t column = static_cast<std::size_t>(std::ranges::count_if(in_line, is_start));
  return fmt::format("line {}, column {}", line, std::max<std::size_t>(column, 1));
}

// What the library says, without its own numbering, position and copy of the text.
std::string plain_reason(const std::string& what) {
  const std::size_t dash = what.find(" - ");
  const std::size_t reason = dash != std::string::npos ? dash + 3 : what.find("] ") + 2;
  const std::string text = what.substr(reason, what.find("; last read") - reason);
  return text == "invalid literal" ? text + " (NaN, Infinity, comments and bare words are not JSON)"
                                   : text;
}

// Builds the value while watching what the library's own builder lets pass.
class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(std::string_view text, std::size_t max_depth) : text_(text), max_depth_(max_depth) {}

  json root;

  bool null() override { return add(nullptr); }
  bool boolean(bool value) override { return add(value); }
  bool number_integer(number_integer_t value) override { return add(value); }
  bool number_unsigned(number_unsigned_t value) override { return add(value); }
  bool number_float(number_float_t value, const string_t&) override { return add(value); }
  bool string(string_t& value) override { return add(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // not in JSON text

  bool key(string_t& value) override {
    key_ = value;
    if (open_.back()->contains(value)) {
      throw JsonError(pointer() + "/" + pointer_token(value), "key given twice; keep one of them");
    }
    return true;
  }
  bool start_object(std::size_t) override { return start(json::object()); }
  bool start_array(std::size_t) override { return start(json::array()); }
  bool end_object() override { return end(); }
  bool end_array() override { return end(); }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    throw JsonError(line_and_column(text_, position), "not JSON: " + plain_reason(error.what()));
  }

 private:
  json* place(json value) {
    if (open_.empty()) {
      root = std::move(value);
      return &root;
    }
    json& parent = *open_.back();
    if (parent.is_array()) {
      parent.push_back(std::move(value));
      return &parent.back();
    }
    return &(parent[key_] = std::move(value));
  }
  bool add(json value) {
    place(std::move(value));
    return true;
  }
  bool start(json value) {
    if (open_.size() == max_depth_) {
      throw JsonError(pointer(), fmt::format("nested deeper than {} levels", max_depth_));
    }
    std::string token = open_.empty()              ? ""
                        : open_.back()->is_array() ? fmt::format("/{}", open_.back()->size())
                                                   : "/" + pointer_token(key_);
    open_.push_back(place(std::move(value)));
    tokens_.push_back(std::move(token));
    return true;
  }
  bool end() {
    open_.pop_back();
    tokens_.pop_back();
    return true;
  }
  std::string pointer() const { return fmt::format("{}", fmt::join(tokens_, "")); }

  std::string_view text_;
  std::size_t max_depth_;
  std::string key_;
  std::vector<json*> open_;          // parents stay put while a child is open: only it grows
  std::vector<std::string> tokens_;  // one an open value
};

}  // namespace

std::string pointer_token(const std::string& key) {
  const std::string quoted = json(key).dump(-1, ' ', true, json::error_handler_t::replace);
  std::string token;
  for (const char c : quoted.substr(1, std::min<std::size_t>(quoted.size() - 2, 64))) {
    if (c == '~') {
      token += "~0";
    } else if (c == '/') {
      token += "~1";
    } else {
      token += c;
    }
  }
  return token;
}

json parse_strict_json(std::string_view text, std::size_t max_depth) {
  // To the library a byte of zero is the end of the text, whatever comes after it.
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    throw JsonError(line_and_column(text, zero + 1),
                    "not JSON: a byte of zero; save the file as UTF-8");
  }
  Builder builder(text, max_depth);
  json::sax_parse(text, &builder);
  return std::move(builder.root);
}

json read_json_file(const std::filesystem::path& path, std::size_t limit_bytes) {
  const std::string text = read_whole(path, limit_bytes);
  try {
    return parse_strict_json(text);
  } catch (const JsonError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.place), error.what());
  }
}

}  // namespace pinchlab
