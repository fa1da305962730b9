// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/utc.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <charconv>

namespace pinchlab::study {

std::string utc_now() {
  using namespace std::chrono;
  const auto now = floor<milliseconds>(system_clock::now());
  return fmt::format("{:%FT%T}.{:03}Z", fmt::gmtime(system_clock::to_time_t(now)),
                     (now - floor<seconds>(now)).count());
}

std::chrono::sys_seconds parse_utc(const std::string& text) {
  const auto number = [&](std::size_t at, std::size_t length) {
    int value = 0;
    std::from_chars(text.data() + at, text.data() + at + length, value);
    return value;
  };
  using namespace std::chrono;
  const year_month_day date{year(number(0, 4)), month(static_cast<unsigned>(number(5, 2))),
                            day(static_cast<unsigned>(number(8, 2)))};
  return sys_days(date) + hours(number(11, 2)) + minutes(number(14, 2)) + seconds(number(17, 2));
}

}  // namespace pinchlab::study
