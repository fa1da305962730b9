// SPDX-License-Identifier: GPL-3.0-or-later
// Boxes that meet with corner on corner: towers of boxes of one width, and such as lean on each
// other.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/at.h"
#include "sim/outline.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double width = 0.3;  // m, and height
const Vec2 pull(5.5, -9.81);   // m/s^2

/// That many boxes of 1 kg on one another, on a floor on which they do not slip, listed from below
/// or from above.
Scene tower(int boxes, bool from_below) {
  Scene scene;
  scene.gravity = pull;
  scene.walls.push_back({{-5, 0}, {5, 0}, 0.9});
  for (int k = 0; k < boxes; ++k) {
    const int level = from_below ? k : boxes - 1 - k;
    Body box =
        body("box " + std::to_string(level), BodyKind::free, 0.0, (level + 0.5) * width, 0.0, 1.0);
    const double half = 0.5 * width;
    make_polygon(box, {{-half, -half}, {half, -half}, {half, half}, {-half, half}}, 0.0);
    box.contact_friction = 0.9;
    scene.bodies.push_back(box);
  }
  return scene;
}

/// rad, by which a tower has tilted about its foremost corner after `time` (s), as one body.
double tilted_by(int boxes, double time) {
  const double height = boxes * width;
  const double half_diagonal = 0.5 * std::hypot(width, height);
  const double arm_squared =
      (width * width + height * height) / 12.0 + half_diagonal * half_diagonal;
  const double upright = std::atan2(height, -width);
  double angle = 0.0, turning = 0.0;
  constexpr int steps = 20000;
  const double h = time / steps;
  const auto turn = [&](double share) {
    const double direction = upright + angle;
    const Vec2 arm = half_diagonal * Vec2(std::cos(direction), std::sin(direction));
    turning += share * h * (arm.x() * pull.y() - arm.y() * pull.x()) / arm_squared;
  };
  for (int k = 0; k < steps; ++k) {
    turn(0.5);
    angle += h * turning;
    turn(0.5);
  }
  return angle;
}

// Corners that lie on one another swap, by round-off, which of the two is beyond the other's side:
// there a distance has no direction of its own, and the tower must not be moved by it.
TEST(Towers, BoxesOfOneWidthTiltAsOne) {
  constexpr int frames = 25;
  for (const int boxes : {2, 3, 4, 5}) {
    const double exact = tilted_by(boxes, frames / 60.0);
    for (const bool from_below : {true, false}) {
      for (const int steps : {1, 2, 4, 8}) {
        SCOPED_TRACE(::testing::Message() << boxes << " boxes, " << steps << " steps, from "
                                          << (from_below ? "below" : "above"));
        const World world = after(tower(boxes, from_below), steps, frames / 60.0);
        for (const double angle : world.angle) EXPECT_NEAR(angle, world.angle[0], 1e-9);
        const double error = std::abs(world.angle[0] - exact);
        EXPECT_LT(error, 1e-4 / (steps * steps));
      }
    }
  }
}

/// Two boards of 1 kg, 1 m by 2 cm, that lean on each other, corner on corner, at that angle (rad)
/// to a floor; `gap` (m) apart at first.
Scene leaning(double angle, double gap) {
  Scene scene;
  scene.walls.push_back({{-3, 0}, {3, 0}, 0.7});
  const std::vector<Vec2> corners = {{-0.5, -0.01}, {0.5, -0.01}, {0.5, 0.01}, {-0.5, 0.01}};
  const double right = turned(corners[1], angle).x(), low = turned(corners[0], angle).y();
  for (const double side : {-1.0, 1.0}) {
    Body board = body(side < 0.0 ? "left" : "right", BodyKind::free, side * (right + 0.5 * gap),
                      -low, 0.0, 1.0);
    make_polygon(board, corners, 0.0);
    board.angle = side < 0.0 ? angle : std::numbers::pi - angle;
    board.contact_friction = 0.7;
    scene.bodies.push_back(board);
  }
  return scene;
}

// Corners that rest on each other bear a force along either's way and along what is between: where
// the floor holds, which takes cot(angle) / 2 of friction, two boards stand. By one of the ways
// alone they would slide below the angle of friction, 55 degrees, and creep above it.
TEST(Towers, BoardsThatLeanOnEachOtherStand) {
  for (const double degrees : {50.0, 60.0, 65.0, 75.0, 85.0}) {
    for (const double gap : {0.0, 1e-9, 1e-6, 1e-3}) {
      // Having met, they might slide as well, down to that angle.
      if (gap > 0.0 && degrees < 55.0) continue;
      const Scene scene = leaning(degrees * std::numbers::pi / 180.0, gap);
      for (const int steps : {1, 4, 16}) {
        SCOPED_TRACE(::testing::Message() << degrees << " degrees, " << gap << " m apart, " << steps
                                          << " steps a frame");
        const World world = after(scene, steps, 2.0);
        for (std::size_t b = 0; b < 2; ++b) {
          EXPECT_NEAR((world.position[b] - scene.bodies[b].position).norm(), 0.0, gap + 1e-12);
          EXPECT_LT(world.velocity[b].norm(), 1e-9);
        }
        EXPECT_NEAR(world.position[0].x() + world.position[1].x(), 0.0, 1e-9);
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
