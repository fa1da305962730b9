// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/population.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/experiments/population_scenes.h"
#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/make_world.h"
#include "sim/mirror.h"
#include "sim/step.h"
#include "tests/analysis/experiments/watched.h"

namespace pinchlab::experiments {
namespace {

// Discs of masses up to 1e4 apart dropped on cables, at three lengths of the step: no motor, no
// gain. Before solves were watched, energy rose in one run of forty.
TEST(Population, NoEnergyComesFromNowhere) {
  for (int seed = 1; seed <= 40; ++seed) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      const Soundness run = run_scene(scene, watched(), steps, 60);
      EXPECT_TRUE(run.finite) << seed << " at " << steps;
      EXPECT_LE(run.length_error, 1e-12) << seed << " at " << steps;
      if (!run.driven) {
        EXPECT_LE(run.energy_gain, 1e-9) << seed << " at " << steps;
      }
    }
  }
}

// A light ball is stopped by a cable that a heavy weight pulls, and turns the spans beside it by
// half a radian in a step (sim/motion/turning.h). It gained up to 28 % of all energy.
TEST(Population, WhatTurnsSpansFarMakesNoEnergy) {
  for (const int seed : {88, 100, 512, 579, 951, 1573, 1842, 1865}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).energy_gain, 1e-9)
          << seed << " at " << steps;
    }
  }
}

// Cables that lie slack over bodies of finite friction, one of whose spans runs short: it takes
// material from the others. These seeds had spans up to 4 mm too long without tension.
TEST(Population, NoSpanIsTooLongWithoutTension) {
  for (const int seed : {103, 109, 148, 153, 177}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).loose_span, 1e-9) << seed << " at " << steps;
    }
  }
}

// Cables that hardly give, caught in the middle of a step, so that a repair has a long way to go;
// and a pinch that a try turned by more than half a turn, taken back with a turn too many.
TEST(Population, NoSpanIsTooLongAfterALongRepair) {
  for (const int seed : {28, 100, 861, 1126}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).loose_span, 1e-9) << seed << " at " << steps;
    }
  }
}

// Cables that are as straight as can be, where a body comes upon them or two press them: what they
// ask for contradicts itself, and each was left too long for a step, by 2e-9 to 6.5e-4 m. In 1390
// what slides went in circles, in 1308 it happened after more events than are located.
TEST(Population, NoSpanIsTooLongWhereNothingGives) {
  for (const int seed : {308, 318, 1308, 1390, 1748, 1845}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).loose_span, 1e-9) << seed << " at " << steps;
    }
  }
}

// Spans that contradict one another ask for speeds that they do not get, and miss by that. Taken
// for such as repeat others, which miss nothing, they were 0.2 to 49 mm too long.
TEST(Population, NoSpanIsTooLongWhereSpansContradictEachOther) {
  for (const int seed : {124, 757}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_LT(run_scene(scene, watched(), 1, 60).loose_span, 1e-9) << seed;
  }
}

// A disc that has just lost its own link presses the cable at the very end of the arc of the body
// below. The tangent there lies beyond that end, by 1e-9 rad, and as much of the cable was put into
// the pinch: the body, which is fixed and holds the cable, kept that too little on one side for
// good, and 96 of 240 steps could not repair it.
TEST(Population, NothingIsStoredWhereADiscIsPressedOnAnArcsEnd) {
  const Soundness run = run_scene(dropped_discs(1845), watched(), 4, 60);
  EXPECT_EQ(run.unsettled, 0);
  EXPECT_LE(run.loose_span, 1e-10);
}

// Bodies on taut spans that several of them press, or that have just come off one: what a repair
// pushes into a span is met there. These sank into it by 2 mm to 0.3 m, and fell through.
TEST(Population, NoBodySinksThroughASpan) {
  for (const int seed : {216, 424, 446, 477, 573, 600}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).depth, 1e-6) << seed << " at " << steps;
    }
  }
}

// Discs that come upon the ends of cables from beyond, and sank up to their radius into the span.
TEST(Population, NoBodySinksOverAnEnd) {
  for (const int seed : {1, 371, 717, 1494, 1899, 1968}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      const Soundness run = run_scene(scene, watched(), steps, 60);
      EXPECT_LE(run.depth, 1e-6) << seed << " at " << steps;
      EXPECT_LE(run.loose_span, 1e-9) << seed << " at " << steps;
    }
  }
}

// A span swings, or a rim turns, so that the cable leaves the rim below a disc which lies beyond:
// it meets the span, in which it was up to 5 mm deep at 1 step a frame.
TEST(Population, NoBodySinksBesideARim) {
  for (const int seed : {177, 567}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).depth, 1e-6) << seed << " at " << steps;
    }
  }
}

// Motors that wind in what cannot give: those that had thrown weights when they held their speed
// did so again, as stalling left the cable stretched, if a thousandth as fast. They were 914 m and
// 78 m from their cables, and in the other two wound them in by 5 and 1.5 mm. Of one run a
// repair fails for a step in which all is jammed: a span is 9.3 micrometres too long at its end.
TEST(Population, MotorsThatThrowStayStalled) {
  for (const int seed : {11, 1018, 1190, 1229}) {
    for (const int steps : {1, 4, 16}) {
      const Soundness run =
          run_scene(dropped_discs(static_cast<std::uint64_t>(seed)), watched(), steps, 60);
      const bool jams = seed == 1229 && steps == 16;
      EXPECT_LE(run.loose_span, jams ? 1e-5 : 1e-6) << seed << " at " << steps;
      EXPECT_LE(run.gap_violation, 1e-6) << seed << " at " << steps;
      for (const Vec2& position : run.positions) {
        EXPECT_LT(position.norm(), 100.0) << seed << " at " << steps;
      }
    }
  }
}

// Cables as straight as can be that lie on bodies too light for them, runs that jam whichever way
// they slide, slack loops that a roller drags: in 10 to 25 of 60 steps their states went round in
// circles, and something stuck beyond its bounds.
TEST(Population, WhatWentInCirclesSettles) {
  for (const int seed : {216, 369, 600, 658, 948, 1321, 1732, 1923}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_EQ(run_scene(scene, watched(), 1, 60).unsettled, 0) << seed;
  }
  for (const int seed : {390, 551, 984, 1627, 1696}) {
    const Scene scene = dropped_shapes(static_cast<std::uint64_t>(seed)).scene;
    EXPECT_EQ(run_scene(scene, watched(), 1, 60).unsettled, 0) << "shapes " << seed;
  }
}

// Light and heavy discs on cables that bend by 1e-5 and less: doubles do not tell what holds whom,
// impulses are 1e7 to 1e14 of what they come to. Motors that wind in what cannot give. Repairs of
// spans that are straight. In each of these something stuck beyond its bounds, in up to 30 of 60
// steps, or lengths stayed wrong by up to 5e-7 m.
TEST(Population, WhatNearlyContradictsItselfSettles) {
  for (const int seed : {12, 28, 33, 45, 117, 129, 234, 297, 503, 573, 747, 1124, 1262, 1296}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    const Soundness sound = run_scene(scene, watched(), 1, 60);
    EXPECT_EQ(sound.unsettled, 0) << seed;
    EXPECT_LE(sound.loose_span, 1e-9) << seed;
  }
}

// A motor that insists against what jams its cable stretches it. Only its own disc can give that
// back: in the first scene the cable stayed 0.8 mm too long for 126 steps.
TEST(Population, MotorsGiveBackWhatTheyHaveStretched) {
  for (const auto& [seed, steps] : {std::pair(626, 4), std::pair(759, 1), std::pair(759, 4)}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_EQ(run_scene(scene, watched(), steps, 60).unsettled, 0) << seed << " at " << steps;
  }
}

// Middle bodies of pinches that stick in the first round of a solve and slide in the next: what
// they missed while they stuck was taken for slip, which came to 1e8 m/s, and so much material.
TEST(Population, WhatSlidesMakesUpForNothing) {
  for (const int seed : {183, 1132, 1343, 1560}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_LE(run_scene(scene, watched(), 16, 60).length_error, 1e-12) << seed;
  }
}

// A disc jammed on a cable as straight as can be, between impulses of 1e17 N s that all but cancel:
// what they give told nothing, velocities tell that it would have been thrown with 390 J.
TEST(Population, AJammedDiscIsNotThrown) {
  EXPECT_LE(run_scene(dropped_shapes(794).scene, watched(), 16, 60).energy_gain, 1e-9);
}

// A disc comes over a node of a rope on to the piece beside it, as both fall on to a corner below:
// it was met a step later, within the piece, and came to lie on the corner below the rope. When the
// rope left the corner it was up to five half widths within the disc.
TEST(Population, WhatComesOverANodeIsMetAtItsTime) {
  for (const auto& [seed, steps] : {std::pair(480, 4), std::pair(587, 1)}) {
    const Scene scene = shapes_on_hanging_rope(static_cast<std::uint64_t>(seed)).scene;
    EXPECT_LE(run_scene(scene, watched(), steps, 60).gap_violation, 1e-6) << seed;
  }
}

// A corner meets a rope right beside where that is pressed on a disc, and comes off in the same
// instant. Round-off of a picometre that was made up for in 1e-14 s threw it by 1.1 m/s, and with
// that the rope: it gained 1.5 times the energy at play.
TEST(Population, NoRoundOffThrowsWhereEventsComeAtOnce) {
  const Scene scene = shapes_on_hanging_rope(605).scene;
  EXPECT_LE(run_scene(scene, watched(), 16, 60).energy_gain, 1e-6);
}

// A polygon from above, body 3, rolls over the tip that the cable leaves a pulley by, and a corner
// of it comes down on the span beyond: from over the end of that, and past its line within the same
// step. It was met a step later, from below.
TEST(Population, WhatRollsOverATipIsMetFromItsOwnSide) {
  Scene scene = dropped_shapes(411).scene;
  scene.steps_per_frame = 1;
  World world = make_world(scene, Method::pinch);
  Workspace work;
  int met = 0;
  for (int i = 0; i < 40; ++i) {
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    for (const Link& link : world.cables[0].links) {
      if (link.body != 3) continue;
      EXPECT_EQ(link.orientation, 1) << i;
      ++met;
    }
  }
  EXPECT_GT(met, 0);
}

/// By how much the tensions on either side of a cable's unpressed arcs differ by more than the
/// capstan law lets them on arcs as they were `before`, as a share of its greatest.
double beyond_capstan(const World& world, const CableState& cable, const CableState& before) {
  double greatest = 0.0, most = 0.0;
  for (const Segment& segment : cable.segments) greatest = std::max(greatest, segment.tension);
  constexpr double nothing = 1e-9;  // N
  if (greatest < nothing) return 0.0;
  const int count = static_cast<int>(cable.links.size());
  for (int i = 0; i < count; ++i) {
    const Link& link = at(cable.links, i);
    const int after = next_link(cable, i);
    if (link.orientation == 0 || after < 0) continue;
    const double mu = at(world.bodies, link.body).cable_friction;
    const Segment &in = at(cable.segments, i), &out = at(cable.segments, after);
    if (mu == infinity || in.pinched || out.pinched || link.pinch_middle) continue;
    if (at(cable.links, previous_link(cable, i)).pinch_middle) continue;
    if (at(cable.links, after).pinch_middle) continue;
    const double factor = std::exp(mu * std::max(at(before.links, i).wrap, 0.0));
    most = std::max({most, in.tension - factor * out.tension, out.tension - factor * in.tension});
  }
  return most / greatest;
}

// Slack loops that slide everywhere, since something drags them: where one run has to stick it is
// one that can. And a thin cable between bodies that press a thick one feels nothing of that. These
// had tensions in one span of a loop without any in the next, and nothing said so. (Of the first
// 700 scenes 129, 360 and 476 still do, for a step; sim/README.md, "Limits".)
TEST(Population, LoopsKeepTheCapstanLaw) {
  int seen = 0;
  for (const int seed : {45, 49, 94, 158, 283, 318, 356, 470, 484, 573}) {
    Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    scene.steps_per_frame = 1;
    World world = make_world(scene, Method::pinch);
    Workspace work;
    for (int i = 0; i < 60; ++i) {
      const World start = world;
      ASSERT_EQ(step(scene, world, work), StepStatus::ok) << seed;
      // Of a step that was divided these are the tensions of its last interval, and of one that did
      // not settle they keep no law.
      const Diagnostics &d = world.diagnostics, &before = start.diagnostics;
      if (d.intervals != before.intervals + 1 || d.fallbacks != before.fallbacks) continue;
      for (std::size_t c = 0; c < world.cables.size(); ++c) {
        const CableState &cable = world.cables[c], &then = start.cables[c];
        if (!cable.closed || cable.elastic || cable.links.size() != then.links.size()) continue;
        EXPECT_LT(beyond_capstan(world, cable, then), 1e-6) << seed << " step " << i;
        ++seen;
      }
    }
  }
  EXPECT_GT(seen, 100);
}

// A disc on a span that cannot give, which a motor winds in: it threw the disc at 1e6 m/s.
TEST(Population, SpansThatCannotGiveThrowNothing) {
  const Scene scene = dropped_discs(1252);
  for (const int steps : {16, 64}) {
    EXPECT_TRUE(run_scene(scene, watched(), steps, 40).finite) << steps;
  }
}

// A disc that hits a span of another part, from outside: that it does was found where the step had
// been divided already, and repaired.
TEST(Population, HitsAreMetAtTheirTime) {
  for (const int seed : {205, 1278}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_LE(run_scene(scene, watched(), 16, 60).loose_span, 1e-9) << seed;
  }
}

// A pulley and a disc that pinched a slack cable on it leave the cable within a step, the pulley
// first: then it lies deep in the span that closes up behind the disc, and has not left.
TEST(Population, APulleyIsMetAgainOnceWhatHidItHasLeft) {
  for (const int seed : {1076, 1241}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    EXPECT_LE(run_scene(scene, watched(), 1, 60).depth, 1e-6) << seed;
  }
}

// Seeds in which gaps fell short: discs let down on to pulleys by taut spans (10, 1031, 1225), that
// meet on spans that cannot give (433, 650), moved apart by a repair that then stood as they had
// been (689), and struck (719); and repairs whose whole way made nothing better, so that nothing
// was repaired.
TEST(Population, GapsAreKept) {
  for (const int seed : {10, 433, 650, 689, 717, 719, 1031, 1225, 2725, 4065, 4803}) {
    const Scene scene = dropped_discs(static_cast<std::uint64_t>(seed));
    for (const int steps : {4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).gap_violation, 1e-6)
          << seed << " at " << steps;
    }
  }
}

// A motor without a limit that is struck by what its cable, which cannot give, holds: it gives way,
// and does not throw that. It raised the energy from 4.2 kJ to 3.1 MJ at 4 steps a frame.
TEST(Population, AMotorThatIsStruckDoesNotThrow) {
  Scene scene = dropped_discs(1229);
  for (const int steps : {1, 2, 3, 4, 8, 16}) {
    scene.steps_per_frame = steps;
    World world = make_world(scene, watched());
    Workspace work;
    double start = 0.0, most = 0.0;
    for (int i = 0; i < 60 * steps; ++i) {
      ASSERT_EQ(step(scene, world, work), StepStatus::ok);
      if (i == 0) start = world.diagnostics.energy;
      most = std::max(most, world.diagnostics.energy);
    }
    EXPECT_LE(most, start * (1.0 + 1e-9)) << steps;
  }
}

TEST(Population, AMirrorImageOfASceneIsItsOwnMirrorImage) {
  const Scene scene = dropped_discs(3), twice = mirrored(mirrored(scene));
  const Soundness a = run_scene(scene, watched(), 4, 30), b = run_scene(twice, watched(), 4, 30);
  EXPECT_EQ(end_distance(a, b, false), 0.0);
  EXPECT_EQ(end_distance(a, run_scene(mirrored(scene), watched(), 4, 30), true), 0.0);
}

/// A second of the scene, at three lengths of the step.
void expect_sound(int seed, const ShapelyScene& drawn, double most_energy_gained) {
  for (const int steps : {1, 4, 16}) {
    const Soundness run = run_scene(drawn.scene, watched(), steps, 60);
    EXPECT_TRUE(run.finite) << seed << " at " << steps;
    EXPECT_LE(run.length_error, 1e-12) << seed << " at " << steps;
    EXPECT_LE(run.gap_violation, 1e-3) << seed << " at " << steps;
    EXPECT_LE(run.energy_gain, most_energy_gained) << seed << " at " << steps;
    EXPECT_LE(run.lasting_gain, 1e-9) << seed << " at " << steps;
  }
}

/// The scene as it was when the seeds were found: ropes slip on pulleys that are discs only.
ShapelyScene slipping_on_discs(ShapelyScene drawn) {
  for (Body& b : drawn.scene.bodies) {
    const bool moves = b.name.starts_with("falling");
    if (drawn.has.ropes && (moves || !b.corners.empty())) b.cable_friction = infinity;
  }
  return drawn;
}

// Polygons, compounds, ropes and chains. On spans that cannot give, bodies that were steadied threw
// others: the first five seeds gained 0.04 to 0.98 of all the energy that there was. In the next
// nine gaps were 1e-3 to 3 half widths short. Where ropes slip on all energy swings by more.
TEST(Population, ShapesMakeNoEnergy) {
  std::vector<int> seeds = {24, 45, 581, 769, 909, 19, 69, 500, 513, 621, 647, 669, 867, 887};
  for (int seed = 1; seed <= 12; ++seed) seeds.push_back(seed);
  for (const int seed : seeds) {
    const ShapelyScene drawn = dropped_shapes(static_cast<std::uint64_t>(seed));
    expect_sound(seed, slipping_on_discs(drawn), 1e-9);
    if (drawn.has.ropes) expect_sound(seed, drawn, 1e-4);
  }
}

// A corner that bears nothing for all of the step in which it comes off a side, or is held by that
// side, is a motion of the first order: half of these scenes were 1e-4 m apart, a tenth 4 cm.
TEST(Population, WhatIsThrownOffATableAgreesWithFinerSteps) {
  constexpr int scenes = 80;
  std::vector<double> apart;
  for (std::uint64_t seed = 1; seed <= scenes; ++seed) {
    const Scene scene = thrown_off_a_table(seed);
    const Soundness coarse = run_scene(scene, watched(), 4, 60);
    const Soundness fine = run_scene(scene, watched(), 16, 60);
    for (const Soundness& run : {coarse, fine}) {
      EXPECT_TRUE(run.finite) << seed;
      EXPECT_EQ(run.unsettled, 0) << seed;
      EXPECT_LE(run.gap_violation, 1e-11) << seed;
    }
    EXPECT_LE(coarse.energy_gain, 2e-4) << seed;
    EXPECT_LE(fine.energy_gain, std::max(coarse.energy_gain / 8.0, 1e-6)) << seed;
    apart.push_back(end_distance(coarse, fine, false));
  }
  std::ranges::sort(apart);
  EXPECT_LE(apart[scenes / 2], 5e-5);
  EXPECT_LE(apart[scenes * 9 / 10], 2e-3);
}

// The first six had gaps that were up to 18 half widths short, where nodes were taken in that were
// bent, or lay between corners; the next three up to 11, where the cable came off a corner as well,
// or closed up over a disc that it had left at another node. The last two gained up to 1.3 of all
// energy, where a node was taken in by an interval that was too long for how fast it swung at its
// end. In seeds 351 and 813 a disc came over the end of the rope, where nodes were given off. In
// 523 and 865 the rope folds back about a corner at a node, which lies on no side there; in 9 cable
// gathers in a pinch beside a node that a rim holds. In 4 a corner comes upon the rope right beside
// a node, which is moored and let go until it has come past.
TEST(Population, RopesThatHangMakeNoEnergy) {
  std::vector<int> seeds = {13,  106, 163, 178, 327, 746, 203, 503,
                            963, 25,  372, 813, 351, 523, 865};
  for (int seed = 1; seed <= 10; ++seed) seeds.push_back(seed);
  for (const int seed : seeds) {
    expect_sound(seed, shapes_on_hanging_rope(static_cast<std::uint64_t>(seed)), 2e-3);
  }
}

// Slack ropes that fall turn wheels by what lies over on either side (sim/cable/mass.h). They
// gained 1e-7 to 1.2e-5 of all energy in a tenth of a second, at any length of the step.
TEST(Population, LooseRopesGainNothingAsTheyFall) {
  for (const std::uint64_t seed : {76, 138, 166, 401, 414, 437, 628}) {
    EXPECT_LE(run_scene(shapes_on_hanging_rope(seed).scene, watched(), 16, 6).energy_gain, 1e-8)
        << seed;
  }
}

// On discs, on corners, with slip and without: taken in at once nodes were lifted by up to 3e-3 of
// all energy.
TEST(Population, RimsLiftNoNodes) {
  for (const std::uint64_t seed : {927, 804, 370, 816, 167, 98, 116, 288}) {
    EXPECT_LE(run_scene(shapes_on_hanging_rope(seed).scene, watched(), 4, 60).energy_gain, 1e-9)
        << seed;
  }
}

// Nodes that a jerk whips about, and a span that turns within a few intervals: they gained 8e-3 and
// 7e-3 of all energy.
TEST(Population, RopesThatWhipMakeNoEnergy) {
  const auto gain = [](std::uint64_t seed, int steps) {
    return run_scene(shapes_on_hanging_rope(seed).scene, watched(), steps, 60).energy_gain;
  };
  EXPECT_LE(gain(253, 1), 1e-9);
  EXPECT_LE(gain(158, 1), 1e-9);  // its end was crossed at once, after 48 events in a step
  EXPECT_LE(gain(892, 16), 1e-9);
}

// Many events in a step, after which the rest of it is crossed at once. A span between discs that
// were about to pinch it and their friction contradicted each other by the curvature of their ways,
// which threw all at hundreds of times the speed; and nodes that rims had overrun were left with
// next to no mass, and went on to infinity. In the last a node was left 1e-7 m from a corner, about
// which what it flowed by had no bound.
TEST(Population, RopesThatAreCrossedDoNotRunAway) {
  const auto gain = [](std::uint64_t seed) {
    Scene scene = shapes_on_hanging_rope(seed).scene;
    scene.cables[0].node_tolerance = 1e-2;
    const Soundness sound = run_scene(scene, watched(), 1, 60);
    EXPECT_TRUE(sound.finite) << seed;
    return sound.energy_gain;
  };
  EXPECT_LE(gain(359), 1e-9);
  EXPECT_LE(gain(671), 1e-9);
  EXPECT_LE(run_scene(shapes_on_hanging_rope(390).scene, watched(), 16, 60).energy_gain, 1e-9);
}

}  // namespace
}  // namespace pinchlab::experiments
