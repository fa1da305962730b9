// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/mirror.h"

#include <algorithm>

namespace pinchlab {

namespace {

void mirror(Vec2& v) {
  v.x() = -v.x();
}

void mirror(Body& body) {
  for (Vec2* v : {&body.position, &body.velocity, &body.rail_axis, &body.seat}) mirror(*v);
  body.angle = -body.angle;
  body.angular_velocity = -body.angular_velocity;
  body.seat_angle = -body.seat_angle;
  body.torque = -body.torque;
  if (body.driven_angular_velocity) *body.driven_angular_velocity = -*body.driven_angular_velocity;
  for (MotorPoint& point : body.motor) point.value = -point.value;
  for (Vec2& corner : body.corners) mirror(corner);
  std::reverse(body.corners.begin(), body.corners.end());
}

}  // namespace

Scene mirrored(Scene scene) {
  mirror(scene.gravity);
  for (Body& body : scene.bodies) mirror(body);
  for (Cable& cable : scene.cables) {
    mirror(cable.start.point);
    mirror(cable.end.point);
    for (Wrap& wrap : cable.wraps) wrap.orientation = -wrap.orientation;
  }
  for (Wall& wall : scene.walls) {
    mirror(wall.a);
    mirror(wall.b);
  }
  scene.view = {{-scene.view.high.x(), scene.view.low.y()},
                {-scene.view.low.x(), scene.view.high.y()}};
  return scene;
}

}  // namespace pinchlab
