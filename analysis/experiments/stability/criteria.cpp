// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/stability/criteria.h"

#include <cmath>
#include <limits>
#include <utility>

namespace pinchlab::experiments::stability {

const char* to_string(Failure failure) {
  switch (failure) {
    case Failure::none:
      return "none";
    case Failure::not_finite:
      return "not finite";
    case Failure::passed_through:
      return "passed through";
    case Failure::strain:
      return "stretched";
    case Failure::squeeze:
      return "squeezed";
    case Failure::length:
      return "length lost";
    case Failure::energy_gained:
      return "energy gained";
    case Failure::energy_lost:
      return "energy lost";
    case Failure::restless:
      return "restless";
    case Failure::wrong:
      return "wrong";
  }
  return "unknown";
}

Verdict judge(const Measures& m, const Limits& limits) {
  constexpr double beyond = std::numeric_limits<double>::infinity();
  if (!m.finite) return {beyond, Failure::not_finite};
  Verdict verdict;
  const std::pair<double, Failure> shares[] = {
      {m.strain / limits.strain, Failure::strain},
      {m.squeeze / limits.squeeze, Failure::squeeze},
      {m.length / limits.length, Failure::length},
      {m.energy_gained / limits.energy, Failure::energy_gained},
      {m.energy_lost / limits.energy, Failure::energy_lost},
      {m.end_speed_m_s / limits.end_speed_m_s, Failure::restless},
      {m.error / limits.error, Failure::wrong},
  };
  for (const auto& [share, failure] : shares) {
    if (std::isnan(share)) return {beyond, Failure::not_finite};
    if (share > verdict.severity) verdict = {share, failure};
  }
  if (m.passed_through) verdict = {beyond, Failure::passed_through};
  return verdict;
}

}  // namespace pinchlab::experiments::stability
