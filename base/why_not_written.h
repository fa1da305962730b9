// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cerrno>
#include <string>
#include <system_error>

namespace pinchlab {

/// The system's reason (an errno) why something is not written, with the cure where there is one.
inline std::string why_not_written(int error_number) {
  const bool is_forbidden =
      error_number == EACCES || error_number == EPERM || error_number == EROFS;
  return std::generic_category().message(error_number) +
         (is_forbidden ? "; name a place that you may write to" : "");
}

}  // namespace pinchlab
