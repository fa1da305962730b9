// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/mass.h"

#include <Eigen/LU>
#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/tangent.h"

namespace pinchlab {

using Eigen::Vector3d;

int mover_or_world(const World& world, const Link& link) {
  return link.body >= 0 ? mover_of(world, link.body) : static_cast<int>(world.bodies.size());
}

namespace {

/// Of the link's circle, from the centre of what it moves with (m).
Vec2 centre_of(const World& world, const Link& link) {
  if (link.body < 0) return link.offset;
  return link_centre(world, link) - at(world.position, mover_of(world, link.body));
}

/// The same from what it turns about.
Vec2 turning_centre(const World& world, const CableState& cable, int number) {
  const Link& link = at(cable.links, number);
  if (link.body < 0) return link.offset;
  return link_centre(world, link) - pivot_of_link(world, cable, number);
}

/// Of a span that leaves a drum which fills; or lies between that and the cable's end on it, where
/// nothing moves.
void let_fill(const Link& from, const Link& to, MassedSpan& span) {
  if (wound_end(from, to)) {
    if (from.layers.way != 0 || to.layers.way != 0) span.p_a = span.p_b = 0.0;
    return;
  }
  if (from.layers.way > 0) span.slope_a = from.layers.growth;
  if (to.layers.way < 0) span.slope_b = -to.layers.growth;
  span.laying_a.keeps = span.laying_a.keeps || from.layers.way > 0;
  span.laying_b.keeps = span.laying_b.keeps || to.layers.way < 0;
  if (span.pinched) return;
  // The first has no bound on a span as short as the slope, w / pi, which has no room for a turn
  // more or less (lay_outermost_turn).
  span.distance = std::max(span.distance + span.slope_b - span.slope_a, 0.5 * span.distance);
}

}  // namespace

MassedSpan span_of(const World& world, const CableState& cable, std::size_t i) {
  const int head = static_cast<int>(i), tail = previous_link(cable, head);
  const Link &from = at(cable.links, tail), &to = cable.links[i];
  const Segment& segment = cable.segments[i];
  MassedSpan span;
  span.a = mover_or_world(world, from);
  span.b = mover_or_world(world, to);
  span.p_a = from.signed_radius();
  span.p_b = to.signed_radius();
  span.centre_a = turning_centre(world, cable, tail);
  span.centre_b = turning_centre(world, cable, head);
  span.direction = segment.direction;
  span.z_a = left(span.centre_a) + span.p_a * span.direction;
  span.z_b = left(span.centre_b) + span.p_b * span.direction;
  span.pinched = segment.pinched;
  span.distance = segment.pinched ? span.p_b - span.p_a : segment.length;
  if (!cable.rims.empty()) {
    const Rim &before = at(cable.rims, tail), &rim = cable.rims[i];
    const double now = rim.slope;  // as the interval begins
    span.laying_a = laying_at(before, true, segment.pinched ? before.comes_on_at_head : now);
    span.laying_b = laying_at(rim, false, now);
  }
  if (cable.fills) let_fill(from, to, span);
  span.length = segment.length;
  span.material = std::max(material_of_span(cable, i), 0.0);
  // All of what a side bears is a sleeve's: arc_that_turns.
  span.density = is_side_of_sleeve(world, from, to) ? 0.0 : cable.density;
  return span;
}

namespace {

/// An arc about the link's own centre: on the circle z = p e, e turning from where the cable comes
/// to where it goes.
void lie_on_rim(const CableState& cable, const Link& link, const Vec2& comes, const Vec2& goes,
                MassedArc& arc) {
  const double squared = link.radius * link.radius;
  arc.mass = cable.density * link.radius * std::max(link.wrap, 0.0);
  arc.first = cable.density * squared * (left(comes) - left(goes));
  arc.second = arc.mass * squared;
}

/// The same piece by piece, of what the rim has carried over as stretched as it came on.
void lie_as_laid(const World& world, const CableState& cable, std::size_t i, MassedArc& arc) {
  const Link& link = cable.links[i];
  const double p = link.signed_radius();
  const double angle = body_angle(world, link) - origin_of_rim(cable, i) / p;
  arc.kept = true;
  each_piece(world, cable, i, [&](double from, double to, double slope) {
    const double mass = cable.density * slope;  // kg/m
    const Vec2 comes = direction_at(from / p + angle), goes = direction_at(to / p + angle);
    arc.mass += mass * (to - from);
    arc.first += mass * p * p * (left(comes) - left(goes));
  });
  arc.second = arc.mass * p * p;
}

/// The same of what lies in layers, z = orientation r e with r = inner + g th. The direction e is
/// `free` where the span leaves them, and by the angle x back from there e' = -sigma left(e),
/// sigma = way orientation, so that
///     integral r^2 e dx = [sigma (r^2 - 2 g^2) left(e) - 2 g r e],
///     integral r^3 dx = [r^4 / 4 g].
void lie_in_layers(const CableState& cable, const Link& link, const Vec2& comes, const Vec2& goes,
                   MassedArc& arc) {
  const Layers& layers = link.layers;
  const double sigma = layers.way * link.orientation, g = layers.growth, outer = link.radius;
  const auto until = [&](double r, const Vec2& e) -> Vec2 {
    return sigma * (r * r - 2.0 * g * g) * left(e) - 2.0 * g * r * e;
  };
  const Vec2 &held = layers.way > 0 ? comes : goes, &free = layers.way > 0 ? goes : comes;
  const double wrap = std::max(link.wrap, 0.0);
  const double squares = outer * outer + layers.inner * layers.inner;
  arc.kept = true;
  arc.mass = cable.density * layers.length(wrap);
  arc.first = link.orientation * cable.density * (until(layers.inner, held) - until(outer, free));
  arc.second = 0.25 * cable.density * wrap * squares * (outer + layers.inner);
}

/// `centre`: of the link's circle, as of centre_of.
MassedArc arc_of(const World& world, const CableState& cable, std::size_t i, const Vec2& centre) {
  const Link& link = cable.links[i];
  MassedArc arc;
  arc.body = mover_or_world(world, link);
  arc.centre = centre;
  if (!cable.rims.empty() && !cable.rims[i].laid.empty()) {
    lie_as_laid(world, cable, i, arc);
  } else {
    const auto lie = link.layers.way != 0 ? lie_in_layers : lie_on_rim;
    lie(cable, link, cable.segments[i].direction,
        cable.segments[(i + 1) % cable.links.size()].direction, arc);
  }
  const Vec2 c = left(arc.centre);
  arc.second += arc.mass * c.squaredNorm() + 2.0 * c.dot(arc.first);
  arc.first += arc.mass * c;
  return arc;
}

/// What lies on link i as the motion needs it: with the side before it, where that slips.
MassedArc arc_that_turns(const World& world, const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  MassedArc arc = arc_of(world, cable, i, turning_centre(world, cable, static_cast<int>(i)));
  const int before = previous_link(cable, static_cast<int>(i));
  if (before < 0 || !is_side_of_sleeve(world, at(cable.links, before), link)) return arc;
  const double p = link.signed_radius();
  const double mass = cable.density * std::max(material_of_span(cable, i), 0.0);
  arc.mass += mass;
  arc.first += mass * p * cable.segments[i].direction;
  arc.second += mass * p * p;
  return arc;
}

/// rad/s of a span's direction.
double turning_of(const MassedSpan& span, const Vector3d& v_a, const Vector3d& v_b) {
  if (span.a == span.b) return v_a.z();
  if (span.distance == 0.0) return 0.0;
  const Vec2 d = at_place(v_b, left(span.centre_b)) - at_place(v_a, left(span.centre_a));
  if (span.pinched) return -span.direction.dot(d) / span.distance;
  const double filling = span.slope_b * v_b.z() - span.slope_a * v_a.z();
  return (left(span.direction).dot(d) + filling) / span.distance;
}

void add(std::span<Eigen::Matrix3d> to, const MassedSpan& span) {
  const double mass = end_mass(span);
  add_moments(at(to, span.a), mass, mass * span.z_a, mass * span.z_a.squaredNorm());
  add_moments(at(to, span.b), mass, mass * span.z_b, mass * span.z_b.squaredNorm());
}

void add(std::span<Eigen::Matrix3d> to, const MassedArc& arc) {
  add_moments(at(to, arc.body), arc.mass, arc.first, arc.second);
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

void add_way(const Vector3d& way, Ways& ways) {
  ways.conservativeResize(3, ways.cols() + 1);
  ways.rightCols<1>() = way;
}

void add_ways_of_centre(const BodyProperties& body, Ways& ways) {
  if (body.kind == BodyKind::free) {
    add_way(Vector3d::UnitX(), ways);
    add_way(Vector3d::UnitY(), ways);
  } else if (body.kind == BodyKind::rail) {
    const Vec2 along = body.rail_axis.normalized();
    add_way({along.x(), along.y(), 0.0}, ways);
  }
}

}  // namespace

Ways ways_of(const BodyProperties& body) {
  Ways ways(3, 0);
  add_ways_of_centre(body, ways);
  if (body.kind != BodyKind::fixed && !body.driven_angular_velocity) {
    add_way(Vector3d::UnitZ(), ways);
  }
  return ways;
}

namespace {

/// In closed form, without pivots: the choice of these would depend on units.
Eigen::Matrix3d inverse_on(const Ways& ways, const Eigen::Matrix3d& matrix) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3> there =
      ways.transpose() * matrix * ways;
  switch (ways.cols()) {
    case 0:
      return Eigen::Matrix3d::Zero();
    case 1:
      return ways * ways.transpose() / there(0, 0);
    case 2:
      return ways * Eigen::Matrix2d(there).inverse() * ways.transpose();
    default:
      return ways * Eigen::Matrix3d(there).inverse() * ways.transpose();
  }
}

}  // namespace

void add_masses(const World& world, int number, const std::vector<Sleeve>& sleeves,
                CableMasses& to) {
  const CableState& cable = at(world.cables, number);
  const auto put = [&](int& body, int link) {
    const int sleeve = sleeves.empty() ? -1 : sleeve_at(world, sleeves, number, link);
    if (sleeve >= 0) body = -1 - sleeve;
  };
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    const int link = static_cast<int>(i);
    if (i >= first_segment(cable)) {
      to.spans.push_back(span_of(world, cable, i));
      put(to.spans.back().a, previous_link(cable, link));
      put(to.spans.back().b, link);
    }
    if (cable.links[i].orientation == 0) continue;
    to.arcs.push_back(arc_that_turns(world, cable, i));
    put(to.arcs.back().body, link);
  }
}

void add_carried(const CableMasses& masses, std::span<Eigen::Matrix3d> to) {
  for (const MassedSpan& span : masses.spans) add(to, span);
  for (const MassedArc& arc : masses.arcs) add(to, arc);
}

void find_carried(const World& world, std::vector<Eigen::Matrix3d>& carried,
                  std::vector<Sleeve>& sleeves) {
  carried.clear();
  sleeves.clear();
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const CableState& cable = at(world.cables, c);
    if (!is_massed(cable)) continue;
    carried.resize(world.bodies.size() + 1, Eigen::Matrix3d::Zero());
    const std::size_t first = sleeves.size();
    list_sleeves(world, c, sleeves);
    const auto mass_at = [&](int body, int link) -> Eigen::Matrix3d& {
      const int sleeve = first == sleeves.size() ? -1 : sleeve_at(world, sleeves, c, link);
      return sleeve >= 0 ? at(sleeves, sleeve).mass : at(carried, body);
    };
    for (std::size_t i = 0; i < cable.links.size(); ++i) {
      const int link = static_cast<int>(i);
      if (i >= first_segment(cable)) {
        const MassedSpan span = span_of(world, cable, i);
        const double mass = end_mass(span);
        const int before = previous_link(cable, link);
        add_moments(mass_at(span.a, before), mass, mass * span.z_a, mass * span.z_a.squaredNorm());
        add_moments(mass_at(span.b, link), mass, mass * span.z_b, mass * span.z_b.squaredNorm());
      }
      if (cable.links[i].orientation == 0) continue;
      const MassedArc arc = arc_that_turns(world, cable, i);
      add_moments(mass_at(arc.body, link), arc.mass, arc.first, arc.second);
    }
    for (std::size_t k = first; k < sleeves.size(); ++k) {
      sleeves[k].mass += least_mass(world, sleeves[k], sleeves[k].mass);
      sleeves[k].velocity = velocity_of(world, sleeves[k]);
    }
  }
}

Eigen::Matrix3d least_mass(const World& world, const Sleeve& sleeve, const Eigen::Matrix3d& mass) {
  constexpr double share = 1e-9;  // of the cable's
  const CableState& cable = at(world.cables, sleeve.cable);
  const double radius = at(cable.links, sleeve.first).radius;
  const double lacking = std::max(0.0, share * cable.density * cable.length - mass(0, 0));
  return Vector3d(lacking, lacking, lacking * radius * radius).asDiagonal();
}

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

Flow flow_at(const World& world, const CableState& cable, std::size_t segment, bool at_head) {
  const int head = static_cast<int>(segment);
  const int number = at_head ? head : previous_link(cable, head);
  const MassedSpan span = span_of(world, cable, segment);
  const Link& link = at(cable.links, number);
  if (link.body < 0) return {};
  const auto of = static_cast<int>(&cable - world.cables.data());
  const double along = link.signed_radius() * turning_at(world, of, number);
  const Vec2 u = velocity_at(world, cable, number, at_head ? span.z_b : span.z_a);
  return {u - along * span.direction, along};
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

double potential_energy(const World& world, const CableState& cable, const Vec2& gravity) {
  double energy = 0.0;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    const Segment& span = cable.segments[i];
    if (i >= first_segment(cable)) {
      const double mass = 0.5 * cable.density * std::max(material_of_span(cable, i), 0.0);
      energy -= mass * gravity.dot(span.tail + span.head);
      if (is_held(cable, i)) energy -= gravity.dot(first_moment(cable, i));
    }
    if (cable.links[i].orientation == 0) continue;
    const MassedArc arc = arc_of(world, cable, i, centre_of(world, cable.links[i]));  // z = left(x)
    energy -= gravity.dot(arc.mass * at(world.position, arc.body) - left(arc.first));
  }
  return energy;
}

Eigen::Matrix3d inverse_for(const BodyProperties& body, const Eigen::Matrix3d& matrix) {
  return inverse_on(ways_of(body), matrix);
}

Eigen::Matrix3d inverse_for_sleeve(const World& world, const Sleeve& sleeve,
                                   const Eigen::Matrix3d& matrix) {
  const BodyProperties& mover = at(world.bodies, mover_of(world, sleeve.body));
  Ways ways(3, 0);
  if (is_carried_round(world, sleeve)) {
    ways = Eigen::Matrix3d::Identity();
  } else {
    add_ways_of_centre(mover, ways);
    add_way(Vector3d::UnitZ(), ways);
  }
  return inverse_on(ways, matrix);
}

}  // namespace pinchlab
