// SPDX-License-Identifier: GPL-3.0-or-later
// The references themselves, against closed forms and conserved energy.

#include "analysis/experiments/references.h"

#include <gtest/gtest.h>

#include <cmath>

namespace pinchlab::experiments {
namespace {

constexpr double g = 9.81;

TEST(References, IntegratesAnOscillatorToRoundOff) {
  const auto states = integrate(
      [](const State& y) -> State {
        return {y[1], -y[0]};
      },
      {1.0, 0.0}, 0.1, 100);
  ASSERT_EQ(states.size(), 101u);
  for (std::size_t i = 0; i < states.size(); ++i) {
    EXPECT_NEAR(states[i][0], std::cos(0.1 * static_cast<double>(i)), 1e-11);
  }
}

TEST(References, AtwoodBalancesItsTensions) {
  const double m1 = 1.0, m2 = 3.0, pulleys = 0.8, a = atwood_acceleration(m1, m2, pulleys, g);
  EXPECT_NEAR(m2 * (g - a) - m1 * (g + a), pulleys * a, 1e-12);
}

TEST(References, SlippingAtwoodHoldsTheCapstanRatio) {
  const double m1 = 1.0, m2 = 3.0, k = 1.17, a = slipping_atwood_acceleration(m1, m2, k, g);
  EXPECT_NEAR(m2 * (g - a), k * m1 * (g + a), 1e-12);
  EXPECT_NEAR(slipping_atwood_acceleration(m1, m2, 1.0, g), atwood_acceleration(m1, m2, 0.0, g),
              1e-14);
}

TEST(References, SwingingLoadKeepsItsEnergy) {
  const SwingingLoad swing{0.55, 1.0, 1.2, 1.7, g};
  const auto states = integrate([&](const State& y) { return swing.derivative(y); },
                                {0.6, 0.0, 2.2, 0.3}, 1.0 / 60.0, 120);
  for (const State& y : states) EXPECT_NEAR(swing.energy(y), swing.energy(states[0]), 1e-10);
  EXPECT_GT(std::abs(states.back()[0] - 0.6), 0.1) << "it swings";
}

// Its equations are consistent with its geometry: the velocity that the energy is made of is the
// derivative of the bob's place.
TEST(References, SwingingLoadsEnergyIsThatOfItsMotion) {
  const SwingingLoad swing{0.55, 1.0, 0.0, 0.0, g};
  const State y{0.6, 0.7, 2.2, 0.3};
  constexpr double h = 1e-5;
  double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
  swing.place({y[0] - h * y[1], 0.0, y[2] - h * y[3], 0.0}, x0, y0);
  swing.place({y[0] + h * y[1], 0.0, y[2] + h * y[3], 0.0}, x1, y1);
  const double vx = (x1 - x0) / (2.0 * h), vy = (y1 - y0) / (2.0 * h);
  EXPECT_NEAR(swing.energy(y) - swing.energy({y[0], 0.0, y[2], 0.0}), 0.5 * (vx * vx + vy * vy),
              1e-8);
}

TEST(References, SwingingLoadThatHangsStraightIsAnAtwoodMachine) {
  const SwingingLoad swing{0.55, 1.0, 1.2, 1.7, g};
  const auto states =
      integrate([&](const State& y) { return swing.derivative(y); }, {0.0, 0.0, 2.0, 0.0}, 0.5, 1);
  EXPECT_NEAR(states[1][2] - 2.0, 0.125 * atwood_acceleration(1.2, 1.0, 1.7, g), 1e-11);
  EXPECT_EQ(states[1][0], 0.0);
}

// A pulley that nothing turns leaves the pendulum that unwinds from a drum: l = l0 + R theta,
// l theta'' + R theta'^2 + g sin theta = 0.
TEST(References, SwingingLoadOnAHeavyPulleyIsAnUnwindingPendulum) {
  const double R = 0.55, l0 = 2.0;
  const SwingingLoad swing{R, 1.0, 0.0, 1e14, g};
  const auto states =
      integrate([&](const State& y) { return swing.derivative(y); }, {0.7, 0.0, l0, 0.0}, 0.5, 2);
  const auto pendulum = integrate(
      [=](const State& y) -> State {
        return {y[1], -(R * y[1] * y[1] + g * std::sin(y[0])) / (l0 + R * y[0])};
      },
      {0.7, 0.0}, 0.5, 2);
  EXPECT_NEAR(states[2][0], pendulum[2][0], 1e-10);
}

TEST(References, RollerOnDrumKeepsItsEnergyAndFallsLikeACosh) {
  const RollerOnDrum roller{0.85, 0.35, g};
  const auto derivative = [&](const State& y) { return roller.derivative(y); };
  const auto states = integrate(derivative, {-0.05, 0.8}, 1.0 / 60.0, 30);
  for (const State& y : states) EXPECT_NEAR(roller.energy(y), roller.energy(states[0]), 1e-11);
  const double small = 1e-5, rate = std::sqrt(g / (0.85 * 1.35));
  const auto falling = integrate(derivative, {small, 0.0}, 0.5, 1);
  EXPECT_NEAR(falling[1][0] / (small * std::cosh(rate * 0.5)), 1.0, 1e-7);
}

// A ball thrown up at 1 m/s, twice: phases end at their events to round-off.
TEST(References, PhasesEndAtTheirEvents) {
  const auto falls = [](const State& y) -> State { return {y[1], -g}; };
  const auto height = [](const State& y) { return y[0]; };
  const auto thrown = [](const State&) -> State { return {0.0, 1.0}; };
  const auto states = integrate({{falls, height, thrown}, {falls, height, thrown}, {falls, {}, {}}},
                                {0.0, 1.0}, 0.05, 10);
  const double t = 0.5 - 2.0 * (2.0 / g);
  EXPECT_NEAR(states[10][0], t - 0.5 * g * t * t, 1e-13);
  EXPECT_NEAR(states[10][1], 1.0 - g * t, 1e-12);
}

TEST(References, GalileosPendulumKeepsItsEnergyAndItsPlaceAtThePeg) {
  const PegPendulum pendulum{1.0, 0.5, 0.03, g};
  const auto states = integrate(pendulum.phases(), {-std::atan2(0.8, 0.6), 0.0}, 1.0 / 60.0, 90);
  double highest = -1.0, farthest = -1.0;
  for (const State& y : states) {
    EXPECT_NEAR(pendulum.energy(y), pendulum.energy(states[0]), 1e-11);
    double x = 0.0, height = 0.0;
    pendulum.place(y, x, height);
    farthest = std::max(farthest, y[0]);
    if (y[0] > 0.0) highest = std::max(highest, height);
  }
  EXPECT_NEAR(highest, -0.6, 1e-3) << "it rises to its old height";
  EXPECT_GT(farthest, 1.0) << "round the peg";
  EXPECT_LT(states.back()[0], pendulum.meets()) << "and comes back";
  double x0 = 0.0, y0 = 0.0, x1 = 0.0, y1 = 0.0;
  pendulum.place({pendulum.meets() - 1e-12, 0.0}, x0, y0);
  pendulum.place({pendulum.meets() + 1e-12, 0.0}, x1, y1);
  EXPECT_NEAR(std::hypot(x1 - x0, y1 - y0), 0.0, 1e-11);
}

// Newton's law for the bob's own place, by differences: what is left of its acceleration without
// gravity is the cable's pull, along the span; against the load's it obeys the capstan law.
TEST(References, LoopingPendulumObeysNewtonAndTheCapstanLaw) {
  const LoopingPendulum pendulum{0.05, 0.3, 1.0, 3.0, 1.0, 1.5707963267948966, g};
  constexpr double h = 1e-4;
  const int count = 11600;
  const auto states = integrate(pendulum.phases(), {pendulum.start_angle, 0.0, 0.0, 0.0}, h, count);
  int slipping = 0, sticking = 0;
  const auto slips = [&](int i) { return states[static_cast<std::size_t>(i)][3] > 0.0; };
  for (int i = 10; i + 10 < count; i += 7) {
    if (slips(i - 2) != slips(i) || slips(i + 2) != slips(i)) continue;  // an event between
    double x[3], y[3];
    for (int k = 0; k < 3; ++k) {
      pendulum.place(states[static_cast<std::size_t>(i + k - 1)], x[k], y[k]);
    }
    const State& s = states[static_cast<std::size_t>(i)];
    const double ax = (x[0] - 2.0 * x[1] + x[2]) / (h * h);
    const double ay = (y[0] - 2.0 * y[1] + y[2]) / (h * h) + g;
    const double ex = -std::sin(s[0]), ey = std::cos(s[0]);
    const double pull = -(ax * ex + ay * ey), across = ax * -ey + ay * ex;
    const double slip = (states[static_cast<std::size_t>(i - 1)][2] - 2.0 * s[2] +
                         states[static_cast<std::size_t>(i + 1)][2]) /
                        (h * h);
    const double load = 3.0 * (g - slip), k = std::exp(0.3 * s[0]);
    EXPECT_NEAR(across, 0.0, 1e-4 * pull) << i;
    EXPECT_NEAR(pull, pendulum.bob_tension(s, slip), 1e-4 * pull) << i;
    EXPECT_GT(pull, 2.0) << i << ": it never gets slack";
    if (slips(i)) {
      EXPECT_NEAR(load, k * pull, 1e-3 * load) << i;
      ++slipping;
    } else {
      EXPECT_LE(load, k * pull * (1.0 + 1e-4)) << i;
      EXPECT_LE(pull, k * load * (1.0 + 1e-4)) << i;
      ++sticking;
    }
  }
  EXPECT_GT(slipping, 500);
  EXPECT_GT(sticking, 500);
  EXPECT_GT(states.back()[0], pendulum.start_angle + 2.0 * 3.14159) << "more than once round";
  EXPECT_EQ(states.back()[3], 0.0) << "held in the end";
}

}  // namespace
}  // namespace pinchlab::experiments
