// SPDX-License-Identifier: GPL-3.0-or-later
// Corners, heavy ropes and chains that fold.

#include <cmath>

#include "analysis/experiments/stability/items.h"
#include "analysis/experiments/stability/scenes.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/nodes.h"

namespace pinchlab::experiments::stability {

namespace {

constexpr double error_m = 5e-4;  // what the demonstrations ask for

Case case_of(const std::string& series, double x, Scene scene, double seconds, EnergyLaw energy,
             double at_play_j) {
  Case test;
  test.series = series;
  test.x = x;
  test.scene = std::move(scene);
  test.scene.error = error_m;
  test.seconds = seconds;
  test.energy = energy;
  test.energy_at_play_j = at_play_j;
  return test;
}

}  // namespace

Item corners(bool quick) {
  Item item;
  item.id = "corners";
  item.title = "Corners under tension";
  item.x_name = "bob over drum";
  item.why =
      "Ours goes from corner to corner at the time at which a side is in line with the span, where "
      "neither its lever nor its length jumps. A light drum throws its bob up with each corner, "
      "and is caught by it again.";
  item.scene =
      "A bob of 1 kg on a cable that is fixed to a drum of 3 to 12 corners, 0.5 m from its axle, "
      "and winds it to and fro: mass times square of that radius over the drum's inertia. 20 s, "
      "at the 0.5 mm that the demonstrations ask for.";
  for (const int count : {3, 4, 12}) {
    for (const double ratio : decades(-3, 1, quick ? 1 : 2)) {
      Scene scene = build::turning_drum(build::regular_corners(count, 0.5), 0.0, 4);
      scene.bodies[0].inertia = 0.25 / ratio;
      item.cases.push_back(case_of(std::to_string(count) + " corners", ratio, std::move(scene),
                                   quick ? 2.0 : 20.0, EnergyLaw::falls, 3.4 * g));
    }
  }
  return item;
}

Item heavy_ropes(bool quick) {
  Item item;
  item.id = "heavy";
  item.title = "Heavy ropes over pulleys";
  item.x_name = "kg a metre";
  item.why =
      "The rope's mass is the bodies' own while it moves with them, so that a rope much heavier "
      "than its weights is no stiffer a problem than a light one. Plain cable joints have it too.";
  item.scene =
      "Atwood's machine of 1 and 1.5 kg on 4 m of rope, for 0.6 s, whose energy must stay; a block "
      "in the bight of a rope of up to 100 kg a metre that runs on over a pulley to a weight, for "
      "2 s, which may lose energy where the rope goes taut.";
  for (const double density : decades(-4, 4, quick ? 1 : 2)) {
    Scene fall = build::rope_atwood(4);
    fall.cables[0].mass_per_metre = density;
    item.cases.push_back(case_of("Atwood's machine", density, std::move(fall), 0.6,
                                 EnergyLaw::keeps, (2.5 + 4.0 * density) * g * 0.1));
    if (density > 100.0) continue;  // slack, it would hang: sim/README.md, Limits
    Scene tackle = build::heavy_tackle(4);
    tackle.cables[0].mass_per_metre = density;
    item.cases.push_back(case_of("tackle", density, std::move(tackle), 2.0, EnergyLaw::falls,
                                 (1.7 + 3.0 * density) * g * 0.1));
  }
  return item;
}

Item folding(bool quick) {
  Item item;
  item.id = "folding";
  item.title = "A chain that folds";
  item.x_name = "pieces";
  item.why =
      "The pieces at the fold turn round within a few steps, the faster the shorter they are. Ours "
      "divides such steps, and holds pieces both ways.";
  item.scene =
      "A chain of 1 m and 1 kg hangs by both ends, side by side; one is let go. 0.6 s, 16 steps a "
      "frame, 64 for 100 pieces; it may not gain energy.";
  for (const int pieces : {5, 10, 20, 50, 100}) {
    if (quick && pieces > 20) break;
    item.cases.push_back(case_of("folded chain", pieces,
                                 build::folded_chain(pieces, pieces > 50 ? 64 : 16), 0.6,
                                 EnergyLaw::falls, 0.5 * g));
  }
  return item;
}

Item refinement(bool quick) {
  Item item;
  item.id = "refinement";
  item.title = "Nodes that come and go";
  item.x_name = "tolerance in m";
  item.why =
      "Ours lets two pieces become one, and one two, at limits a factor of two apart, keeps mass, "
      "centre and momentum, and never makes energy by it. The others keep all nodes.";
  item.scene =
      "A cable of 2 m and 1 kg/m hangs between supports 1 m apart, and is blown at, at 1.5 m/s, 2 "
      "s "
      "at 32 steps a frame; a chain of 1 m and 1 kg hangs by both ends, side by side, and one is "
      "let go, 0.6 s at 64. The number of nodes adapts, 31 and 63 at most; energy may not rise.";
  for (const double tolerance : decades(-4, -2, quick ? 1 : 4)) {
    Scene blown = build::catenary(32, 32);
    blown.cables[0].node_tolerance = tolerance;
    spread_nodes(blown);
    for (Body& body : blown.bodies) body.velocity = Vec2(1.5, 0.0);
    item.cases.push_back(case_of("blown cable", tolerance, std::move(blown), quick ? 0.5 : 2.0,
                                 EnergyLaw::falls, 2.25));
    item.cases.push_back(case_of("folded chain", tolerance, build::folded_chain(64, 64, tolerance),
                                 0.6, EnergyLaw::falls, 0.5 * g));
  }
  return item;
}

}  // namespace pinchlab::experiments::stability
