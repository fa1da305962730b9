// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/pieces.h"

#include <algorithm>
#include <array>

#include "base/at.h"
#include "sim/compound.h"
#include "sim/lines.h"
#include "sim/outline.h"
#include "sim/seams.h"
#include "sim/touch.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

// Along a chain, within an interval: ends a search that goes to and fro over a bend. Nothing moves
// by so many pieces at once.
constexpr int most_hops = 64;
// The radius at which cable may lie on what touches it, in lengths of a piece: round what is larger
// the nodes follow its curve, with pieces less than an eighth of their length off it.
constexpr double most_curved = 1.0;

bool sleeps(const CableState& piece) {
  return piece.pieces == 0;
}

/// Where an end of a piece is (m).
Vec2 place_of_end(const World& world, const Link& end) {
  if (end.body < 0) return end.offset;
  const Vec2& centre = at(world.position, end.body);
  if (end.offset == Vec2::Zero()) return centre;
  return centre + turned(end.offset, at(world.angle, end.body));
}

/// A piece's line, and the foot of a point on it.
struct Line {
  Vec2 tail, way;      // m
  double share = 0.0;  // of the foot, anywhere on the line gone on with

  Line(const World& world, int cable, const Vec2& point) {
    const CableState& piece = at(world.cables, cable);
    tail = place_of_end(world, piece.links[0]);
    way = place_of_end(world, piece.links[1]) - tail;
    const double square = way.squaredNorm();
    share = square > 0.0 ? (point - tail).dot(way) / square : 0.5;
  }

  Vec2 at_share(double s) const { return tail + s * way; }
};

/// What touches pieces.
struct Toucher {
  int body = -1, wall = -1;
  Vec2 place;
  double radius = 0.0;
};

Toucher toucher_of(const World& world, int body, int wall, int point) {
  if (body >= 0) {
    return {body, -1, place_of_point(world, body, point), rim_radius(at(world.bodies, body))};
  }
  const Obstacle& obstacle = at(world.obstacles, wall);
  return {-1, wall, point == 0 ? obstacle.a : obstacle.b, obstacle.radius};
}

Toucher toucher_of(const World& world, const Contact& contact) {
  return toucher_of(world, body_at_piece(world, contact), contact.wall, contact.point);
}

/// The piece before or, with `ahead`, after one, that the toucher meets too; or -1.
int neighbour(const World& world, int cable, bool ahead, const Toucher& toucher) {
  const int node = at(world.cables, cable).links[ahead ? 1 : 0].body;
  if (node < 0 || !at(world.bodies, node).node) return -1;
  const PiecesAtNode& joint = at(world.pieces_at, node);
  const int other = ahead ? joint.after : joint.before;
  return other >= 0 && meets_piece(world, other, toucher.body, toucher.wall) ? other : -1;
}

/// Whether a chain bends away from a point where the second of two pieces follows the first.
bool bends_away(const Line& first, const Line& second, const Vec2& point) {
  return cross(first.way, point - first.tail) * cross(first.way, second.way) <= 0.0;
}

/// -1 or +1 where a nearer place is before the piece or after it; 0: it is on it, or at its end.
int away_from(const World& world, int cable, const Toucher& toucher) {
  const Line line(world, cable, toucher.place);
  if (line.share > 0.0 && line.share < 1.0) return 0;
  const bool ahead = line.share >= 1.0;
  const int next = neighbour(world, cable, ahead, toucher);
  if (next < 0) return 0;
  if (!ahead) return -1;
  return Line(world, next, toucher.place).share > 0.0 ? 1 : 0;
}

/// Whether what is `way` (m) off now, from the point to the foot, has come to the far side through
/// the piece rather than round it. `before`: (m) then.
bool has_gone_through(const Vec2& before, const Vec2& way, double radii) {
  return way.dot(before) < 0.0 && distance_from_line(before, way, Vec2::Zero()) < radii;
}

/// The foot at `share` of a piece; `before` as above, or no way at all where nothing is known.
Foot foot_at(const World& world, int cable, const Line& line, double share, const Toucher& toucher,
             const Vec2& before) {
  Foot foot;
  foot.cable = cable;
  foot.share = share;
  foot.place = toucher.place;
  foot.radius = toucher.radius;
  const double radii = toucher.radius + at(world.cables, cable).half_width;
  const Vec2 way = line.at_share(share) - toucher.place;
  double distance = way.norm();
  if (has_gone_through(before, way, radii)) distance = -distance;
  if (distance != 0.0) {
    foot.way = way / distance;
  } else {
    foot.way =
        before.squaredNorm() > 0.0 ? Vec2(before.normalized()) : Vec2(left(line.way).normalized());
  }
  foot.gap = distance - radii;
  return foot;
}

/// From what touches the piece to its foot when the contact was measured last (m).
Vec2 way_before(const World& world, const Contact& contact, const Toucher& toucher) {
  const double way = contact.gap + toucher.radius + at(world.cables, contact.piece).half_width;
  return (contact.a == toucher.body ? way : -way) * contact.normal;
}

Foot foot_along(const World& world, int cable, const Toucher& toucher, const Vec2& before) {
  for (int hop = 0;; ++hop) {
    const Line line(world, cable, toucher.place);
    if (line.share > 0.0 && line.share < 1.0) {
      return foot_at(world, cable, line, line.share, toucher, before);
    }
    const bool ahead = line.share >= 1.0;
    const double end = ahead ? 1.0 : 0.0;
    const int next = neighbour(world, cable, ahead, toucher);
    if (next < 0 || hop == most_hops) return foot_at(world, cable, line, end, toucher, before);
    const Line other(world, next, toucher.place);
    const bool at_node = ahead ? other.share <= 0.0 : other.share >= 1.0;
    const bool away =
        ahead ? bends_away(line, other, toucher.place) : bends_away(other, line, toucher.place);
    if (at_node || !away) return foot_at(world, cable, line, end, toucher, before);
    cable = next;
  }
}

/// Fills in which bodies a contact has: the node that stands for the piece and what touches it.
void name_bodies(const World& world, int cable, const Toucher& toucher, Contact& contact) {
  const int node = node_of_piece(world, cable);
  contact.piece = cable;
  contact.wall = toucher.wall;
  contact.a = toucher.body >= 0 ? std::min(node, toucher.body) : node;
  contact.b = toucher.body >= 0 ? std::max(node, toucher.body) : -1;
}

void set_from(const Foot& foot, int body, Contact& contact) {
  contact.gap = foot.gap;
  contact.normal = contact.a == body ? foot.way : Vec2(-foot.way);
}

}  // namespace

int body_at_piece(const World& world, const Contact& contact) {
  if (contact.b < 0) return -1;
  return at(world.bodies, contact.a).node ? contact.b : contact.a;
}

int node_of_piece(const World& world, int cable) {
  for (const Link& link : at(world.cables, cable).links) {
    if (link.body >= 0 && at(world.bodies, link.body).node) return link.body;
  }
  return -1;
}

bool meets_piece(const World& world, int cable, int body, int wall) {
  const int key = body >= 0 ? body : -1 - wall;
  if (!world.passing.empty() &&
      std::binary_search(world.passing.begin(), world.passing.end(), std::array{cable, key})) {
    return false;
  }
  if (body < 0) return true;
  const BodyProperties& properties = at(world.bodies, body);
  if (properties.node || !properties.outlined) return false;
  const CableState& piece = at(world.cables, cable);
  if (rim_radius(properties) + piece.half_width > most_curved * piece.length) return false;
  const int mover = mover_of(world, body);
  return std::none_of(piece.links.begin(), piece.links.end(), [&](const Link& link) {
    return link.body >= 0 && mover_of(world, link.body) == mover;
  });
}

bool is_met_by_pieces(const World& world, int node, int body, int wall) {
  if (world.pieces_at.empty()) return false;
  const PiecesAtNode& joint = at(world.pieces_at, node);
  return (joint.before >= 0 && meets_piece(world, joint.before, body, wall)) ||
         (joint.after >= 0 && meets_piece(world, joint.after, body, wall));
}

namespace {

/// The piece, or what it is part of at present.
int awake_piece(const Scene& scene, const World& world, int cable) {
  while (sleeps(at(world.cables, cable))) {
    const auto chain = std::ranges::find(scene.chains, cable, &NodeChain::first_piece);
    cable = chain != scene.chains.end() ? chain->cable : cable - 1;
  }
  return cable;
}

/// How far a point (m) is from a body's outline (m).
double distance_from_outline(const World& world, int body, const Vec2& point) {
  const BodyProperties& properties = at(world.bodies, body);
  const Vec2 from = point - at(world.position, body);
  if (!is_polygon(properties)) return from.norm() - properties.radius;
  const Vec2 inside = turned(from, -at(world.angle, body));
  return outside_of(properties.corners, inside).distance - properties.corner_radius;
}

}  // namespace

void join_pieces(const Scene& scene, World& world) {
  world.pieces_at.assign(world.bodies.size(), {});
  world.passing = world.passing_at_ends;
  for (auto& [piece, passing] : world.passing) piece = awake_piece(scene, world, piece);
  const auto is_node = [&world](int body) { return body >= 0 && at(world.bodies, body).node; };
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const CableState& cable = at(world.cables, c);
    if (!cable.piece || sleeps(cable)) continue;
    if (is_node(cable.links[0].body)) at(world.pieces_at, cable.links[0].body).after = c;
    if (is_node(cable.links[1].body)) at(world.pieces_at, cable.links[1].body).before = c;
  }
  for (const auto& [a, b] : scene.apart) {
    const int node = is_node(a) ? a : is_node(b) ? b : -1;
    if (node < 0) continue;
    const PiecesAtNode& joint = at(world.pieces_at, node);
    for (const int c : {joint.before, joint.after}) {
      if (c >= 0) world.passing.push_back({c, node == a ? b : a});
    }
  }
  std::sort(world.passing.begin(), world.passing.end());
}

void let_pass_at_ends(const Scene& scene, double allowed, World& world) {
  world.passing_at_ends.clear();
  BoxTree walls, bodies;
  find_extents(world.obstacles, walls);
  for (int b = 0; index(b) < world.bodies.size(); ++b) {
    const BodyProperties& body = at(world.bodies, b);
    if (body.node || !body.outlined) continue;
    const Vec2 reach = Vec2::Constant(body.radius);
    bodies.add(at(world.position, b) - reach, at(world.position, b) + reach, b);
  }
  bodies.build();
  std::vector<int> near;
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    const CableState& cable = at(world.cables, c);
    if (!cable.piece) continue;
    const double most = cable.half_width - allowed;
    const Vec2 reach = Vec2::Constant(most);
    for (const Link& link : cable.links) {
      if (link.body >= 0) continue;
      bodies.list(link.offset - reach, link.offset + reach, near);
      for (const int b : near) {
        if (distance_from_outline(world, b, link.offset) < most) {
          world.passing_at_ends.push_back({c, b});
        }
      }
      walls.list(link.offset - reach, link.offset + reach, near);
      for (const int w : near) {
        const Obstacle& wall = at(world.obstacles, w);
        if (distance_from_line(wall.a, wall.b, link.offset) - wall.radius < most) {
          world.passing_at_ends.push_back({c, -1 - w});
        }
      }
    }
  }
  join_pieces(scene, world);
}

void find_tips(std::vector<Obstacle>& obstacles) {
  constexpr double near = 1e-9;  // of lengths
  BoxTree walls;
  find_extents(obstacles, walls);
  for (int w = 0; index(w) < obstacles.size(); ++w) {
    Obstacle& wall = at(obstacles, w);
    if (wall.cable >= 0) continue;
    const double length = (wall.b - wall.a).norm();
    const Vec2 room = Vec2::Constant(near * length);
    for (const std::size_t end : {0U, 1U}) {
      const auto& nooks = wall.nooks[end];
      // Between walls on both sides nothing stands out.
      if (nooks[0].length > 0.0 && nooks[1].length > 0.0) continue;
      const Vec2& here = end == 0 ? wall.a : wall.b;
      const bool repeats = walls.any(here - room, here + room, [&](int before) {
        const Obstacle& other = at(obstacles, before);
        const double allowed = near * (length + (other.b - other.a).norm());
        return before < w && other.cable < 0 &&
               std::min((other.a - here).norm(), (other.b - here).norm()) <= allowed;
      });
      wall.tips[end] = repeats ? Tipped::of_another : Tipped::own;
    }
  }
}

Foot foot_of(const World& world, const Contact& contact) {
  const Toucher toucher = toucher_of(world, contact);
  return foot_along(world, contact.piece, toucher, way_before(world, contact, toucher));
}

double gap_of_piece(const World& world, const Contact& contact) {
  if (contact.away == 0) return foot_of(world, contact).gap;
  const Toucher toucher = toucher_of(world, contact);
  const Line line(world, contact.piece, toucher.place);
  if (line.share <= 0.0 || line.share >= 1.0) return infinity;
  const bool ahead = contact.away > 0;
  const int next = neighbour(world, contact.piece, ahead, toucher);
  if (next >= 0) {
    const Line other(world, next, toucher.place);
    const bool away =
        ahead ? bends_away(line, other, toucher.place) : bends_away(other, line, toucher.place);
    if (away) return infinity;
  }
  const Vec2 before = way_before(world, contact, toucher);
  return foot_at(world, contact.piece, line, line.share, toucher, before).gap;
}

void measure_piece(const World& world, Contact& contact) {
  const Toucher toucher = toucher_of(world, contact);
  const Vec2 before = way_before(world, contact, toucher);
  if (contact.away == 0) {
    return set_from(foot_along(world, contact.piece, toucher, before), toucher.body, contact);
  }
  const Line line(world, contact.piece, toucher.place);
  const double share = std::clamp(line.share, 0.0, 1.0);
  set_from(foot_at(world, contact.piece, line, share, toucher, before), toucher.body, contact);
}

void append_at_piece(const World& world, int cable, int body, int wall, double most,
                     std::vector<Contact>& to) {
  const auto append = [&](int point) {
    const Toucher toucher = toucher_of(world, body, wall, point);
    const Line line(world, cable, toucher.place);
    const double share = std::clamp(line.share, 0.0, 1.0);
    const Foot foot = foot_at(world, cable, line, share, toucher, Vec2::Zero());
    if (foot.gap > most) return;
    Contact contact;
    name_bodies(world, cable, toucher, contact);
    contact.touch = Touch::piece;
    contact.point = static_cast<std::int8_t>(point);
    contact.away = static_cast<std::int8_t>(away_from(world, cable, toucher));
    set_from(foot, body, contact);
    to.push_back(contact);
  };
  if (body < 0) {
    for (const int end : {0, 1}) {
      if (at(world.obstacles, wall).tips[index(end)] == Tipped::own) append(end);
    }
    return;
  }
  const BodyProperties& properties = at(world.bodies, body);
  const int points = is_polygon(properties) ? static_cast<int>(properties.corners.size()) : 1;
  for (int point = 0; point < points; ++point) append(point);
}

bool is_left_to_pieces(const World& world, const Contact& contact) {
  if (world.pieces_at.empty() || contact.touch == Touch::piece) return false;
  const int node = at(world.bodies, contact.a).node                     ? contact.a
                   : contact.b >= 0 && at(world.bodies, contact.b).node ? contact.b
                                                                        : -1;
  if (node < 0) return false;
  const int body = contact.b < 0 ? -1 : contact.a == node ? contact.b : contact.a;
  const Vec2& x = at(world.position, node);
  if (!is_met_by_pieces(world, node, body, contact.wall)) return false;
  if (body < 0) {
    const Obstacle& wall = at(world.obstacles, contact.wall);
    const Vec2 d = wall.b - wall.a;
    const double along = d.dot(x - wall.a);
    if (along > 0.0 && along < d.squaredNorm()) return false;
    return wall.tips[along <= 0.0 ? 0U : 1U] != Tipped::none;
  }
  const BodyProperties& properties = at(world.bodies, body);
  if (!is_polygon(properties)) return true;
  const Vec2 inside = turned(x - at(world.position, body), -at(world.angle, body));
  const std::vector<Vec2>& corners = properties.corners;
  const Outside out = outside_of(corners, inside);
  if (!(out.distance > 0.0)) return false;
  // Nearest to a corner, and not beside a side.
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const Vec2 &p = corners[k], &q = corners[(k + 1) % corners.size()];
    const Vec2 side = q - p;
    const double along = side.dot(inside - p);
    const bool is_before = cross(side, inside - p) < 0.0;  // outside of it
    if (is_before && along > 0.0 && along < side.squaredNorm()) return false;
  }
  return true;
}

bool follow_along_chains(const World& world, std::vector<Contact>& contacts) {
  bool any = false;
  for (Contact& contact : contacts) {
    if (contact.touch != Touch::piece || !contact.touching || contact.away != 0) continue;
    if (sleeps(at(world.cables, contact.piece))) continue;
    const Toucher toucher = toucher_of(world, contact);
    int cable = foot_of(world, contact).cable;
    // A node is of the piece that ends there.
    if (away_from(world, cable, toucher) < 0) {
      const int before = neighbour(world, cable, false, toucher);
      if (before >= 0) cable = before;
    }
    if (cable == contact.piece) continue;
    name_bodies(world, cable, toucher, contact);
    any = true;
  }
  return any;
}

}  // namespace pinchlab
