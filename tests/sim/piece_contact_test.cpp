// SPDX-License-Identifier: GPL-3.0-or-later
// What lies on a hanging cable between its nodes: sim/pieces.h.

#include <algorithm>
#include <cmath>

#include "sim/lines.h"
#include "sim/make_world.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/touch.h"
#include "tests/sim/random.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double half_width = 0.01;  // m

/// The least distance (m) of a body's outline from the surface of any awake piece.
double clearance_over_pieces(const World& world, int body) {
  const BodyProperties& b = pinchlab::at(world.bodies, body);
  double least = infinity;
  for (const CableState& cable : world.cables) {
    if (!cable.piece || cable.pieces == 0) continue;
    const auto& segment = cable.segments[1];
    const int points = is_polygon(b) ? static_cast<int>(b.corners.size()) : 1;
    for (int k = 0; k < points; ++k) {
      const Vec2 p = place_of_point(world, body, k);
      least = std::min(least, distance_from_line(segment.tail, segment.head, p) - rim_radius(b) -
                                  cable.half_width);
    }
  }
  return least;
}

/// A ball over the middle of a piece of a cable between two points 1 m apart.
Scene ball_on_cable(double mass_per_metre, double slack, int nodes, double x = 0.0) {
  Scene scene;
  scene.bodies.push_back(body("ball", BodyKind::free, x, 0.1, 0.02, 0.2));
  scene.cables.push_back(cable(at(-0.5, 0.0), {}, at(0.5, 0.0), half_width));
  Cable& rope = scene.cables[0];
  rope.slack = slack;
  rope.mass_per_metre = mass_per_metre;
  rope.nodes = nodes;
  rope.linear_drag = 2.0;
  scene.bodies[0].linear_drag = 2.0;
  spread_nodes(scene);
  return scene;
}

TEST(PieceContact, ASmallBallRestsBetweenTwoNodes) {
  for (const int steps : {1, 4, 16}) {
    Scene scene = ball_on_cable(0.5, 0.1, 4);
    scene.steps_per_frame = steps;
    World world = make_world(scene, measured());
    Workspace work;
    while (world.time() < 8.0) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      ASSERT_GT(clearance_over_pieces(world, 0), -1e-6 * half_width)
          << world.time() << " s, " << steps << " steps a frame";
    }
    EXPECT_NEAR(clearance_over_pieces(world, 0), 0.0, 1e-6 * half_width) << steps;
    EXPECT_LT(world.velocity[0].norm(), 1e-6) << steps;
    EXPECT_NEAR(world.position[0].x(), 0.0, 1e-9);
    ASSERT_EQ(std::count_if(world.contacts.begin(), world.contacts.end(),
                            [](const Contact& c) { return c.touching; }),
              1);
    for (const Contact& contact : world.contacts) {
      if (contact.touching) {
        EXPECT_NEAR(contact.normal_force, 0.2 * g, 1e-6) << steps;
      }
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
