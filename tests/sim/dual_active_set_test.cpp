// SPDX-License-Identifier: GPL-3.0-or-later
// The dual method by itself: against all active sets, closed forms, and conditions that contradict.

#include "sim/solve/dual_active_set.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <cmath>
#include <optional>
#include <vector>

#include "sim/solve/part_system.h"
#include "tests/sim/random.h"

namespace pinchlab::testing {
namespace {

constexpr DualTerms repairing{1.0, 1e-13, true}, holding{1.0, 1e-13, false};

/// `bodies` that move as they like, and the world after them. Large enough that no way is too long
/// for its conditions.
PartSystem system_of(int bodies) {
  PartSystem s;
  s.mobility.resize(index(bodies) + 1);
  s.free_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
  s.velocity = s.free_velocity;
  s.extent = 1e6;
  s.reach = 0.0;
  return s;
}

void add_row(PartSystem& s, RowBodies bodies, double bias, RowKind kind = RowKind::segment) {
  const auto part = [&s](int body, const Eigen::Vector3d& j) {
    const Mobility& m = at(s.mobility, body);
    const Eigen::Matrix3d matrix{{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.angular}};
    return j.dot(matrix * j);
  };
  Row& row = s.rows.emplace_back();
  row.kind = kind;
  row.bias = bias;
  row.diagonal = part(bodies.a, bodies.ja) + part(bodies.b, bodies.jb);
  s.bodies.push_back(bodies);
}

RowBodies on_one(int body, const Eigen::Vector3d& j, int world) {
  RowBodies bodies;
  bodies.a = body;
  bodies.b = world;
  bodies.ja = j;
  bodies.jb = Eigen::Vector3d::Zero();
  return bodies;
}

/// J M^-1 J' and J v_free + bias.
struct Dense {
  Eigen::MatrixXd normals, a;
  Eigen::VectorXd b;
};

Dense dense_of(const PartSystem& s) {
  const auto rows = static_cast<Eigen::Index>(s.rows.size());
  const auto count = static_cast<Eigen::Index>(3 * s.mobility.size());
  Dense dense{Eigen::MatrixXd::Zero(rows, count), {}, Eigen::VectorXd(rows)};
  Eigen::MatrixXd mobility = Eigen::MatrixXd::Zero(count, count);
  for (Eigen::Index k = 0; 3 * k < count; ++k) {
    const Mobility& m = s.mobility[static_cast<std::size_t>(k)];
    mobility.block<3, 3>(3 * k, 3 * k) << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.angular;
  }
  for (Eigen::Index r = 0; r < rows; ++r) {
    const RowBodies& row = s.bodies[static_cast<std::size_t>(r)];
    dense.normals.block<1, 3>(r, 3 * row.a) += row.ja.transpose();
    dense.normals.block<1, 3>(r, 3 * row.b) += row.jb.transpose();
    dense.b(r) = s.rows[static_cast<std::size_t>(r)].bias + row.ja.dot(at(s.free_velocity, row.a)) +
                 row.jb.dot(at(s.free_velocity, row.b));
  }
  dense.a = dense.normals * mobility * dense.normals.transpose();
  return dense;
}

/// The impulses of the active set, of all there are, for which none is negative and nothing is
/// violated.
std::optional<Eigen::VectorXd> try_all_sets(const Dense& dense) {
  const auto rows = static_cast<int>(dense.b.size());
  for (int set = 0; set < 1 << rows; ++set) {
    std::vector<Eigen::Index> on;
    for (int r = 0; r < rows; ++r) {
      if ((set >> r) % 2 == 1) on.push_back(r);
    }
    Eigen::VectorXd p = Eigen::VectorXd::Zero(rows);
    if (!on.empty()) {
      const Eigen::MatrixXd a = dense.a(on, on);
      p(on) = -a.completeOrthogonalDecomposition().solve(dense.b(on));
    }
    const Eigen::VectorXd w = dense.a * p + dense.b;
    bool holds = p.minCoeff() >= -1e-9 && w.minCoeff() >= -1e-9;
    for (const Eigen::Index r : on) holds = holds && std::abs(w(r)) < 1e-9;
    if (holds) return p;
  }
  return std::nullopt;
}

/// Up to three bodies, of masses up to 1e3 apart, one of them on a rail or held by its axle, and up
/// to eight rows, some of them twice, which some velocity meets.
PartSystem random_system(Random& random) {
  const int bodies = 1 + random.below(3), rows = 1 + random.below(8);
  PartSystem s = system_of(bodies);
  std::vector<Eigen::Vector3d> allowed(s.mobility.size(), Eigen::Vector3d::Zero());
  const auto draw = [&random] {
    return Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
  };
  for (int b = 0; b < bodies; ++b) {
    Mobility& m = at(s.mobility, b);
    m.xx = m.yy = std::pow(10.0, random.uniform(-1.5, 1.5));
    m.angular = std::pow(10.0, random.uniform(-1.5, 1.5));
    const int kind = b > 0 ? random.below(3) : 0;
    if (kind == 1) m.xx = m.yy = 0.0;
    if (kind == 2) m.yy = 0.0;
    Eigen::Vector3d free = draw(), other = draw();
    if (m.xx == 0.0) free.x() = other.x() = 0.0;
    if (m.yy == 0.0) free.y() = other.y() = 0.0;
    at(s.free_velocity, b) = free;
    at(allowed, b) = other;
  }
  for (int r = 0; r < rows; ++r) {
    RowBodies row = on_one(random.below(bodies), draw(), bodies);
    if (random.below(2) == 0) row.b = random.below(bodies);
    if (row.b != bodies) row.jb = draw();
    if (r > 0 && random.below(5) == 0) row = s.bodies.back();
    const double speed = row.ja.dot(at(allowed, row.a)) + row.jb.dot(at(allowed, row.b));
    add_row(s, row, random.uniform(0.0, 0.5) - speed);
  }
  return s;
}

double kinetic_energy_of(const PartSystem& s, const std::vector<Eigen::Vector3d>& velocity) {
  double energy = 0.0;
  for (std::size_t b = 0; b < s.mobility.size(); ++b) {
    const Mobility& m = s.mobility[b];
    const Eigen::Vector3d inverse(m.xx, m.yy, m.angular);
    for (int k = 0; k < 3; ++k) {
      if (inverse[k] > 0.0) energy += 0.5 * velocity[b][k] * velocity[b][k] / inverse[k];
    }
  }
  return energy;
}

TEST(DualActiveSet, IsTheOneOfAllSetsThatHolds) {
  int bear = 0;
  for (unsigned seed = 0; seed < 2000; ++seed) {
    Random random(seed);
    PartSystem s = random_system(random);
    const Dense dense = dense_of(s);
    const std::optional<Eigen::VectorXd> expected = try_all_sets(dense);
    ASSERT_TRUE(expected) << seed;
    DualScratch scratch;
    double missed = 0.0;
    ASSERT_TRUE(solve_dual(s, scratch, repairing, missed)) << seed;
    EXPECT_LT(missed, 1e-9) << seed;
    // Velocities are unique; impulses need not be.
    Eigen::VectorXd p(dense.b.size());
    for (Eigen::Index r = 0; r < p.size(); ++r) {
      const Row& row = s.rows[static_cast<std::size_t>(r)];
      p(r) = row.impulse;
      EXPECT_GE(row.impulse, -1e-9) << seed;
      bear += row.impulse > 0.0 ? 1 : 0;
    }
    EXPECT_LT((dense.a * (p - *expected)).cwiseAbs().maxCoeff(), 1e-8) << seed;
    const double given = kinetic_energy_of(s, s.velocity) - kinetic_energy_of(s, s.free_velocity);
    EXPECT_NEAR(scratch.energy, given, 1e-9 * (1.0 + kinetic_energy_of(s, s.velocity))) << seed;
  }
  EXPECT_GT(bear, 2000);
}

// Without the biases of what is violated it is a projection, which only takes energy.
TEST(DualActiveSet, HoldingTakesEnergy) {
  for (unsigned seed = 0; seed < 500; ++seed) {
    Random random(seed);
    PartSystem s = random_system(random);
    for (Row& row : s.rows) row.bias = -std::abs(row.bias);
    DualScratch scratch;
    double missed = 0.0;
    ASSERT_TRUE(solve_dual(s, scratch, holding, missed)) << seed;
    EXPECT_LE(scratch.energy, 1e-12) << seed;
    for (std::size_t r = 0; r < s.rows.size(); ++r) {
      EXPECT_GT(row_speed(s, r) - s.rows[r].bias, -1e-10) << seed;
    }
  }
}

// A body on a span that is straight but for an angle a, both of whose halves hold it: it stops, by
// impulses m v / 2 a. J M^-1 J' has the condition 1 / a^2.
TEST(DualActiveSet, HoldsABodyUpOnASpanAsGoodAsStraight) {
  for (const double a : {1e-3, 1e-6, 1e-9}) {
    PartSystem s = system_of(1);
    s.mobility[0].xx = s.mobility[0].yy = 0.5;
    s.free_velocity[0] = {0.3, -1.0, 0.0};
    add_row(s, on_one(0, {1.0, a, 0.0}, 1), 0.0);
    add_row(s, on_one(0, {-1.0, a, 0.0}, 1), 0.0);
    DualScratch scratch;
    double missed = 0.0;
    ASSERT_TRUE(solve_dual(s, scratch, repairing, missed)) << a;
    EXPECT_LT(s.velocity[0].norm(), 1e-6) << a;
    const double sum = 2.0 / a, difference = -2.0 * 0.3;  // N s, of 2 kg
    EXPECT_NEAR(s.rows[0].impulse, 0.5 * (sum + difference), 1e-6 * sum) << a;
    EXPECT_NEAR(s.rows[1].impulse, 0.5 * (sum - difference), 1e-6 * sum) << a;
    EXPECT_NEAR(scratch.energy, -0.5 * 2.0 * 1.09, 1e-9) << a;
  }
}

// v >= 1 and v <= 0.5: one of the two is left out, and what it misses is told.
TEST(DualActiveSet, LeavesOutWhatContradicts) {
  PartSystem s = system_of(1);
  s.mobility[0].xx = s.mobility[0].yy = 1.0;
  add_row(s, on_one(0, {1.0, 0.0, 0.0}, 1), -1.0);
  add_row(s, on_one(0, {-1.0, 0.0, 0.0}, 1), 0.5);
  DualScratch scratch;
  double missed = 0.0;
  ASSERT_TRUE(solve_dual(s, scratch, repairing, missed));
  EXPECT_NEAR(missed, 0.5, 1e-12);
  EXPECT_NEAR(s.velocity[0].x(), 1.0, 1e-12);
  EXPECT_TRUE(scratch.skipped[1]);
}

// What is to be made up for on a way that bends its conditions by more than that is not.
TEST(DualActiveSet, LeavesOutBiasesThatAskForTooLongAWay) {
  for (const double extent : {1.0, 1e4}) {
    PartSystem s = system_of(1);
    s.extent = extent;
    s.mobility[0].xx = s.mobility[0].yy = 1.0;
    add_row(s, on_one(0, {0.0, 1e-3, 0.0}, 1), -1e-3);  // 1 m of way for 1 mm
    DualScratch scratch;
    double missed = 0.0;
    ASSERT_TRUE(solve_dual(s, scratch, repairing, missed));
    const bool follows = extent > 1e3;  // way^2 <= extent * 1 mm
    EXPECT_NEAR(s.velocity[0].y(), follows ? 1.0 : 0.0, 1e-12) << extent;
    EXPECT_NEAR(missed, follows ? 0.0 : 1e-3, 1e-15) << extent;
  }
}

// A clamped row pushes as well; an elastic one gives p = -(J v + bias) / (diagonal + compliance).
TEST(DualActiveSet, ClampedAndElasticRows) {
  PartSystem s = system_of(1);
  s.mobility[0].xx = s.mobility[0].yy = 0.25;
  s.free_velocity[0] = {2.0, -3.0, 0.0};
  add_row(s, on_one(0, {1.0, 0.0, 0.0}, 1), 0.0);
  s.rows[0].clamped = s.rows[0].on = true;
  add_row(s, on_one(0, {0.0, 1.0, 0.0}, 1), 0.0);
  s.rows[1].compliance = 0.5;
  DualScratch scratch;
  double missed = 0.0;
  ASSERT_TRUE(solve_dual(s, scratch, repairing, missed));
  EXPECT_NEAR(s.rows[0].impulse, -2.0 / 0.25, 1e-12);
  EXPECT_NEAR(s.velocity[0].x(), 0.0, 1e-12);
  EXPECT_NEAR(s.rows[1].impulse, 3.0 / 0.75, 1e-12);
  EXPECT_NEAR(s.velocity[0].y(), -3.0 + 0.25 * 4.0, 1e-12);
}

}  // namespace
}  // namespace pinchlab::testing
