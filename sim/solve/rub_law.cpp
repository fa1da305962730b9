// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/rub_law.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/solve/friction.h"
#include "sim/solve/solve_scratch.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

/// Adds m.b of a centre at c, with b = v' + omega' left(c) - omega^2 c - g.
void add(const Vec2& m, const Vec2& c, Carried& to) {
  to.of_body += Eigen::Vector3d(m.x(), m.y(), m.dot(left(c)));
  to.turning -= m.dot(c);
}

void add(const Carried& other, double factor, Carried& to) {
  to.of_body += factor * other.of_body;
  to.turning += factor * other.turning;
  to.slipping += factor * other.slipping;
}

void scale(double factor, Carried& to) {
  to.of_body *= factor;
  to.turning *= factor;
  to.slipping *= factor;
}

/// X after some of the way, in terms of that before it and of what else there is.
struct Way {
  Vec2 centre = Vec2::Zero();  // m, where it has come to, from that of what moves the body
  double in = 1.0;             // of X before
  double faster = 0.0;         // kg, of w'
  Carried moved;
  // The same of the whole without friction:
  double mass = 0.0;  // kg, of w'
  Carried first;
  double exponent = 0.0;  // of `in`
};

/// Goes on by an arc of `angle` (rad) with friction m, forward positive.
void pass_arc(const CableState& cable, const Link& link, double angle, const Vec2& e_in,
              const Vec2& e_out, double mu, RubLaw& law, Way& way, std::vector<Term>& terms) {
  const double o = link.orientation, mass = cable.density * link.radius;  // kg a rad
  const double m =
      angle > 0.0
          ? std::copysign(std::min(std::abs(mu), (largest_exponent - way.exponent) / angle), mu)
          : mu;
  const double k = std::exp(m * angle);
  way.exponent += std::abs(m) * angle;
  way.in *= k;
  const Vec2 d = e_out - k * e_in;
  const Vec2 z = ((1.0 - m * m) * d - 2.0 * o * m * left(d)) / (1.0 + m * m);
  scale(k, way.moved);
  add(-mass * o * left(z), way.centre, way.moved);
  way.faster = k * way.faster + mass * (m != 0.0 ? std::expm1(m * angle) / m : angle);
  for (int t = law.terms_begin; index(t) < terms.size(); ++t) at(terms, t).coefficient *= k;
  way.mass += mass * angle;
  add(-mass * o * left(Vec2(e_out - e_in)), way.centre, way.first);
}

/// What presses at a pinch on the way adds friction.
void pass_pinch(const World& world, const SolveScratch& scratch, int contact, double mu,
                std::vector<Term>& terms) {
  const Press press = press_of(world, scratch, contact, mu);
  if (press.normal >= 0 && mu != 0.0) terms.push_back({press.normal, press.friction});
}

/// Goes on by a link, whose arc is cut where contacts press it that have no link of their own.
void pass_link(const World& world, SolveScratch& scratch, const SleevePlace& one, int i, double mu,
               double pinched, PartSystem& s, RubLaw& law, Way& way) {
  const CableState& cable = at(world.cables, one.sleeve.cable);
  const Link& link = at(cable.links, i);
  const double wrap = std::max(link.wrap, 0.0);
  find_cuts(world, scratch.capstan.pressing, one.sleeve.cable, i, wrap, scratch.capstan.cuts);
  Vec2 e = at(cable.segments, i).direction;
  double passed = 0.0;
  for (const ArcCut& cut : scratch.capstan.cuts) {
    const Vec2 there = turned(at(cable.segments, i).direction, link.orientation * cut.arc);
    pass_arc(cable, link, cut.arc - passed, e, there, mu, law, way, s.rub_terms);
    pass_pinch(world, scratch, cut.contact, pinched, s.rub_terms);
    const int normal = at(scratch.normal_row_of_contact, cut.contact);
    const int tangent = normal >= 0 ? tangent_row_of(s, normal) : -1;
    if (tangent >= 0) s.rub_terms.push_back({tangent, -1.0});
    e = there;
    passed = cut.arc;
  }
  const Vec2& leaves = at(cable.segments, next_link(cable, i)).direction;
  pass_arc(cable, link, wrap - passed, e, leaves, mu, law, way, s.rub_terms);
}

/// Goes on along the side of a polygon to the centre of link i, `centre`.
void pass_side(const CableState& cable, int i, double mu, const Vec2& centre, const PartSystem& s,
               const SleevePlace& one, Way& way) {
  const Vec2& e = at(cable.segments, i).direction;
  const double o = at(cable.links, i).orientation;
  const Vec2 n = o * left(e);
  const double half = 0.5 * cable.density * std::max(at(cable.segments, i).rest_length, 0.0);  // kg
  const double square = std::abs(one.radius), coriolis = 2.0 * o;
  const double presses =
      s.rub_fall.dot(n) +
      s.rub_kick * one.turning * (one.turning * (n.dot(centre) - square) - coriolis * one.slipping);
  const Vec2 moved = presses > 0.0 ? Vec2(e - mu * n) : e;
  for (const Vec2& end : {way.centre, centre}) {
    add(half * moved, end, way.moved);
    add(half * e, end, way.first);
  }
  if (presses > 0.0) {
    way.moved.turning -= 2.0 * half * mu * square;
    way.moved.slipping -= 2.0 * half * mu * coriolis;
  }
  way.faster += 2.0 * half;
  way.mass += 2.0 * half;
  way.centre = centre;
}

/// m, from that of what moves the link's body.
Vec2 centre_of_link(const World& world, const Link& link) {
  return link_centre(world, link) - at(world.position, mover_of(world, link.body));
}

}  // namespace

int row_of_segment(const PartSystem& s, const SleevePlace& one, int segment) {
  return at(s.row_of_segment, at(s.segment_begin, one.cable_place) + segment);
}

void find_law(const World& world, SolveScratch& scratch, const SleevePlace& one, int sign,
              PartSystem& s, RubLaw& law) {
  const CableState& cable = at(world.cables, one.sleeve.cable);
  const double mu = sign * at(world.bodies, one.sleeve.body).cable_friction;
  const double pinched = sign * friction_in_pinch(world, cable, one.sleeve.body);
  std::vector<Term>& terms = s.rub_terms;
  law = {};
  law.terms_begin = static_cast<int>(terms.size());
  const SleevePlace& tail = at(s.sleeves, one.tail);
  Way way;
  way.centre = one.sleeve.centre;
  pass_pinch(world, scratch, at(cable.segments, one.sleeve.first).contact, pinched, terms);
  for (int i = one.sleeve.first;; i = next_link(cable, i)) {
    const Link& link = at(cable.links, i);
    const int after = next_link(cable, i);
    if (link.pinch_middle) {
      pass_pinch(world, scratch, link.contact, pinched, terms);
      terms.push_back({row_of_segment(s, one, i), -1.0});
    } else {
      if (i != one.sleeve.first && link.corner >= 0) {
        pass_side(cable, i, mu, centre_of_link(world, link), s, one, way);
      }
      pass_link(world, scratch, one, i, mu, pinched, s, law, way);
    }
    if (i != tail.sleeve.last) continue;
    pass_pinch(world, scratch, at(cable.segments, after).contact, pinched, terms);
    break;
  }
  law.terms_end = static_cast<int>(terms.size());

  const MassedSpan& in = at(s.masses.spans, one.span_in);
  const MassedSpan& out = at(s.masses.spans, tail.span_out);
  const double m_i = end_mass(in), m_o = end_mass(out);
  double mass = 0.0;
  for (int k = one.head; k <= one.tail; ++k) mass += at(s.carried, at(s.sleeves, k).place)(0, 0);
  const double rest = std::max(0.0, mass - (m_i + m_o + way.mass));  // next to nothing: least_mass
  const double share = mass / (m_o + way.in * m_i + way.faster + rest);
  law.in = way.in * share - 1.0;
  law.out = 1.0 - share;
  add(way.moved, share, law.carried);
  add(way.first, -1.0, law.carried);
  add((share - 1.0) * m_o * out.direction, tail.sleeve.centre, law.carried);
  add((share * way.in - 1.0) * m_i * in.direction, one.sleeve.centre, law.carried);
  for (int t = law.terms_begin; t < law.terms_end; ++t) {
    Term& term = at(terms, t);
    const bool middle = at(s.rows, term.index).kind != RowKind::normal;
    term.coefficient = share * term.coefficient + (middle ? 1.0 : 0.0);
  }
}

}  // namespace pinchlab
