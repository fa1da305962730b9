// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Dense>
#include <algorithm>

#include "sim/solve/profile_ldl.h"
#include "sim/solve/profile_lu.h"
#include "tests/sim/random.h"
#include "tests/sim/scenes.h"

namespace pinchlab::testing {
namespace {

/// A random matrix that is narrow about its diagonal, with a few full rows, diagonally dominant.
TEST(ProfileLu, AgreesWithDenseLu) {
  Random random(1);
  for (int n = 1; n < 60; n += 7) {
    std::vector<int> first(static_cast<std::size_t>(n));
    for (int u = 0; u < n; ++u)
      first[static_cast<std::size_t>(u)] = u % 11 == 10 ? 0 : std::max(0, u - u % 4);
    ProfileLu lu;
    lu.reset(first);
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(n, n);
    for (int u = 0; u < n; ++u) {
      for (int v = first[static_cast<std::size_t>(u)]; v <= u; ++v) {
        for (const auto& [i, j] : {std::pair(u, v), std::pair(v, u)}) {
          if (i == j && a(i, j) != 0.0) continue;
          const double value = random.uniform(-0.5, 0.5) + (i == j ? 20.0 : 0.0);
          a(i, j) += value;
          lu.add(i, j, value);
        }
      }
    }
    Eigen::VectorXd b = Eigen::VectorXd::LinSpaced(n, -1.0, 1.0);
    std::vector<double> x(b.data(), b.data() + n);
    EXPECT_EQ(lu.factor(std::vector<double>(static_cast<std::size_t>(n), 20.0), 0.0), 0);
    lu.solve(x);
    const Eigen::VectorXd exact = a.partialPivLu().solve(b);
    for (int u = 0; u < n; ++u) EXPECT_NEAR(x[static_cast<std::size_t>(u)], exact(u), 1e-13);
  }
}

TEST(ProfileLu, FindsRepeatedRows) {
  ProfileLu lu;
  lu.reset({0, 0, 0});
  const double a[3][3] = {{2, 1, 2}, {1, 3, 1}, {2, 1, 2}};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) lu.add(i, j, a[i][j]);
  }
  EXPECT_EQ(lu.factor({2, 3, 2}, 0.0), 1);
  std::vector<double> x{5, 5, 5};
  lu.solve(x);
  EXPECT_EQ(x[2], 0.0);
  EXPECT_NEAR(2 * x[0] + x[1], 5.0, 1e-14);
  EXPECT_NEAR(x[0] + 3 * x[1], 5.0, 1e-14);
}

// One profile that is wider by a zero keeps a tridiagonal matrix off its shorter way: rows that
// nothing couples, and one that repeats another, too.
TEST(ProfileLdl, ATridiagonalMatrixHasTheBitsOfAWiderOne) {
  constexpr int n = 40, repeated = 21;
  Random random(1);
  ProfileLdl narrow, wide;
  narrow.clear();
  wide.clear();
  std::vector<double> scale(n), x(n);
  for (int u = 0; u < n; ++u) {
    const bool alike = u == repeated || u == repeated - 1;
    const int first = u == 0 || u % 7 == 6 ? u : u - 1;
    scale[index(u)] = alike ? 1.0 : random.uniform(2.0, 4.0);
    x[index(u)] = random.uniform(-1.0, 1.0);
    double* entries = narrow.append(first);
    double* wider = wide.append(u == n - 1 ? u - 2 : first);
    if (first < u) entries[u - 1] = wider[u - 1] = alike ? 1.0 : random.uniform(-1.0, 1.0);
  }
  std::vector<double> y = x;
  EXPECT_EQ(narrow.factor(scale, 0.0), 1);
  EXPECT_EQ(wide.factor(scale, 0.0), 1);
  narrow.solve(x);
  wide.solve(y);
  EXPECT_EQ(x, y);
}

// Rows of many cables to one body: all but three repeat others, wherever they come.
TEST(ProfileLdl, LeavesOutRowsThatRepeatOthers) {
  constexpr int count = 60;
  Random random(1);
  Eigen::MatrixXd rows(count, 3);
  for (int u = 0; u < count; ++u) {
    for (int k = 0; k < 3; ++k) rows(u, k) = random.uniform(-1.0, 1.0);
    if (u == 1 || u == 2 || u == 4) rows.row(u) = 2.0 * rows.row(0);
  }
  const Eigen::MatrixXd dense = rows * rows.transpose();
  const Eigen::VectorXd right_side = dense * Eigen::VectorXd::Ones(count);
  ProfileLdl ldl;
  std::vector<double> scale;
  for (int u = 0; u < count; ++u) {
    double* entries = ldl.append(0);
    for (int v = 0; v < u; ++v) entries[v] = dense(u, v);
    scale.push_back(dense(u, u));
  }
  EXPECT_EQ(ldl.factor(scale, 0.0), count - 3);
  std::vector<double> x(right_side.begin(), right_side.end());
  ldl.solve(x);
  EXPECT_EQ(std::count(x.begin(), x.end(), 0.0), count - 3);
  for (const std::size_t u : {0, 3, 5}) EXPECT_NE(x[u], 0.0) << u;
  const Eigen::Map<const Eigen::VectorXd> solution(x.data(), count);
  EXPECT_LT((dense * solution - right_side).cwiseAbs().maxCoeff(), 1e-11);
}

// A row of bodies in touch is struck at its end: without friction all move on as one, however many.
TEST(Solver, ABlowRunsThroughALongRow) {
  for (const int count : {3, 30, 1000}) {
    Scene scene;
    for (int i = 0; i < count; ++i) {
      scene.bodies.push_back(body("", BodyKind::free, 0.2 * i, 0.1, 0.1, 1.0));
      scene.bodies.back().contact_friction = 0.0;
    }
    scene.bodies.front().velocity = {1.0, 0.0};
    scene.walls.push_back({Vec2(-5.0, 0.0), Vec2(0.2 * count + 5.0, 0.0), 0.0, 0.0});
    World world = make_world(scene, Method::pinch);
    run(scene, world, 1);
    EXPECT_EQ(world.diagnostics.fallbacks, 0) << count;
    double worst = 0.0;
    for (const Vec2& v : world.velocity) worst = std::max(worst, std::abs(v.x() - 1.0 / count));
    const double round_off = 1e-15 * 0.2 * count / world.step_length;  // of places, in a step
    EXPECT_LT(worst, round_off + 1e-14) << count;
  }
}

TEST(Solver, AnUnusedFeatureIsNotOnTheStepsPath) {
  // No finite friction: nothing of the capstan law is set up. Bodies far apart: no contact, no
  // pinch.
  Scene scene = load_chain(21, 3.0, 2.0, 1.0);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int i = 0; i < 10; ++i) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  EXPECT_TRUE(work.solve.capstan.runs.empty());
  EXPECT_TRUE(work.solve.capstan.passages.empty());
  EXPECT_TRUE(world.contacts.empty());
  EXPECT_EQ(work.contacts.contacts_of_body.begin.size(), 0u) << "the search for pinches never ran";
}

// A disc hits a row of others: the step is divided, and each interval's solves are counted once.
TEST(Solver, EachIntervalCountsItsOwnSolves) {
  Scene scene;
  scene.steps_per_frame = 1;
  scene.walls.push_back({Vec2(-1.0, 0.0), Vec2(20.0, 0.0), 0.0, 0.0});
  for (int i = 0; i < 12; ++i) {
    scene.bodies.push_back(
        body(fmt::format("disc {}", i), BodyKind::free, 0.5 + 0.2 * i, 0.1, 0.1, 1.0));
  }
  scene.bodies.push_back(body("striker", BodyKind::free, 0.28, 0.1, 0.1, 1.0));
  scene.bodies.back().velocity = {2.0, 0.0};
  World world = make_world(scene, Method::pinch);
  Workspace work;
  const Diagnostics& d = world.diagnostics;
  bool divided = false;
  for (int i = 0; i < 8; ++i) {
    const std::int64_t solves = d.total_solves, intervals = d.intervals;
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
    divided = divided || d.intervals - intervals > 1;
    EXPECT_GE(d.total_solves - solves, d.active_set_solves + d.intervals - intervals - 1);
    EXPECT_LE(d.total_solves - solves, d.active_set_solves * (d.intervals - intervals));
    if (d.intervals - intervals == 3) {
      EXPECT_LT(d.total_solves - solves, 2 * d.active_set_solves);
    }
  }
  EXPECT_TRUE(divided);
}

TEST(Solver, ARestingSceneOnlyCountsItsSteps) {
  Scene scene = load_chain(3, 2.0, 2.0, 1.0);
  World world = make_world(scene, Method::pinch);
  run(scene, world, 240);
  const std::int64_t solves = world.diagnostics.total_solves;
  const Vec2 position = world.position[0];
  run(scene, world, 240);
  EXPECT_EQ(world.diagnostics.total_solves, solves);
  EXPECT_EQ(world.diagnostics.active_set_solves, 0);
  EXPECT_EQ(world.position[0], position);
  EXPECT_NEAR(world.time(), 2.0, 1e-12);
}

TEST(Solver, StagesAreTimedOnRequest) {
  Scene scene = load_chain(21, 3.0, 2.0, 1.0);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  StageTimes times;
  for (int i = 0; i < 50; ++i) step(scene, world, work, &times);
  for (std::size_t stage = 0; stage < times.seconds.size(); ++stage) {
    EXPECT_GT(times.seconds[stage], 0.0) << to_string(static_cast<Stage>(stage));
  }
}

}  // namespace
}  // namespace pinchlab::testing
