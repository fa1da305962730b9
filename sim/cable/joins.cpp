// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/joins.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/cable/links.h"
#include "sim/cable/mass.h"
#include "sim/cable/sleeve.h"
#include "sim/compound.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

using Eigen::Vector3d;

/// Velocities of a body, or of its sleeve `at_sleeve` (-1: the body itself).
Vector3d motion_of(const World& world, int body, const std::vector<Sleeve>& sleeves,
                   int at_sleeve) {
  if (at_sleeve >= 0) return at(sleeves, at_sleeve).velocity;
  const Vec2& v = at(world.velocity, body);
  return {v.x(), v.y(), at(world.angular_velocity, body)};
}

/// Changes a body's velocities (m/s, m/s, rad/s), and with them those of its shapes.
void hasten(World& world, int body, const Vector3d& change) {
  at(world.velocity, body) += change.head<2>();
  at(world.angular_velocity, body) += change.z();
  for (const int shape : world.carried) {
    if (at(world.bodies, shape).carrier == body) carry(world, shape);
  }
}

/// Gives the body, or its sleeve, an impulse (N s, N s, N m s), which it takes up with what it
/// carries, and with all of its sleeves and what is on theirs.
void push(World& world, int body, const Eigen::Matrix3d& carried,
          const std::vector<Sleeve>& sleeves, int at_sleeve, const Vector3d& impulse) {
  std::vector<int> on_body;
  std::vector<Eigen::Index> turns;  // which of the velocities below its angle is
  Eigen::Index count = 3;
  for (std::size_t k = 0; k < sleeves.size(); ++k) {
    if (mover_of(world, sleeves[k].body) != body) continue;
    on_body.push_back(static_cast<int>(k));
    if (!sleeves[k].goes_on) ++count;
    turns.push_back(count - 1);
  }
  const BodyProperties& properties = at(world.bodies, body);
  Eigen::Matrix3d own = carried;
  add_moments(own, properties.mass, Vec2::Zero(), inertia_of(properties));
  if (on_body.empty()) {
    if (is_mobile(properties)) hasten(world, body, inverse_for(properties, own) * impulse);
    return;
  }
  // Of the velocities (x, y, angle; angles of sleeves) those that what holds the body leaves free.
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd given = Eigen::VectorXd::Zero(count);
  all.topLeftCorner<3, 3>() = own;
  if (at_sleeve < 0) given.head<3>() = impulse;
  for (std::size_t k = 0; k < on_body.size(); ++k) {
    const Sleeve& sleeve = at(sleeves, on_body[k]);
    Eigen::MatrixXd sees = Eigen::MatrixXd::Zero(3, count);  // the sleeve of these velocities
    sees.topLeftCorner<2, 2>().setIdentity();
    sees.block<2, 1>(0, 2) = left(sleeve.centre);
    sees(2, turns[k]) = 1.0;
    all += sees.transpose() * sleeve.mass * sees;
    if (on_body[k] == at_sleeve) given += sees.transpose() * impulse;
  }
  const auto body_ways = ways_of(properties);
  Eigen::MatrixXd ways = Eigen::MatrixXd::Zero(count, body_ways.cols() + count - 3);
  ways.topLeftCorner(3, body_ways.cols()) = body_ways;
  ways.bottomRightCorner(count - 3, count - 3).setIdentity();
  const Eigen::MatrixXd there = ways.transpose() * all * ways;
  const Eigen::VectorXd change = ways * there.ldlt().solve(ways.transpose() * given);
  hasten(world, body, change.head<3>());
  for (std::size_t k = 0; k < on_body.size(); ++k) {
    const Sleeve& sleeve = at(sleeves, on_body[k]);
    CableState& cable = at(world.cables, sleeve.cable);
    const Link& link = at(cable.links, sleeve.first);
    const double faster = change(turns[k]) - change.z();
    set_slip(cable, sleeve, link.slip, link.slip_speed + faster * link.signed_radius());
  }
}

/// A link that has been put in at a polygon's corner slips with what lies on the side beside it.
void slip_along(const World& world, CableState& cable, int link) {
  Link& added = at(cable.links, link);
  for (const int beside : {previous_link(cable, link), next_link(cable, link)}) {
    if (beside < 0 || !is_slipping_side(world, at(cable.links, beside), added)) continue;
    added.slip = at(cable.links, beside).slip;
    added.slip_speed = at(cable.links, beside).slip_speed;
    return;
  }
}

/// Changes velocities as if a mass with velocity u had joined the body, or its sleeve, at z, where
/// `carried` and the sleeves have that mass already.
void take_up(World& world, int body, const Eigen::Matrix3d& carried,
             const std::vector<Sleeve>& sleeves, int at_sleeve, double mass, const Vec2& z,
             const Vec2& u) {
  const Vec2 own = at_place(motion_of(world, body, sleeves, at_sleeve), z);
  push(world, body, carried, sleeves, at_sleeve, on_body(mass * (u - own), z));
}

/// Those of a link that is no more. Where they have become one, `merged`, that is `before`.
struct Neighbours {
  int before = 0, after = 0;
  bool merged = false;
};

/// Removes the link from between them.
Neighbours remove_between(World& world, CableState& cable, int link) {
  const auto links = static_cast<int>(cable.links.size());
  remove_link(world, cable, link);
  const auto left_over = static_cast<int>(cable.links.size());
  const bool merged = left_over + 2 == links, first_gone = merged && link == links - 1;
  const int after = link % left_over;
  return {first_gone ? left_over - 1 : previous_link(cable, after), after, merged};
}

/// Whether the neighbours of a node's link come to be the ends of a side that slips.
bool closes_side(const World& world, const CableState& cable, int link) {
  const int before = previous_link(cable, link), after = next_link(cable, link);
  return at(cable.links, link).orientation == 0 && before >= 0 && after >= 0 &&
         is_slipping_side(world, at(cable.links, before), at(cable.links, after));
}

/// What slips is to have this impulse besides; at the corner that it was at, on another sleeve.
struct Surplus {
  int corner = -1;
  Vec2 centre = Vec2::Zero();
  Vector3d impulse = Vector3d::Zero();
};

/// Lets all that slips as one with sleeve k slip at `speed`. Appends the momentum that it loses.
void slip_alike(CableState& cable, const std::vector<Sleeve>& sleeves, int k, double speed,
                std::vector<Surplus>& lost) {
  for (int i = head_of(sleeves, k); i <= tail_of(sleeves, k); ++i) {
    const Sleeve& sleeve = at(sleeves, i);
    const Link& link = at(cable.links, sleeve.first);
    const double slower = (link.slip_speed - speed) / link.signed_radius();
    lost.push_back({link.corner, sleeve.centre, slower * sleeve.mass.col(2)});
    set_slip(cable, sleeve, link.slip, speed);
  }
}

/// Gives a body, or what lies there of the sleeves that slip as one with k (-1: nothing slips),
/// what was to be given at a corner.
void give_back(World& world, int body, const Eigen::Matrix3d& carried,
               const std::vector<Sleeve>& sleeves, int k, const Surplus& lost) {
  if (k < 0) {
    const Vec2 force = lost.impulse.head<2>();
    const Vector3d turned = on_body(force, left(lost.centre)) + Vector3d(0, 0, lost.impulse.z());
    return push(world, body, carried, sleeves, -1, turned);
  }
  int there = head_of(sleeves, k);
  const auto corner = [&](int i) {
    const Sleeve& sleeve = at(sleeves, i);
    return at(at(world.cables, sleeve.cable).links, sleeve.first).corner;
  };
  while (there < tail_of(sleeves, k) && corner(there) != lost.corner) ++there;
  push(world, body, carried, sleeves, there, lost.impulse);
}

/// Removes such a link. What slips on either side of it goes on as one along the side, with the
/// momentum of both, and that of a node which is not moored.
void close_side(World& world, CableState& cable, int link) {
  const auto number = static_cast<int>(&cable - world.cables.data());
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const int before = previous_link(cable, link), after = next_link(cable, link);
  const Link node = at(cable.links, link);
  const Vec2 x = link_centre(world, node);
  const Vec2 u = node.moored ? Vec2::Zero() : at(world.velocity, node.body);
  const auto half = [&](int segment) {  // kg, which goes to the other end of the side
    const double material = std::max(material_of_span(cable, index(segment)), 0.0);
    return node.moored ? 0.0 : 0.5 * cable.density * material;
  };
  const double to_after = half(link), to_before = half(after);
  const int at_before = sleeve_at(world, sleeves, number, before);
  const int at_after = sleeve_at(world, sleeves, number, after);
  const bool slips = at_before >= 0 && at_after >= 0;
  const double speed = slips ? at(cable.links, before).slip_speed : 0.0;
  std::vector<Surplus> lost;
  for (const int k : {at_before, at_after}) {
    if (k >= 0) slip_alike(cable, sleeves, k, speed, lost);
  }
  const int body = mover_of(world, at(cable.links, before).body);
  const Neighbours now = remove_between(world, cable, link);
  find_carried(world, carried, sleeves);
  const int k = sleeve_at(world, sleeves, number, now.before);
  for (const Surplus& one : lost) give_back(world, body, at(carried, body), sleeves, k, one);
  if (node.moored || (k < 0 && !is_mobile(at(world.bodies, body)))) return;
  const auto take = [&](int beside, double mass, const Vec2& z) {
    find_carried(world, carried, sleeves);  // with new velocities
    const int sleeve = sleeve_at(world, sleeves, number, beside);
    take_up(world, body, at(carried, body), sleeves, sleeve, mass, z, u);
  };
  if (now.merged) {
    const Vec2 z = left(Vec2(x - pivot_of_link(world, cable, now.before)));
    return take(now.before, to_before + to_after, z);
  }
  const MassedSpan side = span_of(world, cable, index(now.after));
  take(now.before, to_before, side.z_a);
  take(now.after, to_after, side.z_b);
}

}  // namespace

void meet_body(World& world, CableState& cable, std::size_t segment, int body, int corner,
               int orientation) {
  if (!is_massed(cable)) {
    insert_link(world, cable, segment, body, corner, orientation);
    return;
  }
  if (is_held(cable, segment)) let_go(world, cable, segment);
  const int number = static_cast<int>(&cable - world.cables.data());
  const MassedSpan before = span_of(world, cable, segment);
  const int head = static_cast<int>(segment);
  const Vec2 u_a = velocity_at(world, cable, previous_link(cable, head), before.z_a);
  const Vec2 u_b = velocity_at(world, cable, head, before.z_b);
  const std::size_t position = segment == 0 ? cable.links.size() : segment;
  insert_link(world, cable, segment, body, corner, orientation);
  slip_along(world, cable, static_cast<int>(position));
  const int mover = mover_of(world, body);
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const int sleeve = sleeve_at(world, sleeves, number, static_cast<int>(position));
  if (sleeve < 0 && !is_mobile(at(world.bodies, mover))) return;
  const MassedSpan first = span_of(world, cable, position);
  const MassedSpan second = span_of(world, cable, segment == 0 ? 0 : position + 1);
  const double both = first.material + second.material;
  if (!(both > 0.0)) return;
  // Each neighbour has given up its share of the part that it is no longer at.
  const Vec2 u = (second.material * u_a + first.material * u_b) / both;
  take_up(world, mover, at(carried, mover), sleeves, sleeve, 0.5 * cable.density * both, first.z_b,
          u);
}

void leave_body(World& world, CableState& cable, int link) {
  if (!is_massed(cable)) {
    remove_link(world, cable, link);
    return;
  }
  const int number = static_cast<int>(&cable - world.cables.data());
  if (closes_side(world, cable, link)) return close_side(world, cable, link);
  const MassedSpan first = span_of(world, cable, index(link));
  const MassedSpan second = span_of(world, cable, index(next_link(cable, link)));
  const Vec2 u = velocity_at(world, cable, link, first.z_b);
  const Neighbours now = remove_between(world, cable, link);
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const auto give = [&](int to, int at_link, const Vec2& z, double material) {
    if (index(to) == world.bodies.size()) return;
    const int sleeve = sleeve_at(world, sleeves, number, at_link);
    take_up(world, to, at(carried, to), sleeves, sleeve, 0.5 * cable.density * material, z, u);
  };
  give(first.a, now.before, first.z_a, second.material);
  if (!sleeves.empty()) find_carried(world, carried, sleeves);  // with new velocities
  give(second.b, now.merged ? now.before : now.after, second.z_b, first.material);
}

void join_rim(World& world, CableState& cable, int number, int rim) {
  Link& link = at(cable.links, number);
  const Vec2 x = at(world.position, link.body), u = at(world.velocity, link.body);
  link.body = at(cable.links, rim).body;
  link.moored = true;
  link.slid = slid_by(world, cable, number);
  const Link& held_by = at(cable.links, rim);
  const double angle = at(world.angle, link.body);
  Vec2 pivot = Vec2::Zero();  // in the body's frame
  if (held_by.corner >= 0 && at(world.bodies, link.body).cable_friction < infinity) {
    link.corner = held_by.corner;
    pivot = held_by.offset;
  }
  const Vec2 arm = x - at(world.position, link.body) - turned(pivot, angle);
  link.offset = pivot + turned(arm, -angle - link.slid);
  const int mover = mover_of(world, link.body);
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const auto of = static_cast<int>(&cable - world.cables.data());
  const int sleeve = sleeve_at(world, sleeves, of, number);
  if (sleeve < 0 && !is_mobile(at(world.bodies, mover))) return;
  const double mass = end_mass(span_of(world, cable, index(number))) +
                      end_mass(span_of(world, cable, index(next_link(cable, number))));
  const Vec2 z = left(Vec2(x - pivot_of_link(world, cable, number)));
  take_up(world, mover, at(carried, mover), sleeves, sleeve, mass, z, u);
}

namespace {

/// What one of the two neighbours has of the cable, before and after it has gone.
struct Share {
  int body = 0, sleeve = -1;
  bool is_head = false;   // of the span that closes up
  double joins = 0.0;     // kg, half of the other span
  Vec2 z = Vec2::Zero();  // where that joins it
  Vec2 pivot = z;         // m, that z is from
  Eigen::Matrix3d before = Eigen::Matrix3d::Zero(), after = before;
  Vector3d velocity = Vector3d::Zero(), impulse = velocity;
  double gained() const { return after(0, 0) - before(0, 0); }
};

const Eigen::Matrix3d& mass_of(const Share& share, const std::vector<Eigen::Matrix3d>& carried,
                               const std::vector<Sleeve>& sleeves) {
  return share.sleeve < 0 ? at(carried, share.body) : at(sleeves, share.sleeve).mass;
}

/// What is about the node of a link; one where both neighbours are on the same, none of the world.
std::vector<Share> list_shares(const World& world, const CableState& cable, int link,
                               const std::vector<Eigen::Matrix3d>& carried,
                               const std::vector<Sleeve>& sleeves) {
  const auto number = static_cast<int>(&cable - world.cables.data());
  const int before = previous_link(cable, link), after = next_link(cable, link);
  std::vector<Share> shares;
  for (const int beside : {before, after}) {
    const Segment& other = at(cable.segments, beside == before ? after : link);
    Share share;
    share.joins = 0.5 * cable.density * std::max(other.rest_length, 0.0);
    share.body = mover_or_world(world, at(cable.links, beside));
    share.sleeve = sleeve_at(world, sleeves, number, beside);
    share.is_head = beside == after;
    if (index(share.body) == world.bodies.size()) continue;
    share.pivot = pivot_of_link(world, cable, beside);
    if (!shares.empty() && shares[0].body == share.body && shares[0].sleeve == share.sleeve) {
      shares[0].joins += share.joins;
      continue;
    }
    share.before = mass_of(share, carried, sleeves);
    share.velocity = motion_of(world, share.body, sleeves, share.sleeve);
    shares.push_back(share);
  }
  return shares;
}

/// The same when the node at x has gone; whether what was a sleeve is one, and what was none.
bool note_after(const World& world, const CableState& cable, const Neighbours& now, const Vec2& x,
                const std::vector<Eigen::Matrix3d>& carried, const std::vector<Sleeve>& sleeves,
                std::vector<Share>& shares) {
  const auto number = static_cast<int>(&cable - world.cables.data());
  const MassedSpan closed = span_of(world, cable, index(now.after));
  bool alike = true;
  for (Share& share : shares) {
    const bool was_sleeve = share.sleeve >= 0;
    share.sleeve =
        sleeve_at(world, sleeves, number, share.is_head && !now.merged ? now.after : now.before);
    alike = alike && (share.sleeve >= 0) == was_sleeve;
    share.after = mass_of(share, carried, sleeves);
    share.z = now.merged ? left(Vec2(x - share.pivot)) : share.is_head ? closed.z_b : closed.z_a;
  }
  return alike;
}

/// Finds the impulses by which the neighbours take up a node of that mass (kg) and velocity, and
/// what a rim gives off as the cable straightens, which goes to the other one as it moves. Returns
/// the energy (J) that is lost by them.
double share_out(const World& world, double node_mass, const Vec2& u, std::vector<Share>& shares) {
  double passed = node_mass;
  Vec2 momentum = node_mass * u;
  for (const Share& share : shares) {
    if (share.gained() >= 0.0) continue;
    passed -= share.gained();
    momentum -= share.gained() * at_place(share.velocity, share.z);
  }
  double energy = 0.5 * node_mass * u.squaredNorm();
  for (Share& share : shares) {
    const Vec2 joined =
        share.gained() < 0.0 ? at_place(share.velocity, share.z) : Vec2(momentum / passed);
    share.impulse =
        (share.before - share.after) * share.velocity + on_body(share.gained() * joined, share.z);
    const BodyProperties& properties = at(world.bodies, share.body);
    Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
    add_moments(own, properties.mass, Vec2::Zero(), inertia_of(properties));
    const Vector3d now =
        share.velocity + inverse_for(properties, own + share.after) * share.impulse;
    energy += 0.5 * share.velocity.dot((own + share.before) * share.velocity);
    energy -= 0.5 * now.dot((own + share.after) * now);
  }
  return energy;
}

}  // namespace

void leave_node(World& world, CableState& cable, int link) {
  if (closes_side(world, cable, link)) return close_side(world, cable, link);
  const int node = at(cable.links, link).body;
  const Vec2 x = at(world.position, node), u = at(world.velocity, node);
  std::vector<Eigen::Matrix3d> carried;
  std::vector<Sleeve> sleeves;
  find_carried(world, carried, sleeves);
  const double node_mass = at(carried, node)(0, 0);
  std::vector<Share> shares = list_shares(world, cable, link, carried, sleeves);
  const Neighbours now = remove_between(world, cable, link);
  find_carried(world, carried, sleeves);
  const bool alike = note_after(world, cable, now, x, carried, sleeves, shares);
  const double lost = share_out(world, node_mass, u, shares);
  for (const Share& share : shares) {
    const bool keeps = alike && lost >= 0.0 && share.sleeve < 0;
    const Vector3d joins = on_body(share.joins * (u - at_place(share.velocity, share.z)), share.z);
    push(world, share.body, at(carried, share.body), sleeves, share.sleeve,
         keeps ? share.impulse : joins);
    if (!sleeves.empty()) find_carried(world, carried, sleeves);  // with new velocities
  }
}

}  // namespace pinchlab
