// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Constraint rows: one scalar condition on the velocities of at most two bodies each.

#include <Eigen/Core>

#include "sim/contact.h"
#include "sim/scene.h"

namespace pinchlab {

struct Part;
struct World;

/// Inverse mass and inertia of a body in this step, drag included: dv = linear * impulse.
struct Mobility {
  double xx = 0.0, xy = 0.0, yy = 0.0;  // 1/kg, symmetric: a rail body moves along its axis only
  double angular = 0.0;                 // 1/(kg m^2)

  Eigen::Vector3d operator*(const Eigen::Vector3d& j) const {
    return {xx * j.x() + xy * j.y(), xy * j.x() + yy * j.y(), angular * j.z()};
  }
};

enum class RowKind {
  segment,       // tension of a span or transitional pinch, >= 0
  pinch_middle,  // friction on the middle body of a non-transitional pinch: one signed row,
                 // or with PinchRows::three two of kind `segment`
  normal,        // contact force, >= 0
  tangent,       // Coulomb friction of bare surfaces, |.| <= mu * normal
};

/// w = J v + bias, impulse p: a unilateral row asks p >= 0, w + compliance p >= 0, p (w +
/// compliance p) = 0. The impulse changes the bodies' velocities by mobility * J^T p.
struct Row {
  RowKind kind;
  int index = -1;                      // contact; or cable
  int item = -1;                       // segment, or middle link
  int a = -1, b = -1;                  // bodies, -1: none
  Eigen::Vector3d ja, jb;              // (x, y, angle); of bodies that there are
  Eigen::Vector3d ra, rb;              // mobility * J^T of them, by weigh
  double bias = 0.0;                   // m/s
  double compliance = 0.0;             // 1/kg
  double diagonal = 0.0;               // 1/kg, J * mobility * J^T
  double impulse = 0.0;                // N s
  bool rebounds = false;               // normal: the bias is the speed of a rebound
  double speed = 0.0;                  // w, m/s, after the solve
  bool on = false;                     // active set: bears a force
  Slip slip = Slip::stick;             // active set: friction rows
  int run = -1;                        // pinch_middle: the wrapped body's run, where it may slide
  bool in_group_equation = false;      // pinch_middle: its equation is part of its group's
  int repeats = -1;                    // pinch_middle: the row that this one repeats, or -1
  int repeated = 0;                    // pinch_middle: how many rows repeat this one
  int normal = -1;                     // friction rows: the row whose force bounds them, or -1
  double friction = 0.0;               // friction rows: coefficient of the row's own body or pair
  double wrapped_friction = infinity;  // pinch_middle: that of the wrapped body
  double bound = 0.0;    // friction rows: |impulse| <= bound * impulse of `normal`, in force
  int flipped = 0;       // solve of this step at which `on` or `slip` last changed
  bool dropped = false;  // friction rows: bears nothing in this step
  bool frozen = false;   // friction rows: keeps its state for this step, whatever its bound
};

/// Of a body by itself, for a velocity kick of `kick` seconds; and of all bodies.
Mobility mobility_of(const Body& body, double kick);
void set_mobilities(const Scene& scene, double kick, std::vector<Mobility>& out);

/// Begins world.scratch.rows with the rows of a part's cables at the present positions (thesis:
/// SegmentsInit).
void make_segment_rows(const Scene& scene, World& world, const Part& part, double kick);

/// Adds the rows of a part's contacts (thesis: ContactsInit). Bodies that cannot give way to one
/// another get none.
void make_contact_rows(const Scene& scene, World& world, const Part& part);

}  // namespace pinchlab
