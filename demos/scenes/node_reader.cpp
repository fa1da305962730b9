// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/node_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/at.h"
#include "sim/nodes.h"
#include "sim/scene_error.h"

namespace pinchlab {
namespace {

bool gets_nodes(const Cable& cable) {
  return becomes_nodes(cable) || becomes_strung(cable);
}

/// Whether they are few enough, however many are chosen where their number is open.
bool are_few(const std::vector<Cable>& cables, std::vector<SceneProblem>& problems) {
  constexpr int most_nodes = 10'000;
  int nodes = 0;
  for (std::size_t c = 0; c < cables.size(); ++c) {
    if (gets_nodes(cables[c])) nodes += cables[c].nodes > 0 ? cables[c].nodes : most_nodes_chosen;
    if (nodes <= most_nodes) continue;
    problems.push_back(
        {fmt::format("/cables/{}", c),
         fmt::format("cables with mass up to this one may have more than {} nodes; give them fewer "
                     "with nodes",
                     most_nodes)});
    return false;
  }
  return true;
}

// What a cable is made of has names of its own in tables.
void check_names(const NodedCable& made, const SceneContent& to, std::size_t cables,
                 const std::map<std::string, int>& body_names,
                 std::vector<SceneProblem>& problems) {
  const Scene& scene = to.scene;
  const auto problem = [&](const char* part, const std::string& name) {
    problems.push_back(
        {fmt::format("/cables/{}/name", made.cable),
         fmt::format("a {} of it is called \"{}\" in tables, as something else is; choose another "
                     "name",
                     part, name)});
  };
  for (int i = 0; i < made.bodies; ++i) {
    const std::string& name = at(scene.bodies, made.first_body + i).name;
    const auto other = body_names.find(name);
    if (other == body_names.end()) continue;
    if (at(scene.bodies, other->second).carrier >= 0) {  // a shape, which no key names
      problem("node", name);
      continue;
    }
    problems.push_back(
        {fmt::format("/bodies/{}/name", other->second),
         fmt::format("\"{}\" is the name of a node of a cable; choose another", name)});
  }
  for (int i = 0; i < made.pieces; ++i) {
    const std::string& name = at(scene.cables, made.first_piece + i).name;
    const auto others = scene.cables.begin() + static_cast<std::ptrdiff_t>(cables);
    if (std::any_of(scene.cables.begin(), others,
                    [&name](const Cable& other) { return other.name == name; })) {
      problem("piece", name);
    }
  }
}

}  // namespace

void read_nodes(SceneContent& to, const std::map<std::string, int>& body_names,
                std::vector<SceneProblem>& problems) {
  const std::vector<Cable> cables = to.scene.cables;
  if (!are_few(cables, problems)) return;
  for (std::size_t i = 0; i < to.look.bodies.size(); ++i) {
    to.look.bodies[i].mass = to.scene.bodies[i].mass;
  }
  try {
    for (const NodedCable& made : spread_nodes(to.scene)) {
      const Cable& cable = at(cables, made.cable);
      if (cable.nodes <= 0) to.chosen_nodes.push_back({cable.name, made.bodies});
      check_names(made, to, cables.size(), body_names, problems);
      for (int i = 0; i < made.bodies; ++i) {
        BodyLook look;
        look.label = "";
        look.marks = false;
        to.look.bodies.push_back(look);
      }
      to.look.cables.insert(to.look.cables.end(), index(made.pieces),
                            at(to.look.cables, made.cable));
    }
  } catch (const SceneError& error) {
    problems.push_back({error.place, error.message});
  }
}

}  // namespace pinchlab
