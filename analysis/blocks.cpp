// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/blocks.h"

#include <fmt/format.h>

#include <cmath>

namespace pinchlab::analysis {

std::string fixed(double value, int decimals) {
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  return text.find_first_not_of("-0.") == std::string::npos ? fmt::format("{:.{}f}", 0.0, decimals)
                                                            : text;
}

std::string fixed(const Estimate& value, int decimals) {
  return value ? fixed(value.value, decimals) : dash;
}

std::string p_text(double p) {
  if (p >= 0.99995) return "1";
  if (p == 0.0) return "<1e-300";
  return p >= 0.001 ? fmt::format("{:.4f}", p) : fmt::format("{:.1e}", p);
}

std::string p_text(const Estimate& p) {
  return p ? p_text(p.value) : dash;
}

std::string p_equation(const Estimate& p) {
  const std::string text = p_text(p);
  return text.starts_with('<') ? "p < " + text.substr(1) : "p = " + text;
}

TextCell p_cell(const Estimate& p, double alpha) {
  return {p_text(p), p && p.value < alpha};
}

std::string p_rounded(double p, int decimals) {
  const double last_digit = std::pow(10.0, -decimals);
  if (p < last_digit) return fmt::format("<{:.{}f}", last_digit, decimals);
  return p > 1.0 - 0.5 * last_digit ? "1" : fmt::format("{:.{}f}", p, decimals);
}

std::string percent(double share) {
  return fmt::format("{:.1f} %", 100.0 * share);
}

std::string ties_among(std::int64_t ties) {
  return fmt::format("{} of them {}", ties, ties == 1 ? "a tie" : "ties");
}

std::string confidence_level(double alpha) {
  return fmt::format("{:g} %", 100.0 * (1.0 - alpha));
}

}  // namespace pinchlab::analysis
