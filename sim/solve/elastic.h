// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Rows of elastic segments, and of dampers.
//
// With C_n at the positions' time, v- and v+ the velocities before and after the kick, which lasts
// from `lag` before that time to h/2 after it, the impulse is
//     p = EA / l (k C_n + a h^2 dC/dt(v+) - 4 b lag^2 dC/dt(v-)),   k = lag + h/2.
// a = b = 1/4 is the trapezoidal rule over the kick: of second order, stable for any stiffness, and
// undamped (at equal steps the mean of C over three of them, weighted 1, 2, 1). a = 1, b = 0 is
// implicit Euler, which damps at the rate (a - b) omega^2 h / 2. A vibration of less than about
// three steps a period, s = (omega h)^2 > 4, cannot be followed and is damped the more the stiffer
// it is: a - b = 1 - 4/s, h being the longer of this interval and the one before, whose half the
// kick makes up. dC/dt(v-) is the mean on the way that took 2 lag, as C_n + h dC/dt(v+) is the end
// of a way that turns (motion/missed.h): then the rule is the same in both directions of time. At
// an instant (h = 0) such a cable is inextensible.
//
// That damps slow vibrations of the same cable as well, by far more than is theirs: a load that
// bobs on a rope with light nodes comes to rest. So of chains of nodes which nothing touches, after
// two intervals of one length h, the share d = a - b is of a mean over four positions instead,
//     C = sum w_j C_n+j,  j = 1, 0, -1, -2,  w = (1 - d) (1, 2, 1, 0) / 4 + d (8, 12, 6, 1) / 27,
// the latter being (z + 1/2)^3 made 1 at z = 1: sum j w_j = 0, so that it is of second order, and
// what is slow is damped by (omega h)^3 / 27 a step at most. What is infinitely stiff is halved by
// each, and nothing grows whatever s and d are (the roots of z (z - 1)^2 + s w(z)). An interval of
// another length h' after these has the weights -7, -1 of the past and that of dC/dt(v+) that makes
// the integral of an even growth over its kick right, 8 h^2 / 27 + (h'^2 - h^2) / 8. Other elastic
// cables keep to the share of implicit Euler: a blow is answered by 2.5 times its speed, so that
// what flows over rims would make energy, and spans over light pulleys, which go slack and taut
// again and again, would go their ways by the round-off of when.
//
// C changes by J v and by what rims carry less than they turn (creep.h).
//
// Where cable slides over bodies, the tensions of a group of segments follow one another (the
// capstan law) and together they take up the sum of their stretches, which sliding does not change:
// with one a and b for all of them the sliding speeds cancel. Half of what lies on a smooth rim
// stretches with either segment beside it (cable/relax.h). At an instant a group's impulses follow
// one another too. Sliding speeds have no mass. Means over three positions would let them alternate
// from kick to kick, more each time; they are what makes the law hold at the interval's end, for
// C_n + h dC/dt(v+) (slip_speeds) and what curved ways make of it (motion/missed.h).
// Where what slides has mass (rubbing.h) each segment is a spring by itself.
//
// A damper adds c (dC/dt(v-) + dC/dt(v+)) / 2 over the kick, to an instant c dC/dt(v+) over the
// lag.

#include "sim/cable/cable.h"
#include "sim/solve/part_system.h"

namespace pinchlab {

struct Part;
struct Parts;

/// Makes the row of an inextensible segment that of an elastic one, of `given`, which slides over
/// no body. At an instant its impulse up to then is known but for a damper's: it has acted on the
/// free velocities, and without a damper the row idles.
void make_elastic(const World& world, const Cable& given, const Segment& segment, const TimeSpan& t,
                  PartSystem& s, int number);

/// The same for all segments of a part whose cables may slide over bodies.
void make_all_elastic(const Scene& scene, const World& world, const Parts& parts, const Part& part,
                      const TimeSpan& t, PartSystem& s);

/// Notes how much elastic segments between nodes have grown in an interval of such a length
/// (s) that is over: CableState::growth.
void note_growth(const PartSystem& s, double length, World& world);

}  // namespace pinchlab
