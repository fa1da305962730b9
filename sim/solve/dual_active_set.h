// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The rows of a part where nothing slides, solved as what they are then: of all velocities that
// they allow, those that differ least from the free ones in kinetic energy,
//     min 1/2 (v - v_free)' M (v - v_free),   J v + bias >= 0, or = 0 of rows that hold both ways.
// By Goldfarb and Idnani's dual method (A numerically stable dual method for solving strictly
// convex quadratic programs, Math. Programming 27, 1983): constraints come in one after another,
// those whose impulse would turn negative go again, and the energy rises each time, so that it
// ends. It works on an orthogonal basis of M^-1/2 J' itself. Factors of J M^-1 J' square its
// condition: of a cable that is held at both ends and has a body on a span as good as straight, at
// an angle of 1e-6 to it, they keep no digit of what holds the body up.
//
// Slower than a guess of the states that is right, which it is not for: it is what solve_direct
// falls back on (active_set.h).

#include <vector>

namespace pinchlab {

struct PartSystem;

/// Storage of solve_dual, which writes all of it. Others read of it then: way, energy and what is
/// skipped or unbiased.
struct DualScratch {
  int dimension = 0;
  double step_length = 0.0;         // s, by which what rows have missed becomes their biases
  std::vector<double> roots;        // Q of mobilities Q'Q, 9 a body
  std::vector<double> normals;      // M^-1/2 J', one row after another
  std::vector<double> norms;        // of these
  std::vector<double> basis;        // orthonormal, of the active rows' normals
  std::vector<double> triangle;     // their coordinates in it, one row after another
  std::vector<double> way;          // M^1/2 (v - v_free)
  std::vector<double> rest, part;   // of a normal: across the basis, and its coordinates
  std::vector<double> multipliers;  // impulses
  std::vector<int> active;
  std::vector<char> skipped;   // rows that contradict others
  std::vector<char> unbiased;  // and those whose bias is left out
  std::vector<double> levers;  // m, of bodies
  std::vector<double> way_unbiased, way_at_entry, multipliers_at_entry;
  std::vector<int> active_before, active_at_entry;
  double energy = 0.0;  // J, that the rows have given
};

struct DualTerms {
  double step_length;  // s, by which what positions have missed has become biases
  double tolerance;    // m/s, of speeds
  bool repairs;        // biases are followed; else nothing violates its condition any further
};

/// Finds impulses, velocities and which unilateral rows bear a force; friction and what else holds
/// both ways bears what it needs, if it is `on`. What contradicts other rows is left out. So are
/// biases that ask for a way so long that the conditions bend on it by more than is made up for:
/// (way / extent)^2 extent; where a cable that cannot give is all but straight, next to nothing is
/// far too much. `missed` (m/s): the most of all that. Whether it has ended.
bool solve_dual(PartSystem& system, DualScratch& scratch, const DualTerms& terms, double& missed);

}  // namespace pinchlab
