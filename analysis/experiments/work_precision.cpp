// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/work_precision.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "analysis/experiments/experiment.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

void record(const Problem& problem, const World& world, std::vector<Place>& places) {
  for (std::size_t i = 0; i < problem.watched.size(); ++i) {
    const std::size_t b = problem.watched[i];
    places[i] = {world.position[b], world.angle[b] * problem.scene.bodies[b].radius};
  }
}

/// Motion under the pinch method, solved directly.
Motion own_motion(const Problem& problem, int steps_per_frame) {
  Recording recording = simulate(problem, Method::pinch, steps_per_frame);
  if (!recording.finite) {
    throw std::runtime_error(problem.name + ": its own solution at " +
                             std::to_string(steps_per_frame) + " steps a frame is not finite");
  }
  return std::move(recording.motion);
}

double apart(const Place& a, const Place& b, bool rims) {
  const double centres = (a.centre - b.centre).norm();
  return rims ? std::max(centres, std::abs(a.rim - b.rim)) : centres;
}

}  // namespace

Recording simulate(const Problem& problem, Configuration configuration, int steps_per_frame) {
  configuration.sleep = false;
  configuration.diagnostics = false;
  Scene scene = problem.scene;
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, configuration);
  Workspace work;
  Recording recording;
  recording.motion.assign(static_cast<std::size_t>(problem.frames) + 1,
                          std::vector<Place>(problem.watched.size()));
  record(problem, world, recording.motion[0]);
  const double start = cpu_seconds();
  for (std::size_t frame = 1; frame < recording.motion.size(); ++frame) {
    for (int i = 0; i < steps_per_frame; ++i) {
      if (step(scene, world, work) != StepStatus::ok) recording.finite = false;
      if (!recording.finite) return recording;
      if (problem.on_steps && (i % 64 == 63 || i + 1 == steps_per_frame)) problem.on_steps(world);
    }
    record(problem, world, recording.motion[frame]);
  }
  recording.cpu_s = cpu_seconds() - start;
  return recording;
}

Distance distance(const Motion& a, const Motion& b, bool rims) {
  if (a.size() != b.size()) throw std::logic_error("distance: motions of unequal length");
  Distance distance;
  double squares = 0.0;
  for (std::size_t frame = 0; frame < a.size(); ++frame) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a[frame].size(); ++i) {
      largest = std::max(largest, apart(a[frame][i], b[frame][i], rims));
    }
    distance.largest_m = std::max(distance.largest_m, largest);
    squares += largest * largest;
  }
  distance.rms_m = std::sqrt(squares / static_cast<double>(a.size()));
  return distance;
}

double reach(const Motion& motion, bool rims) {
  return distance(motion, Motion(motion.size(), motion.front()), rims).largest_m;
}

Trial judge(const Problem& problem, const Recording& recording) {
  Trial trial;
  if (!recording.finite) return trial;
  const Distance off = distance(recording.motion, problem.exact, problem.rims);
  trial.finite = std::isfinite(off.largest_m);
  trial.error = off.largest_m / problem.length_m;
  trial.rms_error = off.rms_m / problem.length_m;
  const auto last = recording.motion.end() - 1;
  for (std::size_t i = 0; i < problem.watched.size(); ++i) {
    trial.speed_m_s = std::max(trial.speed_m_s, apart((*last)[i], (*(last - 1))[i], problem.rims) *
                                                    problem.scene.frames_per_second);
  }
  trial.cpu_s_per_s = recording.cpu_s / problem.seconds();
  return trial;
}

Trial measure(const Problem& problem, const std::function<Recording()>& run, const Limits& limits) {
  constexpr std::size_t fewest = 3, most = 200;
  const Recording first = run();
  Trial trial = judge(problem, first);
  if (!trial.finite || first.cpu_s > limits.repeat_cpu_s) return trial;
  std::vector<double> times{first.cpu_s};
  double used = first.cpu_s;
  while (times.size() < most && (times.size() < fewest || used < limits.repeat_cpu_s)) {
    times.push_back(run().cpu_s);
    used += times.back();
  }
  trial.cpu_s_per_s = spread(times).median / problem.seconds();
  return trial;
}

std::vector<Rung> climb(const Problem& problem, const std::string& setting,
                        const std::function<Recording(int)>& run, int most_steps,
                        const Limits& limits) {
  std::vector<Rung> rungs;
  for (int steps = 1; steps <= most_steps; steps *= 2) {
    const Trial trial = measure(
        problem, [&] { return run(steps); }, limits);
    rungs.push_back({setting, steps, trial});
    if (trial.cpu_s_per_s > limits.ladder_cpu_s_per_s) break;
  }
  return rungs;
}

bool meets(const Problem& problem, const Trial& trial, double error) {
  return trial.finite && trial.error + problem.doubt_m / problem.length_m <= error;
}

int cheapest(const Problem& problem, const std::vector<Rung>& rungs, double error, bool lasting) {
  constexpr double tie = 1.15;
  std::vector<std::size_t> good;  // from the last to the first
  for (std::size_t i = rungs.size(); i-- > 0;) {
    const bool finer = i + 1 < rungs.size() && rungs[i + 1].setting == rungs[i].setting;
    if (!meets(problem, rungs[i].trial, error)) continue;
    if (lasting && finer) {
      if (good.empty() || good.back() != i + 1) continue;
      good.back() = i;
    } else {
      good.push_back(i);
    }
  }
  double least = infinity;
  for (const std::size_t i : good) least = std::min(least, rungs[i].trial.cpu_s_per_s);
  std::reverse(good.begin(), good.end());
  for (const std::size_t i : good) {
    if (rungs[i].trial.cpu_s_per_s <= tie * least) return static_cast<int>(i);
  }
  return -1;
}

std::vector<Rung> front(const std::vector<Rung>& rungs) {
  std::vector<Rung> sorted;
  for (const Rung& rung : rungs) {
    if (rung.trial.finite) sorted.push_back(rung);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](const Rung& a, const Rung& b) {
    return a.trial.cpu_s_per_s < b.trial.cpu_s_per_s;
  });
  std::vector<Rung> best;
  for (const Rung& rung : sorted) {
    if (best.empty() || rung.trial.error < best.back().trial.error) best.push_back(rung);
  }
  return best;
}

std::vector<Contender> contenders() {
  std::vector<Contender> all;
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    for (const Solver solver : {Solver::direct, Solver::iterative}) {
      Configuration configuration = method;
      configuration.solver = solver;
      all.push_back({std::string(to_string(method)) + ' ' + to_string(solver), configuration});
    }
  }
  all.push_back({"thesis", thesis_configuration()});
  return all;
}

void solve_finely(Problem& problem, int steps_per_frame) {
  problem.exact = own_motion(problem, steps_per_frame / 2);
  refine(problem, steps_per_frame);
}

void refine(Problem& problem, int steps_per_frame) {
  constexpr double doubt_over_change = 2.5;
  Motion finer = own_motion(problem, steps_per_frame);
  problem.doubt_m = doubt_over_change * distance(problem.exact, finer, problem.rims).largest_m;
  problem.exact = std::move(finer);
}

double observed_order(const std::vector<Rung>& rungs, double floor) {
  std::vector<double> steps, errors;
  for (const Rung& rung : rungs) {
    if (!rung.trial.finite || !(rung.trial.error > floor)) continue;
    steps.push_back(rung.steps_per_frame);
    errors.push_back(rung.trial.error);
  }
  return steps.size() < 3 ? std::nan("") : -growth_exponent(steps, errors);
}

}  // namespace pinchlab::experiments
