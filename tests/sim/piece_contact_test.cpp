// SPDX-License-Identifier: GPL-3.0-or-later
// What lies on a hanging cable between its nodes: sim/pieces.h.

#include <algorithm>
#include <cmath>

#include "sim/lines.h"
#include "sim/make_world.h"
#include "sim/nodes.h"
#include "sim/outline.h"
#include "sim/touch.h"
#include "tests/sim/random_on_pieces.h"
#include "tests/sim/same_state.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

constexpr double half_width = 0.01;  // m

bool is_awake_piece(const CableState& cable) {
  return cable.piece && cable.pieces > 0;
}

/// How far a disc is from any piece, or a polygon's nearest corner (m); below 0: in it.
double clearance_over_pieces(const World& world, int body) {
  const BodyProperties& b = pinchlab::at(world.bodies, body);
  const int points = is_polygon(b) ? static_cast<int>(b.corners.size()) : 1;
  double least = infinity;
  for (const CableState& cable : world.cables) {
    if (!is_awake_piece(cable)) continue;
    const Segment& piece = cable.segments[1];
    for (int k = 0; k < points; ++k) {
      const double distance =
          distance_from_line(piece.tail, piece.head, place_of_point(world, body, k));
      least = std::min(least, distance - rim_radius(b) - cable.half_width);
    }
  }
  return least;
}

int count_touching(const World& world) {
  return static_cast<int>(std::ranges::count_if(world.contacts, &Contact::touching));
}

/// A ball of 0.2 kg over a cable of five pieces between two points 1 m apart.
Scene ball_on_cable(double x, double stiffness = infinity) {
  Scene scene;
  scene.bodies.push_back(body("ball", BodyKind::free, x, 0.05, 0.02, 0.2));
  scene.cables.push_back(cable(at(-0.5, 0.0), {}, at(0.5, 0.0), half_width));
  Cable& rope = scene.cables[0];
  rope.slack = 0.1;
  rope.axial_stiffness = stiffness;
  rope.mass_per_metre = 0.5;
  rope.nodes = 4;
  rope.linear_drag = scene.bodies[0].linear_drag = 20.0;
  spread_nodes(scene);
  return scene;
}

/// What is left of the forces on a node at rest (N).
Vec2 force_on_node(const World& world, int node) {
  const BodyProperties& body = pinchlab::at(world.bodies, node);
  Vec2 force(0.0, -g * body.mass);
  for (const CableState& cable : world.cables) {
    if (!cable.piece) continue;
    const Segment& piece = cable.segments[1];
    const bool is_tail = cable.links[0].body == node, is_head = cable.links[1].body == node;
    if (is_tail) force += piece.tension * piece.direction;
    if (is_head) force -= piece.tension * piece.direction;
    if (!is_tail && !is_head) continue;
    for (const Contact& contact : world.contacts) {
      if (contact.touch != Touch::piece || !contact.touching) continue;
      if (&pinchlab::at(world.cables, contact.piece) != &cable) continue;
      const Vec2 from_tail = world.position[0] - piece.tail;
      const double s = from_tail.dot(piece.direction) / piece.length;
      const Vec2 on_b =
          contact.normal_force * contact.normal + contact.tangent_force * left(contact.normal);
      force += (is_head ? s : 1.0 - s) * (contact.b == 0 ? Vec2(-on_b) : on_b);
    }
  }
  return force;
}

TEST(PieceContact, ASmallBallRestsBetweenTwoNodes) {
  for (const double stiffness : {infinity, 2e3}) {
    for (const int steps : {1, 4, 16}) {
      for (const double x : {0.0, 0.03}) {
        Scene scene = ball_on_cable(x, stiffness);
        scene.steps_per_frame = steps;
        World world = make_world(scene, measured());
        Workspace work;
        while (world.time() < 8.0) {
          ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
          ASSERT_GT(clearance_over_pieces(world, 0), -1e-6 * half_width) << world.time();
        }
        EXPECT_NEAR(clearance_over_pieces(world, 0), 0.0, 1e-6 * half_width) << steps;
        EXPECT_LT(world.velocity[0].norm(), 1e-6) << steps;
        // The ball's weight goes to the two nodes beside it by their shares.
        for (int node = 1; node <= 4; ++node) {
          EXPECT_LT(force_on_node(world, node).norm(), 1e-5) << node << ' ' << steps << ' ' << x;
        }
        if (x != 0.0) continue;
        EXPECT_EQ(count_touching(world), 1);
        EXPECT_NEAR(world.position[0].x(), 0.0, 1e-9);
        // Of a V: half of the weight at either end; ends' half pieces hang from the points.
        const Segment& first = world.cables[0].segments[1];
        const double weight = g * (0.2 + 4.0 * world.bodies[1].mass);
        EXPECT_NEAR(first.tension, 0.5 * weight / -first.direction.y(), 1e-5);
      }
    }
  }
}

TEST(PieceContact, APolygonRestsOnItsCornersBetweenTwoNodes) {
  for (const int steps : {1, 4, 16}) {
    Scene scene = ball_on_cable(0.01);
    make_polygon(scene.bodies[0], {{-0.03, -0.02}, {0.03, -0.02}, {0.03, 0.02}, {-0.03, 0.02}},
                 0.0);
    scene.bodies[0].radius = std::hypot(0.03, 0.02);
    scene.bodies[0].angular_drag = 20.0;
    scene.steps_per_frame = steps;
    World world = make_world(scene, measured());
    Workspace work;
    while (world.time() < 6.0) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      ASSERT_GT(clearance_over_pieces(world, 0), -1e-6 * half_width) << world.time();
    }
    EXPECT_NEAR(clearance_over_pieces(world, 0), 0.0, 1e-6 * half_width) << steps;
    EXPECT_LT(world.velocity[0].norm(), 1e-5) << steps;
    EXPECT_EQ(count_touching(world), 2);
  }
}

// A wall of no width ends under the cable, which falls over the end with a weight.
TEST(PieceContact, ACableLiesOverTheEndOfAWall) {
  for (const int steps : {1, 4, 16}) {
    Scene scene;
    scene.bodies.push_back(body("weight", BodyKind::free, 0.5, 0.3, 0.03, 0.3));
    scene.bodies[0].linear_drag = 5.0;
    scene.cables.push_back(cable(at(-0.5, 0.2), {}, on(0), half_width));
    scene.cables[0].mass_per_metre = 0.5;
    scene.cables[0].nodes = 6;
    scene.cables[0].linear_drag = 5.0;
    scene.walls.push_back({{-1.0, 0.0}, {0.03, 0.0}, 0.5, 0.0});
    scene.steps_per_frame = steps;
    spread_nodes(scene);
    World world = make_world(scene, measured());
    Workspace work;
    const Vec2 end = scene.walls[0].b;
    double least = infinity;
    while (world.time() < 6.0) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
      least = infinity;
      for (const CableState& cable : world.cables) {
        const Segment& piece = cable.segments[1];
        least = std::min(least, distance_from_line(piece.tail, piece.head, end) - half_width);
      }
      ASSERT_GT(least, -1e-6 * half_width) << world.time() << ' ' << steps;
    }
    EXPECT_NEAR(least, 0.0, 1e-6 * half_width);
    EXPECT_LT(world.position[0].y(), -0.1);
  }
}

/// A bead of 50 g slides for 0.8 s along a taut cable of n nodes that runs down by 0.2, without
/// friction.
struct Slide {
  double way = 0.0;                 // m
  double gained = 0.0, lost = 0.0;  // of the kinetic energy at the end, at most and in the end
};

Slide slide(int nodes, int steps) {
  Scene scene;
  const Vec2 d(2.0, -0.4), e = d.normalized();
  constexpr double tension = 1e3, stiffness = 1e6;  // N
  Body bead = body("bead", BodyKind::free, 0.25 * d + (half_width + 0.02) * left(e), 0.02, 0.05);
  bead.contact_friction = 0.0;
  scene.bodies.push_back(bead);
  scene.cables.push_back(cable(at(0.0, 0.0), {}, at(d.x(), d.y()), half_width));
  Cable& rope = scene.cables[0];
  rope.axial_stiffness = stiffness;
  rope.slack = -tension / stiffness * d.norm();
  rope.mass_per_metre = 0.02;
  rope.nodes = nodes;
  scene.steps_per_frame = steps;
  spread_nodes(scene);
  World world = make_world(scene, measured());
  Workspace work;
  Slide result;
  double start = 0.0;
  for (int i = 0; world.time() < 0.8 - 0.5 * world.step_length; ++i) {
    EXPECT_EQ(step(scene, world, work), StepStatus::ok) << world.failure;
    if (i == 0) start = world.diagnostics.energy;
    result.gained = std::max(result.gained, world.diagnostics.energy - start);
  }
  const double kinetic = kinetic_energy(world);
  result.gained /= kinetic;
  result.lost = (start - world.diagnostics.energy) / kinetic;
  result.way = (world.position[0] - bead.position).dot(e);
  return result;
}

// Past all nodes as along a straight line, but for what the cable gives: it bends by W / T = 5e-4
// at the bead, which falls by up to 0.25 mm as it starts, and strikes the next piece at that angle.
TEST(PieceContact, ABeadSlidesAlongATautCable) {
  const double slope = 0.4 / std::hypot(2.0, 0.4), t = 0.8;
  for (const int steps : {1, 4, 16}) {
    for (const int nodes : {7, 15, 31}) {
      const Slide s = slide(nodes, steps);
      EXPECT_NEAR(s.way, 0.5 * g * slope * t * t, 1e-3) << nodes << " nodes, " << steps;
      EXPECT_LT(s.gained, 1e-5) << nodes << " nodes, " << steps;
      EXPECT_LT(s.lost, 3e-3) << nodes << " nodes, " << steps;
    }
  }
}

// What falls on to pieces makes no energy, at any friction and restitution, and comes into none.
// The energy of a wave on the pieces swings by up to a quarter of itself (cable/waves.h): under 3 %
// of all that is at play, but where a landing throws most of that into one wave: two of 1,000.
TEST(PieceContact, RandomLandingsMakeNoEnergyAndKeepOut) {
  int swings = 0;
  for (int seed = 0; seed < seeds_of(200); ++seed) {
    for (const int steps : {1, 4, 16}) {
      Scene scene = random_on_pieces(seed, true);
      scene.steps_per_frame = steps;
      World world = make_world(scene, measured());
      Workspace work;
      double least = infinity, rise = 0.0, at_play = 0.0, in = 0.0;
      while (world.time() < 1.5) {
        ASSERT_EQ(step(scene, world, work), StepStatus::ok) << seed << ' ' << world.failure;
        const double energy = world.diagnostics.energy;
        least = std::min(least, energy);
        rise = std::max(rise, energy - least);
        at_play = std::max(at_play, kinetic_energy(world));
        in = std::max(in, world.diagnostics.largest_gap_violation);
        for (int b = 0; !pinchlab::at(world.bodies, b).node; ++b) {
          in = std::max(in, -clearance_over_pieces(world, b));
        }
      }
      if (rise >= 0.03 * at_play) ++swings;
      EXPECT_LT(rise, 0.05 * at_play) << seed << " at " << steps << " steps a frame";
      EXPECT_LT(in, 1e-3 * half_width) << seed << " at " << steps << " steps a frame";
    }
  }
  EXPECT_LE(swings, 1);
}

TEST(PieceContact, AClearedWorkspaceChangesNoBit) {
  for (int seed = 0; seed < 30; ++seed) {
    EXPECT_TRUE(is_all_state(random_on_pieces(seed, true), Method::pinch, 240)) << seed;
  }
}

TEST(PieceContact, AllPairsFindTheSame) {
  Configuration all = Method::pinch;
  all.detection = Detection::all_pairs;
  for (int seed = 0; seed < 10; ++seed) {
    const Scene scene = random_on_pieces(seed, false);
    World world = make_world(scene, Method::pinch), other = make_world(scene, all);
    Workspace work, other_work;
    for (int i = 0; i < 240; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      ASSERT_EQ(step(scene, other, other_work), StepStatus::ok);
      ASSERT_EQ(world.position, other.position) << seed << ' ' << i;
      ASSERT_EQ(world.velocity, other.velocity) << seed << ' ' << i;
    }
  }
}

// What holds an end of a cable, or is where its end in the world is, lets it pass there.
TEST(PieceContact, WhatHoldsAnEndIsNotMetThere) {
  Scene scene;
  scene.bodies.push_back(body("hook", BodyKind::fixed, 0.0, 0.0, 0.03));
  scene.walls.push_back({{2.0, 0.0}, {3.0, 0.5}, 0.5, 0.0});
  for (const double x : {0.0, 2.0}) {
    const int ball = static_cast<int>(scene.bodies.size());
    scene.bodies.push_back(body(fmt::format("ball {}", ball), BodyKind::free, x, -0.7, 0.05));
    scene.cables.push_back(cable(at(x, 0.0), {}, on(ball), half_width));
    scene.cables.back().name = fmt::format("cable {}", ball);
    scene.cables.back().mass_per_metre = 0.2;
    scene.cables.back().nodes = 4;
  }
  spread_nodes(scene);
  World world = make_world(scene, measured());
  const std::vector<Vec2> start = world.position;
  run(scene, world, 240);
  for (std::size_t b = 0; b < start.size(); ++b) {
    EXPECT_LT((world.position[b] - start[b]).norm(), 1e-9) << b;
  }
}

}  // namespace
}  // namespace pinchlab::testing
