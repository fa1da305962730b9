// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies that press cables: how many, how often wound, how thick.

#include <cmath>

#include "analysis/experiments/stability/items.h"
#include "analysis/experiments/stability/scenes.h"

namespace pinchlab::experiments::stability {

namespace {

/// A scene in which everything falls and comes to rest.
Case comes_to_rest(const std::string& series, double x, Scene scene, double seconds) {
  Case test;
  test.series = series;
  test.x = x;
  test.scene = std::move(scene);
  test.seconds = seconds;
  test.energy = EnergyLaw::falls;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  test.rests = true;
  return test;
}

Case loop_case(int wheels, bool roller, double seconds) {
  Case test;
  test.series = roller ? "with a roller on it" : "wheels alone";
  test.x = wheels;
  test.scene = driven_loop(wheels, roller);
  test.seconds = seconds;
  // All rims run at one speed; a wheel starts at rest, so that the driver jerks it along.
  test.error = [](const Scene& scene, const World& world) {
    const double w = scene.cables[0].half_width;
    const double rim = 5.0 * (scene.bodies[0].radius + w);
    double worst = 0.0;
    for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
      const double speed = std::abs(world.angular_velocity[b]) * (scene.bodies[b].radius + w);
      worst = std::max(worst, std::abs(speed / rim - 1.0));
    }
    return worst;
  };
  return test;
}

}  // namespace

Item windings(bool quick) {
  Item item;
  item.id = "windings";
  item.title = "A wound body that is pinched";
  item.x_name = "whole turns round the drum";
  item.log_x = false;
  item.why =
      "All turns share one contact and one force, so that more of them change nothing; plain cable "
      "joints do not see the roller, which sinks through the cable on to the drum.";
  item.scene =
      "A roller of 1 kg falls 50 mm on a drum that a cable is wound on: it must come to rest on "
      "the "
      "cable. With ten turns it makes ten pinches at once (left untested by the thesis, 6.2).";
  for (const int turns : {0, 1, 2, 3, 5, 7, 10, 15, 20, 30, 50}) {
    if (quick && turns > 10) continue;
    item.cases.push_back(comes_to_rest("fixed anchors", turns, roller_on_drum(turns), 3.0));
  }
  return item;
}

Item stacks(bool quick) {
  Item item;
  item.id = "stack";
  item.title = "Stacks";
  item.x_name = "rollers on top of one another";
  item.log_x = false;
  item.why =
      "Contacts and cables are solved together and exactly; sweeps leave each contact a part of "
      "the weight above it, the more the higher the stack, and plain cable joints have no tangent "
      "where bodies pinch the cable.";
  item.scene =
      "Rollers of 1 kg fall on one another and on a drum, with a cable in a zig-zag between them "
      "and 1 kg at its end: all must come to rest. At four steps a frame and at one.";
  for (const int steps : {4, 1}) {
    for (const int count : {1, 2, 3, 4, 5, 6, 8, 10, 12, 15, 20}) {
      if (quick && (count > 10 || steps == 4)) continue;
      Case test = comes_to_rest(steps == 1 ? "1 step a frame" : "4 steps a frame", count,
                                zigzag_stack(count), 10.0);
      test.scene.steps_per_frame = steps;
      item.cases.push_back(test);
    }
  }
  return item;
}

Item cables_under_a_pinch(bool quick) {
  Item item;
  item.id = "cables";
  item.title = "Several cables under one pinch";
  item.x_name = "cables under the roller";
  item.log_x = false;
  item.why =
      "One contact a pair of bodies holds them apart, however many cables lie between; plain cable "
      "joints have none there.";
  item.scene =
      "A roller of 1 kg falls on a drum with several cables over it: it must come to rest on them.";
  for (const int count : {1, 2, 5, 10, 20, 50}) {
    if (quick && count > 10) continue;
    item.cases.push_back(comes_to_rest("side by side", count, roller_on_drum(0, count), 3.0));
  }
  return item;
}

Item closed_loop(bool quick) {
  Item item;
  item.id = "loop";
  item.title = "Closed loops";
  item.x_name = "wheels in the loop";
  item.why = "The loop's rows are solved as one ring; sweeps let the jerk of the start stretch it.";
  item.scene =
      "A closed cable without slip runs round a ring of wheels, each second one smaller; one is "
      "driven at 5 rad/s, the others start at rest. All rims must run at the cable's speed, and "
      "so must a roller of 1 kg that pinches the cable on the driven wheel.";
  for (const bool roller : {false, true}) {
    for (const int wheels : {2, 3, 4, 8, 16, 32, 64, 128, 256}) {
      if (quick && wheels > 32) continue;
      item.cases.push_back(loop_case(wheels, roller, quick ? 2.0 : 5.0));
    }
  }
  return item;
}

Item thin_cables(bool quick) {
  Item item;
  item.id = "thin";
  item.title = "Thin and thick cables";
  item.x_name = "half width over the rollers' radius";
  item.why =
      "The contact's distance is a number like any other to the direct solve; sweeps leave an "
      "overlap that the height of the stack sets, not the cable, and that is many times a thin "
      "cable's width.";
  item.scene =
      "A roller on a wrapped drum, and a stack of four in a zig-zag, both with r = 0.25 m, for "
      "cables of all widths: squeeze is measured by the cable's width.";
  for (const double ratio : decades(-4, 0, quick ? 1 : 2)) {
    item.cases.push_back(
        comes_to_rest("roller on a drum", ratio, roller_on_drum(0, 1, 0.25 * ratio), 3.0));
  }
  for (const double ratio : decades(-4, 0, quick ? 1 : 2)) {
    item.cases.push_back(
        comes_to_rest("stack of four", ratio, zigzag_stack(4, 0.25 * ratio), 10.0));
  }
  return item;
}

Item plain_joints_under_pinch(bool quick) {
  Item item;
  item.id = "jitter";
  item.title = "Plain cable joints under pinching";
  item.x_name = "rollers on top of one another";
  item.log_x = false;
  item.why =
      "Where the tangent has vanished, plain cable joints act along the centre line: they push the "
      "bodies apart but leave their rolling alone, and the stack tumbles until it has lost its "
      "energy. Without contact rows it is calm, but squeezed flat.";
  item.scene =
      "The stack again, under plain cable joints and under pinch joints without contact rows, "
      "which the thesis had to show in their place.";
  item.methods = {"pinch", "thesis", "pinch_no_contact", "cable"};
  item.shows_speeds = true;
  for (const int count : {1, 2, 3, 4, 5, 6, 8, 10}) {
    if (quick && count > 4) continue;
    item.cases.push_back(comes_to_rest("zig-zag", count, zigzag_stack(count), 10.0));
  }
  return item;
}

}  // namespace pinchlab::experiments::stability
