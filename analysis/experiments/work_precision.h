// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Error against processor time: what a run of a scene costs, and how far it ends up from the motion
// that the scene should have.

#include <functional>
#include <string>
#include <vector>

#include "sim/scene.h"
#include "sim/world.h"

namespace pinchlab::experiments {

/// Where a body is at one moment.
struct Place {
  Vec2 centre = Vec2::Zero();  ///< m
  double rim = 0.0;            ///< m, angle times radius: how far a point of the rim has turned
};

/// Places of the bodies that are watched, one array a frame; frame 0 is the start.
using Motion = std::vector<std::vector<Place>>;

/// A scene, and the motion that it should have.
struct Problem {
  std::string name;   ///< of files and in tables: "swinging-load"
  std::string title;  ///< for people: "Swinging load over two pulleys"
  Scene scene;
  int frames = 60;                   ///< that are compared, at the scene's frames a second
  std::vector<std::size_t> watched;  ///< bodies that are compared
  bool rims = false;                 ///< whether what rims have turned is compared too
  Motion exact;                      ///< frames + 1 of the watched bodies
  double doubt_m = 0.0;              ///< how far off `exact` itself may be
  double length_m = 1.0;             ///< errors are relative to this
  std::string length;                ///< what that length is
  std::string reference;             ///< where `exact` comes from
  /// If there is one, called as a run goes on: at the end of each frame, and of each 64th step, so
  /// seldom that it costs nothing that clocks could tell. What it throws ends the run.
  std::function<void(const World&)> on_steps;

  double seconds() const { return static_cast<double>(frames) / scene.frames_per_second; }
};

/// One run.
struct Recording {
  Motion motion;
  double cpu_s = 0.0;  ///< of the steps alone
  bool finite = true;
};

/// Simulates the problem's frames without sleep and diagnostics.
Recording simulate(const Problem& problem, Configuration configuration, int steps_per_frame);

/// Distances between two motions of the same bodies, m: of a body's centre, or of what its rim has
/// turned if `rims`.
struct Distance {
  double largest_m = 0.0;  ///< over all bodies and frames
  double rms_m = 0.0;  ///< root of the mean over frames of the square of the largest over bodies
};
Distance distance(const Motion& a, const Motion& b, bool rims);

/// The farthest that a watched centre (or rim) gets from its start, m.
double reach(const Motion& motion, bool rims);

/// How a run did. Errors are relative to the problem's length.
struct Trial {
  bool finite = false;       ///< what follows means nothing otherwise
  double error = 0.0;        ///< largest over bodies and frames
  double rms_error = 0.0;    ///< root mean square over frames
  double speed_m_s = 0.0;    ///< largest over bodies in the last frame
  double cpu_s_per_s = 0.0;  ///< processor time a simulated second, median over repeats
};
Trial judge(const Problem& problem, const Recording& recording);

/// How far to go.
struct Limits {
  double repeat_cpu_s = 0.05;     ///< a run is repeated until it has taken so long: three times at
                                  ///< least, not at all if once takes longer
  double ladder_cpu_s_per_s = 1;  ///< finer steps are left out once a simulated second costs this
};

/// Error, and the median of the times of repeated runs.
Trial measure(const Problem& problem, const std::function<Recording()>& run, const Limits& limits);

/// A trial of one setting at one number of steps a frame.
struct Rung {
  std::string setting;  ///< "pinch direct"
  int steps_per_frame = 1;
  Trial trial;
};

/// Trials at 1, 2, 4, ... `most_steps` steps a frame.
std::vector<Rung> climb(const Problem& problem, const std::string& setting,
                        const std::function<Recording(int steps_per_frame)>& run, int most_steps,
                        const Limits& limits);

/// Whether a trial is within `error` (relative) even if the reference is as far off as it may be.
bool meets(const Problem& problem, const Trial& trial, double error);

/// The cheapest rung that meets `error`, or -1. `lasting`: of each setting only the fewest steps
/// that meet it as all finer ones do, so that none wins by luck, nor more steps than are needed
/// because a clock was disturbed. Times within 15 % of the least are a tie, which the first wins.
int cheapest(const Problem& problem, const std::vector<Rung>& rungs, double error, bool lasting);

/// The rungs that no other beats both in error and in time, by rising time.
std::vector<Rung> front(const std::vector<Rung>& rungs);

/// A configuration that is compared, by name.
struct Contender {
  std::string name;  ///< "pinch direct"
  Configuration configuration;
};
/// Every method with every solver, then the thesis' configuration as a whole.
std::vector<Contender> contenders();

/// The scene's own solution: the pinch method, solved directly, at `steps_per_frame`. Fills
/// `exact`, and `doubt_m` with 2.5 times its distance from the solution at half as many steps. That
/// bounds its error where halving the step divides the error by the root of 2 or more: the errors
/// left then add up to at most 1 / (sqrt(2) - 1) = 2.42 times that distance. Throws
/// std::runtime_error where a solution is not finite.
void solve_finely(Problem& problem, int steps_per_frame);

/// The same where `exact` holds the solution at half as many steps already.
void refine(Problem& problem, int steps_per_frame);

/// Order of convergence: minus the slope of log error over log steps a frame, by least squares over
/// the rungs of one setting whose errors lie above `floor`; NaN where those are fewer than three.
double observed_order(const std::vector<Rung>& rungs, double floor);

}  // namespace pinchlab::experiments
