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

}  // namespace
}  // namespace pinchlab::experiments
