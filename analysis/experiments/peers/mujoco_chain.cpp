// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/mujoco_chain.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/at.h"

namespace pinchlab::experiments {

namespace {

/// The nodes in order, from a fixed end on.
struct Chain {
  Vec2 start = Vec2::Zero();
  std::vector<int> nodes;
  bool ends_fixed = false;  // and then
  Vec2 end = Vec2::Zero();  // m: where
};

/// Of rods that begin one where the other ends; fewer nodes than bodies where they do not.
Chain chain_of(const Scene& scene) {
  Chain chain;
  std::vector<const Attachment*> after(scene.bodies.size(), nullptr);
  const Attachment* next = nullptr;
  for (const Cable& cable : scene.cables) {
    if (cable.start.body >= 0) {
      at(after, cable.start.body) = &cable.end;
    } else {
      chain.start = cable.start.point;
      next = &cable.end;
    }
  }
  while (next != nullptr && next->body >= 0 && chain.nodes.size() < scene.bodies.size()) {
    chain.nodes.push_back(next->body);
    next = at(after, next->body);
  }
  chain.ends_fixed = next != nullptr;
  if (chain.ends_fixed) chain.end = next->point;
  return chain;
}

std::string point(const Vec2& p) {
  return fmt::format("{} 0 {}", p.x(), p.y());
}

}  // namespace

std::string mujoco_chain_cannot(const Problem& problem) {
  const Scene& scene = problem.scene;
  if (chain_of(scene).nodes.size() != scene.bodies.size())
    return "one chain from a fixed end is built";
  const bool moves = std::any_of(scene.bodies.begin(), scene.bodies.end(), [](const Body& body) {
    return body.velocity.norm() > 0.0 || body.linear_drag > 0.0;
  });
  return moves ? "chains are built at rest, without drag" : "";
}

std::string mujoco_chain_model(const Problem& problem, const MujocoSettings& settings) {
  const Scene& scene = problem.scene;
  const Chain chain = chain_of(scene);
  const double step = 1.0 / (scene.frames_per_second * settings.steps_per_frame);
  std::string links, ends, equality;
  Vec2 from = chain.start, place = chain.start;  // the node before, relative to the link before
  for (const int node : chain.nodes) {
    const Body& body = at(scene.bodies, node);
    const Vec2 along = body.position - from;
    const double inertia = 1e-9 * body.mass * along.squaredNorm();  // MuJoCo asks for some
    links += fmt::format(
        "<body name='node{0}' pos='{1}'><joint type='hinge' axis='0 1 0'/><inertial pos='{2}' "
        "mass='{3}' "
        "diaginertia='{4} {4} {4}'/><site name='end{0}' pos='{2}'/>\n",
        node, point(place), point(along), body.mass, inertia);
    ends += "</body>";
    from = body.position;
    place = along;
  }
  if (chain.ends_fixed) {
    equality = fmt::format(
        "<equality><tendon tendon1='last' solref='{} 1' solimp='0.9999 0.9999 "
        "0.001'/></equality>\n",
        settings.time_constant_steps * step);
  }
  const std::string last = chain.ends_fixed
                               ? fmt::format(
                                     "<tendon><spatial name='last'><site site='end{}'/><site "
                                     "site='support'/></spatial></tendon>\n",
                                     chain.nodes.back())
                               : "";
  return fmt::format(
      "<mujoco>\n<option timestep='{}' integrator='{}' solver='Newton' iterations='50' "
      "tolerance='1e-12' gravity='{}'><flag contact='disable' frictionloss='disable' "
      "limit='disable' passive='disable' actuation='disable'/></option>\n<size njmax='100' "
      "nconmax='1'/>\n<worldbody>\n<site name='support' "
      "pos='{}'/>{}{}</worldbody>\n{}{}</mujoco>\n",
      step, settings.integrator, point(scene.gravity), point(chain.end), links, ends, last,
      equality);
}

Recording run_mujoco_chain(const Problem& problem, const MujocoSettings& settings) {
  const MujocoModel model = load_mujoco(mujoco_chain_model(problem, settings));
  const MujocoData data(mj_makeData(model.get()), mj_deleteData);
  std::vector<int> sites;
  for (const std::size_t b : problem.watched) {
    sites.push_back(mj_name2id(model.get(), mjOBJ_SITE, fmt::format("end{}", b).c_str()));
  }
  const auto read = [&] {
    mj_kinematics(model.get(), data.get());
    std::vector<Place> places;
    for (const int site : sites) {
      const mjtNum* x = data->site_xpos + 3 * static_cast<std::ptrdiff_t>(site);
      places.push_back({Vec2(x[0], x[2]), 0.0});
    }
    return places;
  };
  return record_mujoco(problem, *model, *data, settings, read);
}

}  // namespace pinchlab::experiments
