// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/first_tensions.h"

#include <algorithm>
#include <vector>

#include "base/at.h"
#include "sim/at_steps.h"
#include "sim/cable/cable.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/motion/impact.h"
#include "sim/motion/missed.h"
#include "sim/solve/active_set.h"
#include "sim/solve/forces.h"
#include "sim/solve/light_bodies.h"
#include "sim/solve/motors.h"
#include "sim/solve/passive.h"
#include "sim/solve/rows.h"
#include "sim/solve/solution.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// A first step whose nodes are steadied by other tensions is no error, only worse.
constexpr int most_trials = 10;

bool are_finite(const PartSystem& s) {
  return std::ranges::all_of(s.velocity, [](const Eigen::Vector3d& v) { return v.allFinite(); });
}

bool has_tensions(const Part& part) {
  return !part.asleep && part.cables_begin != part.cables_end;
}

bool is_moving(const World& world, const Parts& parts, const Part& part) {
  return std::ranges::any_of(bodies_of(parts, part), [&world](int b) {
    return at(world.velocity, b) != Vec2::Zero() || at(world.angular_velocity, b) != 0.0;
  });
}

/// The world with everything moved straight on for that long (s).
World moved_on(World world, double time) {
  for (std::size_t b = 0; b < world.bodies.size(); ++b) {
    world.position[b] += time * world.velocity[b];
    world.angle[b] += time * world.angular_velocity[b];
  }
  carry(world, world.carried);
  for (CableState& cable : world.cables) {
    for (Link& link : cable.links) link.material -= time * link.slip_speed;
    update_cable(world, cable, true, false);
  }
  for (Contact& contact : world.contacts) measure(world, contact);
  return world;
}

/// J v (m/s) of a part's rows.
std::vector<double> speeds_of_rows(const Scene& scene, const World& world, Workspace& work,
                                   const Part& part) {
  Stopwatch untimed(nullptr);
  PartSystem s;
  const TimeSpan t = whole_step(world);
  apply_forces(scene, world, t, work.parts, part, s);
  make_rows(scene, world, work.parts, part, t, s, work.solve, untimed);
  s.velocity.clear();
  for (const int b : bodies_of(work.parts, part)) {
    const Vec2& v = at(world.velocity, b);
    s.velocity.emplace_back(v.x(), v.y(), at(world.angular_velocity, b));
  }
  for (const SleevePlace& one : s.sleeves) s.velocity.push_back(velocity_of(world, one.sleeve));
  s.velocity.emplace_back(Eigen::Vector3d::Zero());
  std::vector<double> speeds;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    speeds.push_back(row_speed(s, r) - s.rows[r].bias);
  }
  return speeds;
}

/// The world just before and just after now.
struct Around {
  World before, after;
  double time = 0.0;  // s, from one to the other
};

Around around(const World& world) {
  constexpr double share = 1e-4;  // of a step: round-off and the next term leave some 1e-9
  const double time = share * world.step_length;
  return {moved_on(world, -0.5 * time), moved_on(world, 0.5 * time), time};
}

/// How a row's condition moves by itself.
struct RowMotion {
  double speed = 0.0;      // m/s, J v
  double curvature = 0.0;  // m/s^2, (dJ/dt) v
};

std::vector<RowMotion> motions_of(const Scene& scene, const Around& now, Workspace& work,
                                  const Part& part) {
  const std::vector<double> before = speeds_of_rows(scene, now.before, work, part);
  const std::vector<double> after = speeds_of_rows(scene, now.after, work, part);
  std::vector<RowMotion> motions;
  for (std::size_t r = 0; r < before.size(); ++r) {
    motions.push_back({0.5 * (before[r] + after[r]), (after[r] - before[r]) / now.time});
  }
  return motions;
}

/// Friction of bare surfaces has its own already (change_of_sliding), what stretches its length.
bool takes_curvature(const Row& row) {
  return row.compliance == 0.0 && is_exact_row(row);
}

/// As solve_again, with the rows' motions.
void solve_curved(const World& world, const Parts& parts, const Part& part, double kick,
                  const std::vector<RowMotion>& motions, PartSystem& s, SolveScratch& set) {
  for (std::size_t r = 0; r < motions.size(); ++r) {
    Row& row = s.rows[r];
    if (!takes_curvature(row)) continue;
    row.bias += kick * motions[r].curvature;
    row.curved += kick * motions[r].curvature;
  }
  solve_again(world, parts, part, s, set);
  // What slackens so slowly that forces undo it within the kick, as where velocities are decimal
  // figures, bears force: all of it, and not less what that takes.
  for (std::size_t r = 0; r < motions.size(); ++r) {
    Row& row = s.rows[r];
    if (row.on && takes_curvature(row)) row.bias -= motions[r].speed;
  }
  solve_again(world, parts, part, s, set);
}

/// As solve_steadily, of rows with these motions, if there are any.
void solve_in_motion(const Scene& scene, const World& world, Workspace& work, const Part& part,
                     const TimeSpan& t, const std::vector<RowMotion>& motions, PartSystem& s) {
  constexpr int most_turns = 3;  // each motor to its limit, back, and no third time
  Stopwatch untimed(nullptr);
  for (int turn = 0; turn < most_turns; ++turn) {
    solve_steadily(scene, world, work, part, t, turn == 0 ? most_motor_changes : 0, untimed);
    if (motions.empty()) return;
    solve_curved(world, work.parts, part, t.kick, motions, s, work.solve);
    if (!change_limited_motors(s)) return;
    s.free_velocity = s.unconstrained;
    drive(s);
  }
}

/// Tensions of a part at time 0, in the first system; of one that moves with its rows' motions. A
/// light body that is not held yet gives way and lowers them, so that it takes some
/// trials.
void find_tensions(const Scene& scene, World& world, Workspace& work, Part part,
                   const std::vector<RowMotion>& motions) {
  Stopwatch untimed(nullptr);
  part.system = 0;
  PartSystem& s = work.systems[0];
  forget(s);
  TimeSpan t = whole_step(world);
  t.clamps = locates_events(world.configuration);
  for (int trial = 0; trial < most_trials; ++trial) {
    apply_forces(scene, world, t, work.parts, part, s);
    if (trial > 0 && !steady_light_bodies(world, work.parts, part, t.kick, s)) return;
    if (locates_events(world.configuration)) {
      t.made_up = t.reach = s.reach;
      solve_in_motion(scene, world, work, part, t, motions, s);
    } else {
      solve_at_steps(scene, world, work, part, t, untimed);
    }
    if (!are_finite(s)) return;  // the first step will tell
    store_tensions(s, t.kick, world);
    if (!part.can_move) return;  // no body is light
  }
}

/// What a part starts with need not fit its cables: it meets them at once, as in the first step.
void strike_at_start(const Scene& scene, World& world, Workspace& work, Part part) {
  part.system = 0;
  forget(work.systems[0]);
  apply_forces(scene, world, TimeSpan{}, work.parts, part, work.systems[0]);
  strike(scene, world, work, part, true);
}

/// Of these parts, which move.
void find_tensions_of_moving(const Scene& scene, World& world, Workspace& work,
                             const std::vector<Part>& moving) {
  World struck = world;
  for (const Part& part : moving) strike_at_start(scene, struck, work, part);
  const Around now = around(struck);
  for (const Part& part : moving) {
    find_tensions(scene, struck, work, part, motions_of(scene, now, work, part));
    for (const int c : cables_of(work.parts, part)) {
      std::vector<Segment>& segments = at(world.cables, c).segments;
      for (std::size_t i = 0; i < segments.size(); ++i) {
        segments[i].tension = at(struck.cables, c).segments[i].tension;
      }
    }
  }
}

}  // namespace

void find_first_tensions(const Scene& scene, World& world, Workspace& work) {
  work.systems.resize(1);
  const bool curves = locates_events(world.configuration);
  std::vector<Part> moving;
  for (const Part& part : work.parts.list) {
    if (!has_tensions(part)) continue;
    if (curves && is_moving(world, work.parts, part)) {
      moving.push_back(part);
    } else {
      find_tensions(scene, world, work, part, {});
    }
  }
  if (!moving.empty()) find_tensions_of_moving(scene, world, work, moving);
}

}  // namespace pinchlab
