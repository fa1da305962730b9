// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/box2d_chain.h"

#include <box2d/box2d.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/experiments/experiment.h"
#include "base/at.h"
#include "sim/cable/cable.h"
#include "sim/make_world.h"
#include "sim/outline.h"

namespace pinchlab::experiments {

namespace {

/// Bits of Box2D's collision filter: links meet bodies, bodies meet bodies, links do not meet.
enum Category : uint16 { of_bodies = 1, of_links = 2, of_loads = 4 };

b2Vec2 vec(const Vec2& v, double scale) {
  return {static_cast<float>(v.x() * scale), static_cast<float>(v.y() * scale)};
}

/// Points of the cable's centre line `spacing` apart at most, ends and tangent points among them.
/// On an arc they lie so far out that the chords between them touch the cable's inner side.
std::vector<Vec2> chain_points(const CableState& cable, const World& world, double spacing) {
  std::vector<Vec2> points{cable.segments[1].tail};
  for (std::size_t i = 1; i < cable.segments.size(); ++i) {
    const Segment& segment = cable.segments[i];
    const int links = std::max(1, static_cast<int>(std::ceil(segment.length / spacing)));
    for (int k = 1; k <= links; ++k) {
      points.push_back(segment.tail + (segment.head - segment.tail) * k / links);
    }
    if (i + 1 == cable.segments.size()) break;
    const Link& link = cable.links[i];
    const Vec2 centre = link_centre(world, link);
    const int chords = std::max(2, static_cast<int>(std::ceil(link.radius * link.wrap / spacing)));
    const double turn = link.orientation * link.wrap / chords;
    const Vec2 arm = segment.head - centre;
    for (int k = 0; k < chords; ++k) {  // corners between the tangent points
      const double angle = turn * (k + 0.5), out = 1.0 / std::cos(0.5 * turn);
      points.push_back(centre + out * (Eigen::Rotation2Dd(angle) * arm));
    }
    points.push_back(cable.segments[i + 1].tail);
  }
  // A pinched span has no length.
  points.erase(std::unique(points.begin(), points.end(),
                           [](const Vec2& a, const Vec2& b) { return (a - b).norm() < 1e-6; }),
               points.end());
  return points;
}

class ChainWorld {
 public:
  ChainWorld(const Problem& problem, const Box2dSettings& settings)
      : problem_(problem), settings_(settings), world_(vec(problem.scene.gravity, settings.scale)) {
    world_.SetAllowSleeping(false);
    world_.SetContinuousPhysics(settings.continuous);
    ground_ = world_.CreateBody(&ground_def_);
    for (const Body& body : problem.scene.bodies) add_body(body);
    for (const Wall& wall : problem.scene.walls) add_wall(wall);
    const World start = make_world(problem.scene, Method::pinch);
    for (std::size_t c = 0; c < problem.scene.cables.size(); ++c) {
      if (problem.scene.cables[c].rod) {
        add_rod(problem.scene.cables[c]);
        continue;
      }
      add_chain(problem.scene.cables[c], start.cables[c], start);
    }
  }

  void step() {
    const float h =
        1.0f / static_cast<float>(problem_.scene.frames_per_second * settings_.steps_per_frame);
    world_.Step(h, settings_.velocity_iterations, settings_.position_iterations);
  }

  std::vector<Place> places() const {
    std::vector<Place> places;
    for (const std::size_t b : problem_.watched) {
      const b2Vec2 p = bodies_[b]->GetPosition();
      places.push_back({Vec2(p.x, p.y) / settings_.scale,
                        (bodies_[b]->GetAngle() - problem_.scene.bodies[b].angle) *
                            problem_.scene.bodies[b].radius});
    }
    return places;
  }

 private:
  /// What carries an end of a cable does not meet its links, unless the cable runs round it.
  bool is_load(const Body& body) const {
    const auto index = static_cast<int>(&body - problem_.scene.bodies.data());
    const auto is_wrap = [index](const Wrap& wrap) { return wrap.body == index; };
    return std::any_of(problem_.scene.cables.begin(), problem_.scene.cables.end(),
                       [&](const Cable& c) {
                         return (c.start.body == index || c.end.body == index) &&
                                std::none_of(c.wraps.begin(), c.wraps.end(), is_wrap);
                       });
  }

  void add_body(const Body& body) {
    const double scale = settings_.scale;
    b2BodyDef def;
    def.type = body.kind == BodyKind::fixed ? b2_staticBody : b2_dynamicBody;
    def.position = vec(body.position, scale);
    def.angle = static_cast<float>(body.angle);
    def.linearVelocity = vec(body.velocity, scale);
    def.angularVelocity = static_cast<float>(body.angular_velocity);
    def.fixedRotation = body.node;
    b2Body* made = world_.CreateBody(&def);
    if (body.node) {
      add_mass(body, *made);
      bodies_.push_back(made);
      return;
    }
    b2CircleShape disc;
    disc.m_radius = static_cast<float>(body.radius * scale);
    b2PolygonShape polygon;
    b2FixtureDef fixture;
    fixture.shape = &disc;
    if (is_polygon(body)) {
      std::vector<b2Vec2> corners;
      for (const Vec2& corner : body.corners) corners.push_back(vec(corner, scale));
      polygon.Set(corners.data(), static_cast<int>(corners.size()));
      fixture.shape = &polygon;
    }
    fixture.density = 1.0f;
    // Box2D takes the root of the product of both coefficients; that of links is 1. "No slip" is a
    // coefficient that no force here overcomes. Where there are no links bodies rub on each other
    // and on walls, for which that root is our law as well.
    const double mu = std::min(body.cable_friction, 10.0);
    fixture.friction =
        static_cast<float>(problem_.scene.cables.empty() ? body.contact_friction : mu * mu);
    const bool load = is_load(body);
    fixture.filter.categoryBits = load ? of_loads : of_bodies;
    fixture.filter.maskBits = load ? of_bodies : of_bodies | of_links | of_loads;
    made->CreateFixture(&fixture);
    if (def.type == b2_dynamicBody) add_mass(body, *made);
    hold(body, *made);
    bodies_.push_back(made);
  }

  /// Bodies rebound from it however slow they are, and with its restitution: Box2D takes the larger
  /// of both.
  void add_wall(const Wall& wall) {
    b2EdgeShape edge;
    edge.SetTwoSided(vec(wall.a, settings_.scale), vec(wall.b, settings_.scale));
    b2FixtureDef fixture;
    fixture.shape = &edge;
    fixture.friction = static_cast<float>(wall.contact_friction);
    fixture.restitution = static_cast<float>(wall.restitution);
    fixture.restitutionThreshold = 0.0f;
    fixture.filter.categoryBits = of_bodies;
    fixture.filter.maskBits = of_bodies | of_loads;
    ground_->CreateFixture(&fixture);
  }

  void add_mass(const Body& body, b2Body& made) {
    b2MassData mass;
    mass.mass = static_cast<float>(body.mass);
    mass.I =
        body.node ? 0.0f : static_cast<float>(inertia_of(body) * settings_.scale * settings_.scale);
    mass.center.SetZero();
    made.SetMassData(&mass);
  }

  /// Axles and rails.
  void hold(const Body& body, b2Body& made) {
    if (body.kind == BodyKind::fixed_axle) {
      b2RevoluteJointDef axle;
      axle.Initialize(ground_, &made, made.GetPosition());
      world_.CreateJoint(&axle);
    } else if (body.kind == BodyKind::rail) {
      b2WheelJointDef rail;  // a line and free turning; its spring is off
      rail.Initialize(ground_, &made, made.GetPosition(), vec(body.rail_axis, 1.0));
      world_.CreateJoint(&rail);
    }
  }

  b2Body* carrier(const Attachment& attachment) {
    return attachment.body < 0 ? ground_ : at(bodies_, attachment.body);
  }

  void join(b2Body* a, b2Body* b, const Vec2& at) {
    b2RevoluteJointDef joint;
    joint.Initialize(a, b, vec(at, settings_.scale));
    world_.CreateJoint(&joint);
  }

  /// Between two nodes.
  void add_rod(const Cable& rod) {
    const auto end = [&](const Attachment& a) {
      return a.body < 0 ? a.point : at(problem_.scene.bodies, a.body).position;
    };
    b2DistanceJointDef joint;  // stiff, at the length that it begins with
    joint.Initialize(carrier(rod.start), carrier(rod.end), vec(end(rod.start), settings_.scale),
                     vec(end(rod.end), settings_.scale));
    world_.CreateJoint(&joint);
  }

  void add_chain(const Cable& cable, const CableState& state, const World& start) {
    const std::vector<Vec2> points = chain_points(state, start, settings_.link_m);
    double length = 0.0, lightest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
    for (const Body& body : problem_.scene.bodies) {
      if (is_load(body)) lightest = std::min(lightest, body.mass);
    }
    if (!std::isfinite(lightest)) lightest = 1.0;
    b2Body* before = carrier(cable.start);
    for (std::size_t i = 1; i < points.size(); ++i) {
      const double part = (points[i] - points[i - 1]).norm();
      const double mass = cable.mass_per_metre > 0.0
                              ? cable.mass_per_metre * part
                              : settings_.mass_share * lightest * part / length;
      b2Body* link = add_link(points[i - 1], points[i], cable.half_width, mass);
      if (cable.mass_per_metre > 0.0) link->SetGravityScale(1.0f);
      join(before, link, points[i - 1]);
      before = link;
    }
    join(before, carrier(cable.end), points.back());
  }

  b2Body* add_link(const Vec2& from, const Vec2& to, double half_width, double mass) {
    const double scale = settings_.scale;
    const Vec2 along = to - from;
    b2BodyDef def;
    def.type = b2_dynamicBody;
    def.position = vec(0.5 * (from + to), scale);
    def.angle = static_cast<float>(std::atan2(along.y(), along.x()));
    def.gravityScale = 0.0f;
    b2Body* link = world_.CreateBody(&def);
    // Box2D holds polygons apart by a skin of 2 slops; it lies within the cable's width.
    b2PolygonShape box;
    const double length = std::max(along.norm() * scale - 2.0 * b2_polygonRadius, 0.01);
    const double width = std::max(half_width * scale - b2_polygonRadius, 0.25 * half_width * scale);
    box.SetAsBox(static_cast<float>(0.5 * length), static_cast<float>(width));
    b2FixtureDef fixture;
    fixture.shape = &box;
    fixture.density = 1.0f;
    fixture.friction = 1.0f;
    fixture.filter.categoryBits = of_links;
    fixture.filter.maskBits = of_bodies;
    link->CreateFixture(&fixture);
    const double size = along.norm() * scale, thick = 2.0 * half_width * scale;
    b2MassData data;
    data.mass = static_cast<float>(mass);
    data.I = static_cast<float>(mass * (size * size + thick * thick) / 12.0);
    data.center.SetZero();
    link->SetMassData(&data);
    return link;
  }

  const Problem& problem_;
  const Box2dSettings& settings_;
  b2World world_;
  b2BodyDef ground_def_;
  b2Body* ground_ = nullptr;
  std::vector<b2Body*> bodies_;
};

bool finite(const std::vector<Place>& places) {
  return std::all_of(places.begin(), places.end(),
                     [](const Place& p) { return p.centre.allFinite() && std::isfinite(p.rim); });
}

}  // namespace

std::string box2d_cannot(const Problem& problem) {
  for (const Cable& cable : problem.scene.cables) {
    if (cable.closed) return "closed cables are not built";
  }
  for (const Body& body : problem.scene.bodies) {
    if (body.corners.size() > b2_maxPolygonVertices || body.corner_radius > 0.0) {
      return "polygons are built sharp, of 8 corners at most";
    }
    if (body.driven_angular_velocity || body.torque != 0.0 || body.linear_drag > 0.0 ||
        body.angular_drag > 0.0) {
      return "drives, torques and drag are not built";
    }
  }
  return "";
}

Recording run_box2d(const Problem& problem, const Box2dSettings& settings) {
  ChainWorld world(problem, settings);
  Recording recording;
  recording.motion.push_back(world.places());
  for (int frame = 0; frame < problem.frames; ++frame) {
    const double start = cpu_seconds();
    for (int i = 0; i < settings.steps_per_frame; ++i) world.step();
    recording.cpu_s += cpu_seconds() - start;
    recording.motion.push_back(world.places());
    recording.finite = finite(recording.motion.back());
    if (!recording.finite) return recording;
  }
  return recording;
}

}  // namespace pinchlab::experiments
