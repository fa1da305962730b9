// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Friction: one law for bare contacts, for the middle bodies of pinches and for cable that slides
// over bodies. All of what bounds a tangential force stands here; both solvers use it.
//
//   contact or middle body:   |p| <= mu N     N the force that presses, mu of the pair or body
//   arc of angle theta:       1/k <= T_after / T_before <= k,    k = e^(mu theta)   (capstan)
//   pinch on the way:         T_after - T_before within mu N of the wrapped body, less what the
//                             middle body takes
//
// A contact's force is shared evenly by the cables (or turns of one) that lie in it. The mu of a
// pinch stands in cable/cable.h (friction_in_pinch), since detection asks for it too.

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/solve/part_system.h"

namespace pinchlab {

struct CableState;
struct Link;
struct Part;
struct Parts;
struct SolveScratch;
struct World;

/// Something on a cable's way over a body that changes its tension: an arc, or a pinch.
struct Passage {
  double factor = 1.0;    // arc: exp(friction * wrap)
  int normal = -1;        // pinch: row of the contact's force, or -1
  double friction = 0.0;  // pinch: the wrapped body's friction is at most friction * that force
  int middle = -1;        // non-transitional pinch: the middle body's row, or -1
  int middle_out = -1;    // with three rows: the second one of the middle body
  double middle_factor = 1.0;  // with three rows: the most that the middle body changes the tension
};

inline bool is_arc(const Passage& p) {
  return p.normal < 0 && p.friction == 0.0 && p.middle < 0;
}

/// Tension after a passage over which the material slides forward (way = 1) or backward (-1) as a
/// sum: of `before` times the tension before it and `pressed` times the force that presses, less
/// the middle body's share.
struct SlidingTerms {
  double before = 1.0, pressed = 0.0;
};
inline SlidingTerms sliding_terms(const Passage& p, int way) {
  return {way > 0 ? p.factor : 1.0 / p.factor, way * p.friction};
}

/// That tension, from the tension before it, the force that presses and the middle body's share;
/// all N, or all N s.
inline double tension_after(const Passage& p, int way, double before, double force, double middle) {
  return (way > 0 ? before * p.factor : before / p.factor) + way * p.friction * force - middle;
}

/// Beyond this exponent no double tells the ratio from infinity in a sum with another tension. The
/// product of those along a cable must not overflow.
constexpr double largest_exponent = 40.0;

/// A contact's coefficient for one of the cables that lie in it.
double share(double mu, const Contact& contact);

/// What presses a cable at a contact: the row of its force, or -1, and the most that this holds of
/// the cable, as a share of it.
struct Press {
  int normal = -1;
  double friction = 0.0;
};

/// Of a contact, or none (-1), by a body that holds what is pressed by `mu`.
Press press_of(const World& world, const SolveScratch& scratch, int contact, double mu);

/// Coulomb coefficient of two bare surfaces: the geometric mean of the two bodies' (or the body's
/// and the wall's).
double contact_coefficient(double mu_a, double mu_b);

/// Of a contact, of bare surfaces or on a cable that is held between them; 0 where that cable's own
/// rows have it.
double coefficient_of(const World& world, const Contact& contact);

/// +1, or -1: what the force of a contact's tangent row has of that on b along left(normal). Where
/// the contact presses a cable that may slip, the row is turned as that of a middle body: its force
/// pulls the body that the cable slips on along the cable, and what presses against it.
///
/// Where the cable's link turns by o about that body, its direction below the contact is
/// o left(outward), outward = +-normal where the body is a or b; pulled along left(normal) is b.
/// Either way that has the sign -o.
inline int way_of_row(const Contact& contact) {
  return contact.slipping_cable >= 0 ? -contact.slips_way : 1;
}

/// The same state along a row that is turned about, or not.
inline Slip along(int way, Slip slip) {
  return static_cast<Slip>(way * static_cast<int>(slip));
}

/// Friction of a bare contact of the given coefficient, pressed by row `normal`.
Friction contact_friction(int row, int normal, double coefficient);

/// Friction of the middle body of a pinch, which row `row` is for, by the contact that presses it.
/// Without slip it holds whatever it must, where the bodies are axles that do not give way, or
/// where (thesis) contacts have no rows.
Friction middle_friction(const World& world, const PartSystem& system, const SolveScratch& scratch,
                         int row);

/// What a friction row may bear at most, times the force that presses it, on a cable that is slack
/// on both sides of the pinch or not. A slack cable passes friction from body to body, as much as
/// the smoother of the two allows.
inline double bound_in_force(const Friction& friction, bool slack) {
  return slack ? std::min(friction.coefficient, friction.wrapped) : friction.coefficient;
}

/// bound * force, where infinite friction under no force holds nothing.
inline double most_friction(double bound, double force) {
  return bound == 0.0 || force == 0.0 ? 0.0 : bound * force;
}

/// The state of a friction row that bears impulse p of at most `most`: friction opposes sliding.
inline Slip slip_of(double p, double most) {
  if (std::abs(p) < most || p == 0.0) return Slip::stick;
  return p > 0.0 ? Slip::backward : Slip::forward;
}

/// Which way to let slide what its law says cannot stick: the way in which it is pushed; but the
/// other where it has slid that way in this step and was found to stick. Then friction presses
/// together what slides by more than it takes to slide (Painleve), or jams it.
inline Slip way_to_try(Slip pushed, Slip slid) {
  if (slid != pushed) return pushed;
  return pushed == Slip::forward ? Slip::backward : Slip::forward;
}

/// Where several turns of cable without slip lie under one pinch, their middle rows say the same.
/// The first stands for all, and its force is shared among them in the end, as by equally stiff
/// cables; the system then has no repeated rows.
void find_repeated_middles(const World& world, PartSystem& system, SolveScratch& scratch);

/// Impulses of repeated rows: their shares of the first one's.
void share_among_repeated(PartSystem& system);

/// Notes by what angles the part's cables lie on bodies (PartSystem::wraps). Forces are those at
/// the interval's start: where its rows are solved again, at its end, these angles have changed.
void note_wraps(const World& world, const Parts& parts, const Part& part, PartSystem& system);

/// The contacts of a part that press a cable which may slip there, without a link of its own
/// (CapstanScratch::pressing).
void list_pressing(const World& world, const Parts& parts, const Part& part,
                   std::vector<int>& pressing);

/// Whether a contact presses a cable on that link, where it may slip.
bool presses(const Contact& contact, int cable, const Link& link);

/// Where a contact presses a link's cable.
struct ArcCut {
  double arc;  // rad after the link's tail
  int contact;
  bool operator<(const ArcCut& other) const {
    return arc != other.arc ? arc < other.arc : contact < other.contact;
  }
};

/// The places on a link of a cable at which contacts press it, in their order, within its `wrap`
/// (rad).
void find_cuts(const World& world, const std::vector<int>& pressing, int cable, int link,
               double wrap, std::vector<ArcCut>& cuts);

/// The row of a contact's tangent, of that of its normal; or -1.
int tangent_row_of(const PartSystem& system, int normal);

/// Appends the passages of a cable's links first..last, which lie on one body, and of the
/// transitional pinches at either end. `begin` is where the cable's own begin in row_of_segment and
/// wraps. With `three` rows a pinch, contacts have no share in friction (thesis), and the middle
/// body holds the cable like an arc of 1 rad on it.
void append_passages(const World& world, PartSystem& system, SolveScratch& scratch, int cable,
                     int first, int last, int begin, int run, std::vector<Passage>& passages);

}  // namespace pinchlab
