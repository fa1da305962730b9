// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/picture/compose.h"
#include "render/picture/frame_marks.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "render/picture/cable_path.h"
#include "sim/cable/cable.h"
#include "sim/cable/links.h"
#include "sim/joints.h"
#include "sim/nodes.h"
#include "sim/step.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using testing::atwood;
using testing::body;
using testing::hung;

constexpr double fine = 1e-4;  // m, the smallest sag that is drawn

std::vector<StripPoint> path_of(const Scene& scene, const World& world,
                                double smallest_sag = fine) {
  std::vector<StripPoint> points;
  append_cable_path(scene, world, world.cables[0], smallest_sag, points);
  return points;
}

/// Length of the strip's arcs and lines, m.
double length_of(const std::vector<StripPoint>& points) {
  double sum = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double chord = (points[i].position - points[i - 1].position).norm();
    const double turn =
        std::acos(std::clamp(points[i].tangent.dot(points[i - 1].tangent), -1.0, 1.0));
    sum += turn < 1e-6 ? chord : chord * 0.5 * turn / std::sin(0.5 * turn);
  }
  return sum;
}

/// Where on the drawn path material `m` lies; the path's end if beyond.
Vec2 place_of(const std::vector<StripPoint>& points, double m) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const StripPoint &from = points[i - 1], &to = points[i];
    if (to.material < m) continue;
    const double span = to.material - from.material;
    const double share = span > 0.0 ? (m - from.material) / span : 0.0;
    const Vec2 chord = to.position - from.position;
    const double turn =
        std::atan2(from.tangent.x() * to.tangent.y() - from.tangent.y() * to.tangent.x(),
                   from.tangent.dot(to.tangent));
    if (std::abs(turn) < 1e-9 || chord.norm() == 0.0) return from.position + share * chord;
    // Along the arc: it leaves half the turn before its chord.
    const double radius = chord.norm() / (2.0 * std::sin(0.5 * turn));
    const double start = std::atan2(chord.y(), chord.x()) - 0.5 * turn, a = start + share * turn;
    return from.position +
           radius * Vec2(std::sin(a) - std::sin(start), std::cos(start) - std::cos(a));
  }
  return points.back().position;
}

void expect_smooth(const std::vector<StripPoint>& points) {
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double turn =
        std::acos(std::clamp(points[i].tangent.dot(points[i - 1].tangent), -1.0, 1.0));
    EXPECT_LE(turn, 1.02 * most_turn) << i;
    EXPECT_GE(points[i].material, points[i - 1].material - 1e-9) << i;
    EXPECT_TRUE(points[i].position.allFinite() && points[i].tangent.allFinite());
    EXPECT_NEAR(points[i].tangent.norm(), 1.0, 1e-9);
  }
}

TEST(CablePath, FollowsTheCableAndItsMaterial) {
  const Scene scene = atwood();
  const World world = make_world(scene, Method::pinch);
  const auto points = path_of(scene, world);
  expect_smooth(points);
  EXPECT_NEAR((points.front().position - Vec2(-0.55, -1.5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((points.back().position - Vec2(0.55, -1.0)).norm(), 0.0, 1e-12);
  // 1.5 m up, half a turn of radius 0.55, 1 m down.
  const double expected = 1.5 + 0.55 * std::numbers::pi + 1.0;
  EXPECT_NEAR(length_of(points), expected, 1e-9);
  EXPECT_NEAR(points.back().material - points.front().material, expected, 1e-9);
  for (const StripPoint& p : points) {
    if (p.position.y() > 1e-9) {
      EXPECT_NEAR(p.position.norm(), 0.55, 1e-12);
    }
  }
}

TEST(CablePath, MaterialTurnsWithABodyThatDoesNotSlip) {
  const Scene scene = atwood();
  World world = make_world(scene, Method::pinch);
  Workspace work;
  const double top = 1.5 + 0.55 * 0.5 * std::numbers::pi;  // m of material at the top of the pulley
  ASSERT_NEAR((place_of(path_of(scene, world), top) - Vec2(0.0, 0.55)).norm(), 0.0, 1e-9);
  const auto angle_at = [&](double m) {
    const Vec2 p = place_of(path_of(scene, world), m);
    return std::atan2(p.y(), p.x());
  };
  const double before = angle_at(top);
  world.angle[0] -= 0.3;
  world.position[1].y() += 0.3 * 0.55;
  world.position[2].y() -= 0.3 * 0.55;
  update_segments(world, work);
  EXPECT_NEAR(angle_at(top), before - 0.3, 1e-9);
}

TEST(CablePath, SlippingMovesTheMarksAndNotThePulley) {
  const Scene scene = atwood();
  World world = make_world(scene, Method::pinch);
  Workspace work;
  const auto before = path_of(scene, world);
  for (std::size_t i : {std::size_t{1}})
    world.cables[0].links[i].material += 0.1;  // 0.1 m to the left
  world.position[1].y() -= 0.1;
  world.position[2].y() += 0.1;
  update_segments(world, work);
  const auto after = path_of(scene, world);
  // The material that was at m on the wrap is now where m - 0.1 was.
  const Vec2 now = place_of(after, 2.3), then = place_of(before, 2.2);
  EXPECT_NEAR((now - then).norm(), 0.0, 1e-9);
}

TEST(CablePath, SlackSpansHangWithTheirRestLength) {
  for (const double slack : {0.0, 1e-7, 1e-3, 0.2, 1.0}) {
    const Scene scene = hung(slack);
    const World world = make_world(scene, Method::pinch);
    const auto points = path_of(scene, world);
    expect_smooth(points);
    const double material = points.back().material - points.front().material;
    EXPECT_NEAR(material, world.cables[0].length, 1e-9);
    // Arcs through a catenary's points and tangents measure a little less than it.
    EXPECT_NEAR(length_of(points), world.cables[0].length, 2e-7 + 1e-3 * slack) << slack;
    if (slack == 0.2) {
      double lowest = 0.0;
      for (const StripPoint& p : points) lowest = std::min(lowest, p.position.y());
      EXPECT_LT(lowest, -0.25) << "below both anchors";
    }
  }
}

TEST(CablePath, HangingIsContinuousWhereASpanGoesSlack) {
  const Scene scene = hung(0.0);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  auto last = path_of(scene, world);
  for (int k = 0; k < 400; ++k) {
    world.cables[0].links[2].material += 1e-6 * k;  // slack of the second span grows from nothing
    update_segments(world, work);
    const auto now = path_of(scene, world);
    for (double m = 0.0; m < 4.0; m += 0.05) {
      EXPECT_LT((place_of(now, m) - place_of(last, m)).norm(), 2e-3) << k << " " << m;
    }
    last = now;
  }
}

TEST(CablePath, ALinkWithoutWrapChangesNothing) {
  // A body that has just touched a free span: a link with no wrap.
  Scene scene;
  scene.bodies = {body("roller", BodyKind::free, {0.3, 0.25}, 0.2)};
  Cable cable;
  cable.name = "rope";
  cable.start.point = {-1.0, 0.0};
  cable.end.point = {1.0, 0.0};
  scene.cables = {cable};
  scene.view = {{-1.0, -1.0}, {1.0, 1.0}};
  World world = make_world(scene, Method::pinch);
  Workspace work;
  const auto before = path_of(scene, world);
  if (world.cables[0].links.size() == 2) insert_link(world, world.cables[0], 1, 0, -1, 1);
  ASSERT_EQ(world.cables[0].links.size(), 3u);
  update_segments(world, work);
  const auto after = path_of(scene, world);
  expect_smooth(after);
  for (double m = 0.0; m <= 2.0; m += 0.1) {
    EXPECT_NEAR((place_of(after, m) - place_of(before, m)).norm(), 0.0, 1e-9) << m;
  }
}

/// A small roller pressed on a wrapped pulley.
Scene pinching() {
  Scene scene = atwood();
  scene.bodies.push_back(body("roller", BodyKind::rail, {0.0, 0.8 + 1e-9}, 0.2));
  return scene;
}

TEST(CablePath, APinchOnAWrapIsDrawnOnce) {
  const Scene scene = pinching();
  World world = make_world(scene, Method::pinch);
  Workspace work;
  for (int k = 0; k < 40 && world.cables[0].links.size() == 3; ++k)
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  ASSERT_EQ(world.cables[0].links.size(), 5u) << "the roller pinches the wrap";
  ASSERT_TRUE(world.cables[0].links[2].pinch_middle);
  const auto points = path_of(scene, world);
  expect_smooth(points);
  for (const StripPoint& p : points) {
    EXPECT_GT((p.position - world.position[0]).norm(), 0.55 - 1e-9);
    if (p.position.y() > 0.01) {
      EXPECT_NEAR(p.position.norm(), 0.55, 1e-6) << "on the pulley, never round the roller";
    }
  }
  EXPECT_NEAR(length_of(points), world.cables[0].length, 1e-6);
}

TEST(CablePath, OfSeveralTurnsTheLastOneShowsUnderAPinchToo) {
  Scene scene = pinching();
  scene.cables[0].wraps[0].extra_turns = 2;
  World world = make_world(scene, Method::pinch);
  const auto shown = [&](const World& now) {
    std::vector<StripPoint> points;
    const auto begins = append_cable_path(scene, now, now.cables[0], fine, points);
    EXPECT_EQ(begins.size(), 2u) << "the span that is wound on, and what shows of the rest";
    const auto cut = points.begin() + static_cast<std::ptrdiff_t>(begins.back());
    return length_of({points.begin(), cut}) + length_of({cut, points.end()});
  };
  const double before = shown(world);
  EXPECT_NEAR(before, world.cables[0].length - 1.5 * 2.0 * std::numbers::pi * 0.55, 1e-6);
  Workspace work;
  for (int k = 0; k < 40 && world.cables[0].links.size() == 3; ++k)
    ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  ASSERT_EQ(world.cables[0].links.size(), 9u) << "the roller parts each of three turns";
  EXPECT_NEAR(shown(world), before, 1e-6);
}

TEST(CablePath, ClippingBodiesStillShowOneSmoothCable) {
  // Zig-zag round two bodies that overlap the cable between them by half its width.
  Scene scene;
  scene.bodies = {body("lower", BodyKind::fixed_axle, {0.0, 0.0}, 0.3),
                  body("upper", BodyKind::fixed_axle, {0.0, 0.7}, 0.3)};
  Cable cable;
  cable.name = "rope";
  cable.start.point = {-0.35, -2.0};
  cable.wraps = {{0, -1, 0}, {1, 1, 0}};
  cable.end.point = {0.35, 2.5};
  scene.cables = {cable};
  World world = make_world(scene, Method::pinch_no_contact);
  Workspace work;
  world.position[1].y() -= 0.05;
  update_segments(world, work);
  ASSERT_TRUE(world.cables[0].segments[2].pinched);
  const auto points = path_of(scene, world);
  expect_smooth(points);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double chord = (points[i].position - points[i - 1].position).norm();
    if (points[i].position.y() > 0.0 && points[i].position.y() < 0.6) {
      EXPECT_LT(chord, 0.2) << "no jump";
    }
  }
  // Half-way between the two, give or take nothing: each arc gives way alike.
  const Vec2 middle = place_of(points, world.cables[0].links[1].material +
                                           world.cables[0].links[1].signed_radius() *
                                               (alpha_head(world.cables[0], 1) - world.angle[0]));
  EXPECT_NEAR(middle.y(), 0.325, 1e-6);
}

TEST(CablePath, ClosedLoopComesRoundWithWholeMarks) {
  Scene scene;
  scene.bodies = {body("a", BodyKind::fixed_axle, {-1.0, 0.0}, 0.4),
                  body("b", BodyKind::fixed_axle, {1.0, 0.2}, 0.6)};
  Cable cable;
  cable.name = "belt";
  cable.closed = true;
  cable.wraps = {{0, 1, 0}, {1, 1, 0}};
  scene.cables = {cable};
  const World world = make_world(scene, Method::pinch);
  const auto points = path_of(scene, world);
  expect_smooth(points);
  EXPECT_NEAR((points.back().position - points.front().position).norm(), 0.0, 1e-9);
  EXPECT_NEAR(length_of(points), world.cables[0].length, 1e-8);
  EXPECT_NEAR(points.back().material - points.front().material, world.cables[0].length, 1e-9);
  const double marks = world.cables[0].length / mark_spacing(world.cables[0]);
  EXPECT_NEAR(marks, std::round(marks), 1e-9);
}

TEST(CablePath, MarksMoveContinuouslyThroughASimulation) {
  // A roller falls on a span that a load keeps taut, is wrapped, and rolls to and fro: links come
  // and go, spans go slack and taut, and no mark moves faster than the bodies do.
  Scene scene = atwood();
  scene.cables[0].start = {-1, {-2.5, 0.6}};
  scene.bodies[1] = body("roller", BodyKind::free, {-1.4, 1.4}, 0.2);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  std::vector<StripPoint> last;
  std::size_t fewest = 99, most = 0;
  for (int frame = 0; frame < 240; ++frame) {
    const auto now = path_of(scene, world);
    double fastest = 0.0;  // m/s
    for (std::size_t b = 0; b < 3; ++b) {
      fastest = std::max(fastest, world.velocity[b].norm() +
                                      std::abs(world.angular_velocity[b]) * scene.bodies[b].radius);
    }
    for (double m = 0.0; !last.empty() && m < world.cables[0].length; m += 0.1) {
      EXPECT_LT((place_of(now, m) - place_of(last, m)).norm(), 0.02 + 1.5 * fastest / 60.0)
          << "frame " << frame << ", material " << m;
    }
    last = now;
    fewest = std::min(fewest, world.cables[0].links.size());
    most = std::max(most, world.cables[0].links.size());
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  }
  EXPECT_LT(fewest, most) << "a link has come on the way";
}

// A roller that climbs a wrapped pulley carries slack into the nip between the two, where a span of
// some millimetres cannot show it: the slack span behind the roller shows it, so that the drawn
// cable keeps its length all the time, and nothing jumps when the links change.
TEST(CablePath, SlackThatHasNoRoomIsShownBesideIt) {
  Scene scene;
  scene.bodies = {body("pulley", BodyKind::fixed_axle, {47.7, 9.096}, 0.32767),
                  body("roller", BodyKind::free, {46.016, 10.086}, 0.163835)};
  scene.bodies[0].mass = 10.0;
  scene.bodies[1].linear_drag = 1.5;
  Cable cable;
  cable.start.point = {45.587, 10.243};
  cable.wraps = {{1, 1, 0}, {0, -1, 0}};
  cable.end.point = {49.661, 8.008};
  scene.cables = {cable};
  World world = make_world(scene, Method::pinch);
  Workspace work;
  double most_hidden = 0.0, largest_change = 0.0, last = world.cables[0].length;  // m
  std::size_t changes = 0, links = world.cables[0].links.size();
  for (int frame = 0; frame < 160; ++frame) {
    const double drawn = length_of(path_of(scene, world));
    most_hidden = std::max(most_hidden, world.cables[0].length - drawn);
    largest_change = std::max(largest_change, std::abs(drawn - last));
    last = drawn;
    changes += static_cast<std::size_t>(world.cables[0].links.size() != links);
    links = world.cables[0].links.size();
    for (int s = 0; s < 4; ++s) ASSERT_EQ(step(scene, world, work), StepStatus::ok);
  }
  EXPECT_GE(changes, 1U) << "the links change on the way";
  EXPECT_LT(most_hidden, 0.02);
  EXPECT_LT(largest_change, 0.015);
}

TEST(Compose, WeightsOfThingsOnCableEndsAreWritten) {
  const Scene scene = atwood();
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  ASSERT_EQ(picture.labels.size(), 2u);
  EXPECT_EQ(picture.labels[0].text, "1 kg");
  EXPECT_EQ(picture.labels[1].text, "1.05 kg");
  EXPECT_NEAR(picture.labels[0].centre.x(), -0.55, 1e-12);
  EXPECT_LT(picture.labels[0].centre.y(), -1.5 - 0.2);
}

TEST(Compose, MethodsOfAPairLookAlike) {
  const Scene scene = atwood();
  Picture pinch, baseline;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), pinch);
  compose(scene, set_scenery(scene), make_world(scene, Method::cable), baseline);
  ASSERT_EQ(pinch.order.size(), baseline.order.size());
  for (std::size_t i = 0; i < pinch.strokes.size(); ++i) {
    EXPECT_EQ(pinch.strokes[i].fill, baseline.strokes[i].fill);
    EXPECT_EQ(pinch.strokes[i].a, baseline.strokes[i].a);
  }
  for (const Label& label : pinch.labels) EXPECT_EQ(label.text.find("pinch"), std::string::npos);
}

TEST(Compose, ABodyTurnsVisibly) {
  const Scene scene = atwood();
  World world = make_world(scene, Method::pinch);
  Picture before, after;
  compose(scene, set_scenery(scene), world, before);
  world.angle[1] += 2.0 * std::numbers::pi / 3.0;  // the spokes look the same, the dot does not
  compose(scene, set_scenery(scene), world, after);
  double moved = 0.0;
  for (std::size_t i = 0; i < before.strokes.size(); ++i) {
    if (before.strokes[i].a == before.strokes[i].b)
      moved = std::max(moved, (after.strokes[i].a - before.strokes[i].a).norm());
  }
  EXPECT_GT(moved, 0.2);  // m, of a body with a radius of 0.2 m
}

TEST(Compose, DrivenBodiesShowTheirSense) {
  Scene scene = atwood();
  scene.bodies[0].driven_angular_velocity = -2.0;
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  ASSERT_EQ(picture.strips.size(), 2u);  // the cable and the arrow's shaft
  const Strip& shaft = picture.strips[1];
  const StripPoint &first = picture.points[shaft.first], &next = picture.points[shaft.first + 1];
  EXPECT_LT(first.position.x() * next.position.y() - first.position.y() * next.position.x(), 0.0)
      << "clockwise";
}

TEST(Compose, ReusedPictureHoldsNothingOld) {
  const Scene scene = atwood(), other = hung(0.1);
  Picture picture, fresh;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  compose(other, set_scenery(other), make_world(other, Method::pinch), picture);
  compose(other, set_scenery(other), make_world(other, Method::pinch), fresh);
  EXPECT_EQ(picture.order.size(), fresh.order.size());
  EXPECT_EQ(picture.points.size(), fresh.points.size());
  EXPECT_EQ(picture.labels.size(), fresh.labels.size());
}

TEST(Compose, TheTimeStandsInTheFramesCorner) {
  const Scene scene = atwood();
  Scenery scenery = set_scenery(scene);
  scenery.view = {{-1.0, -2.0}, {3.0, 2.0}};
  const Vec2 offset = scenery.text() * Vec2(2.6, -1.2);  // from the frame's upper left corner
  EXPECT_NEAR((time_label(scenery, 1.5, 1.0).centre - offset - Vec2(-1.0, 2.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((time_label(scenery, 1.5, 0.5).centre - offset - Vec2(-1.0, 4.0)).norm(), 0.0, 1e-12)
      << "portrait: room above";
  EXPECT_NEAR((time_label(scenery, 1.5, 2.0).centre - offset - Vec2(-3.0, 2.0)).norm(), 0.0, 1e-12)
      << "landscape: room at the left";
  EXPECT_EQ(time_label(scenery, 1.5, 1.0).text, " 1.500 s");
}

TEST(Compose, ADividerRunsAlongTheFramesLeftSide) {
  Scenery scenery;
  scenery.view = {{-1.0, -2.0}, {3.0, 2.0}};
  const Stroke line = divider(scenery, 1920.0, 960.0);
  EXPECT_NEAR((line.a - Vec2(-3.0, -2.0)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((line.b - Vec2(-3.0, 2.0)).norm(), 0.0, 1e-12);
  EXPECT_EQ(line.fill, scenery.theme.support);
  EXPECT_EQ(line.half_width, 2.0 * scenery.line());
  EXPECT_NEAR(divider(scenery, 100.0, 100.0).half_width, 0.04, 1e-12) << "a whole pixel is seen";
}

// One band for all pieces, with marks along all of it, and nothing for the nodes.
TEST(Compose, CablesWithMassAreOneBand) {
  Scene scene;
  scene.view = {Vec2(-1.0, -1.5), Vec2(2.0, 1.0)};
  Cable chain;
  chain.name = "chain";
  chain.half_width = 0.01;
  chain.end.point = Vec2(1.0, 0.0);
  chain.slack = 1.0;
  chain.mass_per_metre = 1.0;
  chain.nodes = 20;
  scene.cables.push_back(chain);
  spread_nodes(scene);
  const World world = make_world(scene, Method::pinch);
  Picture picture;
  compose(scene, set_scenery(scene), world, picture);
  ASSERT_EQ(picture.strips.size(), 1U);
  const Strip& strip = picture.strips[0];
  EXPECT_GT(strip.mark_length, 0.0);
  EXPECT_NEAR(picture.points[strip.first + strip.count - 1].material, 2.0, 1e-9);
  EXPECT_NEAR(picture.points[strip.first + strip.count - 1].position.x(), 1.0, 1e-9);
  for (std::size_t i = strip.first + 1; i < strip.first + strip.count; ++i) {
    EXPECT_GT(picture.points[i].tangent.dot(picture.points[i - 1].tangent), std::cos(most_turn));
  }
  EXPECT_TRUE(picture.labels.empty());
}

// A bar and a spring are lines with a pin at either end, a hinge is one pin with a bracket in the
// world, a stop a block; none of them is drawn as a cable.
TEST(Compose, JointsAreNoCables) {
  Scene scene;
  scene.view = {Vec2(-2.0, -2.0), Vec2(2.0, 2.0)};
  for (const double x : {-1.0, 0.0, 1.0}) {
    Body body;
    body.name = fmt::format("{}", x);
    body.radius = 0.2;
    body.position = {x, 0.0};
    scene.bodies.push_back(body);
  }
  scene.bodies[2].kind = BodyKind::rail;
  const auto strokes = [&scene] {
    Picture picture;
    compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
    EXPECT_TRUE(picture.strips.empty());
    return picture.strokes;
  };
  const std::size_t bare = strokes().size();
  add_bar(scene, "bar", {0, Vec2::Zero()}, {1, Vec2::Zero()});
  EXPECT_EQ(strokes().size(), bare + 5);
  EXPECT_EQ(strokes()[strokes().size() - 5].b, scene.bodies[1].position);
  add_hinge(scene, "elbow", 0, 1, {-0.5, 0.0});
  EXPECT_EQ(strokes().size(), bare + 7);
  EXPECT_EQ(strokes().back().a, Vec2(-0.5, 0.0));
  add_hinge(scene, "pivot", 1, -1, {0.0, 0.0});
  EXPECT_GT(strokes().size(), bare + 10);
  const std::size_t before = strokes().size();
  add_stops(scene, 2, -0.5, 0.75);
  ASSERT_EQ(strokes().size(), before + 2);
  const Stroke low = strokes()[before];
  EXPECT_NEAR(0.5 * (low.a.y() + low.b.y()), -0.7, 0.01);  // where its rim arrives
  add_spring(scene, "spring", {1, Vec2::Zero()}, {2, Vec2::Zero()}, 1.0, 0.0, 0.0);
  EXPECT_EQ(strokes().size(), before + 2 + 19 + 4);
}

}  // namespace
}  // namespace pinchlab
