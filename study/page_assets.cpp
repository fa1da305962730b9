// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "study/page_assets.h"

namespace pinchlab::study {
namespace {

std::string html_escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    html += c == '&'   ? "&amp;"
            : c == '<' ? "&lt;"
            : c == '>' ? "&gt;"
            : c == '"' ? "&quot;"
                       : std::string(1, c);
  }
  return html;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

}  // namespace

const PageAsset* find_asset(std::string_view path) {
  const auto assets = page_assets();
  const auto found = std::ranges::find(assets, path, &PageAsset::path);
  return found == assets.end() ? nullptr : &*found;
}

std::string html_page(std::string_view path, const Config& config, std::string_view backend,
                      std::string_view scripts) {
  const PageAsset* asset = find_asset(path);
  std::string html(asset == nullptr ? std::string_view() : asset->bytes);
  html = replaced(html, "{{language}}", html_escaped(config.language));
  html = replaced(html, "{{backend}}", std::string(backend));
  html = replaced(html, "{{scripts}}", std::string(scripts));
  for (const char* text : {"title", "loading", "connection_lost"}) {
    html = replaced(html, fmt::format("{{{{{}}}}}", text), html_escaped(config.texts.at(text)));
  }
  return html;
}

bool has_page() {
  return find_asset("jspsych.js") != nullptr;
}

}  // namespace pinchlab::study
