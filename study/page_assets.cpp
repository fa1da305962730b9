// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/page_assets.h"

#include <algorithm>

namespace pinchlab::study {

const PageAsset* find_asset(std::string_view path) {
  const auto assets = page_assets();
  const auto found = std::ranges::find(assets, path, &PageAsset::path);
  return found == assets.end() ? nullptr : &*found;
}

bool has_page() {
  return find_asset("jspsych.js") != nullptr &&
         find_asset("jspsych-survey-html-form.js") != nullptr;
}

}  // namespace pinchlab::study
