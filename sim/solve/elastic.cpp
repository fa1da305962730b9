// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/elastic.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at.h"
#include "sim/cable/creep.h"
#include "sim/parts.h"
#include "sim/solve/rows.h"
#include "sim/tangent.h"
#include "sim/world.h"

namespace pinchlab {

namespace {

/// Compliance of a segment without pinches (m/N). Its material is rounded to 2^-45 of the cable's,
/// 128 units in the last place of what it is a difference of: where round-off alone shakes a cable,
/// rows and factors stand, unless the material is next to a boundary of that rounding. Those of the
/// stress scene's segments are all the same, and next to one of 2^-46.
double flexibility_of(const CableState& cable, const Cable& given, const Segment& segment) {
  const double coarse = 128.0 * cable.length;
  const double material = (elastic_material(cable, segment) + coarse) - coarse;
  return material / given.axial_stiffness;
}

double length_of(const World& world, const TimeSpan& t) {
  return t.length > 0.0 ? t.length : world.step_length;
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
  if (from.still && to.still) return true;
  if (!is_central(from) || !is_central(to)) return false;
  Vec2 way = Vec2::Zero();
  if (to.body >= 0) way = at(world.velocity, to.body);
  if (from.body >= 0) way -= at(world.velocity, from.body);
  const double least = short_way * segment.length;
  return back * back * way.squaredNorm() <= least * least;
}

/// The row of a segment of such a flexibility (m/N), `damped` being its a - b.
void make_row(const World& world, const Cable& given, const Segment& segment, const TimeSpan& t,
              double flexibility, double damped, PartSystem& s, int number) {
  const bool both_ways = given.rod;
  Row& row = at(s.rows, number);
  RowBodies& bodies = at(s.bodies, number);
  const double h = length_of(world, t);
  const double b = 0.25 * (1.0 - damped);
  const CableState& cable = at(world.cables, row.index);
  const Link &to = at(cable.links, row.item),
             &from = at(cable.links, previous_link(cable, row.item));
  const double creep = cable.rims.empty() ? 0.0 : creep_speed(world, cable, row.item);
  double before = to.slip_speed - from.slip_speed - speed_of(world, from.body, bodies.ja) -
                  speed_of(world, to.body, bodies.jb) + creep;  // dC/dt(v-), m/s
  const double back = 2.0 * t.lag;
  if (!goes_straight(world, segment, from, to, back)) {
    before -= bent_by(world, segment, from, to, back);
  }
  double known = t.kick * row.clearance + 4.0 * b * t.lag * t.lag * before;  // -m s
  if (t.length == 0.0) {
    if (damped > 0.0 || flexibility == 0.0) return;
    const double impulse = both_ways ? -known / flexibility : std::max(0.0, -known / flexibility);
    const RowResponse& response = at(s.responses, number);
    at(s.free_velocity, bodies.a) += impulse * response.ra;
    at(s.free_velocity, bodies.b) += impulse * response.rb;
    const double damper = given.damping * t.kick;  // kg
    row.idle = damper == 0.0;
    row.on = row.clamped = !row.idle;
    row.bias = 0.0;
    row.compliance = row.idle ? 0.0 : 1.0 / damper;
    return;
  }
  double scale = b * h * h + damped * h * t.kick;  // s^2
  if (given.damping > 0.0) {
    const double damper = flexibility * given.damping * t.kick;  // s^2
    const double taken = given.damping * t.kick * row.diagonal;
    const double after = taken > 0.0 ? Drag(taken).after / taken : 0.5;  // its share
    known -= (1.0 - after) * damper * before;
    scale += after * damper;
  }
  row.idle = !both_ways && row.clearance > t.reach;
  row.clamped = both_ways;
  row.on = both_ways || (!segment.slack && !row.idle);
  row.compliance = flexibility / scale;
  bodies.curvature = -creep;  // and what else there is of it is found at the interval's end
  row.bias = known / scale - creep;
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

/// Makes the rows of a cable's segments first .. last (around a closed one), between which it may
/// slide everywhere: all with the same a and b, the most damped that one of its groups asks for.
void make_section(const World& world, const Cable& given, const CableState& cable,
                  std::span<const int> row_of_segment, int first, int last, const TimeSpan& t,
                  PartSystem& s) {
  double damped = 0.0;
  SlidingGroup group;
  const auto end_group = [&] {
    if (group.flexibility > 0.0) {
      damped = std::max(damped, damped_share(world, t, group.flexibility, group.mobility));
    }
    group = {};
  };
  const auto is_row = [&](int i) {
    const int number = row_of_segment[index(i)];
    return number >= 0 && at(s.rows, number).kind == RowKind::segment;
  };
  for (int i = first; i <= last; ++i) {
    const Link& before = at(cable.links, previous_link(cable, i));
    const bool slides =
        before.orientation != 0 &&
        (before.slip != Slip::stick || at(world.bodies, before.body).cable_friction == 0.0);
    if (!slides) end_group();
    if (!is_row(i)) continue;
    const Segment& segment = at(cable.segments, i);
    join(s, row_of_segment[index(i)], segment.pinched ? 0.0 : flexibility_of(cable, given, segment),
         group);
  }
  end_group();
  for (int i = first; i <= last; ++i) {
    const Segment& segment = at(cable.segments, i);
    if (!is_row(i) || segment.pinched) continue;
    const int number = row_of_segment[index(i)];
    const double flexibility = flexibility_of(cable, given, segment);
    make_row(world, given, segment, t, flexibility, damped, s, number);
    if (s.elastic_ends.empty()) continue;
    ElasticEnd& end = at(s.elastic_ends, number);
    end.compliance = flexibility / (t.kick * t.length);
    end.bias = at(s.rows, number).clearance / t.length + at(s.bodies, number).curvature;
  }
}

}  // namespace

void make_elastic(const World& world, const Cable& given, const Segment& segment, const TimeSpan& t,
                  PartSystem& s, int number) {
  const CableState& cable = at(world.cables, at(s.rows, number).index);
  const double flexibility = flexibility_of(cable, given, segment);
  const double damped = damped_share(world, t, flexibility, at(s.rows, number).diagonal);
  make_row(world, given, segment, t, flexibility, damped, s, number);
}

void make_all_elastic(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& t, PartSystem& s) {
  const std::span<const int> cables = cables_of(parts, part);
  for (std::size_t place = 0; place < cables.size(); ++place) {
    const CableState& cable = at(world.cables, cables[place]);
    if (!cable.elastic) continue;
    const Cable& given = at(scene.cables, cables[place]);
    const std::span<const int> rows(s.row_of_segment.data() + s.segment_begin[place],
                                    cable.segments.size());
    const int count = static_cast<int>(cable.segments.size());
    int first = static_cast<int>(first_segment(cable));
    if (!slides_without_mass(world, cable)) {
      for (int i = first; i < count; ++i) {
        const Segment& segment = at(cable.segments, i);
        const int number = rows[index(i)];
        if (number >= 0 && !segment.pinched) make_elastic(world, given, segment, t, s, number);
      }
      continue;
    }
    if (t.length > 0.0 && world.configuration.solver == Solver::direct) {
      s.elastic_ends.resize(s.rows.size());
    }
    for (int i = first; i < count; ++i) {
      const Link& link = at(cable.links, i);
      const bool holds = link.orientation != 0 && !link.pinch_middle &&
                         at(world.bodies, link.body).cable_friction == infinity;
      if (!cable.closed && holds) {
        make_section(world, given, cable, rows, first, i, t, s);
        first = i + 1;
      }
    }
    if (first < count) {
      make_section(world, given, cable, rows, first, count - 1, t, s);
    }
  }
}

}  // namespace pinchlab
