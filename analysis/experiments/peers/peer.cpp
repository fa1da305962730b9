// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/peer.h"

#ifdef PINCHLAB_BOX2D
#include <box2d/b2_common.h>

#include "analysis/experiments/peers/box2d_chain.h"
#endif
#ifdef PINCHLAB_MUJOCO
#include <mujoco/mujoco.h>

#include "analysis/experiments/peers/mujoco_tendon.h"
#endif

#include <fmt/format.h>

#include <algorithm>

#include "sim/outline.h"

namespace pinchlab::experiments {

namespace {

/// Why neither can take part, or nothing.
[[maybe_unused]] std::string cannot_by_shape(const Problem& problem) {
  const Scene& scene = problem.scene;
  const bool corners = std::any_of(scene.bodies.begin(), scene.bodies.end(),
                                   [](const Body& body) { return is_polygon(body); });
  if (corners) return "corners are not built";
  for (const Cable& cable : scene.cables) {
    if (cable.mass_per_metre > 0.0 || cable.rod) return "cables with mass are not built";
    if (cable.start.layers || cable.end.layers) return "layers are not built";
    if (cable.axial_stiffness < infinity) return "elastic cables are not built";
  }
  return "";
}

Peer box2d() {
  Peer peer;
  peer.name = "Box2D";
  peer.package = "libbox2d-dev";
  peer.model =
      "A chain of rigid links as thick as the cable, joined by revolute joints; pulleys turn by "
      "contact friction. Links have mass, which a cable has not; they feel no gravity here, which "
      "is kinder. Link length, the chain's mass as a share of the lightest load, iterations and "
      "steps are varied, all at ten of Box2D's metres a metre, so that its tolerance of "
      "5 mm is 0.5 mm. Single precision. Its pulley joint has neither radius nor inertia nor "
      "friction and is no cable.";
#ifdef PINCHLAB_BOX2D
  peer.version = fmt::format("{}.{}", b2_version.major, b2_version.minor);
  peer.cannot = [](const Problem& problem) {
    const std::string why = cannot_by_shape(problem);
    return why.empty() ? box2d_cannot(problem) : why;
  };
  peer.settings = [](const Problem&, bool quick) {
    std::vector<PeerSetting> settings;
    const std::vector<double> links = quick ? std::vector{0.2} : std::vector{0.2, 0.1};
    const std::vector<double> masses =
        quick ? std::vector{0.1, 0.01} : std::vector{1.0, 0.1, 0.01, 0.001};
    for (const double link : links) {
      for (const double mass : masses) {
        for (const auto& [velocity, position] : {std::pair(8, 3), std::pair(50, 20)}) {
          Box2dSettings s;
          s.link_m = link;
          s.mass_share = mass;
          s.velocity_iterations = velocity;
          s.position_iterations = position;
          s.scale = 10.0;
          settings.push_back({fmt::format("links {} m; mass {}; {} + {} iterations", link, mass,
                                          velocity, position),
                              [s](const Problem& problem, int steps_per_frame) {
                                Box2dSettings now = s;
                                now.steps_per_frame = steps_per_frame;
                                return run_box2d(problem, now);
                              }});
        }
      }
    }
    return settings;
  };
#endif
  return peer;
}

Peer mujoco() {
  Peer peer;
  peer.name = "MuJoCo";
  peer.package = "libmujoco-dev";
  peer.model =
      "A spatial tendon over cylinders that stand still, held at its length by an equality "
      "constraint as stiff as MuJoCo allows (time constant of two steps, impedance 0.9999); the "
      "inertia of no-slip pulleys is armature on a load that hangs straight, its fastest exact "
      "form. A tendon is without width and without friction over geoms: it is not pinched, does "
      "not turn pulleys, does not slip by the capstan law, and bodies do not feel it. Its "
      "semi-implicit Euler is run both as it is and started half a step back, which makes it a "
      "leapfrog of second order, and against RK4.";
#ifdef PINCHLAB_MUJOCO
  peer.version = mj_versionString();
  peer.cannot = [](const Problem& problem) {
    const std::string why = cannot_by_shape(problem);
    return why.empty() ? mujoco_cannot(problem) : why;
  };
  peer.settings = [](const Problem&, bool) {
    std::vector<PeerSetting> settings;
    const auto add = [&](const std::string& text, const std::string& integrator, bool leapfrog) {
      MujocoSettings s;
      s.integrator = integrator;
      s.leapfrog = leapfrog;
      settings.push_back({text, [s](const Problem& problem, int steps_per_frame) {
                            MujocoSettings now = s;
                            now.steps_per_frame = steps_per_frame;
                            return run_mujoco(problem, now);
                          }});
    };
    add("Euler", "Euler", false);
    add("Euler, started half a step back", "Euler", true);
    add("RK4", "RK4", false);
    return settings;
  };
#endif
  return peer;
}

}  // namespace

std::vector<Peer> peers() {
  return {box2d(), mujoco()};
}

}  // namespace pinchlab::experiments
