// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/commands.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <stdexcept>
#include <string>

#include "analysis/experiments/accuracy.h"
#include "analysis/experiments/convergence.h"
#include "analysis/experiments/experiment.h"
#include "analysis/experiments/features.h"
#include "analysis/experiments/instructions.h"
#include "analysis/experiments/pinch_detection.h"
#include "analysis/experiments/population.h"
#include "analysis/experiments/render_cost.h"
#include "analysis/experiments/shapes.h"
#include "analysis/experiments/stability/stability.h"
#include "analysis/experiments/stress.h"
#include "demos/command_line.h"

namespace pinchlab::experiments {

namespace {

struct Experiment {
  const char* name;
  const char* help;
  void (*run)(const Options& options);
  const char* example;
  bool has_loads = false;
};

/// All but render, which has options of its own.
constexpr Experiment experiments[] = {
    {"stress", "What a step costs as scenes grow, stage by stage, against the thesis' method",
     run_stress, "pinchlab bench stress --loads 1,10,100 --out /tmp/stress", true},
    {"pinch-detection", "What finding pinches costs, phase by phase", run_pinch_detection,
     "pinchlab bench pinch-detection --quick --out /tmp/pinches", true},
    {"features", "What features cost scenes that do not use them, and what sleep saves",
     run_features, "pinchlab bench features --quick --out /tmp/features"},
    {"accuracy", "Error against processor time, ours and other engines'", run_accuracy,
     "pinchlab bench accuracy --quick --out /tmp/accuracy"},
    {"convergence", "How motion through events converges, with events at their time and without",
     run_convergence, "pinchlab bench convergence --quick --out /tmp/convergence"},
    {"shapes", "Corners, drums that fill and cables with mass against known solutions", run_shapes,
     "pinchlab bench shapes --quick --out /tmp/shapes"},
    {"stability", "How far each method holds, and how it fails beyond", run_stability,
     "pinchlab bench stability --quick --out /tmp/stability"},
};

/// The options as they can be typed again, after the command's name.
std::string typed(const Options& options, bool has_loads) {
  std::string text;
  if (options.quick) text += " --quick";
  if (has_loads && options.loads != Options().loads) {
    text += fmt::format(" --loads {}", fmt::join(options.loads, ","));
  }
  return text + " --out " + options.out.string();
}

void add_options(CLI::App& command, Options& options) {
  command.add_option("--out", options.out, "Folder for tables, figures and page [results]")
      ->type_name("DIR");
  command.add_flag("--quick", options.quick, "The same from fewer points, in a tenth of the time");
}

void add_loads(CLI::App& command, Options& options) {
  command
      .add_option(
          "--loads", options.loads,
          fmt::format("How often the scene is repeated [{}]", fmt::join(options.loads, ",")))
      ->type_name("N,...")
      ->delimiter(',')
      ->check(whole_in(1, 100000));
}

void add_experiment(CLI::App& bench, const Experiment& experiment) {
  auto options = std::make_shared<Options>();
  CLI::App* command = bench.add_subcommand(experiment.name, experiment.help);
  add_options(*command, *options);
  if (experiment.has_loads) add_loads(*command, *options);
  command->footer(fmt::format("Example:\n  {}", experiment.example));
  command->callback([options, &experiment] {
    options->command =
        fmt::format("pinchlab bench {}{}", experiment.name, typed(*options, experiment.has_loads));
    experiment.run(*options);
  });
}

void add_render(CLI::App& bench) {
  auto run = std::make_shared<RenderRun>();
  auto scene = std::make_shared<std::string>();
  auto size = std::make_shared<Size>(Size{run->width, run->height});
  CLI::App* command = bench.add_subcommand(
      "render", "What simulating, drawing, converting and encoding a frame cost");
  command->add_option("scene", *scene, "Scene file [all of demos, and their mean]")
      ->type_name("SCENE");
  add_method(*command, run->method,
             "pinch, pinch_no_contact, cable, baseline (the scene's own) or thesis [pinch]");
  add_size(*command, *size, "Pixels of a frame, even [960x960]");
  command->add_option("--frames", run->frames, "Frames to measure [all of the clip]")
      ->type_name("N")
      ->check(whole_in(1, 1'000'000));
  command->add_option("--out", run->out, "Folder for a table and a page as well")->type_name("DIR");
  command->footer(
      "Examples:\n"
      "  pinchlab bench render demos/03-drop.json --size 640x640\n"
      "  pinchlab bench render --frames 60 --out /tmp/render");
  command->callback([run, scene, size] {
    run->scene = *scene;
    run->width = size->width;
    run->height = size->height;
    if (run->width % 2 != 0 || run->height % 2 != 0) {
      throw std::invalid_argument(fmt::format("h264 needs an even size, not {}x{}; change --size",
                                              run->width, run->height));
    }
    run->command = fmt::format(
        "pinchlab bench render{}{} --method {} --size {}x{}{} --out {}", scene->empty() ? "" : " ",
        *scene, run->method, run->width, run->height,
        run->frames > 0 ? fmt::format(" --frames {}", run->frames) : "", run->out.string());
    run_render(*run);
  });
}

void add_population(CLI::App& bench) {
  auto run = std::make_shared<PopulationRun>();
  CLI::App* command = bench.add_subcommand(
      "population", "What no motion may show, counted over random scenes at three step lengths");
  command->add_option("--out", run->options.out, "Folder for table and page [results]")
      ->type_name("DIR");
  command->add_option("--scenes", run->scenes, "How many of discs [2000]")
      ->type_name("N")
      ->check(whole_in(1, 1000000));
  command
      ->add_option("--shapes", run->shapely_scenes,
                   "How many of polygons, compounds and cables with mass, of cables that stretch, "
                   "of ropes that hang, and of what is thrown over edges [1000]")
      ->type_name("N")
      ->check(whole_in(1, 1000000));
  command->add_option("--first", run->first, "Seed of the first, to look at some by themselves [1]")
      ->type_name("N")
      ->check(whole_in(1, 1000000));
  command->footer(
      "Examples:\n"
      "  pinchlab bench population --scenes 100 --out /tmp/population\n"
      "  pinchlab bench population --first 1234 --scenes 1 --out /tmp/one");
  command->callback([run] {
    run->options.command =
        fmt::format("pinchlab bench population --scenes {} --shapes {} --first {} --out {}",
                    run->scenes, run->shapely_scenes, run->first, run->options.out.string());
    run_population(*run);
  });
}

void add_instructions(CLI::App& bench) {
  auto options = std::make_shared<Options>();
  CLI::App* command = bench.add_subcommand(
      "instructions", "What a step executes, counted by valgrind: steady where clocks are not");
  add_options(*command, *options);
  command->footer("Example:\n  pinchlab bench instructions --quick --out /tmp/instructions");
  command->callback([options] {
    options->command = "pinchlab bench instructions" + typed(*options, false);
    run_instructions(*options);
  });
}

/// Not everybody has valgrind: all the rest is measured without it.
void count_if_possible(const Options& options) {
  if (!can_count_instructions()) {
    fmt::print(stderr, "instructions are not counted: there is no valgrind\n");
    return;
  }
  Options own = options;
  own.command = "pinchlab bench instructions" + typed(options, false);
  run_instructions(own);
}

void add_all(CLI::App& bench) {
  auto options = std::make_shared<Options>();
  CLI::App* command = bench.add_subcommand("all", "All experiments, one after another");
  add_options(*command, *options);
  command->footer("The published results are made by: pinchlab bench all --out analysis/results");
  command->callback([options] {
    for (const Experiment& experiment : experiments) {
      options->command = fmt::format("pinchlab bench {}{}", experiment.name,
                                     typed(*options, experiment.has_loads));
      experiment.run(*options);
    }
    PopulationRun population;
    population.options = *options;
    if (options->quick) population.scenes = population.shapely_scenes = 100;
    population.options.command =
        fmt::format("pinchlab bench population --scenes {} --shapes {} --out {}", population.scenes,
                    population.shapely_scenes, options->out.string());
    run_population(population);
    count_if_possible(*options);
    RenderRun render;
    render.out = options->out;
    if (options->quick) render.frames = 60;
    render.command = fmt::format("pinchlab bench render{} --out {}",
                                 options->quick ? " --frames 60" : "", render.out.string());
    run_render(render);
  });
}

}  // namespace

void add_bench_commands(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Experiments on speed, accuracy and stability")
                        ->require_subcommand(1);
  for (const Experiment& experiment : experiments) add_experiment(*bench, experiment);
  add_render(*bench);
  add_instructions(*bench);
  add_population(*bench);
  add_all(*bench);
  bench->footer(
      "Each writes raw tables (CSV) and a page that says in words what they show; where there is "
      "something to\ndraw, figures too (SVG and PDF, by gnuplot).\n\n"
      "Examples:\n"
      "  pinchlab bench all --quick                        everything, in several minutes\n"
      "  pinchlab bench all --out analysis/results         the published results\n"
      "  pinchlab bench render demos/03-drop.json          what a frame of one clip costs");
}

}  // namespace pinchlab::experiments
