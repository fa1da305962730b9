// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene.h"

#include <cmath>

namespace pinchlab {

double drive_at(const std::vector<MotorPoint>& motor, double t) {
  if (t <= motor.front().time) return motor.front().value;
  for (std::size_t i = 1; i < motor.size(); ++i) {
    const MotorPoint &a = motor[i - 1], &b = motor[i];
    if (t < b.time) return a.value + (b.value - a.value) * (t - a.time) / (b.time - a.time);
  }
  return motor.back().value;
}

// A line's mean is its value at the middle; the table's corners divide the time into lines.
double mean_drive(const std::vector<MotorPoint>& motor, double begin, double end) {
  double sum = 0.0, from = begin;
  const auto add_until = [&](double to) {
    sum += (to - from) * drive_at(motor, 0.5 * (from + to));
    from = to;
  };
  for (const MotorPoint& corner : motor) {
    if (corner.time > from && corner.time < end) add_until(corner.time);
  }
  add_until(end);
  return sum / (end - begin);
}

double strongest_drive(const Body& body) {
  double most = body.motor.empty() ? body.driven_angular_velocity.value_or(body.torque) : 0.0;
  for (const MotorPoint& point : body.motor) {
    if (std::abs(point.value) > std::abs(most)) most = point.value;
  }
  return most;
}

const char* to_string(Method method) {
  switch (method) {
    case Method::pinch:
      return "pinch";
    case Method::pinch_no_contact:
      return "pinch_no_contact";
    case Method::cable:
      return "cable";
  }
  return "unknown";
}

}  // namespace pinchlab
