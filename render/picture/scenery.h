// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What stays the same from frame to frame of a scene's clips: the view, how far rails are used,
// where labels and arrows keep out of the way. Found by a rehearsal, so that both clips of a pair
// have the same.

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "render/picture/look.h"
#include "sim/configuration.h"
#include "sim/world.h"

namespace pinchlab {

/// A label that goes with a body.
struct SceneryLabel {
  std::size_t body = 0;
  std::string text;
  Vec2 offset = Vec2::Zero();  // m, of the text's centre from the body's
};

/// How far a body on a rail comes, m along its axis from where it starts.
struct Travel {
  double low = 0.0, high = 0.0;
  double reach = 0.0;  // m, the largest radius of the bodies on the rail
  bool own = true;     // not: another body's rail is this one's too, and longer
};

/// A cable's end in the world.
struct Anchor {
  Vec2 point = Vec2::Zero();      // m
  Vec2 outward = Vec2(0.0, 1.0);  // unit, away from the cable at the start
  double half_width = 0.0;        // m, the cable's
};

struct Scenery {
  Theme theme;
  SceneLook look;
  View view;
  std::vector<Travel> travel;        // one a body
  std::vector<double> arrow_middle;  // rad, one a body: where a motor's arrow stands
  std::vector<double> fullest;       // m, one a body: how thick the layers on it get
  std::vector<SceneryLabel> labels;
  std::vector<Anchor> anchors;

  /// Sizes that belong to the page rather than to the scene, m.
  double unit() const { return 0.01 * (view.high - view.low).maxCoeff(); }
  double line() const { return 0.1 * unit() * theme.line_width; }
  double text() const { return theme.text_height * unit(); }
};

using OnStep = std::function<void(const World& world)>;

/// Plays the scene once under each configuration and sets the scenery for all of them. The scene is
/// not played where nothing in it asks for it (no rail, no label, no motor, no fitted view). Where
/// a value becomes not finite the rehearsal ends early. `on_step` is called after each step. Throws
/// as make_world and on_step.
Scenery set_scenery(const Scene& scene, const SceneLook& look, const Theme& theme,
                    std::span<const Configuration> configurations, const OnStep& on_step = {});

/// The ends of a body's rail, m: as much further than anything on it comes in any clip that nothing
/// seems to be stopped there.
std::pair<Vec2, Vec2> rail_ends(const Scene& scene, const Scenery& scenery, std::size_t body);

/// m, of the ring that holds a cable's end in the world.
double anchor_radius(const Scenery& scenery, double half_width);

/// m from a driven body's centre to its arrow, outside of its rim and of the cables round it.
double arrow_radius(const Scene& scene, const Scenery& scenery, std::size_t body);

/// set_scenery for the pair that the scene asks for.
Scenery set_scenery(const Scene& scene, const SceneLook& look = {}, const Theme& theme = {},
                    const OnStep& on_step = {});

}  // namespace pinchlab
