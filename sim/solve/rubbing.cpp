// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/rubbing.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/parts.h"
#include "sim/solve/friction.h"
#include "sim/solve/rows.h"
#include "sim/solve/rub_law.h"
#include "sim/solve/solve_scratch.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

double radius_of(const World& world, const Sleeve& sleeve) {
  return at(at(world.cables, sleeve.cable).links, sleeve.first).signed_radius();
}

/// A body that can move shares half of its mass evenly among its sleeves, which move with it:
/// whatever lies on a sleeve, its matrix has an inverse then. With those that it carries round,
/// centre at c, it shares no more than a quarter, and than a quarter of its moment of inertia I.
/// With m' = sum of the shares s there, what is left has an inverse, since
///     (sum s c)^2 <= m' sum s c^2 <= m I / 16.
void share_masses(const World& world, PartSystem& s) {
  s.lent.assign(index(s.sleeves.back().place) + 2, Eigen::Matrix3d::Zero());
  for (const SleevePlace& one : s.sleeves) at(s.lent, one.body)(0, 0) += 1.0;  // to count them
  for (SleevePlace& one : s.sleeves) {
    const BodyProperties& body = at(world.bodies, mover_of(world, one.sleeve.body));
    const double on_it = at(s.lent, one.body)(0, 0);
    const bool round = is_carried_round(world, one.sleeve);
    one.share = can_move(body) ? (round ? 0.25 : 0.5) * body.mass / on_it : 0.0;
    if (!round) continue;
    const double turning = 0.25 * inertia_of(body) / (on_it * one.sleeve.centre.squaredNorm());
    one.share = can_move(body) ? std::min(one.share, turning) : turning;
  }
  for (Eigen::Matrix3d& lent : s.lent) lent.setZero();
  for (const SleevePlace& one : s.sleeves) {
    const Vec2& c = one.sleeve.centre;
    add_moments(at(s.lent, one.body), one.share, one.share * left(c), one.share * c.squaredNorm());
  }
}

/// m/s, m/s, rad/s: of what moves the sleeve's body.
Eigen::Vector3d motion_of_body(const World& world, const SleevePlace& one) {
  const int mover = mover_of(world, one.sleeve.body);
  const Vec2& v = at(world.velocity, mover);
  return {v.x(), v.y(), at(world.angular_velocity, mover)};
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
    one.body_before = motion_of_body(world, one);
    one.head = one.tail = static_cast<int>(k);
    if (one.sleeve.goes_on) one.head = s.sleeves[k - 1].head;
    one.radius = radius_of(world, one.sleeve);
    one.dropped = one.frozen = false;
  }
  for (std::size_t k = s.sleeves.size(); k-- > 1;) {
    if (s.sleeves[k].sleeve.goes_on) s.sleeves[k - 1].tail = s.sleeves[k].tail;
  }
  s.lent.clear();
  if (!s.sleeves.empty()) share_masses(world, s);
}

namespace {

/// N, what a span's row and what flows there is more than X at its end on a sleeve, which turns
/// with its rim at w and moves at `velocity`.
double bend_at(const MassedSpan& span, const Laying& end, const Eigen::Vector3d& velocity,
               double w) {
  return span.density * (end.keeps ? w * w : 0.5 * (w * w + velocity.head<2>().squaredNorm()));
}

}  // namespace

void note_flow(PartSystem& s, std::span<const Eigen::Vector3d> velocities) {
  for (SleevePlace& one : s.sleeves) {
    const MassedSpan& in = at(s.masses.spans, one.span_in);
    const MassedSpan& out = at(s.masses.spans, one.span_out);
    const Eigen::Vector3d& v = at(velocities, one.place);
    const double w = one.radius * v.z();
    one.turning = at(velocities, one.body).z();
    one.slipping = w - one.radius * one.turning;
    // A node that is moored there is pulled at by the tension itself.
    const double at_node = -in.density * w * w;
    one.flow_in = in.p_b != 0.0 ? flow_tensions(in, velocities).y() - bend_at(in, in.laying_b, v, w)
                                : at_node;
    one.flow_out = out.p_a != 0.0
                       ? flow_tensions(out, velocities).x() - bend_at(out, out.laying_a, v, w)
                       : at_node;
  }
}

int place_of_sleeve(const World& world, const PartSystem& s, int cable, int link, int body) {
  const int sleeve = sleeve_at(world, s.listed_sleeves, cable, link);
  return sleeve >= 0 ? at(s.sleeves, sleeve).place : body;
}

int place_that_is_pressed(const World& world, const PartSystem& s, const Contact& contact,
                          int body) {
  if (s.sleeves.empty()) return body;
  const int cable = contact.slipping_cable;
  const std::vector<Link>& links = at(world.cables, cable).links;
  for (int i = 0; index(i) < links.size(); ++i) {
    if (presses(contact, cable, at(links, i))) return place_of_sleeve(world, s, cable, i, body);
  }
  return body;
}

void roll_on_sleeve(const PartSystem& s, const Contact& contact, int pressed, RowBodies& row) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.place != pressed) continue;
    Eigen::Vector3d& j = row.a == pressed ? row.ja : row.jb;
    j.z() -= cross(one.sleeve.centre, Vec2(j.head<2>()));
    if (contact.slips_corner >= 0) j.z() = -std::abs(one.radius);
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
    const BodyProperties& body = at(world.bodies, mover_of(world, one.sleeve.body));
    one.hold = static_cast<int>(s.rows.size());
    if (body.kind == BodyKind::free || is_carried_round(world, one.sleeve)) {
      hold(one, Vec2::UnitX());
      hold(one, Vec2::UnitY());
    } else if (body.kind == BodyKind::rail) {
      hold(one, body.rail_axis.normalized());
    }
    one.rub = -1;
    if (one.sleeve.goes_on) {
      RowBodies* bodies = append(one, RowKind::sleeve_hold);
      bodies->a = s.responses.back().a = one.place - 1;
      bodies->jb = {0.0, 0.0, one.radius};
      bodies->ja = -bodies->jb;
      continue;
    }
    if (at(world.bodies, one.sleeve.body).cable_friction == 0.0) continue;
    one.rub = static_cast<int>(s.rows.size());
    RowBodies* bodies = append(one, RowKind::sleeve_rub);
    bodies->jb = {0.0, 0.0, radius_of(world, one.sleeve)};
    bodies->ja = -bodies->jb;
  }
}

namespace {

/// What of f is neither a row's impulse nor the centre's velocity after the kick.
double known_friction(const PartSystem& s, const SleevePlace& one, const RubLaw& law) {
  const Eigen::Vector3d& before =
      s.rub_kick > 0.0 ? one.body_before : at(s.free_velocity, one.body);
  const Carried& carried = law.carried;
  const double round =
      one.turning * (one.turning * carried.turning + one.slipping * carried.slipping);
  return s.rub_kick * (law.in * one.flow_in + law.out * at(s.sleeves, one.tail).flow_out + round) -
         carried.of_body.dot(before) - carried.of_body.head<2>().dot(s.rub_fall);
}

/// f for the present impulses and velocities (N s).
double friction_of(const PartSystem& s, const SleevePlace& one, const RubLaw& law) {
  double f = known_friction(s, one, law) + law.in * at(s.rows, one.row_in).impulse +
             law.out * at(s.rows, one.row_out).impulse +
             law.carried.of_body.dot(at(s.velocity, one.body));
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

namespace {

/// Centres that are carried round are where they have come to.
void place_holds(const World& world, PartSystem& s) {
  for (const SleevePlace& one : s.sleeves) {
    if (!is_carried_round(world, one.sleeve)) continue;
    const Vec2 arm = left(one.sleeve.centre);
    at(s.bodies, one.hold).ja.z() = -arm.x();
    at(s.bodies, one.hold + 1).ja.z() = -arm.y();
  }
}

}  // namespace

void make_sleeve_rows(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& interval, PartSystem& s, SolveScratch& scratch) {
  list_pressing(world, parts, part, scratch.capstan.pressing);
  s.rub_terms.clear();
  s.rub_kick = interval.kick;
  s.rub_fall = interval.kick * scene.gravity;
  place_holds(world, s);
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
    one.row_out = row_of_segment(s, one, span_after(cable, at(s.sleeves, one.tail).sleeve));
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
    const Eigen::Vector3d& moved = law.carried.of_body;
    if (response.a == one.body) along += moved.dot(response.ra);
    if (response.b == one.body) along += moved.dot(response.rb);
    const ThirdBody* third = third_of(s, index(r));
    if (third && third->place == one.body) along += moved.dot(third->response);
    add(r, along);
  }
  return known_friction(s, one, law) + law.carried.of_body.dot(at(s.free_velocity, one.body));
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
  const SleevePlace& one = at(s.sleeves, s.sleeves[k].head);  // all the same, to the bit
  const bool in_part = one.body != s.ground();
  const double turning =
      in_part ? velocities[index(one.body)].z() : at(world.angular_velocity, one.sleeve.body);
  return radius_of(world, one.sleeve) * (velocities[index(one.place)].z() - turning);
}

void store_rubbing(const PartSystem& s, World& world) {
  for (std::size_t k = 0; k < s.sleeves.size(); ++k) {
    const Sleeve& sleeve = s.sleeves[k].sleeve;
    const int rub = at(s.sleeves, s.sleeves[k].head).rub;
    const bool sticks = rub >= 0 && at(s.rows, rub).on && at(s.rows, rub).slip == Slip::stick;
    const double speed = sticks ? 0.0 : slip_speed_of(s, s.velocity, world, k);
    const Slip slip = rub >= 0 ? at(s.rows, rub).slip : Slip::forward;
    set_slip(at(world.cables, sleeve.cable), sleeve, sticks ? Slip::stick : slip, speed);
  }
}

}  // namespace pinchlab
