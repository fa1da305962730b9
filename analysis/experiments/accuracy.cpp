// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/accuracy.h"

#include <algorithm>

#include "analysis/experiments/accuracy_scenes.h"
#include "analysis/experiments/event_scenes.h"
#include "demos/command_line.h"
#include "demos/scenes/find_scenes.h"
#include "demos/scenes/scene_json.h"

namespace pinchlab::experiments {

namespace {

/// How far the experiment goes.
struct Extent {
  int most_steps = 256;        ///< a frame
  int reference_steps = 4096;  ///< a frame, of a demonstration's own solution
  double demonstration_s = infinity;
  Limits ours{0.05, 1.0};
  Limits peers{0.05, 0.6};
};

Extent extent(bool quick) {
  return quick ? Extent{64, 512, 2.0, {0.005, 0.1}, {0.005, 0.03}} : Extent();
}

ProblemResult result_of(Problem problem, bool demonstration = false) {
  ProblemResult result;
  result.problem = std::move(problem);
  result.demonstration = demonstration;
  return result;
}

std::vector<ProblemResult> problems(const Extent& extent) {
  std::vector<ProblemResult> results = scenes_of_known_motion();
  for (Problem& problem : finely_solved_problems(extent.reference_steps)) {
    results.push_back(result_of(std::move(problem)));
  }
  const std::vector<std::filesystem::path> paths = find_scenes({demos_folder()});
  Progress progress("the demonstrations' own solutions", static_cast<double>(paths.size()));
  for (const std::filesystem::path& path : paths) {
    const Scene scene = read_scene_file(path).scene;
    const double clip = static_cast<double>(scene.frame_count) / scene.frames_per_second;
    const double seconds = std::min(clip, extent.demonstration_s);
    results.push_back(
        result_of(own_solution(scene.name, scene, seconds, extent.reference_steps), true));
    progress.done(1.0);
  }
  return results;
}

std::vector<Rung> climb_ours(const Problem& problem, const std::string& setting,
                             const Configuration& configuration, const Extent& extent) {
  const auto run = [&](int steps) { return simulate(problem, configuration, steps); };
  return climb(problem, setting, run, extent.most_steps, extent.ours);
}

void run_ours(ProblemResult& result, const Extent& extent, Progress& progress) {
  for (const Contender& contender : contenders()) {
    const std::vector<Rung> rungs =
        climb_ours(result.problem, contender.name, contender.configuration, extent);
    result.rungs.insert(result.rungs.end(), rungs.begin(), rungs.end());
    progress.done(1.0);
  }
  if (!result.events) return;
  Configuration configuration = Method::pinch;
  configuration.events = Events::at_steps;
  result.at_steps = climb_ours(result.problem, events_at_steps, configuration, extent);
}

void run_peer(ProblemResult& result, const Peer& peer, const Extent& extent, bool quick,
              Progress& progress) {
  PeerResult& mine = result.peers.emplace_back();
  if (peer.present()) {
    mine.cannot = result.demonstration ? "demonstrations are not among its scenes"
                                       : peer.cannot(result.problem);
  }
  if (!peer.present() || !mine.cannot.empty()) return;
  const std::vector<PeerSetting> settings = peer.settings(result.problem, quick);
  for (const PeerSetting& setting : settings) {
    const auto run = [&](int steps) { return setting.run(result.problem, steps); };
    const std::vector<Rung> rungs =
        climb(result.problem, setting.text, run, extent.most_steps, extent.peers);
    mine.rungs.insert(mine.rungs.end(), rungs.begin(), rungs.end());
    progress.done(1.0);
  }
}

void add_rows(Csv& csv, const std::string& scene, const std::string& engine,
              const std::vector<Rung>& rungs) {
  for (const Rung& rung : rungs) {
    const Trial& t = rung.trial;
    const double none = std::nan("");
    csv.row({scene, engine, rung.setting, static_cast<std::int64_t>(rung.steps_per_frame),
             static_cast<std::int64_t>(t.finite), t.finite ? t.error : none,
             t.finite ? t.rms_error : none, t.finite ? t.speed_m_s : none,
             t.finite ? 1e6 * t.cpu_s_per_s : none});
  }
}

void write_tables(Output& output, const std::vector<ProblemResult>& results,
                  const std::vector<Peer>& all_peers, const std::string& command) {
  const std::vector<std::string> columns{"scene",           "engine",         "setting",
                                         "steps_per_frame", "finite",         "error",
                                         "rms_error",       "last_speed_m_s", "cpu_us_per_s"};
  Csv all(columns), fronts(columns);
  for (const ProblemResult& result : results) {
    add_rows(all, result.problem.name, "Pinchlab", result.rungs);
    add_rows(all, result.problem.name, "Pinchlab", result.at_steps);
    for (std::size_t p = 0; p < all_peers.size(); ++p) {
      add_rows(all, result.problem.name, all_peers[p].name, result.peers[p].rungs);
      add_rows(fronts, result.problem.name, all_peers[p].name, front(result.peers[p].rungs));
    }
  }
  output.csv("accuracy", all, command);
  output.csv("accuracy-fronts", fronts, command);
}

}  // namespace

std::vector<ProblemResult> scenes_of_known_motion() {
  std::vector<ProblemResult> results;
  for (Problem& problem : known_problems()) results.push_back(result_of(std::move(problem)));
  for (Problem& problem : event_problems()) {
    results.push_back(result_of(std::move(problem)));
    results.back().events = true;
  }
  return results;
}

std::vector<Rung> ladder(const std::vector<Rung>& rungs, const std::string& setting) {
  std::vector<Rung> found;
  for (const Rung& rung : rungs) {
    if (rung.setting == setting) found.push_back(rung);
  }
  return found;
}

void run_accuracy(const Options& options) {
  Output output(options.out);
  const Extent how_far = extent(options.quick);
  const std::vector<Peer> all_peers = peers();
  std::vector<ProblemResult> results = problems(how_far);
  double ladders = 0.0;
  for (const ProblemResult& result : results) {
    ladders += static_cast<double>(contenders().size());
    for (const Peer& peer : all_peers) {
      if (peer.present() && !result.demonstration && peer.cannot(result.problem).empty()) {
        ladders += static_cast<double>(peer.settings(result.problem, options.quick).size());
      }
    }
  }
  Progress progress("bench accuracy", ladders);
  for (ProblemResult& result : results) {
    run_ours(result, how_far, progress);
    for (const Peer& peer : all_peers) {
      run_peer(result, peer, how_far, options.quick, progress);
    }
  }
  write_tables(output, results, all_peers, options.command);
  write_accuracy_figures(output, results, all_peers);
  write_events_figure(output, results);
  output.page("accuracy", accuracy_page(results, all_peers, how_far.ours, how_far.peers),
              options.command);
}

}  // namespace pinchlab::experiments
