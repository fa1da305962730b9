// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/links.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/joins.h"
#include "sim/cable/taking_in.h"
#include "sim/tangent.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Below this wrap (rad, so the same for scenes of any size) a link is gone. Far above round-off,
/// far below what a frame could show.
constexpr double gone = -1e-9;

std::ptrdiff_t offset(std::size_t i) {
  return static_cast<std::ptrdiff_t>(i);
}

/// What the rim of the later of two links on a body carries becomes part of the earlier one's, from
/// where that ends on.
void take_over(CableState& cable, int link, int later) {
  if (cable.rims.empty() || at(cable.rims, link).laid.empty()) return;
  const Rim& other = at(cable.rims, later);
  if (other.laid.empty()) return;
  std::vector<Laid>& all = at(cable.rims, link).laid;
  const double end = all.back().place;
  const double apart = origin_of_rim(cable, index(link)) - origin_of_rim(cable, index(later));
  const double shift = all.back().material - laid_material(other, end - apart);
  all.back().slope = other.comes_on_at_tail;
  for (const Laid& laid : other.laid) {
    const double place = laid.place + apart;
    if (place <= end) {
      all.back().slope = laid.slope;
    } else {
      all.push_back({place, laid.material + shift, laid.slope});
    }
  }
  sum_moments(cable, index(link));
}

/// What the spans between two links had more than lies there now that these are one is with the
/// span after it, of which `had` (m) was the material before: half of it goes to the other side.
void share_excess(World& world, CableState& cable, int link, double had) {
  const double excess = at(cable.segments, next_link(cable, link)).rest_length - had;
  if (std::abs(excess) <= material_rounding(cable)) return;
  shift_material(cable, link, 0.5 * excess);
  update_wraps_and_rest_lengths(world, cable);
}

/// Notes it in Workspace::released, in its cable's place.
void note_release(Workspace& work, const Release& release) {
  const auto place =
      std::upper_bound(work.released.begin(), work.released.end(), release,
                       [](const Release& p, const Release& q) { return p.cable < q.cable; });
  work.released.insert(place, release);
}

}  // namespace

void remove_link(World& world, CableState& cable, int link) {
  const int before = previous_link(cable, link), after = next_link(cable, link);
  // The neighbours of what goes may have been middle links of a pinch: they are ordinary ones now,
  // and how the cable slipped there is over.
  for (const int neighbour : {before, after}) {
    Link& now = at(cable.links, neighbour);
    if (now.pinch_middle) now.slip_speed = 0.0;
    now.pinch_middle = false;
  }
  const Link &one = at(cable.links, before), &other = at(cable.links, after);
  const bool merge = before != after && one.body == other.body && one.corner == other.corner &&
                     one.orientation == other.orientation && one.orientation != 0;
  const bool of_corner = !merge && at(cable.links, link).corner >= 0;
  const int kept = before - (link < before ? 1 : 0) - (after < before ? 1 : 0);  // in a merge
  const double beyond = merge ? at(cable.segments, next_link(cable, after)).rest_length : 0.0;
  count_changes(world, cable, 1);
  // A segment goes with the link that it arrives at; the one that leaves from the link stays and is
  // computed anew from the link before. In a merge the earlier link on the body stays.
  const auto erase = [&cable](int i) {
    cable.links.erase(cable.links.begin() + i);
    cable.segments.erase(cable.segments.begin() + i);
    if (!cable.rims.empty()) cable.rims.erase(cable.rims.begin() + i);
  };
  if (merge) {
    take_over(cable, before, after);
    erase(std::max(link, after));
    erase(std::min(link, after));
  } else {
    erase(link);
  }
  // Of a polygon's corner only the segment that closes up is new; a cable may have very many.
  const std::size_t closed_up = index(link) % cable.segments.size();
  const std::size_t first = of_corner ? closed_up : first_segment(cable);
  const std::size_t end = of_corner ? closed_up + 1 : cable.segments.size();
  for (std::size_t i = first; i < end; ++i) {
    const Vec2 tail = cable.segments[i].tail, head = cable.segments[i].head;
    update_tangent(world, cable, i);
    if (cable.segments[i].tail != tail || cable.segments[i].head != head) {
      begin_here(cable.segments[i]);
    }
  }
  update_wraps_and_rest_lengths(world, cable);
  if (merge) share_excess(world, cable, kept, beyond);
  lay_down(world, cable);
}

bool needed(const CableState& cable, std::size_t i) {
  if (!cable.closed) return false;
  int body = -1;
  for (std::size_t k = 0; k < cable.links.size(); ++k) {
    const Link& link = cable.links[k];
    if (k == i || link.pinch_middle) continue;
    if (body >= 0 && link.body != body) return false;
    body = link.body;
  }
  return true;
}

bool has_come_off(const CableState& cable, std::size_t i) {
  const Link& link = cable.links[i];
  return link.orientation != 0 && !link.pinch_middle && link.wrap < gone && !needed(cable, i);
}

void take_off(World& world, Workspace& work, int cable, int link) {
  CableState& state = at(world.cables, cable);
  const Link off = at(state.links, link);
  for (const int beside : {previous_link(state, link), next_link(state, link)}) {
    if (beside < 0 || !is_moored_to(at(state.links, beside), off)) continue;
    work.neighbourhoods.follow(cast_off_node(world, state, beside), cable);
    work.broad_phase.boxes.clear();  // for bodies with other outlines
  }
  note_release(work, {cable, off.body, off.orientation});
  leave_body(world, state, link);
}

bool remove_links(World& world, Workspace& work) {
  bool any = false;
  for (std::size_t c = 0; c < world.cables.size(); ++c) {
    CableState& cable = world.cables[c];
    bool changed = cable.unwound && !is_idle(work.parts, c);
    while (changed) {
      changed = false;
      for (std::size_t i = 0; i < cable.links.size(); ++i) {
        if (has_come_off(cable, i)) {
          take_off(world, work, static_cast<int>(c), static_cast<int>(i));
          changed = any = true;
          break;
        }
      }
    }
  }
  return any;
}

Link rolling_link(const BodyProperties& properties, int body, int corner, int orientation,
                  double half_width) {
  Link link;
  link.body = body;
  link.corner = corner;
  link.orientation = orientation;
  link.radius = (corner < 0 ? properties.radius : properties.corner_radius) + half_width;
  link.still = corner < 0 && !can_move(properties);
  if (corner >= 0) link.offset = at(properties.corners, corner);
  return link;
}

void insert_link(World& world, CableState& cable, std::size_t segment, int body, int corner,
                 int orientation) {
  // A link put into the segment that closes a loop comes last, so that indices stay where they are.
  const std::size_t position = segment == 0 ? cable.links.size() : segment;
  Segment& old = cable.segments[segment];
  if (cable.links.size() == 2 && !cable.closed) {  // no body has counted its turns so far
    old.alpha = first_heading(old.direction, orientation);
  }
  const auto from = index(previous_link(cable, static_cast<int>(segment)));

  const Link link =
      rolling_link(at(world.bodies, body), body, corner, orientation, cable.half_width);
  cable.links.insert(cable.links.begin() + offset(position), link);
  Segment arriving = old;
  if (segment == 0) arriving.alpha = old.alpha + cable.turning;
  cable.segments.insert(cable.segments.begin() + offset(position), arriving);
  if (!cable.rims.empty()) cable.rims.insert(cable.rims.begin() + offset(position), Rim{});

  const std::size_t leaving = segment == 0 ? 0 : position + 1;
  update_tangent(world, cable, position);
  update_tangent(world, cable, leaving);
  Segment& first = cable.segments[position];
  Segment& second = cable.segments[leaving];
  begin_here(first);
  begin_here(second);
  // Both parts get the same strain: rest lengths in the ratio of the lengths. The material to share
  // is what lies between the neighbours' new tangents: they have turned, by much where the body is
  // near.
  count_changes(world, cable, 1);
  if (const int way = way_of_layers(cable, position); way != 0) {
    begin_layers(world, cable, position, way);
  }
  Link& added = cable.links[position];
  const std::size_t to = leaving;  // a segment arrives at the link of its index
  const double start = head_material(cable, from, body_angle(world, cable.links[from]));
  const double end =
      tail_material(cable, to, body_angle(world, cable.links[to])) + (to == 0 ? cable.length : 0.0);
  added.wrap = orientation * (alpha_head(cable, position) - first.alpha);
  const double stored = stored_length(added);
  const double free_length = first.length + second.length;
  const double share = free_length > 0.0 ? first.length / free_length : 0.5;
  double arrives = start + share * (end - start - stored);
  // A side keeps the strain that it comes on with. So the tension does not jump, and no stretch is
  // left behind to the span. Of what is being hung, where nothing pulls yet, it has none.
  const double slope = free_length > 0.0 ? (end - start - stored) / free_length : 1.0;
  const bool pulls = cable.elastic && arriving.tension > 0.0;
  const double a_metre = pulls ? std::clamp(slope, 0.0, 1.0) : 1.0;  // m of material
  const auto make_side = [](Segment& side) {  // without a row, which alone would change them
    side.tension = 0.0;
    side.slack = false;
  };
  if (is_side(cable.links[from], added)) {
    arrives = start + a_metre * first.length;
    make_side(first);
  }
  if (is_side(added, cable.links[to])) {
    arrives = end - a_metre * second.length - stored;
    make_side(second);
  }
  added.material += arrives - tail_material(cable, position, body_angle(world, added));
  begin_to_carry(world, cable, position);
  update_wraps_and_rest_lengths(world, cable);
  lay_down(world, cable);
}

namespace {

/// Gives a new middle link the material of the link before it where both meet, so that none is
/// stored between them: by the tangent, as the arc of a body that has just come off the very end
/// of the wrap is that end.
void hold_where_pressed(const World& world, CableState& cable, std::size_t middle) {
  Link& link = cable.links[middle];
  const Link& whole = cable.links[middle - 1];
  const double alpha = cable.segments[middle].alpha;
  const double pressed = material_at(cable, middle - 1, false, alpha, body_angle(world, whole));
  const double place = link.signed_radius() * (alpha - body_angle(world, link));
  link.material = pressed - place;
  const bool carries = !cable.rims.empty() && !cable.rims[middle - 1].laid.empty() &&
                       may_carry(world, cable, middle);
  if (!carries) return;
  Rim& rim = cable.rims[middle];
  rim.slides = slides_with_mass(world, cable, link);
  const double from = place + origin_of_rim(cable, middle);
  rim.laid = {{from, from, 1.0}};
}

}  // namespace

void insert_pinches(World& world, CableState& cable, std::span<const NewPinch> pinches) {
  std::vector<Link> links;
  std::vector<Segment> segments;
  std::vector<Rim> rims;
  links.reserve(cable.links.size() + 2 * pinches.size());
  segments.reserve(links.capacity());
  std::vector<std::size_t> middles;  // links
  auto next = pinches.begin();
  for (std::size_t i = 0; i < cable.links.size(); ++i) {
    const Link& whole = cable.links[i];
    links.push_back(whole);
    segments.push_back(cable.segments[i]);
    if (!cable.rims.empty()) rims.push_back(cable.rims[i]);
    for (; next != pinches.end() && index(next->link) == i; ++next) {
      Segment between;
      between.alpha = cable.segments[i].alpha + whole.orientation * next->arc;
      Link middle;
      middle.body = next->body;
      middle.orientation = -whole.orientation;
      middle.radius = at(world.bodies, next->body).radius + cable.half_width;
      middle.still = !can_move(at(world.bodies, next->body));
      middle.pinch_middle = true;
      if (!cable.rims.empty()) {
        rims.emplace_back();
        rims.push_back(cable.rims[i]);
        rims.back().slope = 0.0;
      }
      middles.push_back(links.size());
      for (const Link& link : {middle, whole}) {
        links.push_back(link);
        segments.push_back(between);
      }
    }
  }
  cable.links.swap(links);
  cable.segments.swap(segments);
  cable.rims.swap(rims);
  count_changes(world, cable, static_cast<int>(pinches.size()));
  for (const std::size_t middle : middles) {
    for (const std::size_t s : {middle, middle + 1}) {
      update_tangent(world, cable, s);
      begin_here(cable.segments[s]);
    }
    hold_where_pressed(world, cable, middle);
  }
  update_wraps_and_rest_lengths(world, cable);
  lay_down(world, cable);
}

}  // namespace pinchlab
