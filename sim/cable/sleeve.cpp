// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/cable/sleeve.h"

#include <algorithm>
#include <iterator>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/cable/mass.h"
#include "sim/compound.h"
#include "sim/tangent.h"
#include "sim/touch.h"

namespace pinchlab {

namespace {

bool lies_loose(const World& world, const Link& link) {
  return link.orientation != 0 && !link.pinch_middle &&
         at(world.bodies, link.body).cable_friction < infinity;
}

/// The link beyond a pinch or a side before this one, where what lies at it slips there as well;
/// else -1.
int part_before(const World& world, const CableState& cable, int link) {
  const int before = previous_link(cable, link);
  if (before < 0) return -1;
  if (is_slipping_side(world, at(cable.links, before), at(cable.links, link))) return before;
  return at(cable.links, before).pinch_middle ? previous_link(cable, before) : -1;
}

/// The last link of what begins with `first`: beyond each pinch, and along each side, it goes on.
int last_part(const World& world, const CableState& cable, int first) {
  int last = first;
  for (std::size_t seen = 0; seen < cable.links.size(); ++seen) {
    const int after = next_link(cable, last);
    if (after < 0) break;
    if (is_slipping_side(world, at(cable.links, last), at(cable.links, after))) {
      last = after;
      continue;
    }
    if (!at(cable.links, after).pinch_middle) break;
    last = next_link(cable, after);
  }
  return last;
}

/// Whether the segment between the two goes to an end of the cable that the same body holds.
bool is_fast(const Link& end, const Link& link) {
  return end.orientation == 0 && !end.moored && end.body == link.body;
}

bool is_fast(const CableState& cable, int first, int last) {
  const int before = previous_link(cable, first), after = next_link(cable, last);
  return (before >= 0 && is_fast(at(cable.links, before), at(cable.links, first))) ||
         (after >= 0 && is_fast(at(cable.links, after), at(cable.links, last)));
}

/// Calls `visit(first, last, goes_on)` for each sleeve of a cable.
template <class Visit>
void each_sleeve(const World& world, const CableState& cable, Visit visit) {
  for (int i = 0; index(i) < cable.links.size(); ++i) {
    if (!lies_loose(world, at(cable.links, i))) continue;
    if (part_before(world, cable, i) >= 0) continue;  // from there
    const int last = last_part(world, cable, i);
    if (is_fast(cable, i, last)) continue;
    int first = i;
    for (int link = i; link != last; link = next_link(cable, link)) {
      const Link &from = at(cable.links, link), &to = at(cable.links, next_link(cable, link));
      if (!is_slipping_side(world, from, to) || is_side_of_sleeve(world, from, to)) continue;
      visit(first, link, first != i);
      first = next_link(cable, link);
    }
    visit(first, last, first != i);
  }
}

/// m/s at which a segment between links that do not slip gets longer than its material.
double stretching(const World& world, const CableState& cable, int segment) {
  const Vec2& e = at(cable.segments, segment).direction;
  const auto along = [&](const Link& link) {
    if (link.body < 0) return 0.0;
    const Vec2 z = left(Vec2(link_centre(world, link) - at(world.position, link.body))) +
                   link.signed_radius() * e;
    return e.dot(at(world.velocity, link.body) + at(world.angular_velocity, link.body) * z);
  };
  return along(at(cable.links, segment)) - along(at(cable.links, previous_link(cable, segment)));
}

}  // namespace

bool is_slipping_side(const World& world, const Link& from, const Link& to) {
  return from.corner >= 0 && from.orientation != 0 && to.corner >= 0 && from.body == to.body &&
         lies_loose(world, to);
}

bool is_side_of_sleeve(const World& world, const Link& from, const Link& to) {
  return is_slipping_side(world, from, to) &&
         at(world.bodies, mover_of(world, to.body)).kind == BodyKind::fixed;
}

bool has_sleeves(const World& world, const CableState& cable) {
  bool any = false;
  if (is_massed(cable)) each_sleeve(world, cable, [&any](int, int, bool) { any = true; });
  return any;
}

void list_sleeves(const World& world, int number, std::vector<Sleeve>& to) {
  const CableState& cable = at(world.cables, number);
  if (!is_massed(cable)) return;
  each_sleeve(world, cable, [&](int first, int last, bool goes_on) {
    Sleeve& sleeve = to.emplace_back();
    sleeve.cable = number;
    sleeve.first = first;
    sleeve.last = last;
    sleeve.goes_on = goes_on;
    const Link& link = at(cable.links, first);
    sleeve.body = link.body;
    if (link.corner < 0 && mover_of(world, link.body) == link.body) return;
    sleeve.centre = link_centre(world, link) - at(world.position, mover_of(world, link.body));
  });
}

int span_before(const CableState& cable, const Sleeve& sleeve) {
  const int before = previous_link(cable, sleeve.first);
  const bool moored = is_moored_to(at(cable.links, before), at(cable.links, sleeve.first));
  return moored ? before : sleeve.first;
}

int span_after(const CableState& cable, const Sleeve& sleeve) {
  const int after = next_link(cable, sleeve.last);
  const bool moored = is_moored_to(at(cable.links, after), at(cable.links, sleeve.last));
  return moored ? next_link(cable, after) : after;
}

int sleeve_at(const World& world, const std::vector<Sleeve>& sleeves, int cable, int link) {
  const CableState& of = at(world.cables, cable);
  if (at(of.links, link).moored) link = rim_of(of, link);
  if (!lies_loose(world, at(at(world.cables, cable).links, link))) return -1;
  const auto begin = std::lower_bound(sleeves.begin(), sleeves.end(), cable,
                                      [](const Sleeve& s, int c) { return s.cable < c; });
  if (begin == sleeves.end() || begin->cable != cable) return -1;
  auto end = std::upper_bound(begin, sleeves.end(), cable,
                              [](int c, const Sleeve& s) { return c < s.cable; });
  const auto number = [&sleeves](auto found) { return static_cast<int>(found - sleeves.begin()); };
  const auto holds = [link](const Sleeve& s) {
    if (s.first > s.last) return link >= s.first || link <= s.last;
    return s.first <= link && link <= s.last;
  };
  // In the order of their links, but for the last, which may go on beyond the seam of a loop.
  for (; std::prev(end)->first < begin->first; --end) {
    if (holds(*std::prev(end))) return number(std::prev(end));
  }
  const auto after =
      std::upper_bound(begin, end, link, [](int l, const Sleeve& s) { return l < s.first; });
  if (after != begin && holds(*std::prev(after))) return number(std::prev(after));
  return holds(*std::prev(end)) ? number(std::prev(end)) : -1;
}

double turning_at(const World& world, int cable, int number) {
  const CableState& of = at(world.cables, cable);
  const Link& link = at(of.links, at(of.links, number).moored ? rim_of(of, number) : number);
  if (link.body < 0) return 0.0;
  const double turning = at(world.angular_velocity, link.body);
  return lies_loose(world, link) ? turning + link.slip_speed / link.signed_radius() : turning;
}

int tail_of(const std::vector<Sleeve>& sleeves, int k) {
  while (index(k + 1) < sleeves.size() && sleeves[index(k + 1)].goes_on) ++k;
  return k;
}

int head_of(const std::vector<Sleeve>& sleeves, int k) {
  while (at(sleeves, k).goes_on) --k;
  return k;
}

bool is_on_sleeve(const World& world, const CableState& cable, int link) {
  if (!is_massed(cable)) return false;
  if (at(cable.links, link).moored) link = rim_of(cable, link);
  if (!lies_loose(world, at(cable.links, link))) return false;
  int first = link;
  for (std::size_t seen = 0; seen < cable.links.size(); ++seen) {
    const int before = part_before(world, cable, first);
    if (before < 0) break;
    first = before;
  }
  return !is_fast(cable, first, last_part(world, cable, first));
}

Vec2 pivot_of_link(const World& world, const CableState& cable, int number) {
  const Link& link = at(cable.links, number);
  const int mover = mover_of(world, link.body);
  if (link.corner < 0 && mover == link.body) return at(world.position, mover);
  // Of what is fixed all but a sleeve stands.
  const bool fixed = link.corner >= 0 && at(world.bodies, mover).kind == BodyKind::fixed;
  if (!fixed && !is_on_sleeve(world, cable, number)) return at(world.position, mover);
  return place_of_point(world, link.body, link.corner);
}

Vec2 velocity_at(const World& world, const CableState& cable, int link, const Vec2& z) {
  const int body = mover_or_world(world, at(cable.links, link));
  if (index(body) == world.bodies.size()) return Vec2::Zero();
  const auto number = static_cast<int>(&cable - world.cables.data());
  const Vec2 centre = pivot_of_link(world, cable, link) - at(world.position, body);
  return at(world.velocity, body) + at(world.angular_velocity, body) * left(centre) +
         turning_at(world, number, link) * z;
}

bool is_carried_round(const World& world, const Sleeve& sleeve) {
  return !sleeve.centre.isZero(0.0) &&
         at(world.bodies, mover_of(world, sleeve.body)).kind != BodyKind::fixed;
}

Eigen::Vector3d velocity_of(const World& world, const Sleeve& sleeve) {
  const int mover = mover_of(world, sleeve.body);
  const Vec2 v =
      at(world.velocity, mover) + at(world.angular_velocity, mover) * left(sleeve.centre);
  return {v.x(), v.y(), turning_at(world, sleeve.cable, sleeve.first)};
}

void set_slip(CableState& cable, const Sleeve& sleeve, Slip slip, double speed) {
  for (int i = sleeve.first;; i = next_link(cable, i)) {
    Link& link = at(cable.links, i);
    if (!link.pinch_middle) {
      link.slip = slip;
      link.slip_speed = speed;
    }
    if (i == sleeve.last) return;
  }
}

namespace {

/// Sleeves that follow one another with no link between that the cable does not slip at.
struct LooseRun {
  std::size_t first = 0, count = 0;
  bool round = false;  // a whole closed cable, that slips everywhere
};

/// Of the way from a sleeve, or from a link that the cable does not slip at, to the next.
struct Between {
  double material = 0.0, stretching = 0.0;  // m, m/s if nothing slipped
  bool held = false;                        // there is such a link on the way

  void add(const World& world, const CableState& cable, int segment) {
    material += std::max(at(cable.segments, segment).rest_length, 0.0);
    stretching += pinchlab::stretching(world, cable, segment);
  }
};

/// Before sleeve k of a cable that has these, and no others. A side of a polygon slips as one.
Between before_sleeve(const World& world, const CableState& cable,
                      const std::vector<Sleeve>& sleeves, std::size_t k) {
  Between way;
  if (sleeves[k].goes_on) return way;
  int i = sleeves[k].first;
  const int last = sleeves[(k + sleeves.size() - 1) % sleeves.size()].last;
  way.add(world, cable, i);
  for (i = previous_link(cable, i); i != last && !way.held; i = previous_link(cable, i)) {
    way.held = !at(cable.links, i).pinch_middle;
    if (!way.held) way.add(world, cable, i);
  }
  return way;
}

/// m, of what lies on a sleeve and moves along with it.
double material_at(const CableState& cable, const Sleeve& sleeve) {
  const auto half = [&cable](int segment) {
    return 0.5 * std::max(at(cable.segments, segment).rest_length, 0.0);
  };
  double material = 0.0;
  for (int i = sleeve.first;; i = next_link(cable, i)) {
    material += half(i) + stored_length(at(cable.links, i)) + half(next_link(cable, i));
    if (i == sleeve.last) return material;
  }
}

/// Where a run's ends move so that its spans must stretch, all do alike, whatever end the cable is
/// written from. What slips all round has no slip on the average of its material.
void begin_slip(const World& world, CableState& cable, const std::vector<Sleeve>& sleeves,
                const LooseRun& run) {
  std::vector<Between> ways;
  Between whole;
  const auto sleeve = [&](std::size_t k) -> const Sleeve& {
    return sleeves[(run.first + k) % sleeves.size()];
  };
  for (std::size_t k = 0; k < run.count; ++k) {
    ways.push_back(before_sleeve(world, cable, sleeves, (run.first + k) % sleeves.size()));
    whole.material += ways[k].material;
    whole.stretching += ways[k].stretching;
  }
  if (!run.round) whole.add(world, cable, next_link(cable, sleeve(run.count - 1).last));
  const double strain_rate = whole.material > 0.0 ? whole.stretching / whole.material : 0.0;
  std::vector<double> speeds;
  double speed = 0.0, flow = 0.0, material = 0.0;
  for (std::size_t k = 0; k < run.count; ++k) {
    speed -= ways[k].stretching - strain_rate * ways[k].material;
    speeds.push_back(speed);
    const double moved = material_at(cable, sleeve(k));
    flow += moved * speed;
    material += moved;
  }
  const double mean = run.round ? flow / material : 0.0;
  for (std::size_t k = 0; k < run.count; ++k) {
    set_slip(cable, sleeve(k), Slip::stick, speeds[k] - mean);
  }
}

/// Of all its sleeves.
void begin_slip(const World& world, CableState& cable, const std::vector<Sleeve>& sleeves) {
  const std::size_t count = sleeves.size();
  const auto begins = [&](std::size_t k) {
    return (!cable.closed && k == 0) || before_sleeve(world, cable, sleeves, k).held;
  };
  std::size_t first = 0;
  while (first < count && !begins(first)) ++first;
  if (first == count) return begin_slip(world, cable, sleeves, {0, count, true});
  for (std::size_t done = 0; done < count;) {
    LooseRun run{(first + done) % count, 1, false};
    while (done + run.count < count && !begins((run.first + run.count) % count)) ++run.count;
    begin_slip(world, cable, sleeves, run);
    done += run.count;
  }
}

}  // namespace

void begin_slip(const Scene& scene, World& world) {
  std::vector<Sleeve> sleeves;
  for (int c = 0; index(c) < world.cables.size(); ++c) {
    CableState& cable = at(world.cables, c);
    if (!is_massed(cable) || at(scene.cables, c).slack > 0.0) continue;
    sleeves.clear();
    list_sleeves(world, c, sleeves);
    if (!sleeves.empty()) begin_slip(world, cable, sleeves);
  }
}

}  // namespace pinchlab
