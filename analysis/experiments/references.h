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

/// A stretch of a motion between two events.
struct Phase {
  Derivative derivative;
  std::function<double(const State&)> until;   ///< ends where this falls below 0; none: never
  std::function<State(const State&)> becomes;  ///< y after the event, of y before; none: the same
};

/// The same through phases, each from where the one before it ended: the moment is bisected until
/// doubles end. An event whose `until` is below 0 between two of the times only is missed.
std::vector<State> integrate(const std::vector<Phase>& phases, State y, double interval, int count);

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

/// Galileo's peg: a bob on a cable of length L from the origin, which meets a peg straight below,
/// at depth p and of radius R (to the cable's centre line), and winds round it.
///
/// theta is the span's angle from straight down, e = (sin, -cos) theta its direction. The cable
/// lies on the peg while theta > theta_0 = -asin(R/p). The tangent point there is sqrt(p^2 - R^2)
/// from the origin, so that the free length is l = L - sqrt(p^2 - R^2) - R (theta - theta_0). The
/// bob's velocity is l theta' n on either side of theta_0, n = (cos, sin) theta (l = L before): it
/// is the same when the cable meets the peg, and theta' jumps as 1 / l. In between
///   l theta'' = R theta'^2 - g sin theta     (R = 0 off the peg).
struct PegPendulum {
  double length = 1.0;   // m, L
  double depth = 0.5;    // m, p
  double radius = 0.03;  // m, R
  double g = 9.81;       // m/s^2

  double meets() const;                    ///< theta_0, rad
  double free_length(double theta) const;  ///< m
  /// Swing to the peg, round it and back, and away, of y = (theta, theta').
  std::vector<Phase> phases() const;
  void place(const State& y, double& x, double& y_m) const;  ///< bob, m
  /// Energy over the bob's mass (J/kg) up to a constant.
  double energy(const State& y) const;
};

/// A box of mass m and moment of inertia I that slides without friction over the edge of a table,
/// at the origin, and off it; a and b are half of its length and height.
///
/// It begins to tip as its centre c comes over the edge, where what bears its rear corner has come
/// to nothing. Then the edge slides along its underside. With e = (cos, sin) theta, u = (-sin, cos)
/// theta, v = c' and s = -e . c, the place of the edge on the underside, u . c = b gives, twice
/// differentiated, the force N along u at the edge:
///   (1/m + s^2/I) N = g cos theta + b theta'^2 + 2 theta' (e . v),   I theta'' = s N.
/// The edge comes off where s = -a, the box's rear corner, and the force is gone at once.
struct TippingBox {
  double half_length = 0.2;  // m, a
  double half_height = 0.1;  // m, b
  double mass = 1.0;         // kg
  double inertia = 0.01;     // kg m^2
  double g = 9.81;           // m/s^2

  double edge(const State& y) const;   ///< m, s
  double force(const State& y) const;  ///< N
  /// Slides, tips, flies, of y = (x, y, theta, x', y', theta').
  std::vector<Phase> phases() const;
};

/// The looping pendulum: a bob of mass m and a load of mass M on one cable over a fixed rod of
/// radius R (to the cable's centre line) at the origin, on which it slips by the capstan law. The
/// load hangs straight down on the right; from there the cable runs counter-clockwise over the rod,
/// by the angle phi, and on to the bob.
///
/// With n = (cos, sin) phi and e = n', the bob is at R n + l e, and l = l_0 - R (phi - phi_0) - s
/// with s what has slipped towards the load. Its velocity is -s' e - l phi' n, so along n
///   l phi'' = R phi'^2 + 2 s' phi' + g sin phi,
/// and along e its tension is T = m (s'' + l phi'^2 - g cos phi). The load's is M (g - s''). While
/// the cable slips towards the load that is k T, k = e^(mu phi):
///   (M + k m) s'' = M g - k m (l phi'^2 - g cos phi).
/// It sticks where s' comes to 0, and holds while M g <= k T (and T <= k M g).
struct LoopingPendulum {
  double radius = 0.05;       // m, R
  double friction = 0.3;      // mu
  double bob = 1.0;           // kg, m
  double load = 3.0;          // kg, M
  double length = 1.0;        // m, l_0
  double start_angle = 1.57;  // rad, phi_0
  double g = 9.81;            // m/s^2

  double free_length(const State& y) const;                            ///< m, l
  double bob_tension(const State& y, double slip_acceleration) const;  ///< N, T
  /// How fast slipping begins to be faster (m/s^2): s'' as if it slips.
  double slip_acceleration(const State& y) const;
  /// M g over k T where it sticks: slips towards the load above 1.
  double load_over_hold(const State& y) const;
  /// Slips, sticks, slips, sticks, of y = (phi, phi', s, s').
  std::vector<Phase> phases() const;
  void place(const State& y, double& x, double& y_m) const;  ///< bob, m
};

}  // namespace pinchlab::experiments
