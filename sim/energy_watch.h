// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Energy that comes from nowhere, watched from outside. What acts on one another exchanges energy,
// so that it can be told only of groups: of bodies and cables that have been in one part (parts.h)
// since the start, or have touched meanwhile. Groups only grow. Where two become one their
// energies, what they had at the start and what was at play are added, so that what one has gained
// before is not forgotten, and of what acts on nothing of a group nothing depends.
//
// Energy that goes nowhere is watched likewise, since something last may have taken some: a blow, a
// catch or another event, friction where something slides, drag, a damped spring, cable with mass.

#include <cstdint>
#include <vector>

#include "sim/diagnostics.h"
#include "sim/parts.h"
#include "sim/trees.h"

namespace pinchlab {

class EnergyWatch {
 public:
  /// What a group has gained since the start, or lost since something last may have taken energy.
  struct Change {
    double share = 0.0;  // of the energy at play
    int item = -1;       // a body of it, or, counted on after all bodies, a cable
  };
  /// The greatest of any group.
  struct Changes {
    Change gained, lost;
  };

  /// Of a world at its start.
  void start(const Scene& scene, const World& world);

  /// To be called after every step, of groups that nothing drives. Allocates nothing, but where
  /// parts change.
  Changes note(const Scene& scene, const World& world);

 private:
  /// What groups add up as they become one. Energies in J.
  struct Group {
    double start = 0.0;       // kinetic and potential, at the start
    double at_play = 0.0;     // the most kinetic energy so far, or what lifts each body by its
                              // radius, whichever is more
    double kinetic = 0.0;     // at the last step's end, by the velocities of then
    double potential = 0.0;   // then
    double mass = 0.0;        // kg
    double extent = 0.0;      // m, coordinates and cable lengths at most
    double kept = -infinity;  // kinetic and potential, since something last may have taken some of
                              // it; -infinity: not known
    bool driven = false;
    bool drained = false;  // something may always take energy
  };
  /// Of the step being noted.
  struct Sums {
    double kinetic = 0.0, kinetic_after = 0.0;  // at its start, see note; at its end
    double potential = 0.0;                     // at its end
    bool whole = true;                          // it was not divided
    bool taken = false;                         // something may have taken energy
  };

  struct Range {
    double least = 0.0, most = 0.0;  // J
  };

  int root_of(int item) { return find_root(root_, item); }
  int cable_item(const World& world, int cable) const {
    return static_cast<int>(world.bodies.size()) + cable;
  }
  void describe_items(const Scene& scene, const World& world);
  void unite(int item, int other);
  void unite_parts(const World& world);
  void unite_at_cable(const World& world, int cable);
  void unite_all(const World& world);
  void add_kinetic(const World& world, double Sums::*sum);
  void add_potential(const Scene& scene, const World& world);
  void find_what_takes(const World& world);
  static Range energy_at_start(const Group& group, const Sums& sums);
  void note_change(int group, double energy, Change& worst) const;
  int representative(const World& world, int group);

  std::vector<int> root_;      // of each body's tree, then of each cable's
  std::vector<Group> groups_;  // at these roots
  std::vector<Sums> sums_;     // likewise
  std::vector<int> changes_;   // CableState::changes when the last step was noted
  std::vector<int> first_;     // item of each part, while parts are united
  Parts parts_, parts_before_;
  Instant before_;                              // of the last step's end
  std::int64_t events_ = 0, node_changes_ = 0;  // of Diagnostics, by then
  bool links_changed_ = false;                  // in the step being noted; by unite_all
};

}  // namespace pinchlab
