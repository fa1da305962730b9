// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/motors.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "sim/trees.h"

namespace pinchlab {

namespace {

// Of a torque, or an angular velocity: far above round-off of sums of rows, and no motor's table
// tells so little apart.
constexpr double rounding = 1e-9;
// Of a rim's or a motor's speed: far above round-off, far below its share.
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

/// Joins a part's rows, and the places after them, to sets that hang together: by rows that bear
/// force, or would have to, on what can move, and by cables that slide over what cannot.
void join_rows(const PartSystem& s, SolveScratch& set) {
  const int rows = static_cast<int>(s.rows.size());
  std::vector<int>& root = set.root_of_row;
  root.resize(s.rows.size() + s.mobility.size());
  std::iota(root.begin(), root.end(), 0);
  const auto joins = [&s](int r) {
    const Row& row = at(s.rows, r);
    return !row.idle && (row.on || row.impulse != 0.0 || row.speed < 0.0);
  };
  const auto join_to = [&](int r, int place) {
    if (joins(r) && at(s.mobile, place)) join(root, r, rows + place);
  };
  for (int r = 0; r < rows; ++r) {
    join_to(r, at(s.bodies, r).a);
    join_to(r, at(s.bodies, r).b);
  }
  for (const ThirdBody& third : s.thirds) join_to(third.row, third.place);
  if (set.capstan.runs.empty()) return;
  for (const Group& group : set.capstan.groups) {
    for (int m = group.begin + 1; m < group.end; ++m) {
      join(root, at(set.capstan.members, m), at(set.capstan.members, m - 1));
    }
  }
}

/// Marks, of what join_rows has joined, the sets that pull at a body.
void find_pulling(const PartSystem& s, int place, SolveScratch& set) {
  std::vector<int>& root = set.root_of_row;
  std::vector<char>& pulling = set.pulling;
  pulling.assign(root.size(), 0);
  const auto mark = [&](std::size_t r) { at(pulling, find_root(root, static_cast<int>(r))) = 1; };
  for (std::size_t r = 0; r < s.rows.size(); ++r) {
    if (s.bodies[r].a == place || s.bodies[r].b == place) mark(r);
  }
  for (const ThirdBody& third : s.thirds) {
    if (third.place == place) mark(index(third.row));
  }
  for (std::size_t i = 0; i < root.size(); ++i) {
    pulling[i] = at(pulling, find_root(root, static_cast<int>(i)));
  }
}

/// How fast inextensible cables of the part are being stretched at most (m/s), by rows that count.
template <class Counts>
double stretching(const PartSystem& s, const SolveScratch& set, Counts counts) {
  const CapstanScratch& capstan = set.capstan;
  double most = 0.0;
  for (int r = 0; r < s.first_contact_row; ++r) {
    const Row& row = at(s.rows, r);
    if (row.kind != RowKind::segment || row.idle || row.compliance > 0.0 || !counts(r)) continue;
    const bool grouped = !capstan.runs.empty() && capstan.group_of_row[index(r)] >= 0;
    if (!grouped) most = std::max(most, -row.speed);
  }
  if (capstan.runs.empty()) return most;
  for (const Group& group : capstan.groups) {
    if (!counts(at(capstan.members, group.begin))) continue;
    const Shortage shortage = shortage_of(group, s, capstan);
    if (may_bear(group, shortage, s, set)) most = std::max(most, shortage.speed);
  }
  return most;
}

/// The speed that all of the part's moving bodies that count would have with the energy of motion
/// that rows have given them (m/s); what they have taken counts against it.
template <class Counts>
double speed_given(const World& world, std::span<const int> bodies, const PartSystem& s,
                   Counts counts) {
  double energy = 0.0, mass = 0.0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyProperties& body = at(world.bodies, bodies[i]);
    if (!can_move(body) || !counts(static_cast<int>(i))) continue;
    energy += body.mass *
              (s.velocity[i].head<2>().squaredNorm() - s.unconstrained[i].head<2>().squaredNorm());
    mass += body.mass;
  }
  return energy > 0.0 ? std::sqrt(energy / mass) : 0.0;
}

/// Lets motors without a limit stall where all else that could give is a stretch of the cables that
/// pull at their bodies, or a body there that they would throw; whether any has changed. One whose
/// stalling leaves most of the stretch has nothing to do with it, and insists.
bool stall(const World& world, const Parts& parts, const Part& part, PartSystem& s,
           SolveScratch& set) {
  constexpr double most = 0.5;
  const std::span<const int> bodies = bodies_of(parts, part);
  const auto all = [](int) { return true; };
  const double any_stretched = stretching(s, set, all);
  const double any_given = speed_given(world, bodies, s, all);
  bool changed = false, joined = false;
  for (Motor& motor : s.motors) {
    const double rim = std::abs(motor.speed) * at(world.bodies, bodies[index(motor.place)]).radius;
    if (motor.most < infinity || motor.pauses || rim == 0.0) continue;
    if (motor.state == MotorState::insists || motor.state == MotorState::keeps) continue;
    if (any_stretched <= contradicting * rim && any_given <= thrown * rim) continue;
    if (!joined) join_rows(s, set);
    joined = true;
    find_pulling(s, motor.place, set);
    const auto of_row = [&set](int r) { return at(set.pulling, r) != 0; };
    const auto of_place = [&](int place) { return set.pulling[s.rows.size() + index(place)] != 0; };
    const double stretched = stretching(s, set, of_row);
    if (motor.state == MotorState::stalls) {
      if (motor.threw || stretched <= contradicting * rim || stretched < most * motor.stretched) {
        continue;  // it has helped, or insisting would throw again
      }
      motor.state = MotorState::insists;
    } else {
      motor.threw =
          any_given > thrown * rim && speed_given(world, bodies, s, of_place) > thrown * rim;
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
  motor.kept = (speed - before) * before > 0.0 ? 0.0 : before;
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

void add_stalled_motor(const BodyProperties& body, int place, double speed, double before,
                       PartSystem& s) {
  Motor& motor = append_motor(body, place, speed, before, s);
  motor.pauses = true;
  motor.state = MotorState::stalls;
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
    const bool keeps = motor.state == MotorState::keeps;
    const bool holds =
        keeps || motor.state == MotorState::holds || motor.state == MotorState::insists;
    double& mobility = at(s.mobility, motor.place).angular;
    double& free = at(s.free_velocity, motor.place).z();
    const double before = mobility;
    mobility = holds ? 0.0 : 1.0 / motor.inertia;
    at(s.mobile, motor.place) = motor.moves || !holds;
    s.mobility_changed = s.mobility_changed || mobility != before;
    free = keeps ? motor.kept : motor.pauses ? motor.before : motor.speed;
    if (motor.state == MotorState::forward) free = motor.before + motor.most / motor.inertia;
    if (motor.state == MotorState::backward) free = motor.before - motor.most / motor.inertia;
  }
}

namespace {

/// What one without a limit is to do that has stalled.
MotorState next_of_stalled(const PartSystem& s, const Motor& motor) {
  const double lacks = motor.speed - motor.kept, least = contradicting * lacks * lacks;
  if (motor.state == MotorState::stalls) {
    const double gained = at(s.velocity, motor.place).z() - motor.kept;
    return gained * lacks < -least ? MotorState::keeps : MotorState::stalls;
  }
  const double given =
      motor.inertia * (motor.kept - motor.before) - impulse_of_rows(s, motor.place);
  return given * lacks < -motor.inertia * least ? MotorState::stalls : MotorState::keeps;
}

}  // namespace

bool change_limited_motors(PartSystem& s) {
  bool changed = false;
  for (Motor& motor : s.motors) {
    if (motor.state == MotorState::stalls || motor.state == MotorState::keeps) {
      const MotorState next = next_of_stalled(s, motor);
      changed = changed || next != motor.state;
      motor.state = next;
      continue;
    }
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
                   SolveScratch& set) {
  const bool changed = change_limited_motors(s);
  // What sweeps leave of a row is no contradiction.
  const bool direct = world.configuration.solver == Solver::direct;
  return (direct && stall(world, parts, part, s, set)) || changed;
}

}  // namespace pinchlab
