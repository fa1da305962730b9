// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Storage of the direct solve, for the part being solved. Nothing of it outlives the solve.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "sim/solve/capstan.h"
#include "sim/solve/dual_active_set.h"
#include "sim/solve/lemke.h"
#include "sim/solve/profile_lu.h"
#include "sim/solve/terms.h"

namespace pinchlab {

/// What an unknown does to a body (a column of the system), or what its equation sees of one (a
/// row).
struct BodyTerm {
  int unknown;
  int body;
  Eigen::Vector3d vector;
};

/// One end of an unknown's row, in the chain of those on one body.
struct RowEnd {
  int previous;  // in the chain, or -1
  int least;     // unknown of the chain
};

/// A change of state that the last solution asks for.
struct Flip {
  int row;  // or run, where is_run
  bool is_run;
  bool on;
  Slip slip;
};

/// Storage of order_rows, which writes all of it.
struct OrderScratch {
  Lists<int> rows_of_body;                 // that mobile bodies couple
  std::vector<int> fill;                   // cursor of rows_of_body while it is made
  std::vector<int> row_stamp, body_stamp;  // of each, the last search that has come to it
};

/// What an unknown of solve_complementary is, or the sliding speed that it is.
enum class Unknown : std::int8_t {
  unilateral,        // an impulse, of a segment or a normal
  either,            // of what bears force both ways
  friction,          // bounded, one way; the next two follow
  friction_against,  // likewise, the other way
  rubbing,           // a sleeve's; forward and backward follow
  sliding,           // m/s, one way or the other
  forward,           // m/s, of a run; the next follows
  backward,
};

/// Velocity of a body, to more digits than it is kept with.
struct ExtendedVelocity {
  Extended x, y, turning;  // m/s, m/s, rad/s
};

/// Storage of solve_complementary, which writes all of it.
struct ComplementaryScratch {
  Complementarity problem;
  std::vector<Unknown> kinds;
  std::vector<double> units;       // u of each unknown: complementary.cpp,
  double impulse_unit = 1.0;       // and g
  std::vector<int> column_of_row;  // its first unknown, or -1
  std::vector<char> beside_run;    // rows: a run that may slide is
  std::vector<int> rows, runs;     // that take part
  std::vector<double> ways;  // rows: 1, or -1 where the first unknown of friction is against it
  std::vector<int> column_of_run;  // its first unknown, or -1
  std::vector<Extended> impulses;  // of rows
  std::vector<Extended> speeds;    // of rows: w + compliance p
  std::vector<ExtendedVelocity> velocities;
  std::vector<Extended> w;  // of each unknown
  std::vector<Term> limit;
};

struct SolveScratch {
  int solves = 0;            // of this part in this step so far
  bool froze = false;        // the states did not settle by themselves
  bool left_out = false;     // rows contradict others, and are left out
  bool contradicts = false;  // rows that bear force do one another, as settle leaves them
  bool by_dual = false;      // the last solution is that of solve_dual
  bool swept = false;        // the last solution is that of sweep_rows: nothing slides
  bool repairs = true;       // DualTerms::repairs
  bool direct = false;       // the last solution is that of a regular symmetric system,
  double missing = 0.0;      // m/s, whose equations it misses by so much at most,
  double fastest = 0.0;      // m/s, and that lets no other row go faster, either way, that does not
                             // stretch
  bool suspicious = false;   // a row may contradict the last solution
  bool smooth = false;       // friction that slides is left out; what sticks for good does
  bool held = false;         // nothing slides but what has no friction
  double step_length = 0.0;  // s, by which round-off of positions becomes speed
  double reach = infinity;   // m, TimeSpan::reach
  CapstanScratch capstan;    // empty without finite friction on a cable
  std::vector<int> middle_row_of_contact;  // the first of its middle rows; -1: none. Storage of
                                           // find_repeated_middles
  std::vector<int> normal_row_of_contact;  // of the part's contacts; -1: none. By make_rows

  // Unknowns and their equations; by solve_for_states, terms of what slides by capstan.cpp and
  // rubbing.cpp.
  std::vector<int> unknown_of_row;  // of rows that have one of their own, or -1
  std::vector<int> row_of_unknown;
  bool symmetric = true;                        // every unknown is one row's impulse
  std::vector<int> impulse_begin, impulse_end;  // of each row's impulse, in impulse_terms
  std::vector<Term> impulse_terms;              // of unknowns
  std::vector<EquationTerm> equation_terms;     // of rows
  std::vector<BodyTerm> columns;                // unordered; columns_of_body lists them by body
  std::vector<BodyTerm> equations;              // one unknown after another
  std::vector<int> last_equation;               // of each body of the part: its last term, or -1
  Lists<BodyTerm> columns_of_body;
  std::vector<int> fill;
  std::vector<int> least_column, least_equation;  // least unknown that moves, or sees, each body
  std::vector<int> first;                         // profile
  std::vector<double> right_side, solution, residual;
  // Of a symmetric system; by symmetric.cpp.
  std::vector<RowEnd> ends;   // two an unknown: what it does to its row's bodies
  std::vector<int> last_end;  // of each body of the part: the last of its chain, or -1
  ProfileLu lu;
  std::vector<Term> rubbing;  // of unknowns: an impulse while it is expressed, by express_rubbing
  std::vector<Term> friction_terms;  // of rows, by list_friction
  std::vector<Flip> flips;  // by the checks after each solve: check, check_runs, check_rubbing
  OrderScratch ordering;
  DualScratch dual;
  ComplementaryScratch complementary;
  std::vector<int> root_of_row;     // rows, then places: disjoint sets, by join_rows (motors.cpp)
  std::vector<char> pulling;        // of them, at a motor's body; by find_pulling
  std::vector<double> bounds;       // of frictions, before they are made anew; by bounds_stand
  std::vector<double> repaired_by;  // kg m, of the rows in a repair so far; by repair
};

}  // namespace pinchlab
