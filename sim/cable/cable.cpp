// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/cable.h"

#include <algorithm>
#include <numbers>

#include "base/at.h"
#include "sim/cable/creep.h"
#include "sim/cable/held_spans.h"
#include "sim/outline.h"
#include "sim/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

std::size_t tail_link(const CableState& cable, std::size_t segment) {
  return segment == 0 ? cable.links.size() - 1 : segment - 1;
}

}  // namespace

double alpha_head(const CableState& cable, std::size_t link) {
  if (link + 1 < cable.segments.size()) return cable.segments[link + 1].alpha;
  return cable.segments[0].alpha + cable.turning;
}

namespace {

/// Angle (rad) by which the drum is wound up to where its cable has the direction alpha.
double turned_until(const Link& link, double alpha, double angle) {
  return link.layers.way * (link.orientation * (alpha - angle) - link.layers.begins);
}

double material_in_layers(const Link& link, double alpha, double angle) {
  return link.material + link.layers.way * link.layers.length(turned_until(link, alpha, angle));
}

}  // namespace

double material_at(const CableState& cable, std::size_t i, bool at_head, double alpha,
                   double angle) {
  const Link& link = cable.links[i];
  if (link.layers.way != 0) return material_in_layers(link, alpha, angle);
  const double place = link.signed_radius() * (alpha - angle);
  if (cable.rims.empty() || cable.rims[i].laid.empty()) return link.material + place;
  const Rim& rim = cable.rims[i];
  if (rim.slides) return laid_near_end(rim, at_head, link.material + place);
  return link.material + laid_near_end(rim, at_head, place);
}

double arc_of_direction(const CableState& cable, std::size_t i, const Vec2& u) {
  const Link& link = cable.links[i];
  const Vec2 e = link.orientation * left(u);  // direction of the cable at that point of the surface
  const double arrives = cable.segments[i].alpha;
  const double arc = link.orientation * (unwrapped(heading(e), arrives) - arrives);
  return arc < -arc_tolerance ? arc + 2.0 * std::numbers::pi : arc;
}

double tail_material(const CableState& cable, std::size_t i, double angle) {
  return material_at(cable, i, false, cable.segments[i].alpha, angle);
}

double head_material(const CableState& cable, std::size_t i, double angle) {
  return material_at(cable, i, true, alpha_head(cable, i), angle);
}

void begin_layers(const World& world, CableState& cable, std::size_t i, int way) {
  Link& link = cable.links[i];
  const double alpha = way > 0 ? cable.segments[i].alpha : alpha_head(cable, i);
  const double inner = at(world.bodies, link.body).radius + cable.half_width;
  link.layers = {way, inner, cable.half_width / std::numbers::pi,
                 link.orientation * (alpha - body_angle(world, link))};
  cable.fills = true;
  cable.stands = false;
}

int way_of_layers(const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  if (link.orientation == 0 || link.corner >= 0 || cable.closed) return 0;
  const auto holds = [&link](const Link& end) {
    return end.layers.way != 0 && end.orientation == 0 && end.body == link.body;
  };
  if (i > 0 && holds(cable.links[i - 1])) return 1;
  return i + 1 < cable.links.size() && holds(cable.links[i + 1]) ? -1 : 0;
}

Vec2 offset_centre(const World& world, const Link& link) {
  const Vec2& x = at(world.position, link.body);
  const double angle = at(world.angle, link.body);
  if (link.slid == 0.0 || link.corner < 0) return x + turned(link.offset, angle + link.slid);
  const Vec2& corner = at(at(world.bodies, link.body).corners, link.corner);
  return x + turned(corner, angle) + turned(Vec2(link.offset - corner), angle + link.slid);
}

int rim_of(const CableState& cable, int link) {
  const int before = previous_link(cable, link);
  return before >= 0 && is_moored_to(at(cable.links, link), at(cable.links, before))
             ? before
             : next_link(cable, link);
}

double slid_by(const World& world, const CableState& cable, int link) {
  const Link& rim = at(cable.links, rim_of(cable, link));
  const bool slips = at(world.bodies, rim.body).cable_friction < infinity;
  return slips ? -rim.material / rim.signed_radius() : 0.0;
}

Vec2 velocity_of(const World& world, const Link& link) {
  if (link.body < 0) return Vec2::Zero();
  const Vec2& velocity = at(world.velocity, link.body);
  if (is_central(link)) return velocity;
  const Vec2 from_centre = offset_centre(world, link) - at(world.position, link.body);
  return velocity + at(world.angular_velocity, link.body) * left(from_centre);
}

bool is_fastened_inside(const World& world, const CableState& cable, const Link& end) {
  const BodyProperties& b = at(world.bodies, end.body);
  constexpr double rounding = 1e-9;  // an end on the rim, in a file's decimal figures, is on it
  const double margin = (rim_radius(b) + cable.half_width) * (1.0 - rounding);
  if (is_polygon(b)) return outside_of(b.corners, end.offset).distance < margin;
  return end.offset.norm() < margin;
}

namespace {

/// The radius of a drum's outermost turn depends on the direction of the span that leaves it, which
/// depends on that radius, and on that of the drum at its other end, if there is one: by
/// d(alpha)/dR = 1 / length, so that simple iteration contracts by
///     w / (pi length)
/// each time, or, between two drums, by twice that.
void lay_outermost_turns(const World& world, const CableState& cable, std::size_t i, Link& from,
                         Link& to) {
  const bool at_tail = from.layers.way > 0 && from.orientation != 0;
  const bool at_head = to.layers.way < 0 && to.orientation != 0;
  if (!at_tail && !at_head) return;
  // A span as long as half of the cable's width gains a factor pi / 2 with each, all bits with 81;
  // what is shorter still has no room for a turn more or less.
  constexpr int most_rounds = 90;
  const Vec2 a = link_centre(world, from), b = link_centre(world, to);
  const auto stands = [&world](Link& drum, double alpha) {
    const double before = drum.radius, turned = turned_until(drum, alpha, body_angle(world, drum));
    drum.radius = drum.layers.radius(std::max(0.0, turned));
    return std::abs(drum.radius - before) <= 1e-16 * drum.radius;  // not by a bit
  };
  for (int round = 0; round < most_rounds; ++round) {
    const Vec2 e = common_tangent(a, from.signed_radius(), b, to.signed_radius()).direction;
    const double alpha = unwrapped(heading(e), cable.segments[i].alpha);
    const bool tail_stands = !at_tail || stands(from, alpha);
    if ((!at_head || stands(to, alpha)) && tail_stands) return;
  }
}

/// By which share of the sum of their radii the circles of a cable's span that crosses over between
/// them, the one at a (m), may part before it is there. Far above what gaps are right to, which is
/// 1e-12 of a part's extent, coordinates and lengths of cables; less for it to become pinched than
/// to stay so.
double parting_of(const World& world, const CableState& cable, const Segment& span,
                  const Link& from, const Link& to, const Vec2& a) {
  if (!opposite(from, to) || !locates_events(world.configuration)) return 0.0;
  const double extent = std::max(a.cwiseAbs().maxCoeff(), cable.length);
  const double far = 1e-2 * extent / (from.radius + to.radius);
  return (span.was_pinched ? 1e-8 : 1e-9) * std::max(1.0, far);
}

}  // namespace

namespace {

/// update_tangent, of circles whose centres are `a` and `b` (m).
void update_tangent(const World& world, CableState& cable, std::size_t i, const Vec2& a,
                    const Vec2& b) {
  Link& from = cable.links[tail_link(cable, i)];
  Link& to = cable.links[i];
  if (cable.fills && !wound_end(from, to) && !is_side(from, to)) {
    lay_outermost_turns(world, cable, i, from, to);
  }
  Segment& segment = cable.segments[i];
  const double parting = parting_of(world, cable, segment, from, to, a);
  Tangent t = common_tangent(a, from.signed_radius(), b, to.signed_radius(), parting);
  if (wound_end(from, to)) {
    const bool arrives = from.orientation == 0;  // at the body, from its rim
    const Vec2 rim = arrives ? Vec2(a - b) : Vec2(b - a);
    t.direction = (from.orientation + to.orientation) * left(rim.normalized());
    t.length = 0.0;
    t.pinched = true;
  }
  if (from.pinch_middle || to.pinch_middle) {
    // Held between two bodies: the limit of the tangent, also while the bodies part by round-off.
    const double delta = to.signed_radius() - from.signed_radius();
    t.direction = -std::copysign(1.0, delta) / t.distance * left(b - a);
    t.length = 0.0;
    t.pinched = true;
  }
  cable.stands = false;
  segment.moved = true;
  segment.tail_centre = a;
  segment.head_centre = b;
  segment.direction = t.direction;
  segment.length = t.length;
  segment.pinched = t.pinched;
  segment.alpha = unwrapped(heading(t.direction), segment.alpha);
  segment.tail = tangent_point(a, from.signed_radius(), t.direction);
  segment.head = tangent_point(b, to.signed_radius(), t.direction);
}

}  // namespace

void update_tangent(const World& world, CableState& cable, std::size_t i) {
  const Link &from = cable.links[tail_link(cable, i)], &to = cable.links[i];
  update_tangent(world, cable, i, link_centre(world, from), link_centre(world, to));
}

namespace {

/// Of a link that the cable rolls on.
void update_wrap(CableState& cable, Link& link, double arrives, double leaves) {
  link.wrap = link.orientation * (leaves - arrives);
  if (!(link.wrap >= 0.0 || link.pinch_middle)) cable.unwound = true;
}

/// Notes what the whole step asks of a segment whose rest length is up to date, while it is at
/// hand. Zero times what is finite is zero, and sums of that are.
void inspect(CableState& cable, const Segment& segment, double rounding, double& sum) {
  if (is_misfilled(cable, segment, rounding)) cable.misfilled = true;
  sum += 0.0 * (segment.length + segment.rest_length + segment.tension);
}

/// Of a cable that lies in layers, or creeps.
void update_laid_cable(const World& world, CableState& cable) {
  const double rounding = material_rounding(cable);
  double sum = 0.0;
  cable.unwound = cable.misfilled = cable.short_span = false;
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    if (cable.links[i].orientation == 0) continue;
    update_wrap(cable, cable.links[i], cable.segments[i].alpha, alpha_head(cable, i));
  }
  for (std::size_t i = first_segment(cable); i < cable.links.size(); ++i) {
    const std::size_t tail = tail_link(cable, i);
    const Link &to = cable.links[i], &from = cable.links[tail];
    cable.segments[i].rest_length = tail_material(cable, i, body_angle(world, to)) -
                                    head_material(cable, tail, body_angle(world, from)) +
                                    (i == 0 ? cable.length : 0.0);
    if (is_held(cable, i)) cable.segments[i].rest_length -= held_at(cable, i).spare;
    if (is_short(cable.segments[i], from, to)) cable.short_span = true;
    inspect(cable, cable.segments[i], rounding, sum);
  }
  cable.finite = sum == 0.0;
}

/// Material coordinates (m) where a cable meets a link and where it leaves it.
struct Passage {
  double met = 0.0, left = 0.0;
};

/// That of a link that the cable, by its directions there (rad), rolls on or is attached at.
template <bool stands>
inline Passage pass(const World& world, CableState& cable, Link& link, double arrives,
                    double leaves) {
  if (link.orientation == 0) return {link.material, link.material};
  if (!stands) update_wrap(cable, link, arrives, leaves);
  const double radius = link.signed_radius(), angle = at(world.angle, link.body);
  return {link.material + radius * (arrives - angle), link.material + radius * (leaves - angle)};
}

/// Of any other. Where its course stands, wraps and spans are as they were: bodies turn under them.
template <bool stands>
void update_rolled_cable(const World& world, CableState& cable) {
  const double rounding = material_rounding(cable);
  const bool holds = !cable.finest.empty();
  double sum = 0.0;
  bool has_short = false;
  cable.misfilled = false;
  if (!stands) cable.unwound = false;
  Segment* segment = cable.segments.data();
  Segment* const end = segment + cable.segments.size();
  Link* link = cable.links.data();
  const double last = segment->alpha + cable.turning;
  const auto leaves = [&] { return segment + 1 != end ? segment[1].alpha : last; };  // alpha_head
  const Passage first = pass<stands>(world, cable, *link, segment->alpha, leaves());
  double left = first.left;
  for (++segment, ++link; segment != end; ++segment, ++link) {
    const Passage here = pass<stands>(world, cable, *link, segment->alpha, leaves());
    segment->rest_length = here.met - left;
    left = here.left;
    if (holds) {
      const auto i = static_cast<std::size_t>(segment - cable.segments.data());
      if (is_held(cable, i)) segment->rest_length -= held_at(cable, i).spare;
    }
    if (!stands) has_short |= is_short(*segment, link[-1], *link);
    inspect(cable, *segment, rounding, sum);
  }
  if (cable.closed) {
    Segment& closing = cable.segments.front();
    closing.rest_length = first.met - left + cable.length;
    has_short |= is_short(closing, cable.links.back(), cable.links.front());
    inspect(cable, closing, rounding, sum);
  }
  if (!stands) cable.short_span = has_short;
  cable.finite = sum == 0.0;
}

}  // namespace

void update_wraps_and_rest_lengths(const World& world, CableState& cable) {
  if (cable.fills || !cable.rims.empty()) return update_laid_cable(world, cable);
  update_rolled_cable<false>(world, cable);
}

namespace {

/// Where a segment that has moved was when the interval begins.
void begin_segment(Segment& segment) {
  if (!segment.moved) return;
  begin_here(segment);
  segment.moved = false;
  segment.was_pinched = segment.pinched;
}

/// Of a rod, which is straight from end to end and has all of its material there.
bool update_rod(const World& world, CableState& cable, bool begins) {
  const Link &from = cable.links[0], &to = cable.links[1];
  Segment& segment = cable.segments[1];
  if (begins) begin_segment(segment);
  const Vec2 a = link_centre(world, from), b = link_centre(world, to);
  if (a != segment.tail_centre || b != segment.head_centre) {
    const Tangent t = common_tangent(a, 0.0, b, 0.0);
    segment.moved = true;
    segment.tail = segment.tail_centre = a;
    segment.head = segment.head_centre = b;
    segment.direction = t.direction;
    segment.length = t.length;
    if (!cable.piece) segment.alpha = unwrapped(heading(t.direction), segment.alpha);
  }
  segment.rest_length = to.material - from.material;
  cable.finite = 0.0 * (segment.length + segment.rest_length + segment.tension) == 0.0;
  return segment.moved;
}

}  // namespace

namespace {

/// Moored nodes move along with what slips on a disc.
void follow_slip(const World& world, CableState& cable) {
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    if (Link& link = at(cable.links, i); link.moored) link.slid = slid_by(world, cable, i);
  }
}

}  // namespace

bool update_cable(const World& world, CableState& cable, bool begins, bool known) {
  if (cable.rod && cable.rims.empty()) return update_rod(world, cable, begins);
  if (cable.density > 0.0) follow_slip(world, cable);
  if (known && cable.stands) {
    update_rolled_cable<true>(world, cable);
    return false;
  }
  bool moved = false;
  const std::size_t first = first_segment(cable), count = cable.segments.size();
  const bool fills = cable.fills, still_stands = known && !fills;
  bool all_still = !fills && cable.rims.empty();
  const Link* from = &cable.links[tail_link(cable, first)];
  for (std::size_t i = first; i < count; ++i) {
    Segment& segment = cable.segments[i];
    const Link* to = &cable.links[i];
    if (begins) begin_segment(segment);
    const bool still = from->still && to->still;
    all_still = all_still && still;
    if (!(still && still_stands)) {
      const Vec2 a = link_centre(world, *from), b = link_centre(world, *to);
      if (fills || a != segment.tail_centre || b != segment.head_centre) {
        // A try that is taken back may have turned it by more than half a turn, step by step.
        if (!begins) segment.alpha = segment.alpha_before;
        update_tangent(world, cable, i, a, b);
      }
    }
    moved = moved || segment.moved;
    from = to;
  }
  update_wraps_and_rest_lengths(world, cable);
  cable.stands = all_still && !moved;
  return moved;
}

void turn_pieces(const Parts& parts, World& world) {
  for (const Part& part : parts.list) {
    if (!part.has_mass) continue;
    for (const int c : cables_of(parts, part)) {
      CableState& cable = at(world.cables, c);
      if (!cable.piece || !cable.segments[1].moved) continue;
      Segment& segment = cable.segments[1];
      segment.alpha = unwrapped(heading(segment.direction), segment.alpha);
    }
  }
}

void update_segments(World& world, Workspace& work) {
  work.released.clear();
  work.spans_moved = false;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    if (is_idle(work.parts, c)) continue;
    const bool moved = update_cable(world, world.cables[c], true, is_known(work));
    lay_down(world, world.cables[c]);
    work.spans_moved = work.spans_moved || moved;
  }
}

bool slides_somewhere(const World& world, const CableState& cable) {
  return std::any_of(cable.links.begin(), cable.links.end(), [&world](const Link& link) {
    return link.orientation != 0 && at(world.bodies, link.body).cable_friction < infinity;
  });
}

bool rubs_somewhere(const World& world, const CableState& cable) {
  return std::any_of(cable.links.begin(), cable.links.end(), [&world](const Link& link) {
    return link.orientation != 0 && at(world.bodies, link.body).cable_friction > 0.0;
  });
}

}  // namespace pinchlab
