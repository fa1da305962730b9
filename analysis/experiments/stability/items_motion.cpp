// SPDX-License-Identifier: GPL-3.0-or-later
// Links that come and go, fast bodies, long steps and long runs.

#include <cmath>

#include "analysis/experiments/stability/items.h"
#include "analysis/experiments/stability/scenes.h"

namespace pinchlab::experiments::stability {

namespace {

Case swings(const std::string& series, double x, Scene scene, double seconds, double height) {
  Case test;
  test.series = series;
  test.x = x;
  test.scene = std::move(scene);
  test.seconds = seconds;
  test.energy = EnergyLaw::keeps;
  test.energy_at_play_j = energy_at_play(test.scene, height);
  return test;
}

/// Whether the ball is below the cable that it flew at from above.
bool below_cable(const Scene&, const World& world) {
  const CableState& cable = world.cables[0];
  for (const Link& link : cable.links) {
    if (link.body == 0) return link.orientation != 1;
  }
  return std::abs(world.position[0].x()) < 1.0 && world.position[0].y() < 0.0;
}

Case flying(double sizes, double slack) {
  Case test;
  test.series = slack > 0.0 ? "slack span" : "taut span";
  test.x = sizes;
  const double speed = sizes * 0.2 * 240.0;  // m/s, at 240 steps a second
  test.scene = ball_at_span(speed, slack);
  test.seconds = 2.0;
  test.energy = EnergyLaw::falls;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  test.passed_through = below_cable;
  return test;
}

}  // namespace

Item chatter(bool quick) {
  Item item;
  item.id = "chatter";
  item.title = "Links added and removed thousands of times";
  item.x_name = "swing (rad) or fall (m)";
  item.why =
      "Ours makes and removes a link when the cable touches and leaves the body; where that "
      "happens "
      "at the step's end, it takes a second-order share of the energy each time.";
  item.scene =
      "A bob on a cable of 50 mm swings against a peg that the cable touches when it hangs, so "
      "that a link comes and goes with every swing; its energy must stay (from 0.6 rad on it rises "
      "until its cable is slack). A ball bounces on a "
      "cable between two pulleys with weights; it may lose energy but not gain any, and may not "
      "fall through. 16 steps a frame, ten minutes.";
  const double seconds = quick ? 20.0 : 600.0;
  for (const double amplitude : decades(-5, quick ? -1 : -0.5, quick ? 1 : 2)) {
    Case test = swings("bob at a peg", amplitude, bob_at_peg(amplitude), seconds,
                       0.05 * (1.0 - std::cos(amplitude)));
    test.scene.steps_per_frame = 16;
    item.cases.push_back(test);
  }
  for (const double height : decades(-3, 0, quick ? 1 : 2)) {
    Case test = swings("trampoline", height, trampoline(height), seconds, height);
    test.scene.steps_per_frame = 16;
    test.energy = EnergyLaw::falls;
    // The ball's weight spreads the cable by 0.25 m, so that it falls at least this much further.
    test.energy_at_play_j = g * (height + 0.25);
    test.passed_through = below_cable;
    item.cases.push_back(test);
  }
  return item;
}

Item fast_bodies(bool quick) {
  Item item;
  item.id = "fast";
  item.title = "Fast bodies against spans";
  item.x_name = "body sizes a step";
  item.why =
      "Ours divides the step where a body meets a span. Where the hit is found after the step, the "
      "cable is stretched for one step by as much as the body has gone too far.";
  item.scene =
      "A ball of 0.2 m flies at a cable of 4 m held at both ends, taut or with 0.2 m of slack; it "
      "may not pass, nor leave with more energy than it came with.";
  for (const double slack : {0.0, 0.2}) {
    for (const double sizes : decades(-2, 3, quick ? 1 : 4)) {
      item.cases.push_back(flying(sizes, slack));
    }
  }
  return item;
}

Item frames_and_steps(bool quick) {
  Item item;
  item.id = "steps";
  item.title = "Frames and steps";
  item.x_name = "frames a second";
  item.y_name = "steps a frame";
  item.border = "steps a second";
  item.why =
      "On a curved path the step's chord leaves the circle by (v h)^2/(2 L), which is the "
      "pendulum's stretch; a pinch that opens by a gap d frees a span of the order of sqrt(d), "
      "which no linear row foresees, and which is the roll-over's. Ours corrects both within the "
      "step; elsewhere they are gone at the next one and vanish with h.";
  item.scene =
      "Five scenes: a stack of five, a roller that falls on a drum, a roller that rolls over one, "
      "a load caught after 2 m, a load that swings and unwinds. The map shows the worst of them.";
  const auto add = [&](const std::string& series, const Scene& scene, double seconds,
                       EnergyLaw energy, bool rests) {
    for (const int rate : {15, 20, 24, 30, 60, 120}) {
      for (const int steps : {1, 2, 4, 8, 16}) {
        if (quick && (rate % 30 != 15 && rate != 60)) continue;
        Case test;
        test.series = series;
        test.x = rate;
        test.y = steps;
        test.scene = scene;
        test.scene.frames_per_second = rate;
        test.scene.steps_per_frame = steps;
        test.seconds = seconds;
        test.energy = energy;
        test.energy_at_play_j = energy_at_play(scene, 2.0);
        test.rests = rests;
        item.cases.push_back(test);
      }
    }
  };
  add("stack of five", zigzag_stack(5), 10.0, EnergyLaw::falls, true);
  add("roller on a drum", roller_on_drum(0), 2.0, EnergyLaw::falls, true);
  add("roll-over", roll_over(), 2.0, EnergyLaw::falls, false);
  add("caught load", caught_load(2.0), 2.0, EnergyLaw::falls, true);
  add("unwinding pendulum", unwinding_pendulum(), 10.0, EnergyLaw::keeps, false);
  return item;
}

Item long_swing(bool quick) {
  Item item;
  item.id = "long";
  item.title = "A million steps";
  item.x_name = "steps";
  item.why =
      "The leapfrog is symplectic as long as its constraints are met exactly: its energy swings "
      "about a constant; sweeps leave some of the constraint's speed in, and damp.";
  item.scene =
      "A load swings on a cable that winds and unwinds on a drum, without mass and on one of 0.2 "
      "kg "
      "a metre, and a roller runs to and fro in the bight of a cable: after up to a million steps "
      "their energy must be the same.";
  for (const double steps : decades(3, quick ? 5 : 6, 1)) {
    item.cases.push_back(
        swings("unwinding pendulum", steps, unwinding_pendulum(), steps / 240.0, 1.0));
    Scene heavy = unwinding_pendulum();
    heavy.cables[0].mass_per_metre = 0.2;
    item.cases.push_back(
        swings("unwinding a heavy rope from a drum", steps, std::move(heavy), steps / 240.0, 1.0));
    item.cases.push_back(swings("roller in a bight", steps, roller_in_bight(), steps / 240.0, 1.0));
  }
  return item;
}

}  // namespace pinchlab::experiments::stability
