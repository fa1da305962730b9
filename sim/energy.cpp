// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/energy.h"

#include <algorithm>

#include "base/at.h"
#include "sim/cable/bending.h"
#include "sim/cable/cable.h"
#include "sim/cable/creep.h"
#include "sim/cable/mass.h"

namespace pinchlab {

double potential_energy_of_body(const Scene& scene, const World& world, int body) {
  const BodyProperties& of = at(world.bodies, body);
  return can_move(of) ? -of.mass * scene.gravity.dot(at(world.position, body)) : 0.0;
}

double potential_energy_of_cable(const Scene& scene, const World& world, int number) {
  double energy = 0.0;
  const double stiffness = at(scene.cables, number).axial_stiffness;
  const CableState& cable = at(world.cables, number);
  if (cable.bends_with >= 0) energy += bending_energy(world, cable);
  if (is_massed(cable)) energy += potential_energy(world, cable, scene.gravity);
  if (stiffness == infinity) return energy;
  for (std::size_t i = first_segment(cable); i < cable.segments.size(); ++i) {
    const Segment& segment = cable.segments[i];
    const double material = elastic_material(cable, segment);
    if (segment.pinched || material == 0.0) continue;
    double stretch = segment.length - segment.rest_length;
    if (!cable.rod) stretch = std::max(stretch, 0.0);
    energy += 0.5 * stiffness * stretch * stretch / material;
  }
  if (!cable.rims.empty()) energy += energy_carried(world, cable, stiffness);
  return energy;
}

/// Links may have come and gone since: one of the cable's on the same body stands for the sleeve,
/// or, where there is none any more, its motion before.
double kinetic_energy_of_sleeve(const World& world, const Instant& before, double length,
                                Sleeve sleeve) {
  const std::vector<Link>& links = at(world.cables, sleeve.cable).links;
  const auto is_it = [&sleeve](const Link& link) {
    return link.body == sleeve.body && link.orientation != 0 && !link.pinch_middle;
  };
  Eigen::Vector3d now = sleeve.velocity;
  if (index(sleeve.first) >= links.size() || !is_it(at(links, sleeve.first))) {
    sleeve.first =
        static_cast<int>(std::find_if(links.begin(), links.end(), is_it) - links.begin());
  }
  if (index(sleeve.first) < links.size()) now = velocity_of(world, sleeve);
  const double lag = before.lag[world.bodies.size() + index(sleeve.cable)];
  const double after = share_after(lag, length);
  const Eigen::Vector3d v = (1.0 - after) * sleeve.velocity + after * now;
  return 0.5 * v.dot(sleeve.mass * v);
}

}  // namespace pinchlab
