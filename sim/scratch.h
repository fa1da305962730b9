// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Storage that the stages of a step reuse, so that a warm step allocates nothing.

#include <vector>

#include "sim/broad_phase.h"
#include "sim/capstan.h"
#include "sim/contact.h"
#include "sim/gauss_seidel.h"
#include "sim/parts.h"
#include "sim/profile_ldl.h"
#include "sim/profile_lu.h"
#include "sim/rows.h"
#include "sim/terms.h"

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
  Eigen::Vector3d j;  // (x, y, angle)
  int previous;       // in the chain, or -1
  int least;          // unknown of the chain
};

/// A change of state that the last solution asks for.
struct Flip {
  int row;  // or run, where is_run
  bool is_run;
  bool on;
  Slip slip;
};

struct ActiveSet {
  int part = 0;                     // being solved, of Parts::list
  int solves = 0;                   // of this part in this step so far
  CapstanScratch capstan;           // empty without finite friction on a cable
  std::vector<int> unknown_of_row;  // of rows that have one of their own, or -1
  std::vector<int> row_of_unknown;
  std::vector<int> impulse_begin, impulse_end;  // of each row's impulse, in impulse_terms
  std::vector<Term> impulse_terms;              // of unknowns
  std::vector<EquationTerm> equation_terms;     // of rows
  std::vector<BodyTerm> columns;                // unordered; columns_of_body lists them by body
  std::vector<BodyTerm> equations;
  Lists<BodyTerm> columns_of_body;
  std::vector<int> fill;
  std::vector<int> least_column, least_equation;  // least unknown that moves, or sees, each body
  std::vector<int> first;                         // profile
  std::vector<double> scale, right_side, solution, residual;
  bool symmetric = true;      // every unknown is one row's impulse
  std::vector<RowEnd> ends;   // two an unknown: what it does to its row's bodies
  std::vector<int> last_end;  // of each body of the part: the last of its chain, or -1
  std::vector<int> factored;  // rows whose unknowns ldl holds the factors for; empty: none
  ProfileLdl ldl;             // symmetric
  ProfileLu lu;               // otherwise
  std::vector<Flip> flips;
};

/// A body that has just left a cable.
struct Release {
  int cable, body;
};

/// What taut spans do to a body across themselves: h^2 times their stiffness, and that times their
/// other ends' velocities. By steady_light_bodies.
struct SpanMass {
  Eigen::Matrix2d mass = Eigen::Matrix2d::Zero();  // kg
  Vec2 momentum = Vec2::Zero();                    // kg m/s
  bool steadied = false;                           // the body's mobility is not its own
};

/// The order of a part's rows, for the bodies that they couple.
struct RowOrder {
  std::vector<int> structure, order;
};

/// What rows were made for: while it is the same, so are their bodies.
struct RowsMade {
  int part = -1, divisions = -1, changes = -1;  // of Parts::list; Parts; all cables
  double kick = 0.0;                            // s
  bool operator==(const RowsMade&) const = default;
};

struct Scratch {
  std::vector<Release> released;  // since update_segments
  bool spans_moved = true;        // any of them, by update_segments
  bool contacts_kept = false;     // all contacts are those of the step before, by find_contacts
  bool pinches_kept = false;      // and all pinches, by configure_pinches
  int configured_changes = -1;    // CableState::changes of all cables when pinches were configured
  BroadPhase broad_phase;
  std::vector<Contact> old_contacts;
  Lists<int> contacts_of_body;
  std::vector<int> fill;                           // cursors while Lists are made
  std::vector<Row> rows;                           // of the part being solved
  RowsMade rows_made;                              // what they are for
  bool rows_stand = false;                         // as made before, but for bias and compliance
  std::vector<Mobility> mobility;                  // one a body
  double mobility_kick = 0.0;                      // s, what they are for
  std::vector<SpanMass> span_masses;               // one a body; empty until one is too light
  std::vector<int> segment_begin, row_of_segment;  // of cable c, from segment_begin[c]; -1: none
  std::vector<int> normal_row_of_contact;          // of the part's contacts; -1: none
  std::vector<int> middle_row_of_contact;          // the first of its middle rows; -1: none
  bool has_friction_rows = false;                  // of contacts or pinch middles
  int first_contact_row = 0;                       // those before are of cables
  Parts parts;
  std::vector<int> order;                  // of the rows, by order_rows
  std::vector<RowOrder> orders;            // one a part
  std::vector<int> row_stamp, body_stamp;  // marks of order_rows

  Lists<int> rows_of_body;  // rows that a mobile body of the part couples
  ActiveSet active_set;
  SweepScratch sweeps;  // empty with the direct solver

  std::vector<Vec2> velocity_before;  // m/s, at the start of the step
  std::vector<double> angular_velocity_before;
  std::vector<Vec2> velocity_free;  // m/s, after forces, before constraints
  std::vector<double> angular_velocity_free;
};

}  // namespace pinchlab
