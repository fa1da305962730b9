// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The mutable state of a simulation: all that a restart needs, and nothing that follows from it
// (that is in a Workspace). Bodies and cables are indexed as in Scene; links and segments come and
// go.

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "sim/configuration.h"
#include "sim/contact.h"
#include "sim/scene.h"

namespace pinchlab {

/// How a cable lies in layers on the drum that holds its end, by the area that it takes: wound by
/// the angle th it has the length l = inner th + w th^2 / 2 pi (w the half width), and its centre
/// line there the radius sqrt(inner^2 + 2 w l / pi) = inner + w th / pi, which is dl/dth and lever
/// arm alike.
struct Layers {
  int way = 0;          // +1: the drum holds the cable's start, -1: its end; 0: there are none
  double inner = 0.0;   // m, radius of the centre line where the first layer begins
  double growth = 0.0;  // m/rad, w / pi
  double begins = 0.0;  // rad, orientation * (alpha - body's angle) where it begins

  double radius(double turned) const { return inner + growth * turned; }
  double length(double turned) const { return (inner + 0.5 * growth * turned) * turned; }

  /// The angle (rad) to a place `length` (m) from where it begins.
  double turned_at(double length) const {
    return 2.0 * length / (inner + std::sqrt(inner * inner + 2.0 * growth * length));
  }
};

/// A circle fixed to a body, which a cable touches: rolling round it, or (of radius 0) attached to
/// it at an end of the cable. On a polygon a cable has a link at each corner that it bends round;
/// the segments between them are its sides, and rigid.
///
/// The material at the link's tail tangent has the coordinate material + p (alpha_tail - angle),
/// that at its head tangent material + p (alpha_head - angle), where p = orientation * radius,
/// alpha is the direction of the segment before or after, and angle is the body's. Without slip
/// `material` is constant, so the cable's total length is conserved by construction. Of an elastic
/// cable that a rim carries over stretched it is material + what its rim carries up to p (alpha -
/// angle).
struct alignas(64) Link {
  // What every step reads, in one line of the cache.
  int body = -1;        // index, or -1: attached to the world
  int orientation = 0;  // +1 counter-clockwise, -1 clockwise, 0 attachment
  int corner = -1;      // of a polygon, that the circle is about; or -1. Of a moored node, that
                        // it turns about as it slips
  bool still = false;   // the circle never moves: about a centre that cannot, or in the world
  bool pinch_middle = false;  // middle link of a non-transitional pinch: no wrap, the links
                              // before and after lie on the pinched body
  Slip slip = Slip::stick;    // by the active set
  bool moored = false;        // a node of the cable that the body's rim holds: taking_in.h
  double radius = 0.0;      // m, of the body or its corner, + cable half width; 0 at an attachment
  double material = 0.0;    // m along the cable; changed by slip only
  double wrap = 0.0;        // rad, angle of cable stored on the body, may exceed 2 pi
  double slip_speed = 0.0;  // m/s of material over the body's surface, forward positive
  Vec2 offset = Vec2::Zero();  // m, the circle's centre in the body's frame, or in the world
  // What few steps read.
  int contact = -1;  // pinch_middle: the contact that presses it, by assign_contacts
  // moored:
  double bent = 0.0;  // rad, by which the cable was bent there when the rim took hold of it,
  double held = 0.0;  // rad, at which the rim, or the cable on it, was turned
  double slid = 0.0;  // rad, by which slipping has turned `offset` on the body; by follow_slip
  Layers layers;      // of a drum that fills; `radius` is then that of the outermost turn,
                      // by update_tangent

  double signed_radius() const { return orientation * radius; }
};

/// A place on a rim that carries an elastic cable, and the material that lies on it up to there.
struct Laid {
  double place = 0.0;          // m along the rim: p (alpha - angle), see Link, and Rim::slides
  double material = 0.0;       // m
  double slope = 1.0;          // m of material in a m of the rim, from here to the next
  Vec2 moment = Vec2::Zero();  // m, integral of slope e up to there, e being the direction of place
                               // / p; of cables with mass (laid_moment)
};

/// What a link's rim carries of an elastic cable, stretched as it came on: creep.h.
struct Rim {
  std::vector<Laid> laid;  // ascending; between two the strain is one. Empty: as much as it turns
  double comes_on_at_tail = 1.0, comes_on_at_head = 1.0;  // m of material on a m of rim
  double slope = 0.0;   // m of material in a m of the segment before, when the interval began; 0:
                        // not known
  bool slides = false;  // over the body, as the cable does: places are so far from where that has
                        // Link::material 0
  std::array<double, 2> gives{};  // m, to the segments before and after it as it slides in part
                                  // at an interval's end; by slide_in_part
};

/// The free span that arrives at the link of the same index from the link before it.
struct alignas(64) Segment {
  // What every step reads.
  double alpha = 0.0;               // rad, heading(direction), continuous; of pieces: turn_pieces
  double length = 0.0;              // m, distance along the tangent; 0 when pinched
  double rest_length = 0.0;         // m of material; may be negative by round-off when pinched
  double tension = 0.0;             // N, of the last step; in a non-transitional pinch the change
                                    // of tension that the middle body takes up
  Vec2 direction = Vec2(0.0, 1.0);  // unit, from tail to head
  bool moved = true;                // in the last step, or made in it; by update_tangent
  bool slack = false;               // by the active set
  bool pinched = false;             // between two touching bodies: zero length, never hit-tested
  bool was_pinched = false;         // at the interval's start
  int contact = -1;                 // pressing a transitional pinch, by assign_contacts; or -1
  double alpha_before = 0.0;        // rad, alpha when the interval began, like previous_tail
  // What is read where something has moved.
  Vec2 tail_centre = Vec2::Zero(), head_centre = Vec2::Zero();  // m, of the circles that the
                                                                // tangent is for
  Vec2 tail = Vec2::Zero(), head = Vec2::Zero();  // m, tangent points on the cable's centre line
  Vec2 previous_tail = Vec2::Zero(), previous_head = Vec2::Zero();  // m, when the interval began
  Curvature curvature{};                                            // by note_curvatures
};

/// The finest piece between two nodes of a cable with mass that runs over bodies, of those whose
/// number adapts, or what begins with it: held_spans.h.
struct FinestPiece {
  int pieces = 1;            // of the finest in the span that begins with it; 0: in another's
  double turned = 0.0;       // rad, to the straight line of that span
  Vec2 seat = Vec2::Zero();  // m, in the frame of that line: the node before, if the span holds it
  double spare = 0.0;        // m, by which that line is shorter than its material
  Vec2 held = Vec2::Zero();  // kg m, likewise, first moment of the bend that it holds
  double let_out = 0.0;      // 1/s, at which tension straightens that bend
};

/// How fast an elastic segment has lengthened in the last two intervals, more than its material has
/// (m/s).
struct Growth {
  double last = infinity, before = infinity;

  bool operator==(const Growth&) const = default;
};

struct alignas(64) CableState {
  // What every step reads, in two lines of the cache.
  std::vector<Link> links;
  std::vector<Segment> segments;  // as many as links; segments[0] is unused when open and runs
                                  // from the last link to the first when closed
  int changes = 0;                // links inserted and removed so far
  int changed_at = 0;             // World::changes after the last of these
  int bends_with = -1;            // a piece between nodes that goes on from its end: bending.h
  int pieces = 1;  // of a chain whose number of nodes adapts (held.h), by adapt_nodes: the
                   // finest that it is made of; 0: dormant, part of another
  bool closed = false;
  bool elastic = false;  // of finite stiffness
  bool creeps = false;   // elastic, and rims carry it over stretched: creep.h
  bool rod = false;      // bears force both ways: a piece between nodes, or a joint
  bool piece = false;    // between nodes
  bool fills = false;    // lies in layers on a body that holds an end of it
  Joint joint = Joint::none;
  // By update_wraps_and_rest_lengths, which has all at hand:
  bool unwound = false;     // a link that it rolls on has lost its wrap
  bool misfilled = false;   // a pinched segment is, somewhere: cable.h
  bool short_span = false;  // a span is short, as vanishing ones are: cable.h
  bool finite = true;       // lengths, rest lengths and tensions are
  bool stands =
      false;  // nothing of its course has moved since the interval before, and nothing can: so
              // its tangents and wraps are as they were; by update_cable
  double length = 0.0;      // m of material, constant
  double turning = 0.0;     // rad, total turning of a closed loop, a multiple of 2 pi
  double half_width = 0.0;  // m
  double density = 0.0;     // kg/m, of a cable that has mass without nodes (cable/mass.h)
  std::vector<Rim> rims;    // as many, once a rim carries what creeps; else none. By lay_down
  // What few steps read.
  double least_gap = 0.0;  // m, between bodies that pinch it: (1 - squeeze) of its width; 0 under
                           // Method::pinch_no_contact
  // Of a chain whose number of nodes adapts, by adapt_nodes:
  Vec2 held = Vec2::Zero();  // kg m, first moment of the bend that it holds
  double turned = 0.0;       // rad, of the finest piece to the line of what it is part of
  double let_out = 0.0;      // 1/s, at which tension straightens that bend
  // Of any:
  int first_node = -1, nodes = 0;   // bodies, of one with mass that runs over bodies: strung.h
  std::vector<FinestPiece> finest;  // of nodes whose number adapts, by adapt_nodes: one more
  double grip = 1.0;                // factor on the friction of its pinches
  double bend = 0.0;                // N m a rad, between it and `bends_with`
  std::vector<Growth> growth;       // elastic, between nodes: as many as segments; by note_growth
};

/// Direction angle of the cable where it leaves link i (rad, consistent with that link's tail).
double alpha_head(const CableState& cable, std::size_t link);

/// Material coordinate (m from the cable's start) where the cable meets link i, and where it
/// leaves.
double tail_material(const CableState& cable, std::size_t link, double body_angle);
double head_material(const CableState& cable, std::size_t link, double body_angle);

/// How far a link's outermost layer is off its first (m); 0 where there are none.
inline double thickness_of_layers(const Link& link) {
  return link.layers.way != 0 ? link.radius - link.layers.inner : 0.0;
}

/// m of cable on a link, the wraps being up to date.
inline double stored_length(const Link& link) {
  return link.layers.way == 0 ? link.radius * link.wrap : link.layers.length(link.wrap);
}

/// Where another wall goes on from a wall's end, on one side of it: by join_walls.
struct Nook {
  Vec2 way = Vec2::Zero();  // unit, along the other wall from there
  double length = 0.0;      // m, of the other wall along that; 0: there is none
  bool straight = false;    // the two are one line
};

/// Whether a wall's end stands out, so that hanging cables may lie over it.
enum class Tipped : std::int8_t {
  none,
  own,
  of_another,  // wall, that comes before this one and ends there too
};

/// What stands for good and bodies cannot pass: a wall of the scene; or the end of a cable that is
/// held in the world, a smooth point with the cable's half width about it (make_world.cpp).
struct Obstacle : Wall {
  double radius = 0.0;           // m, how far from its line its surface is
  int cable = -1;                // whose end it is, or -1: a wall
  std::array<Tipped, 2> tips{};  // of a and b; by find_tips
  std::array<std::array<Nook, 2>, 2>
      nooks;  // of a and b, on the left of the way out of the wall there and on its right
};

/// The pieces of a hanging cable that end and begin in a node.
struct PiecesAtNode {
  int before = -1, after = -1;  // cables, or -1
};

/// What came of a step. It fails where a value is not finite, or where cables bend round more
/// corners, or meet and leave bodies more often, than anything real: World::failure.
enum class StepStatus { ok, failed };

constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

/// What the last step was like. Lengths in m, at the positions that the step ended with; they and
/// the energy are not_measured unless Configuration::diagnostics asks for them.
struct Diagnostics {
  double largest_stretch = not_measured;  // m, of an inextensible cable's segment beyond its rest
                                          // length
  double largest_gap_violation = not_measured;  // m, below a contact's target
  double energy = not_measured;  // J, kinetic + potential + elastic, at the step's start
  double cable_length_error = not_measured;  // m, sum of wraps and rest lengths against the
                                             // cables' lengths
  int active_set_solves = 0;                 // in the last step
  std::int64_t total_solves = 0;             // since the start
  std::int64_t fallbacks =
      0;  // parts of steps (Events::located: steps) whose active set did not settle, or whose
          // lengths and gaps no repair could meet
  std::int64_t events = 0;        // located since the start
  std::int64_t intervals = 0;     // into which steps have been divided, since the start
  std::int64_t node_changes = 0;  // of cables whose nodes come and go, since the start
  double node_losses = 0.0;       // J, kinetic energy lost in these, of chains that adapt
  std::int64_t clusters = 0;      // steps with so many events that what came last did not rebound
};

/// How a part has come to where it is.
struct Pace {
  double lag = 0.0;  // s, by which velocities are behind positions (leapfrog): half of the last
                     // interval, or none where they have been found for these positions since
  // Of the intervals of that length that came one after another until now:
  std::int8_t intervals = 0;   // how many, as far as their curvatures are kept
  std::int8_t unmeasured = 0;  // of the last of them the errors are not known
  bool curved = false;         // some way in them; else nothing is kept of curvatures, which are 0

  bool operator==(const Pace&) const = default;
};

/// Copying a World is cheap: a few arrays, no text but a failure's. A copy goes on to the same
/// bits. Marks of cables and segments that follow from the rest are here too, since stages that get
/// no Workspace read them, in the lines of the cache that they read anyway.
struct World {
  Configuration configuration;
  double step_length = 0.0;  // s
  std::int64_t step = 0;     // steps done; the time is step * step_length

  std::vector<BodyProperties> bodies;  // by make_world; masses, kinds and seats of what belongs to
                                       // chains whose number of nodes adapts, by adapt_nodes
  std::vector<Obstacle> obstacles;     // walls as in Scene, then ends of cables; by make_world
  std::vector<int> carried;    // bodies that are shapes of others (compound.h), by make_world
  std::vector<Vec2> position;  // m, one a body, at `time()`; by move_bodies
  std::vector<double> angle;   // rad, likewise
  std::vector<Pace> pace;      // one a body, then one a cable: of its part; by finish_interval
  std::vector<Vec2> velocity;  // m/s, Pace::lag before `time()`; by store_solution
  std::vector<double> angular_velocity;  // rad/s, likewise
  std::vector<CableState> cables;        // geometry by update_segments, links by add_hit_links,
                                         // remove_links and configure_pinches, forces and states by
                                         // store_solution
  std::vector<int> still_steps;          // steps for which the body's part has been at rest, by
                                         // note_rest
  std::vector<Contact> contacts;         // sorted by (a, b, wall); by find_contacts, forces and
                                         // states by store_solution
  std::vector<PiecesAtNode> pieces_at;   // one a body; empty where pieces of hanging cables meet
                                         // nothing. By join_pieces, as `passing`:
  std::vector<std::array<int, 2>> passing;  // sorted: a piece, and the body (or -1 - wall) that it
                                            // does not meet;
  std::vector<std::array<int, 2>> passing_at_ends;  // of these those for good, by make_world
  std::vector<int> strung;  // cables with mass that run over bodies and have nodes; by make_world
  int changes = 0;          // links inserted and removed so far, of all cables
  Diagnostics diagnostics;
  std::string failure;  // where and when, if a step was not finite

  std::uint64_t stamp = 0;  // what a Workspace knows this state by; 0: none does. Set it to 0 after
                            // changing positions, cables or contacts by hand

  double time() const { return static_cast<double>(step) * step_length; }
};

}  // namespace pinchlab
