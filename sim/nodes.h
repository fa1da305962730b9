// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Cables with mass that hang: chains of nodes with massless pieces of cable between them. Those
// that run over bodies are in cable/mass.h.

#include <vector>

#include "sim/node_count.h"
#include "sim/scene.h"

namespace pinchlab {

/// What a cable with mass has become.
struct NodedCable {
  int cable = 0;                    // index in the scene before and after: its first piece
  int first_body = 0, bodies = 0;   // its nodes, in the scene after
  int first_piece = 0, pieces = 0;  // its other pieces, likewise
};

/// Whether spread_nodes makes a chain of it: a cable with mass that does not run over bodies.
inline bool becomes_nodes(const Cable& cable) {
  return cable.mass_per_metre > 0.0 && cable.wraps.empty();
}

/// Whether spread_nodes gives it nodes that are strung on it where it is free (cable/strung.h).
inline bool becomes_strung(const Cable& cable) {
  return cable.mass_per_metre > 0.0 && !cable.wraps.empty() && cable.nodes != 0 &&
         cable.first_node < 0;
}

/// Replaces every cable of the scene that has a mass, and runs over no bodies, by n nodes and n + 1
/// massless pieces of equal length l between them: node i has the mass (l_(i-1) + l_i) / 2 times
/// that of a metre, and those next to an end on a body that can move have the end's half piece too:
/// off its centre that would move the body's centre of mass. Nodes are discs as wide as the cable
/// that do not turn: they lie on walls and bodies, with friction, and pass through one another.
///
/// A cable with slack starts where its chain hangs at rest, exactly (without gravity as if it had
/// one); a taut one straight. Its nodes start with velocities between those of its ends, by their
/// share of its length, as on cables that run over bodies (velocity_between). How many nodes: as
/// many as it says, or so many that pieces are no shorter than twice the cable's width, a
/// two-hundredth of it, and what a wave runs in two steps under the tension that is to be expected
/// (node_count.h), beyond which nodes swing faster than steps can follow; and, with a bending
/// stiffness EI and the mass rho a metre, than sqrt(2 h sqrt(EI / rho)), beyond which their bending
/// does.
///
/// With a node tolerance their number adapts as it moves (motion/adapt_nodes.h): it starts with the
/// most, 2^k - 1 of them, and a body that holds an end has the end's half piece itself.
///
/// With a bending stiffness pieces bear force both ways, and bend against one another
/// (cable/bending.h).
///
/// Throws SceneError where a cable runs over bodies that are not in the scene, has no length,
/// cannot hang as it is straight between two points that stand, has more nodes than fit, or cannot
/// adapt their number.
std::vector<NodedCable> spread_nodes(Scene& scene);

}  // namespace pinchlab
