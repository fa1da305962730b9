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
  // more or less (lay_outermost_turns).
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

/// The same of what the rim has carried over as stretched as it came on.
void lie_as_laid(const World& world, const CableState& cable, std::size_t i, MassedArc& arc) {
  const Link& link = cable.links[i];
  const Rim& rim = cable.rims[i];
  const double p = link.signed_radius();
  const double angle = body_angle(world, link) - origin_of_rim(cable, i) / p;
  const RimSpan on = span_on_rim(world, cable, i);
  arc.kept = true;
  arc.mass = cable.density * (laid_material(rim, on.head) - laid_material(rim, on.tail));
  arc.first = cable.density * p *
              turned(laid_moment(rim, p, on.head) - laid_moment(rim, p, on.tail), angle);
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

void add(std::span<Eigen::Matrix3d> to, const MassedSpan& span) {
  const double mass = end_mass(span);
  add_moments(at(to, span.a), mass, mass * span.z_a, mass * span.z_a.squaredNorm());
  add_moments(at(to, span.b), mass, mass * span.z_b, mass * span.z_b.squaredNorm());
}

void add(std::span<Eigen::Matrix3d> to, const MassedArc& arc) {
  add_moments(at(to, arc.body), arc.mass, arc.first, arc.second);
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
