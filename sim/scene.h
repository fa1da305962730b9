// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The immutable description of a simulation: what a scene file says, in SI units, checked.

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pinchlab {

using Vec2 = Eigen::Vector2d;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// How pinched cables are handled (thesis 3.3.1 and 4.2).
enum class Method {
  pinch,             ///< pinch joints: no body comes nearer to another than the cable between them
  pinch_no_contact,  ///< pinch joints without their contact rows: bodies clip into the cable
  cable,             ///< plain cable joints: wrapped cable is not seen by other bodies at all
};

enum class BodyKind {
  free,        ///< moves and turns
  rail,        ///< moves along `rail_axis` only, and turns
  fixed_axle,  ///< turns only
  fixed,       ///< neither moves nor turns
};

/// What a body is, for all time: a disc, or a convex polygon.
struct BodyProperties {
  BodyKind kind = BodyKind::free;
  double radius = 0.5;  ///< m, > 0; of a polygon that of the circle about its centre that holds it
  /// m, in the body's frame, whose origin is the centre of mass: 3 to 64 corners of a convex
  /// polygon, counter-clockwise. Empty: a disc.
  std::vector<Vec2> corners;
  double corner_radius = 0.0;       ///< m, >= 0: the polygon's outline is that far off
  double mass = 1.0;                ///< kg, > 0; unused for fixed bodies; 0 of shapes
  std::optional<double> inertia;    ///< kg m^2, > 0; default: disc, m r^2 / 2
  Vec2 rail_axis = Vec2(0.0, 1.0);  ///< unit vector; rail bodies only
  std::optional<double> driven_angular_velocity;  ///< rad/s, prescribed for all time
  double torque_limit = infinity;  ///< N m, > 0: the most that holds the driven velocity
  double torque = 0.0;             ///< N m, constant
  bool node = false;               ///< of a cable with mass, by spread_nodes: part of the cable
  bool outlined = true;       ///< false: a compound, whose shapes have its outlines (compound.h)
  int carrier = -1;           ///< of a shape: the compound, index into Scene::bodies
  Vec2 seat = Vec2::Zero();   ///< m, of a shape's centre in the compound's frame
  double seat_angle = 0.0;    ///< rad, by which the shape is turned there
  double linear_drag = 0.0;   ///< 1/s: dv/dt = -drag v
  double angular_drag = 0.0;  ///< 1/s
  double cable_friction = infinity;  ///< capstan coefficient mu >= 0; infinity: no slip
  double contact_friction = 0.5;     ///< Coulomb coefficient >= 0 between bare surfaces
  double restitution = 0.0;          ///< 0..1, of bodies that hit each other or a wall
};

/// A corner of a motor's time table.
struct MotorPoint {
  double time = 0.0;   ///< s, >= 0
  double value = 0.0;  ///< rad/s of a driven body, N m of any other
};

/// A body and its state at time 0.
struct Body : BodyProperties {
  std::string name;               ///< unique in the scene
  Vec2 position = Vec2::Zero();   ///< m
  double angle = 0.0;             ///< rad, counter-clockwise
  Vec2 velocity = Vec2::Zero();   ///< m/s
  double angular_velocity = 0.0;  ///< rad/s; a motor without a torque limit has its own
  /// What stands in place of `driven_angular_velocity`, where that is given, or of `torque`:
  /// straight lines between these points, of ascending times, and constant before the first and
  /// after the last.
  std::vector<MotorPoint> motor;
};

/// Where an end of an open cable is held.
struct Attachment {
  int body = -1;              ///< index into Scene::bodies, or -1: the world
  Vec2 point = Vec2::Zero();  ///< m, in the body's frame (origin at its centre), or in the world
  bool layers = false;        ///< on a disc's rim: what winds up there lies in layers
};

/// One body that a cable runs round.
struct Wrap {
  int body = 0;         ///< index into Scene::bodies
  int orientation = 1;  ///< +1: the cable runs counter-clockwise round the body; -1: clockwise
  int extra_turns = 0;  ///< whole turns beyond the one wrap in [0, 2 pi) that the tangents ask for
};

/// What a joint of the scene has become: a cable of one straight segment that nothing hits
/// (joints.h).
enum class Joint : std::int8_t {
  none,    ///< a cable
  bar,     ///< keeps two points at their distance
  pin,     ///< one of the two bars of a hinge
  spring,  ///< pulls and pushes
  stop,    ///< an inextensible cable along a rail, taut where its body may go no further
};

/// As many as steps can follow: spread_nodes chooses.
constexpr int automatic_nodes = -1;

// squeeze and grip make a pinch weaker by degrees. A sheath that yields to any force surrounds a
// core that yields to none: bodies that pinch the cable come as near to each other as (1 - squeeze)
// times its width, and their force N acts there. At 1 it is Method::pinch_no_contact, exactly. The
// friction of a pinch is at most grip * mu * N of either body. Arcs keep their capstan law, spans
// their length, and a body without slip that lies on the pinched cable's way does not slip.

/// A cable, massless unless it says so, from `start` over `wraps` to `end`; a closed one has wraps
/// only (at least two).
struct Cable {
  std::string name;          ///< unique in the scene
  double half_width = 0.05;  ///< m, > 0
  bool closed = false;
  bool creep = true;   ///< elastic: rims carry it over as stretched as it came on (creep.h)
  bool rod = false;    ///< bears force both ways: between nodes, and joints, which nothing hits
  bool piece = false;  ///< between nodes, by spread_nodes
  Joint joint = Joint::none;
  Attachment start, end;  ///< unused when closed
  std::vector<Wrap> wraps;
  double slack = 0.0;                 ///< m, total length beyond the taut path at time 0; >= 0,
                                      ///< negative (pre-stretched) only with finite stiffness
  double axial_stiffness = infinity;  ///< N, EA; infinity: inextensible
  double damping = 0.0;               ///< N s/m, of a spring: force per speed of its lengthening
  double squeeze = 0.0;  ///< 0..1, share of the width that a pinch presses out of it without force
  double grip = 1.0;     ///< 0..1, factor on the friction that a pinch's force gives
  /// kg/m. A cable that runs over bodies is straight between them (cable/mass.h); any other becomes
  /// a chain of nodes that have its mass (nodes.h).
  double mass_per_metre = 0.0;
  int nodes = 0;  ///< of such a chain; 0: automatic_nodes. Of one that runs over bodies, of all of
                  ///< it; 0: it is straight between them
  int first_node = -1;  ///< of one that runs over bodies: all others follow. By spread_nodes
  /// m, of nodes of either: how far from straight it may be between two of them, whose number
  /// adapts; 0: it is fixed.
  double node_tolerance = 0.0;
  double bending_stiffness = 0.0;  ///< N m^2, EI, of such a chain
  int bends_with = -1;  ///< of a piece between nodes: the next one, against which it bends; or -1
  double bend = 0.0;    ///< N m a rad, there
  double contact_friction = 0.5;  ///< Coulomb coefficient of its nodes on bodies and walls
  double linear_drag = 0.0;       ///< 1/s, of its nodes
};

/// A cable of nodes whose number adapts, by spread_nodes: its finest pieces, equally long, and the
/// nodes between them.
struct NodeChain {
  int cable = 0;                ///< the first piece
  int first_piece = 0;          ///< the second; all others follow
  int first_body = 0;           ///< the first node; all others follow
  int pieces = 0;               ///< a power of two
  double piece_length = 0.0;    ///< m
  double mass_per_metre = 0.0;  ///< kg/m
  double tolerance = 0.0;       ///< m
};

/// A static straight wall: bodies cannot pass it from either side. Cables ignore walls.
struct Wall {
  Vec2 a = Vec2::Zero(), b = Vec2::Zero();  ///< m
  double contact_friction = 0.5;
  double restitution = 0.0;
};

/// The part of the plane that a frame shows, m. Its aspect is fitted into the frame's.
struct View {
  Vec2 low = Vec2(-1.0, -1.0), high = Vec2(1.0, 1.0);
};

struct Scene {
  std::string name;                 ///< file name without folder and ending, e.g. "03-drop"
  std::string title;                ///< for people, e.g. "Dropped roller"
  Vec2 gravity = Vec2(0.0, -9.81);  ///< m/s^2
  std::vector<Body> bodies;
  std::vector<Cable> cables;
  std::vector<Wall> walls;
  std::vector<NodeChain> chains;  ///< of cables whose number of nodes adapts
  /// Bodies, the lesser index first, that do not touch each other whatever they do; ascending.
  std::vector<std::array<int, 2>> apart;
  int frame_count = 600;
  int frames_per_second = 60;
  int steps_per_frame = 4;
  double error = 0.0;  ///< m, >= 0: Configuration::error, where that is 0
  View view;
  Method baseline = Method::pinch_no_contact;  ///< what the pinch method is paired with
  std::string baseline_reason;
};

inline double step_length(const Scene& scene) {  // s
  return 1.0 / (static_cast<double>(scene.frames_per_second) * scene.steps_per_frame);
}

/// What the motor's table says at time t (s). The table has a point.
double drive_at(const std::vector<MotorPoint>& motor, double t);

/// The mean of that from `begin` to `end` (s), exactly; end > begin.
double mean_drive(const std::vector<MotorPoint>& motor, double begin, double end);

/// What drives the body when it is driven most, rad/s or N m; 0: it has no motor.
double strongest_drive(const Body& body);

/// Whether the body's centre can move.
inline bool can_move(const BodyProperties& body) {
  return body.kind == BodyKind::free || body.kind == BodyKind::rail;
}

/// Moment of inertia (kg m^2), of an even plate if none is given.
inline double inertia_of(const BodyProperties& body) {
  return body.inertia.value_or(0.5 * body.mass * body.radius * body.radius);
}

/// Whether nothing about the body ever changes.
inline bool is_static(const BodyProperties& body) {
  return body.kind == BodyKind::fixed && !body.driven_angular_velocity;
}

/// Whether impulses can move or turn the body.
inline bool is_mobile(const BodyProperties& body) {
  return can_move(body) || (body.kind != BodyKind::fixed && !body.driven_angular_velocity);
}

const char* to_string(Method method);

}  // namespace pinchlab
