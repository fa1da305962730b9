// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/peer.h"

#ifdef PINCHLAB_BOX2D
#include <box2d/b2_common.h>

#include "analysis/experiments/peers/box2d_chain.h"
#endif
#ifdef PINCHLAB_MUJOCO
#include <mujoco/mujoco.h>

#include "analysis/experiments/peers/mujoco_chain.h"
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
  for (const Cable& cable : scene.cables) {
    if (cable.start.layers || cable.end.layers) return "layers are not built";
    if (cable.slack != 0.0 && cable.mass_per_metre == 0.0) return "slack cables are not built";
    if (cable.axial_stiffness < infinity) return "elastic cables are not built";
    if (cable.bends_with >= 0) return "bending is not built";
    if (cable.rod && !is_chain(problem)) return "chains that hold bodies are not built";
  }
  return "";
}

[[maybe_unused]] bool has_mass(const Problem& problem) {
  const std::vector<Cable>& cables = problem.scene.cables;
  return std::any_of(cables.begin(), cables.end(),
                     [](const Cable& cable) { return cable.mass_per_metre > 0.0; });
}

/// Whether links of 0.1 m are too long for something that cables run round.
[[maybe_unused]] bool has_thin_peg(const Problem& problem) {
  const std::vector<Body>& bodies = problem.scene.bodies;
  return std::any_of(bodies.begin(), bodies.end(), [](const Body& body) {
    return !can_move(body) && body.corners.empty() && body.radius < 0.05;
  });
}

#ifdef PINCHLAB_BOX2D
PeerSetting box2d_setting(const std::string& text, const Box2dSettings& settings) {
  return {text, [settings](const Problem& problem, int steps_per_frame) {
            Box2dSettings now = settings;
            now.steps_per_frame = steps_per_frame;
            return run_box2d(problem, now);
          }};
}

/// What of them matters to the problem.
std::vector<PeerSetting> box2d_settings(const Problem& problem, bool quick) {
  std::vector<PeerSetting> settings;
  Box2dSettings s;
  s.scale = 10.0;
  for (const auto& [velocity, position] :
       {std::pair(8, 3), std::pair(50, 20), std::pair(400, 100)}) {
    s.velocity_iterations = velocity;
    s.position_iterations = position;
    const std::string iterations = fmt::format("{} + {} iterations", velocity, position);
    if (is_chain(problem)) {
      settings.push_back(box2d_setting(iterations, s));
      continue;
    }
    if (velocity > 50) continue;
    if (problem.scene.cables.empty()) {
      for (const bool continuous : {false, true}) {
        s.continuous = continuous;
        settings.push_back(box2d_setting(iterations + (continuous ? "; times of impact" : ""), s));
      }
      continue;
    }
    std::vector<double> links = quick ? std::vector{0.2} : std::vector{0.2, 0.1};
    if (has_thin_peg(problem)) links = {0.05};
    for (const double link : links) {
      s.link_m = link;
      if (has_mass(problem)) {
        settings.push_back(box2d_setting(fmt::format("links {} m; {}", link, iterations), s));
        continue;
      }
      const std::vector<double> masses =
          quick ? std::vector{0.1, 0.01} : std::vector{1.0, 0.1, 0.01, 0.001};
      for (const double mass : masses) {
        s.mass_share = mass;
        settings.push_back(
            box2d_setting(fmt::format("links {} m; mass {}; {}", link, mass, iterations), s));
      }
    }
  }
  return settings;
}
#endif

Peer box2d() {
  Peer peer;
  peer.name = "Box2D";
  peer.package = "libbox2d-dev";
  peer.model =
      "A chain of rigid links as thick as the cable, joined by revolute joints; pulleys turn by "
      "contact friction. Links have mass, which a cable has not; they feel no gravity then, which "
      "is kinder. Link length, the chain's mass as a share of the lightest load, iterations and "
      "steps are varied. A cable with mass has that of its links over bodies, and is nodes joined "
      "by distance "
      "joints where it hangs. Walls are edges, met with and without Box2D's times of impact. All "
      "at "
      "ten of Box2D's metres a metre, so that its tolerance of "
      "5 mm is 0.5 mm. Single precision. Its pulley joint has neither radius nor inertia nor "
      "friction and is no cable.";
#ifdef PINCHLAB_BOX2D
  peer.version = fmt::format("{}.{}", b2_version.major, b2_version.minor);
  peer.cannot = [](const Problem& problem) {
    const std::string why = cannot_by_shape(problem);
    return why.empty() ? box2d_cannot(problem) : why;
  };
  peer.settings = box2d_settings;
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
      "leapfrog of second order, and against RK4. A cable that hangs is a chain of "
      "hinged links without width, MuJoCo's own coordinates, in which no length can be wrong.";
#ifdef PINCHLAB_MUJOCO
  peer.version = mj_versionString();
  peer.cannot = [](const Problem& problem) {
    std::string why = cannot_by_shape(problem);
    if (!why.empty()) return why;
    if (has_mass(problem)) return std::string("a tendon has no mass");
    const std::vector<Body>& bodies = problem.scene.bodies;
    if (std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return is_polygon(b); })) {
      return std::string("a tendon runs over spheres and cylinders, not over corners");
    }
    return is_chain(problem) ? mujoco_chain_cannot(problem) : mujoco_cannot(problem);
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
                            return is_chain(problem) ? run_mujoco_chain(problem, now)
                                                     : run_mujoco(problem, now);
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

bool is_chain(const Problem& problem) {
  const Scene& scene = problem.scene;
  return std::all_of(scene.bodies.begin(), scene.bodies.end(),
                     [](const Body& body) { return body.node; }) &&
         std::all_of(scene.cables.begin(), scene.cables.end(),
                     [](const Cable& cable) { return cable.rod; });
}

std::vector<Peer> peers() {
  return {box2d(), mujoco()};
}

}  // namespace pinchlab::experiments
