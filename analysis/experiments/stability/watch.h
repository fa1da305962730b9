// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// One scene, run under one method with its measures taken from the positions alone, so that all
// methods are judged alike.

#include <cstdint>
#include <functional>
#include <string>

#include "analysis/experiments/stability/criteria.h"
#include "sim/configuration.h"
#include "sim/scene.h"
#include "sim/world.h"

namespace pinchlab::experiments::stability {

enum class EnergyLaw {
  unchecked,  ///< something drives the scene
  falls,      ///< impacts and slip may take energy, nothing may give any
  keeps,      ///< nothing may take any either
};

/// A scene and what must hold in it.
struct Case {
  std::string series;  ///< cases of one series differ in x (and y) only
  double x = 0.0;      ///< the parameter, on the item's axis
  double y = 0.0;      ///< the other parameter of a map
  Scene scene;
  double seconds = 1.0;  ///< simulated
  EnergyLaw energy = EnergyLaw::unchecked;
  double energy_at_play_j = 0.0;  ///< what gains and losses are measured by
  bool rests = false;             ///< everything must be at rest in the last tenth
  /// Of the end's positions or forces against the exact ones, relative; or nothing.
  std::function<double(const Scene&, const World&)> error;
  /// Whether a body has crossed a cable by the end; or nothing.
  std::function<bool(const Scene&, const World&)> passed_through;
};

/// A case under a method, and what came of it.
struct Result {
  std::string series, method;
  double x = 0.0, y = 0.0;
  Measures measures;
  Verdict verdict;
  std::int64_t steps = 0;         // done
  int most_solves = 0;            // of the active set in one step
  std::int64_t total_solves = 0;  // likewise, of all steps
  std::int64_t fallbacks = 0;
  std::int64_t link_changes = 0;  // links added or removed
};

/// Steps that the case takes.
std::int64_t step_count(const Case& test);

/// Runs a case; `method` names what it is reported as. A step that is not finite ends the run.
Result watch(const Case& test, const std::string& method, const Configuration& configuration);

/// Depth of the deepest overlap of a body with a cable, over the cable's full width: with what lies
/// wrapped on another body, with a pinched span and with a free one.
double squeeze(const Scene& scene, const World& world);

/// Cable in the spans beyond what is there, over the cable's length: the largest of all cables.
double strain(const Scene& scene, const World& world);

}  // namespace pinchlab::experiments::stability
