// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/joints.h"

#include <algorithm>

#include "base/at.h"
#include "sim/compound.h"
#include "sim/outline.h"
#include "sim/scene_error.h"

namespace pinchlab {

namespace {

/// The point of a body, or of the world, that is at `place` when the scene starts.
Attachment attached_at(const Scene& scene, int body, const Vec2& place) {
  if (body < 0) return {-1, place, false};
  const Body& b = at(scene.bodies, body);
  return {body, turned(Vec2(place - b.position), -b.angle), false};
}

void refuse_idle(const std::string& name, int body, int other) {
  if (body == other) {
    throw SceneError("joint '" + name + "'",
                     body < 0 ? "both of its ends are on the world; let one be on a body"
                              : "both of its ends are on one body; let one be elsewhere");
  }
}

/// A cable of one segment from `start` to `end`; of no use as a pinched one, it has next to no
/// width.
Cable segment_of(const Scene& scene, const std::string& name, Joint joint, const Attachment& start,
                 const Attachment& end) {
  Cable cable;
  cable.name = name;
  cable.joint = joint;
  cable.start = start;
  cable.end = end;
  const double length = (place_of(scene, end) - place_of(scene, start)).norm();
  if (!(length > 0.0)) {
    throw SceneError("joint '" + name + "'",
                     "its ends lie in one place; move them apart, or use a hinge");
  }
  cable.half_width = 1e-6 * length;  // nothing touches it; cables have some width
  return cable;
}

}  // namespace

void add_bar(Scene& scene, const std::string& name, const Attachment& start,
             const Attachment& end) {
  refuse_idle(name, start.body, end.body);
  Cable bar = segment_of(scene, name, Joint::bar, start, end);
  bar.rod = true;
  scene.cables.push_back(bar);
}

void add_hinge(Scene& scene, const std::string& name, int body, int other, const Vec2& point) {
  refuse_idle(name, body, other);
  const auto distance = [&](int b) {
    return b < 0 ? 0.0 : (point - at(scene.bodies, b).position).norm();
  };
  const bool swapped = other >= 0 && distance(other) < distance(body);
  const int pinned = swapped ? other : body, holder = swapped ? body : other;
  const double radius = at(scene.bodies, holder >= 0 ? holder : body).radius;
  const double length = std::max({radius, distance(body), distance(other)});
  const double arm = swapped ? -length : length;
  for (const Vec2& axis : {Vec2(1.0, 0.0), Vec2(0.0, 1.0)}) {
    Cable bar = segment_of(scene, name + (axis.x() > 0.0 ? ":x" : ":y"), Joint::pin,
                           attached_at(scene, pinned, point),
                           attached_at(scene, holder, point + arm * axis));
    bar.rod = true;
    scene.cables.push_back(bar);
  }
  if (other < 0) return;
  for (const int a : outlines_of(scene, body)) {
    for (const int b : outlines_of(scene, other)) keep_apart(scene, a, b);
  }
}

void add_spring(Scene& scene, const std::string& name, const Attachment& start,
                const Attachment& end, double stiffness, double natural_length, double damping) {
  refuse_idle(name, start.body, end.body);
  Cable spring = segment_of(scene, name, Joint::spring, start, end);
  spring.rod = true;
  const double distance = (place_of(scene, end) - place_of(scene, start)).norm();
  const double natural = natural_length > 0.0 ? natural_length : distance;
  spring.slack = natural - distance;
  spring.axial_stiffness = stiffness * natural;
  spring.damping = damping;
  scene.cables.push_back(spring);
}

// |x - anchor| <= 2 range, the anchor so far beyond the other end of the travel that the body never
// comes nearer than the range: along a rail that is x <= its end, and the segment's direction the
// axis.
void add_stops(Scene& scene, int body, double low, double high) {
  const Body& b = at(scene.bodies, body);
  const Vec2 axis = b.rail_axis.normalized();
  const double range = high - low;
  for (const double side : {-1.0, 1.0}) {
    const double end = side > 0.0 ? high : low;
    const Attachment anchor{-1, b.position + (end - 2.0 * side * range) * axis, false};
    Cable stop = segment_of(scene, b.name + (side > 0.0 ? ":high" : ":low"), Joint::stop, anchor,
                            {body, Vec2::Zero(), false});
    stop.slack = 2.0 * range - (b.position - anchor.point).norm();
    // It starts there, but for round-off of the places, some thousand times less.
    if (stop.slack < 1e-12 * range) stop.slack = 0.0;
    scene.cables.push_back(stop);
  }
}

}  // namespace pinchlab
