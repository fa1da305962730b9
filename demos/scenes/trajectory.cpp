// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/trajectory.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>

#include "base/at.h"
#include "base/output_file.h"
#include "base/progress.h"
#include "demos/scenes/fineness.h"
#include "demos/scenes/scene_format.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

void add_bodies(const Player& player, std::string& rows) {
  const Scene& scene = player.scene();
  const World& world = player.world();
  const Velocities velocity = player.velocities();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    fmt::format_to(std::back_inserter(rows), "{},{},{},{},{},{},{},{}\n", player.time(),
                   scene.bodies[i].name, world.position[i].x(), world.position[i].y(),
                   world.angle[i], velocity.linear[i].x(), velocity.linear[i].y(),
                   velocity.angular[i]);
  }
}

const char* body_name(const Scene& scene, const Link& link) {
  return link.body < 0 ? "world" : at(scene.bodies, link.body).name.c_str();
}

void add_segments(const Player& player, std::string& rows) {
  const Scene& scene = player.scene();
  const World& world = player.world();
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    const CableState& cable = world.cables[c];
    if (cable.pieces == 0) continue;  // part of another
    const std::size_t first = cable.closed ? 0 : 1;
    for (std::size_t i = first; i < cable.segments.size(); ++i) {
      const Segment& segment = cable.segments[i];
      const Link& from = cable.links[i == 0 ? cable.links.size() - 1 : i - 1];
      const Link& to = cable.links[i];
      fmt::format_to(std::back_inserter(rows), "{},{},{},{},{},{},{},{},{},{}\n", player.time(),
                     scene.cables[c].name, i - first, body_name(scene, from), body_name(scene, to),
                     segment.length, segment.rest_length, segment.tension, segment.pinched ? 1 : 0,
                     static_cast<int>(to.slip));
    }
  }
}

// The last frame whose time is not after `until`.
int last_frame(const Scene& scene, std::optional<double> until) {
  if (!until) {
    return scene.frame_count - 1;
  }
  const double frames = *until * scene.frames_per_second;
  if (!(*until >= 0.0) || frames > max_frame_count) {
    throw std::invalid_argument(
        fmt::format("--until must be 0 to {} s, not {}",
                    static_cast<double>(max_frame_count) / scene.frames_per_second, *until));
  }
  return static_cast<int>(std::floor(frames * (1.0 + 1e-12)));
}

// Rows are frames; a time between two of them is not what the table ends with.
void tell_last_time(const SceneFile& file, const Scene& scene, std::optional<double> until,
                    int last) {
  if (!until) return;
  const double time = static_cast<double>(last) / scene.frames_per_second;  // s
  if (std::abs(time - *until) <= 1e-9 * *until) return;
  fmt::print(stderr, "{}: note: --until {} s lies between two frames; the last row is of {} s\n",
             file.path.string(), *until, time);
}

Fineness find_fineness(const SceneFile& file, const Scene& scene, int last,
                       const TrajectoryOptions& options) {
  const Configuration& how = options.configuration;
  return options.quiet
             ? find_fineness(file, scene, how, last, options.time_limit)
             : find_fineness_aloud(file, scene, how, last, options.time_limit, scene.name);
}

}  // namespace

void write_trajectory(const SceneFile& file, const TrajectoryOptions& options) {
  if (options.segments && is_same_file(*options.segments, options.out)) {
    throw std::invalid_argument("--out and --segments must be different files");
  }
  for (const fs::path& out : {options.out, options.segments.value_or(fs::path())}) {
    if (is_same_file(out, file.path)) {
      throw std::invalid_argument(
          fmt::format("{}: is the scene; give the motion another name", out.string()));
    }
  }
  const Scene asked = with_timing(file.scene, options.timing);
  check_error_is_heeded(options.timing, {&options.configuration, 1});
  const int last = last_frame(asked, options.until);
  if (!options.quiet) tell_last_time(file, asked, options.until, last);
  // Before the work: what cannot be written is told at once.
  OutputFile bodies(options.out);
  std::optional<OutputFile> segments;
  if (options.segments) segments.emplace(*options.segments);
  const Fineness fineness = find_fineness(file, asked, last, options);
  const Scene scene = made_finer(asked, fineness.factor);
  Player player(file, scene, options.configuration);
  bodies.write("time_s,body,x_m,y_m,angle_rad,vx_m_s,vy_m_s,omega_rad_s\n");
  if (segments) {
    segments->write(
        "time_s,cable,segment,from_body,to_body,length_m,rest_length_m,tension_n,pinched,"
        "slipping\n");
  }
  Progress progress("simulating " + scene.name, "steps",
                    std::int64_t{last} * scene.steps_per_frame);
  if (!options.quiet) player.on_step([&progress] { progress.add(1); });
  player.give_up_after(options.time_limit);
  std::string rows;
  for (int frame = 0; frame <= last; ++frame) {
    player.advance_to(frame);
    rows.clear();
    add_bodies(player, rows);
    bodies.write(rows);
    if (segments) {
      rows.clear();
      add_segments(player, rows);
      segments->write(rows);
    }
  }
  bodies.finish();
  if (segments) {
    segments->finish();
  }
  progress.clear();
  if (options.quiet) return;
  tell_fineness(file.path.string(), fineness);
  std::vector<std::string> broken = player.broken_promises();
  add_missed_error(fineness, options.configuration, broken);
  tell_broken_promises(file.path.string(), broken);
}

}  // namespace pinchlab
