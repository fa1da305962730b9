// SPDX-License-Identifier: GPL-3.0-or-later
// The mirror image of a scene moves as the mirror image of its motion, to the last bit.

#include "sim/mirror.h"

#include <functional>
#include <string>

#include "demos/scenes/scene_json.h"
#include "tests/sim/random_hanging.h"
#include "tests/sim/random_on_pieces.h"
#include "tests/sim/random_scene.h"
#include "tests/sim/same_state.h"

namespace pinchlab::testing {
namespace {

Vec2 mirror(const Vec2& v) {
  return {-v.x(), v.y()};
}

/// The angle of a cable that goes round nothing counts turns for nobody.
void forget_idle_angles(World& world) {
  for (CableState& cable : world.cables) {
    if (cable.links.size() != 2 || cable.closed) continue;
    cable.segments[1].alpha = cable.segments[1].alpha_before = 0.0;
  }
}

void mirror(CableState& cable) {
  cable.turning = -cable.turning;
  cable.turned = -cable.turned;
  cable.held.y() = -cable.held.y();
  for (Rim& rim : cable.rims) {
    for (Laid& laid : rim.laid) laid.moment = mirror(laid.moment);
  }
  for (Link& link : cable.links) {
    link.orientation = -link.orientation;
    link.offset = mirror(link.offset);
    link.slid = -link.slid;
    link.held = -link.held;
  }
  for (Segment& s : cable.segments) {
    s.alpha = -s.alpha;
    s.alpha_before = -s.alpha_before;
    for (Vec2* v : {&s.direction, &s.tail, &s.head, &s.previous_tail, &s.previous_head,
                    &s.tail_centre, &s.head_centre}) {
      *v = mirror(*v);
    }
  }
}

/// A polygon's corners come in the opposite order.
void mirror_point(const World& world, Contact& contact) {
  if (contact.touch != Touch::piece || contact.b < 0) return;
  const BodyProperties& a = at(world.bodies, contact.a);
  const auto count = (a.node ? at(world.bodies, contact.b) : a).corners.size();
  if (count > 0)
    contact.point = static_cast<std::int8_t>(static_cast<int>(count) - 1 - contact.point);
}

/// A contact's tangent is to the left of its normal: sliding forward is sliding backward in a
/// mirror.
void mirror(Contact& contact) {
  contact.normal = mirror(contact.normal);
  contact.slip = static_cast<Slip>(-static_cast<int>(contact.slip));
  contact.tangent_force = -contact.tangent_force;
}

bool is_image(World world, World other) {
  for (Vec2& x : world.position) x = mirror(x);
  for (Vec2& v : world.velocity) v = mirror(v);
  for (double& angle : world.angle) angle = -angle;
  for (double& omega : world.angular_velocity) omega = -omega;
  for (BodyProperties& body : world.bodies) {
    double& across = body.node ? body.seat.y() : body.seat.x();  // in a piece's frame, or a body's
    across = -across;
  }
  for (CableState& cable : world.cables) mirror(cable);
  for (Contact& contact : world.contacts) {
    mirror(contact);
    mirror_point(world, contact);
  }
  forget_idle_angles(world);
  forget_idle_angles(other);
  return same_state(world, other);
}

/// The first of so many steps after which scene and image are no images of each other (0: before
/// any), or -1.
int first_parted(const Scene& scene, const Configuration& configuration, int steps) {
  const Scene image = mirrored(scene);
  World world = make_world(scene, configuration), other = make_world(image, configuration);
  Workspace work, other_work;
  if (!is_image(world, other)) return 0;
  for (int i = 1; i <= steps; ++i) {
    const StepStatus status = step(scene, world, work);
    if (step(image, other, other_work) != status || !is_image(world, other)) return i;
    if (status != StepStatus::ok) break;
  }
  return -1;
}

struct Population {
  std::string name;
  std::function<Scene(int)> scene;
  int count;
};

class Mirror : public ::testing::TestWithParam<Population> {};

TEST_P(Mirror, ImageMovesAsTheImageToTheLastBit) {
  for (int seed = 0; seed < seeds_of(GetParam().count); ++seed) {
    Scene scene = GetParam().scene(seed);
    for (const int steps : {1, 4, 16}) {
      scene.steps_per_frame = steps;
      EXPECT_EQ(first_parted(scene, Method::pinch, 60 * steps), -1) << seed << " at " << steps;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(
    , Mirror,
    ::testing::Values(
        Population{"Discs", random_scene, 200}, Population{"Elastic", random_elastic, 60},
        Population{"HeavyElastic", heavy_elastic, 60},
        Population{"SlippingElastic", slipping_elastic, 60}, Population{"Linkages", linkage, 60},
        Population{"Ropes", falling_on_rope, 60}, Population{"SlippingRopes", slipping_rope, 60},
        Population{"RopesInLayers", braked_rope, 60}, Population{"StrungRopes", strung_rope, 30},
        Population{"StrungRopesInLayers",
                   [](int seed) { return strung_braked_rope(static_cast<unsigned>(seed), true); },
                   20},
        Population{"Adapting", random_hanging, 20},
        Population{"OnPieces", [](int seed) { return random_on_pieces(seed, false); }, 40}),
    [](const auto& of) { return of.param.name; });

TEST(MirrorMethods, ImageMovesAsTheImageByEveryMethod) {
  Configuration at_steps;
  at_steps.events = Events::at_steps;
  for (const Configuration& configuration :
       {Configuration(Method::pinch_no_contact), Configuration(Method::cable), at_steps,
        thesis_configuration()}) {
    for (int seed = 0; seed < seeds_of(30); ++seed) {
      EXPECT_EQ(first_parted(random_scene(seed), configuration, 240), -1)
          << to_string(configuration) << ' ' << seed;
    }
  }
}

TEST(MirrorDemonstrations, ImageMovesAsTheImage) {
  for (const char* name :
       {"01-roll-over", "02-stack", "03-drop", "04-two-blocking", "05-notch", "06-windlass",
        "07-driven-roller", "08-driven-roller-weights", "more/10-drum", "more/11-chain",
        "more/12-linkage", "more/13-car", "more/14-heavy-rope", "more/15-rope-way"}) {
    const Scene scene =
        read_scene_file(PINCHLAB_SOURCE_DIR "/demos/" + std::string(name) + ".json").scene;
    EXPECT_EQ(first_parted(scene, Method::pinch, scene.frame_count * scene.steps_per_frame), -1)
        << name;
  }
}

}  // namespace
}  // namespace pinchlab::testing
