// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/population.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
#include <mutex>
#include <thread>
#include <type_traits>

#include "analysis/experiments/population_scenes.h"
#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/diagnostics.h"
#include "sim/mirror.h"
#include "sim/step.h"
#include "sim/tangent.h"

namespace pinchlab::experiments {

namespace {

constexpr int frames = 60;  // one second
constexpr std::array<int, 3> ladder{1, 4, 16};
constexpr int finer = 64;              // steps a frame, of what gains energy at the ladder's last
constexpr double least_gained = 1e-9;  // of all energy: more than round-off
constexpr std::array<const char*, 2> kinds{"located", "at_steps"};  // of events

void note_spans(const Scene& scene, const World& world, Soundness& sound) {
  for (const CableState& cable : world.cables) {
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Segment& segment = cable.segments[s];
      if (segment.pinched) continue;
      if (segment.tension == 0.0) {
        sound.loose_span = std::max(sound.loose_span, segment.length - segment.rest_length);
      }
      const Link& to = cable.links[s];
      const Link& from = at(cable.links, previous_link(cable, static_cast<int>(s)));
      for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
        if (to.body == static_cast<int>(b) || from.body == static_cast<int>(b)) continue;
        const Vec2 x = world.position[b] - segment.tail;
        const double along = segment.direction.dot(x);
        if (along <= 0.0 || along >= segment.length) continue;
        const double side = std::abs(cross(segment.direction, x));
        sound.depth = std::max(sound.depth, scene.bodies[b].radius + cable.half_width - side);
      }
    }
  }
}

struct Runs {
  std::array<Soundness, ladder.size()> runs;

  double apart(std::size_t a, std::size_t b) const { return end_distance(runs[a], runs[b], false); }
};

struct Sample : Runs {
  Soundness image;  // mirrored, at the middle of the ladder

  double asymmetry() const { return end_distance(runs[1], image, true); }
};

Configuration configuration_of(const std::string& kind) {
  Configuration configuration = Method::pinch;
  configuration.diagnostics = true;
  if (kind == "at_steps") configuration.events = Events::at_steps;
  return configuration;
}

Runs run_ladder(const Scene& scene, const Configuration& configuration) {
  Runs runs;
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    runs.runs[i] = run_scene(scene, configuration, ladder[i], frames);
  }
  return runs;
}

Sample run_sample(std::uint64_t seed, const Configuration& configuration) {
  const Scene scene = dropped_discs(seed);
  Sample sample{run_ladder(scene, configuration), {}};
  sample.image = run_scene(mirrored(scene), configuration, ladder[1], frames);
  return sample;
}

/// What `sample` makes of each seed, by itself, so that the number of threads changes nothing.
template <typename Made>
std::vector<Made> run_samples(int count, int first, Progress& progress,
                              const std::function<Made(std::uint64_t)>& sample) {
  std::vector<Made> samples(static_cast<std::size_t>(count));
  std::atomic<int> next = 0;
  std::mutex telling;
  const auto work = [&] {
    for (int i = next++; i < count; i = next++) {
      at(samples, i) = sample(static_cast<std::uint64_t>(first) + static_cast<std::uint64_t>(i));
      const std::lock_guard lock(telling);
      progress.done(1.0);
    }
  };
  std::vector<std::jthread> threads;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) threads.emplace_back(work);
  work();
  threads.clear();
  return samples;
}

struct ShapelySample : Runs {
  Shapely has;
  double finer_gain = 0.0;
};

ShapelySample run_shapely(const ShapelyScene& drawn) {
  const Configuration configuration = configuration_of(kinds[0]);
  ShapelySample sample{run_ladder(drawn.scene, configuration), drawn.has};
  if (sample.runs.back().energy_gain > least_gained) {
    sample.finer_gain = run_scene(drawn.scene, configuration, finer, frames).energy_gain;
  }
  return sample;
}

Csv table_of(const PopulationRun& run, const std::vector<ShapelySample>& samples) {
  Csv csv({"seed", "polygons", "compounds", "ropes", "chains", "steps_per_frame", "finite",
           "energy_gain", "lasting_gain", "gap_violation", "length_error_m", "unsettled_steps",
           "late_event_steps"});
  for (std::size_t n = 0; n < samples.size(); ++n) {
    const Shapely& has = samples[n].has;
    for (std::size_t i = 0; i < ladder.size(); ++i) {
      const Soundness& r = samples[n].runs[i];
      csv.row({run.first + static_cast<std::int64_t>(n), std::int64_t{has.polygons},
               std::int64_t{has.compounds}, std::int64_t{has.ropes}, std::int64_t{has.chains},
               std::int64_t{ladder[i]}, std::int64_t{r.finite}, r.energy_gain, r.lasting_gain,
               r.gap_violation, r.length_error, r.unsettled, r.late_events});
    }
  }
  return csv;
}

Csv table_of(const PopulationRun& run, const std::array<std::vector<Sample>, 2>& samples) {
  Csv csv({"events", "seed", "steps_per_frame", "finite", "driven", "energy_gain", "gap_violation",
           "length_error_m", "loose_span_m", "depth_m", "unsettled_steps", "late_event_steps",
           "from_finer_m", "from_image_m"});
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    for (std::size_t n = 0; n < samples[k].size(); ++n) {
      const Sample& sample = samples[k][n];
      for (std::size_t i = 0; i < ladder.size(); ++i) {
        const Soundness& r = sample.runs[i];
        csv.row({kinds[k], run.first + static_cast<std::int64_t>(n), std::int64_t{ladder[i]},
                 std::int64_t{r.finite}, std::int64_t{r.driven}, r.energy_gain, r.gap_violation,
                 r.length_error, r.loose_span, r.depth, r.unsettled, r.late_events,
                 i + 1 < ladder.size() ? Csv::Cell(sample.apart(i, i + 1)) : Csv::Cell(""),
                 i == 1 ? Csv::Cell(sample.asymmetry()) : Csv::Cell("")});
      }
    }
  }
  return csv;
}

Csv table_of(const PopulationRun& run, const std::array<std::vector<Runs>, 2>& samples) {
  Csv csv({"events", "seed", "steps_per_frame", "finite", "energy_gain", "gap_violation_m",
           "unsettled_steps", "late_event_steps", "from_finer_m"});
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    for (std::size_t n = 0; n < samples[k].size(); ++n) {
      for (std::size_t i = 0; i < ladder.size(); ++i) {
        const Soundness& r = samples[k][n].runs[i];
        csv.row({kinds[k], run.first + static_cast<std::int64_t>(n), std::int64_t{ladder[i]},
                 std::int64_t{r.finite}, r.energy_gain, r.gap_violation, r.unsettled, r.late_events,
                 i + 1 < ladder.size() ? Csv::Cell(samples[k][n].apart(i, i + 1)) : Csv::Cell("")});
      }
    }
  }
  return csv;
}

/// How many runs break a promise, and the worst of them.
template <typename Made>
std::string broken(const std::vector<Made>& samples, std::size_t step,
                   double (*value)(const Soundness&), double limit) {
  int count = 0;
  double worst = 0.0;
  for (const Made& sample : samples) {
    const double v = value(sample.runs[step]);
    count += !(v <= limit);
    worst = std::max(worst, v);
  }
  return fmt::format("{} ({:.1e})", count, worst);
}

/// Of how many runs that holds.
template <typename Made>
std::string count(const std::vector<Made>& samples, std::size_t step,
                  bool (*holds)(const Soundness&)) {
  return fmt::to_string(std::count_if(samples.begin(), samples.end(), [&](const Made& sample) {
    return holds(sample.runs[step]);
  }));
}

bool has_exploded(const Soundness& run) {
  return !run.finite;
}

bool has_clusters(const Soundness& run) {
  return run.late_events > 0;
}

/// How many runs had steps whose states did not settle, and their share of all steps.
template <typename Made>
std::string unsettled(const std::vector<Made>& samples, std::size_t step) {
  std::int64_t runs = 0, steps = 0;
  for (const Made& sample : samples) {
    runs += sample.runs[step].unsettled > 0;
    steps += sample.runs[step].unsettled;
  }
  const double all = static_cast<double>(samples.size()) * frames * ladder[step];
  return fmt::format("{} ({:.2f} %)", runs, 100.0 * static_cast<double>(steps) / all);
}

std::string promises(const std::array<std::vector<Sample>, 2>& samples) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    for (std::size_t i = 0; i < ladder.size(); ++i) {
      const std::vector<Sample>& s = samples[k];
      rows.push_back({kinds[k], fmt::to_string(ladder[i]), count(s, i, has_exploded),
                      broken(
                          s, i, [](const Soundness& r) { return r.driven ? 0.0 : r.energy_gain; },
                          least_gained),
                      broken(
                          s, i, [](const Soundness& r) { return r.gap_violation; }, 1e-6),
                      broken(
                          s, i, [](const Soundness& r) { return r.length_error; }, 1e-12),
                      broken(
                          s, i, [](const Soundness& r) { return r.loose_span; }, 1e-9),
                      broken(
                          s, i, [](const Soundness& r) { return r.depth; }, 1e-6),
                      unsettled(s, i), count(s, i, has_clusters)});
    }
  }
  return markdown_table({"events", "steps a frame", "not finite", "energy gained > 1e-9",
                         "gap < by 1e-6 w", "material > 1e-12 m", "loose span > 1e-9 m",
                         "in a span > 1e-6 m", "unsettled (share of all steps)", "clusters"},
                        rows);
}

std::string shapely_promises(const std::vector<ShapelySample>& samples) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    const auto gain = [](const Soundness& r) { return r.energy_gain; };
    rows.push_back(
        {fmt::to_string(ladder[i]), count(samples, i, has_exploded),
         broken(samples, i, gain, least_gained),
         broken(
             samples, i, [](const Soundness& r) { return r.lasting_gain; }, least_gained),
         count(samples, i, [](const Soundness& r) { return r.energy_gain > 1e-2; }),
         broken(
             samples, i, [](const Soundness& r) { return r.gap_violation; }, 1e-3),
         broken(
             samples, i, [](const Soundness& r) { return r.length_error; }, 1e-12),
         unsettled(samples, i), count(samples, i, has_clusters)});
  }
  return markdown_table(
      {"steps a frame", "not finite", "energy gained > 1e-9", "for 0.1 s", "> 1e-2",
       "gap < by 1e-3 w", "material > 1e-12 m", "unsettled (share of all steps)", "clusters"},
      rows);
}

/// What is left, with a quarter of the last step, of what energy runs gain at that.
std::string left_with_finer(const std::vector<ShapelySample>& samples) {
  std::vector<double> kept;
  double most = 0.0;
  for (const ShapelySample& sample : samples) {
    const double gain = sample.runs.back().energy_gain;
    if (gain <= least_gained) continue;
    kept.push_back(sample.finer_gain / gain);
    most = std::max(most, sample.finer_gain);
  }
  if (kept.empty()) return fmt::format("None gains at {} steps a frame", ladder.back());
  const auto middle = kept.begin() + static_cast<std::ptrdiff_t>(kept.size() / 2);
  std::nth_element(kept.begin(), middle, kept.end());
  return fmt::format(
      "Of the {} that gain at {} steps a frame half keep at most {:.2g} of that at {}, where the "
      "worst of them gains {:.1e}",
      kept.size(), ladder.back(), *middle, finer, most);
}

/// How many of the scenes have what.
std::string shares(const std::vector<ShapelySample>& samples) {
  const auto count = [&](bool Shapely::*has) {
    return std::count_if(samples.begin(), samples.end(),
                         [has](const ShapelySample& sample) { return sample.has.*has; });
  };
  return fmt::format("{} with polygons, {} with compounds, {} with ropes, {} with chains",
                     count(&Shapely::polygons), count(&Shapely::compounds), count(&Shapely::ropes),
                     count(&Shapely::chains));
}

std::string promises_on_tables(const std::array<std::vector<Runs>, 2>& samples) {
  std::vector<std::vector<std::string>> rows;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    for (std::size_t i = 0; i < ladder.size(); ++i) {
      const std::vector<Runs>& s = samples[k];
      rows.push_back({kinds[k], fmt::to_string(ladder[i]), count(s, i, has_exploded),
                      broken(
                          s, i, [](const Soundness& r) { return r.energy_gain; }, least_gained),
                      broken(
                          s, i, [](const Soundness& r) { return r.gap_violation; }, 1e-9),
                      unsettled(s, i), count(s, i, has_clusters)});
    }
  }
  return markdown_table({"events", "steps a frame", "not finite", "energy gained > 1e-9",
                         "overlap > 1e-9 m", "unsettled (share of all steps)", "clusters"},
                        rows);
}

template <typename Made>
std::vector<double> sorted(const std::vector<Made>& samples, auto distance) {
  std::vector<double> all;
  all.reserve(samples.size());
  for (const Made& sample : samples) all.push_back(distance(sample));
  std::sort(all.begin(), all.end());
  return all;
}

double share_within(const std::vector<double>& sorted, double limit) {
  return static_cast<double>(std::upper_bound(sorted.begin(), sorted.end(), limit) -
                             sorted.begin()) /
         static_cast<double>(sorted.size());
}

template <typename Made>
std::string distances(const std::array<std::vector<Made>, 2>& samples) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* events, const std::string& what, const std::vector<double>& d) {
    std::vector<std::string> row{events, what};
    for (const double q : {0.1, 0.25, 0.5, 0.75, 0.9}) {
      row.push_back(fmt::format(
          "{:.1e}", d[static_cast<std::size_t>(q * static_cast<double>(d.size() - 1))]));
    }
    for (const double limit : {1e-9, 1e-3}) {
      row.push_back(fmt::format("{:.0f} %", 100.0 * share_within(d, limit)));
    }
    rows.push_back(row);
  };
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const char* events = kinds[k];
    for (std::size_t i = 0; i + 1 < ladder.size(); ++i) {
      add(events, fmt::format("{} and {} steps a frame", ladder[i], ladder[i + 1]),
          sorted(samples[k], [i](const Made& s) { return s.apart(i, i + 1); }));
    }
    if constexpr (std::is_same_v<Made, Sample>) {
      add(events, "mirror image", sorted(samples[k], [](const Made& s) { return s.asymmetry(); }));
    }
  }
  return markdown_table(
      {"events", "between", "10 %", "25 %", "median", "75 %", "90 %", "<= 1e-9 m", "<= 1 mm"},
      rows);
}

constexpr const char* page_text =
    "# Random scenes\n\n"
    "{} scenes (seeds from {} on) of one to six discs, of masses up to 1e4 apart, that fall on "
    "one to four cables over two to five pulleys: taut, slack or closed, with slip or without, "
    "with restitution from 0 to 1, some with drag or a motor. One second each, `pinch`, with "
    "events at their time (`located`) and at the steps (`at_steps`, as before 0.2).\n\n"
    "## What no motion may show\n\n"
    "Runs in which it happened, and in brackets the worst of any. Energy is that above the "
    "start's, as a share of the most kinetic energy, where nothing drives. A loose span is "
    "longer than its material without tension. In a span lies a body without a link on it. "
    "Unsettled is a run with a step whose states went in circles, so that something stuck beyond "
    "its bounds, or whose lengths and gaps no repair met.\n\n{}\n"
    "## How far two runs of a scene end apart\n\n"
    "The largest distance of any body after the second. Scenes of many impacts are chaotic: what "
    "differs by 1e-12 m grows.\n\n{}\n"
    "## Corners, compounds and weight\n\n"
    "{} scenes of one to four discs, polygons and compounds that fall on a cable over discs and "
    "polygons: {}. Ropes have mass and run over bodies between a weight and an end, chains hang "
    "between two points. Events at their time. Energy that is gained is what leapfrog swings by "
    "in violent turns, of second order in the step; what is beyond 1e-2 is not. {}.\n\n{}\n"
    "## Cables that stretch\n\n"
    "The same scenes, the cable as soft as 1e3 to 1e5 N. What vibrates is followed with no less "
    "than three steps a period, and what is faster is damped: at so few energy swings, by what "
    "falls with the step. Beyond 1e-2 are vibrations that a short interval lets loose, and "
    "bodies that are moved when a cable comes between them. {}.\n\n{}\n"
    "## Ropes that hang\n\n"
    "{} scenes of the same kind on a rope with mass and 5 to 34 nodes, taut or slack, that hangs "
    "between the bodies that it runs over: {}. Of every other rope the number of nodes adapts, "
    "with a tolerance of 2 mm. Energy that is gained is leapfrog's swing, as there: a rim that "
    "takes a node in lifts nothing (`sim/cable/taking_in.h`). {}.\n\n{}\n"
    "## Over an edge\n\n"
    "{} scenes of one to three boxes, polygons and discs that are thrown along a table and over "
    "its edge: a wall, a block that is fixed, or one that lies on the floor. A corner that "
    "slides off is let go at its time (`sim/motion/jumps.h`). Many lose nothing: energy that "
    "they gain is leapfrog's error, a sixteenth with a quarter of the step.\n\n{}\n"
    "How far two runs of a scene end apart, as above:\n\n{}";

/// The most that so many values in succession all reach somewhere; 0: they reach nothing above it.
double reached_by(const std::vector<double>& values, std::size_t many) {
  double greatest = 0.0;
  for (std::size_t i = 0; i + many <= values.size(); ++i) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(i);
    greatest =
        std::max(greatest, *std::min_element(begin, begin + static_cast<std::ptrdiff_t>(many)));
  }
  return greatest;
}

}  // namespace

Soundness run_scene(Scene scene, const Configuration& configuration, int steps_per_frame,
                    int frame_count) {
  constexpr double exploded = 1e5;    // m/s, and rad/s
  constexpr std::size_t piled = 500;  // links of one cable
  scene.steps_per_frame = steps_per_frame;
  World world = make_world(scene, configuration);
  Workspace work;
  Soundness sound;
  double thinnest = infinity, start = 0.0, kinetic = 0.0;
  std::vector<double> gains;  // J, at each step
  for (const Cable& cable : scene.cables) thinnest = std::min(thinnest, cable.half_width);
  if (scene.cables.empty()) thinnest = 1.0;
  for (const Body& body : scene.bodies) {
    sound.driven = sound.driven || body.driven_angular_velocity || body.torque != 0.0;
  }
  for (int i = 0; i < frame_count * steps_per_frame && sound.finite; ++i) {
    if (step(scene, world, work) != StepStatus::ok) sound.finite = false;
    const Diagnostics& d = world.diagnostics;
    if (i == 0) start = d.energy;
    gains.push_back(d.energy - start);
    kinetic = std::max(kinetic, kinetic_energy(world));
    sound.gap_violation = std::max(sound.gap_violation, d.largest_gap_violation / thinnest);
    sound.length_error = std::max(sound.length_error, d.cable_length_error);
    note_spans(scene, world, sound);
    for (const CableState& cable : world.cables) {
      if (cable.links.size() > piled) sound.finite = false;
    }
    for (const Vec2& v : world.velocity) {
      if (!(v.cwiseAbs().maxCoeff() < exploded)) sound.finite = false;
    }
  }
  if (kinetic > 0.0) {
    const std::size_t tenth = index(scene.frames_per_second * steps_per_frame / 10);
    sound.energy_gain = reached_by(gains, 1) / kinetic;
    sound.lasting_gain = reached_by(gains, tenth + 1) / kinetic;
  }
  sound.unsettled = world.diagnostics.fallbacks;
  sound.late_events = world.diagnostics.clusters;
  sound.positions = world.position;
  return sound;
}

double end_distance(const Soundness& a, const Soundness& b, bool image) {
  if (!a.finite || !b.finite) return infinity;
  double largest = 0.0;
  for (std::size_t i = 0; i < a.positions.size(); ++i) {
    Vec2 other = b.positions[i];
    if (image) other.x() = -other.x();
    largest = std::max(largest, (a.positions[i] - other).norm());
  }
  return largest;
}

void run_population(const PopulationRun& run) {
  std::array<std::vector<Sample>, 2> samples;
  Progress progress("bench population",
                    static_cast<double>(kinds.size()) * run.scenes +
                        static_cast<double>(3 + kinds.size()) * run.shapely_scenes);
  std::array<std::vector<Runs>, 2> tables;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const Configuration configuration = configuration_of(kinds[k]);
    samples[k] = run_samples<Sample>(
        run.scenes, run.first, progress,
        [&configuration](std::uint64_t seed) { return run_sample(seed, configuration); });
    tables[k] = run_samples<Runs>(run.shapely_scenes, run.first, progress, [&](std::uint64_t seed) {
      return run_ladder(thrown_off_a_table(seed), configuration);
    });
  }
  const auto run_all = [&](const auto& make) {
    return run_samples<ShapelySample>(run.shapely_scenes, run.first, progress,
                                      [&](std::uint64_t seed) { return run_shapely(make(seed)); });
  };
  const std::vector<ShapelySample> shapely = run_all(dropped_shapes);
  const std::vector<ShapelySample> stretched = run_all(stretched_shapes);
  const std::vector<ShapelySample> hanging = run_all(shapes_on_hanging_rope);
  Output output(run.options.out);
  output.csv("population", table_of(run, samples), run.options.command);
  output.csv("population_shapes", table_of(run, shapely), run.options.command);
  output.csv("population_stretched", table_of(run, stretched), run.options.command);
  output.csv("population_ropes", table_of(run, hanging), run.options.command);
  output.csv("population_tables", table_of(run, tables), run.options.command);
  const std::string page = fmt::format(
      page_text, run.scenes, run.first, promises(samples), distances(samples), run.shapely_scenes,
      shares(shapely), left_with_finer(shapely), shapely_promises(shapely),
      left_with_finer(stretched), shapely_promises(stretched), run.shapely_scenes, shares(hanging),
      left_with_finer(hanging), shapely_promises(hanging), run.shapely_scenes,
      promises_on_tables(tables), distances(tables));
  output.page("population", page, run.options.command);
}

}  // namespace pinchlab::experiments
