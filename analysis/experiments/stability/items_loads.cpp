// SPDX-License-Identifier: GPL-3.0-or-later
// Heavy loads, long rows of pulleys, jerks and slip: what a cable carries.

#include <cmath>
#include <numbers>

#include "analysis/experiments/stability/items.h"
#include "analysis/experiments/stability/scenes.h"
#include "sim/make_world.h"

namespace pinchlab::experiments::stability {

namespace {

constexpr double R = pulley_radius + cable_half_width;
/// Inertia of a pulley of 1 kg over the square of the radius that the cable runs at, kg.
constexpr double pulley_load = 0.5 * pulley_radius * pulley_radius / (R * R);

/// How far load 0 has risen, against a t^2 / 2, relative to what `scale` m/s^2 would give.
std::function<double(const Scene&, const World&)> rise_error(double a, double scale) {
  return [a, scale](const Scene& scene, const World& world) {
    const double t = world.time();
    const double risen = world.position[0].y() - scene.bodies[0].position.y();
    return std::abs(risen - 0.5 * a * t * t) / (0.5 * scale * t * t);
  };
}

Case along_a_cable(double ratio) {
  const int count = 21;
  Case test;
  test.series = "along a cable";
  test.x = ratio;
  test.scene = build::load_chain(count, ratio, 0.5 * ratio, 1.0);
  test.energy = EnergyLaw::keeps;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  const double a = -0.5 * ratio * g / (1.5 * ratio + count * pulley_load);
  test.error = rise_error(a, std::abs(a));
  return test;
}

Case hanging(double ratio, bool quick) {
  Case test;
  test.series = "hanging";
  test.x = ratio;
  test.scene = hanging_pair(ratio);
  test.seconds = quick ? 5.0 : 10.0;
  test.energy = EnergyLaw::falls;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  test.rests = true;
  return test;
}

Case stacked(double ratio) {
  Case test;
  test.series = "stack on a light roller";
  test.x = ratio;
  test.scene = heavy_on_light(ratio);
  test.seconds = 3.0;
  test.energy = EnergyLaw::falls;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  test.rests = true;
  return test;
}

/// Tension ratio at which a cable slips over all the pulleys of a scene's first cable.
double slip_ratio(const Scene& scene, double mu) {
  const World world = make_world(scene, Method::pinch);
  double wrap = 0.0;
  for (const Link& link : world.cables[0].links) wrap += link.wrap;
  return std::exp(mu * wrap);
}

Case slipping(const std::string& series, int count, BodyKind kind, double mu) {
  const double light = 1.0, heavy = 3.0;
  Case test;
  test.series = series;
  test.x = mu;
  test.scene = build::load_chain(count, light, heavy, 1.0, mu);
  for (Body& b : test.scene.bodies) {
    if (b.kind == BodyKind::fixed_axle) b.kind = kind;
  }
  const double k = slip_ratio(test.scene, mu);
  // Without slip the pulleys' inertia, or their being fixed, sets the acceleration.
  double a = 0.0;
  if (kind == BodyKind::fixed_axle) a = (heavy - light) * g / (heavy + light + count * pulley_load);
  const double held = heavy * (g - a) / (light * (g + a));
  if (held > k) a = g * (heavy - k * light) / (heavy + k * light);
  test.error = rise_error(a, g);
  test.energy = EnergyLaw::falls;
  test.energy_at_play_j = energy_at_play(test.scene, 1.0);
  return test;
}

}  // namespace

Item mass_ratio(bool quick) {
  Item item;
  item.id = "mass-ratio";
  item.title = "Mass ratio";
  item.x_name = "mass ratio";
  item.why =
      "Ten sweeps carry a force over ten links only a little at a time, so that heavy loads on "
      "light pulleys stretch the cable; one elimination carries it exactly. A light body between "
      "taut spans vibrates faster than steps can follow; all three methods damp it on to its line "
      "(`sim/solve/light_bodies.h`).";
  item.scene =
      "Along a cable: M and M/2 on one cable over 21 pulleys of 1 kg; the motion after 1 s is "
      "compared with the closed form. Hanging: M kg on a cable below a body of 1 kg on another, "
      "1 mm out of line and damped. Stack: a roller of M kg falls on one of 1 kg that falls on a "
      "wrapped drum. The last two must come to rest.";
  for (const double ratio : decades(0, 9, quick ? 1 : 2))
    item.cases.push_back(along_a_cable(ratio));
  for (const double ratio : decades(0, 9, quick ? 1 : 2)) {
    item.cases.push_back(hanging(ratio, quick));
  }
  for (const double ratio : decades(0, 9, quick ? 1 : 2)) item.cases.push_back(stacked(ratio));
  return item;
}

Item pulleys(bool quick) {
  Item item;
  item.id = "pulleys";
  item.title = "Number of pulleys";
  item.x_name = "pulleys";
  item.why =
      "The direct solve takes the cable's force over any number of pulleys in one elimination; a "
      "sweep takes it a pulley further, and the sweeps are counted.";
  item.scene =
      "1000 kg and 999 kg, or 2 kg and 1 kg, on one cable over a row of pulleys of 0.1 kg; the "
      "motion after 1 s is compared with the closed form.";
  for (const bool heavy : {true, false}) {
    for (const int count : {1, 3, 5, 11, 21, 51, 101, 301, 1001}) {
      if (quick && count > 101) continue;
      const double left = heavy ? 1000.0 : 2.0, right = heavy ? 999.0 : 1.0;
      Case test;
      test.series = heavy ? "1000 kg and 999 kg" : "2 kg and 1 kg";
      test.x = count;
      test.scene = build::load_chain(count, left, right, 0.1);
      const double a = -(left - right) * g / (left + right + count * 0.1 * pulley_load);
      test.error = rise_error(a, std::abs(a));
      test.energy = EnergyLaw::keeps;
      test.energy_at_play_j = energy_at_play(test.scene, 1.0);
      item.cases.push_back(test);
    }
  }
  return item;
}

Item caught_loads(bool quick) {
  Item item;
  item.id = "catch";
  item.title = "Dropped loads";
  item.x_name = "free fall before the cable is taut, m";
  item.why =
      "The direct solve stops the load in the step in which its cable gets taut; sweeps let the "
      "cable stretch first and then turn the stretch into speed, so that the load bounces.";
  item.scene =
      "10 kg fall until their cable, led over five pulleys of 0.1 kg to an anchor, gets taut and "
      "stops them; then they must hang still. At four steps a frame and at one.";
  for (const int steps : {4, 1}) {
    for (const double height : decades(-2, 3, quick ? 1 : 2)) {
      Case test;
      test.series = steps == 1 ? "1 step a frame" : "4 steps a frame";
      test.x = height;
      test.scene = caught_load(height);
      test.scene.steps_per_frame = steps;
      test.seconds = std::sqrt(2.0 * height / g) + 2.0;
      test.energy = EnergyLaw::falls;
      test.energy_at_play_j = energy_at_play(test.scene, height);
      test.rests = true;
      item.cases.push_back(test);
    }
  }
  return item;
}

Item jerks(bool quick) {
  Item item;
  item.id = "jerk";
  item.title = "Jerks";
  item.x_name = "mass ratio";
  item.why =
      "Ours goes on from the jerk with the velocities after it, and corrects lengths within the "
      "step. In a step that knows no jerk a light body is thrown aside; a heavier one overlaps, or "
      "stretches its cable.";
  item.scene =
      "Through a light body: the hanging pair of the mass ratios, where M first falls 0.1 m on a "
      "slack cable. Into a pinch: M falls 5 m before its cable jerks a roller of 1 kg, which rests "
      "10 mm below a wrapped drum, up against it.";
  for (const double ratio : decades(0, 9, quick ? 1 : 2)) {
    Case test = hanging(ratio, quick);
    test.series = "through a light body";
    test.scene.cables[1].slack = 0.1;
    item.cases.push_back(test);
  }
  for (const double ratio : decades(0, 4, quick ? 1 : 2)) {
    Case test;
    test.series = "into a pinch";
    test.x = ratio;
    test.scene = roller_jerked_at_drum(ratio);
    test.seconds = 2.0;
    item.cases.push_back(test);
  }
  return item;
}

Item friction(bool quick) {
  Item item;
  item.id = "friction";
  item.title = "Friction across the slip border";
  item.x_name = "capstan coefficient";
  item.why =
      "Sticking or slipping is found with the tensions, in one solve, for all pulleys at once; ten "
      "sweeps come near it from the sticking side, so that a cable that ought to slip easily is "
      "held back.";
  item.scene =
      "1 kg and 3 kg on a cable over one fixed pulley, one that turns, and nine fixed ones in a "
      "row; the motion after 1 s is compared with the closed form. Infinite friction is drawn at "
      "1000.";
  std::vector<double> values{0.0};
  for (const double mu : decades(-3, 2, quick ? 2 : 4)) values.push_back(mu);
  const double border = std::log(3.0) / std::numbers::pi;  // of the one fixed pulley
  for (const double part : {0.9, 0.999, 1.0 - 1e-6, 1.0 - 1e-9, 1.0 + 1e-9, 1.0 + 1e-6, 1.001, 1.1})
    values.push_back(part * border);
  values.push_back(infinity);
  std::sort(values.begin(), values.end());
  for (const double mu : values) {
    item.cases.push_back(slipping("one fixed pulley", 1, BodyKind::fixed, mu));
  }
  for (const double mu : values) {
    item.cases.push_back(slipping("one turning pulley", 1, BodyKind::fixed_axle, mu));
  }
  for (const double mu : values) {
    item.cases.push_back(slipping("nine fixed pulleys", 9, BodyKind::fixed, mu));
  }
  return item;
}

}  // namespace pinchlab::experiments::stability
