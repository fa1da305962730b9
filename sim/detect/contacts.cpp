// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/contacts.h"

#include <algorithm>
#include <tuple>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/strung.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/pieces.h"
#include "sim/touch.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// How much nearer two things whose speeds add up to `speed` may come within the next step,
/// generously.
double reach(const Scene& scene, const World& world, double speed, double radius) {
  const double h = world.step_length;
  return 2.0 * h * (speed + scene.gravity.norm() * h) + 0.01 * radius;
}

/// Of a pair they come in their order, those of walls after all of pairs.
bool comes_before(const Contact& p, const Contact& q) {
  if (p.a != q.a) return p.a < q.a;
  if (p.b != q.b) return p.b < q.b;
  return std::tie(p.wall, p.piece, p.touch, p.point) < std::tie(q.wall, q.piece, q.touch, q.point);
}

/// Old contacts of pairs, or of bodies and obstacles, that are asked for in their order.
class Kept {
 public:
  explicit Kept(const std::vector<Contact>& old) : next_(old.begin()), end_(old.end()) {}

  /// Between bodies that are where they were, what was a contact is one; how many there are.
  std::size_t keep(int a, int b, int wall, std::vector<Contact>& to, int piece = -1) {
    const auto comes_before = [a, b, wall, piece](const Contact& c) {
      if (c.a != a) return c.a < a;
      if (c.b != b) return c.b < b;
      return c.wall != wall ? c.wall < wall : c.piece < piece;
    };
    while (next_ != end_ && comes_before(*next_)) ++next_;
    const std::size_t before = to.size();
    for (; next_ != end_ && next_->a == a && next_->b == b && next_->wall == wall &&
           next_->piece == piece;
         ++next_) {
      to.push_back(*next_);
    }
    return to.size() - before;
  }

 private:
  std::vector<Contact>::const_iterator next_, end_;
};

double speed_of(const World& world, int body) {
  return at(world.velocity, body).norm();
}

/// By which a polygon's outline may come nearer as it turns.
double rim_speed_of(const World& world, int body) {
  const BodyProperties& b = at(world.bodies, body);
  return is_polygon(b) ? b.radius * std::abs(at(world.angular_velocity, body)) : 0.0;
}

/// The gaps (m) at which a pair has a contact at most. Circles about polygons come no nearer as
/// these turn, so that what the broad phase lists, by where bodies get to, is enough.
struct MostGap {
  double circles, outlines;
};

/// Of two with a cable of that width (m) between, whose speeds add up to `speed` and those of their
/// rims to `rims` (m/s), the smaller of that radius (m).
MostGap most_gap(const Scene& scene, const World& world, double width, double speed, double rims,
                 double radius) {
  const double circles = width + reach(scene, world, speed, radius);
  return {circles, rims > 0.0 ? width + reach(scene, world, speed + rims, radius) : circles};
}

/// Whether the body is where it was. A node that has only just come was not in any part.
bool is_where_it_was(const World& world, const Parts& parts, int body) {
  if (!is_still(parts, body)) return false;
  return parts.list.empty() || at(parts.of_body, body) >= 0 ||
         !may_change_gaps(at(world.bodies, body));
}

/// How far a body may get by the end of the step; by what it may get in all of it, parts were
/// divided.
double way_left(const Scene& scene, const World& world, const Neighbourhoods& near, int body) {
  const double gained = scene.gravity.norm() * world.step_length;
  return 2.0 * near.left_of(body) * (speed_of(world, body) + gained);
}

/// The contacts of body `a` with body `b`, or with an obstacle (b = -1), whose nearest point or
/// centre lies by `d` (m) from that of `a`, with circles of `radii` (m) in sum.
void add_contacts(World& world, int a, int b, int wall, const Vec2& d, double radii,
                  const MostGap& most) {
  const double distance = d.norm();
  if (distance - radii > most.circles) return;
  if (is_polygon(at(world.bodies, a)) || (b >= 0 && is_polygon(at(world.bodies, b)))) {
    append_touches(world, a, b, wall, most.outlines, world.contacts);
    return;
  }
  const Vec2 somewhere = b >= 0 ? Vec2(1.0, 0.0) : Vec2(0.0, -1.0);
  Contact& contact = world.contacts.emplace_back();
  contact.a = a;
  contact.b = b;
  contact.wall = wall;
  contact.normal = distance > 0.0 ? Vec2(d / distance) : somewhere;
  contact.gap = distance - radii;
}

/// Whether one of them is a node beside the other along its cable.
bool lies_beside(const World& world, const BodyPair& pair) {
  if (at(world.bodies, pair.a).node) return lies_beside(world, pair.a, pair.b);
  return at(world.bodies, pair.b).node && lies_beside(world, pair.b, pair.a);
}

/// Appends the contacts of bodies and walls; returns how many were kept.
std::size_t add_contacts_of_walls(const Scene& scene, World& world, const Workspace& work,
                                  const std::vector<Contact>& old) {
  std::size_t kept = 0;
  Kept old_of_walls(old);
  for (const WallPair& pair : work.broad_phase.wall_pairs) {
    if (!may_change_gaps(at(world.bodies, pair.body))) continue;
    if (is_where_it_was(world, work.parts, pair.body)) {
      kept += old_of_walls.keep(pair.body, -1, pair.wall, world.contacts);
      continue;
    }
    const Obstacle& obstacle = at(world.obstacles, pair.wall);
    const Vec2& x = at(world.position, pair.body);
    const Vec2 d = nearest_on_line(obstacle.a, obstacle.b, x) - x;
    const double radius = at(world.bodies, pair.body).radius;
    const double speed = speed_of(world, pair.body);
    const MostGap most = most_gap(scene, world, 0.0, speed, rim_speed_of(world, pair.body), radius);
    add_contacts(world, pair.body, -1, pair.wall, d, radius + obstacle.radius, most);
  }
  return kept;
}

/// Greatest speed of a piece's ends (m/s).
double speed_of_piece(const World& world, const CableState& piece) {
  return std::max(velocity_of(world, piece.links[0]).norm(),
                  velocity_of(world, piece.links[1]).norm());
}

bool is_where_it_was(const World& world, const Parts& parts, const PiecePair& pair) {
  if (pair.body >= 0 && !is_where_it_was(world, parts, pair.body)) return false;
  const std::vector<Link>& links = at(world.cables, pair.cable).links;
  return std::all_of(links.begin(), links.end(), [&](const Link& link) {
    return link.body < 0 || is_where_it_was(world, parts, link.body);
  });
}

MostGap most_gap(const Scene& scene, const World& world, double width, const BodyPair& pair) {
  const double a = at(world.bodies, pair.a).radius, b = at(world.bodies, pair.b).radius;
  // Bodies that move together have no speed between them until one is stopped within the step.
  const double speed = speed_of(world, pair.a) + speed_of(world, pair.b);
  const double rims = rim_speed_of(world, pair.a) + rim_speed_of(world, pair.b);
  return most_gap(scene, world, width, speed, rims, std::min(a, b));
}

MostGap most_gap(const Scene& scene, const World& world, const PiecePair& pair) {
  const CableState& piece = at(world.cables, pair.cable);
  const double speed =
      speed_of_piece(world, piece) + (pair.body >= 0 ? speed_of(world, pair.body) : 0.0);
  const double rim = pair.body >= 0 ? rim_speed_of(world, pair.body) : 0.0;
  return most_gap(scene, world, 0.0, speed, rim, piece.half_width);
}

/// Of a pair with a body (m).
double distance_from_piece(const World& world, const PiecePair& pair) {
  const CableState& piece = at(world.cables, pair.cable);
  const double distance =
      distance_from_line(link_centre(world, piece.links[0]), link_centre(world, piece.links[1]),
                         at(world.position, pair.body));
  return distance - piece.half_width - at(world.bodies, pair.body).radius;
}

/// Appends the contacts of pieces of hanging cables; returns how many were kept.
std::size_t add_contacts_of_pieces(const Scene& scene, World& world, Workspace& work,
                                   const std::vector<Contact>& old) {
  std::size_t kept = 0;
  Kept old_of_pieces(old);
  Neighbourhoods& near = work.neighbourhoods;
  for (const PiecePair& pair : work.broad_phase.piece_pairs) {
    if (is_where_it_was(world, work.parts, pair)) {
      kept += old_of_pieces.keep(pair.a, pair.b, pair.wall, world.contacts, pair.cable);
      continue;
    }
    const MostGap most = most_gap(scene, world, pair);
    const int node = node_of_piece(world, pair.cable);
    if (pair.body >= 0 && near.separate_bodies(node, pair.body)) {
      double left = way_left(scene, world, near, pair.body);
      for (const Link& link : at(world.cables, pair.cable).links) {
        if (link.body >= 0 && !is_static(at(world.bodies, link.body))) {
          left = std::max(left, way_left(scene, world, near, pair.body) +
                                    way_left(scene, world, near, link.body));
        }
      }
      near.crossed = near.crossed || distance_from_piece(world, pair) <= left;
      continue;
    }
    const bool turns = most.outlines > most.circles;
    if (turns && distance_from_piece(world, pair) > most.circles) continue;
    append_at_piece(world, pair.cable, pair.body, pair.wall, most.outlines, world.contacts);
  }
  return kept;
}

bool is_same(const Contact& p, const Contact& q) {
  return p.a == q.a && p.b == q.b && p.wall == q.wall && p.touch == q.touch && p.point == q.point &&
         p.piece == q.piece;
}

/// Whether a contact's pair had others before, in the list about `near`, with no cable between.
bool was_bare(const std::vector<Contact>& old, std::vector<Contact>::const_iterator near,
              const Contact& contact) {
  const auto is_of_pair = [&contact](const Contact& one) {
    return one.a == contact.a && one.b == contact.b && one.wall == contact.wall;
  };
  while (near != old.begin() && is_of_pair(*(near - 1))) --near;
  const auto end = std::find_if_not(near, old.end(), is_of_pair);
  return near != end &&
         std::all_of(near, end, [](const Contact& one) { return one.cable_between < 0; });
}

/// What the last solve left of the contacts that there were.
void carry_over(const std::vector<Contact>& old, std::vector<Contact>& contacts) {
  auto previous = old.begin();
  for (Contact& contact : contacts) {
    const auto is_there = [&] { return previous != old.end() && is_same(*previous, contact); };
    bool there = is_there();  // mostly
    if (!there) {
      while (previous != old.end() && comes_before(*previous, contact)) ++previous;
      there = is_there();
    }
    if (there) {
      contact.touching = previous->touching && contact.away == 0;
      contact.slip = previous->slip;
      contact.normal_force = previous->normal_force;
      contact.tangent_force = previous->tangent_force;
      contact.curvature = previous->curvature;
      contact.struck = previous->struck;
      contact.bare = previous->cable_between < 0;
      // Found anew at the same instant it has not parted yet.
      contact.rebounds = previous->rebounds && contact.gap == previous->gap;
    } else if (contact.touch != Touch::circles) {
      contact.bare = was_bare(old, previous, contact);
    }
  }
}

}  // namespace

double widest_cable(const World& world) {
  double width = 0.0;
  if (world.configuration.method != Method::cable) {
    for (const CableState& cable : world.cables) width = std::max(width, thickness(cable));
  }
  return width;
}

bool may_touch(const Scene& scene, const World& world, double width, const BodyPair& pair) {
  const double radii = at(world.bodies, pair.a).radius + at(world.bodies, pair.b).radius;
  const double distance = (at(world.position, pair.b) - at(world.position, pair.a)).norm();
  return distance - radii <= most_gap(scene, world, width, pair).circles;
}

bool may_touch(const Scene& scene, const World& world, const PiecePair& pair) {
  return distance_from_piece(world, pair) <= most_gap(scene, world, pair).circles;
}

void find_contacts(const Scene& scene, World& world, Workspace& work) {
  bool& all_kept = work.contacts.contacts_kept;
  std::vector<Contact>& old = work.contacts.old_contacts;
  const BroadPhase& broad = work.broad_phase;
  if (world.contacts.empty() && broad.body_pairs.empty() && broad.wall_pairs.empty() &&
      broad.piece_pairs.empty()) {
    all_kept = true;
    old.clear();
    return;
  }
  all_kept = !work.parts.list.empty() && !work.parts.any_moves;
  if (all_kept) return;
  std::swap(old, world.contacts);
  world.contacts.clear();
  if (!broad.piece_pairs.empty() && follow_along_chains(world, old)) {
    std::sort(old.begin(), old.end(), comes_before);
  }
  std::size_t kept = 0;
  const double width = widest_cable(world);
  Kept old_pairs(old);
  Neighbourhoods& near = work.neighbourhoods;
  for (const BodyPair& pair : broad.body_pairs) {
    if (is_where_it_was(world, work.parts, pair.a) && is_where_it_was(world, work.parts, pair.b)) {
      kept += old_pairs.keep(pair.a, pair.b, -1, world.contacts);
      continue;
    }
    const double radii = at(world.bodies, pair.a).radius + at(world.bodies, pair.b).radius;
    const Vec2 d = at(world.position, pair.b) - at(world.position, pair.a);
    if (near.separate_bodies(pair.a, pair.b)) {
      const double left =
          width + way_left(scene, world, near, pair.a) + way_left(scene, world, near, pair.b);
      near.crossed = near.crossed || d.norm() - radii <= left;
      continue;
    }
    const MostGap most = most_gap(scene, world, width, pair);
    if (!world.strung.empty() && d.norm() - radii <= most.circles && lies_beside(world, pair))
      continue;
    add_contacts(world, pair.a, pair.b, -1, d, radii, most);
  }
  kept += add_contacts_of_walls(scene, world, work, old);
  if (!world.pieces_at.empty()) {
    for (Contact& contact : world.contacts) contact.away = is_left_to_pieces(world, contact);
    kept += add_contacts_of_pieces(scene, world, work, old);
  }
  const bool mixed = !broad.wall_pairs.empty() || !broad.piece_pairs.empty();
  if (mixed && !std::ranges::is_sorted(world.contacts, comes_before)) {
    std::sort(world.contacts.begin(), world.contacts.end(), comes_before);
  }
  all_kept = kept == world.contacts.size() && kept == old.size();
  carry_over(old, world.contacts);
}

}  // namespace pinchlab
