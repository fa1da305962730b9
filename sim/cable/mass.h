// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables with mass that run over bodies: belts, and ropes over pulleys and on drums, tight enough
// to be straight. Half of a span's mass moves with its end on either body, and what lies on a rim
// turns with it, so that along a taut cable all of its mass and weight is there, whatever its
// spans' lengths.
//
// With z = left(x) for a place x from a body's centre, u = v + omega z is the velocity there, and
// what a body carries of cables has the kinetic energy
//     T = sum 1/2 rho l |u|^2 / 2 (ends of spans) + 1/2 integral rho |u|^2 ds (rims),
// whose Hessian joins the body's own mass. T depends on where things are too: material flows,
// tangents turn. d/dt (dT/dv) - dT/dq = F leaves the force dT/dq - (dM/dt) v, quadratic in
// velocities.
//
// Of material a metre of a rim holds k: 1, or less where it carries cable over as stretched as it
// came on (creep.h). By a rim's turning a span of the direction e, whose angle is phi, gains
// k p (omega - phi') at a, and loses it at b. What a rim carries over so turns with the body.
//
// A span that is not taut, or is stretched otherwise than what the rims give and take, has material
// M other than k times its length l. With the arcs' weight beside it, its own,
// V = -rho M g . (x_a + x_b) / 2, does not act then as if its halves turned with the rims at its
// ends. What is left at either end is the power
//     -K p (omega - phi'),      K = rho (M - k l) (g . e) / 2.
//
// Of elastic cables with l of material in a span of the length L, V = EA (L - l)^2 / 2 l, and so
//     dV = T d(L - l) - T^2 / 2 EA dl,      T = EA (L - l) / l.
// Rows know the first term. The second is by what comes on to a rim or goes off it there without
// its strain: at a the power T^2 / 2 EA p (omega - phi'), at b as much less.
//
// The row of a span has the tension T at its middle. Either half of it, with what that moves with,
// is a body that material enters and leaves. In the middle it has the mean q of both flows (m/s of
// material) and the mean u of both velocities, and takes the momentum rho q (u . e) e along from
// the half at a to that at b. Of a span that cannot stretch this might as well be left to the row,
// whose force would be less by it: then it would be less in a frame that moves along the span, and
// no sign of what is slack. Its power rho q (u . e) (u_b - u_a) . e is, by the mean q, that of what
// the flow's kinetic energy along the span does at its ends,
//     rho (q_a + q_b) ((u_b . e)^2 - (u_a . e)^2) / 4,
// which it takes the place of: energy is as it was.
//
// A drum that fills (Layers) is as if each moment its outermost turn were its rim: p changes with
// what is wound up, dp = s d(theta - angle), theta being the span's direction and s its slope. What
// lies below is fixed to the drum, and the spiral's moments are integrals over it,
//     integral r^2 e dtheta, integral r^3 dtheta.
// Rows see nothing of s, as the path along a tangent is stationary in a circle's radius. Weight
// does, as spans move across themselves while a drum fills: V changes by that too.

#include <Eigen/Core>
#include <span>
#include <vector>

#include "sim/cable/creep.h"
#include "sim/cable/sleeve.h"
#include "sim/world.h"

namespace pinchlab {

/// A straight piece between two links. Of its ends a and b: body that it moves with, the number of
/// bodies for the world, whose centre is its origin, or -1 - k for sleeve k (sleeve.h); p and
/// centre of the link's circle, see Link.
struct MassedSpan {
  int a = 0, b = 0;
  double p_a = 0.0, p_b = 0.0;                        // m
  Vec2 centre_a = Vec2::Zero(), centre_b = centre_a;  // m, from the bodies' centres
  Vec2 z_a = centre_a, z_b = centre_a;                // m, of the ends
  Vec2 direction = Vec2(1.0, 0.0);
  double distance = 0.0;                // m, over which ends that move across it turn it
  double slope_a = 0.0, slope_b = 0.0;  // m/rad, of p by what the direction turns on the body: not
                                        // 0 on a drum that fills
  bool pinched = false;                 // turns with the line of centres
  double length = 0.0, material = 0.0;  // m
  double density = 0.0;                 // kg/m
  Laying laying_a{}, laying_b{};
  double strained_a = 0.0, strained_b = 0.0;  // J/m, of its material, more than what either rim
                                              // holds: 0 if that is as stretched
};

/// What lies on a rim.
struct MassedArc {
  int body = 0;                // or sleeve, likewise
  bool kept = false;           // it turns with the body. Else material comes as it goes
  Vec2 centre = Vec2::Zero();  // m, of the circle from the body's centre
  double mass = 0.0;           // kg
  Vec2 first = Vec2::Zero();   // kg m, integral of z
  double second = 0.0;         // kg m^2, of |z|^2
};

struct CableMasses {
  std::vector<MassedSpan> spans;
  std::vector<MassedArc> arcs;
};

/// Whether the cable has mass that bodies carry.
inline bool is_massed(const CableState& cable) {
  return cable.density > 0.0;
}

/// m of material, by which a span between bodies apart is longer than itself.
inline double spare_of(const MassedSpan& span) {
  return span.pinched ? 0.0 : span.material - span.length;
}

/// kg, at either end.
inline double end_mass(const MassedSpan& span) {
  return 0.5 * span.density * span.material;
}

/// Adds a cable's masses, its geometry being up to date. `sleeves`: of this cable and others.
void add_masses(const World& world, int cable, const std::vector<Sleeve>& sleeves, CableMasses& to);

/// Adds them to the masses of bodies, for (x, y, angle): kg, kg m, kg m^2. Bodies are one after
/// another as in the spans, and the world after the last.
void add_carried(const CableMasses& masses, std::span<Eigen::Matrix3d> to);

/// The same of all cables of the world, and its sleeves with their masses; empty where none has
/// mass.
void find_carried(const World& world, std::vector<Eigen::Matrix3d>& carried,
                  std::vector<Sleeve>& sleeves);

/// What a sleeve has at least. Where both spans beside a new one are pinched it has no mass of its
/// own: as little as this does not show, and keeps its motion determined.
Eigen::Matrix3d least_mass(const World& world, const Sleeve& sleeve, const Eigen::Matrix3d& mass);

/// dT/dq - (dM/dt) v at these velocities (m/s, m/s, rad/s), likewise (N, N, N m): put into `to`,
/// and what gravity (m/s^2) does to spans that are loose or move across themselves as drums fill.
void find_flow_forces(const CableMasses& masses, const Vec2& gravity,
                      std::span<const Eigen::Vector3d> velocities, std::span<Eigen::Vector3d> to);

/// Adds `factor` times the rate at which the weight of what bodies carry changes as material flows,
/// spans turn and bodies turn at these velocities (N/s, N/s, N m/s), likewise.
void add_weight_rates(const CableMasses& masses, const Vec2& gravity, double factor,
                      std::span<const Eigen::Vector3d> velocities, std::span<Eigen::Vector3d> to);

/// dT/dq - (dM/dt) v of one span, on what moves with its ends (N, N, N m).
struct FlowForces {
  Eigen::Vector3d on_a = Eigen::Vector3d::Zero(), on_b = on_a;
};
FlowForces flow_forces(const MassedSpan& span, std::span<const Eigen::Vector3d> velocities);

/// What this is to the turning of the sleeves at either end, as a tension of the span (N): at a, at
/// b. Places are of `velocities`.
Vec2 flow_tensions(const MassedSpan& span, std::span<const Eigen::Vector3d> velocities);

/// Of a cable's weight (J).
double potential_energy(const World& world, const CableState& cable, const Vec2& gravity);

/// Inverse of a matrix for (x, y, angle) on what the body can do: move, move along its rail, turn.
Eigen::Matrix3d inverse_for(const BodyProperties& body, const Eigen::Matrix3d& matrix);

/// The same on what a sleeve can do: it turns whatever holds its body.
Eigen::Matrix3d inverse_for_sleeve(const World& world, const Sleeve& sleeve,
                                   const Eigen::Matrix3d& matrix);

/// Velocity of a place z = left(x), x off a body's centre (m/s), and what a force or an impulse
/// there is to the body.
inline Vec2 at_place(const Eigen::Vector3d& velocity, const Vec2& z) {
  return velocity.head<2>() + velocity.z() * z;
}
inline Eigen::Vector3d on_body(const Vec2& force, const Vec2& z) {
  return {force.x(), force.y(), z.dot(force)};
}

/// Adds a mass (kg) with its first and second moment of z (kg m, kg m^2) to such a matrix.
inline void add_moments(Eigen::Matrix3d& to, double mass, const Vec2& first, double second) {
  to(0, 0) += mass;
  to(1, 1) += mass;
  to.topRightCorner<2, 1>() += first;
  to.bottomLeftCorner<1, 2>() += first.transpose();
  to(2, 2) += second;
}

/// What moves a link: a body, or the number of bodies for the world.
int mover_or_world(const World& world, const Link& link);

/// A segment, by bodies and not by sleeves.
MassedSpan span_of(const World& world, const CableState& cable, std::size_t segment);

/// What the body can do: move, move along its rail, turn. One a column.
using Ways = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;
Ways ways_of(const BodyProperties& body);

/// How the material at an end of a segment moves (m/s): with what holds the link's circle, and
/// along the cable by the circle's turning.
struct Flow {
  Vec2 carried = Vec2::Zero();
  double along = 0.0;
};
Flow flow_at(const World& world, const CableState& cable, std::size_t segment, bool at_head);

/// Of the material at that share (0..1) of the way between two ends, where the cable has this
/// direction (m/s).
inline Vec2 velocity_between(const Flow& tail, const Flow& head, double share,
                             const Vec2& direction) {
  return (1.0 - share) * tail.carried + share * head.carried +
         ((1.0 - share) * tail.along + share * head.along) * direction;
}

}  // namespace pinchlab
