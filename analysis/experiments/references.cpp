// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/references.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
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

namespace {

State after(const Derivative& f, const State& y, double time) {
  return time > 0.0 ? integrate(f, y, time, 1)[1] : y;
}

/// When (s, at most `most`) the phase ends that begins at y, and has ended by then.
double end_of(const Phase& phase, const State& y, double most) {
  double before = 0.0, past = most;
  for (;;) {
    const double middle = 0.5 * (before + past);
    if (middle <= before || middle >= past) return past;
    (phase.until(after(phase.derivative, y, middle)) < 0.0 ? past : before) = middle;
  }
}

}  // namespace

std::vector<State> integrate(const std::vector<Phase>& phases, State y, double interval,
                             int count) {
  std::vector<State> states{y};
  auto phase = phases.begin();
  for (int i = 1; i <= count; ++i) {
    double left = interval;
    for (;;) {
      State next = after(phase->derivative, y, left);
      if (!phase->until || !(phase->until(next) < 0.0)) {
        y = std::move(next);
        break;
      }
      const double end = end_of(*phase, y, left);
      y = after(phase->derivative, y, end);
      if (phase->becomes) y = phase->becomes(y);
      left -= end;
      if (++phase == phases.end()) throw std::logic_error("integrate: the last phase has an end");
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

double PegPendulum::meets() const {
  return -std::asin(radius / depth);
}

double PegPendulum::free_length(double theta) const {
  if (theta <= meets()) return length;
  return length - std::sqrt(depth * depth - radius * radius) - radius * (theta - meets());
}

std::vector<Phase> PegPendulum::phases() const {
  const PegPendulum pendulum = *this;
  const double there = meets();
  const double shorter = length - std::sqrt(depth * depth - radius * radius);
  const auto swing = [pendulum](const State& y) -> State {
    return {y[1], -pendulum.g * std::sin(y[0]) / pendulum.length};
  };
  const auto wound = [=](const State& y) -> State {
    const double l = shorter - pendulum.radius * (y[0] - there);
    return {y[1], (pendulum.radius * y[1] * y[1] - pendulum.g * std::sin(y[0])) / l};
  };
  const auto times = [](double ratio) {
    return [ratio](const State& y) -> State { return {y[0], y[1] * ratio}; };
  };
  return {{swing, [=](const State& y) { return there - y[0]; }, times(length / shorter)},
          {wound, [=](const State& y) { return y[0] - there; }, times(shorter / length)},
          {swing, {}, {}}};
}

void PegPendulum::place(const State& y, double& x, double& y_m) const {
  const double s = std::sin(y[0]), c = std::cos(y[0]), l = free_length(y[0]);
  const bool on_peg = y[0] > meets();
  x = l * s - (on_peg ? radius * c : 0.0);
  y_m = -l * c - (on_peg ? depth + radius * s : 0.0);
}

double PegPendulum::energy(const State& y) const {
  const double across = free_length(y[0]) * y[1];
  double x = 0.0, height = 0.0;
  place(y, x, height);
  return 0.5 * across * across + g * height;
}

double TippingBox::edge(const State& y) const {
  return -std::cos(y[2]) * y[0] - std::sin(y[2]) * y[1];
}

double TippingBox::force(const State& y) const {
  const double c = std::cos(y[2]), s = edge(y), along = c * y[3] + std::sin(y[2]) * y[4];
  return (g * c + half_height * y[5] * y[5] + 2.0 * y[5] * along) / (1.0 / mass + s * s / inertia);
}

std::vector<Phase> TippingBox::phases() const {
  const TippingBox box = *this;
  const auto moves = [box](const State& y, double force) -> State {
    return {y[3],
            y[4],
            y[5],
            -std::sin(y[2]) * force / box.mass,
            std::cos(y[2]) * force / box.mass - box.g,
            box.edge(y) * force / box.inertia};
  };
  const auto slides = [](const State& y) -> State { return {y[3], 0.0, 0.0, 0.0, 0.0, 0.0}; };
  const auto tips = [=](const State& y) { return moves(y, box.force(y)); };
  const auto flies = [=](const State& y) { return moves(y, 0.0); };
  return {{slides, [](const State& y) { return -y[0]; }, {}},
          {tips, [box](const State& y) { return box.edge(y) + box.half_length; }, {}},
          {flies, {}, {}}};
}

double LoopingPendulum::free_length(const State& y) const {
  return length - radius * (y[0] - start_angle) - y[2];
}

double LoopingPendulum::bob_tension(const State& y, double slip_acceleration) const {
  return bob * (slip_acceleration + free_length(y) * y[1] * y[1] - g * std::cos(y[0]));
}

double LoopingPendulum::slip_acceleration(const State& y) const {
  const double k = std::exp(friction * y[0]);
  return (load * g - k * bob_tension(y, 0.0)) / (load + k * bob);
}

double LoopingPendulum::load_over_hold(const State& y) const {
  return load * g / (std::exp(friction * y[0]) * bob_tension(y, 0.0));
}

std::vector<Phase> LoopingPendulum::phases() const {
  const LoopingPendulum pendulum = *this;
  const auto turning = [pendulum](const State& y) {
    return (pendulum.radius * y[1] * y[1] + 2.0 * y[3] * y[1] + pendulum.g * std::sin(y[0])) /
           pendulum.free_length(y);
  };
  Phase slips, sticks;
  slips.derivative = [=](const State& y) -> State {
    return {y[1], turning(y), y[3], pendulum.slip_acceleration(y)};
  };
  slips.until = [](const State& y) { return y[3]; };
  slips.becomes = [](const State& y) -> State { return {y[0], y[1], y[2], 0.0}; };
  sticks.derivative = [=](const State& y) -> State { return {y[1], turning(y), 0.0, 0.0}; };
  sticks.until = [pendulum](const State& y) { return 1.0 - pendulum.load_over_hold(y); };
  return {slips, sticks, slips, {sticks.derivative, {}, {}}};
}

void LoopingPendulum::place(const State& y, double& x, double& y_m) const {
  const double s = std::sin(y[0]), c = std::cos(y[0]), l = free_length(y);
  x = radius * c - l * s;
  y_m = radius * s + l * c;
}

}  // namespace pinchlab::experiments
