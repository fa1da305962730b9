// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How the arcs of a cable give way where the bodies under them clip.

#include "render/picture/fade.h"
#include "sim/scene.h"

namespace pinchlab {

/// Where two bodies clip, the arcs round them do not meet. Both give way, the shorter one by
/// more, smoothly, along a few widths of cable; what is left at the end of a short arc moves the
/// end of the span beyond it. So the cable does not jump where the one body's wrap begins or
/// ends.
struct GiveWay {
  Vec2 at_tail = Vec2::Zero(), at_head = Vec2::Zero();  // m, at the ends of the arc
  double length = 0.0, reach = 1.0;                     // m, of the arc; along which it fades
  bool none() const { return at_tail.isZero(0.0) && at_head.isZero(0.0); }

  Vec2 shift(double s) const {  // m, at s along the arc
    return fade(s, reach).value * at_tail + fade(length - s, reach).value * at_head;
  }
  Vec2 slope(double s) const {  // its derivative
    return fade(s, reach).slope * at_tail - fade(length - s, reach).slope * at_head;
  }
};

}  // namespace pinchlab
