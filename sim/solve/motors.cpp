// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/motors.h"

#include <algorithm>
#include <cmath>

namespace pinchlab {

namespace {

// Of a torque, or an angular velocity: far above round-off of sums of rows, and no motor's table
// tells so little apart.
constexpr double rounding = 1e-9;
// Of a rim's speed: far above round-off, far below its share.
constexpr double contradicting = 1e-6;

/// Angular impulse of the rows on a body (N m s).
double impulse_of_rows(const PartSystem& s, int place) {
  double sum = 0.0;
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    const RowBodies& bodies = s.bodies[r];
    if (bodies.a == place) sum += s.rows[r].impulse * bodies.ja.z();
    if (bodies.b == place) sum += s.rows[r].impulse * bodies.jb.z();
  }
  for (const ThirdBody& third : s.thirds) {
    if (third.place == place) sum += at(s.rows, third.row).impulse * third.j.z();
  }
  return sum;
}

/// How fast inextensible cables of the part are being stretched at most (m/s).
double stretching(const PartSystem& s, const SolveScratch& set) {
  const CapstanScratch& capstan = set.capstan;
  double most = 0.0;
  for (int r = 0; r < s.first_contact_row; ++r) {
    const Row& row = at(s.rows, r);
    if (row.kind != RowKind::segment || row.idle || row.compliance > 0.0) continue;
    const bool grouped = !capstan.runs.empty() && capstan.group_of_row[index(r)] >= 0;
    if (!grouped) most = std::max(most, -row.speed);
  }
  if (capstan.runs.empty()) return most;
  for (const Group& group : capstan.groups) {
    const Shortage shortage = shortage_of(group, s, capstan);
    if (shortage.clearance <= set.reach) most = std::max(most, shortage.speed);
  }
  return most;
}

/// The speed that all of the part's moving bodies would have with the energy of motion that rows
/// have given them (m/s); what they have taken counts against it.
double speed_given(const World& world, std::span<const int> bodies, const PartSystem& s) {
  double energy = 0.0, mass = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyProperties& body = at(world.bodies, bodies[i]);
    if (!can_move(body)) continue;
    energy += body.mass *
              (s.velocity[i].head<2>().squaredNorm() - s.unconstrained[i].head<2>().squaredNorm());
    mass += body.mass;
  }
  return energy > 0.0 ? std::sqrt(energy / mass) : 0.0;
}

/// Lets motors without a limit stall where all else that could give is a cable's stretch, or a body
/// that it would throw; whether any has changed. One whose stalling leaves most of the stretch has
/// nothing to do with it, and insists.
bool stall(const World& world, const Parts& parts, const Part& part, PartSystem& s,
           const SolveScratch& set) {
  constexpr double most = 0.5;
  const std::span<const int> bodies = bodies_of(parts, part);
  bool changed = false;
  for (Motor& motor : s.motors) {
    const double rim = std::abs(motor.speed) * at(world.bodies, bodies[index(motor.place)]).radius;
    if (motor.most < infinity || rim == 0.0 || motor.state == MotorState::insists) continue;
    const double stretched = stretching(s, set);
    if (motor.state == MotorState::stalls) {
      if (motor.threw || stretched <= contradicting * rim || stretched < most * motor.stretched) {
        continue;  // it has helped, or insisting would throw again
      }
      motor.state = MotorState::insists;
    } else {
      motor.threw = speed_given(world, bodies, s) > thrown * rim;
      if (!motor.threw && stretched <= contradicting * rim) continue;
      motor.stretched = stretched;
      motor.state = MotorState::stalls;
    }
    changed = true;
  }
  return changed;
}

/// One without a limit.
Motor& append_motor(const BodyProperties& body, int place, double speed, double before,
                    PartSystem& s) {
  Motor& motor = s.motors.emplace_back();
  motor.place = place;
  motor.speed = speed;
  motor.before = before;
  motor.inertia = inertia_of(body);
  motor.moves = can_move(body);
  motor.most = infinity;
  return motor;
}

}  // namespace

void add_motor(const BodyProperties& body, int place, double speed, double before, double kick,
               PartSystem& s) {
  const bool limited = body.torque_limit < infinity;
  Motor& motor = append_motor(body, place, kick > 0.0 || limited ? speed : before, before, s);
  if (limited) motor.most = kick * body.torque_limit;
  find_first_state(motor);
}

void add_stalled_motor(const BodyProperties& body, int place, double before, PartSystem& s) {
  append_motor(body, place, before, before, s).state = MotorState::stalls;
}

void find_first_state(Motor& motor) {
  if (motor.state == MotorState::stalls) return;
  const double needed = motor.inertia * (motor.speed - motor.before);
  const bool gives = std::abs(needed) > motor.most || motor.most == 0.0;
  motor.state = !gives         ? MotorState::holds
                : needed > 0.0 ? MotorState::forward
                               : MotorState::backward;
}

void drive(PartSystem& s) {
  for (const Motor& motor : s.motors) {
    const bool holds = motor.state == MotorState::holds || motor.state == MotorState::insists;
    double& mobility = at(s.mobility, motor.place).angular;
    double& free = at(s.free_velocity, motor.place).z();
    const double before = mobility;
    mobility = holds ? 0.0 : 1.0 / motor.inertia;
    at(s.mobile, motor.place) = motor.moves || !holds;
    s.mobility_changed = s.mobility_changed || mobility != before;
    free = motor.speed;
    if (motor.state == MotorState::forward) free = motor.before + motor.most / motor.inertia;
    if (motor.state == MotorState::backward) free = motor.before - motor.most / motor.inertia;
  }
}

bool change_limited_motors(PartSystem& s) {
  bool changed = false;
  for (Motor& motor : s.motors) {
    if (motor.most == 0.0 || motor.most == infinity) continue;
    const double turning = at(s.velocity, motor.place).z();
    const double least = rounding * std::max(std::abs(motor.speed), std::abs(motor.before));
    MotorState next = motor.state;
    if (motor.state != MotorState::holds) {
      const double faster =
          motor.state == MotorState::forward ? turning - motor.speed : motor.speed - turning;
      if (faster > least) next = MotorState::holds;
    } else {
      const double given =
          motor.inertia * (motor.speed - motor.before) - impulse_of_rows(s, motor.place);
      if (std::abs(given) > motor.most * (1.0 + rounding)) {
        next = given > 0.0 ? MotorState::forward : MotorState::backward;
      }
    }
    changed = changed || next != motor.state;
    motor.state = next;
  }
  return changed;
}

bool stall_all(PartSystem& s) {
  bool any = false;
  for (Motor& motor : s.motors) {
    if (motor.state != MotorState::holds && motor.state != MotorState::insists) continue;
    motor.state = MotorState::stalls;
    any = true;
  }
  if (any) drive(s);
  return any;
}

bool change_motors(const World& world, const Parts& parts, const Part& part, PartSystem& s,
                   const SolveScratch& set) {
  const bool changed = change_limited_motors(s);
  // What sweeps leave of a row is no contradiction.
  const bool direct = world.configuration.solver == Solver::direct;
  return (direct && stall(world, parts, part, s, set)) || changed;
}

}  // namespace pinchlab
