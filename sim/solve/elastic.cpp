// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/elastic.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/creep.h"
#include "sim/cable/relax.h"
#include "sim/parts.h"
#include "sim/solve/rows.h"
#include "sim/tangent.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Compliance of so much material (m) of a cable (m/N). It is rounded to 2^-45 of the cable's, 128
/// units in the last place of what it is a difference of: where round-off alone shakes a cable,
/// rows and factors stand, unless the material is next to a boundary of that rounding. Those of the
/// stress scene's segments are all the same, and next to one of 2^-46.
double flexibility_of(const CableState& cable, const Cable& given, double material) {
  const double coarse = 128.0 * cable.length;
  return ((material + coarse) - coarse) / given.axial_stiffness;
}

/// m, of a span at the end of an interval that opens between circles, if they move on as they do;
/// their centres are so far apart (m) at its start.
double length_opening_to(const World& world, const Link& from, const Link& to, double distance,
                         const TimeSpan& t) {
  const double radii = from.radius + to.radius;
  if (from.still && to.still) return distance > radii ? tangent_root(distance, radii) : 0.0;
  const Vec2 a = link_centre(world, from) + t.length * velocity_of(world, from);
  const Vec2 b = link_centre(world, to) + t.length * velocity_of(world, to);
  return common_tangent(a, from.signed_radius(), b, to.signed_radius()).length;
}

/// Of a segment that is short at the interval's start, and opens; 0 of one in a pinch.
double flexibility_of_short(const World& world, const CableState& cable, const Cable& given,
                            const Segment& segment, const Link& from, const Link& to,
                            const TimeSpan& t) {
  const double distance = (segment.head_centre - segment.tail_centre).norm();
  if (segment.pinched && !is_let_go(world, segment, from, to, distance)) return 0.0;
  const double material = segment.pinched ? 0.0 : elastic_material(cable, segment);
  const double length = length_opening_to(world, from, to, distance, t);
  return flexibility_of(cable, given, std::max(material, length));
}

/// Of a segment; 0 of one in a pinch. One that opens is as flexible as at the interval's end: it
/// may begin with next to nothing, and one that closes, which the same reversed in time does, is
/// taken as it is at its start.
inline double flexibility_of(const World& world, const CableState& cable, const Cable& given,
                             const Segment& segment, int i, const TimeSpan& t) {
  constexpr double short_share = 0.1;  // of the sum of the radii: what is longer opens little
  const Link &to = at(cable.links, i), &from = at(cable.links, previous_link(cable, i));
  if (t.length > 0.0 && opposite(from, to) &&
      segment.length < short_share * (from.radius + to.radius)) {
    return flexibility_of_short(world, cable, given, segment, from, to, t);
  }
  if (segment.pinched) return 0.0;
  return flexibility_of(cable, given, elastic_material(cable, segment));
}

/// a - b, for what is as flexible (m/N) and as mobile (1/kg) as that.
double damped_share(const World& world, const TimeSpan& t, double flexibility, double mobility) {
  if (world.configuration.solver == Solver::iterative) return 1.0;  // the thesis' implicit Euler
  // Vibrations are to be followed over the kick's two halves, of which one may be of a longer
  // interval than this one.
  const double h = t.length > 0.0 ? std::max(t.length, 2.0 * t.lag) : world.step_length;
  const double square = h * h * mobility;  // (omega h)^2 * flexibility
  if (flexibility == 0.0) return 1.0;
  return 4.0 * flexibility < square ? 1.0 - 4.0 * flexibility / square : 0.0;
}

/// m, that the centre of a link's circle has come at the velocities v- in the time `back` (s), on
/// an arc if it is off its body's.
Vec2 way_of(const World& world, const Link& link, double back) {
  if (link.body < 0) return Vec2::Zero();
  Vec2 way = back * at(world.velocity, link.body);
  if (is_central(link)) return way;
  const Vec2 from_centre = offset_centre(world, link) - at(world.position, link.body);
  return way + from_centre - turned(from_centre, -back * at(world.angular_velocity, link.body));
}

/// m/s, by which the way along a segment and on to its rims grows faster now than in the mean over
/// the time `back` (s) at v-: it has turned. With d from the one centre to the other, L the
/// segment's length in the direction e and d = L e + rho left(e), that way is L - rho alpha.
double bent_by(const World& world, const Segment& segment, const Link& from, const Link& to,
               double back) {
  if (!(back > 0.0) || !(segment.length > 0.0)) return 0.0;
  const Vec2& e = segment.direction;
  const Vec2 speed = velocity_of(world, to) - velocity_of(world, from);
  const Vec2 now = link_centre(world, to) - link_centre(world, from);
  const Vec2 before = now - way_of(world, to, back) + way_of(world, from, back);
  const double rho = cross(e, now), square = before.squaredNorm();
  const double length = std::sqrt(std::max(square - rho * rho, 0.0));
  const Vec2 was = length * before - rho * left(before);  // of the direction before
  const double turned_by = std::atan2(cross(was, e), was.dot(e));
  const double mean = (segment.length - length - rho * turned_by) / back;
  return e.dot(speed) - mean;
}

/// Whether nothing of a segment's ends turns it by more than round-off of its length in such a time
/// (s).
bool goes_straight(const World& world, const Segment& segment, const Link& from, const Link& to,
                   double back) {
  constexpr double short_way = 1e-8;  // of its length, on which that is by half the square of this
  if (!is_central(from) || !is_central(to)) return false;
  Vec2 way = Vec2::Zero();
  if (to.body >= 0) way = at(world.velocity, to.body);
  if (from.body >= 0) way -= at(world.velocity, from.body);
  const double least = short_way * segment.length;
  return back * back * way.squaredNorm() <= least * least;
}

/// m/s, -dC/dt(v-) of a row of segment in the mean, by what rims carry less than they turn, and
/// what the former was an interval earlier, where intervals are steady; else infinite.
struct Lengthening {
  double before = 0.0, creep = 0.0, earlier = infinity;
};

Lengthening lengthening(const World& world, const Segment& segment, const TimeSpan& t,
                        const PartSystem& s, int number) {
  const Row& row = at(s.rows, number);
  const RowBodies& bodies = at(s.bodies, number);
  const CableState& cable = at(world.cables, row.index);
  const Link &to = at(cable.links, row.item),
             &from = at(cable.links, previous_link(cable, row.item));
  double before = to.slip_speed - from.slip_speed - speed_of(world, from.body, bodies.ja) -
                  speed_of(world, to.body, bodies.jb);
  const double creep = cable.rims.empty() ? 0.0 : creep_speed(world, cable, row.item);
  before += creep;
  const bool still = from.still && to.still;
  const double back = 2.0 * t.lag;
  if (!still && !goes_straight(world, segment, from, to, back)) {
    before -= bent_by(world, segment, from, to, back);
  }
  return {before, creep};
}

/// -m s, what of k C + a h^2 dC/dt(v+) - 4 b lag^2 dC/dt(v-) is known, `damped` being a - b.
double known_part(const TimeSpan& t, double damped, double clearance, double before) {
  return t.kick * clearance + (1.0 - damped) * t.lag * t.lag * before;
}

/// Of a segment, or of one and half of what slides over the rims beside it.
struct Spring {
  double flexibility = 0.0;  // m/N
  double clearance = 0.0;    // m, by which it is loose; below 0: stretched
};

/// The row of a segment in an interval, which lengthens so, `damped` being its a - b.
void make_row(const Cable& given, const Segment& segment, const TimeSpan& t, Spring spring,
              Lengthening lengthens, double damped, PartSystem& s, int number) {
  const double before = lengthens.before, creep = lengthens.creep;
  const bool both_ways = given.rod;
  Row& row = at(s.rows, number);
  const double h = t.length;
  const double b = 0.25 * (1.0 - damped);
  double known = known_part(t, damped, spring.clearance, before);
  double scale = b * h * h + damped * h * t.kick;  // s^2
  if (damped > 0.0 && lengthens.earlier < infinity) {
    const double last = 4.0 * t.lag * t.lag;  // s^2, h^2 of the interval before
    const double past = 7.0 * before + lengthens.earlier;
    known = known_part(t, damped, spring.clearance, before) + damped * last * past / 27.0;
    scale = b * h * h + damped * (last * 8.0 / 27.0 + (h * h - last) / 8.0);
  }
  if (given.damping > 0.0) {
    const double damper = spring.flexibility * given.damping * t.kick;  // s^2
    const double taken = given.damping * t.kick * row.diagonal;
    const double after = taken > 0.0 ? Drag(taken).after / taken : 0.5;  // its share
    known -= (1.0 - after) * damper * before;
    scale += after * damper;
  }
  row.idle = !both_ways && row.clearance > t.reach;
  row.clamped = both_ways;
  row.on = both_ways || (!segment.slack && !row.idle);
  row.compliance = spring.flexibility / scale;
  at(s.bodies, number).curvature = -creep;  // and what else there is of it is found at the end
  row.bias = known / scale - creep;
}

/// Of a segment at an instant: such an impulse (N s) has acted up to then, and a damper acts still.
void make_row_at_instant(const Cable& given, const TimeSpan& t, double impulse, PartSystem& s,
                         int number) {
  Row& row = at(s.rows, number);
  const RowBodies& bodies = at(s.bodies, number);
  const RowResponse& response = at(s.responses, number);
  at(s.free_velocity, bodies.a) += impulse * response.ra;
  at(s.free_velocity, bodies.b) += impulse * response.rb;
  const double damper = given.damping * t.kick;  // kg
  row.stretches = true;
  row.idle = damper == 0.0;
  row.on = row.clamped = !row.idle;
  row.bias = 0.0;
  row.compliance = row.idle ? 0.0 : 1.0 / damper;
}

/// N s, of the impulse up to an instant for such a known part (-m s); only a rod pushes.
double impulse_of(const Cable& given, double known, double flexibility) {
  const double impulse = -known / flexibility;
  return given.rod ? impulse : std::max(0.0, impulse);
}

/// Segments between which cable slides at present.
struct SlidingGroup {
  double flexibility = 0.0;  // m/N
  double mobility = 0.0;     // 1/kg, of the sum of their rows
  int last = -1;             // row
};

void join(const PartSystem& s, int number, double flexibility, SlidingGroup& group) {
  group.flexibility += flexibility;
  group.mobility += at(s.rows, number).diagonal;
  if (group.last >= 0) {
    const RowBodies& bodies = at(s.bodies, number);
    const RowResponse& before = at(s.responses, group.last);
    if (before.b == bodies.a && at(s.mobile, bodies.a)) {
      group.mobility += 2.0 * dot(before.rb, bodies.ja);
    }
  }
  group.last = number;
}

/// Whether cable slides on to a segment over the link before it.
bool slides_on_to(const World& world, const CableState& cable, int segment) {
  const Link& before = at(cable.links, previous_link(cable, segment));
  return before.orientation != 0 &&
         (before.slip != Slip::stick || at(world.bodies, before.body).cable_friction == 0.0);
}

/// Segments first .. last of a cable (around a closed one), between which it may slide everywhere,
/// and the rows of all of its segments, or -1.
struct Section {
  const World& world;
  const Cable& given;
  const CableState& cable;
  std::span<const int> rows;
  int first = 0, last = 0;

  /// The row of a segment that stretches or is in a pinch, or -1.
  int row_of(const PartSystem& s, int i) const {
    const int number = rows[index(i)];
    return number >= 0 && at(s.rows, number).kind == RowKind::segment ? number : -1;
  }
  const Segment& segment(int i) const { return at(cable.segments, i); }
  /// Of segment i, which has that row; not flexible in a pinch.
  Spring spring(int i, const TimeSpan& t, const PartSystem& s, int number) const {
    Spring spring{flexibility_of(world, cable, given, segment(i), i, t),
                  at(s.rows, number).clearance};
    if (spring.flexibility == 0.0) return spring;
    for (const int link : {previous_link(cable, i), i}) {
      if (!lies_relaxed(world, cable, link)) continue;
      const Beside lies = lies_beside(world, cable, link, link != i);
      spring.flexibility += lies.material / given.axial_stiffness;
      spring.clearance += lies.loose;
    }
    return spring;
  }
};

/// a - b of all of its rows: the most damped that one of its groups asks for.
double damped_share(const Section& section, const TimeSpan& t, const PartSystem& s) {
  double damped = 0.0;
  SlidingGroup group;
  const auto end_group = [&] {
    if (group.flexibility > 0.0) {
      damped = std::max(damped, damped_share(section.world, t, group.flexibility, group.mobility));
    }
    group = {};
  };
  for (int i = section.first; i <= section.last; ++i) {
    if (!slides_on_to(section.world, section.cable, i)) end_group();
    const int number = section.row_of(s, i);
    if (number < 0) continue;
    join(s, number, section.spring(i, t, s, number).flexibility, group);
  }
  end_group();
  return damped;
}

/// Its rows at an instant, undamped. The impulses of a group up to then follow one another as the
/// tensions of the kick before do, and take up the sum of what the group has stretched by: how that
/// is shared among segments does not matter, of which one may be all but gone.
void make_rows_at_instant(const Section& section, const TimeSpan& t, PartSystem& s) {
  int begin = section.first;
  double known = 0.0, flexible = 0.0, even = 0.0;  // the last two: weighted by tensions, and not
  const auto end_group = [&](int end) {
    const double sum = flexible > 0.0 ? flexible : even;
    for (int i = begin; i < end && sum > 0.0; ++i) {
      const Segment& segment = section.segment(i);
      const int number = section.row_of(s, i);
      if (number < 0 || segment.pinched) continue;
      const double share = flexible > 0.0 ? segment.tension : 1.0;
      const double impulse = impulse_of(section.given, known, sum) * share;
      make_row_at_instant(section.given, t, impulse, s, number);
    }
    begin = end;
    known = flexible = even = 0.0;
  };
  for (int i = section.first; i <= section.last; ++i) {
    if (!slides_on_to(section.world, section.cable, i)) end_group(i);
    const Segment& segment = section.segment(i);
    const int number = section.row_of(s, i);
    if (number < 0 || segment.pinched) continue;
    const double before = lengthening(section.world, segment, t, s, number).before;
    const Spring spring = section.spring(i, t, s, number);
    known += known_part(t, 0.0, spring.clearance, before);
    flexible += spring.flexibility * segment.tension;
    even += spring.flexibility;
  }
  end_group(section.last + 1);
}

/// Its rows.
void make_rows(const Section& section, const TimeSpan& t, PartSystem& s) {
  const double damped = damped_share(section, t, s);
  if (t.length == 0.0) {
    if (damped == 0.0) make_rows_at_instant(section, t, s);
    return;
  }
  for (int i = section.first; i <= section.last; ++i) {
    const Segment& segment = section.segment(i);
    const int number = section.row_of(s, i);
    const Spring spring = number < 0 ? Spring() : section.spring(i, t, s, number);
    if (spring.flexibility == 0.0) continue;
    const Lengthening lengthens = lengthening(section.world, segment, t, s, number);
    make_row(section.given, segment, t, spring, lengthens, damped, s, number);
    if (s.elastic_ends.empty()) continue;
    ElasticEnd& end = at(s.elastic_ends, number);
    end.compliance = spring.flexibility / (t.kick * t.length);
    end.bias = spring.clearance / t.length + at(s.bodies, number).curvature;
  }
}

}  // namespace

void make_elastic(const World& world, const Cable& given, const Segment& segment, const TimeSpan& t,
                  PartSystem& s, int number) {
  const Row& row = at(s.rows, number);
  const CableState& cable = at(world.cables, row.index);
  const double flexibility = flexibility_of(world, cable, given, segment, row.item, t);
  if (flexibility == 0.0) return;
  const double damped = damped_share(world, t, flexibility, row.diagonal);
  if (t.length == 0.0 && damped > 0.0) return;
  Lengthening lengthens = lengthening(world, segment, t, s, number);
  if (t.length > 0.0) {
    const std::size_t i = index(row.item);
    const bool known = t.steady && cable.piece && i < cable.growth.size();
    if (known) lengthens.earlier = cable.growth[i].before;
    const Spring spring{flexibility, row.clearance};
    return make_row(given, segment, t, spring, lengthens, damped, s, number);
  }
  const double known = known_part(t, damped, row.clearance, lengthens.before);
  make_row_at_instant(given, t, impulse_of(given, known, flexibility), s, number);
}

void make_all_elastic(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& t, PartSystem& s) {
  const std::span<const int> cables = cables_of(parts, part);
  s.stretch_waits = t.length > 0.0 && !t.tells_forces();
  for (std::size_t place = 0; place < cables.size(); ++place) {
    const CableState& cable = at(world.cables, cables[place]);
    if (!cable.elastic) continue;
    const Cable& given = at(scene.cables, cables[place]);
    const std::span<const int> rows(s.row_of_segment.data() + s.segment_begin[place],
                                    cable.segments.size());
    const int count = static_cast<int>(cable.segments.size());
    Section section{world, given, cable, rows, static_cast<int>(first_segment(cable))};
    if (!slides_without_mass(world, cable)) {
      for (int i = section.first; i < count; ++i) {
        const Segment& segment = at(cable.segments, i);
        const int number = rows[index(i)];
        if (number >= 0) make_elastic(world, given, segment, t, s, number);
      }
      continue;
    }
    if (t.length > 0.0 && world.configuration.solver == Solver::direct) {
      s.elastic_ends.resize(s.rows.size());
    }
    for (int i = section.first; i < count; ++i) {
      const Link& link = at(cable.links, i);
      const bool holds = link.orientation != 0 && !link.pinch_middle &&
                         at(world.bodies, link.body).cable_friction == infinity;
      if (i + 1 < count && (cable.closed || !holds)) continue;
      section.last = i;
      make_rows(section, t, s);
      section.first = i + 1;
    }
  }
}

void note_growth(const PartSystem& s, double length, World& world) {
  for (const Row& row : s.rows) {
    if (row.kind != RowKind::segment || row.compliance == 0.0) continue;
    CableState& cable = at(world.cables, row.index);
    if (!cable.piece) continue;
    if (cable.growth.size() != cable.segments.size()) {
      cable.growth.assign(cable.segments.size(), {});
    }
    const Segment& segment = at(cable.segments, row.item);
    Growth& growth = at(cable.growth, row.item);
    growth.before = growth.last;
    growth.last = (row.clearance - (segment.rest_length - segment.length)) / length;
  }
}

}  // namespace pinchlab
