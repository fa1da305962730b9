// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables with mass that slip on bodies: a sleeve (cable/sleeve.h) is a body of the part, whose
// centre rows hold where its body has it, and which spans pull at instead of that. Between the two
// there is friction by the capstan law with the rope's inertia.
//
// An element R dth of the rope, which moves at w over the rim about a centre with the acceleration
// a, is pressed by N dth and rubbed by mu N dth against the way that it slips. With t its
// direction, n that to the centre and b = a - g (Bechtel et al., "The stretching and slipping of
// belts and fibers on pulleys", J. Appl. Mech. 67, 2000, for belts without weight)
//     N = X - rho R b.n,     X = T - rho w^2,
//     dX/dth = rho R w' + rho R b.t +- mu N,
// since w is one along the rim. Over an arc th, with m = +-mu, k = e^(m th)
//     X_out = k X_in + rho R w' (k - 1) / m + rho R b.V,
//     V = integral of e^(m (th - s)) (t - m n) ds,
// and the spans' halves m_i, m_o, which move with it, add m_i (w' + b.e_i) to the tension before,
// and take m_o (w' + b.e_o) from the one after it. All of it together moves by
//     T_out - T_in = M w' + b.S + f,      f: what friction takes,
// so that w' is known by f: eliminated, f is linear in the tensions, in what presses pinches on the
// way and in the centre's velocity. Slipping, friction is that f; sticking, it is no more than that
// either way.
//
// A sleeve's turning feels the force of a span's row, the tension at its middle, with flow_tensions
// (mass.h) and the half's own inertia, as what flows from one half of the span to the other takes
// momentum along. At the end of the arc the tension T is that and (w^2 - v^2) rho / 2 more,
// where v is the centre's velocity (from the momentum of the rope beyond; test
// MovesAlongWithItsFrame). So X is it less (w^2 + v^2) rho / 2. Where a rim keeps what lies on it,
// stretched as it came on, flow_tensions has that difference, and X is it less rho w^2.
//
// On a polygon all of this goes on from corner to corner: w is the same at each, and its friction
// is one row's. Of corners that a body carries round a is that of each centre, linear in how the
// body accelerates, and so is what its sides press (rub_law.h).
//
// Where f comes out below zero, the rope does not press on the rim: then there is no friction. It
// does not lift off.

#include <span>
#include <vector>

#include "sim/solve/part_system.h"

namespace pinchlab {

struct Contact;
struct Flip;
struct Part;
struct Parts;
struct Scene;
struct SolveScratch;
struct World;

/// Lists the part's sleeves. Where there are others than before, its system is made anew.
void find_sleeves(const World& world, const Parts& parts, const Part& part, PartSystem& system);

/// Notes what flows through the spans beside sleeves do to them at these velocities.
void note_flow(PartSystem& system, std::span<const Eigen::Vector3d> velocities);

/// The place of the sleeve that the link of a cable is part of, or else `body`.
int place_of_sleeve(const World& world, const PartSystem& system, int cable, int link, int body);

/// The place of the sleeve that a contact presses, or else of the body `slips_on`: what presses a
/// rope that slips rubs on its sleeve.
int place_that_is_pressed(const World& world, const PartSystem& system, const Contact& contact,
                          int body);

/// What the sleeve at that place sees of friction: a polygon's moves along the side with its centre
/// line, a disc's turns about its own centre.
void roll_on_sleeve(const PartSystem& system, const Contact& contact, int pressed, RowBodies& row);

/// Appends rows to those of segments, in which sleeves are bodies by now.
void append_sleeve_rows(const World& world, PartSystem& system);

/// Makes them what they are before a solve, with the laws of friction.
void make_sleeve_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& interval, PartSystem& system, SolveScratch& scratch);

/// Before a solve: friction that is left out bears nothing.
void drop_rubbing(PartSystem& system);

/// f of a sleeve that slips that way, for the present impulses and velocities (N s).
double friction_of(const PartSystem& system, const SleevePlace& one, Slip way);

/// The same as a sum: of rows' impulses, by `terms`, and of what is known, which it returns (N s).
double list_friction(const PartSystem& system, const SleevePlace& one, Slip way,
                     std::vector<Term>& terms);

/// Impulses of sleeves that slip, in terms of the unknowns, after those of all other rows.
void express_rubbing(PartSystem& system, SolveScratch& scratch);

/// Adds to their impulses what is known of them.
void add_known_rubbing(PartSystem& system);

/// Appends a flip for each sleeve whose state the solution contradicts.
void check_rubbing(const PartSystem& system, SolveScratch& scratch, double speed_tolerance,
                   double impulse_tolerance);

/// Least and most of a sleeve's friction for the present impulses and velocities (N s).
struct Bounds {
  double least, most;
};
Bounds bounds_of_rubbing(const PartSystem& system, const Row& row);

/// Everything sticks that has changed in this step, for the rest of it; or all, until it is
/// contradicted.
void freeze_rubbing(PartSystem& system);
void stick_rubbing(PartSystem& system);

/// Slip speeds and states, from the velocities just found.
void store_rubbing(const PartSystem& system, World& world);

/// Of sleeve `k`, the velocities being `velocities` (m/s, forward positive).
double slip_speed_of(const PartSystem& system, std::span<const Eigen::Vector3d> velocities,
                     const World& world, std::size_t k);

}  // namespace pinchlab
