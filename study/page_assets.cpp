// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "study/page_assets.h"

namespace pinchlab::study {

const PageAsset* find_asset(std::string_view path) {
  const auto assets = page_assets();
  const auto found = std::ranges::find(assets, path, &PageAsset::path);
  return found == assets.end() ? nullptr : &*found;
}

bool has_page() {
  return find_asset("jspsych.js") != nullptr;
}

}  // namespace pinchlab::study
