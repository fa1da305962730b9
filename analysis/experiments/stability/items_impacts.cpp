// SPDX-License-Identifier: GPL-3.0-or-later
// Impacts of several bodies and cables at once, at steps from long to short.

#include "analysis/experiments/stability/items.h"
#include "analysis/experiments/stability/scenes.h"

namespace pinchlab::experiments::stability {

namespace {

void add_ladder(Item& item, bool quick, const std::string& series, const Scene& scene,
                EnergyLaw law, double height) {
  for (int steps = 1; steps <= 256; steps *= quick ? 16 : 2) {
    Case test;
    test.series = series;
    test.x = steps;
    test.scene = scene;
    test.scene.steps_per_frame = steps;
    test.seconds = 2.0;
    test.energy = law;
    test.energy_at_play_j = energy_at_play(scene, height);
    item.cases.push_back(test);
  }
}

}  // namespace

Item impacts(bool quick) {
  Item item;
  item.id = "impacts";
  item.title = "Impacts of several at once";
  item.x_name = "steps a frame";
  item.why =
      "Ours finds when bodies meet and cables are caught, and takes the velocities of that time: "
      "blow after blow what rebounds, in one solve what does not, so that no impact makes energy "
      "however long the step. Methods that repair in one step what another has let overlap turn "
      "the repair into speed, the more of it the shorter the step.";
  item.scene =
      "Two discs side by side fall on one free span, of 1 and 1 kg or of 1 and 20 kg, taut between "
      "weights or slack between anchors; a load falls into three cables of unequal slack; a ball "
      "drops on a span; Newton's cradle of five (restitution 1, whose energy must stay) is drawn "
      "aside by 0.5 rad. Two seconds at 60 frames.";
  add_ladder(item, quick, "equal discs on a taut span", two_on_span(1.0, false), EnergyLaw::falls,
             1.0);
  add_ladder(item, quick, "unequal discs on a taut span", two_on_span(20.0, false),
             EnergyLaw::falls, 1.0);
  add_ladder(item, quick, "equal discs on a slack span", two_on_span(1.0, true), EnergyLaw::falls,
             1.0);
  add_ladder(item, quick, "unequal discs on a slack span", two_on_span(20.0, true),
             EnergyLaw::falls, 1.0);
  add_ladder(item, quick, "load into three cables", load_into_cables(), EnergyLaw::falls, 1.0);
  add_ladder(item, quick, "ball on a span", trampoline(0.5), EnergyLaw::falls, 0.75);
  add_ladder(item, quick, "Newton's cradle", newtons_cradle(), EnergyLaw::keeps, 0.13);
  return item;
}

}  // namespace pinchlab::experiments::stability
