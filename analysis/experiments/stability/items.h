// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is tested: one item a way in which cables may fail.

#include <string>
#include <vector>

#include "analysis/experiments/stability/watch.h"

namespace pinchlab::experiments::stability {

/// An item: scenes along one parameter (or two), and what the page says of them.
struct Item {
  std::string id;      ///< of its files and its section
  std::string title;   ///< of its section
  std::string x_name;  ///< axis, with unit
  std::string y_name;  ///< of a map; empty: curves. A map's border is in x times y
  std::string border;  ///< what the border is given in
  bool log_x = true;
  bool shows_speeds = false;  ///< one more panel: a stack of four against time
  std::string scene;          ///< what is simulated and asked, in a few sentences
  std::string why;            ///< why methods fail where they do
  std::vector<std::string> methods{"pinch", "thesis", "cable"};
  std::vector<Case> cases;
};

/// All items in the order of the page. `quick` takes fewer and shorter cases.
std::vector<Item> stability_items(bool quick);

// The items by what they try (items_*.cpp).
Item mass_ratio(bool quick);
Item pulleys(bool quick);
Item caught_loads(bool quick);
Item jerks(bool quick);
Item friction(bool quick);
Item windings(bool quick);
Item stacks(bool quick);
Item cables_under_a_pinch(bool quick);
Item closed_loop(bool quick);
Item thin_cables(bool quick);
Item plain_joints_under_pinch(bool quick);
Item chatter(bool quick);
Item fast_bodies(bool quick);
Item frames_and_steps(bool quick);
Item long_swing(bool quick);
Item impacts(bool quick);
Item corners(bool quick);
Item heavy_ropes(bool quick);
Item folding(bool quick);
Item refinement(bool quick);

/// 10^from, 10^(from + 1/per_decade) .. 10^to.
std::vector<double> decades(double from, double to, int per_decade);

/// Height times weight of all that moves, and its energy of motion at the start, J.
double energy_at_play(const Scene& scene, double height_m);

}  // namespace pinchlab::experiments::stability
