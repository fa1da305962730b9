// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How a scene is drawn: a theme for all scenes, and what one scene says of its own things.

#include <optional>
#include <string>
#include <vector>

#include "render/picture/picture.h"

namespace pinchlab {

struct Paint {
  Colour fill, edge;
  bool operator==(const Paint&) const = default;
};

/// Colours and sizes of a picture. The default is the palette of Okabe and Ito, told apart with any
/// colour vision, with tints and shades of its colours. Half of what lies under a body shows
/// through it, so that a body that has sunk into a cable shows the overlap.
struct Theme {
  Colour background{252, 252, 250};
  Colour ink{38, 43, 51};  ///< text, arrows, anchors
  Colour rail{205, 209, 214};
  Colour support{128, 135, 144};  ///< brackets, walls' hatching
  Paint cable{{236, 165, 46}, {110, 62, 8}};
  Colour cable_mark{152, 84, 6};
  Paint body{{172, 206, 236, 128}, {0, 82, 130}};
  Paint driven{{148, 214, 190, 128}, {0, 100, 74}};
  Paint fixed{{184, 188, 194, 128}, {84, 92, 102}};
  Colour shadow{0, 0, 0, 0};  ///< alpha 0: none
  double line_width = 1.0;    ///< factor on every line and outline
  double text_height = 2.8;   ///< font size in hundredths of the view's longer side
  bool operator==(const Theme&) const = default;
};

/// Where a body's label stands.
enum class LabelSide { automatic, below, above, left, right };

/// What a scene says of a body's looks.
struct BodyLook {
  std::optional<Colour> colour;      ///< of its fill; the edge is a shade of it
  std::optional<std::string> label;  ///< empty: none; default: its mass if it can move
  std::optional<double> mass;        ///< kg, where cables that it holds have added to the body's
  LabelSide side = LabelSide::automatic;
  bool marks = true;  ///< spokes and dot, by which one sees it turn
};

struct CableLook {
  std::optional<Colour> colour;
  bool marks = true;  ///< stripes, by which one sees it run
};

/// What a scene says of its looks; lists as long as the scene's, or empty.
struct SceneLook {
  std::vector<BodyLook> bodies;
  std::vector<CableLook> cables;
  bool fit_view = false;  ///< the view is what the pair's motion needs
};

}  // namespace pinchlab
