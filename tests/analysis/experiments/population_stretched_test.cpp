// SPDX-License-Identifier: GPL-3.0-or-later
// Random scenes on cables that stretch.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "analysis/experiments/population.h"
#include "analysis/experiments/population_scenes.h"
#include "tests/analysis/experiments/watched.h"
#include "tests/sim/other_end.h"

namespace pinchlab::experiments {
namespace {

// What falls on cables that stretch. In the first two these slip, or run over corners that hold
// them, and what came on to rims left its stretch behind. In the others something happens where
// next to nothing is left of a cable between two bodies, or a body and the cable's end, or where
// bodies part that have pressed it: it was taken to be as stiff as that. They gained up to all of
// the energy at play, those above up to 1 % at any step.
TEST(Population, WhatStretchesMakesNoEnergy) {
  for (const int seed : {29, 565, 95, 591, 744, 772}) {
    const Scene scene = stretched_shapes(static_cast<std::uint64_t>(seed)).scene;
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).energy_gain, 2e-3)
          << seed << " at " << steps;
    }
  }
}

// Spans that closed faster than steps followed; slack cable over smooth bodies of which a short
// span stayed stretched (674); and a compound that bounced off the cable and was wound round from
// the wrong side (852). They gained 0.1 to 5 times all of the energy at play.
TEST(Population, WhatStretchesMakesNoEnergyWhereSpansCloseFast) {
  for (const int seed : {80, 359, 383, 670, 674, 796, 852, 973}) {
    const Scene scene = stretched_shapes(static_cast<std::uint64_t>(seed)).scene;
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).energy_gain, 2e-3)
          << seed << " at " << steps;
    }
  }
}

// Vertices of two polygons pass each other (459); a corner comes upon a span from beyond its end,
// was given a link that came off at once, and again at every event, each time leaving some cable on
// the rim beside it that was more stretched (686). Up to five times the energy at play. (At one
// step a frame another corner of 459 comes past a tip and takes the cable off that: 0.18 of it.)
TEST(Population, WhatStretchesMakesNoEnergyAtCornersThatPass) {
  for (const int seed : {459, 686}) {
    const Scene scene = stretched_shapes(static_cast<std::uint64_t>(seed)).scene;
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).energy_gain, 1e-9)
          << seed << " at " << steps;
    }
  }
}

// Heavy ropes on rough bodies. What rims took of a short span was not stretched, so that its last
// had less than no material (568, 648); and what had slackened at both ends of a rim, all at once,
// took more than one of the spans had (900). 0.1 to 12 times the energy at play.
TEST(Population, WhatStretchesMakesNoEnergyWhereRimsCarryIt) {
  for (const int seed : {568, 648, 900}) {
    const Scene scene = stretched_shapes(static_cast<std::uint64_t>(seed)).scene;
    for (const int steps : {1, 4, 16}) {
      EXPECT_LE(run_scene(scene, watched(), steps, 60).energy_gain, 1e-9)
          << seed << " at " << steps;
    }
  }
}

// A pinch on an elastic cable opens that had some material to itself: the next span has it. What
// the rim beside it carried had taken it up without room, and 18 um of the cable were lost.
TEST(Population, WhatStretchesKeepsItsLengthAsAPinchOpens) {
  const Scene scene = stretched_shapes(918).scene;
  for (const int steps : {1, 4, 16}) {
    EXPECT_LE(run_scene(scene, watched(), steps, 60).length_error, 1e-12) << steps;
  }
}

// Rough rims on which an elastic cable slides in part (sim/cable/partial_slip.h). Where the pulls
// of both spans meet on a rim a 24th of it went to one of them (8), and rims at either end of a
// span (74) took from it one after the other: 0.7 um and 0.04 um apart after 0.3 s.
TEST(Population, WhatStretchesMovesTheSameFromEitherEnd) {
  for (const int seed : {8, 74}) {
    const ShapelyScene drawn = stretched_shapes(static_cast<std::uint64_t>(seed));
    const Soundness one = run_scene(drawn.scene, watched(), 4, 18);
    const Soundness other = run_scene(testing::from_the_other_end(drawn.scene), watched(), 4, 18);
    for (std::size_t b = 0; b < drawn.bodies; ++b) {
      EXPECT_LE((one.positions[b] - other.positions[b]).norm(), 1e-9) << seed << ", body " << b;
    }
  }
}

// Between two events an interval of 2e-14 s is left, in which impulses are what round-off asks for:
// by these the cable slid 15 m, at 6e14 m/s, and had 4e4 times the energy at play.
TEST(Population, WhatStretchesDoesNotSlideInNoTime) {
  const Scene scene = stretched_shapes(764).scene;
  EXPECT_LE(run_scene(scene, watched(), 16, 60).energy_gain, 1e-9);
}

}  // namespace
}  // namespace pinchlab::experiments
