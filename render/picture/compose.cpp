// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/compose.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/at.h"
#include "render/picture/cable_path.h"
#include "render/picture/chain_path.h"
#include "render/picture/layer_seam.h"
#include "render/picture/polygon_outline.h"
#include "sim/cable/cable.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/tangent.h"

namespace pinchlab {

namespace {

constexpr double turn = 2.0 * std::numbers::pi;

constexpr Colour clear{0, 0, 0, 0};

Vec2 unit_vector(double angle) {
  return {std::cos(angle), std::sin(angle)};
}

Stroke disc(const Vec2& centre, double radius, Colour fill) {
  return {centre, centre, radius, 0.0, fill, clear};
}

Stroke line(const Vec2& a, const Vec2& b, double half_width, Colour colour) {
  return {a, b, half_width, 0.0, colour, clear};
}

bool is_driven(const Body& body) {
  return strongest_drive(body) != 0.0;
}

/// The edge that goes with a fill of the scene's choice.
Colour shade(Colour fill) {
  const auto darker = [](std::uint8_t c) { return static_cast<std::uint8_t>(c * 2 / 5); };
  return {darker(fill.red), darker(fill.green), darker(fill.blue), 255};
}

class Composer {
 public:
  Composer(const Scene& scene, const Scenery& scenery, const World& world, Picture& picture)
      : scene_(scene), scenery_(scenery), theme_(scenery.theme), world_(world), picture_(picture) {}

  void run() {
    picture_.clear();
    picture_.view = scenery_.view;
    picture_.background = theme_.background;
    // Each change between strokes, strips and labels costs a canvas some time: like goes by like.
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_rail(i);
    for (const Anchor& anchor : scenery_.anchors) add_anchor_plate(anchor);
    if (theme_.shadow.alpha > 0) add_shadows();
    for (std::size_t c = 0; c < world_.cables.size(); ++c) {
      for (const LayeredLink& layered : links_in_layers(scene_, world_, c)) {
        const auto body = static_cast<std::size_t>(layered.link.body);
        const auto [fill, edge] = paint_of(body);
        append_riser(world_, layered, world_.cables[c].half_width, rim_band(body),
                     {over_paper(fill), edge}, picture_);
      }
    }
    for (std::size_t c = 0; c < world_.cables.size(); ++c) add_cable(c);
    for (const Wall& wall : scene_.walls) {
      picture_.add(line(wall.a, wall.b, 2.5 * scenery_.line(), theme_.fixed.edge));
    }
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_body(i);
    for (std::size_t c = 0; c < world_.cables.size(); ++c) {
      if (world_.cables[c].joint == Joint::none) {
        add_fastenings(c);
      } else {
        add_joint(c);
      }
    }
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_arrow_ends(i);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) add_arrow_shaft(i);
    for (const SceneryLabel& label : scenery_.labels) {
      picture_.add(Label{world_.position[label.body] + label.offset, scenery_.text(), label.text,
                         theme_.ink});
    }
  }

 private:
  /// What is fixed to the ground: a line from a to b, hatched on its left.
  void add_hatched(const Vec2& a, const Vec2& b, double spacing) {
    const double width = 1.1 * scenery_.line();
    picture_.add(line(a, b, 1.3 * width, theme_.support));
    const double length = (b - a).norm();
    const Vec2 along = (b - a) / length;
    const int count = std::max(2, static_cast<int>(std::lround(length / spacing)));
    for (int k = 0; k < count; ++k) {
      const Vec2 foot = a + (k + 0.75) / count * (b - a);
      picture_.add(line(foot, foot + 0.7 * spacing * (left(along) - along), width, theme_.support));
    }
  }

  /// A bracket from an axle down to the ground, of a size with a wheel of radius r.
  void add_bracket(const Vec2& axle, double r) {
    const Vec2 foot = axle + Vec2(0.0, -0.6 * r), half(0.34 * r, 0.0);
    for (const double side : {-0.6, 0.6}) {
      picture_.add(line(axle, foot + side * half, 1.3 * scenery_.line(), theme_.support));
    }
    add_hatched(foot + half, foot - half, 0.2 * r);
  }

  /// Where the body's centre goes in the clips. What ends its way is drawn as a stop, and nothing
  /// else there: a bracket would look like one.
  void add_rail(std::size_t i) {
    if (scene_.bodies[i].kind != BodyKind::rail || !scenery_.travel[i].own) return;
    const auto [low, high] = rail_ends(scene_, scenery_, i);
    picture_.add(line(low, high, 1.5 * scenery_.line(), theme_.rail));
  }

  void add_anchor_plate(const Anchor& anchor) {
    const double r = anchor_radius(scenery_, anchor.half_width);
    const Vec2 across = 1.3 * r * left(anchor.outward),
               foot = anchor.point + 1.1 * r * anchor.outward;
    add_hatched(foot + across, foot - across, 0.65 * r);
  }

  void add_shadows() {
    const Vec2 shift = scenery_.unit() * Vec2(0.5, -0.5);
    for (std::size_t i = 0; i < scene_.bodies.size(); ++i) {
      const Body& body = scene_.bodies[i];
      if (body.node || !body.outlined) continue;
      if (is_polygon(body)) {
        add_patch(i, shift, -body.corner_radius, theme_.shadow);
      } else {
        picture_.add(disc(world_.position[i] + shift, body.radius, theme_.shadow));
      }
    }
  }

  CableLook look_of(std::size_t c) const {
    return scenery_.look.cables.empty() ? CableLook{} : scenery_.look.cables[c];
  }

  Paint cable_paint(std::size_t c) const {
    const std::optional<Colour> colour = look_of(c).colour;
    return colour ? Paint{*colour, shade(*colour)} : theme_.cable;
  }

  void add_cable(std::size_t c) {
    const CableState& cable = world_.cables[c];
    if (cable.joint != Joint::none) return;
    const CableLook look = look_of(c);
    Strip strip;
    strip.half_width = cable.half_width;
    strip.edge_width = std::min(0.22 * cable.half_width, 2.0 * scenery_.line());
    strip.mark_spacing = mark_spacing(cable);
    strip.mark_length = look.marks ? (cable.closed ? 0.4 : 0.25) * strip.mark_spacing : 0.0;
    strip.fill = cable_paint(c).fill;
    strip.edge = cable_paint(c).edge;
    strip.mark = look.colour ? strip.edge : theme_.cable_mark;
    if (cable.rod) {
      if (is_on_node(scene_, cable.links.front())) return;
      strip.first = picture_.points.size();
      append_chain_path(scene_, world_, c, picture_.points);
      strip.count = picture_.points.size() - strip.first;
      picture_.add(strip);
      return;
    }
    const double smallest_sag = 5e-3 * scenery_.unit();  // 1/20 px in 960
    std::vector<double> sweeps;                          // rad, on each link
    auto begins = append_cable_path(scene_, world_, cable, smallest_sag, picture_.points, &sweeps);
    begins.push_back(picture_.points.size());
    for (std::size_t i = 0; i < sweeps.size(); ++i) add_seam(cable.links[i], sweeps[i], strip);
    for (std::size_t i = 0; i + 1 < begins.size(); ++i) {
      strip.first = begins[i];
      strip.count = begins[i + 1] - begins[i];
      picture_.add(strip);
    }
  }

  /// Lies under a cable where its turns on a drum that fills touch: pixels that two of them share
  /// would let the paper through.
  void add_seam(const Link& link, double sweep, const Strip& cable) {
    Strip seam;
    seam.first = picture_.points.size();
    append_seam(world_, link, cable.half_width, sweep, picture_.points);
    seam.count = picture_.points.size() - seam.first;
    seam.half_width = 0.5 * cable.half_width;
    seam.fill = cable.edge;
    if (seam.count > 0) picture_.add(seam);
  }

  /// A pin through what is joined there.
  void add_pin(const Vec2& point) {
    picture_.add(disc(point, 0.75 * scenery_.unit(), theme_.ink));
    picture_.add(disc(point, 0.3 * scenery_.unit(), paper()));
  }

  /// A zigzag of eight teeth between two straight ends.
  void add_coils(const Vec2& from, const Vec2& to, Colour colour) {
    constexpr int teeth = 8;
    constexpr double straight = 0.12;  // of the length, at either end
    const Vec2 along = to - from, across = 1.2 * scenery_.unit() * left(along.normalized());
    const double half_width = 2.0 * scenery_.line();
    Vec2 before = from;
    const auto go_to = [&](const Vec2& point) {
      picture_.add(line(before, point, half_width, colour));
      before = point;
    };
    go_to(from + straight * along);
    for (int k = 0; k < 2 * teeth; ++k) {
      const double share = straight + (1.0 - 2.0 * straight) * (k + 0.5) / (2 * teeth);
      go_to(from + share * along + (k % 2 == 0 ? 1.0 : -1.0) * across);
    }
    go_to(to - straight * along);
    go_to(to);
  }

  /// A block at the place where a stop's body runs against it, off the rail's line by the body's
  /// radius.
  void add_stop(const CableState& cable) {
    const Link& body = cable.links.back();
    const Vec2 axis = cable.segments[1].direction;
    const double radius = at(scene_.bodies, body.body).radius;
    const Vec2 foot =
        cable.links.front().offset + (cable.length + radius) * axis + 1.2 * scenery_.line() * axis;
    const Vec2 half = std::max(0.5 * radius, 1.5 * scenery_.unit()) * left(axis);
    picture_.add(line(foot - half, foot + half, 2.4 * scenery_.line(), theme_.support));
  }

  void add_joint(std::size_t c) {
    const CableState& cable = world_.cables[c];
    const Vec2 from = link_centre(world_, cable.links.front());
    const Vec2 to = link_centre(world_, cable.links.back());
    const Colour colour = look_of(c).colour.value_or(theme_.fixed.edge);
    switch (cable.joint) {
      case Joint::none:
        return;
      case Joint::stop:
        return add_stop(cable);
      case Joint::pin:  // once for the two bars of a hinge
        if (c > 0 && world_.cables[c - 1].joint == Joint::pin &&
            link_centre(world_, world_.cables[c - 1].links.front()) == from) {
          return;
        }
        if (cable.links.back().body < 0) add_bracket(from, 5.0 * scenery_.unit());
        return add_pin(from);
      case Joint::bar:
        picture_.add(line(from, to, 0.5 * scenery_.unit(), colour));
        break;
      case Joint::spring:
        add_coils(from, to, colour);
        break;
    }
    add_pin(from);
    add_pin(to);
  }

  /// The background, of which holes are made; opaque even where the page is not.
  Colour paper() const {
    Colour colour = theme_.background;
    colour.alpha = 255;
    return colour;
  }

  /// A colour as it looks on the background, opaque.
  Colour over_paper(Colour colour) const {
    const Colour page = paper();
    const auto mixed = [&colour](std::uint8_t top, std::uint8_t below) {
      return static_cast<std::uint8_t>((top * colour.alpha + below * (255 - colour.alpha) + 127) /
                                       255);
    };
    return {mixed(colour.red, page.red), mixed(colour.green, page.green),
            mixed(colour.blue, page.blue), 255};
  }

  /// m, how wide a body's outline is.
  double rim_band(std::size_t i) const {
    return std::min(0.09 * inner_radius(scene_.bodies[i]), 4.0 * scenery_.line());
  }

  Paint paint_of(std::size_t i) const {
    const Body& body = scene_.bodies[i];
    Paint paint = body.kind == BodyKind::fixed ? theme_.fixed
                  : is_driven(body)            ? theme_.driven
                                               : theme_.body;
    if (!scenery_.look.bodies.empty() && scenery_.look.bodies[i].colour) {
      paint = {*scenery_.look.bodies[i].colour, shade(*scenery_.look.bodies[i].colour)};
    }
    return paint;
  }

  PolygonOutline polygon(std::size_t i) const {
    return {scene_.bodies[i], world_.position[i], world_.angle[i]};
  }

  /// A patch whose sides lie `inset` (m) within those of the core of a polygon.
  void add_patch(std::size_t i, const Vec2& shift, double inset, Colour colour) {
    const std::size_t count = scene_.bodies[i].corners.size();
    for (std::size_t k = 0; k < count; ++k) {
      picture_.corners.push_back(polygon(i).corner(k, inset) + shift);
    }
    picture_.add(Patch{picture_.corners.size() - count, count, colour});
  }

  /// A polygon's band along its outline, `inset` m within it, which hides the sides of the patch
  /// that fills it.
  void add_polygon(std::size_t i, double inset, double band, Colour fill, Colour edge) {
    Strip outline;
    outline.first = picture_.points.size();
    outline.half_width = 0.5 * band;
    outline.fill = edge;
    Patch patch;
    patch.first = picture_.corners.size();
    patch.fill = fill;
    polygon(i).trace(inset + 0.5 * band, [this](const Vec2& point, const Vec2& e, bool is_new) {
      picture_.points.push_back({point, e, 0.0});
      if (is_new) picture_.corners.push_back(point);
    });
    const StripPoint first = picture_.points[outline.first];
    picture_.points.push_back(first);
    outline.count = picture_.points.size() - outline.first;
    patch.count = picture_.corners.size() - patch.first;
    picture_.add(patch);
    picture_.add(outline);
  }

  /// An outline's band and what is within it.
  void add_outline(std::size_t i, double band, Colour fill, Colour edge) {
    const Vec2& centre = world_.position[i];
    if (is_polygon(scene_.bodies[i])) return add_polygon(i, 0.0, band, fill, edge);
    picture_.add(Stroke{centre, centre, scene_.bodies[i].radius, band, fill, edge});
  }

  /// What is within an outline's band.
  void add_interior(std::size_t i, double band, Colour fill) {
    if (is_polygon(scene_.bodies[i])) return add_polygon(i, band, band, fill, fill);
    picture_.add(disc(world_.position[i], scene_.bodies[i].radius - band, fill));
  }

  /// Whether all shapes of a compound are discs about its centre: one cannot see them turn.
  bool is_round(std::size_t i, const std::vector<int>& shapes) const {
    return !shapes.empty() && std::ranges::all_of(shapes, [&](int s) {
      const double off = (at(world_.position, s) - world_.position[i]).norm();
      return !is_polygon(at(scene_.bodies, s)) && off <= 1e-6 * at(scene_.bodies, s).radius;
    });
  }

  /// What is drawn within the outline of body i, which has room for a wheel of radius r: its marks,
  /// its axle and what holds that.
  void add_wheel(std::size_t i, double r) {
    const Body& body = scene_.bodies[i];
    const Vec2& centre = world_.position[i];
    const double angle = world_.angle[i];
    const Colour edge = paint_of(i).edge;
    const bool held = body.kind == BodyKind::fixed_axle || body.kind == BodyKind::fixed;
    // A thin bar's axle is as large as other small ones: one is to see what it turns about.
    const bool turns = body.kind == BodyKind::fixed_axle && is_polygon(body);
    const double axle = turns ? std::max(r, 5.0 * scenery_.unit()) : r;
    if (held) add_bracket(centre, axle);  // inside of the rim, where no cable runs

    // Three spokes, and a dot between two of them, so that no turn of less than a whole one looks
    // like none.
    if (scenery_.look.bodies.empty() || scenery_.look.bodies[i].marks) {
      for (int k = 0; k < 3; ++k) {
        const Vec2 e = unit_vector(angle + k * turn / 3.0);
        picture_.add(line(centre, centre + 0.9 * r * e, 0.045 * r * theme_.line_width, edge));
      }
      picture_.add(disc(centre + 0.68 * r * unit_vector(angle + turn / 6.0), 0.1 * r, edge));
    }
    picture_.add(disc(centre, 0.17 * axle, edge));
    if (held) {
      picture_.add(disc(centre, 0.11 * axle, paper()));
      picture_.add(disc(centre, 0.055 * axle, theme_.ink));
    }
  }

  /// Shapes that overlap have one outline: the insides of all lie, opaque, over the bands of all.
  void add_compound(std::size_t i) {
    const auto [given, edge] = paint_of(i);
    const Colour fill = over_paper(given);
    const std::vector<int> shapes = outlines_of(scene_, static_cast<int>(i));
    double smallest = infinity, largest = 0.0;
    for (const int s : shapes) {
      const double r = inner_radius(at(scene_.bodies, s));
      smallest = std::min(smallest, r);
      largest = std::max(largest, r);
    }
    const double band = std::min({4.0 * scenery_.line(), 0.09 * largest, 0.3 * smallest});
    for (const int s : shapes) add_outline(index(s), band, fill, edge);
    for (const int s : shapes) add_interior(index(s), band, fill);
    if (is_round(i, shapes)) return add_wheel(i, largest);
    if (scene_.bodies[i].kind == BodyKind::fixed_axle) {
      add_bracket(world_.position[i], 5.0 * scenery_.unit());
      add_pin(world_.position[i]);
    }
  }

  void add_body(std::size_t i) {
    const Body& body = scene_.bodies[i];
    if (!body.outlined) return add_compound(i);
    if (body.node || body.carrier >= 0) return;
    add_outline(i, rim_band(i), paint_of(i).fill, paint_of(i).edge);
    add_wheel(i, inner_radius(body));
  }

  /// What holds the ends of an open cable: a bolt in the world, a pin on a body.
  void add_fastenings(std::size_t c) {
    const CableState& cable = world_.cables[c];
    if (cable.closed || cable.links.size() < 2) return;
    for (const Link* link : {&cable.links.front(), &cable.links.back()}) {
      if (is_on_node(scene_, *link)) continue;
      if (link->body >= 0) {
        picture_.add(
            disc(link_centre(world_, *link), 1.05 * cable.half_width, cable_paint(c).edge));
      } else {
        const double r = anchor_radius(scenery_, cable.half_width);
        picture_.add(disc(link->offset, r, theme_.ink));
        picture_.add(disc(link->offset, 0.4 * r, paper()));
      }
    }
  }

  /// The arrow beside a driven body's rim shows the sense in which it is driven and does not turn
  /// with it.
  struct Arrow {
    double sense = 0.0;         // +1 counter-clockwise, -1 clockwise, 0 none
    double radius, half_width;  // m
    double from, to;            // rad
  };
  Arrow arrow(std::size_t i) const {
    const Body& body = scene_.bodies[i];
    if (!is_driven(body)) return {};
    const double sense = strongest_drive(body) > 0.0 ? 1.0 : -1.0;
    const double r = arrow_radius(scene_, scenery_, i);
    const double reach = sense * std::clamp(5.0 * scenery_.unit() / r, 0.35, 0.8);  // rad
    return {sense, r, 3.0 * scenery_.line(), scenery_.arrow_middle[i] - reach,
            scenery_.arrow_middle[i] + reach};
  }

  void add_arrow_ends(std::size_t i) {
    const Arrow a = arrow(i);
    if (a.sense == 0.0) return;
    const Vec2& centre = world_.position[i];
    picture_.add(disc(centre + a.radius * unit_vector(a.from), a.half_width, theme_.ink));
    const Vec2 radial = unit_vector(a.to), tip = centre + a.radius * radial;
    for (const double side : {-1.0, 1.0}) {
      const Vec2 barb = tip + 1.1 * scenery_.unit() * (side * radial - a.sense * left(radial));
      picture_.add(line(tip, barb, a.half_width, theme_.ink));
    }
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
    shaft.fill = theme_.ink;
    picture_.add(shaft);
  }

  const Scene& scene_;
  const Scenery& scenery_;
  const Theme& theme_;
  const World& world_;
  Picture& picture_;
};

}  // namespace

void compose(const Scene& scene, const Scenery& scenery, const World& world, Picture& picture) {
  Composer(scene, scenery, world, picture).run();
}

}  // namespace pinchlab
