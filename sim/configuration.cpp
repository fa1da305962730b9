// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/configuration.h"

namespace pinchlab {

Configuration thesis_configuration() {
  Configuration thesis(Method::pinch);
  thesis.solver = Solver::iterative;
  thesis.detection = Detection::all_pairs;
  thesis.pinch_rows = PinchRows::three;
  thesis.events = Events::at_steps;
  thesis.sleep = false;
  return thesis;
}

namespace {

// With any number of sweeps, and whatever else is asked of it besides.
bool has_ways_of_thesis(const Configuration& configuration) {
  const Configuration thesis = thesis_configuration();
  return configuration.method == thesis.method && configuration.solver == thesis.solver &&
         configuration.detection == thesis.detection &&
         configuration.pinch_rows == thesis.pinch_rows && configuration.events == thesis.events;
}

}  // namespace

std::optional<Configuration> configuration_from_string(std::string_view name) {
  if (name == "thesis") return thesis_configuration();
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    if (name == to_string(method)) return method;
  }
  return std::nullopt;
}

const char* to_string(const Configuration& configuration) {
  return has_ways_of_thesis(configuration) ? "thesis" : to_string(configuration.method);
}

const char* to_string(Solver solver) {
  return solver == Solver::direct ? "direct" : "iterative";
}

const char* to_string(Detection detection) {
  return detection == Detection::sweep ? "sweep" : "all_pairs";
}

const char* to_string(Events events) {
  return events == Events::located ? "located" : "at_steps";
}

const char* to_string(PinchRows rows) {
  return rows == PinchRows::one ? "one" : "three";
}

}  // namespace pinchlab
