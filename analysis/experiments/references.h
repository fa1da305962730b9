// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Motions that are known without a cable simulator: closed forms, and smooth equations of motion
// that GSL integrates. SI units throughout.

#include <functional>
#include <vector>

namespace pinchlab::experiments {

using State = std::vector<double>;
using Derivative = std::function<State(const State&)>;  ///< dy/dt of y

/// y at the times 0, interval, ..., count * interval (s) of dy/dt = f(y), by GSL's Prince-Dormand
/// 8(9) pair with absolute and relative error 1e-13 a step. Throws std::runtime_error where GSL
/// gives up.
std::vector<State> integrate(const Derivative& f, State y, double interval, int count);

/// Loads m1 and m2 (kg) on one massless cable over pulleys with fixed axles, `pulleys` the sum of
/// their I/R^2 (kg), without slip: acceleration of m2 downwards (m/s^2),
///   a = (m2 - m1) g / (m1 + m2 + sum I/R^2).
double atwood_acceleration(double m1, double m2, double pulleys, double g);

/// The same where the cable slips on its pulley, k = e^(mu * wrap): T2 = k T1, so
///   a = g (m2 - k m1) / (m2 + k m1).
/// Holds while m2 > k m1 and the pulley is slower than the cable.
double slipping_atwood_acceleration(double m1, double m2, double k, double g);

/// A bob swings on a cable that runs over a pulley of radius R (to the cable's centre line) at the
/// origin and on to a load that hangs straight down.
///
/// theta is the free span's angle from straight down, outwards from the pulley; l its length. The
/// tangent point is R n and the bob R n + l e with e = (-sin, -cos) theta, n = (-cos, sin) theta;
/// since e' = theta' n and n' = -theta' e, its velocity is (l' - R theta') e + l theta' n. With
/// q = l - R theta, the material that has come over the pulley, and M = m + m_load + sum I/R^2:
///   M q''     = m l theta'^2 + m g cos theta - m_load g
///   l theta'' = -R theta'^2 - 2 q' theta' - g sin theta
struct SwingingLoad {
  double radius = 0.5;   // m, R
  double mass = 1.0;     // kg, of the bob
  double load = 1.0;     // kg, of the hanging load
  double pulleys = 0.0;  // kg, sum of I/R^2
  double g = 9.81;       // m/s^2

  /// dy/dt of y = (theta, theta', q, q').
  State derivative(const State& y) const;
  /// Bob (m) at y.
  void place(const State& y, double& x, double& y_m) const;
  /// Kinetic and potential energy (J) up to a constant.
  double energy(const State& y) const;
};

/// A roller of mass m rolls without slip on the cable that is wrapped round a fixed drum: an
/// inverted pendulum of length D = r1 + r2 + 2w. With R2 = r2 + w to the cable's centre line it
/// turns at -phi' D / R2, so
///   (1 + I/(m R2^2)) D phi'' = g sin phi,     phi from the vertical, clockwise.
struct RollerOnDrum {
  double distance = 1.0;       // m, D
  double inertia_share = 0.5;  // I / (m R2^2)
  double g = 9.81;             // m/s^2

  /// dy/dt of y = (phi, phi').
  State derivative(const State& y) const;
  /// Energy over the roller's mass (J/kg) up to a constant.
  double energy(const State& y) const;
};

}  // namespace pinchlab::experiments
