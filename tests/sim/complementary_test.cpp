// SPDX-License-Identifier: GPL-3.0-or-later
// All states of a part at once: the same as guesses of them come to, where these settle.

#include "sim/solve/complementary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "sim/solve/active_set.h"
#include "sim/solve/forces.h"
#include "sim/solve/rows.h"
#include "sim/solve/rubbing.h"
#include "sim/workspace.h"
#include "tests/sim/random_scene.h"

namespace pinchlab::testing {
namespace {

/// Solves a part for the next step by guesses of its states; whether they settled.
bool solve_by_guesses(const Scene& scene, const World& world, const Part& part, Workspace& work) {
  PartSystem& s = at(work.systems, part.system);
  TimeSpan t;
  t.start = world.time();
  t.length = t.repair = t.kick = world.step_length;
  t.clamps = true;
  apply_forces(scene, world, t, work.parts, part, s);
  t.made_up = t.reach = s.reach;
  Stopwatch untimed(nullptr);
  make_rows(scene, world, work.parts, part, t, s, work.solve, untimed);
  return solve_direct(world, work.parts, part, s, work.solve);
}

/// Whether what bears force, and what slides, is bounded and complementary in the solution.
void expect_conditions(const PartSystem& s, const SolveScratch& set, const std::string& where) {
  double greatest = 0.0, fastest = 0.0, stiffest = 0.0;
  for (const Row& row : s.rows) {
    greatest = std::max(greatest, std::abs(row.impulse));
    stiffest = std::max(stiffest, row.diagonal);
  }
  for (const Row& row : s.rows) {
    if (!row.idle) fastest = std::max(fastest, std::abs(row.speed));
  }
  const double round_off = s.reach / set.step_length;  // m/s
  const double little = 1e-8 * greatest + round_off / stiffest, slow = 1e-8 * fastest + round_off;
  for (const Row& row : s.rows) {
    if (is_unilateral(row)) {
      EXPECT_GE(row.impulse, -little) << where;
    }
    if (row.kind == RowKind::normal && !row.idle && row.diagonal > 0.0) {
      EXPECT_GE(row.speed, -slow) << where;
      if (row.impulse > little) {
        EXPECT_LE(row.speed, slow) << where;
      }
    }
    if (row.kind != RowKind::tangent || !row.on) continue;
    const Friction& friction = at(s.frictions, row.friction);
    if (friction.bound == infinity) continue;
    const double most = friction.bound * at(s.rows, friction.normal).impulse;
    EXPECT_LE(std::abs(row.impulse), most + little) << where;
    if (std::abs(row.impulse) >= most - little || friction.run >= 0) continue;
    EXPECT_LE(std::abs(row.speed), slow) << where;
  }
  for (const SleevePlace& one : s.sleeves) {
    if (one.rub < 0) continue;
    const Row& row = at(s.rows, one.rub);
    const Bounds bounds = bounds_of_rubbing(s, row);
    EXPECT_LE(row.impulse, bounds.most + little) << where;
    EXPECT_GE(row.impulse, bounds.least - little) << where;
    if (row.speed > slow) {
      EXPECT_LE(row.impulse, bounds.least + little) << where;
    }
    if (row.speed < -slow) {
      EXPECT_GE(row.impulse, bounds.most - little) << where;
    }
  }
  for (const Run& run : set.capstan.runs) {
    if (run.passages_begin == run.passages_end) continue;
    double most = at(s.rows, run.row_in).impulse, least = most;
    for (int k = run.passages_begin; k < run.passages_end; ++k) {
      const Passage& passage = at(set.capstan.passages, k);
      const auto impulse = [&s](int r) { return r >= 0 ? at(s.rows, r).impulse : 0.0; };
      const double pressed = impulse(passage.normal), middle = impulse(passage.middle);
      most = tension_after(passage, 1, most, pressed, middle);
      least = tension_after(passage, -1, least, pressed, middle);
    }
    const double after = at(s.rows, run.row_out).impulse;
    EXPECT_LE(after, most + little) << where;
    EXPECT_GE(after, least - little) << where;
    if (run.speed > slow) {
      EXPECT_GE(after, most - little) << where;
    }
    if (run.speed < -slow) {
      EXPECT_LE(after, least + little) << where;
    }
  }
}

struct Found {
  int asked = 0, solved = 0, other = 0;
};

/// Asks for all states at once where guesses of them have settled, on the way of random scenes.
Found find_again(bool heavy) {
  Found found;
  for (int seed = 1; seed <= 60; ++seed) {
    Scene scene = random_scene(seed);
    if (heavy) {
      for (Cable& cable : scene.cables) cable.mass_per_metre = 0.02 * seed;
    }
    World world = make_world(scene, Method::pinch);
    Workspace work;
    for (int i = 0; i < 480; ++i) {
      if (step(scene, world, work) != StepStatus::ok) ADD_FAILURE() << world.failure;
      if (i % 12 != 0) continue;
      World now = world;
      Workspace trial;
      step(scene, now, trial);  // finds its parts
      for (const Part& part : trial.parts.list) {
        if (part.asleep || !has_contacts(part)) continue;
        PartSystem& s = at(trial.systems, part.system);
        if (!solve_by_guesses(scene, now, part, trial) || s.rows.empty()) continue;
        const std::vector<Eigen::Vector3d> guessed = s.velocity;
        ++found.asked;
        if (!solve_complementary(s, trial.solve) || trial.solve.left_out) continue;
        ++found.solved;
        expect_conditions(s, trial.solve, fmt::format("seed {}, step {}", seed, i));
        double apart = 0.0, fastest = 0.0;
        for (std::size_t b = 0; b < guessed.size(); ++b) {
          apart = std::max(apart, (guessed[b] - s.velocity[b]).cwiseAbs().maxCoeff());
          fastest = std::max(fastest, guessed[b].cwiseAbs().maxCoeff());
        }
        found.other += apart > 1e-7 * fastest + 1e-9 ? 1 : 0;
      }
    }
  }
  return found;
}

TEST(Complementary, FindsWhatGuessesSettleOn) {
  const Found found = find_again(false);
  EXPECT_GT(found.asked, 1000);
  // Cable that is pushed on to an arc has another law.
  EXPECT_GE(found.solved, found.asked - found.asked / 100);
  EXPECT_LE(found.other, found.asked / 100);  // friction may leave a choice
}

TEST(Complementary, FindsHowRopesWithMassSlip) {
  const Found found = find_again(true);
  EXPECT_GT(found.asked, 1000);
  EXPECT_GE(found.solved, found.asked - found.asked / 20);  // a rope that does not press has others
  EXPECT_LE(found.other, found.asked / 100);
}

}  // namespace
}  // namespace pinchlab::testing
