// SPDX-License-Identifier: GPL-3.0-or-later
// What rolls on outlines that turn, or turns as it rolls, against its equation of motion: of second
// order, since the speed at which surfaces slide counts in an interval's middle.

#include <array>
#include <functional>

#include "demos/scenes/shape_scenes.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

using build::box_corners;
using build::box_on_disc;
using build::disc_on_plank;

/// By Runge's and Kutta's method of fourth order, in steps of some 0.1 ms.
template <std::size_t n>
std::array<double, n> integrate(
    std::array<double, n> x, double time,
    const std::function<std::array<double, n>(const std::array<double, n>&)>& rates) {
  const int steps = static_cast<int>(std::ceil(time / 1e-4));
  const double h = time / steps;
  const auto moved = [](std::array<double, n> from, const std::array<double, n>& by, double share) {
    for (std::size_t i = 0; i < n; ++i) from[i] += share * by[i];
    return from;
  };
  for (int k = 0; k < steps; ++k) {
    const auto a = rates(x), b = rates(moved(x, a, 0.5 * h));
    const auto c = rates(moved(x, b, 0.5 * h)), d = rates(moved(x, c, h));
    for (std::size_t i = 0; i < n; ++i) x[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
  }
  return x;
}

/// The order of `error_at` at 1 to 32 steps a frame, from halving to halving.
void expect_second_order(const std::function<double(int)>& error_at, double last) {
  double before = 0.0;
  for (int n = 1; n <= 32; n *= 2) {
    const double error = error_at(n);
    if (n > 1) {
      EXPECT_GT(std::log2(before / error), 1.9) << n << " steps a frame, " << error << " m";
    }
    before = error;
  }
  EXPECT_LT(before, last);
}

Vec2 place_after(Scene scene, int steps_per_frame, int frames, std::size_t body) {
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, measured());
  run(scene, world, frames * steps_per_frame);
  EXPECT_EQ(world.diagnostics.fallbacks, 0);
  return world.position[body];
}

// A disc on a plank that turns about its middle: with s along the plank, th its angle, h the disc's
// height above its line, and rolling omega = th' - s' / r,
//   (m + I / r^2) s'' - (m h + I / r) th'' = m s th'^2 - m g sin th,
//   (J + m (h^2 + s^2) + I) th'' - (m h + I / r) s'' = -2 m s s' th' - m g (s cos th - h sin th).
TEST(Rolling, ADiscOnATurningPlank) {
  const double r = 0.2, thick = 0.2, m = 1.0, I = 0.5 * m * r * r, h = 0.5 * thick + r;
  const Scene scene = disc_on_plank(1);
  const double J = scene.bodies[0].inertia.value();
  Scene of_two_boards;
  of_two_boards.bodies = {body("plank", BodyKind::fixed_axle, 0.0, 0.0, 1.0, 5.0), scene.bodies[1]};
  std::array<Shape, 2> boards;
  for (Shape& board : boards) {
    board.properties.corners = box_corners(1.5, thick);
    board.properties.contact_friction = 2.0;
    board.place = {&board == boards.data() ? -0.75 : 0.75, 0.0};
  }
  add_shapes(of_two_boards, 0, boards);
  const auto rates = [&](const std::array<double, 4>& x) -> std::array<double, 4> {
    const auto& [s, th, s1, th1] = x;
    const double a = m + I / (r * r), b = -(m * h + I / r);
    const double d = J + m * (h * h + s * s) + I;
    const double p = m * s * th1 * th1 - m * g * std::sin(th);
    const double q = -2.0 * m * s * s1 * th1 - m * g * (s * std::cos(th) - h * std::sin(th));
    const double det = a * d - b * b;
    return {s1, th1, (p * d - q * b) / det, (q * a - p * b) / det};
  };
  const auto x = integrate<4>({0.4, 0.0, 0.0, 0.0}, 0.5, rates);
  const double c = std::cos(x[1]), sine = std::sin(x[1]);
  const Vec2 exact(x[0] * c - h * sine, x[0] * sine + h * c);
  for (const Scene& one : {scene, of_two_boards}) {
    expect_second_order([&](int n) { return (place_after(one, n, 30, 1) - exact).norm(); }, 1e-7);
  }
}

// A box on a fixed disc of radius R, of half height h, that rocks by phi:
//   (I + m h^2 + m R^2 phi^2) phi'' = m g (h sin phi - R phi cos phi) - m R^2 phi phi'^2.
TEST(Rolling, ABoxThatRocksOnADisc) {
  const double R = 0.6, h = 0.1, m = 2.0, start = 0.4;
  const Scene scene = box_on_disc(1);
  const double I = scene.bodies[1].inertia.value();
  const auto place = [&](double phi) {
    const Vec2 out(std::sin(phi), std::cos(phi)), along(std::cos(phi), -std::sin(phi));
    return Vec2((R + h) * out - R * phi * along);
  };
  const auto rates = [&](const std::array<double, 2>& x) -> std::array<double, 2> {
    const auto& [phi, speed] = x;
    const double force = m * g * (h * std::sin(phi) - R * phi * std::cos(phi));
    return {speed,
            (force - m * R * R * phi * speed * speed) / (I + m * h * h + m * R * R * phi * phi)};
  };
  const auto x = integrate<2>({start, 0.0}, 1.0, rates);
  const Vec2 exact = place(x[0]);
  expect_second_order([&](int n) { return (place_after(scene, n, 60, 1) - exact).norm(); }, 1e-6);
}

// A box that topples about a corner, l from its centre, which friction holds:
//   (I + m l^2) phi'' = m g l sin phi.
TEST(Rolling, ABoxThatTopplesAboutACorner) {
  const double wide = 0.4, high = 0.8, m = 1.0, l = 0.5 * std::hypot(wide, high);
  Scene scene;
  scene.walls.push_back({{-5.0, 0.0}, {5.0, 0.0}, 5.0, 0.0});
  Body box = body("box", BodyKind::free, 0.0, 0.0, 1.0, m);
  make_polygon(box, box_corners(wide, high), 0.0);
  const double lean = std::atan2(wide, high), start = 0.1;  // of the corner, from upright
  const auto place = [&](double phi) { return Vec2(l * std::sin(phi), l * std::cos(phi)); };
  box.position = place(start);
  box.angle = -(start + lean);
  box.contact_friction = 5.0;
  const double I = box.inertia.value();
  scene.bodies.push_back(box);
  const auto rates = [&](const std::array<double, 2>& x) -> std::array<double, 2> {
    return {x[1], m * g * l * std::sin(x[0]) / (I + m * l * l)};
  };
  const auto x = integrate<2>({start, 0.0}, 0.5, rates);
  const Vec2 exact = place(x[0]);
  expect_second_order([&](int n) { return (place_after(scene, n, 30, 0) - exact).norm(); }, 1e-7);
}

}  // namespace
}  // namespace pinchlab::testing
