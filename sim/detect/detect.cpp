// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/detect/detect.h"

#include "sim/cable/cable.h"
#include "sim/cable/links.h"
#include "sim/detect/all_pairs.h"
#include "sim/detect/contacts.h"
#include "sim/detect/pinch.h"
#include "sim/detect/span_hits.h"
#include "sim/workspace.h"

namespace pinchlab {

namespace {

/// Whether the pairs of an interval are those of what moves in it.
bool are_of_movers(const World& world, const Workspace& work) {
  return work.neighbourhoods.divided && world.configuration.detection == Detection::sweep;
}

}  // namespace

void find_pairs(const Scene& scene, const World& world, Workspace& work) {
  const bool sweep = world.configuration.detection == Detection::sweep;
  (sweep ? find_body_pairs : find_all_body_pairs)(scene, world, work);
  (sweep ? find_span_pairs : find_all_span_pairs)(world, work);
}

const std::vector<SpanPair>& pairs_of_interval(const World& world, const Workspace& work) {
  const BroadPhase& broad = work.broad_phase;
  return are_of_movers(world, work) ? broad.moving_pairs : broad.span_pairs;
}

const std::vector<SpanPair>& find_pairs_of_interval(const Scene& scene, const World& world,
                                                    Workspace& work) {
  if (are_of_movers(world, work)) {
    find_moving_pairs(scene, world, work);
  } else {
    find_pairs(scene, world, work);
  }
  return pairs_of_interval(world, work);
}

void detect(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  update_segments(world, work);
  watch.lap(Stage::update_segments);
  find_what_may_meet(scene, world, work, false, times);
  find_what_meets(scene, world, work, times);
}

void find_what_may_meet(const Scene& scene, World& world, Workspace& work, bool pairs_stand,
                        StageTimes* times) {
  Stopwatch watch(times);
  const bool removed = remove_links(world, work);
  watch.lap(Stage::remove_links);
  if (removed || !pairs_stand || work.broad_phase.patched) find_pairs(scene, world, work);
  watch.lap(Stage::broad_phase);
}

void find_what_meets(const Scene& scene, World& world, Workspace& work, StageTimes* times) {
  Stopwatch watch(times);
  add_hit_links(world, work);
  watch.lap(Stage::intersect_segments);
  find_contacts(scene, world, work);
  watch.lap(Stage::find_contacts);
  configure_pinches(world, work);
  find_parts(world, work);
  assign_contacts(world, work);
  watch.lap(Stage::configure_pinches);
}

}  // namespace pinchlab
