// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// START HERE: how far each method holds, and how it fails beyond.

#include "analysis/experiments/experiment.h"
#include "analysis/experiments/stability/items.h"

namespace pinchlab::experiments {

/// `pinchlab bench stability`: runs all items under all methods and writes a table and a figure an
/// item (stability-ID.*), and the page stability.md.
void run_stability(const Options& options);

namespace stability {

/// What came of an item: results by method, then in the order of its cases.
struct ItemResults {
  Item item;
  std::vector<Result> results;
};

/// Runs an item's cases under its methods. `progress` is told of each case's cost().
ItemResults run_item(const Item& item, Progress& progress);

/// What a case costs, in steps times cables and bodies.
double cost(const Case& test);

/// All of an item's results (stability-ID.csv).
Csv results_table(const ItemResults& item);

/// For a map: the worst of all series at each x and y (stability-ID-map.csv).
Csv map_table(const ItemResults& item);

/// gnuplot commands that draw an item from its tables, and the picture's size in pixels.
struct Drawing {
  int width_px = 0, height_px = 0;
  std::string commands;
};
/// Throws std::logic_error where a panel of curves would be empty.
Drawing draw(const ItemResults& item);

/// The speeds of a stack under each method of an item, against time (stability-ID-speeds.csv).
Csv speeds_table(const Item& item);

/// stability.md.
std::string page_text(const std::vector<ItemResults>& items);

}  // namespace stability
}  // namespace pinchlab::experiments
