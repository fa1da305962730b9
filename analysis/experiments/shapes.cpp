// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/shapes.h"

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "analysis/experiments/adapting_nodes.h"
#include "analysis/experiments/hanging_ropes.h"
#include "analysis/experiments/step_cost.h"
#include "demos/scenes/shape_scenes.h"
#include "sim/nodes.h"
#include "sim/step.h"

namespace pinchlab::experiments {

namespace {

using namespace build;  // NOLINT(google-build-using-namespace): scenes by rule

Configuration measured() {
  Configuration configuration = Method::pinch;
  configuration.diagnostics = true;
  return configuration;
}

/// How a run ended.
struct Run {
  World world;
  double energy_made = 0.0;  // J, above the start, at most
  double cost_s = 0.0;       // of processor time, a simulated second
};

Run run(const Scene& scene, double seconds) {
  Run result;
  result.world = make_world(scene, measured());
  Workspace work;
  const int steps =
      static_cast<int>(std::lround(seconds * scene.frames_per_second * scene.steps_per_frame));
  const double before = cpu_seconds();
  double start = 0.0;
  for (int i = 0; i < steps; ++i) {
    if (step(scene, result.world, work) != StepStatus::ok) {
      throw std::runtime_error(result.world.failure);
    }
    const double energy = result.world.diagnostics.energy;
    if (i == 0) start = energy;
    result.energy_made = std::max(result.energy_made, energy - start);
  }
  result.cost_s = (cpu_seconds() - before) / seconds;
  return result;
}

/// A motion at 1, 2, 4 ... steps a frame.
struct Ladder {
  std::string name, against;
  std::vector<int> steps_per_frame;
  std::vector<double> error_m, cost_s;
};

/// Against a known place; or, where `exact` is null, against `finest` steps a frame.
Ladder climb(const std::string& name, const std::function<Scene(int)>& scene, double seconds,
             const Vec2* exact, int finest, int rungs) {
  Ladder ladder;
  ladder.name = name;
  ladder.against = exact != nullptr ? "its solution" : fmt::format("{} steps a frame", finest);
  const Vec2 reference = exact != nullptr ? *exact : run(scene(finest), seconds).world.position[1];
  for (int n = 1; n < 1 << rungs; n *= 2) {
    const Run result = run(scene(n), seconds);
    ladder.steps_per_frame.push_back(n);
    ladder.error_m.push_back((result.world.position[1] - reference).norm());
    ladder.cost_s.push_back(result.cost_s);
  }
  return ladder;
}

std::vector<Ladder> climb_all(bool quick, Progress& progress) {
  const int rungs = quick ? 5 : 8, finest = quick ? 256 : 4096;
  const SquareDrum drum;
  const Vec2 exact = drum.bob_after(1.2);
  const std::vector<Vec2> square = box_corners(0.6, 0.6);
  std::vector<Ladder> ladders;
  ladders.push_back(climb(
      "unwinding from a square", [&](int n) { return drum.scene(n); }, 1.2, &exact, 0, rungs));
  progress.done(1.0);
  ladders.push_back(climb(
      "a square drum turns under a bob", [&](int n) { return turning_drum(square, 2.5, n); }, 1.6,
      nullptr, finest, rungs));
  progress.done(1.0);
  ladders.push_back(
      climb("a disc rolls on a turning plank", disc_on_plank, 0.5, nullptr, finest, rungs));
  ladders.push_back(climb("a box rocks on a disc", box_on_disc, 1.0, nullptr, finest, rungs));
  ladders.push_back(climb("a roller presses a cable that slips on a turning drum of six corners",
                          pressed_drum, 0.6, nullptr, finest, rungs));
  ladders.push_back(climb(
      "a load on a drum in layers", [](int n) { return layered_hoist(8, 0.02, n); }, 1.0, nullptr,
      finest, rungs));
  ladders.push_back(climb(
      "a load on a heavy rope on a drum in layers", [](int n) { return heavy_hoist(n); }, 1.0,
      nullptr, finest, rungs));
  progress.done(1.0);
  const Scene atwood = rope_atwood(1);
  const double k = std::sqrt(0.8 * atwood.gravity.norm() / 4.35);  // 1/s
  const Vec2 fallen = atwood.bodies[1].position - Vec2(0.0, 0.625 * (std::cosh(k) - 1.0));
  ladders.push_back(
      climb("Atwood's machine with a heavy rope", rope_atwood, 1.0, &fallen, 0, rungs));
  const Scene smooth = rope_over_peg(0.0, 1);
  const double rate = std::sqrt(0.8 * smooth.gravity.norm() / 1.8);  // 1/s
  const Vec2 slid = smooth.bodies[1].position - Vec2(0.0, 0.1 * (std::cosh(0.8 * rate) - 1.0));
  ladders.push_back(climb(
      "a heavy rope slides off a smooth peg", [](int n) { return rope_over_peg(0.0, n); }, 0.8,
      &slid, 0, rungs));
  ladders.push_back(climb(
      "a heavy rope slides off a rough peg", [](int n) { return rope_over_peg(0.02, n); }, 0.8,
      nullptr, finest, rungs));
  ladders.push_back(
      climb("a tackle with a heavy rope swings", heavy_tackle, 0.4, nullptr, finest, rungs));
  progress.done(1.0);
  return ladders;
}

std::string ladder_table(const std::vector<Ladder>& ladders) {
  std::vector<std::vector<std::string>> rows;
  for (const Ladder& ladder : ladders) {
    for (std::size_t i = 0; i < ladder.error_m.size(); ++i) {
      const double order = i == 0 ? 0.0 : std::log2(ladder.error_m[i - 1] / ladder.error_m[i]);
      rows.push_back({i == 0 ? ladder.name : "", i == 0 ? ladder.against : "",
                      fmt::format("{}", ladder.steps_per_frame[i]),
                      fmt::format("{:.2e}", ladder.error_m[i]),
                      i == 0 ? "" : fmt::format("{:.2f}", order), time_text(ladder.cost_s[i])});
    }
  }
  return markdown_table(
      {"motion", "against", "steps a frame", "error, m", "order", "a second costs"}, rows);
}

struct Polygon {
  int corners = 0;
  double error_m = 0.0;
};

/// How far the bob of a polygon's drum is from that of its disc after a second.
std::vector<Polygon> compare_polygons() {
  const Vec2 round = run(turning_drum(0.5, 0.0, 16), 1.0).world.position[1];
  std::vector<Polygon> polygons;
  for (const int corners : {8, 16, 32, 64}) {
    const Scene scene =
        turning_drum(regular_corners(corners, 0.5, std::numbers::pi / corners), 0.0, 16);
    polygons.push_back({corners, (run(scene, 1.0).world.position[1] - round).norm()});
  }
  return polygons;
}

struct Hanging {
  int pieces = 0, steps_per_frame = 0;
  double sag_m = 0.0, end_tension = 0.0;  // m; of rho g
  double cost_s = 0.0, energy_made = 0.0;
};

/// After a second, from rest; of as many pieces as the program chooses, for 0.
Hanging hang(int pieces, int steps_per_frame) {
  Scene scene = catenary(pieces, steps_per_frame);
  const std::vector<NodedCable> made = spread_nodes(scene);
  const Run result = run(scene, 1.0);
  Hanging hanging;
  hanging.pieces = made[0].bodies + 1;
  hanging.steps_per_frame = steps_per_frame;
  for (const Vec2& position : result.world.position) {
    hanging.sag_m = std::max(hanging.sag_m, -position.y());
  }
  const double half_piece =
      1.0 / hanging.pieces;  // m: the support holds the first one's upper half
  const Segment& first = result.world.cables[0].segments[1];
  const Vec2 pull = -first.tension * first.direction - half_piece * scene.gravity;  // 1 kg/m
  hanging.end_tension = pull.norm() / scene.gravity.norm();
  hanging.cost_s = result.cost_s;
  hanging.energy_made = result.energy_made;
  return hanging;
}

struct Fall {
  int pieces = 0;
  double time = 0.0;         // of sqrt(2 L / g)
  double energy_made = 0.0;  // J, of 4.9 at play
};

Fall fall(int pieces, int steps_per_frame) {
  const Scene scene = folded_chain(pieces, steps_per_frame);
  World world = make_world(scene, measured());
  Workspace work;
  Fall result;
  result.pieces = pieces;
  double start = 0.0;
  for (int i = 0; world.step < 2 || world.velocity[0].y() < 0.0; ++i) {
    if (step(scene, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
    if (world.time() > 2.0) throw std::runtime_error("a folded chain does not stop falling");
    if (i == 0) start = world.diagnostics.energy;
    result.energy_made = std::max(result.energy_made, world.diagnostics.energy - start);
  }
  result.time = world.time() / std::sqrt(2.0 / scene.gravity.norm());
  return result;
}

/// The least that a step of a chain of so many nodes can consist of: tangents, a tridiagonal
/// matrix, its elimination, speeds.
double bare_seconds(const Scene& scene, const World& world, const Effort& effort) {
  const std::size_t rows = world.cables.size();
  std::vector<Vec2> x, v(rows + 1, Vec2::Zero()), e(rows, Vec2::Zero());
  std::vector<double> inverse(rows + 1, 0.0), upper(rows), impulse(rows), diagonal(rows);
  x.push_back(scene.cables[0].start.point);
  for (std::size_t i = 0; i + 1 < rows; ++i) {
    x.push_back(world.position[i]);
    inverse[i + 1] = 1.0 / scene.bodies[i].mass;
  }
  x.push_back(scene.cables[rows - 1].end.point);
  const double length = world.cables[0].length, h = world.step_length;
  const auto pass = [&] {
    for (std::size_t i = 0; i < rows; ++i) {
      const Vec2 d = x[i + 1] - x[i];
      const double norm = d.norm();
      e[i] = d / norm;
      impulse[i] = (norm - length) / h + e[i].dot(v[i + 1] - v[i]);
      diagonal[i] = inverse[i] + inverse[i + 1];
    }
    for (std::size_t i = 1; i < rows; ++i) {
      upper[i - 1] = -inverse[i] * e[i - 1].dot(e[i]);
      const double factor = upper[i - 1] / diagonal[i - 1];
      diagonal[i] -= factor * upper[i - 1];
      impulse[i] -= factor * impulse[i - 1];
    }
    impulse[rows - 1] /= diagonal[rows - 1];
    for (std::size_t i = rows - 1; i > 0; --i) {
      impulse[i - 1] = (impulse[i - 1] - upper[i - 1] * impulse[i]) / diagonal[i - 1];
    }
    for (std::size_t i = 0; i < rows; ++i) {
      v[i] += 1e-6 * inverse[i] * impulse[i] * e[i];  // so little that it does not run away
      v[i + 1] -= 1e-6 * inverse[i + 1] * impulse[i] * e[i];
    }
  };
  return measure_call(pass, effort).seconds.median;
}

struct ChainCost {
  double step_s = 0.0, bare_s = 0.0;
};

/// Of a chain of 100 nodes that swings with all its pieces turning.
ChainCost cost_of_chain(const Effort& effort) {
  Scene scene = catenary(101, 4);
  spread_nodes(scene);
  for (Body& body : scene.bodies) body.velocity = Vec2(0.5, 0.0);
  World world = make_world(scene, Method::pinch);
  Workspace work;
  ChainCost cost;
  cost.step_s = measure_steps(scene, world, work, effort).step_s.median;
  cost.bare_s = bare_seconds(scene, world, effort);
  return cost;
}

/// A flexible pendulum's tip after a second.
struct Pendulum {
  int pieces = 0, steps_per_frame = 0;
  Vec2 tip = Vec2::Zero();
  double cost_s = 0.0;
};

Pendulum swing_flexibly(int pieces, int steps_per_frame) {
  const Run result = run(flexible_pendulum(pieces, steps_per_frame), 1.0);
  return {pieces, steps_per_frame, result.world.position[0], result.cost_s};
}

struct Creep {
  int steps_per_frame = 0;
  double taut = 0.0, slack = 0.0;  // N
  double loss = 0.0, known = 0.0;  // of the rim's speed; by the ratio of strains
};

/// Over a second, after eleven.
Creep creep(int steps_per_frame) {
  constexpr double radius = 0.35;
  const Scene scene = belt_drive(radius, 150.0, 101.0, steps_per_frame);
  const World before = run(scene, 11.0).world;
  World world = before;
  Workspace work;
  const int steps = scene.frames_per_second * steps_per_frame;
  Creep result;
  result.steps_per_frame = steps_per_frame;
  for (int i = 0; i < steps; ++i) {
    if (step(scene, world, work) != StepStatus::ok) throw std::runtime_error(world.failure);
    const std::vector<Segment>& spans = world.cables[0].segments;
    result.taut += std::max(spans[0].tension, spans[1].tension) / steps;
    result.slack += std::min(spans[0].tension, spans[1].tension) / steps;
  }
  const double driver = (world.angle[0] - before.angle[0]) * (0.2 + belt_half_width);
  const double driven = (world.angle[1] - before.angle[1]) * (radius + belt_half_width);
  result.loss = 1.0 - driven / driver;
  result.known = 1.0 - (1.0 + result.slack / belt_stiffness) / (1.0 + result.taut / belt_stiffness);
  return result;
}

struct Shapes {
  std::vector<Ladder> ladders;
  std::vector<Polygon> polygons;
  std::vector<Hanging> hanging;
  std::vector<Fall> falls;
  AdaptingNodes adapting;
  std::vector<HangingRope> ropes;
  std::vector<Pendulum> pendulums;
  std::vector<Creep> creeps;
  ChainCost cost;
};

Csv csv_of(const Shapes& shapes) {
  Csv csv({"case", "size", "measured", "value"});
  for (const Ladder& ladder : shapes.ladders) {
    for (std::size_t i = 0; i < ladder.error_m.size(); ++i) {
      const std::int64_t n = ladder.steps_per_frame[i];
      csv.row({ladder.name, n, std::string("error_m"), ladder.error_m[i]});
      csv.row({ladder.name, n, std::string("cost_s"), ladder.cost_s[i]});
    }
  }
  for (const Polygon& p : shapes.polygons) {
    csv.row({std::string("polygon against disc"), std::int64_t{p.corners}, std::string("error_m"),
             p.error_m});
  }
  for (const Hanging& h : shapes.hanging) {
    csv.row({std::string("catenary"), std::int64_t{h.pieces}, std::string("sag_m"), h.sag_m});
    csv.row({std::string("catenary"), std::int64_t{h.pieces}, std::string("end_tension_rho_g"),
             h.end_tension});
  }
  for (const Fall& f : shapes.falls) {
    csv.row(
        {std::string("folded chain"), std::int64_t{f.pieces}, std::string("fall_time"), f.time});
    csv.row({std::string("folded chain"), std::int64_t{f.pieces}, std::string("energy_made_j"),
             f.energy_made});
  }
  add_rows(shapes.adapting, csv);
  add_rows(shapes.ropes, csv);
  for (const Pendulum& p : shapes.pendulums) {
    csv.row({std::string("flexible pendulum"), std::int64_t{p.pieces}, std::string("tip_x_m"),
             p.tip.x()});
    csv.row({std::string("flexible pendulum"), std::int64_t{p.pieces}, std::string("tip_y_m"),
             p.tip.y()});
  }
  for (const Creep& c : shapes.creeps) {
    csv.row({std::string("belt drive"), std::int64_t{c.steps_per_frame}, std::string("speed_lost"),
             c.loss});
    csv.row({std::string("belt drive"), std::int64_t{c.steps_per_frame}, std::string("error"),
             std::abs(c.loss - c.known)});
  }
  csv.row({std::string("100 nodes"), std::int64_t{100}, std::string("step_s"), shapes.cost.step_s});
  csv.row({std::string("100 nodes"), std::int64_t{100}, std::string("bare_pass_s"),
           shapes.cost.bare_s});
  return csv;
}

using Table = std::vector<std::vector<std::string>>;

std::string polygon_table(const std::vector<Polygon>& polygons) {
  Table rows;
  for (const Polygon& p : polygons) {
    rows.push_back({fmt::format("{}", p.corners), fmt::format("{:.2e}", p.error_m),
                    fmt::format("{:.2f}", p.error_m * p.corners * p.corners)});
  }
  return markdown_table({"corners n", "distance, m", "distance × n²"}, rows);
}

std::string hanging_table(const std::vector<Hanging>& hanging) {
  Table rows;
  for (const Hanging& h : hanging) {
    rows.push_back({fmt::format("{}", h.pieces), fmt::format("{}", h.steps_per_frame),
                    fmt::format("{:.7f}", h.sag_m), fmt::format("{:+.1e}", h.sag_m - 0.7963884),
                    fmt::format("{:.7f}", h.end_tension), time_text(h.cost_s)});
  }
  rows.push_back({"the catenary", "", "0.7963884", "", "1.0260286", ""});
  return markdown_table({"pieces", "steps a frame", "sag, m", "error, m",
                         "tension at the end, of rho g", "a second costs"},
                        rows);
}

std::string fall_table(const std::vector<Fall>& falls) {
  Table rows;
  for (const Fall& f : falls) {
    rows.push_back({fmt::format("{}", f.pieces), fmt::format("{:.5f}", f.time),
                    fmt::format("{:.2f}", (f.time - 0.847213) * f.pieces),
                    fmt::format("{:.1e}", f.energy_made)});
  }
  return markdown_table(
      {"pieces N", "time, of sqrt(2 L / g)", "(time - 0.847213) N", "energy made, J"}, rows);
}

std::string pendulum_table(const std::vector<Pendulum>& pendulums) {
  Table rows;
  for (const Pendulum& p : pendulums) {
    rows.push_back({fmt::format("{}", p.pieces), fmt::format("{}", p.steps_per_frame),
                    fmt::format("{:.6f}", p.tip.x()), fmt::format("{:.6f}", p.tip.y()),
                    time_text(p.cost_s)});
  }
  rows.push_back({"finite elements", "", "-0.994295", "0.037633", ""});
  return markdown_table({"pieces", "steps a frame", "x, m", "y, m", "a second costs"}, rows);
}

std::string creep_table(const std::vector<Creep>& creeps) {
  Table rows;
  for (const Creep& c : creeps) {
    rows.push_back({fmt::format("{}", c.steps_per_frame), fmt::format("{:.3f}", c.taut),
                    fmt::format("{:.3f}", c.slack), fmt::format("{:.7f} %", 100.0 * c.loss),
                    fmt::format("{:.1e}", std::abs(c.loss - c.known))});
  }
  return markdown_table({"steps a frame", "T1, N", "T2, N", "speed lost", "error of the loss"},
                        rows);
}

std::string page_text(const Shapes& shapes) {
  const auto& [ladders, polygons, hanging, falls, adapting, ropes, pendulums, creeps, cost] =
      shapes;
  return fmt::format(
      "# Corners, layers, cables with mass\n\n"
      "What bodies and cables of more than discs and massless lines come to, against solutions of "
      "other kinds "
      "(demos/scenes/shape_scenes.h has the scenes; sim/README.md the models).\n\n"
      "## Order\n\nLargest steps first. A corner that the cable or the roller comes to is an event "
      "at its time, and so is where what slides comes to rest; where in its step friction "
      "begins to slip changes the roller's error somewhat.\n\n{}\n"
      "## A polygon of n corners against its disc\n\n"
      "Both with the same inertia, a bob hanging from each; distance of the bobs after a "
      "second.\n\n{}\n"
      "## A cable that hangs\n\n2 m and 1 kg/m between supports 1 m apart, started where its chain "
      "is at rest; after a second. "
      "Three numbers of pieces that are asked for, and those that the program chooses at 4, 8 and "
      "16 steps a frame.\n\n{}\n"
      "## A folded chain's fall\n\nBoth ends of a chain of 1 m are held up, one is let go: the "
      "time until that end turns, "
      "at 64 steps a frame. If no energy is lost it is 0.847213 (Calkin & March 1989, Am. J. Phys. "
      "57:154), less than the "
      "1 of a free fall.\n\n{}\n"
      "{}{}"
      "## A flexible pendulum\n\n1 m, 0.393 kg/m, EA = 1571 N, EI = 0.2 N m^2, pinned and let go "
      "horizontally: its tip "
      "after a second, beside the authors' own (Westin and Irani's code, ten finite elements). As "
      "many steps as the "
      "bending of so many pieces asks for.\n\n{}\n"
      "## A belt that creeps\n\nA belt of EA = 10 kN between a driven pulley and one that is "
      "braked: the rim of the driven one loses 1 - (1 + T2 / EA) / (1 + T1 / EA) of its speed, "
      "since each "
      "rim carries over what it has taken with the strain that it had there.\n\n{}\n"
      "## Cost\n\nA step of a swinging cable of 100 nodes: {}, {:.1f} times the {} of a bare pass "
      "(directions, a "
      "tridiagonal matrix, its elimination, speeds; nothing else).\n",
      ladder_table(ladders), polygon_table(polygons), hanging_table(hanging), fall_table(falls),
      adapting_text(adapting), hanging_ropes_text(ropes), pendulum_table(pendulums),
      creep_table(creeps), time_text(cost.step_s), cost.step_s / cost.bare_s,
      time_text(cost.bare_s));
}

Shapes measure_shapes(const Options& options, Progress& progress) {
  Shapes shapes;
  shapes.ladders = climb_all(options.quick, progress);
  shapes.polygons = compare_polygons();
  progress.done(1.0);
  for (const int pieces : {20, 50, 100}) shapes.hanging.push_back(hang(pieces, 4));
  for (const int steps : {4, 8, 16}) shapes.hanging.push_back(hang(0, steps));
  progress.done(1.0);
  for (const int pieces : {20, 50, 100}) shapes.falls.push_back(fall(pieces, 64));
  shapes.adapting = measure_adapting_nodes();
  progress.done(1.0);
  shapes.ropes = measure_hanging_ropes();
  progress.done(1.0);
  for (const auto& [pieces, n] : {std::pair(20, 16), std::pair(40, 64), std::pair(80, 192)}) {
    shapes.pendulums.push_back(swing_flexibly(pieces, n));
  }
  progress.done(1.0);
  for (const int n : {1, 4, 16}) shapes.creeps.push_back(creep(n));
  progress.done(1.0);
  shapes.cost = cost_of_chain(effort_of(options));
  progress.done(1.0);
  return shapes;
}

}  // namespace

void run_shapes(const Options& options) {
  Output output(options.out);
  Progress progress("shapes", 12.0);
  const Shapes shapes = measure_shapes(options, progress);
  output.csv("shapes", csv_of(shapes), options.command);
  output.page("shapes", page_text(shapes), options.command);
  fmt::print("{}: corners, layers and cables with mass against known solutions\n",
             (options.out / "shapes.md").string());
}

}  // namespace pinchlab::experiments
