// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/cable_path.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "render/picture/fade.h"
#include "render/picture/give_way.h"
#include "render/picture/hanging.h"
#include "render/picture/span_rests.h"
#include "sim/cable/cable.h"
#include "sim/cable/held_spans.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double full_turn = 2.0 * std::numbers::pi;

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// Where the cable meets and leaves a link: directions (rad) and material coordinates (m).
struct Bounds {
  double tail_angle = 0.0, head_angle = 0.0;
  double tail_material = 0.0, head_material = 0.0;
};

/// The centre line of one cable, built link by link.
class PathBuilder {
 public:
  PathBuilder(const Scene& scene, const World& world, const CableState& cable, double smallest_sag,
              std::vector<StripPoint>& points)
      : world_(world),
        cable_(cable),
        smallest_sag_(smallest_sag),
        points_(points),
        begins_{points.size()} {
    const double g = scene.gravity.norm();
    up_ = g > 0.0 ? Vec2(-scene.gravity / g) : Vec2(0.0, 1.0);
  }

  /// rad, by which the cable turns on a link.
  double sweep(std::size_t i) const {
    return std::abs(bounds_[i].head_angle - bounds_[i].tail_angle);
  }

  std::vector<std::size_t> build() {
    const std::size_t count = cable_.links.size();
    if (count < 2) return {};
    find_bounds();
    if (cable_.closed) {
      // Start behind the seam, on the first link, and come back to it.
      for (std::size_t i = 0; i < count; ++i) {
        add_arc(i);
        add_span((i + 1) % count);
      }
    } else {
      for (std::size_t i = 1; i < count; ++i) {
        add_span(i);
        add_arc(i);
      }
    }
    return begins_;
  }

 private:
  struct Span {
    bool drawn = false;
    bool hanging = false;
    bool merged = false;             // past a link that it has let go of
    double slack = 0.0;              // m, by which it hangs
    double length = 0.0;             // m of material, as it hangs
    std::size_t tail = 0, head = 0;  // the links between which it is drawn
    RestingSpan shape;
  };

  std::size_t tail_link(std::size_t segment) const {
    return segment == 0 ? cable_.links.size() - 1 : segment - 1;
  }

  /// A hanging span may take as much off the wrap as the span on its other side has left.
  SpanEnd span_end(std::size_t i, double alpha) const {
    const Link& link = cable_.links[i];
    const double wrap = link.orientation * (bounds_[i].head_angle - bounds_[i].tail_angle);
    const double growth = link.layers.way * link.orientation != 0 ? link.layers.growth : 0.0;
    return {link_centre(world_, link), link.signed_radius(), std::max(wrap, 0.0), alpha, growth};
  }

  /// Whether segment i is a pinch between two wraps, at one place of the cable.
  bool joins_wraps(std::size_t i) const {
    const Link &from = cable_.links[tail_link(i)], &to = cable_.links[i];
    return spans_[i].drawn && cable_.segments[i].pinched && from.orientation != 0 &&
           to.orientation != 0 && from.body != to.body;
  }

  /// The end of a hanging span on the far side of link `by`, whose wrap is used up, and of the
  /// pinch on to link `next`: from there on the cable lies on that one. Adds the wrap to `length`
  /// (m); where the two bodies clip, the span keeps its slack on the longer or shorter way from
  /// `far`.
  SpanEnd pass(std::size_t by, std::size_t next, std::size_t pinch, const Vec2& far,
               double& length) {
    length += bounds_[by].head_material - bounds_[by].tail_material;
    const Segment& join = cable_.segments[pinch];
    const double to_tail = (join.tail - far).norm(), to_head = (join.head - far).norm();
    length += next < by ? to_tail - to_head : to_head - to_tail;
    passed_[by] = true;
    spans_[pinch].drawn = false;
    SpanEnd end = span_end(next, from_x_axis(cable_.segments[pinch].alpha));
    end.most_unwrap = 0.0;  // it is pressed on there
    return end;
  }

  /// The shape of slack span i, between the bodies that it hangs from. One that is pressed on to
  /// another and has hardly any wrap lets go of it, and the span hangs from that other.
  RestingSpan shape(std::size_t i) {
    Span& span = spans_[i];
    const Segment& segment = cable_.segments[i];
    double length = span.length;
    const double alpha = from_x_axis(segment.alpha);
    SpanEnd tail = span.merged ? tail_end(i) : span_end(span.tail, alpha);
    SpanEnd head = span.merged ? head_end(i) : span_end(span.head, alpha);
    const auto keep_clear = [&](const HangingSpan& hung) {
      return rest_on_ends(world_, cable_, {span.tail, span.head}, {tail, head}, length, hung, up_);
    };
    const HangingSpan straight = hang(tail, head, length, up_);
    if (span.merged) return keep_clear(straight);
    const std::size_t by_tail = span.tail, by_head = span.head;
    const bool pass_tail = straight.tail_bare && i > 0 && by_tail > 0 && joins_wraps(by_tail);
    const bool pass_head =
        straight.head_bare && by_head + 1 < cable_.links.size() && joins_wraps(by_head + 1);
    if (pass_tail) {
      span.tail = by_tail - 1;
      tail = pass(by_tail, span.tail, by_tail, segment.head, length);
    }
    if (pass_head) {
      span.head = by_head + 1;
      head = pass(by_head, span.head, span.head, segment.tail, length);
    }
    return keep_clear(pass_tail || pass_head ? hang(tail, head, length, up_) : straight);
  }

  /// The ends of span i as long as nothing of it has been hung.
  SpanEnd tail_end(std::size_t i) const {
    const std::size_t link = spans_[i].tail;
    return span_end(link, bounds_[link].head_angle - (i == 0 ? cable_.turning : 0.0));
  }
  SpanEnd head_end(std::size_t i) const {
    return span_end(spans_[i].head, bounds_[spans_[i].head].tail_angle);
  }

  /// The span that leaves link i, which is not the last of an open cable.
  std::size_t span_after(std::size_t i) const {
    const std::size_t next = (i + 1) % cable_.links.size();
    return passed_[next] ? span_after(next) : next;
  }

  /// rad, by which cable that is slack on both sides of link i would turn on it the wrong way; 0
  /// or less: it lies on it.
  double lifted(std::size_t i) const {
    const Link& link = cable_.links[i];
    if (passed_[i] || link.orientation == 0 || link.layers.way != 0) return 0.0;
    const std::size_t after = span_after(i);
    if (!spans_[i].hanging || !spans_[after].hanging) return 0.0;
    SpanEnd head = head_end(i), tail = tail_end(after);
    head.most_unwrap = tail.most_unwrap = std::numbers::pi;
    const HangingSpan come = hang(tail_end(i), head, spans_[i].length, up_);
    const HangingSpan go = hang(tail, head_end(after), spans_[after].length, up_);
    const double seam = after == 0 ? cable_.turning : 0.0;
    return link.orientation * (come.head_angle - go.tail_angle - seam);
  }

  /// What falls on to a slack cable without mass meets it where the straight line is, high above
  /// what hangs. Until it comes down there the cable hangs as if nothing were on it.
  void let_go() {
    if (cable_.first_node >= 0 || cable_.density > 0.0) return;  // it hangs as the simulator says
    const std::size_t end = cable_.links.size() - (cable_.closed ? 0 : 1);
    for (;;) {
      std::size_t most = 0;
      double lift = 0.0;
      for (std::size_t i = 1; i < end; ++i) {
        if (const double here = lifted(i); here > lift) std::tie(most, lift) = std::tuple(i, here);
      }
      if (most == 0) return;
      Span& after = spans_[span_after(most)];
      after.merged = true;
      after.tail = spans_[most].tail;
      after.length += spans_[most].length;
      after.length += bounds_[most].head_material - bounds_[most].tail_material;
      spans_[most].drawn = spans_[most].hanging = false;
      passed_[most] = true;
    }
  }

  /// Share of its slack that span i can show: a span about as short as the cable is wide cannot
  /// hang, and a pinched one not at all; in between the straighter the shorter it is. Beyond a
  /// cable's end nothing takes what is left, and it hangs in a loop, however narrow.
  double room(std::size_t i) const {
    const Segment& segment = cable_.segments[i];
    if (segment.pinched || !spans_[i].drawn) return 0.0;
    if (!cable_.closed && (i == 1 || i + 1 == cable_.links.size())) return 1.0;
    return 1.0 - fade(segment.length, 12.0 * cable_.half_width).value;
  }

  /// Material that span i holds beyond its straight length, m.
  double slack(std::size_t i) const {
    return std::max(cable_.segments[i].rest_length - cable_.segments[i].length, 0.0);
  }

  /// Share of another span's slack that span i can take: none if it is pulled.
  double taking(std::size_t i) const { return cable_.segments[i].tension > 0.0 ? 0.0 : room(i); }

  /// Hands on what a short span cannot show to the spans beside it, so that the drawn cable keeps
  /// its length when the link between them goes, or when the span is pinched. Most goes past the
  /// link with the smaller wrap, which is the one about to go, if the span there can take it.
  void share_slack() {
    const std::size_t count = cable_.links.size(), first = first_segment(cable_);
    for (std::size_t i = first; i < count; ++i) spans_[i].slack = room(i) * slack(i);
    for (std::size_t i = first; i < count; ++i) {
      const double hidden = (1.0 - room(i)) * slack(i);
      if (hidden <= 0.0) continue;
      const std::size_t before = tail_link(i), after = (i + 1) % count;
      const double to_before = cable_.closed || before >= first ? taking(before) : 0.0;
      const double to_after = cable_.closed || after > i ? taking(after) : 0.0;
      const double tail_wrap = arc(before), head_wrap = arc(i);
      const double both = head_wrap * to_before + tail_wrap * to_after;
      if (both <= 0.0) continue;
      const double handed = hidden * std::max(to_before, to_after) / both;
      const double back = handed * head_wrap * to_before, on = handed * tail_wrap * to_after;
      spans_[before].slack += back;
      spans_[after].slack += on;
      // The cable on the link between runs along with it.
      move(bounds_[before], back);
      move(bounds_[i], -on);
    }
  }
  static void move(Bounds& bounds, double material) {
    bounds.tail_material += material;
    bounds.head_material += material;
  }

  /// m of cable on link i.
  double arc(std::size_t i) const { return stored_length(cable_.links[i]); }

  /// The shape of every span, and from it where each link's arc begins and ends.
  void find_bounds() {
    const std::size_t count = cable_.links.size();
    bounds_.resize(count);
    spans_.resize(count);
    passed_.assign(count, false);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = body_angle(world_, cable_.links[i]);
      bounds_[i] = {from_x_axis(cable_.segments[i].alpha), from_x_axis(alpha_head(cable_, i)),
                    tail_material(cable_, i, angle), head_material(cable_, i, angle)};
    }
    const std::size_t first = first_segment(cable_);
    for (std::size_t i = first; i < count; ++i) {
      spans_[i].drawn = !cable_.links[tail_link(i)].pinch_middle && !cable_.links[i].pinch_middle;
      spans_[i].tail = tail_link(i);
      spans_[i].head = i;
    }
    share_slack();
    for (std::size_t i = first; i < count; ++i) {
      Span& span = spans_[i];
      // A chord of length l and slack d sags by sqrt(3 l d / 8).
      span.hanging = span.drawn &&
                     span.slack * cable_.segments[i].length > 2.0 * smallest_sag_ * smallest_sag_;
      span.length = cable_.segments[i].length + span.slack;
    }
    let_go();
    for (std::size_t i = first; i < count; ++i) {
      if (spans_[i].hanging) hang_span(i);
    }
  }

  void hang_span(std::size_t i) {
    Span& span = spans_[i];
    span.shape = shape(i);
    const HangingSpan& hung = span.shape.hung;
    Bounds &before = bounds_[span.tail], &after = bounds_[span.head];
    const double seam = i == 0 ? cable_.turning : 0.0;
    const Link &tail = cable_.links[span.tail], &head = cable_.links[span.head];
    before.head_material +=
        taken_up(span_end(span.tail, before.head_angle),
                 tail.orientation * (hung.tail_angle + seam - before.head_angle));
    before.head_angle = hung.tail_angle + seam;
    after.tail_material -= taken_up(span_end(span.head, after.tail_angle),
                                    -head.orientation * (hung.head_angle - after.tail_angle));
    after.tail_angle = hung.head_angle;
  }

  void add_point(const Vec2& position, const Vec2& tangent, double material) {
    if (points_.size() > begins_.back()) {
      // A kink is a fan of points at one place: a round joint.
      const StripPoint last = points_.back();
      const double bend = std::atan2(cross(last.tangent, tangent), last.tangent.dot(tangent));
      if (std::abs(bend) > 1.01 * most_turn) {
        const int pieces = static_cast<int>(std::ceil(std::abs(bend) / most_turn));
        for (int k = 1; k < pieces; ++k) {
          const double a = bend * k / pieces;
          const Vec2 t = std::cos(a) * last.tangent + std::sin(a) * left(last.tangent);
          points_.push_back({position, t, material});
        }
      }
    }
    points_.push_back({position, tangent, material});
  }

  /// From the end of the arc before pinched segment i to the beginning of the one after it: zero
  /// unless the two bodies clip.
  Vec2 clipped(std::size_t i) const {
    if (!spans_[i].drawn || spans_[i].hanging || cable_.segments[i].length > 0.0)
      return Vec2::Zero();
    const Vec2 overlap = cable_.segments[i].head - cable_.segments[i].tail;
    return overlap.norm() > 0.2 * smallest_sag_ ? overlap : Vec2(Vec2::Zero());
  }

  /// m, of the arc on link i as it is drawn.
  double drawn_arc(std::size_t i) const { return cable_.links[i].radius * sweep(i); }

  /// 0 to 1: 1 where the arc on link i is much the shorter one of two.
  double shorter(std::size_t i, std::size_t other) const {
    const double most = 4.0 * cable_.half_width;
    const double mine = std::min(drawn_arc(i), most), its = std::min(drawn_arc(other), most);
    const double both = mine + its;
    return both > 0.0 ? its / both : 0.5;
  }

  GiveWay give_way(std::size_t i) const {
    const Link& link = cable_.links[i];
    if (link.orientation == 0 || link.pinch_middle || passed_[i]) return {};
    const bool last = !cable_.closed && i + 1 == cable_.links.size();
    GiveWay way;
    const std::size_t next = (i + 1) % cable_.links.size();
    way.at_tail = -shorter(i, tail_link(i)) * clipped(i);
    if (!last) way.at_head = shorter(i, next) * clipped(next);
    way.length = drawn_arc(i);
    way.reach = 8.0 * cable_.half_width;
    const bool both = !way.at_tail.isZero(0.0) && !way.at_head.isZero(0.0);
    if (both) way.reach = std::min(way.reach, 0.5 * way.length);
    return way;
  }

  /// All turns of a drum that fills, each outside of the one below.
  void add_layers(std::size_t i) {
    const Link& link = cable_.links[i];
    const Layers& layers = link.layers;
    const Bounds& b = bounds_[i];
    const Vec2 centre = link_centre(world_, link);
    const double sweep = b.head_angle - b.tail_angle, turned = std::abs(sweep);
    const int pieces = std::max(1, static_cast<int>(std::ceil(turned / most_turn)));
    for (int k = 0; k <= pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      const double below = layers.way > 0 ? share * turned : (1.0 - share) * turned;
      const double wound = layers.length(below), radius = layers.radius(below);
      const Vec2 e = unit_vector(b.tail_angle + share * sweep);
      const double slope = link.orientation * layers.way * layers.growth / radius;
      add_point(tangent_point(centre, link.orientation * radius, e),
                (e - slope * left(e)).normalized(),
                layers.way > 0 ? b.tail_material + wound : b.head_material - wound);
    }
  }

  /// Share of the arc on link i that later turns on the same body hide: the last full turn shows. A
  /// body that presses on the turns parts them.
  double hidden_share(std::size_t i) const {
    double turned = sweep(i);
    const auto& links = cable_.links;
    for (std::size_t k = i + 2; !cable_.closed && k < links.size(); k += 2) {
      if (!links[k - 1].pinch_middle || links[k].body != links[i].body) break;
      turned += sweep(k);
    }
    if (turned <= full_turn) return 0.0;
    return std::min(1.0, (turned - full_turn) / sweep(i));
  }

  void add_arc(std::size_t i) {
    const Link& link = cable_.links[i];
    if (link.orientation == 0 || link.pinch_middle || passed_[i]) return;
    if (link.layers.way != 0) return add_layers(i);
    const Bounds& b = bounds_[i];
    const Vec2 centre = link_centre(world_, link);
    const double turned = b.head_angle - b.tail_angle;
    const double hidden = hidden_share(i);
    if (hidden > 0.0 && points_.size() > begins_.back()) begins_.push_back(points_.size());
    if (hidden >= 1.0) return;
    // Where an arc gives way it is no circle: finer pieces come close enough.
    const GiveWay way = give_way(i);
    const int pieces_a_turn = way.none() ? 13 : 52;
    const double piece = full_turn / pieces_a_turn;
    static_assert(full_turn / 13 * 1.02 < most_turn);
    const auto add = [&](double angle, const Vec2& e) {
      const double share = turned != 0.0 ? (angle - b.tail_angle) / turned : 0.0;
      const double s = share * way.length;
      add_point(tangent_point(centre, link.signed_radius(), e) + way.shift(s),
                (e + way.slope(s)).normalized(),
                b.tail_material + share * (b.head_material - b.tail_material));
    };
    // Pieces begin at the same places from frame to frame, whatever the arc's ends do: what stands
    // still need not be drawn anew.
    const double from = b.tail_angle + hidden * turned;
    add(from, unit_vector(from));
    const double sense = std::copysign(1.0, turned), least = 0.02;  // of a piece
    const int first = static_cast<int>(std::floor(sense * from / piece + least)) + 1;
    const int last = static_cast<int>(std::ceil(sense * b.head_angle / piece - least)) - 1;
    for (int k = first; k <= last; ++k) {
      const double place = sense * std::remainder(k, pieces_a_turn);
      add(sense * k * piece, unit_vector(place * piece));
    }
    add(b.head_angle, unit_vector(b.head_angle));
  }

  /// With the bend that it holds.
  void add_held_span(std::size_t i, double from) {
    const Segment& segment = cable_.segments[i];
    const double piece = node_spacing(cable_);
    const int pieces = held_at(cable_, i).pieces;
    Vec2 tail = segment.tail;
    for (int k = 1; k <= pieces; ++k) {
      const Vec2 head = k < pieces ? place_of_held(cable_, i, k) : segment.head;
      const Vec2 e = (head - tail).normalized();
      add_point(tail, e, from + (k - 1) * piece);
      add_point(head, e, from + k * piece);
      tail = head;
    }
  }

  void add_rest(const Rest& rest, double material) {
    for (const auto& [place, e, m] : points_of(rest, material)) add_point(place, e, m);
  }

  void add_span(std::size_t i) {
    const Span& span = spans_[i];
    if (!span.drawn) return;
    double from = bounds_[span.tail].head_material;
    if (is_held(cable_, i)) return add_held_span(i, from);
    double to = bounds_[span.head].tail_material + (i == 0 ? cable_.length : 0.0);
    const GiveWay before = give_way(span.tail), after = give_way(span.head);
    const Vec2 tail_shift = before.shift(before.length), head_shift = after.shift(0.0);
    if (!span.hanging) {
      // Pinched: nothing lies between the arcs.
      const Segment& segment = cable_.segments[i];
      if (segment.length <= 0.0) return;
      const Vec2 tail = segment.tail + tail_shift, head = segment.head + head_shift;
      const Vec2 e = (head - tail).normalized();
      add_point(tail, e, from);
      add_point(head, e, to);
      return;
    }
    add_rest(span.shape.at_tail, from);
    from += span.shape.at_tail.length();
    to -= span.shape.at_head.length();
    const Catenary& curve = span.shape.hung.curve;
    const double length = curve.length();
    constexpr double most = 0.15;  // rad: a catenary is no circle
    const int pieces = std::max(1, static_cast<int>(std::ceil(curve.turn() / most)));
    for (int k = 0; k <= pieces; ++k) {
      const double s = curve.arc_at_turn(static_cast<double>(k) / pieces), share = s / length;
      const Vec2 slope = (head_shift - tail_shift) / length;
      add_point(curve.point(s) + (1.0 - share) * tail_shift + share * head_shift,
                (curve.tangent(s) + slope).normalized(), from + share * (to - from));
    }
    add_rest(span.shape.at_head, to);
  }

  const World& world_;
  const CableState& cable_;
  double smallest_sag_;
  std::vector<StripPoint>& points_;
  std::vector<std::size_t> begins_;  // indices of the strips' first points
  Vec2 up_;
  std::vector<Bounds> bounds_;
  std::vector<Span> spans_;
  std::vector<bool> passed_;  // links that a hanging span has let go of
};

}  // namespace

double mark_spacing(const CableState& cable) {
  if (!cable.closed) return 8.0 * cable.half_width;
  // A belt runs fast: marks that move by half their distance a frame seem to run backward.
  const double wanted = 16.0 * cable.half_width;
  return cable.length / std::max(1.0, std::round(cable.length / wanted));
}

std::vector<std::size_t> append_cable_path(const Scene& scene, const World& world,
                                           const CableState& cable, double smallest_sag,
                                           std::vector<StripPoint>& points,
                                           std::vector<double>* sweeps) {
  PathBuilder path(scene, world, cable, smallest_sag, points);
  std::vector<std::size_t> begins = path.build();
  for (std::size_t i = 0; sweeps && i < cable.links.size(); ++i) sweeps->push_back(path.sweep(i));
  return begins;
}

}  // namespace pinchlab
