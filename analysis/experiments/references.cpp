// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/references.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>

namespace pinchlab::experiments {

namespace {

int call_derivative(double /*t*/, const double y[], double dydt[], void* data) {
  const auto& [f, size] = *static_cast<const std::pair<const Derivative&, std::size_t>*>(data);
  const State d = f(State(y, y + size));
  std::copy(d.begin(), d.end(), dydt);
  return GSL_SUCCESS;
}

}  // namespace

std::vector<State> integrate(const Derivative& f, State y, double interval, int count) {
  std::pair<const Derivative&, std::size_t> data(f, y.size());
  gsl_odeiv2_system system{call_derivative, nullptr, y.size(), &data};
  constexpr double first_step = 1e-4, tolerance = 1e-13;
  const std::unique_ptr<gsl_odeiv2_driver, void (*)(gsl_odeiv2_driver*)> driver(
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, first_step, tolerance,
                                    tolerance),
      gsl_odeiv2_driver_free);
  std::vector<State> states{y};
  double t = 0.0;
  for (int i = 1; i <= count; ++i) {
    const int status = gsl_odeiv2_driver_apply(driver.get(), &t, i * interval, y.data());
    if (status != GSL_SUCCESS) {
      throw std::runtime_error(std::string("GSL's odeiv2: ") + gsl_strerror(status));
    }
    states.push_back(y);
  }
  return states;
}

double atwood_acceleration(double m1, double m2, double pulleys, double g) {
  return (m2 - m1) * g / (m1 + m2 + pulleys);
}

double slipping_atwood_acceleration(double m1, double m2, double k, double g) {
  return g * (m2 - k * m1) / (m2 + k * m1);
}

State SwingingLoad::derivative(const State& y) const {
  const double theta = y[0], turning = y[1], q = y[2], paying = y[3];
  const double l = q + radius * theta;
  return {
      turning, -(radius * turning * turning + 2.0 * paying * turning + g * std::sin(theta)) / l,
      paying,
      (mass * (l * turning * turning + g * std::cos(theta)) - load * g) / (mass + load + pulleys)};
}

void SwingingLoad::place(const State& y, double& x, double& y_m) const {
  const double s = std::sin(y[0]), c = std::cos(y[0]), l = y[2] + radius * y[0];
  x = -radius * c - l * s;
  y_m = radius * s - l * c;
}

double SwingingLoad::energy(const State& y) const {
  const double l = y[2] + radius * y[0], across = l * y[1];
  double x = 0.0, height = 0.0;
  place(y, x, height);
  return 0.5 * (mass + load + pulleys) * y[3] * y[3] + 0.5 * mass * across * across +
         mass * g * height + load * g * y[2];
}

State RollerOnDrum::derivative(const State& y) const {
  return {y[1], g * std::sin(y[0]) / (distance * (1.0 + inertia_share))};
}

double RollerOnDrum::energy(const State& y) const {
  return 0.5 * (1.0 + inertia_share) * distance * distance * y[1] * y[1] +
         g * distance * std::cos(y[0]);
}

}  // namespace pinchlab::experiments
