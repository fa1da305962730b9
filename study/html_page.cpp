// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/html_page.h"

#include <fmt/format.h>

#include "base/html.h"
#include "study/page_assets.h"

namespace pinchlab::study {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

}  // namespace

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

}  // namespace pinchlab::study
