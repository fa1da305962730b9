// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The system of one part: its bodies, rows, their order and their factors. It belongs to the part,
// so that what stands of it stands whatever other parts do.

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "base/at.h"
#include "sim/cable/mass.h"
#include "sim/contact.h"
#include "sim/scene.h"
#include "sim/solve/profile_ldl.h"
#include "sim/solve/terms.h"

namespace pinchlab {

/// Inverse mass and inertia of a body in this step, drag included: dv = mobility * impulse.
struct Mobility {
  double xx = 0.0, xy = 0.0, yy = 0.0;  // 1/kg, symmetric: a rail body moves along its axis only
  double angular = 0.0;                 // 1/(kg m^2)
  double xz = 0.0, yz = 0.0;            // 1/(kg m), of a body that carries cables with mass

  Eigen::Vector3d operator*(const Eigen::Vector3d& j) const {
    return {xx * j.x() + xy * j.y() + xz * j.z(), xy * j.x() + yy * j.y() + yz * j.z(),
            xz * j.x() + yz * j.y() + angular * j.z()};
  }
};

/// What drag takes in a kick, of the velocities before and after it:
///     (1 + after) v' = (1 - before) v + ...
/// With `taken` = c k it is the mean of both (trapezoidal, of second order) as long as that does
/// not turn the motion round, and else as much of the second as makes an end of the first.
struct Drag {
  double before = 0.0, after = 0.0;

  Drag() = default;
  explicit Drag(double taken)
      : before(std::min(0.5 * taken, 1.0)), after(std::max(0.5 * taken, taken - 1.0)) {}
};

/// What forces make of a body's velocity in a kick, whatever that is.
struct Forcing {
  Vec2 pull = Vec2::Zero();  // m/s, that gravity adds
  Drag linear, angular;
  double spin = 0.0;                   // rad/s, that a torque adds
  bool moves = false, turned = false;  // the body's centre can; something turns it
  bool has_motor = false;              // what turns it is driven, or follows a table
};

/// What a solve is for. Positions move on by `length` with the velocities that it finds, after
/// forces have acted for `kick`.
struct TimeSpan {
  double start = 0.0;         // s, the positions' time
  double length = 0.0;        // s; 0: the velocities of an instant
  double kick = 0.0;          // s, from the velocities' time on
  double lag = 0.0;           // s, the part of the kick before the positions' time
  double repair = 0.0;        // s, in which a violation is made up for; at least the length
  double made_up = infinity;  // m: a greater violation stays as it is, and is repaired in positions
  double reach = infinity;    // m: what is further from bearing force than that bears none
  bool clamps = false;        // pressed bodies hold the cable in a transitional pinch both ways
  bool held_only = false;     // nothing bears force that does not do so already
  bool foreseen = false;      // the rows' curvatures are: foresight.h
  bool steady = false;        // after two of one length, of a part that nothing touches
  bool straight = false;      // no way is curved to the rows. Where they contradict each other by
                              // that, as a span that is about to be pinched does the friction of
                              // the discs beside it, the linear solution is sound still

  /// Whether impulses tell forces: in a shorter kick what round-off of positions asks for, as much
  /// however short that is, is no small part of them.
  bool tells_forces() const { return kick > 1e-3 * repair; }
};

enum class RowKind : std::int8_t {
  segment,       // tension of a span or transitional pinch, >= 0
  pinch_middle,  // friction on the middle body of a non-transitional pinch: one signed row,
                 // or with PinchRows::three two of kind `segment`
  normal,        // contact force, >= 0
  tangent,       // Coulomb friction of bare surfaces, |.| <= mu * normal
  sleeve_hold,   // keeps a sleeve's centre where its body has it, or its turning its neighbour's
  sleeve_rub,    // friction between the two: rubbing.h
};

/// The two bodies of a row, as places in the part's arrays, and what it sees of their velocities
/// (x, y, angle). Nothing moves the place after the last body: it stands for the world and for
/// bodies that do not change.
struct alignas(64) RowBodies {
  int a = 0, b = 0;
  Eigen::Vector3d ja = Eigen::Vector3d::Zero(), jb = ja;  // m/s of row a m/s, or rad/s, of body
  double curvature = 0.0;  // m/s, elastic: of the bias, by which C changes otherwise than by J v
};

/// What an impulse on a row does to its bodies. It has their places as well, so that whoever
/// applies impulses reads nothing else, and whoever measures speeds none of this.
struct RowResponse {
  int a = 0, b = 0;
  Eigen::Vector3d ra = Eigen::Vector3d::Zero(), rb = ra;  // mobility * J^T: m/s, or rad/s, a N s
};

/// The third body of a row that has one, of a contact with a piece of a hanging cable.
struct ThirdBody {
  int row = 0, place = 0;
  Eigen::Vector3d j = Eigen::Vector3d::Zero(), response = j;
};

/// A row's own values. With w = J v + bias and the impulse p a unilateral row asks
///     p >= 0,   w + compliance p >= 0,   p (w + compliance p) = 0.
/// The impulse changes the bodies' velocities by mobility * J^T p.
struct Row {
  RowKind kind = RowKind::segment;
  bool rebounds = false;    // normal, Events::at_steps: the bias is the speed of a rebound
  bool is_new = true;       // segment: its bodies are not yet seen
  bool turns = false;       // segment: its levers turn with a body, moved or not
  bool shut = false;        // segment: in a pinch for good, between circles that never move
  bool has_third = false;   // of PartSystem::thirds, at `item`
  bool on = false;          // active set: bears a force
  bool idle = false;        // bears no force in this solve, whatever its speed: out of reach
  Slip slip = Slip::stick;  // active set: friction rows
  bool clamped = false;     // active set: `presser` bears, so that the row may push as well
  bool returned = false;    // normal: has lost its force in this step and got it back
  bool stretches = false;   // segment, at an instant: by forces, which do nothing then
  int flipped = 0;          // solve of this step at which `on` or `slip` last changed
  int presser = -1;         // segment: row of the force that clamps the cable in its pinch, or -1
  int friction = -1;        // pinch_middle, tangent: of PartSystem::frictions
  int index = -1;           // contact; or cable
  int item = -1;            // segment, middle link, or place of its third body
  double clearance = 0.0;   // m, slack or gap that is left; below 0: too long, or too near
  double bias = 0.0;        // m/s
  double curved = 0.0;      // m/s, of the bias: by what C changes otherwise than by J v
  double compliance = 0.0;  // 1/kg
  double diagonal = 0.0;    // 1/kg, J * mobility * J^T
  double impulse = 0.0;     // N s
  double speed = 0.0;       // w + compliance p, m/s, after the solve
};

/// The law of an elastic segment of a cable that may slide, for its tension at the interval's end,
/// over the kick: J v + bias + compliance p = 0 where nothing slides (elastic.h).
struct ElasticEnd {
  double bias = 0.0;        // m/s
  double compliance = 0.0;  // 1/kg; 0: not of such a segment
};

/// Of neither a segment nor a contact.
inline bool is_of_sleeve(const Row& row) {
  return row.kind == RowKind::sleeve_hold || row.kind == RowKind::sleeve_rub;
}

/// What bounds the impulse of a friction row, a contact's tangent or the middle body of a pinch:
/// friction.h. In a pinch is also the tangent of a contact that presses a cable which may slip.
struct Friction {
  int row = -1;                    // that it bounds
  int normal = -1;                 // row of the force that presses, or -1: see `coefficient`
  double coefficient = 0.0;        // of the row's own body or pair; infinity: no slip, 0: no force
  double wrapped = infinity;       // in a pinch: coefficient of the wrapped body
  double bound = 0.0;              // |impulse| <= bound * impulse of `normal`, in force
  int run = -1;                    // in a pinch: the wrapped body's run, where it may slide
  int repeats = -1;                // pinch_middle: the row that this one repeats, or -1
  int repeated = 0;                // pinch_middle: how many rows repeat this one
  bool opposes = false;            // pinch_middle: it is the opposite of the row that it repeats
  bool in_group_equation = false;  // in a pinch: its equation is part of its group's
  bool dropped = false;            // bears nothing in this step
  bool frozen = false;             // keeps its state for this step, whatever its bound
  Slip slid = Slip::stick;         // the way it last slid in this step
};

/// What taut spans do to a body across themselves: h^2 times their stiffness, and that times either
/// component of their other ends' velocities. By steady_light_bodies, as its own mobility and free
/// velocity (m/s, m/s, rad/s) where it has others then.
struct SpanMass {
  Eigen::Matrix2d mass = Eigen::Matrix2d::Zero();                                 // kg
  Eigen::Matrix2d momentum_x = Eigen::Matrix2d::Zero(), momentum_y = momentum_x;  // kg m/s
  bool steadied = false;                                                          // it has
  Mobility own;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
};

enum class MotorState : std::int8_t {
  holds,     // its angular velocity, by whatever torque within its limit
  forward,   // turns that way with all its torque
  backward,  // likewise
  stalls,    // turns its body only as far as cables let it
  keeps,     // has stalled, and lets nothing turn its body back
  insists,   // holds for all that: its stalling has not helped
};

/// What turns a driven body: motors.h.
struct Motor {
  int place = 0;           // of the body in the part
  double speed = 0.0;      // rad/s, that it is to turn at
  double before = 0.0;     // rad/s, before the kick
  double inertia = 0.0;    // kg m^2
  double most = 0.0;       // N m s: its limit over the kick, or infinity
  bool moves = false;      // the body can do more than turn
  bool threw = false;      // something in this kick, when it held its speed
  double stretched = 0.0;  // m/s, a cable at most, then
  double kept = 0.0;       // rad/s, below which it lets nothing turn its body when it has stalled
  bool pauses = false;     // it has stalled in the kick before this instant
  MotorState state = MotorState::holds;
};

/// A force (N) that is linear in how centres of sleeves on one body accelerate, less gravity.
struct Carried {
  Eigen::Vector3d of_body = Eigen::Vector3d::Zero();  // kg, kg, kg m: of the body's acceleration,
  double turning = 0.0;                               // kg m: of the square of its turning,
  double slipping = 0.0;                              // kg, of that times the slip speed
};

/// What friction on a sleeve, and on those that go on from it, is at most, one way, as a sum of the
/// rows' impulses and of what is known: rubbing.h.
struct RubLaw {
  double in = 0.0, out = 0.0;  // of the tensions before and after it
  Carried carried;
  int terms_begin = 0, terms_end = 0;  // of PartSystem::rub_terms: of pinches on the way
};

/// A sleeve as a body of the part, and how it rubs.
struct SleevePlace {
  Sleeve sleeve;
  int place = 0, body = 0;                           // of the sleeve and of what moves its body
  int head = 0, tail = 0;                            // of those that go on from one another
  int hold = -1;                                     // first row that holds its centre, or -1
  int cable_place = 0;                               // in the part's cables
  double radius = 0.0;                               // m, signed, of the cable's centre line
  double share = 0.0;                                // kg, of the body's mass
  int span_in = -1, span_out = -1;                   // of PartSystem::masses
  int row_in = -1, row_out = -1;                     // of the segments before and after all
  int rub = -1;                                      // row of a head; -1: it does not
  Eigen::Vector3d before = Eigen::Vector3d::Zero();  // m/s, m/s, rad/s: before the kick,
  Eigen::Vector3d body_before = before;              // and the body's
  double flow_in = 0.0, flow_out = 0.0;  // N, by what tensions are more than rows' forces, less
                                         // what goes into the bend
  double turning = 0.0, slipping = 0.0;  // rad/s of the body, m/s, then
  RubLaw forward, backward;
  double known = 0.0;    // N s, of the impulse where it slips: what is no unknown
  bool dropped = false;  // bears nothing in this solve
  bool frozen = false;   // keeps its state for this step
};

/// What rows were made for: while it is the same, so are their bodies.
struct RowsMade {
  int changes = -1;   // of the part's cables
  double kick = 0.0;  // s
  bool operator==(const RowsMade&) const = default;
};

/// What is within this share of a part's extent of bearing force may do so. Lengths and gaps are
/// right to a tenth of it, and round-off of positions is some 1e-16.
constexpr double within_reach = 1e-11;

struct PartSystem {
  // Bodies of the part in its order, and the world after them; by apply_forces (forces.cpp).
  std::vector<Mobility> mobility;              // changed by steady_light_bodies and drive
  std::vector<char> mobile;                    // impulses can move or turn it
  std::vector<Forcing> forcing;                // what the mobilities' kick adds
  std::vector<Eigen::Vector3d> free_velocity;  // m/s, m/s, rad/s: after forces, before impulses
  std::vector<Eigen::Vector3d> velocity;       // likewise, after impulses
  std::vector<SpanMass> span_masses;           // empty until one body is too light; by
                                               // steady_light_bodies
  std::vector<Motor> motors;                   // of its driven bodies; states by solve_with_motors
  std::vector<Eigen::Matrix3d> carried;        // by its bodies; empty: cables without mass
  double mobility_kick = 0.0;                  // s, what the mobilities are for
  double extent_of_still = 0.0;                // m, coordinates of bodies that cannot move at most
  double extent = 0.0;                         // m, coordinates and cable lengths at most
  double reach = 0.0;                          // m, TimeSpan::reach where events are located
  bool mobility_changed = true;                // since the step before
  bool has_tables = false;                     // of speeds, of its bodies' motors

  // Rows: of cables, then of contacts; by make_segment_rows and make_contact_rows.
  std::vector<RowBodies> bodies;
  std::vector<RowResponse> responses;
  std::vector<Row> rows;
  std::vector<ThirdBody> thirds;  // of the rows that have one, in their order
  std::vector<Friction> frictions;
  std::vector<char> changed;  // of each row: its bodies or diagonal are not those of the step
                              // before
  RowsMade made;              // what they are for
  int first_contact_row = 0;
  int first_sleeve_row = 0;     // of those before the contacts'
  bool same_segments = false;   // rows of segments are of what they were of when last made
  bool segments_stand = false;  // and so are their bodies and diagonals
  bool same_rows = false;       // all rows are of what they were of in the step before
  bool rows_stand = false;      // and so are their bodies and diagonals
  bool factored = false;        // `ldl` has factors of its matrix, and no row repeats others; by
                                // solve_for_states
  std::vector<int> middles;     // rows of kind pinch_middle
  std::vector<int> pressed;     // rows of transitional pinches that a contact presses
  std::vector<int> loose;       // rows that may catch or let go in an interval, ascending: all but
                                // friction's and those of segments that are tight and stiff
  bool too_long = false;        // a segment that cannot stretch is, by more than TimeSpan::made_up
  std::vector<int> repeated;    // frictions that repeat others, or are repeated; ascending. By
                                // find_repeated_middles

  // Order of the rows and what it is for, two bodies a row; by order_rows.
  std::vector<int> structure, order;

  // The matrix of the rows that bore a force, where it was symmetric, and its factors; by
  // solve_for_states.
  ProfileLdl ldl;
  std::vector<int> assembled;  // rows that the matrix is for, one an unknown; empty: no matrix
  std::vector<double> scale, unsure;  // diagonals, and for pivots (ProfileLdl::factor)

  // Beside what every step reads.
  CableMasses masses;                          // of its cables; bodies are places in the part. By
                                               // apply_forces
  std::vector<Eigen::Vector3d> flow;           // N, N, N m: find_flow_forces, in free_velocity,
  std::vector<Eigen::Vector3d> flow_velocity;  // at these velocities; by follow_flow
  std::vector<Eigen::Vector3d> flow_before;    // storage of follow_flow
  std::vector<SleevePlace> sleeves;            // bodies between the part's own and the world; by
                                               // find_sleeves, laws by make_sleeve_rows
  std::vector<Sleeve> listed_sleeves;          // storage of find_sleeves
  std::vector<Eigen::Matrix3d> lent;           // masses of its bodies that sleeves have; empty
                                               // without these. By find_sleeves
  std::vector<Term> rub_terms;                 // of rows; by make_sleeve_rows, as
  double rub_kick = 0.0;                       // s, that the rows are for,
  Vec2 rub_fall = Vec2::Zero();                // m/s, and what gravity adds in it
  std::vector<Eigen::Vector3d> unconstrained;  // free velocities before rows; by solve_with_motors
  std::vector<ElasticEnd> elastic_ends;        // of the rows; empty without elastic cables that may
                                               // slide. By make_all_elastic, as
  bool stretch_waits = false;                  // impulses do not tell how far these slide
  std::vector<int> row_of_segment;             // cable after cable; -1: none. By
                                               // make_segment_rows, as
  std::vector<int> segment_begin;              // of the part's cables, in row_of_segment
  std::vector<double> wraps;  // rad, of links when the rows were made, as row_of_segment; of parts
                              // that may slide. By note_wraps

  int ground() const { return static_cast<int>(mobility.size()) - 1; }

  /// What lengths and gaps may miss at an interval's end (m).
  double tolerance() const { return 0.1 * reach; }
};

/// Whether the row pulls, or pushes, and never both.
inline bool is_unilateral(const Row& row) {
  return (row.kind == RowKind::segment && !row.clamped) || row.kind == RowKind::normal;
}

inline bool is_friction(const Row& row) {
  return row.friction >= 0;
}

/// Whether an impulse changes a row's speed: of what it pulls at, or as what stretches.
inline bool gives(const Row& row) {
  return row.diagonal + row.compliance > 0.0;
}

/// Whether a row's state may contradict the solution at all: where that of none may, nobody needs
/// to know how much of it would be round-off.
inline bool is_suspicious(const PartSystem& s, const Row& row) {
  if (is_friction(row)) return row.on && at(s.frictions, row.friction).bound < infinity;
  if (row.clamped) return false;
  return row.on ? row.impulse < 0.0 : row.speed < 0.0 && gives(row) && !row.idle;
}

/// Leaves nothing that the system was made for; its storage stays.
inline void forget(PartSystem& s) {
  s.mobility.clear();
  s.span_masses.clear();
  s.mobility_kick = 0.0;
  s.made = {};
  s.structure.clear();
  s.assembled.clear();
}

/// Leaves nothing of what the last solve has flipped, for another solve of the same rows.
inline void forget_flips(PartSystem& s) {
  for (Row& row : s.rows) {
    row.flipped = 0;
    row.returned = false;
  }
  for (Friction& friction : s.frictions) {
    friction.dropped = friction.frozen = false;
    friction.slid = Slip::stick;
  }
  for (SleevePlace& sleeve : s.sleeves) sleeve.dropped = sleeve.frozen = false;
}

inline double dot(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return a.x() * b.x() + a.y() * b.y() + a.z() * b.z();
}

/// Of the centres, along an axis (m/s).
inline double greatest_speed(const std::vector<Eigen::Vector3d>& velocity) {
  double greatest = 0.0;
  for (const Eigen::Vector3d& v : velocity) {
    greatest = std::max({greatest, std::abs(v.x()), std::abs(v.y())});
  }
  return greatest;
}

/// The third body of a row, or null.
inline const ThirdBody* third_of(const PartSystem& s, std::size_t r) {
  if (s.thirds.empty() || !s.rows[r].has_third) return nullptr;
  return &at(s.thirds, s.rows[r].item);
}

/// What a row's third body adds to J v at such velocities (m/s).
inline double speed_of_third(const PartSystem& s, std::size_t r,
                             const std::vector<Eigen::Vector3d>& velocity) {
  const ThirdBody* third = third_of(s, r);
  return third ? dot(third->j, at(velocity, third->place)) : 0.0;
}

/// J v + bias at the present velocities (m/s).
inline double row_speed(const PartSystem& s, std::size_t r) {
  const RowBodies& row = s.bodies[r];
  const double speed =
      s.rows[r].bias + dot(row.ja, at(s.velocity, row.a)) + dot(row.jb, at(s.velocity, row.b));
  return s.thirds.empty() ? speed : speed + speed_of_third(s, r, s.velocity);
}

/// Changes the velocities of the row's bodies by an impulse on it (N s).
inline void push(PartSystem& s, std::size_t r, double impulse) {
  if (impulse == 0.0) return;
  const RowResponse& row = s.responses[r];
  at(s.velocity, row.a) += impulse * row.ra;
  at(s.velocity, row.b) += impulse * row.rb;
  if (const ThirdBody* third = third_of(s, r)) {
    at(s.velocity, third->place) += impulse * third->response;
  }
}

}  // namespace pinchlab
