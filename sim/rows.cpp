// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/rows.h"

#include <algorithm>
#include <cmath>

#include "sim/cable.h"
#include "sim/light_bodies.h"
#include "sim/tangent.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// What a unit impulse on the row does to its bodies, and to its own speed.
void weigh(const std::vector<Mobility>& mobility, Row& row) {
  row.diagonal = 0.0;
  if (row.a >= 0) {
    row.ra = mobility[static_cast<std::size_t>(row.a)] * row.ja;
    row.diagonal += row.ja.dot(row.ra);
  }
  if (row.b >= 0) {
    row.rb = mobility[static_cast<std::size_t>(row.b)] * row.jb;
    row.diagonal += row.jb.dot(row.rb);
  }
}

/// Body-fixed lever of a force along e at the link: torque = lever * force. For a rolling link it
/// is the signed radius, since cross(-p left(e), e) = p.
double lever(const World& world, const Link& link, const Vec2& e) {
  if (link.orientation != 0 || link.body < 0) return link.signed_radius();
  const Vec2 arm = link_centre(world, link) - world.position[static_cast<std::size_t>(link.body)];
  return cross(arm, e);
}

/// dC/dt = e.(v_B - v_A) + p_B om_B - p_A om_A with C = L - l; the row's J is its negative, so that
/// tension (p >= 0) shortens the segment.
void set_segment_row(const World& world, const Link& from, const Link& to, const Segment& segment,
                     Row& row) {
  row.kind = RowKind::segment;
  row.a = from.body;
  row.b = to.body;
  const Vec2& e = segment.direction;
  row.ja = {e.x(), e.y(), lever(world, from, e)};
  row.jb = {-e.x(), -e.y(), -lever(world, to, e)};
}

/// What the material asks of the row: all of it that changes where the tangent has not moved.
void set_material(const World& world, const Segment& segment, double stiffness, double kick,
                  Row& row) {
  row.on = !segment.slack;
  // Where plain cable joints have crossed bodies, rolling has moved material that no row has held;
  // what is left of a segment is then at least nothing.
  const double rest = world.configuration.method == Method::cable
                          ? std::max(segment.rest_length, 0.0)
                          : segment.rest_length;
  row.bias = -(segment.length - rest) / world.step_length;
  // T = EA C / l at the step's end: C + h dC/dt = T l / EA with impulse T * kick.
  if (stiffness < infinity && !segment.pinched) {
    row.compliance = std::max(segment.rest_length, 0.0) / (stiffness * world.step_length * kick);
  }
}

/// A segment's row as it was before the last solve.
void renew(Row& row) {
  row.run = row.normal = row.repeats = -1;
  row.repeated = row.flipped = 0;
  row.in_group_equation = row.dropped = row.frozen = false;
  row.slip = Slip::stick;
  row.bound = row.compliance = 0.0;
}

/// Plain cable joints know no pinch: where the tangent has vanished, the segment joins the
/// attachment points along the centre line, backwards (thesis 4.2.1, Figure 4.3). It then pushes
/// the bodies apart, but leaves their rolling alone: the origin of the method's jitter.
void turn_to_centre_line(const World& world, const Link& from, const Link& to,
                         const Segment& segment, Row& row) {
  const Vec2 d = link_centre(world, to) - link_centre(world, from);
  const double distance = d.norm();
  if (!(distance > 0.0)) return;
  const Vec2 u = d / distance;
  row.ja = {-u.x(), -u.y(), 0.0};
  row.jb = {u.x(), u.y(), 0.0};
  const double overlap = from.radius + to.radius - distance;
  row.bias = -(overlap - std::max(segment.rest_length, 0.0)) / world.step_length;
}

/// What presses the middle body of a non-transitional pinch, and how much of it this cable gets.
void bound_pinch_friction(const Scene& scene, const World& world, Row& row) {
  const Link& middle =
      world.cables[static_cast<std::size_t>(row.index)].links[static_cast<std::size_t>(row.item)];
  const Contact* contact =
      middle.contact >= 0 ? &world.contacts[static_cast<std::size_t>(middle.contact)] : nullptr;
  const int normal =
      contact ? world.scratch.normal_row_of_contact[static_cast<std::size_t>(middle.contact)] : -1;
  const bool clamped =
      contact &&
      (normal < 0 || world.scratch.rows[static_cast<std::size_t>(normal)].diagonal == 0.0);
  if (row.friction == infinity &&
      (clamped || world.configuration.method == Method::pinch_no_contact)) {
    row.on = true;  // held by axles that do not give way, or (thesis) by the joint alone
    row.slip = Slip::stick;
    return;
  }
  row.normal = clamped ? -1 : normal;
  if (row.normal < 0) row.friction = 0.0;
  if (contact == nullptr) return;
  const Link& wrapped = world.cables[static_cast<std::size_t>(row.index)]
                            .links[static_cast<std::size_t>(row.item - 1)];
  const int points = std::max(1, contact->pinch_points);
  row.friction /= points;
  row.wrapped_friction =
      scene.bodies[static_cast<std::size_t>(wrapped.body)].cable_friction / points;
}

/// Where several turns of cable without slip lie under one pinch, their middle rows say the same.
/// The first stands for all, and its force is shared among them in the end, as by equally stiff
/// cables; the system then has no repeated rows.
void find_repeated_middles(World& world) {
  std::vector<int>& first_middle = world.scratch.middle_row_of_contact;
  std::vector<Row>& rows = world.scratch.rows;
  first_middle.assign(world.contacts.size(), -1);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Row& row = rows[r];
    if (row.kind != RowKind::pinch_middle || row.friction != infinity) continue;
    const int contact = world.cables[static_cast<std::size_t>(row.index)]
                            .links[static_cast<std::size_t>(row.item)]
                            .contact;
    if (contact < 0) continue;
    int& first = first_middle[static_cast<std::size_t>(contact)];
    if (first < 0) {
      first = static_cast<int>(r);
      continue;
    }
    Row& other = rows[static_cast<std::size_t>(first)];
    const bool same_side = row.a == other.a;
    const Eigen::Vector3d& j = same_side ? other.ja : other.jb;
    const double sign = row.ja.dot(j) > 0.0 ? 1.0 : -1.0;
    const Eigen::Vector3d& k = same_side ? other.jb : other.ja;
    const double difference =
        (row.ja - sign * j).cwiseAbs().maxCoeff() + (row.jb - sign * k).cwiseAbs().maxCoeff();
    if (difference > 1e-12) continue;  // cables of different widths
    row.repeats = first;
    row.on = false;
    ++other.repeated;
  }
}

}  // namespace

Mobility mobility_of(const Body& body, double kick) {
  Mobility m;
  // Drag acts on the mean of the velocities before and after the kick (Crank-Nicolson), so what an
  // impulse adds is divided by 1 + c k / 2.
  const double linear = 1.0 / (body.mass * (1.0 + 0.5 * kick * body.linear_drag));
  if (body.kind == BodyKind::free) m.xx = m.yy = linear;
  if (body.kind == BodyKind::rail) {
    const Vec2 n = body.rail_axis.normalized();
    m.xx = linear * n.x() * n.x();
    m.xy = linear * n.x() * n.y();
    m.yy = linear * n.y() * n.y();
  }
  if (body.kind != BodyKind::fixed && !body.driven_angular_velocity) {
    m.angular = 1.0 / (disc_inertia(body) * (1.0 + 0.5 * kick * body.angular_drag));
  }
  return m;
}

void set_mobilities(const Scene& scene, double kick, std::vector<Mobility>& out) {
  out.clear();
  for (const Body& body : scene.bodies) out.push_back(mobility_of(body, kick));
}

void make_segment_rows(const Scene& scene, World& world, const Part& part, double kick) {
  Scratch& scratch = world.scratch;
  steady_light_bodies(scene, world, part, kick);
  const bool three = world.configuration.pinch_rows == PinchRows::three;
  const RowsMade made{static_cast<int>(&part - scratch.parts.list.data()), scratch.parts.divisions,
                      changes_of_cables(world), kick};
  const bool again = made == scratch.rows_made && scratch.span_masses.empty();
  scratch.rows_made = made;
  scratch.rows_stand = again && part.contacts_begin == part.contacts_end;
  if (again) {
    scratch.rows.resize(static_cast<std::size_t>(scratch.first_contact_row));
  } else {
    scratch.rows.clear();
    scratch.row_of_segment.clear();
  }
  scratch.has_friction_rows = false;
  scratch.segment_begin.resize(world.cables.size());
  std::size_t begin = 0;  // of the cable, in row_of_segment
  for (const int cable_number : cables_of(scratch.parts, part)) {
    const auto c = static_cast<std::size_t>(cable_number);
    CableState& cable = world.cables[c];
    scratch.segment_begin[c] = static_cast<int>(begin);
    if (!again) scratch.row_of_segment.resize(begin + cable.segments.size(), -1);
    const double stiffness = scene.cables[c].axial_stiffness;
    for (std::size_t s = first_segment(cable); s < cable.segments.size(); ++s) {
      const Link& to = cable.links[s];
      const Link& from =
          cable.links[static_cast<std::size_t>(previous_link(cable, static_cast<int>(s)))];
      // After a middle link comes the opposite of the row before it: one signed row serves both.
      if ((from.pinch_middle && !three) || wound_end(from, to)) continue;
      const Segment& segment = cable.segments[s];
      int& number = scratch.row_of_segment[begin + s];
      if (again && !segment.moved && !segment.pinched) {
        Row& row = scratch.rows[static_cast<std::size_t>(number)];
        renew(row);
        set_material(world, segment, stiffness, kick, row);
        continue;
      }
      scratch.rows_stand = false;
      if (!again) {
        number = static_cast<int>(scratch.rows.size());
        scratch.rows.emplace_back();
      }
      Row& row = scratch.rows[static_cast<std::size_t>(number)];
      renew(row);
      set_segment_row(world, from, to, segment, row);
      row.index = static_cast<int>(c);
      row.item = static_cast<int>(s);
      set_material(world, segment, stiffness, kick, row);
      if (to.pinch_middle && !three) {
        row.kind = RowKind::pinch_middle;
        scratch.has_friction_rows = true;
        row.slip = to.slip;
        row.friction = scene.bodies[static_cast<std::size_t>(to.body)].cable_friction;
        row.wrapped_friction = infinity;
      }
      if (world.configuration.method == Method::cable && segment.pinched) {
        turn_to_centre_line(world, from, to, segment, row);
      }
      weigh(scratch.mobility, row);
    }
    begin += cable.segments.size();
  }
}

void make_contact_rows(const Scene& scene, World& world, const Part& part) {
  std::vector<int>& normal_row_of_contact = world.scratch.normal_row_of_contact;
  normal_row_of_contact.resize(world.contacts.size());
  world.scratch.first_contact_row = static_cast<int>(world.scratch.rows.size());
  for (const int number : contacts_of(world.scratch.parts, part)) {
    const auto i = static_cast<std::size_t>(number);
    const Contact& contact = world.contacts[i];
    const auto a = static_cast<std::size_t>(contact.a), b = static_cast<std::size_t>(contact.b);
    const Vec2& n = contact.normal;
    normal_row_of_contact[i] = -1;
    if (!can_move(scene.bodies[a]) && (contact.b < 0 || !can_move(scene.bodies[b]))) continue;
    normal_row_of_contact[i] = static_cast<int>(world.scratch.rows.size());
    Row& row = world.scratch.rows.emplace_back();
    row.kind = RowKind::normal;
    row.on = contact.touching;
    row.index = number;
    row.a = contact.a;
    row.b = contact.b;
    row.ja = {-n.x(), -n.y(), 0.0};
    row.jb = {n.x(), n.y(), 0.0};
    const double clearance = contact.gap - contact.target;
    row.bias = clearance / world.step_length;
    const double restitution =
        contact.b >= 0 ? std::max(scene.bodies[a].restitution, scene.bodies[b].restitution)
                       : std::max(scene.bodies[a].restitution,
                                  scene.walls[static_cast<std::size_t>(contact.wall)].restitution);
    if (restitution > 0.0) {
      Vec2 v = -world.velocity[a];
      if (contact.b >= 0) v += world.velocity[b];
      const double speed = n.dot(v);
      // Slower than what gravity gives in four steps, a body rests rather than bounces.
      const double slowest = 4.0 * scene.gravity.norm() * world.step_length;
      if (speed < -slowest && clearance + world.step_length * speed < 0.0) {
        row.bias = restitution * speed;
        row.rebounds = true;
      }
    }
    weigh(world.scratch.mobility, row);

    if (contact.pinch_linked) continue;
    const Body& body = scene.bodies[a];
    const double other_friction =
        contact.b >= 0 ? scene.bodies[b].contact_friction
                       : scene.walls[static_cast<std::size_t>(contact.wall)].contact_friction;
    const double friction_coefficient = std::sqrt(body.contact_friction * other_friction);
    if (friction_coefficient == 0.0) continue;
    const Vec2 t = left(n);
    Row& friction = world.scratch.rows.emplace_back();
    friction.kind = RowKind::tangent;
    world.scratch.has_friction_rows = true;
    friction.index = number;
    friction.friction = friction_coefficient;
    friction.slip = contact.slip;
    friction.normal = normal_row_of_contact[i];
    friction.a = contact.a;
    friction.b = contact.b;
    // Both forces act at one point, a share of the gap off the surfaces, so that they have no
    // moment.
    const double radii = body.radius + (contact.b >= 0 ? scene.bodies[b].radius : 0.0);
    const double reach = (radii + contact.gap) / radii;
    friction.ja = {-t.x(), -t.y(), -body.radius * reach};
    friction.jb = {t.x(), t.y(), contact.b >= 0 ? -scene.bodies[b].radius * reach : 0.0};
    weigh(world.scratch.mobility, friction);
  }
  bool middles = false;
  for (Row& row : world.scratch.rows) {
    if (row.kind != RowKind::pinch_middle) continue;
    bound_pinch_friction(scene, world, row);
    middles = true;
  }
  if (middles && world.configuration.solver == Solver::direct) find_repeated_middles(world);
}

}  // namespace pinchlab
