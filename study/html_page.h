// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

#include "study/config.h"

namespace pinchlab::study {

/// One of the pages with its language and title in place, so that they are right before any script
/// runs. `backend` is the module that keeps the answers; `scripts` is HTML that comes before ours.
std::string html_page(std::string_view path, const Config& config, std::string_view backend,
                      std::string_view scripts);

}  // namespace pinchlab::study
