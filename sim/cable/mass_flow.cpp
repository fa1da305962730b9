// SPDX-License-Identifier: GPL-3.0-or-later
// Forces by what flows through cables with mass, and by how their weight changes.

#include <algorithm>

#include "base/at.h"
#include "sim/cable/mass.h"
#include "sim/tangent.h"

namespace pinchlab {

using Eigen::Vector3d;

namespace {

/// rad/s of a span's direction.
double turning_of(const MassedSpan& span, const Vector3d& v_a, const Vector3d& v_b) {
  if (span.a == span.b) return v_a.z();
  if (span.distance == 0.0) return 0.0;
  const Vec2 d = at_place(v_b, left(span.centre_b)) - at_place(v_a, left(span.centre_a));
  if (span.pinched) return -span.direction.dot(d) / span.distance;
  const double filling = span.slope_b * v_b.z() - span.slope_a * v_a.z();
  return (left(span.direction).dot(d) + filling) / span.distance;
}

/// m of material in a metre of the rims at a span's ends, as they turn against it: each gives what
/// lies on it, or takes what comes.
struct EndsLaid {
  double a, b;
};
EndsLaid laid_at_ends(const MassedSpan& span, const Vector3d& v_a, const Vector3d& v_b,
                      double turning) {
  const Laying &a = span.laying_a, &b = span.laying_b;
  return {span.p_a * (v_a.z() - turning) > 0.0 ? a.gives : a.takes,
          span.p_b * (v_b.z() - turning) > 0.0 ? b.takes : b.gives};
}

/// kg/s, of either end's mass, by what rims that turn give and take.
double growth_of(const MassedSpan& span, const EndsLaid& laid, const Vector3d& v_a,
                 const Vector3d& v_b, double turning) {
  return 0.5 * span.density *
         (laid.a * span.p_a * (v_a.z() - turning) - laid.b * span.p_b * (v_b.z() - turning));
}

/// One of a span's ends.
struct SpanEnd {
  const Vec2& z;
  const Vec2& centre;
  double p, slope, laid;
  bool keeps;
};
SpanEnd end_a(const MassedSpan& span, const EndsLaid& laid) {
  return {span.z_a, span.centre_a, span.p_a, span.slope_a, laid.a, span.laying_a.keeps};
}
SpanEnd end_b(const MassedSpan& span, const EndsLaid& laid) {
  return {span.z_b, span.centre_b, span.p_b, span.slope_b, laid.b, span.laying_b.keeps};
}

/// dz/dt of an end that turns with the body about the circle's centre (m/s).
Vec2 shift_of(const SpanEnd& end, const Vector3d& velocity, double turning, const Vec2& e) {
  const Vec2 shift = -velocity.z() * end.centre + end.p * turning * left(e);
  return shift + end.slope * (turning - velocity.z()) * e;
}

/// kg/s on either rim: by the span's turning, and where it keeps what lies there by its own.
double gain_of_rim(const MassedSpan& span, const SpanEnd& end, const Vector3d& velocity,
                   double turning) {
  return span.density * end.laid * end.p * (end.keeps ? turning - velocity.z() : turning);
}

void add_flow_forces(const MassedSpan& span, const Vec2& gravity, const Vector3d& v_a,
                     const Vector3d& v_b, Vector3d& f_a, Vector3d& f_b) {
  const Vec2 u_a = at_place(v_a, span.z_a), u_b = at_place(v_b, span.z_b);
  const Vec2 n = left(span.direction);
  const double rho = span.density, turning = turning_of(span, v_a, v_b);
  const double mass = end_mass(span);
  const EndsLaid laid = laid_at_ends(span, v_a, v_b, turning);
  const double growth = growth_of(span, laid, v_a, v_b, turning);
  const double e_a = 0.5 * rho * u_a.squaredNorm(), e_b = 0.5 * rho * u_b.squaredNorm();  // J/m

  // A point mass whose place on the body moves, and what rims gain by the span's turning.
  const auto end = [&](const SpanEnd& at_end, const Vector3d& velocity, const Vec2& u, double gains,
                       Vector3d& force) {
    const Vec2 shift = shift_of(at_end, velocity, turning, span.direction);
    force -=
        on_body((growth + gains) * u, at_end.z) + mass * velocity.z() * on_body(shift, at_end.z);
    force.z() -= mass * turning * (at_end.p * n + at_end.slope * span.direction).dot(u);
  };
  const SpanEnd at_a = end_a(span, laid), at_b = end_b(span, laid);
  end(at_a, v_a, u_a, gain_of_rim(span, at_a, v_a, turning), f_a);
  end(at_b, v_b, u_b, -gain_of_rim(span, at_b, v_b, turning), f_b);

  // By the flow of material, whose kinetic energy is the mean of the ends'; from and to what rims
  // keep too. For what of that is along a span the momentum goes that flows through its middle.
  const double flow_a = laid.a * span.p_a, flow_b = laid.b * span.p_b;  // m^2 a radian, of material
  double mean_a = 0.5 * (e_a + e_b), mean_b = mean_a;
  if (!span.pinched) {
    const double along_a = u_a.dot(span.direction), along_b = u_b.dot(span.direction);
    const double flow = 0.5 * (flow_a * (v_a.z() - turning) + flow_b * (v_b.z() - turning));  // m/s
    const Vec2 momentum = 0.5 * rho * flow * (along_a + along_b) * span.direction;            // N
    f_a -= on_body(momentum, span.z_a);
    f_b += on_body(momentum, span.z_b);
    const double apart = 0.25 * rho * (along_a * along_a - along_b * along_b);
    mean_a += apart;
    mean_b -= apart;
  }
  f_a.z() += (at_a.keeps ? mean_a - e_a : mean_a) * flow_a;
  f_b.z() -= (at_b.keeps ? mean_b - e_b : mean_b) * flow_b;
  // By the direction: the flow to and from rims, and the ends' own places.
  const double weight = mass * gravity.dot(n);  // N, of what moves by dp across the span
  const double along = span.pinched ? 0.0 : 0.5 * rho * gravity.dot(span.direction);        // N/m
  const double spare_a = along * (span.material - laid.a * span.length) - span.strained_a;  // N
  const double spare_b = along * (span.material - laid.b * span.length) + span.strained_b;
  const double about = mean_b * flow_b - mean_a * flow_a + e_a * flow_a - e_b * flow_b +
                       mass * v_a.z() * (span.p_a * n + span.slope_a * span.direction).dot(u_a) +
                       mass * v_b.z() * (span.p_b * n + span.slope_b * span.direction).dot(u_b) -
                       weight * (span.slope_a + span.slope_b) + spare_a * span.p_a +
                       spare_b * span.p_b;
  f_a.z() += weight * span.slope_a - spare_a * span.p_a;
  f_b.z() += weight * span.slope_b - spare_b * span.p_b;
  if (span.a == span.b) {
    f_a.z() += about;
  } else if (!span.pinched && span.distance > 0.0) {  // in a pinch both sides flow alike
    const double force = about / span.distance;
    f_b += on_body(force * n, left(span.centre_b));
    f_a -= on_body(force * n, left(span.centre_a));
    f_b.z() += force * span.slope_b;
    f_a.z() -= force * span.slope_a;
  }
}

}  // namespace

void find_flow_forces(const CableMasses& masses, const Vec2& gravity,
                      std::span<const Vector3d> velocities, std::span<Vector3d> to) {
  std::fill(to.begin(), to.end(), Vector3d::Zero());
  for (const MassedSpan& span : masses.spans) {
    add_flow_forces(span, gravity, at(velocities, span.a), at(velocities, span.b), at(to, span.a),
                    at(to, span.b));
  }
  for (const MassedArc& arc : masses.arcs) {
    const double square = at(velocities, arc.body).z() * at(velocities, arc.body).z();
    if (arc.kept) {  // it turns about the body
      at(to, arc.body).head<2>() -= square * left(arc.first);
      continue;
    }
    // About a circle that turns about the body.
    at(to, arc.body) += square * Vector3d(arc.mass * arc.centre.x(), arc.mass * arc.centre.y(),
                                          arc.centre.dot(arc.first));
  }
}

void add_weight_rates(const CableMasses& masses, const Vec2& gravity, double factor,
                      std::span<const Vector3d> velocities, std::span<Vector3d> to) {
  const Vec2 g = factor * gravity;
  for (const MassedSpan& span : masses.spans) {
    const Vector3d& v_a = at(velocities, span.a);
    const Vector3d& v_b = at(velocities, span.b);
    const double turning = turning_of(span, v_a, v_b), mass = end_mass(span);
    const EndsLaid laid = laid_at_ends(span, v_a, v_b, turning);
    const double growth = growth_of(span, laid, v_a, v_b, turning);
    const auto end = [&](const SpanEnd& at_end, const Vector3d& velocity, double gains,
                         Vector3d& rate) {
      rate += on_body((growth + gains) * g, at_end.z);
      rate.z() += mass * g.dot(shift_of(at_end, velocity, turning, span.direction));
    };
    const SpanEnd at_a = end_a(span, laid), at_b = end_b(span, laid);
    end(at_a, v_a, gain_of_rim(span, at_a, v_a, turning), at(to, span.a));
    end(at_b, v_b, -gain_of_rim(span, at_b, v_b, turning), at(to, span.b));
  }
  for (const MassedArc& arc : masses.arcs) {
    const double turning = at(velocities, arc.body).z();
    at(to, arc.body).z() +=
        arc.kept ? turning * g.dot(left(arc.first)) : -arc.mass * turning * arc.centre.dot(g);
  }
}

FlowForces flow_forces(const MassedSpan& span, std::span<const Vector3d> velocities) {
  FlowForces forces;
  add_flow_forces(span, Vec2::Zero(), at(velocities, span.a), at(velocities, span.b), forces.on_a,
                  forces.on_b);
  return forces;
}

Vec2 flow_tensions(const MassedSpan& span, std::span<const Vector3d> velocities) {
  const FlowForces forces = flow_forces(span, velocities);
  return {span.p_a != 0.0 ? forces.on_a.z() / span.p_a : 0.0,
          span.p_b != 0.0 ? -forces.on_b.z() / span.p_b : 0.0};
}

}  // namespace pinchlab
