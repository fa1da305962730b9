// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The files of study/page, built into the program (embed.cmake writes embedded_page.cpp).

#include <span>
#include <string_view>

namespace pinchlab::study {

struct PageAsset {
  std::string_view path;  ///< below study/page, such as "texts/en.json"
  std::string_view type;  ///< media type
  std::string_view bytes;
};

std::span<const PageAsset> page_assets();

/// The file of that path, or nullptr.
const PageAsset* find_asset(std::string_view path);

/// Whether jsPsych was there when the program was built: without it there is no page.
bool has_page();

}  // namespace pinchlab::study
