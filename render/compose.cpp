// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/compose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/cable/tangent.h"

namespace pinchlab {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

// The palette of Okabe and Ito, told apart with any colour vision, with tints and shades of its
// colours.
namespace palette {
constexpr Colour paper{252, 252, 250};
constexpr Colour ink{38, 43, 51};
constexpr Colour faint{205, 209, 214};
constexpr Colour cable{236, 165, 46}, cable_edge{110, 62, 8}, cable_mark{152, 84, 6};
// Half of what lies under a body shows through it.
constexpr Colour body{172, 206, 236, 128}, body_edge{0, 82, 130};
constexpr Colour driven{148, 214, 190, 128}, driven_edge{0, 100, 74};
constexpr Colour fixed{184, 188, 194, 128}, fixed_edge{84, 92, 102};
constexpr Colour clear{0, 0, 0, 0};
}  // namespace palette

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

Stroke disc(const Vec2& centre, double radius, Colour fill) {
  return {centre, centre, radius, 0.0, fill, palette::clear};
}

Stroke line(const Vec2& a, const Vec2& b, double half_width, Colour colour) {
  return {a, b, half_width, 0.0, colour, palette::clear};
}

bool is_driven(const Body& body) {
  return body.driven_angular_velocity.value_or(body.torque) != 0.0;
}

/// Sizes that belong to the page rather than to the scene, m: the same in every clip of a scene.
struct Page {
  double unit;  // a hundredth of the view's longer side
  explicit Page(const View& view) : unit(0.01 * (view.high - view.low).maxCoeff()) {}
  double hairline() const { return 0.1 * unit; }
  double text() const { return 2.8 * unit; }
};

class Composer {
 public:
  Composer(const Scene& scene, const World& world, Picture& picture)
      : scene_(scene), world_(world), picture_(picture), page_(scene.view) {}

  void run() {
    picture_.clear();
    picture_.view = scene_.view;
    picture_.background = palette::paper;
    // Each change between strokes, strips and labels costs a canvas some time: like goes by like.
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_rail(i);
    for (const CableState& cable : world_.cables) add_cable(cable);
    for (const Wall& wall : scene_.walls) {
      picture_.add(line(wall.a, wall.b, 0.25 * page_.unit, palette::fixed_edge));
    }
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_body(i);
    for (const CableState& cable : world_.cables) add_fastenings(cable);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_arrow_head(i);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_arrow_shaft(i);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_weight(i);
  }

 private:
  /// Whether an earlier body runs on the same line.
  bool shares_rail(std::size_t i) const {
    const Body& body = scene_.bodies[i];
    return std::any_of(scene_.bodies.begin(),
                       scene_.bodies.begin() + static_cast<std::ptrdiff_t>(i),
                       [&](const Body& other) {
                         constexpr double same = 1e-6;
                         return other.kind == BodyKind::rail &&
                                std::abs(cross(body.rail_axis, other.rail_axis)) < same &&
                                std::abs(cross(body.rail_axis, other.position - body.position)) <
                                    same * page_.unit;
                       });
  }

  /// A faint line where the body's centre can go, right across the page.
  void add_rail(std::size_t i) {
    const Body& body = scene_.bodies[i];
    if (body.kind != BodyKind::rail || shares_rail(i)) return;
    const double reach =
        (body.position - 0.5 * (scene_.view.low + scene_.view.high)).norm() + 300.0 * page_.unit;
    Strip rail;
    rail.first = picture_.points.size();
    rail.count = 2;
    rail.half_width = 1.5 * page_.hairline();
    rail.fill = palette::faint;
    for (const double end : {-reach, reach}) {
      picture_.points.push_back({body.position + end * body.rail_axis, body.rail_axis, 0.0});
    }
    picture_.add(rail);
  }

  void add_cable(const CableState& cable) {
    Strip strip;
    strip.half_width = cable.half_width;
    strip.edge_width = std::min(0.22 * cable.half_width, 2.0 * page_.hairline());
    strip.mark_spacing = mark_spacing(cable);
    strip.mark_length = 0.25 * strip.mark_spacing;
    strip.fill = palette::cable;
    strip.edge = palette::cable_edge;
    strip.mark = palette::cable_mark;
    const double smallest_sag = 5e-3 * page_.unit;  // 1/20 px in 960
    std::vector<std::size_t> begins =
        append_cable_path(scene_, world_, cable, smallest_sag, picture_.points);
    begins.push_back(picture_.points.size());
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
      strip.first = begins[i];
      strip.count = begins[i + 1] - begins[i];
      picture_.add(strip);
    }
  }

  void add_body(std::size_t i) {
    const Body& body = scene_.bodies[i];
    const Vec2& centre = world_.position[i];
    const double r = body.radius, angle = world_.angle[i];
    const bool fixed = body.kind == BodyKind::fixed;
    const Colour fill = fixed ? palette::fixed : is_driven(body) ? palette::driven : palette::body;
    const Colour edge = fixed             ? palette::fixed_edge
                        : is_driven(body) ? palette::driven_edge
                                          : palette::body_edge;
    picture_.add(Stroke{centre, centre, r, std::min(0.09 * r, 0.4 * page_.unit), fill, edge});

    // Three spokes, and a dot between two of them, so that no turn of less than a whole one looks
    // like none.
    for (int k = 0; k < 3; ++k) {
      const Vec2 e = unit_vector(angle + k * turn / 3.0);
      picture_.add(line(centre, centre + 0.9 * r * e, 0.045 * r, edge));
    }
    picture_.add(disc(centre + 0.68 * r * unit_vector(angle + turn / 6.0), 0.1 * r, edge));
    picture_.add(disc(centre, 0.17 * r, edge));
    if (body.kind == BodyKind::fixed_axle || fixed) {
      picture_.add(disc(centre, 0.11 * r, palette::paper));
      picture_.add(disc(centre, 0.055 * r, palette::ink));
    }
  }

  /// What holds the ends of an open cable: a bolt in the world, a pin on a body.
  void add_fastenings(const CableState& cable) {
    if (cable.closed || cable.links.size() < 2) return;
    for (const Link* link : {&cable.links.front(), &cable.links.back()}) {
      if (link->body >= 0) {
        picture_.add(
            disc(link_centre(world_, *link), 1.05 * cable.half_width, palette::cable_edge));
      } else {
        const double r = std::max(1.7 * cable.half_width, 0.6 * page_.unit);
        picture_.add(disc(link->offset, r, palette::ink));
        picture_.add(disc(link->offset, 0.4 * r, palette::paper));
      }
    }
  }

  /// The arrow on a driven body shows the sense in which it is driven and does not turn with it.
  struct Arrow {
    double sense = 0.0;         // +1 counter-clockwise, -1 clockwise, 0 none
    double radius, half_width;  // m
    double from, to;            // rad
  };
  Arrow arrow(std::size_t i) const {
    const Body& body = scene_.bodies[i];
    if (!is_driven(body)) return {};
    const double sense = body.driven_angular_velocity.value_or(body.torque) > 0.0 ? 1.0 : -1.0;
    return {sense, 0.42 * body.radius, std::min(0.055 * body.radius, 0.35 * page_.unit),
            0.25 * turn - sense * 0.36 * turn, 0.25 * turn + sense * 0.36 * turn};
  }

  void add_arrow_head(std::size_t i) {
    const Arrow a = arrow(i);
    if (a.sense == 0.0) return;
    const Vec2& centre = world_.position[i];
    const Vec2 radial = unit_vector(a.to), tip = centre + a.radius * radial;
    for (const double side : {-1.0, 1.0}) {
      const Vec2 barb = tip + 0.38 * a.radius * (side * radial - a.sense * left(radial));
      picture_.add(line(tip, barb, a.half_width, palette::ink));
    }
    picture_.add(disc(centre + a.radius * unit_vector(a.from), a.half_width, palette::ink));
  }

  void add_arrow_shaft(std::size_t i) {
    const Arrow a = arrow(i);
    if (a.sense == 0.0) return;
    Strip shaft;
    shaft.first = picture_.points.size();
    constexpr int pieces = 10;
    for (int k = 0; k <= pieces; ++k) {
      const Vec2 e = unit_vector(a.from + (a.to - a.from) * k / pieces);
      picture_.points.push_back({world_.position[i] + a.radius * e, a.sense * left(e), 0.0});
    }
    shaft.count = picture_.points.size() - shaft.first;
    shaft.half_width = a.half_width;
    shaft.fill = palette::ink;
    picture_.add(shaft);
  }

  /// The mass of a body that hangs on a cable's end: under it, or beside it where a cable runs
  /// round it.
  void add_weight(std::size_t i) {
    const Body& body = scene_.bodies[i];
    if (body.kind == BodyKind::fixed || body.kind == BodyKind::fixed_axle || !holds_cable_end(i))
      return;
    const std::string text = fmt::format("{:.4g} kg", body.mass);
    Vec2 offset(0.0, -(body.radius + 0.8 * page_.text()));
    if (const double round = cable_round(i); round > 0.0) {
      const double half_text = 0.3 * page_.text() * static_cast<double>(text.size());  // about
      offset = Vec2(body.radius + round + 0.5 * page_.text() + half_text, 0.0);
    }
    picture_.add(Label{world_.position[i] + offset, page_.text(), text, palette::ink});
  }

  /// Width of the widest cable that runs round body i at time 0, m; 0 if none does. (Were it the
  /// present one, labels would jump.)
  double cable_round(std::size_t i) const {
    double width = 0.0;
    for (const Cable& cable : scene_.cables) {
      for (const Wrap& wrap : cable.wraps) {
        if (wrap.body == static_cast<int>(i)) width = std::max(width, 2.0 * cable.half_width);
      }
    }
    return width;
  }

  bool holds_cable_end(std::size_t i) const {
    return std::any_of(scene_.cables.begin(), scene_.cables.end(), [i](const Cable& cable) {
      const auto body = static_cast<int>(i);
      return !cable.closed && (cable.start.body == body || cable.end.body == body);
    });
  }

  const Scene& scene_;
  const World& world_;
  Picture& picture_;
  Page page_;
};

}  // namespace

void compose(const Scene& scene, const World& world, Picture& picture) {
  Composer(scene, world, picture).run();
}

}  // namespace pinchlab
