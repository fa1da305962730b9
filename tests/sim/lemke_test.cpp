// SPDX-License-Identifier: GPL-3.0-or-later
// Lemke's method by itself: its conditions on problems that have a solution, and those that have
// none.

#include "sim/solve/lemke.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>

#include "tests/sim/random.h"

namespace pinchlab::testing {
namespace {

Complementarity problem_of(const Eigen::MatrixXd& m, const Eigen::VectorXd& q) {
  Complementarity problem;
  problem.begin(static_cast<int>(q.size()));
  for (int i = 0; i < problem.size; ++i) {
    at(problem.q, i) = q(i);
    for (int k = 0; k < problem.size; ++k) problem.entry(i, k) = m(i, k);
  }
  return problem;
}

/// Of M = A A' + laws and q = A v, to more digits than doubles have: what repeats or contradicts
/// itself would not do so exactly.
Complementarity problem_of(const Eigen::MatrixXd& a, const Eigen::MatrixXd& laws,
                           const Eigen::VectorXd& v) {
  Complementarity problem = problem_of(laws, Eigen::VectorXd::Zero(a.rows()));
  for (int i = 0; i < problem.size; ++i) {
    for (int m = 0; m < a.cols(); ++m) {
      at(problem.q, i) += Extended(a(i, m)) * v(m);
      for (int k = 0; k < problem.size; ++k) problem.entry(i, k) += Extended(a(i, m)) * a(k, m);
    }
  }
  return problem;
}

bool solve(Complementarity& problem, Numbers numbers = Numbers::extended) {
  if (!find_bearing(problem, numbers)) return false;
  solve_for_bearing(problem, problem.yielding);
  return true;
}

Eigen::VectorXd solution_of(const Complementarity& problem) {
  Eigen::VectorXd z(problem.size);
  for (int i = 0; i < problem.size; ++i) z(i) = static_cast<double>(at(problem.z, i));
  return z;
}

/// By how much a solution misses its conditions at most, over the largest of its numbers.
double missing(const Complementarity& problem, const Eigen::MatrixXd& m, const Eigen::VectorXd& q) {
  const Eigen::VectorXd z = solution_of(problem);
  const Eigen::VectorXd w = m * z + q;
  const double size =
      std::max({1.0, z.cwiseAbs().maxCoeff(), (m.cwiseAbs() * z.cwiseAbs()).maxCoeff()});
  double worst = 0.0;
  for (int i = 0; i < problem.size; ++i) {
    const bool either = at(problem.either, i) != 0;
    worst = std::max(worst, either ? std::abs(w(i)) : -w(i));
    if (!either) worst = std::max({worst, -z(i), std::min(std::abs(z(i)), std::abs(w(i)))});
  }
  return worst / size;
}

Eigen::MatrixXd random_matrix(Random& random, int rows, int columns) {
  Eigen::MatrixXd m(rows, columns);
  for (int i = 0; i < rows; ++i) {
    for (int k = 0; k < columns; ++k) m(i, k) = random.uniform(-1.0, 1.0);
  }
  return m;
}

TEST(Lemke, SolvesWhatIsPositiveDefinite) {
  Random random(1);
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 1 + random.below(12);
    const Eigen::MatrixXd j = random_matrix(random, n, n + 2);
    const Eigen::MatrixXd m = j * j.transpose();
    const Eigen::VectorXd q = random_matrix(random, n, 1);
    Complementarity problem = problem_of(m, q);
    for (int i = 0; i < n; ++i) at(problem.either, i) = random.below(4) == 0;
    ASSERT_TRUE(solve(problem)) << trial;
    EXPECT_LT(missing(problem, m, q), 1e-9) << trial;
    const std::vector<char> bears = problem.bears;  // the only solution
    ASSERT_TRUE(solve(problem, Numbers::doubles)) << trial;
    EXPECT_EQ(problem.bears, bears) << trial;
  }
}

// Contacts with friction and runs with a capstan's law on directions that may repeat one another:
// copositive. Velocities that may stop solve them.
TEST(Lemke, SolvesFriction) {
  Random random(2);
  int by_doubles = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const int contacts = 1 + random.below(4), spans = random.below(5);
    const int n = 4 * contacts + spans + 2 * std::max(spans - 1, 0);
    const int movements = 1 + random.below(8);  // fewer than rows: they repeat one another
    const Eigen::MatrixXd j = random_matrix(random, 2 * contacts + spans, movements);
    const Eigen::VectorXd free = random_matrix(random, movements, 1);
    // Of each row's impulse its unknowns, with their signs.
    Eigen::MatrixXd shares = Eigen::MatrixXd::Zero(2 * contacts + spans, n);
    Eigen::MatrixXd laws = Eigen::MatrixXd::Zero(n, n);
    for (int c = 0; c < contacts; ++c) {
      const int normal = 4 * c, along = 4 * c + 1, against = 4 * c + 2, sliding = 4 * c + 3;
      const int press = 2 * c, rub = press + 1;
      shares(press, normal) = shares(rub, along) = 1.0;
      shares(rub, against) = -1.0;
      laws(along, sliding) = laws(against, sliding) = 1.0;
      laws(sliding, along) = laws(sliding, against) = -1.0;
      laws(sliding, normal) = random.uniform(0.0, 1.5);
    }
    const int first = 4 * contacts;
    for (int k = 0; k < spans; ++k) shares(2 * contacts + k, first + k) = 1.0;
    for (int k = 0; k + 1 < spans; ++k) {
      const int in = first + k, out = in + 1, forward = first + spans + 2 * k;
      const int backward = forward + 1;
      const double factor = random.below(3) == 0 ? 1.0 : random.uniform(1.0, 5.0);
      laws(in, forward) = laws(out, backward) = -1.0;
      laws(out, forward) = laws(in, backward) = 1.0;
      laws(forward, in) = factor;
      laws(forward, out) = laws(backward, in) = -1.0;
      laws(backward, out) = 1.0;
      laws(backward, in) = -1.0 / factor;
    }
    const Eigen::MatrixXd a = shares.transpose() * j, m = a * a.transpose() + laws;
    const Eigen::VectorXd q = a * free;
    Complementarity problem = problem_of(a, laws, free);
    problem.yielding = 1e-12;  // of many solutions it has one
    ASSERT_TRUE(solve(problem)) << trial;
    EXPECT_LT(missing(problem, m, q), 1e-9) << trial;
    // Of the same problem doubles may find another solution, or none.
    if (solve(problem, Numbers::doubles) && missing(problem, m, q) < 1e-9) ++by_doubles;
  }
  EXPECT_GT(by_doubles, 950);
}

// Numbers of few kinds, so that nearly every choice of a pivot is a tie.
TEST(Lemke, DoesNotCircleWhereAllTies) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const int n = 2 + random.below(9);
    Eigen::MatrixXd j(n, 3);
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < 3; ++k) j(i, k) = random.below(3) - 1;
    }
    Eigen::VectorXd free(3);
    for (int k = 0; k < 3; ++k) free(k) = random.below(3) - 1;
    const Eigen::MatrixXd m = j * j.transpose();
    const Eigen::VectorXd q = j * free;
    Complementarity problem = problem_of(m, q);
    for (const Numbers numbers : {Numbers::doubles, Numbers::extended}) {
      ASSERT_TRUE(solve(problem, numbers)) << trial;
      EXPECT_LT(missing(problem, m, q), 1e-12) << trial;
    }
  }
}

TEST(Lemke, TellsThatThereIsNoSolution) {
  Complementarity immovable = problem_of(Eigen::MatrixXd::Zero(1, 1), Eigen::VectorXd{{-1.0}});
  EXPECT_FALSE(solve(immovable));
  // Two rows that ask for opposite ways of one body.
  Complementarity squeezed =
      problem_of(Eigen::MatrixXd{{1.0, -1.0}, {-1.0, 1.0}}, Eigen::VectorXd{{-1.0, -1.0}});
  EXPECT_FALSE(solve(squeezed));
}

// A body in a span that bends by so small an angle that its square is lost beside 1: two rows that
// pull it along the span, opposite to one another but for the angle, and what presses it across.
TEST(Lemke, TellsWhatHardlyBendsFromWhatIsStraight) {
  for (const double angle : {1e-3, 1e-5, 1e-7, 1e-8}) {
    const Extended across = angle;
    Complementarity problem;
    problem.begin(2);
    problem.entry(0, 0) = problem.entry(1, 1) = Extended(1.0) + across * across;
    problem.entry(0, 1) = problem.entry(1, 0) = across * across - 1.0;
    problem.q = {-across, -across};  // its speed across, 1, seen by both rows
    ASSERT_TRUE(solve(problem)) << angle;
    // Both bear 1 / 2 angle, which takes all of its speed.
    for (const Extended& z : problem.z) {
      EXPECT_NEAR(static_cast<double>(2.0 * across * z), 1.0, 1e-7) << angle;
    }
  }
}

}  // namespace
}  // namespace pinchlab::testing
