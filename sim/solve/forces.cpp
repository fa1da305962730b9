// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/forces.h"

#include <algorithm>
#include <optional>

#include "base/at.h"
#include "sim/cable/bending.h"
#include "sim/cable/cable.h"
#include "sim/cable/held.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/mass.h"
#include "sim/compound.h"
#include "sim/solve/motors.h"
#include "sim/solve/rows.h"
#include "sim/solve/rubbing.h"
#include "sim/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

// dv/dt = f/m - c v: (1 + after) v' = (1 - before) v + k f/m, see Drag.
Forcing forcing_of(const Scene& scene, const BodyProperties& body, double k) {
  Forcing f;
  f.moves = can_move(body);
  if (f.moves) f.pull = k * scene.gravity;
  if (body.kind == BodyKind::rail) f.pull = body.rail_axis * body.rail_axis.dot(f.pull);
  f.linear = Drag(k * body.linear_drag);
  f.angular = Drag(k * body.angular_drag);
  f.turned = body.angular_drag != 0.0 || body.torque != 0.0;
  if (f.turned) f.spin = k * body.torque / inertia_of(body);
  return f;
}

/// Velocity of a body after a kick by forces alone.
inline Eigen::Vector3d free_velocity(const Forcing& f, const Vec2& v, double omega) {
  Vec2 free = Vec2::Zero();
  if (f.moves) free = ((1.0 - f.linear.before) * v + f.pull) / (1.0 + f.linear.after);
  if (f.turned) omega = ((1.0 - f.angular.before) * omega + f.spin) / (1.0 + f.angular.after);
  return {free.x(), free.y(), omega};
}

/// What of a part's bodies lasts from step to step.
void make_system(const Scene& scene, const World& world, std::span<const int> bodies, double kick,
                 PartSystem& s) {
  s.mobility_changed = true;
  s.mobility_kick = kick;
  s.mobility.clear();
  s.mobile.clear();
  s.span_masses.clear();
  s.forcing.clear();
  s.extent_of_still = 0.0;
  s.has_tables = false;
  for (const int b : bodies) {
    const BodyProperties& body = at(world.bodies, b);
    s.mobility.push_back(mobility_of(body, kick));
    s.mobile.push_back(is_mobile(body));
    Forcing& f = s.forcing.emplace_back(forcing_of(scene, body, kick));
    const bool has_table = !at(scene.bodies, b).motor.empty();
    f.has_motor = body.driven_angular_velocity || has_table;
    s.has_tables = s.has_tables || (has_table && body.driven_angular_velocity);
    if (f.moves) continue;
    s.extent_of_still = std::max(s.extent_of_still, at(world.position, b).cwiseAbs().maxCoeff());
  }
  for (std::size_t k = 0; k < s.sleeves.size(); ++k) {
    s.mobility.emplace_back();
    s.mobile.push_back(true);
  }
  s.mobility.emplace_back();  // nothing moves the world
  s.mobile.push_back(false);
  s.free_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
}

/// The body with what its motor's table says for the interval: the angular velocity of the motion
/// that follows, or the torque of the kick, each the mean over its time. Both are exact integrals.
BodyProperties driven_now(const Body& body, const TimeSpan& t, BodyProperties now) {
  const auto drive = [&body](double begin, double time) {
    const double end = begin + time;
    return end > begin ? mean_drive(body.motor, begin, end) : drive_at(body.motor, begin);
  };
  if (now.driven_angular_velocity) {
    now.driven_angular_velocity = drive(t.start, t.length);
  } else if (t.kick > 0.0) {
    now.torque = drive(t.start - t.lag, t.kick);
  }
  return now;
}

/// The speed (rad/s) of a motor without a limit in the interval before an instant, `lag` after that
/// interval's middle, in which it has left its body to the cables; nothing if it has not.
std::optional<double> speed_of_stalled(const Body& body, const TimeSpan& instant, double omega) {
  constexpr double rounding = 1e-9;
  if (body.torque_limit < infinity) return {};
  const double asked =
      body.motor.empty() ? *body.driven_angular_velocity
                         : mean_drive(body.motor, instant.start - 2.0 * instant.lag, instant.start);
  if (std::abs(omega - asked) <= rounding * std::abs(asked)) return {};
  return asked;
}

/// The free velocity of a body with a motor, or a table of torques.
void drive_body(const Scene& scene, const World& world, const TimeSpan& t, int body, int place,
                PartSystem& s) {
  const BodyProperties& always = at(world.bodies, body);
  const Body& given = at(scene.bodies, body);
  const BodyProperties now = given.motor.empty() ? always : driven_now(given, t, always);
  const double omega = at(world.angular_velocity, body);
  Eigen::Vector3d& free = at(s.free_velocity, place);
  free = free_velocity(forcing_of(scene, now, t.kick), at(world.velocity, body), omega);
  if (!now.driven_angular_velocity) return;
  free.z() = *now.driven_angular_velocity;
  if (t.held_only && t.kick > 0.0) {
    if (const auto asked = speed_of_stalled(given, t, omega)) {
      free.z() = omega;
      add_stalled_motor(always, place, *asked, omega, s);
      return;
    }
  }
  add_motor(always, place, free.z(), omega, t.kick, s);
}

/// The part's velocities as its rows see them: before a kick, with the world's after the last.
void list_velocities(const World& world, std::span<const int> bodies,
                     std::span<const SleevePlace> sleeves,
                     std::vector<Eigen::Vector3d>& velocities) {
  velocities.clear();
  for (const int b : bodies) {
    const Vec2& v = at(world.velocity, b);
    velocities.emplace_back(v.x(), v.y(), at(world.angular_velocity, b));
  }
  for (const SleevePlace& one : sleeves) velocities.push_back(velocity_of(world, one.sleeve));
  velocities.emplace_back(Eigen::Vector3d::Zero());
}

/// Which of the spans of a cable, the first of which is `begin`, are beside its sleeves.
void note_spans_of_sleeves(const CableState& cable, int number, int begin, PartSystem& s) {
  const int first = begin - static_cast<int>(first_segment(cable));
  for (SleevePlace& one : s.sleeves) {
    if (one.sleeve.cable != number) continue;
    one.span_in = first + span_before(cable, one.sleeve);
    one.span_out = first + span_after(cable, one.sleeve);
  }
}

/// A span that vanishes between rims keeps all of its stretch, as they take up none: V has no bound
/// then, and no rope is like that. Its second term (mass.h) is left out, by this share, where a
/// span is shorter than a part of the rim's radius (m).
double share_of_strain(double length, double radius) {
  constexpr double part = 0.3;
  const double x = length / (part * radius);
  return x < 1.0 ? x * x * (3.0 - 2.0 * x) : 1.0;
}

/// Notes how strained the spans of an elastic cable are, beside rims that carry what is not; of
/// spans its first is `first`.
void note_strain(const CableState& cable, double stiffness, std::size_t first,
                 std::vector<MassedSpan>& spans) {
  const auto holds_none = [&cable](int link) {
    return cable.rims.empty() || at(cable.rims, link).laid.empty();
  };
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    const Segment& segment = cable.segments[i];
    MassedSpan& span = spans[first + i - first_segment(cable)];
    const double material = segment.rest_length, stretch = segment.length - material;
    // Of less material than that its tension is that of as much: elastic_material.
    if (segment.pinched || !(stretch > 0.0) || material < elastic_material(cable, segment)) {
      continue;
    }
    const double rim = std::max(std::abs(span.p_a), std::abs(span.p_b));
    const double strain = stretch / material;
    const double energy = 0.5 * stiffness * strain * strain * share_of_strain(segment.length, rim);
    if (holds_none(previous_link(cable, static_cast<int>(i)))) span.strained_a = energy;
    if (holds_none(static_cast<int>(i))) span.strained_b = energy;
  }
}

/// Measures what the part's bodies carry of cables with mass.
void measure_masses(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                    PartSystem& s) {
  s.masses.spans.clear();
  s.masses.arcs.clear();
  for (const int c : cables_of(parts, part)) {
    const CableState& cable = at(world.cables, c);
    if (!is_massed(cable)) continue;
    const std::size_t begin = s.masses.spans.size();
    add_masses(world, c, s.listed_sleeves, s.masses);
    note_spans_of_sleeves(cable, c, static_cast<int>(begin), s);
    if (cable.elastic) {
      note_strain(cable, at(scene.cables, c).axial_stiffness, begin, s.masses.spans);
    }
  }
  const auto place = [&](int& body) {
    if (body < 0) {
      body = at(s.sleeves, -1 - body).place;
      return;
    }
    const bool is_world = index(body) == world.bodies.size();
    const int local = is_world ? -1 : at(parts.local, body);
    body = local >= 0 ? local : s.ground();
  };
  for (MassedSpan& span : s.masses.spans) {
    place(span.a);
    place(span.b);
  }
  for (MassedArc& arc : s.masses.arcs) place(arc.body);
  s.carried.assign(s.mobility.size(), Eigen::Matrix3d::Zero());
  add_carried(s.masses, s.carried);
  for (const SleevePlace& one : s.sleeves) {
    Eigen::Matrix3d& mass = at(s.carried, one.place);
    mass += least_mass(world, one.sleeve, mass);
  }
}

/// Whether sleeves have some of the mass of the body at that place.
bool shares_mass(const PartSystem& s, int place) {
  return !s.lent.empty() && at(s.lent, place)(0, 0) > 0.0;
}

/// Mobility and free velocity of a body that carries mass M beside its own,
///     (M_b + M + M_b after) v' = (M_b + M - M_b before) v + k f,   see Drag,
/// where v' is given in what the body cannot do by itself.
void load(const BodyProperties& body, const Vec2& gravity, const Eigen::Vector3d& v, double k,
          int place, PartSystem& s) {
  const Eigen::Vector3d own(body.mass, body.mass, inertia_of(body));
  const Drag linear(k * body.linear_drag), angular(k * body.angular_drag);
  const Eigen::Vector3d pull(gravity.x(), gravity.y(), 0.0);
  Eigen::Matrix3d all = at(s.carried, place);
  Eigen::Vector3d force = all * pull + at(s.flow, place);
  all.diagonal() += own;
  if (!s.lent.empty()) all -= at(s.lent, place);
  force += Eigen::Vector3d(body.mass * gravity.x(), body.mass * gravity.y(), body.torque);
  Eigen::Matrix3d old = all;
  Eigen::Vector3d dragged = own;  // a node is the cable that it carries
  if (body.node) dragged.head<2>().array() += at(s.carried, place)(0, 0);
  old.diagonal() -=
      dragged.cwiseProduct(Eigen::Vector3d(linear.before, linear.before, angular.before));
  all.diagonal() +=
      dragged.cwiseProduct(Eigen::Vector3d(linear.after, linear.after, angular.after));
  const Eigen::Matrix3d inverse = inverse_for(body, all);
  Eigen::Vector3d& free = at(s.free_velocity, place);
  Eigen::Vector3d given = Eigen::Vector3d::Zero();
  if (body.driven_angular_velocity) given.z() = free.z();
  free = given + inverse * (old * v + k * force - all * given);
  at(s.mobility, place) = {inverse(0, 0), inverse(0, 1), inverse(1, 1),
                           inverse(2, 2), inverse(0, 2), inverse(1, 2)};
}

/// The same of a sleeve.
void load_sleeve(const World& world, const Vec2& gravity, double k, const SleevePlace& one,
                 PartSystem& s) {
  const Eigen::Vector3d& v = at(s.velocity, one.place);
  const Eigen::Vector3d pull(gravity.x(), gravity.y(), 0.0);
  Eigen::Matrix3d all = at(s.carried, one.place);
  const Eigen::Vector3d force = all * pull + at(s.flow, one.place);
  all.diagonal() += Eigen::Vector3d(one.share, one.share, 0.0);
  const Eigen::Matrix3d inverse = inverse_for_sleeve(world, one.sleeve, all);
  at(s.free_velocity, one.place) = v + k * (inverse * force);
  at(s.mobility, one.place) = {inverse(0, 0), inverse(0, 1), inverse(1, 1),
                               inverse(2, 2), inverse(0, 2), inverse(1, 2)};
}

/// Adds to the forces on sleeves, and on bodies less their shares, what centres that are carried
/// round gain by that: -omega^2 c of acceleration that no change of velocities at one place tells.
void carry_round(const PartSystem& s, std::span<const Eigen::Vector3d> velocities,
                 std::span<Eigen::Vector3d> flow) {
  for (const SleevePlace& one : s.sleeves) {
    if (one.body == s.ground()) continue;
    const double turning = at(velocities, one.body).z();
    const Vec2 out = turning * turning * one.sleeve.centre;
    at(flow, one.place) += at(s.carried, one.place).leftCols<2>() * out;
    at(flow, one.place).head<2>() += one.share * out;
    at(flow, one.body).head<2>() -= one.share * out;
  }
}

/// What a force at an end of a cable does to the body that holds it, in a kick of k seconds.
void pull(const World& world, const Parts& parts, const Link& end, const Vec2& force, double k,
          PartSystem& s) {
  if (end.body < 0 || at(parts.local, end.body) < 0) return;
  const int place = at(parts.local, end.body);
  const Vec2 arm = link_centre(world, end) - at(world.position, mover_of(world, end.body));
  const Eigen::Vector3d impulse(k * force.x(), k * force.y(), k * cross(arm, force));
  Mobility mobility = at(s.mobility, place);
  const bool loaded = !s.carried.empty() && at(s.carried, place)(0, 0) > 0.0;
  if (!loaded && !shares_mass(s, place)) {
    // Its own: that of the step before may be a light body's still (light_bodies.h).
    const Mobility own = mobility_of(at(world.bodies, mover_of(world, end.body)), k);
    mobility.xx = own.xx;
    mobility.xy = own.xy;
    mobility.yy = own.yy;
  }
  at(s.free_velocity, place) += mobility * impulse;
}

void bend(const World& world, const Parts& parts, const CableState& cable, double k,
          PartSystem& s) {
  const BendForces forces = bend_forces(world, cable);
  pull(world, parts, cable.links[0], forces.start, k, s);
  pull(world, parts, cable.links[1], forces.node, k, s);
  pull(world, parts, at(world.cables, cable.bends_with).links[1], forces.end, k, s);
}

/// By the weight of the bend that a piece holds.
void turn_held(const World& world, const Parts& parts, const CableState& piece, const Vec2& gravity,
               double k, PartSystem& s) {
  const Vec2 force = held_force(first_moment(piece), piece.segments[1], gravity);
  pull(world, parts, piece.links[0], -force, k, s);
  pull(world, parts, piece.links[1], force, k, s);
}

/// By the weight of the bends that spans hold.
void turn_held_spans(const World& world, const Parts& parts, const CableState& cable,
                     const Vec2& gravity, double k, PartSystem& s) {
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    if (!is_held(cable, i)) continue;
    const Vec2 force = held_force(first_moment(cable, i), cable.segments[i], gravity);
    pull(world, parts, at(cable.links, previous_link(cable, static_cast<int>(i))), -force, k, s);
    pull(world, parts, cable.links[i], force, k, s);
  }
}

/// Loads the part's bodies with the cables that they carry, and their motors.
void load_bodies(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                 const TimeSpan& t, PartSystem& s) {
  const std::span<const int> bodies = bodies_of(parts, part);
  measure_masses(scene, world, parts, part, s);
  list_velocities(world, bodies, s.sleeves, s.velocity);
  s.flow.resize(s.mobility.size());
  find_flow_forces(s.masses, scene.gravity, s.velocity, s.flow);
  carry_round(s, s.velocity, s.flow);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Body& given = at(scene.bodies, bodies[i]);
    const BodyProperties& body = at(world.bodies, bodies[i]);
    const int place = static_cast<int>(i);
    if (s.carried[i](0, 0) == 0.0 && !shares_mass(s, place)) {
      s.mobility[i] = mobility_of(body, t.kick);  // it may have carried some before
      continue;
    }
    load(given.motor.empty() ? body : driven_now(given, t, body), scene.gravity, s.velocity[i],
         t.kick, place, s);
  }
  note_flow(s, s.velocity);
  for (const SleevePlace& one : s.sleeves) load_sleeve(world, scene.gravity, t.kick, one, s);
  for (Motor& motor : s.motors) {
    const Eigen::Matrix3d& carried = at(s.carried, motor.place);
    motor.inertia += carried(2, 2);
    if (!s.lent.empty()) motor.inertia -= at(s.lent, motor.place)(2, 2);
    const double torque = carried.row(2).head<2>().dot(scene.gravity) + at(s.flow, motor.place).z();
    motor.before += t.kick * torque / motor.inertia;
    find_first_state(motor);
  }
  s.mobility_changed = true;
}

/// A kick between the middles of steps h0 and h1 is a mean of the force over them, which counts
/// times as they are near: F + (h0^2 - h0 h1 + h1^2) / 12 F'' at the positions' time. The weight of
/// what bodies carry changes as they move, W' = K v, so that W'' = K (change of v) / kick:
/// Numerov's method (Hairer, Norsett & Wanner 1993, *Solving ordinary differential equations I*,
/// III.10).
void add_curved_weight(const Vec2& gravity, const Start& start, std::span<const int> bodies,
                       const TimeSpan& t, PartSystem& s) {
  s.flow_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec2& v = at(start.velocity, bodies[i]);
    s.flow_velocity[i] =
        s.velocity[i] - Eigen::Vector3d(v.x(), v.y(), at(start.angular_velocity, bodies[i]));
  }
  for (const SleevePlace& one : s.sleeves) {
    at(s.flow_velocity, one.place) = at(s.velocity, one.place) - one.before;
  }
  const double before = 2.0 * t.lag, after = t.length;
  const double square = before * before - before * after + after * after;
  const double factor = square / (12.0 * t.kick);
  add_weight_rates(s.masses, gravity, factor, s.flow_velocity, s.flow);
  for (const SleevePlace& one : s.sleeves) {  // whose weight turns the body as it comes round
    const double mass = at(s.carried, one.place)(0, 0);
    at(s.flow, one.body).z() -=
        factor * mass * at(s.flow_velocity, one.body).z() * one.sleeve.centre.dot(gravity);
  }
}

}  // namespace

Mobility mobility_of(const BodyProperties& body, double kick) {
  Mobility m;
  // Drag takes its share of what an impulse adds.
  const double linear = 1.0 / (body.mass * (1.0 + Drag(kick * body.linear_drag).after));
  if (body.kind == BodyKind::free) m.xx = m.yy = linear;
  if (body.kind == BodyKind::rail) {
    const Vec2 n = body.rail_axis.normalized();
    m.xx = linear * n.x() * n.x();
    m.xy = linear * n.x() * n.y();
    m.yy = linear * n.y() * n.y();
  }
  if (body.kind != BodyKind::fixed && !body.driven_angular_velocity) {
    m.angular = 1.0 / (inertia_of(body) * (1.0 + Drag(kick * body.angular_drag).after));
  }
  return m;
}

void apply_forces(const Scene& scene, const World& world, const TimeSpan& t, const Parts& parts,
                  const Part& part, PartSystem& s) {
  const std::span<const int> bodies = bodies_of(parts, part);
  s.mobility_changed = false;
  if (part.has_sleeves || !s.sleeves.empty()) find_sleeves(world, parts, part, s);
  if (s.mobility.empty() || s.mobility_kick != t.kick) make_system(scene, world, bodies, t.kick, s);
  s.extent = s.extent_of_still;
  s.motors.clear();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto b = index(bodies[i]);
    const Forcing& f = s.forcing[i];
    if (!f.moves && !f.turned && !f.has_motor) {
      s.free_velocity[i] = {0.0, 0.0, world.angular_velocity[b]};
      continue;
    }
    s.free_velocity[i] = free_velocity(f, world.velocity[b], world.angular_velocity[b]);
    if (f.moves) s.extent = std::max(s.extent, world.position[b].cwiseAbs().maxCoeff());
    if (f.has_motor) drive_body(scene, world, t, bodies[i], static_cast<int>(i), s);
  }
  bool massed = false, bends = false;
  for (const int c : cables_of(parts, part)) {
    const CableState& cable = at(world.cables, c);
    massed = massed || is_massed(cable);
    bends = bends || cable.bends_with >= 0 || cable.pieces > 1 || !cable.finest.empty();
    const auto segments = static_cast<double>(cable.segments.size());
    s.extent = std::max(s.extent, cable.length * std::max(1.0, 0.1 * segments));
  }
  s.reach = within_reach * s.extent;
  s.carried.clear();
  if (massed) load_bodies(scene, world, parts, part, t, s);
  drive(s);
  if (!bends) return;
  for (const int c : cables_of(parts, part)) {
    const CableState& cable = at(world.cables, c);
    if (cable.bends_with >= 0) bend(world, parts, cable, t.kick, s);
    if (cable.pieces > 1) turn_held(world, parts, cable, scene.gravity, t.kick, s);
    if (!cable.finest.empty()) turn_held_spans(world, parts, cable, scene.gravity, t.kick, s);
  }
}

void apply_forces(const Scene& scene, const World& world, const TimeSpan& t, Workspace& work) {
  for (const Part& part : work.parts.list) {
    if (part.asleep) continue;
    apply_forces(scene, world, t, work.parts, part, at(work.systems, part.system));
  }
}

void follow_flow(const Scene& scene, const Start& start, const Parts& parts, const Part& part,
                 const TimeSpan& t, PartSystem& s) {
  const std::span<const int> bodies = bodies_of(parts, part);
  const double after = t.kick > 0.0 ? t.lag / t.kick : 0.0;
  s.flow_velocity.assign(s.mobility.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const Vec2& v = at(start.velocity, bodies[i]);
    const Eigen::Vector3d before(v.x(), v.y(), at(start.angular_velocity, bodies[i]));
    s.flow_velocity[i] = before + after * (s.velocity[i] - before);
  }
  for (const SleevePlace& one : s.sleeves) {
    at(s.flow_velocity, one.place) = one.before + after * (at(s.velocity, one.place) - one.before);
  }
  s.flow_before.swap(s.flow);
  s.flow.resize(s.mobility.size());
  find_flow_forces(s.masses, scene.gravity, s.flow_velocity, s.flow);
  carry_round(s, s.flow_velocity, s.flow);
  note_flow(s, s.flow_velocity);
  if (t.kick > 0.0) add_curved_weight(scene.gravity, start, bodies, t, s);
  for (std::size_t i = 0; i < bodies.size() + s.sleeves.size(); ++i) {
    const Eigen::Vector3d change = t.kick * (s.mobility[i] * (s.flow[i] - s.flow_before[i]));
    s.free_velocity[i] += change;
    s.velocity[i] += change;
  }
}

}  // namespace pinchlab
