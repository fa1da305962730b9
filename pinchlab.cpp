// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: reads the command line and calls one function a command.

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "analysis/commands.h"
#include "analysis/experiments/advise.h"
#include "analysis/experiments/commands.h"
#include "base/output_file.h"
#include "demos/baseline.h"
#include "demos/batch.h"
#include "demos/command_line.h"
#include "demos/help_pages.h"
#include "demos/scenes/find_scenes.h"
#include "demos/scenes/trajectory.h"
#include "demos/series_sheet.h"
#include "demos/still.h"
#include "demos/sweep_command.h"
#include "demos/version.h"
#include "study/commands.h"

namespace pinchlab {
namespace {

CLI::Option* add_scene(CLI::App& command, std::string& scene) {
  return command.add_option("scene", scene, "Scene file; demos/README.md documents the format")
      ->type_name("SCENE")
      ->required();
}

void add_fps(CLI::App& command, Timing& timing) {
  command
      .add_option("--fps", timing.frames_per_second,
                  "Frames a second [the scene's]; the steps get no longer than the scene's")
      ->type_name("N")
      ->check(whole_in(1, 1000));
}

CLI::Option* add_error(CLI::App& command, Timing& timing) {
  return command
      .add_option("--error", timing.error,
                  "How far bodies may be from their exact places, m: steps are divided, up to 8 "
                  "times as many are taken, until a simulation with half as long ones confirms it; "
                  "0: not measured [the scene's error_m, or 0]")
      ->type_name("M")
      ->check(number_in(0.0, 1.0));
}

void add_theme(CLI::App& command, ThemeFile& theme, bool& burn_time) {
  command
      .add_option_function<std::string>(
          "--theme", [&theme](const std::string& file) { theme = read_theme_file(file); },
          "Colours and line widths: a file as in demos/themes [the default]")
      ->type_name("FILE");
  command.add_flag("--burn-time", burn_time, "Write the time into a corner of each picture");
}

/// What a clip is made of: its method, pixels, timing, codec and looks.
void add_clip_options(CLI::App& command, BatchOptions& options, Size& size) {
  add_method(
      command, options.method,
      "Make one clip a scene: pinch, pinch_no_contact, cable, baseline (each scene's own) or "
      "thesis (all of the thesis' ways, its iterative solver too) [the pair]");
  command
      .add_option_function<std::vector<std::string>>(
          "--pair",
          [&options](const std::vector<std::string>& pairs) {
            options.side_by_side = true;
            for (const std::string& text : pairs) options.pairs.push_back(pair_from(text));
          },
          "Compare these two of the methods above, e.g. pinch,thesis, in both left/right orders; "
          "several --pair make several pairs [pinch,baseline]")
      ->type_name("A,B")
      ->allow_extra_args(false)
      ->excludes("--method");
  add_size(command, size,
           "Pixels of one picture, even for h264 and vp9; 720x1280 is a portrait [960x960]");
  add_fps(command, options.timing);
  add_error(command, options.timing);
  command
      .add_option_function<std::string>(
          "--codec",
          [&options](const std::string& name) { options.codec = codec_from_string(name); },
          "h264 (MP4), vp9 (WebM), ffv1 (Matroska, lossless), or for previews that play for ever "
          "apng, webp or gif (with --fps 50) [h264]")
      ->type_name("C")
      ->check(CLI::IsMember({"h264", "vp9", "ffv1", "apng", "webp", "gif"}));
  add_simulation_limit(command, options.time_limit, "a clip's");
  command.add_option("--jobs", options.jobs, "Clips made at a time [one a core]")
      ->type_name("N")
      ->check(whole_in(1, 1024));
  add_theme(command, options.theme, options.burn_time);
}

/// A clip's time that is not the scene's.
void add_playback(CLI::App& command, Playback& playback) {
  command
      .add_option_function<std::vector<std::string>>(
          "--slow",
          [&playback](const std::vector<std::string>& windows) {
            for (const std::string& text : windows) {
              playback.slow.push_back(slow_from(text));
            }
          },
          "Slow motion of a part, from steps between the frames: 1.2-1.6:0.25 shows these 0.4 s in "
          "1.6 s")
      ->type_name("FROM-TO:FACTOR")
      ->allow_extra_args(false);
  command
      .add_option_function<std::vector<std::string>>(
          "--freeze",
          [&playback](const std::vector<std::string>& stops) {
            for (const std::string& text : stops) {
              playback.freeze.push_back(freeze_from(text));
            }
          },
          "Hold the frame at a time for so long: 1.2:0.5")
      ->type_name("TIME:SECONDS")
      ->allow_extra_args(false);
}

/// What is made besides each scene's two clips, or instead of them.
void add_kinds_of_clip(CLI::App& command, BatchOptions& options) {
  CLI::Option* also =
      command.add_flag("--side-by-side", options.side_by_side,
                       "Also each pair in one picture, in both left/right orders (for the study)");
  add_playback(command, options.playback);
  command
      .add_flag_callback(
          "--only-side-by-side",
          [&options] {
            options.side_by_side = true;
            options.singles = false;
          },
          "Nothing but these, as `study serve` makes them")
      ->excludes(also)
      ->excludes("--method");
  CLI::Option* checks =
      command.add_flag("--attention-checks", options.checks,
                       "Also the clip with pinch joints beside itself upside down, in both orders");
  checks->excludes("--method");
  CLI::Option* report = command.add_flag(
      "--report", options.report,
      "Also how each pair differs and when, as a table, report.html and strips of pictures");
  report->excludes("--method")->excludes("--pair");
  command
      .add_flag_callback(
          "--only-report",
          [&options] {
            options.report = true;
            options.singles = false;
          },
          "Nothing but this: no clips, nor what is about clips")
      ->excludes("--method")
      ->excludes("--pair")
      ->excludes("--codec")
      ->excludes("--slow")
      ->excludes("--freeze")
      ->excludes("--only-side-by-side")
      ->excludes(also)
      ->excludes(checks)
      ->excludes(report);
}

void add_render(CLI::App& app) {
  auto options = std::make_shared<BatchOptions>();
  auto size = std::make_shared<Size>(Size{options->width, options->height});
  CLI::App* command =
      app.add_subcommand("render", "Render each scene's pair of clips, a poster and manifest.json");
  command->add_option("scenes", options->scenes, "Scene files, or folders of NN-name.json [demos]")
      ->type_name("SCENE");
  command->add_option("--out", options->out, "Folder for the files, made if missing [clips]")
      ->type_name("DIR");
  add_clip_options(*command, *options, *size);
  add_kinds_of_clip(*command, *options);
  command->footer(
      "What is up to date is kept. The same input gives the same bytes, for any --jobs.\n\n"
      "Examples:\n"
      "  pinchlab render                             all of demos/ into clips/\n"
      "  pinchlab render --side-by-side              and what the study shows\n"
      "  pinchlab render demos/03-drop.json --out /tmp/drop --size 640x480\n"
      "  pinchlab render --only-report               how the pairs differ, without the clips\n"
      "  pinchlab render demos/03-drop.json --slow 0.4-0.6:0.25 --freeze 0.5:1 --burn-time\n"
      "  pinchlab render --method cable --codec ffv1 one lossless clip a scene\n"
      "  pinchlab render --pair pinch,cable --pair pinch,thesis --pair cable,thesis --out three");
  command->callback([options, size] {
    if (options->scenes.empty()) {
      options->scenes = {demos_folder()};
    }
    options->width = size->width;
    options->height = size->height;
    if (render_batch(*options) > 0) {
      throw CLI::RuntimeError(1);
    }
  });
}

struct StillCommand : StillOptions {
  std::string scene, method = "pinch";
  std::vector<std::string> table;
  Timing timing;  // its error alone
  bool both = false;
  Size size;
};

/// Which frames of what, as which file.
void add_frames(CLI::App& command, StillCommand& options) {
  CLI::Option* scene = add_scene(command, options.scene);
  command
      .add_option("--time", options.times,
                  "Time to show, s; several --time, or a list 1,2.5,4, make a sheet; 1:1.5 are all "
                  "frames from one time to another")
      ->type_name("S")
      ->allow_extra_args(false)
      ->required();
  command
      .add_option("--out", options.out,
                  "FILE.png, .svg or .pdf; a # in the name of a PNG stands for the frame's number "
                  "and gives each frame its own file")
      ->type_name("FILE")
      ->required();
  add_method(command, options.method,
             "pinch, pinch_no_contact, cable, baseline (the scene's own) or thesis [pinch]");
  CLI::Option* both =
      command.add_flag("--both", options.both, "A row of pinch over a row of the baseline");
  both->excludes("--method");
  CLI::Option* neutral = command.add_flag("--neutral", options.neutral,
                                          "Label the rows of a sheet A and B, not by method");
  command
      .add_option_function<std::vector<std::string>>(
          "--table",
          [&options, scene](const std::vector<std::string>& words) {
            options.table = words;
            if (scene->count() > 0 || words.size() < 2 || !words.back().ends_with(".json")) return;
            scene->add_result(words.back());  // that stands right behind the table
            options.scene = words.back();
            options.table.pop_back();
          },
          "SCENE has placeholders: a column of pictures for each row of this table, as "
          "`sweep` takes it")
      ->type_name("TABLE")
      ->excludes(both)
      ->excludes(neutral);
}

void draw_still(StillCommand& options) {
  const Size of_sheet = options.size.width > 0 ? options.size : Size{480, 480};
  if (!options.table.empty()) {
    options.width = of_sheet.width;
    options.height = of_sheet.height;
    return write_series(read_sweep(options.scene, options.table), options.method, options);
  }
  const SceneFile file = read_scene_file(options.scene, options.timing);
  options.methods = {method_of(file.scene, options.method)};
  if (options.both) options.methods = {Method::pinch, file.scene.baseline};
  check_error_is_heeded(options.timing, options.methods);
  const bool sheet = frames_at(file.scene, options.times).size() * options.methods.size() > 1 &&
                     options.out.filename().string().find('#') == std::string::npos;
  if (options.neutral && !sheet) {
    throw CLI::ValidationError(
        "--neutral",
        "is about the labels of a sheet; give --both or several times, or leave it out");
  }
  const Size single = options.size.width > 0 ? options.size : Size{960, 960};
  options.width = sheet ? of_sheet.width : single.width;
  options.height = sheet ? of_sheet.height : single.height;
  write_still(file, options);
}

void add_still(CLI::App& app) {
  auto options = std::make_shared<StillCommand>();
  CLI::App* command =
      app.add_subcommand("still", "One frame as PNG, SVG or PDF; several make a contact sheet");
  add_frames(*command, *options);
  add_error(*command, options->timing)->excludes(command->get_option("--table"));
  add_theme(*command, options->theme, options->burn_time);
  add_size(*command, options->size, "Pixels of one picture [960x960; in a sheet 480x480]");
  add_simulation_limit(*command, options->time_limit, "a");
  command->footer(
      "Examples:\n"
      "  pinchlab still demos/03-drop.json --time 2.5 --out drop.png\n"
      "  pinchlab still demos/03-drop.json --time 0,1,2,3 --both --neutral --out drop-sheet.pdf\n"
      "  pinchlab still demos/03-drop.json --time 2.5 --theme demos/themes/print.json --out "
      "drop.svg\n"
      "  pinchlab still demos/03-drop.json --time 0.4:0.8 --out frames/#.png\n"
      "  pinchlab still demos/sweep/drop.json --table squeeze=0:1:5 mass=1 height=0.9 --time 1 "
      "--out graded.svg");
  command->callback([options] { draw_still(*options); });
}

void add_simulate(CLI::App& app) {
  struct Options : TrajectoryOptions {
    std::string scene, method = "pinch";
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("simulate", "Simulate a scene and write its motion as CSV");
  add_scene(*command, options->scene);
  command->add_option("--out", options->out, "One row a body and frame; - is standard output")
      ->type_name("TRAJ.csv")
      ->required();
  command->add_option("--segments", options->segments, "One row a cable's segment and frame")
      ->type_name("SEG.csv");
  add_method(*command, options->method,
             "pinch, pinch_no_contact, cable, baseline (the scene's own), or thesis: all of the "
             "thesis' ways, its iterative solver too [pinch]");
  command
      ->add_option(
          "--until", options->until,
          "The last row is the last frame's up to this time, s [the clip's last frame, which is at "
          "its duration less that of a frame]")
      ->type_name("S")
      ->check(number());
  add_fps(*command, options->timing);
  add_error(*command, options->timing);
  command
      ->add_option("--steps-per-frame", options->timing.steps_per_frame,
                   "Steps a frame [the scene's]")
      ->type_name("N")
      ->check(whole_in(1, 1'000'000));
  add_simulation_limit(*command, options->time_limit, "a");
  command->footer(
      "TRAJ.csv: time_s,body,x_m,y_m,angle_rad,vx_m_s,vy_m_s,omega_rad_s\n"
      "SEG.csv:  "
      "time_s,cable,segment,from_body,to_body,length_m,rest_length_m,tension_n,pinched,slipping\n"
      "Velocities are those at the row's time; tension is the last step's; pinched is 0 or 1; "
      "slipping is 1\n"
      "(forward), -1 (backward) or 0 over to_body. Numbers read back exactly. A cable c with nodes "
      "and no wraps\nis the cables c, c:1, c:2 and so on, a piece each.\n\n"
      "Examples:\n"
      "  pinchlab simulate demos/03-drop.json --out drop.csv --segments drop-segments.csv\n"
      "  pinchlab simulate demos/03-drop.json --method baseline --until 2 --steps-per-frame 16 "
      "--out -\n"
      "  pinchlab simulate demos/02-stack.json --method thesis --out stack-thesis.csv");
  command->callback([options] {
    const SceneFile file = read_scene_file(options->scene, options->timing);
    options->configuration = method_of(file.scene, options->method);
    write_trajectory(file, *options);
  });
}

void add_baseline(CLI::App& app) {
  struct Options {
    std::string scene;
    std::optional<double> time_limit;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "baseline", "Which baseline is fair for a scene: how each method does, and a recommendation");
  add_scene(*command, options->scene);
  add_simulation_limit(*command, options->time_limit, "a method's");
  command->footer(
      "Plain cable joints (cable) are recommended where they break nothing, not even the scene's "
      "error_m, and\nmove as smoothly as pinch joints without contact (pinch_no_contact), under "
      "which bodies come equally close.\n\n"
      "Examples:\n"
      "  pinchlab baseline demos/02-stack.json");
  command->callback([options] {
    const SceneFile file = read_scene_file(options->scene);
    print_result(text(file, advise_baseline(file, options->time_limit)));
  });
}

void add_study(CLI::App& app) {
  study::Stimuli stimuli;
  stimuli.demonstrations = [] {
    std::vector<std::string> names;
    if (const auto folder = find_demos_folder()) {
      for (const std::filesystem::path& scene : find_scenes({*folder})) {
        names.push_back(scene.stem().string());
      }
    }
    return names;
  };
  stimuli.render = [](const std::vector<std::string>& names, study::PairKind kind,
                      const std::filesystem::path& folder, study::Encoding encoding) {
    BatchOptions options;
    for (const std::string& name : names) {
      options.scenes.push_back(demos_folder() / (name + ".json"));
    }
    options.out = folder;
    options.codec = encoding == study::Encoding::mp4 ? Codec::h264 : Codec::vp9;
    options.singles = false;
    options.side_by_side = kind == study::PairKind::methods;
    options.checks = kind == study::PairKind::check;
    if (render_batch(options) > 0) {
      throw std::runtime_error(folder.string() + ": clips are missing; the study cannot begin");
    }
  };
  study::add_commands(app, stimuli);
}

int run(int argc, char** argv) {
  CLI::App app{
      "Pinchlab: cables that run over and between bodies in 2D. Paired videos of their "
      "simulation,\n"
      "with pinch joints and without, tables of the motion, and statistics of a study of the "
      "clips."};
  app.name("pinchlab");
  app.set_version_flag("--version", std::string("pinchlab ") + version);
  app.require_subcommand(1);
  app.footer(
      "Results go to files or standard output, messages to standard error.\n"
      "Exit codes: 0 fine, 1 failed (a bad scene, a full disk), 2 bad usage.\n\n"
      "Start with: pinchlab render, then look into clips/. pinchlab COMMAND --help has examples.");
  add_render(app);
  add_still(app);
  add_simulate(app);
  add_baseline(app);
  add_sweep_commands(app);
  experiments::add_bench_commands(app);
  experiments::add_advise_command(app);
  analysis::add_commands(app);
  add_study(app);
  add_help_page_commands(app, version);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();  // told already
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
    if (const std::string unknown = unknown_words(app); !unknown.empty()) {
      throw std::invalid_argument(unknown);
    }
    if (const std::string twice = given_too_often(error); !twice.empty()) {
      throw std::invalid_argument(twice);
    }
    app.exit(error);
    return 2;
  }
  return 0;
}

int run_and_tell(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr,
                 "memory is short for this; ask for less at a time (fewer or smaller pictures, "
                 "fewer --jobs), or allow the program more memory\n");
    return 1;
  } catch (const std::filesystem::filesystem_error& error) {
    std::fprintf(stderr, "%s: %s\n", error.path1().c_str(), error.code().message().c_str());
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}

// A standard stream that the caller has closed is taken, or the next file that is opened would get
// its place, and the messages. What is told there is lost; results, as before, cannot be written.
void take_closed_streams() {
  for (const auto& [stream, mode] :
       {std::pair{STDIN_FILENO, O_RDONLY}, {STDOUT_FILENO, O_RDONLY}, {STDERR_FILENO, O_WRONLY}}) {
    if (::fcntl(stream, F_GETFD) == -1 && errno == EBADF) ::open("/dev/null", mode);
  }
}

// What is left of results on standard output goes out; exit code 1 where that fails, or failed
// before.
int with_results_written(int exit_code) {
  errno = 0;
  const bool written = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
  if (written || exit_code != 0) return exit_code;
  std::fprintf(stderr, "standard output: cannot be written%s%s\n", errno != 0 ? ": " : "",
               errno != 0 ? std::strerror(errno) : "");
  return 1;
}

}  // namespace
}  // namespace pinchlab

int main(int argc, char** argv) {
  using namespace pinchlab;
  take_closed_streams();
  // What a large World leaves is joined block by block as it is freed, not all at once, when no
  // cache has it any more, by the next large allocation.
  mallopt(M_MXFAST, 0);
  return with_results_written(run_and_tell(argc, argv));
}
