// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The scenes of the stability tests. Lengths in m, masses in kg; gravity is the default.

#include "demos/scenes/build.h"

namespace pinchlab::experiments::stability {

constexpr double g = 9.81;  // m/s^2
using build::cable_half_width;
using build::pulley_radius;

/// A body of 1 kg on a cable of 1 m, and `ratio` kg on a cable of 1 m below it, 1 mm out of line.
Scene hanging_pair(double ratio);

/// A drum with a cable over it; on that a roller of 1 kg, and on that one of `ratio` kg.
Scene heavy_on_light(double ratio);

/// 10 kg that fall `height` before their cable, over five light pulleys in a row, gets taut.
Scene caught_load(double height);

/// A roller of 1 kg that falls 50 mm on a cable over a drum, with `extra_turns` round the drum.
Scene roller_on_drum(int extra_turns, int cables = 1, double half_width = cable_half_width);

/// A roller of 1 kg at rest, 10 mm below a drum with a cable under it; `mass` falls 5 m before the
/// cable that it hangs on is taut and jerks the roller up.
Scene roller_jerked_at_drum(double mass);

/// The roller on the drum with 1 kg and 2 kg at the cable's ends, on a
/// drum that does not turn, friction 0.02.
Scene slipping_winding(int extra_turns);

/// `count` rollers of 1 kg on a rail above a drum, from 50 mm apart, the cable in a zig-zag round
/// all and a weight of 1 kg at its end.
Scene zigzag_stack(int count, double half_width = cable_half_width);

/// A closed cable round `wheels` wheels in a ring, each second one smaller; the topmost, body 0,
/// turns at 5 rad/s. With a roller (the last body) that lies on it.
Scene driven_loop(int wheels, bool roller);

/// A bob on a cable of 50 mm that touches a peg when it hangs; it starts `amplitude_rad` away.
Scene bob_at_peg(double amplitude_rad);

/// A ball of 1 kg that falls `height` on a cable between two pulleys with 3 kg at either end, and
/// bounces on it.
Scene trampoline(double height);

/// A ball of 0.1 m radius that flies at `speed` m/s at a cable held at both ends, 2.5 steps away.
Scene ball_at_span(double speed, double slack);

/// A load that swings, from 60 degrees, on a cable wound on a fixed drum.
Scene unwinding_pendulum();

/// A roller that runs to and fro in the bight of a cable between two anchors.
Scene roller_in_bight();

/// A free roller that rolls down a cable, over the drum (which pinches it) and down the far side.
Scene roll_over();

/// Two discs side by side, of 1 and `other` kg, that fall 0.4 m on one span: slack between anchors,
/// or taut between pulleys with weights of 3 kg.
Scene two_on_span(double other, bool slack);

/// A load of 2 kg that hangs on three cables of unequal slack and falls until they catch it.
Scene load_into_cables();

/// Five balls on cables of 1 m, side by side, with restitution 1; the first is 0.5 rad aside.
Scene newtons_cradle();

}  // namespace pinchlab::experiments::stability
