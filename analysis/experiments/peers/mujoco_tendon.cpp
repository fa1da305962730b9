// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/mujoco_tendon.h"

#include <fmt/format.h>
#include <cmath>

#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/make_world.h"

namespace pinchlab::experiments {

namespace {

std::string point(const Vec2& p) {
  return fmt::format("{} 0 {}", p.x(), p.y());
}

bool is_load(const Cable& cable, std::size_t body) {
  const auto index = static_cast<int>(body);
  return cable.start.body == index || cable.end.body == index;
}

bool is_wrapped(const Cable& cable, std::size_t body) {
  return std::any_of(cable.wraps.begin(), cable.wraps.end(),
                     [=](const Wrap& wrap) { return wrap.body == static_cast<int>(body); });
}

/// The load whose span hangs straight down and so moves straight along the cable, or -1.
int straight_load(const CableState& cable) {
  const auto hangs = [](const Segment& s) { return std::abs(s.direction.x()) < 1e-9; };
  if (cable.links.back().body >= 0 && hangs(cable.segments.back())) {
    return cable.links.back().body;
  }
  if (cable.links.front().body >= 0 && hangs(cable.segments[1])) return cable.links.front().body;
  return -1;
}

/// Whether the cable turns a pulley, and does not slip on it.
bool turns(const Body& body) {
  return body.kind == BodyKind::fixed_axle && body.cable_friction == infinity;
}

/// I/R^2 (kg) summed over the pulleys that the cable turns.
double pulley_share(const Scene& scene, const CableState& cable) {
  double share = 0.0;
  for (const Link& link : cable.links) {
    if (link.orientation == 0) continue;
    const Body& body = at(scene.bodies, link.body);
    if (turns(body)) share += inertia_of(body) / (link.radius * link.radius);
  }
  return share;
}

std::string load_xml(const Scene& scene, std::size_t b, double armature) {
  const Body& body = scene.bodies[b];
  std::string axes;
  for (const char* axis : {"1 0 0", "0 0 1"}) {
    axes += fmt::format("<joint type='slide' axis='{}' armature='{}'/>", axis,
                        axis[0] == '0' ? armature : 0.0);
  }
  return fmt::format(
      "<body pos='{}'>{}<inertial pos='0 0 0' mass='{}' diaginertia='1 1 1'/>"
      "<site name='end{}'/></body>\n",
      point(body.position), axes, body.mass, b);
}

/// What the tendon runs through: end, pulley, a fixed point on the span to the next pulley, ...
struct Path {
  std::string world, tendon;  // XML
};

/// A tendon's wrap is found from both neighbouring points, badly so near half a turn; a point just
/// above its middle splits such a wrap in two, and adds a constant to the length.
void split_wrap(const Vec2& centre, const Link& link, const Segment& before, std::size_t i,
                const std::string& geom, Path& path) {
  const Vec2 arm = before.head - centre;
  const double angle = 0.5 * link.orientation * link.wrap;
  const Vec2 middle =
      centre + (1.0 + 1e-6) * Vec2(arm.x() * std::cos(angle) - arm.y() * std::sin(angle),
                                   arm.x() * std::sin(angle) + arm.y() * std::cos(angle));
  path.world += fmt::format("<site name='top{}' pos='{}'/>\n", i, point(middle));
  path.tendon += geom + fmt::format("<site site='top{}'/>", i) + geom;
}

void add_pulley(const World& world, const CableState& cable, std::size_t i, Path& path) {
  const Link& link = cable.links[i];
  const Segment &before = cable.segments[i], &after = cable.segments[i + 1];
  const Vec2 centre = link_centre(world, link);
  // The cable runs on the side of the middle of its wrap.
  const Vec2 side = centre + 2.0 * link.radius *
                                 ((before.head - centre) + (after.tail - centre) +
                                  link.radius * (before.direction - after.direction))
                                     .normalized();
  path.world += fmt::format(
      "<geom name='pulley{0}' type='cylinder' pos='{1}' euler='90 0 0' size='{2} 0.1' contype='0' "
      "conaffinity='0'/>\n<site name='side{0}' pos='{3}'/>\n",
      i, point(centre), link.radius, point(side));
  const std::string geom = fmt::format("<geom geom='pulley{0}' sidesite='side{0}'/>", i);
  if (link.wrap > 2.5) {
    split_wrap(centre, link, before, i, geom, path);
  } else {
    path.tendon += geom;
  }
  if (i + 2 < cable.links.size()) {
    path.world +=
        fmt::format("<site name='mid{}' pos='{}'/>\n", i, point(0.5 * (after.tail + after.head)));
    path.tendon += fmt::format("<site site='mid{}'/>", i);
  }
}

std::string end_site(const Link& link, const char* name, Path& path) {
  if (link.body >= 0) return fmt::format("<site site='end{}'/>", link.body);
  path.world += fmt::format("<site name='{}' pos='{}'/>\n", name, point(link.offset));
  return fmt::format("<site site='{}'/>", name);
}

Path path_of(const World& world, const CableState& cable) {
  Path path;
  path.tendon = end_site(cable.links.front(), "start", path);
  for (std::size_t i = 1; i + 1 < cable.links.size(); ++i) add_pulley(world, cable, i, path);
  path.tendon += end_site(cable.links.back(), "finish", path);
  return path;
}

std::vector<Place> places(const Problem& problem, const mjData& data,
                          const std::vector<int>& first_slide) {
  std::vector<Place> places;
  for (const std::size_t b : problem.watched) {
    const auto slide = static_cast<std::size_t>(first_slide[b]);
    places.push_back(
        {problem.scene.bodies[b].position + Vec2(data.qpos[slide], data.qpos[slide + 1]), 0.0});
  }
  return places;
}

}  // namespace

std::string mujoco_cannot(const Problem& problem) {
  const Scene& scene = problem.scene;
  if (!scene.walls.empty()) return "walls are not built";
  if (scene.cables.size() != 1 || scene.cables[0].closed) return "one open cable is built";
  bool any_turns = false;
  std::string why;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (is_load(scene.cables[0], b)) {
      if (body.kind != BodyKind::free || body.linear_drag > 0.0) why = "loads are built free";
    } else if (body.kind == BodyKind::free || body.kind == BodyKind::rail) {
      return "a tendon is not pinched: it has no width, and bodies do not feel it";
    } else if (!is_wrapped(scene.cables[0], b)) {
      why = "a tendon runs over what it runs over at the start";
    } else if (!turns(body) && body.cable_friction > 0.0) {
      why = "a tendon has no capstan friction";
    } else if (body.driven_angular_velocity || body.torque != 0.0 || body.angular_drag > 0.0) {
      why = "a tendon does not turn its pulleys";
    }
    any_turns = any_turns || turns(body);
  }
  if (!why.empty()) return why;
  const World world = make_world(scene, Method::pinch);
  if (any_turns && straight_load(world.cables[0]) < 0) {
    return "no load hangs straight, to carry the pulleys' inertia";
  }
  return "";
}

std::string mujoco_model(const Problem& problem, const MujocoSettings& settings) {
  const Scene& scene = problem.scene;
  const World world = make_world(scene, Method::pinch);
  const CableState& cable = world.cables[0];
  const double step = 1.0 / (scene.frames_per_second * settings.steps_per_frame);
  const Path path = path_of(world, cable);
  const int straight = straight_load(cable);
  std::string loads;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (!is_load(scene.cables[0], b)) continue;
    loads += load_xml(scene, b, static_cast<int>(b) == straight ? pulley_share(scene, cable) : 0.0);
  }
  return fmt::format(
      "<mujoco>\n<compiler angle='degree'/>\n"
      "<option timestep='{}' integrator='{}' solver='Newton' iterations='50' tolerance='1e-12' "
      "gravity='{}'><flag contact='disable' frictionloss='disable' limit='disable' "
      "passive='disable' "
      "actuation='disable'/></option>\n<size njmax='100' "
      "nconmax='1'/>\n<worldbody>\n{}{}</worldbody>\n"
      "<tendon><spatial name='cable'>{}</spatial></tendon>\n"
      "<equality><tendon tendon1='cable' solref='{} 1' solimp='0.9999 0.9999 0.001'/></equality>\n"
      "</mujoco>\n",
      step, settings.integrator, point(scene.gravity), path.world, loads, path.tendon,
      settings.time_constant_steps * step);
}

Recording run_mujoco(const Problem& problem, const MujocoSettings& settings) {
  const MujocoModel model = load_mujoco(mujoco_model(problem, settings));
  const MujocoData data(mj_makeData(model.get()), mj_deleteData);
  std::vector<int> first_slide(problem.scene.bodies.size(), -1);
  int next = 0;
  for (std::size_t b = 0; b < problem.scene.bodies.size(); ++b) {
    if (!is_load(problem.scene.cables[0], b)) continue;
    const Vec2& velocity = problem.scene.bodies[b].velocity;
    data->qvel[next] = velocity.x();
    data->qvel[next + 1] = velocity.y();
    first_slide[b] = next;
    next += 2;
  }
  const auto read = [&] { return places(problem, *data, first_slide); };
  return record_mujoco(problem, *model, *data, settings, read);
}

}  // namespace pinchlab::experiments
