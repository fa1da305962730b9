// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Moments as answer files have them: "2026-11-20T12:05:01.250Z".

#include <chrono>
#include <string>

namespace pinchlab::study {

std::string utc_now();

/// A moment to the second. What is no such text gives some moment.
std::chrono::sys_seconds parse_utc(const std::string& text);

}  // namespace pinchlab::study
