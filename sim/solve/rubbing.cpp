// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/rubbing.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/parts.h"
#include "sim/solve/friction.h"
#include "sim/solve/rows.h"
#include "sim/solve/solve_scratch.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

double radius_of(const World& world, const Sleeve& sleeve) {
  return at(at(world.cables, sleeve.cable).links, sleeve.first).signed_radius();
}

/// A disc that can move shares half of its mass evenly among its sleeves, which move with it:
/// whatever lies on a sleeve, its matrix has an inverse then.
void share_masses(const World& world, PartSystem& s) {
  for (SleevePlace& one : s.sleeves) {
    const BodyProperties& body = at(world.bodies, one.sleeve.body);
    const auto on_it = std::count_if(
        s.sleeves.begin(), s.sleeves.end(),
        [&one](const SleevePlace& other) { return other.sleeve.body == one.sleeve.body; });
    one.share = can_move(body) ? 0.5 * body.mass / static_cast<double>(on_it) : 0.0;
  }
}

}  // namespace

void find_sleeves(const World& world, const Parts& parts, const Part& part, PartSystem& s) {
  s.listed_sleeves.clear();
  const std::span<const int> cables = cables_of(parts, part);
  for (const int c : cables) list_sleeves(world, c, s.listed_sleeves);
  if (s.listed_sleeves.size() != s.sleeves.size()) forget(s);
  const int bodies = part.bodies_end - part.bodies_begin;
  const int ground = bodies + static_cast<int>(s.listed_sleeves.size());
  s.sleeves.resize(s.listed_sleeves.size());
  for (std::size_t k = 0; k < s.sleeves.size(); ++k) {
    SleevePlace& one = s.sleeves[k];
    one.sleeve = s.listed_sleeves[k];
    one.place = bodies + static_cast<int>(k);
    const auto cable = std::find(cables.begin(), cables.end(), one.sleeve.cable);
    one.cable_place = static_cast<int>(cable - cables.begin());
    const int local = at(parts.local, one.sleeve.body);
    one.body = local >= 0 ? local : ground;
    one.before = velocity_of(world, one.sleeve);
    one.radius = radius_of(world, one.sleeve);
    one.dropped = one.frozen = false;
  }
  share_masses(world, s);
}

void note_flow(PartSystem& s, std::span<const Eigen::Vector3d> velocities) {
  for (SleevePlace& one : s.sleeves) {
    const MassedSpan& in = at(s.masses.spans, one.span_in);
    const MassedSpan& out = at(s.masses.spans, one.span_out);
    const Eigen::Vector3d& v = at(velocities, one.place);
    const double w = one.radius * v.z();
    const double bend = 0.5 * in.density * (w * w + v.head<2>().squaredNorm());
    // A node that is moored there is pulled at by the tension itself.
    const double at_node = -in.density * w * w;
    one.flow_in = in.p_b != 0.0 ? flow_tensions(in, velocities).y() - bend : at_node;
    one.flow_out = out.p_a != 0.0 ? flow_tensions(out, velocities).x() - bend : at_node;
  }
}

void append_sleeve_rows(const World& world, PartSystem& s) {
  s.first_sleeve_row = static_cast<int>(s.rows.size());
  const auto append = [&s](const SleevePlace& one, RowKind kind) {
    Row& row = s.rows.emplace_back();
    row.kind = kind;
    row.index = one.sleeve.cable;
    row.item = one.sleeve.first;
    RowBodies& bodies = s.bodies.emplace_back();
    RowResponse& response = s.responses.emplace_back();
    bodies.a = response.a = one.body;
    bodies.b = response.b = one.place;
    s.changed.push_back(true);
    return &bodies;
  };
  const auto hold = [&](const SleevePlace& one, const Vec2& way) {
    RowBodies* bodies = append(one, RowKind::sleeve_hold);
    bodies->jb = {way.x(), way.y(), 0.0};
    bodies->ja = -bodies->jb;
  };
  for (SleevePlace& one : s.sleeves) {
    const BodyProperties& body = at(world.bodies, one.sleeve.body);
    if (body.kind == BodyKind::free) {
      hold(one, Vec2::UnitX());
      hold(one, Vec2::UnitY());
    } else if (body.kind == BodyKind::rail) {
      hold(one, body.rail_axis.normalized());
    }
    one.rub = -1;
    if (body.cable_friction == 0.0) continue;
    one.rub = static_cast<int>(s.rows.size());
    RowBodies* bodies = append(one, RowKind::sleeve_rub);
    bodies->jb = {0.0, 0.0, radius_of(world, one.sleeve)};
    bodies->ja = -bodies->jb;
  }
}

namespace {

int row_of_segment(const PartSystem& s, const SleevePlace& one, int segment) {
  return at(s.row_of_segment, at(s.segment_begin, one.cable_place) + segment);
}

/// X after some of the way, in terms of that before it and of what else there is.
struct Way {
  double in = 1.0;            // of X before
  double faster = 0.0;        // kg, of w'
  Vec2 moved = Vec2::Zero();  // kg, of b
  // The same of the whole without friction:
  double mass = 0.0;          // kg, of w'
  Vec2 first = Vec2::Zero();  // kg, of b
  double exponent = 0.0;      // of `in`
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
  way.moved = k * way.moved - mass * o * left(z);
  way.faster = k * way.faster + mass * (m != 0.0 ? std::expm1(m * angle) / m : angle);
  for (int t = law.terms_begin; index(t) < terms.size(); ++t) at(terms, t).coefficient *= k;
  way.mass += mass * angle;
  way.first -= mass * o * left(Vec2(e_out - e_in));
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

/// Goes on along the side of a polygon that is fixed, before link i. There the rope presses by its
/// weight alone, if at all: N ds = -rho b.n ds.
void pass_side(const CableState& cable, int i, double mu, const Vec2& gravity, Way& way) {
  const Vec2& e = at(cable.segments, i).direction;
  const Vec2 n = at(cable.links, i).orientation * left(e);
  const double mass = cable.density * std::max(at(cable.segments, i).rest_length, 0.0);
  way.moved += mass * e;
  if (gravity.dot(n) > 0.0) way.moved -= mass * mu * n;
  way.faster += mass;
  way.mass += mass;
  way.first += mass * e;
}

/// The law for slipping forward (sign = 1) or backward (-1).
void find_law(const World& world, SolveScratch& scratch, const SleevePlace& one, int sign,
              PartSystem& s, RubLaw& law) {
  const CableState& cable = at(world.cables, one.sleeve.cable);
  const double mu = sign * at(world.bodies, one.sleeve.body).cable_friction;
  const double pinched = sign * friction_in_pinch(world, cable, one.sleeve.body);
  std::vector<Term>& terms = s.rub_terms;
  law = {};
  law.terms_begin = static_cast<int>(terms.size());
  Way way;
  pass_pinch(world, scratch, at(cable.segments, one.sleeve.first).contact, pinched, terms);
  for (int i = one.sleeve.first;; i = next_link(cable, i)) {
    const Link& link = at(cable.links, i);
    const int after = next_link(cable, i);
    if (link.pinch_middle) {
      pass_pinch(world, scratch, link.contact, pinched, terms);
      terms.push_back({row_of_segment(s, one, i), -1.0});
    } else {
      const bool along = i != one.sleeve.first && at(cable.links, i).corner >= 0;
      if (along) pass_side(cable, i, mu, s.rub_fall, way);
      pass_link(world, scratch, one, i, mu, pinched, s, law, way);
    }
    if (i != one.sleeve.last) continue;
    pass_pinch(world, scratch, at(cable.segments, after).contact, pinched, terms);
    break;
  }
  law.terms_end = static_cast<int>(terms.size());

  const MassedSpan& in = at(s.masses.spans, one.span_in);
  const MassedSpan& out = at(s.masses.spans, one.span_out);
  const double m_i = end_mass(in), m_o = end_mass(out);
  const double mass = at(s.carried, one.place)(0, 0);
  const double rest = std::max(0.0, mass - (m_i + m_o + way.mass));  // next to nothing: least_mass
  const double share = mass / (m_o + way.in * m_i + way.faster + rest);
  law.in = way.in * share - 1.0;
  law.out = 1.0 - share;
  law.carried = share * (m_o * out.direction + way.in * m_i * in.direction + way.moved) -
                (m_o * out.direction + m_i * in.direction + way.first);
  for (int t = law.terms_begin; t < law.terms_end; ++t) {
    Term& term = at(terms, t);
    const bool middle = at(s.rows, term.index).kind != RowKind::normal;
    term.coefficient = share * term.coefficient + (middle ? 1.0 : 0.0);
  }
}

/// What of f is neither a row's impulse nor the centre's velocity after the kick.
double known_friction(const PartSystem& s, const SleevePlace& one, const RubLaw& law) {
  const Vec2 before =
      Vec2((s.rub_kick > 0.0 ? one.before : at(s.free_velocity, one.body)).head<2>());
  return s.rub_kick * (law.in * one.flow_in + law.out * one.flow_out) -
         law.carried.dot(before + s.rub_fall);
}

/// f for the present impulses and velocities (N s).
double friction_of(const PartSystem& s, const SleevePlace& one, const RubLaw& law) {
  double f = known_friction(s, one, law) + law.in * at(s.rows, one.row_in).impulse +
             law.out * at(s.rows, one.row_out).impulse +
             law.carried.dot(at(s.velocity, one.body).head<2>());
  for (int t = law.terms_begin; t < law.terms_end; ++t) {
    const Term& term = at(s.rub_terms, t);
    f += term.coefficient * at(s.rows, term.index).impulse;
  }
  return f;
}

const RubLaw& law_of(const SleevePlace& one, Slip slip) {
  return slip == Slip::forward ? one.forward : one.backward;
}

Bounds bounds_of(const PartSystem& s, const SleevePlace& one) {
  return {-std::max(0.0, friction_of(s, one, one.forward)),
          std::max(0.0, -friction_of(s, one, one.backward))};
}

bool slips(const Row& row) {
  return row.on && row.slip != Slip::stick;
}

}  // namespace

void make_sleeve_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& interval, PartSystem& s, SolveScratch& scratch) {
  list_pressing(world, parts, part, scratch.capstan.pressing);
  s.rub_terms.clear();
  s.rub_kick = interval.kick;
  s.rub_fall = interval.kick * scene.gravity;
  for (int r = s.first_sleeve_row; r < s.first_contact_row; ++r) {
    Row& row = at(s.rows, r);
    RowResponse& response = at(s.responses, r);
    const RowBodies& bodies = at(s.bodies, r);
    response.ra = at(s.mobility, bodies.a) * bodies.ja;
    response.rb = at(s.mobility, bodies.b) * bodies.jb;
    row.diagonal = bodies.ja.dot(response.ra) + bodies.jb.dot(response.rb);
    row.on = row.clamped = true;
    row.idle = false;
    row.slip = Slip::stick;
    row.flipped = 0;
    at(s.changed, r) = true;
  }
  for (SleevePlace& one : s.sleeves) {
    one.dropped = one.frozen = false;
    if (one.rub < 0) continue;
    Row& row = at(s.rows, one.rub);
    row.slip = at(at(world.cables, one.sleeve.cable).links, one.sleeve.first).slip;
    const CableState& cable = at(world.cables, one.sleeve.cable);
    one.row_in = row_of_segment(s, one, span_before(cable, one.sleeve));
    one.row_out = row_of_segment(s, one, span_after(cable, one.sleeve));
    find_law(world, scratch, one, 1, s, one.forward);
    find_law(world, scratch, one, -1, s, one.backward);
  }
}

void drop_rubbing(PartSystem& s) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.rub < 0) continue;
    at(s.rows, one.rub).idle = one.dropped;
    if (one.dropped) at(s.rows, one.rub).on = false;
  }
}

double list_friction(const PartSystem& s, const SleevePlace& one, Slip way,
                     std::vector<Term>& terms) {
  const RubLaw& law = law_of(one, way);
  terms.clear();
  const auto add = [&terms](int row, double coefficient) {
    if (coefficient != 0.0) terms.push_back({row, coefficient});
  };
  add(one.row_in, law.in);
  add(one.row_out, law.out);
  for (int t = law.terms_begin; t < law.terms_end; ++t) {
    add(at(s.rub_terms, t).index, at(s.rub_terms, t).coefficient);
  }
  for (int r = 0; one.share > 0.0 && index(r) < s.rows.size(); ++r) {
    const RowResponse& response = at(s.responses, r);
    double along = 0.0;
    if (response.a == one.body) along += law.carried.dot(response.ra.head<2>());
    if (response.b == one.body) along += law.carried.dot(response.rb.head<2>());
    const ThirdBody* third = third_of(s, index(r));
    if (third && third->place == one.body) along += law.carried.dot(third->response.head<2>());
    add(r, along);
  }
  return known_friction(s, one, law) + law.carried.dot(at(s.free_velocity, one.body).head<2>());
}

double friction_of(const PartSystem& s, const SleevePlace& one, Slip way) {
  return friction_of(s, one, law_of(one, way));
}

void express_rubbing(PartSystem& s, SolveScratch& set) {
  std::vector<Term>& sum = set.rubbing;
  const auto add = [&](int row, double coefficient) {
    for (int k = set.impulse_begin[index(row)]; k < set.impulse_end[index(row)]; ++k) {
      const Term term = set.impulse_terms[index(k)];
      const auto same = std::find_if(
          sum.begin(), sum.end(), [&term](const Term& other) { return other.index == term.index; });
      if (same == sum.end()) {
        sum.push_back({term.index, coefficient * term.coefficient});
      } else {
        same->coefficient += coefficient * term.coefficient;
      }
    }
  };
  for (SleevePlace& one : s.sleeves) {
    if (one.rub < 0 || !slips(at(s.rows, one.rub))) continue;
    const double known = list_friction(s, one, at(s.rows, one.rub).slip, set.friction_terms);
    sum.clear();
    double own = 1.0;
    for (const Term& term : set.friction_terms) {
      if (term.index == one.rub) {
        own += term.coefficient;
      } else {
        add(term.index, -term.coefficient);
      }
    }
    set.impulse_begin[index(one.rub)] = static_cast<int>(set.impulse_terms.size());
    for (const Term& term : sum) {
      set.impulse_terms.push_back({term.index, term.coefficient / own});
    }
    set.impulse_end[index(one.rub)] = static_cast<int>(set.impulse_terms.size());
    one.known = -known / own;
  }
}

void add_known_rubbing(PartSystem& s) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.rub >= 0 && slips(at(s.rows, one.rub))) at(s.rows, one.rub).impulse += one.known;
  }
}

Bounds bounds_of_rubbing(const PartSystem& s, const Row& row) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.rub < 0 || &at(s.rows, one.rub) != &row) continue;
    if (one.dropped) break;
    return bounds_of(s, one);
  }
  return {0.0, 0.0};
}

void check_rubbing(const PartSystem& s, SolveScratch& set, double speed_tolerance,
                   double impulse_tolerance) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.rub < 0 || one.dropped || one.frozen) continue;
    const Row& row = at(s.rows, one.rub);
    const Bounds bounds = bounds_of(s, one);
    const auto flip = [&](bool on, Slip slip) { set.flips.push_back({one.rub, false, on, slip}); };
    if (!row.on) {  // nothing presses
      const bool forward = row.speed > speed_tolerance, backward = row.speed < -speed_tolerance;
      const double most = std::max(forward ? 0.0 : bounds.most, backward ? 0.0 : -bounds.least);
      if (most > impulse_tolerance) {
        flip(true, forward ? Slip::forward : backward ? Slip::backward : Slip::stick);
      }
    } else if (row.slip == Slip::stick) {
      if (row.impulse < bounds.least - impulse_tolerance) {
        flip(true, Slip::forward);
      } else if (row.impulse > bounds.most + impulse_tolerance) {
        flip(true, Slip::backward);
      }
    } else {
      const double against = -row.impulse * static_cast<int>(row.slip);
      if (against < -impulse_tolerance) {
        flip(false, row.slip);
      } else if (row.speed * static_cast<int>(row.slip) < -speed_tolerance &&
                 against > impulse_tolerance) {
        flip(true, Slip::stick);
      }
    }
  }
}

void freeze_rubbing(PartSystem& s) {
  for (SleevePlace& one : s.sleeves) {
    if (one.rub < 0 || at(s.rows, one.rub).flipped == 0) continue;
    Row& row = at(s.rows, one.rub);
    row.on = !one.dropped;
    row.slip = Slip::stick;
    one.frozen = true;
  }
}

void stick_rubbing(PartSystem& s) {
  for (SleevePlace& one : s.sleeves) {
    if (one.rub < 0 || one.dropped) continue;
    at(s.rows, one.rub).on = true;
    at(s.rows, one.rub).slip = Slip::stick;
  }
}

double slip_speed_of(const PartSystem& s, std::span<const Eigen::Vector3d> velocities,
                     const World& world, std::size_t k) {
  const SleevePlace& one = s.sleeves[k];
  const bool in_part = one.body != s.ground();
  const double turning =
      in_part ? velocities[index(one.body)].z() : at(world.angular_velocity, one.sleeve.body);
  return radius_of(world, one.sleeve) * (velocities[index(one.place)].z() - turning);
}

void store_rubbing(const PartSystem& s, World& world) {
  for (std::size_t k = 0; k < s.sleeves.size(); ++k) {
    const SleevePlace& one = s.sleeves[k];
    const bool sticks =
        one.rub >= 0 && at(s.rows, one.rub).on && at(s.rows, one.rub).slip == Slip::stick;
    const double speed = sticks ? 0.0 : slip_speed_of(s, s.velocity, world, k);
    const Slip slip = one.rub >= 0 ? at(s.rows, one.rub).slip : Slip::forward;
    set_slip(at(world.cables, one.sleeve.cable), one.sleeve, sticks ? Slip::stick : slip, speed);
  }
}

}  // namespace pinchlab
