// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// `pinchlab advise`: the cheapest way to simulate a scene to a wanted error.

#include <CLI/App.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "analysis/experiments/work_precision.h"
#include "demos/scenes/timing.h"

namespace pinchlab::experiments {

/// What was asked.
struct Question {
  std::filesystem::path scene;
  double error_m = 1e-3;             ///< > 0
  std::optional<double> seconds;     ///< from a frame to the whole clip, which none stands for
  bool all = false;                  ///< show every rung, not one a configuration
  int most_steps = 256;              ///< a frame, that are tried
  int most_reference_steps = 4096;   ///< a frame, of the scene's own solution
  std::optional<double> time_limit;  ///< s of all of it, after which it is given up
};

/// What was found.
struct Advice {
  Problem problem;          ///< with the scene's own solution; its length is 1 m
  int reference_steps = 0;  ///< a frame
  std::vector<Rung> rungs;  ///< empty where the reference cannot vouch for the wanted error
  int best = -1;            ///< best_to_type
  std::vector<std::string> refused;  ///< configurations that cannot do the scene
  std::vector<ChosenNodes> nodes;    ///< by the scene's own steps, and the same at all steps
};

/// The rung that is cheapest within the error at its steps and all finer ones, of the settings that
/// `simulate` has a name for; -1: none.
int best_to_type(const Question& question, const Advice& advice);

/// Refines the scene's own solution until it is eight times as sure as the wanted error, or as
/// fine as allowed, then tries all configurations; tells on standard error how far it is. Throws
/// SceneFileError, GivenUp, std::invalid_argument for a time that the scene does not have, or
/// std::runtime_error where the scene's own solution is not finite.
Advice advise(const Question& question);

/// The advice in words, with the table of what was tried.
std::string advice_text(const Question& question, const Advice& advice);

/// Adds `advise`.
void add_advise_command(CLI::App& app);

}  // namespace pinchlab::experiments
