// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How fine steps must be for the error that a scene asks for (Scene::error), measured: the motion
// against the one with steps half as long.
//
// Where steps of length h err by c h^p, halves of them err by c h^p / 2^p, and the two are
//     d = c h^p (1 - 2^-p)
// apart: the error of h is d 2^p / (2^p - 1), which is at most 2 d for any order p >= 1 (4/3 d for
// smooth motion, p = 2). Unlike an estimate within a step, this sees all that makes a motion err,
// and what grows from it later.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "demos/scenes/player.h"

namespace pinchlab {

struct Fineness {
  int factor = 1;                  ///< a frame has so many times the scene's steps
  int steps_per_frame = 0;         ///< then
  double asked = 0.0;              ///< m
  std::optional<double> believed;  ///< m, the furthest that a point of a body is, at a frame, from
                                   ///< where it would be with steps of no length; nothing: the
                                   ///< scene does not ask, or the method's steps are not divided
};

/// The scene with `factor` times as many steps, divided for an error that goes with that: an
/// interval's is of third order in its length.
Scene made_finer(const Scene& scene, int factor);

/// Doubles the steps, up to 8 times as many, until what the scene asks for is believed of all
/// frames up to `last`. `measured` is called after each frame, which begin anew with each number of
/// steps. Throws as Player does, and where one simulation takes longer than `time_limit` (s).
Fineness find_fineness(const SceneFile& file, const Scene& scene,
                       const Configuration& configuration, int last,
                       std::optional<double> time_limit,
                       const std::function<void(int steps_per_frame, int frame)>& measured = {});

/// The same, and tells on standard error how far it is with `who`, such as "drop, pinch".
Fineness find_fineness_aloud(const SceneFile& file, const Scene& scene,
                             const Configuration& configuration, int last,
                             std::optional<double> time_limit, const std::string& who);

/// Writes what is believed of a simulation to standard error; nothing where nothing was asked.
void tell_fineness(const std::string& file, const Fineness& fineness);

/// What is to be told beside Player::broken_promises where the error was not reached.
void add_missed_error(const Fineness& fineness, const Configuration& configuration,
                      std::vector<std::string>& broken_promises);

}  // namespace pinchlab
