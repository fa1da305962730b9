// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: reads the command line and calls one function a command.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "demos/batch.h"
#include "demos/still.h"
#include "demos/trajectory.h"
#include "demos/version.h"
#include "render/bench.h"
#include "render/canvas.h"

namespace pinchlab {
namespace {

struct Size {
  int width = 0, height = 0;  // px
};

// "960x540" to a size. Returns what is wrong with it, or nothing.
std::string read_size(const std::string& text, Size& size) {
  char rest = 0;
  const int found = std::sscanf(text.c_str(), "%5dx%5d%c", &size.width, &size.height, &rest);
  if (found == 2 && std::min(size.width, size.height) >= smallest_frame &&
      std::max(size.width, size.height) <= largest_frame) {
    return "";
  }
  return fmt::format("{} is not WIDTHxHEIGHT in pixels, each {} to {}, such as 960x960", text,
                     smallest_frame, largest_frame);
}

void add_size(CLI::App& command, Size& size, const std::string& help) {
  command
      .add_option_function<std::string>(
          "--size", [&size](const std::string& text) { read_size(text, size); }, help)
      ->type_name("WxH")
      ->check([](const std::string& text) {
        Size ignored;
        return read_size(text, ignored);
      });
}

// What render and bench take when no scene is named.
std::filesystem::path demos_folder() {
  if (!std::filesystem::is_directory("demos")) {
    throw std::runtime_error(
        "demos: there is no such folder here; go to the project's folder, or name scene files");
  }
  return "demos";
}

template <class Text>
void add_method(CLI::App& command, Text& method, const std::string& help) {
  command.add_option("--method", method, help)
      ->type_name("M")
      ->check(CLI::IsMember({"pinch", "pinch_no_contact", "cable", "baseline"}));
}

void add_scene(CLI::App& command, std::string& scene) {
  command.add_option("scene", scene, "Scene file; demos/README.md documents the format")
      ->type_name("SCENE")
      ->required();
}

void add_fps(CLI::App& command, Timing& timing) {
  command
      .add_option("--fps", timing.frames_per_second,
                  "Frames a second [the scene's]; the steps get no longer than the scene's")
      ->type_name("N")
      ->check(CLI::Range(1, 1000));
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
  add_method(*command, options->method,
             "Make one clip a scene: pinch, pinch_no_contact, cable or baseline (each scene's own) "
             "[the pair]");
  add_size(*command, *size, "Pixels of one picture, even unless ffv1 [960x960]");
  add_fps(*command, options->timing);
  command
      ->add_option_function<std::string>(
          "--codec",
          [options](const std::string& name) { options->codec = codec_from_string(name); },
          "h264 (MP4), vp9 (WebM) or ffv1 (Matroska, lossless) [h264]")
      ->type_name("C")
      ->check(CLI::IsMember({"h264", "vp9", "ffv1"}));
  command->add_option("--jobs", options->jobs, "Clips made at a time [one a core]")
      ->type_name("N")
      ->check(CLI::Range(1, 1024));
  command->add_flag("--side-by-side", options->side_by_side,
                    "Also each pair in one picture, in both left/right orders (for the study)");
  command->footer(
      "What is up to date is kept. The same input gives the same bytes, for any --jobs.\n\n"
      "Examples:\n"
      "  pinchlab render                             all of demos/ into clips/\n"
      "  pinchlab render --side-by-side              and what the study shows\n"
      "  pinchlab render demos/03-drop.json --out /tmp/drop --size 640x480\n"
      "  pinchlab render --method cable --codec ffv1 one lossless clip a scene");
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

void add_still(CLI::App& app) {
  struct Options : StillOptions {
    std::string scene, method = "pinch";
    bool both = false;
    Size size;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command =
      app.add_subcommand("still", "One frame as PNG; several times make a contact sheet");
  add_scene(*command, options->scene);
  command
      ->add_option("--time", options->times,
                   "Time to show, s; several, or a list 1,2.5,4, make a sheet")
      ->type_name("S")
      ->required()
      ->delimiter(',');
  command->add_option("--out", options->out, "PNG file")->type_name("FILE.png")->required();
  add_method(*command, options->method,
             "pinch, pinch_no_contact, cable or baseline (the scene's own) [pinch]");
  command->add_flag("--both", options->both, "A row of pinch over a row of the baseline")
      ->excludes("--method");
  add_size(*command, options->size, "Pixels of one picture [960x960; in a sheet 480x480]");
  command->footer(
      "Examples:\n"
      "  pinchlab still demos/03-drop.json --time 2.5 --out drop.png\n"
      "  pinchlab still demos/03-drop.json --time 0,1,2,3 --both --out drop-sheet.png");
  command->callback([options] {
    const SceneFile file = read_scene_file(options->scene);
    options->methods = options->both ? std::vector{Method::pinch, file.scene.baseline}
                                     : std::vector{method_of(file.scene, options->method)};
    const bool sheet = options->times.size() * options->methods.size() > 1;
    const Size usual = sheet ? Size{480, 480} : Size{960, 960};
    options->width = options->size.width > 0 ? options->size.width : usual.width;
    options->height = options->size.height > 0 ? options->size.height : usual.height;
    write_still(file, *options);
  });
}

void add_simulate(CLI::App& app) {
  struct Options : TrajectoryOptions {
    std::string scene, method_name = "pinch";
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
  add_method(*command, options->method_name,
             "pinch, pinch_no_contact, cable or baseline (the scene's own) [pinch]");
  command->add_option("--until", options->until, "Time of the last row, s [the clip's last frame]")
      ->type_name("S");
  add_fps(*command, options->timing);
  command
      ->add_option("--steps-per-frame", options->timing.steps_per_frame,
                   "Steps a frame [the scene's]")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000));
  command->footer(
      "TRAJ.csv: time_s,body,x_m,y_m,angle_rad,vx_m_s,vy_m_s,omega_rad_s\n"
      "SEG.csv:  "
      "time_s,cable,segment,from_body,to_body,length_m,rest_length_m,tension_n,pinched,slipping\n"
      "Velocities are those at the row's time; tension is the last step's; pinched is 0 or 1; "
      "slipping is 1\n"
      "(forward), -1 (backward) or 0 over to_body. Numbers read back exactly.\n\n"
      "Examples:\n"
      "  pinchlab simulate demos/03-drop.json --out drop.csv --segments drop-segments.csv\n"
      "  pinchlab simulate demos/03-drop.json --method baseline --until 2 --steps-per-frame 16 "
      "--out -");
  command->callback([options] {
    const SceneFile file = read_scene_file(options->scene);
    options->method = method_of(file.scene, options->method_name);
    write_trajectory(file, *options);
  });
}

void add_bench(CLI::App& app) {
  struct Options {
    std::string scene, method = "pinch";
    int frames = 0;
    Size size{960, 960};
  };
  auto options = std::make_shared<Options>();
  CLI::App* bench = app.add_subcommand("bench", "Measure what things cost")->require_subcommand(1);
  CLI::App* command = bench->add_subcommand(
      "render", "What simulating, drawing, converting and encoding a frame cost");
  command->add_option("scene", options->scene, "Scene file [the first of demos]")
      ->type_name("SCENE");
  add_method(*command, options->method,
             "pinch, pinch_no_contact, cable or baseline (the scene's own) [pinch]");
  add_size(*command, options->size, "Pixels of a frame, even [960x960]");
  command->add_option("--frames", options->frames, "Frames to measure [all of the clip]")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  command->callback([options] {
    const SceneFile file =
        read_scene_file(options->scene.empty() ? find_scenes({demos_folder()}).front()
                                               : std::filesystem::path(options->scene));
    const RenderCost cost =
        measure_render(file.scene, method_of(file.scene, options->method), options->size.width,
                       options->size.height, options->frames);
    fmt::print("{}", table(file.scene.name, cost));
  });
}

int run(int argc, char** argv) {
  CLI::App app{
      "Pinchlab: cables that run over and between bodies in 2D. Paired videos of their "
      "simulation,\n"
      "with pinch joints and without, and tables of the motion."};
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
  add_bench(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::RuntimeError& error) {
    return error.get_exit_code();  // told already
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;  // --help and --version are 0
  }
  return 0;
}

}  // namespace
}  // namespace pinchlab

int main(int argc, char** argv) {
  try {
    return pinchlab::run(argc, argv);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
