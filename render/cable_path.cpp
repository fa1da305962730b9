// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/cable_path.h"

#include <algorithm>
#include <cmath>

#include "render/hanging.h"
#include "sim/cable.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

/// Where the cable meets and leaves a link: directions (rad) and material coordinates (m).
struct Bounds {
  double tail_angle = 0.0, head_angle = 0.0;
  double tail_material = 0.0, head_material = 0.0;
};

/// 1 at s = 0, falling smoothly to 0 at s = reach, and its derivative (1/m).
struct Fade {
  double value = 0.0, slope = 0.0;
};
Fade fade(double s, double reach) {
  if (s >= reach) return {};
  const double x = s / reach;
  return {1.0 - x * x * (3.0 - 2.0 * x), -6.0 * x * (1.0 - x) / reach};
}

/// The centre line of one cable, built link by link.
class PathBuilder {
 public:
  PathBuilder(const Scene& scene, const World& world, const CableState& cable, double smallest_sag,
              std::vector<StripPoint>& points)
      : world_(world),
        cable_(cable),
        smallest_sag_(smallest_sag),
        points_(points),
        first_(points.size()) {
    const double g = scene.gravity.norm();
    up_ = g > 0.0 ? Vec2(-scene.gravity / g) : Vec2(0.0, 1.0);
  }

  void build() {
    const std::size_t count = cable_.links.size();
    if (count < 2) return;
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
  }

 private:
  struct Span {
    bool drawn = false;
    bool hanging = false;
    Catenary curve;
  };

  std::size_t tail_link(std::size_t segment) const {
    return segment == 0 ? cable_.links.size() - 1 : segment - 1;
  }

  SpanEnd span_end(const Link& link) const {
    const double unwrap = link.orientation != 0 ? 0.5 * std::max(link.wrap, 0.0) : 0.0;
    return {link_centre(world_, link), link.signed_radius(), unwrap};
  }

  /// The shape of every span, and from it where each link's arc begins and ends.
  void find_bounds() {
    const std::size_t count = cable_.links.size();
    bounds_.resize(count);
    spans_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const double angle = body_angle(world_, cable_.links[i]);
      bounds_[i] = {cable_.segments[i].alpha, alpha_head(cable_, i),
                    tail_material(cable_, i, angle), head_material(cable_, i, angle)};
    }
    for (std::size_t i = first_segment(cable_); i < count; ++i) {
      const Link &from = cable_.links[tail_link(i)], &to = cable_.links[i];
      const Segment& segment = cable_.segments[i];
      Span& span = spans_[i];
      span.drawn = !from.pinch_middle && !to.pinch_middle;
      // A chord of length l and slack d sags by sqrt(3 l d / 8); where l vanishes, by d / 2.
      const double slack = segment.rest_length - segment.length;
      span.hanging = span.drawn && slack > 0.0 &&
                     slack * std::max(segment.length, slack) > 2.0 * smallest_sag_ * smallest_sag_;
      if (!span.hanging) continue;
      const HangingSpan shape =
          hang(span_end(from), span_end(to), segment.alpha, segment.rest_length, up_);
      span.curve = shape.curve;
      Bounds &before = bounds_[tail_link(i)], &after = bounds_[i];
      const double seam = i == 0 ? cable_.turning : 0.0;
      before.head_material += from.signed_radius() * (shape.tail_angle + seam - before.head_angle);
      before.head_angle = shape.tail_angle + seam;
      after.tail_material += to.signed_radius() * (shape.head_angle - after.tail_angle);
      after.tail_angle = shape.head_angle;
    }
  }

  void add_point(const Vec2& position, const Vec2& tangent, double material) {
    if (points_.size() > first_) {
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

  /// Where two bodies clip, the arcs round them do not meet. Each gives way by half, smoothly,
  /// along a few widths of cable.
  void add_arc(std::size_t i) {
    const Link& link = cable_.links[i];
    if (link.orientation == 0 || link.pinch_middle) return;
    const Bounds& b = bounds_[i];
    const Vec2& centre = world_.position[static_cast<std::size_t>(link.body)];
    const double sweep = b.head_angle - b.tail_angle;
    const double length = link.radius * std::abs(sweep);
    const double bend = std::min(8.0 * cable_.half_width, 0.5 * length);
    const bool at_end = !cable_.closed && i + 1 == cable_.links.size();
    const Vec2 at_tail = -0.5 * clipped(i);
    const Vec2 at_head =
        at_end ? Vec2(Vec2::Zero()) : Vec2(0.5 * clipped((i + 1) % cable_.links.size()));
    // Where an arc gives way it is no circle: finer pieces come close enough.
    const double most = at_tail.isZero() && at_head.isZero() ? most_turn : 0.25 * most_turn;
    const int pieces = std::max(1, static_cast<int>(std::ceil(std::abs(sweep) / most)));
    for (int k = 0; k <= pieces; ++k) {
      const double share = static_cast<double>(k) / pieces;
      const Vec2 e = unit_vector(b.tail_angle + share * sweep);
      const Fade tail = fade(share * length, bend), head = fade((1.0 - share) * length, bend);
      const Vec2 shift = tail.value * at_tail + head.value * at_head;
      const Vec2 slope = tail.slope * at_tail - head.slope * at_head;
      add_point(tangent_point(centre, link.signed_radius(), e) + shift, (e + slope).normalized(),
                b.tail_material + share * (b.head_material - b.tail_material));
    }
  }

  void add_span(std::size_t i) {
    const Span& span = spans_[i];
    if (!span.drawn) return;
    const double from = bounds_[tail_link(i)].head_material;
    const double to = bounds_[i].tail_material + (i == 0 ? cable_.length : 0.0);
    if (!span.hanging) {
      // Pinched: nothing lies between the arcs. Where bodies clip, the arcs' ends lie beside each
      // other.
      const Segment& segment = cable_.segments[i];
      if (segment.length <= 0.0) return;
      const Vec2 e = (segment.head - segment.tail).normalized();
      add_point(segment.tail, e, from);
      add_point(segment.head, e, to);
      return;
    }
    const double length = span.curve.length();
    constexpr double most = 0.15;  // rad: a catenary is no circle
    const int pieces = std::max(1, static_cast<int>(std::ceil(span.curve.turn() / most)));
    for (int k = 0; k <= pieces; ++k) {
      const double s = span.curve.arc_at_turn(static_cast<double>(k) / pieces);
      add_point(span.curve.point(s), span.curve.tangent(s), from + s / length * (to - from));
    }
  }

  const World& world_;
  const CableState& cable_;
  double smallest_sag_;
  std::vector<StripPoint>& points_;
  std::size_t first_;
  Vec2 up_;
  std::vector<Bounds> bounds_;
  std::vector<Span> spans_;
};

}  // namespace

double mark_spacing(const CableState& cable) {
  const double wanted = 8.0 * cable.half_width;
  if (!cable.closed) return wanted;
  return cable.length / std::max(1.0, std::round(cable.length / wanted));
}

void append_cable_path(const Scene& scene, const World& world, const CableState& cable,
                       double smallest_sag, std::vector<StripPoint>& points) {
  PathBuilder(scene, world, cable, smallest_sag, points).build();
}

}  // namespace pinchlab
