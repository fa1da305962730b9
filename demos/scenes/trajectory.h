// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Simulations as tables for other tools.

#include <filesystem>
#include <optional>

#include "demos/scenes/player.h"

namespace pinchlab {

struct TrajectoryOptions {
  Configuration configuration;
  Timing timing;
  std::optional<double> until;       ///< s, of the last row; default: the last frame's
  std::optional<double> time_limit;  ///< s of work, after which it is given up
  std::filesystem::path out;         ///< one row a body and frame; "-": standard output
  std::optional<std::filesystem::path> segments;  ///< one row a cable's segment and frame
  bool quiet = false;                             ///< tells nothing on standard error
};

/// Simulates a scene and writes what it did, numbers in the shortest form that reads back exactly:
///
///   time_s,body,x_m,y_m,angle_rad,vx_m_s,vy_m_s,omega_rad_s
///   time_s,cable,segment,from_body,to_body,length_m,rest_length_m,tension_n,pinched,slipping
///
/// Velocities are those at the time of the positions. Segments count from 0 along the cable;
/// tension is that of the step that led to the frame (0 at the start; on the two segments of length
/// 0 that meet at a body pressed onto a wrap, the change of tension that this body takes up);
/// pinched is 1 or 0; slipping is 1 where the cable runs forward over the body at the segment's
/// end, -1 backward, 0 where it sticks.
///
/// Throws std::invalid_argument for options that cannot be, std::runtime_error where the simulation
/// or a file fails; then nothing is written under the files' names.
void write_trajectory(const SceneFile& file, const TrajectoryOptions& options);

}  // namespace pinchlab
