// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What README.md promises of every step, checked from outside while a world runs. A world that
// nobody watches pays nothing for it.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "sim/energy_watch.h"

namespace pinchlab {

/// Beyond these a promise is broken. All but `sweeps_strain` are the limits of the stability
/// experiments.
struct PromiseLimits {
  double strain = 1e-3;  ///< cable in the spans of an inextensible cable beyond its length, over it
  /// The same by sweeps, which leave stretch behind: twice what they do at most, at 1 step a frame
  /// and more, where they hold a cable (2.5 %, demos/more/13-car.json; 0.9 % between a load and
  /// another of a ten thousandth over 21 pulleys). Where they do not it is 13 % and more.
  double sweeps_strain = 5e-2;
  double squeeze = 1e-3;  ///< of the pinched cable's width, or of the smaller radius without cable
  double length = 1e-6;   ///< wraps and spans against the cable's length, over it
  double energy = 1e-2;   ///< gained since the start, of the energy at play: energy_watch.h
  double loss = 0.1;      ///< lost, likewise, since something last may have taken energy
  double sag = 0.125;     ///< that a span of a cable with mass would have, over its length
};

/// Of a line of Promises::broken on spans that are straight: what helps there, where steps do not.
inline constexpr std::string_view nodes_cure = "with nodes it does";

enum class Promise { strain, squeeze, length, energy, loss, straight, settled, count };

/// Watches one world from its start. What is promised depends on the configuration: `squeeze` needs
/// Method::pinch, and sweeps (Solver::iterative) promise nothing but the cables' lengths and that
/// spans are not much too long.
class Promises {
 public:
  /// `world` must be at its start. Both must be what note() is given later.
  Promises(const Scene& scene, const World& world);

  /// To be called after every step. Reads the world, and allocates nothing.
  void note(const Scene& scene, const World& world);

  /// One line a promise broken: which, by how much, when, where, and in how many steps.
  std::vector<std::string> broken(const Scene& scene, const World& world) const;

 private:
  /// The worst of one promise so far, of what exceeded its limit.
  struct Worst {
    double value = 0.0;             // over its limit's unit, see PromiseLimits
    std::int64_t step = 0;          // after which it was so
    std::int64_t first_step = 0;    // after which the limit was first exceeded
    std::int64_t steps_broken = 0;  // 0: the promise has held
    int item = -1, other = -1;      // cable; or bodies, `other` -1 - wall for an obstacle; of
                                    // energy, EnergyWatch::Change::item
  };

  void note_value(Promise promise, double value, double limit, std::int64_t step, int item,
                  int other);
  void note_cables(const Scene& scene, const World& world);
  void note_sag(const Scene& scene, const World& world);
  void note_contacts(const Scene& scene, const World& world);

  PromiseLimits limits_;
  double most_strain_ = 0.0;  // of limits_
  bool watches_gaps_ = false, watches_energy_ = false, watches_loss_ = false;
  std::array<Worst, static_cast<std::size_t>(Promise::count)> worst_;
  std::array<Worst, static_cast<std::size_t>(Promise::count)> now_;  // of the step being noted
  std::int64_t fallbacks_ = 0;

  EnergyWatch energy_;
};

}  // namespace pinchlab
