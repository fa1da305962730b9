// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/node_reader.h"

#include <fmt/format.h>

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

}  // namespace

void read_nodes(SceneContent& to, const std::map<std::string, int>& body_names,
                std::vector<SceneProblem>& problems) {
  const std::vector<Cable> cables = to.scene.cables;
  if (!are_few(cables, problems)) return;
  try {
    for (const NodedCable& made : spread_nodes(to.scene)) {
      const Cable& cable = at(cables, made.cable);
      if (cable.nodes <= 0) to.chosen_nodes.push_back({cable.name, made.bodies});
      for (int i = 0; i < made.bodies; ++i) {
        const std::string& name = at(to.scene.bodies, made.first_body + i).name;
        if (body_names.contains(name)) {
          problems.push_back(
              {fmt::format("/bodies/{}/name", body_names.at(name)),
               fmt::format("\"{}\" is the name of a node of a cable; choose another", name)});
        }
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
