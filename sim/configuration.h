// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The methods that can be compared on one scene. Each choice has a file of its own, and the
// functions of one choice share a signature.

#include <optional>
#include <string_view>

#include "sim/scene.h"

namespace pinchlab {

/// What finds the impulses of all rows.
enum class Solver {
  direct,     ///< active_set.h: the exact solution
  iterative,  ///< gauss_seidel.h: projected sweeps, with the thesis' settings
};

/// What finds the pairs that may touch.
enum class Detection {
  sweep,      ///< broad_phase.h: sweep and prune, cost linear in the scene
  all_pairs,  ///< all_pairs.h: each body against each, each span against each body (thesis 4.2.4)
};

/// The rows of a non-transitional pinch.
enum class PinchRows {
  one,    ///< its contact, and one signed row for the friction of the middle body
  three,  ///< its contact, and both of its zero-length segments (thesis 4.2.2)
};

/// When impacts, catches and changes of the cables' course take effect.
enum class Events {
  located,   ///< advance.h: at their time; lengths and gaps are exact at the end of each step
  at_steps,  ///< in the step in which they fall; what a step misses the next one makes up
};

/// How a scene is simulated.
struct Configuration {
  Method method = Method::pinch;
  Solver solver = Solver::direct;
  Detection detection = Detection::sweep;
  PinchRows pinch_rows = PinchRows::one;
  Events events = Events::located;  ///< located asks for the direct solver
  double error = 0.0;   ///< m; above 0: steps are divided so that positions end about as near to
                        ///< the exact ones (Events::located only)
  int iterations = 10;  ///< >= 1, sweeps of the iterative solver
  bool sleep = true;    ///< parts of the scene that have come to rest cost no more
  bool diagnostics = false;  ///< fills the measured lengths and energy of World::diagnostics

  Configuration() = default;
  Configuration(Method m) : method(m) {}  // NOLINT: a method alone is a configuration
  bool operator==(const Configuration&) const = default;
};

/// Whether events are located. Sweeps have no exact lengths to locate them by, and neither has a
/// plain cable joint whose bodies have crossed.
inline bool locates_events(const Configuration& configuration) {
  return configuration.events == Events::located && configuration.solver == Solver::direct &&
         configuration.method != Method::cable;
}

/// The whole of what the thesis describes: cables solved by projected Gauss-Seidel sweeps,
/// all-pairs detection, three rows a pinch.
Configuration thesis_configuration();

/// "thesis", or the name of a method with our own choices for the rest; nothing for other names.
std::optional<Configuration> configuration_from_string(std::string_view name);

/// The name that configuration_from_string knows it by, any number of sweeps; or its method's.
const char* to_string(const Configuration& configuration);

const char* to_string(Solver solver);
const char* to_string(Detection detection);
const char* to_string(PinchRows rows);
const char* to_string(Events events);

}  // namespace pinchlab
