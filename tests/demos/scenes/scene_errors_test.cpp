// SPDX-License-Identifier: GPL-3.0-or-later
// Every way in which a scene file can be wrong, with the exact message that its author gets.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "demos/scenes/scene_format.h"
#include "demos/scenes/scene_json.h"
#include "tests/base/temporary_folder.h"
#include "tests/demos/scenes/scene_files.h"

namespace pinchlab {
namespace {

using nlohmann::json;

// A change to the small scene: a JSON pointer, and what to put there ("-" at the end appends; a
// discarded value removes).
struct BadScene {
  const char* pointer;
  const char* value;  // JSON; nullptr removes
  const char* message;
};

const BadScene bad_scenes[] = {
    // Keys
    {"/titel", R"("x")", "s.json: /titel: unknown key (did you mean title?)"},
    {"/duration", "2", "s.json: /duration: unknown key (did you mean duration_s?)"},
    {"/cables/0/half_widht_m", "0.1",
     "s.json: /cables/0/half_widht_m: unknown key (did you mean half_width_m?)"},
    {"/bodies/1/radius", "1", "s.json: /bodies/1/radius: unknown key (did you mean radius_m?)"},
    {"/bodies/1/colour", "1",
     "s.json: /bodies/1/colour: unknown key (known here: name, kind, radius_m, corners_m, "
     "corner_radius_m, shapes, mass_kg, density_kg_m2, "
     "inertia_kg_m2, "
     "position_m, angle_rad, velocity_m_s, angular_velocity_rad_s, rail_axis, travel_m, "
     "driven_angular_velocity_rad_s, torque_n_m, motor, torque_limit_n_m, linear_drag_per_s, "
     "angular_drag_per_s, cable_friction, "
     "contact_friction, restitution, look)"},
    {"/cables/0/wraps/0/orientation", "1",
     "s.json: /cables/0/wraps/0/orientation: unknown key (known here: body, turn, extra_turns)"},
    {"/cables/0/start/point", "[0, 0]",
     "s.json: /cables/0/start/point: unknown key (did you mean point_m?)"},
    {"/view/hihg_m", "[1, 1]", "s.json: /view/hihg_m: unknown key (did you mean high_m?)"},
    {"/baseline/why", R"("x")", "s.json: /baseline/why: unknown key (known here: method, reason)"},
    {"/walls/0/form_m", "[0, 0]", "s.json: /walls/0/form_m: unknown key (did you mean from_m?)"},
    {"/a~1b~0c", "1",
     "s.json: /a~1b~0c: unknown key (known here: $schema, title, notes, gravity_m_s2, bodies, "
     "cables, joints, "
     "walls, duration_s, frames_per_second, steps_per_frame, error_m, poster_time_s, view, "
     "baseline)"},
    // Missing
    {"/title", nullptr, "s.json: title is missing"},
    {"/bodies", nullptr, "s.json: bodies is missing"},
    {"/duration_s", nullptr, "s.json: duration_s is missing"},
    {"/view", nullptr, "s.json: view is missing"},
    {"/view/low_m", nullptr, "s.json: /view: low_m is missing"},
    {"/baseline", nullptr, "s.json: baseline is missing"},
    {"/baseline/reason", nullptr, "s.json: /baseline: reason is missing"},
    {"/bodies/0/name", nullptr, "s.json: /bodies/0: name is missing"},
    {"/bodies/0/kind", nullptr, "s.json: /bodies/0: kind is missing"},
    {"/bodies/0/radius_m", nullptr,
     "s.json: /bodies/0: radius_m is missing (or corners_m, of a polygon)"},
    {"/bodies/0/position_m", nullptr, "s.json: /bodies/0: position_m is missing"},
    {"/bodies/1/mass_kg", nullptr,
     "s.json: /bodies/1: mass_kg is missing (a free body needs one, or density_kg_m2)"},
    {"/cables/0/name", nullptr, "s.json: /cables/0: name is missing"},
    {"/cables/0/half_width_m", nullptr, "s.json: /cables/0: half_width_m is missing"},
    {"/cables/0/start", nullptr,
     "s.json: /cables/0: start is missing (or say \"closed\": true for a loop)"},
    {"/cables/0/wraps/0/body", nullptr, "s.json: /cables/0/wraps/0: body is missing"},
    {"/cables/0/wraps/0/turn", nullptr, "s.json: /cables/0/wraps/0: turn is missing"},
    {"/walls/0/to_m", nullptr, "s.json: /walls/0: to_m is missing"},
    // Types
    {"", "[]", "s.json: must be an object, not a list"},
    {"", "3", "s.json: must be an object, not a number"},
    {"/title", "7", "s.json: /title: must be a string, not a number"},
    {"/bodies", "{}", "s.json: /bodies: must be a list, not an object"},
    {"/bodies/0", "null", "s.json: /bodies/0: must be an object, not null"},
    {"/bodies/0/name", "[]", "s.json: /bodies/0/name: must be a string, not a list"},
    {"/bodies/0/kind", "1",
     "s.json: /bodies/0/kind: must be free, rail, fixed_axle or fixed, not a number"},
    {"/bodies/0/radius_m", R"("0.5")",
     "s.json: /bodies/0/radius_m: must be a number, not a string"},
    {"/bodies/0/radius_m", "true", "s.json: /bodies/0/radius_m: must be a number, not a boolean"},
    {"/bodies/0/position_m", "[0, 0, 0]",
     "s.json: /bodies/0/position_m: must be a list of two numbers, [x, y]"},
    {"/bodies/0/position_m", R"([0, "a"])",
     "s.json: /bodies/0/position_m: must be a list of two numbers, [x, y]"},
    {"/bodies/0/position_m", R"({"x": 0, "y": 0})",
     "s.json: /bodies/0/position_m: must be a list of two numbers, [x, y]"},
    {"/bodies/0/cable_friction", R"("none")",
     "s.json: /bodies/0/cable_friction: must be 0 to 100 or \"no_slip\", not \"none\""},
    {"/cables/0/closed", "1", "s.json: /cables/0/closed: must be true or false, not a number"},
    {"/cables/0/start", R"("left weight")",
     "s.json: /cables/0/start: must be an object, not a string"},
    {"/cables/0/wraps", "null", "s.json: /cables/0/wraps: must be a list, not null"},
    {"/cables/0/wraps/0/extra_turns", "1.5",
     "s.json: /cables/0/wraps/0/extra_turns: must be a whole number, not 1.5"},
    {"/frames_per_second", R"("60")",
     "s.json: /frames_per_second: must be a whole number, not a string"},
    {"/frames_per_second", "59.94",
     "s.json: /frames_per_second: must be a whole number, not 59.94"},
    // Ranges
    {"/title", R"("")", "s.json: /title: must be 1 to 80 characters long, not 0"},
    {"/title", R"("two\nlines")", "s.json: /title: must be one line without control characters"},
    {"/title", R"("\u0000")", "s.json: /title: must be one line without control characters"},
    {"/bodies/0/name", R"("a\u007f")",
     "s.json: /bodies/0/name: must be one line without control characters"},
    {"/bodies/0/name", R"("\u009b31m")",
     "s.json: /bodies/0/name: must be one line without control characters"},
    {"/bodies", "[]", "s.json: /bodies: must have 1 to 10000 entries, not 0"},
    {"/bodies/0/name", R"("a,b")",
     "s.json: /bodies/0/name: a name must have no comma, no quote and no space at its ends"},
    {"/bodies/0/name", R"(" a")",
     "s.json: /bodies/0/name: a name must have no comma, no quote and no space at its ends"},
    {"/bodies/0/kind", R"("rial")",
     "s.json: /bodies/0/kind: must be free, rail, fixed_axle or fixed, not \"rial\" (did you mean "
     "rail?)"},
    {"/bodies/0/radius_m", "0", "s.json: /bodies/0/radius_m: must be 1e-06 to 10000, not 0"},
    {"/bodies/0/radius_m", "1e5",
     "s.json: /bodies/0/radius_m: must be 1e-06 to 10000, not 100000.0"},
    {"/bodies/0/mass_kg", "-1", "s.json: /bodies/0/mass_kg: must be 1e-09 to 1e+12, not -1"},
    {"/bodies/0/mass_kg", "0", "s.json: /bodies/0/mass_kg: must be 1e-09 to 1e+12, not 0"},
    {"/bodies/0/inertia_kg_m2", "-0.1",
     "s.json: /bodies/0/inertia_kg_m2: must be 1e-18 to 1e+20, not -0.1"},
    {"/bodies/0/position_m", "[0, 1e300]",
     "s.json: /bodies/0/position_m/1: must be -1e+06 to 1e+06, not 1e+300"},
    {"/bodies/0/linear_drag_per_s", "-1",
     "s.json: /bodies/0/linear_drag_per_s: must be 0 to 10000, not -1"},
    {"/bodies/0/cable_friction", "-0.1",
     "s.json: /bodies/0/cable_friction: must be 0 to 100, not -0.1"},
    {"/bodies/0/restitution", "1.01", "s.json: /bodies/0/restitution: must be 0 to 1, not 1.01"},
    {"/cables/0/half_width_m", "-0.05",
     "s.json: /cables/0/half_width_m: must be 1e-06 to 1000, not -0.05"},
    {"/cables/0/axial_stiffness_n", "0",
     "s.json: /cables/0/axial_stiffness_n: must be 0.001 to 1e+15, not 0"},
    {"/cables/0/wraps/0/turn", R"("anticlockwise")",
     "s.json: /cables/0/wraps/0/turn: must be counter_clockwise or clockwise, not "
     "\"anticlockwise\" (did you "
     "mean clockwise?)"},
    {"/cables/0/wraps/0/extra_turns", "-1",
     "s.json: /cables/0/wraps/0/extra_turns: must be 0 to 100, not -1"},
    {"/duration_s", "0", "s.json: /duration_s: must be 0.001 to 3600, not 0"},
    {"/duration_s", "1e9", "s.json: /duration_s: must be 0.001 to 3600, not 1000000000.0"},
    {"/frames_per_second", "0", "s.json: /frames_per_second: must be 1 to 1000, not 0"},
    {"/steps_per_frame", "100000", "s.json: /steps_per_frame: must be 1 to 1000, not 100000"},
    {"/steps_per_frame", "18446744073709551615",
     "s.json: /steps_per_frame: must be 1 to 1000, not 18446744073709551615"},
    {"/baseline/method", R"("pinch")",
     "s.json: /baseline/method: must be pinch_no_contact or cable, not \"pinch\" (did you mean "
     "pinch_no_contact?)"},
    // Timing
    {"/duration_s", "2.01",
     "s.json: /duration_s: must be a whole number of frames: 2.01 at 30 a second are 60.3; the "
     "nearest is 2"},
    {"/duration_s", "0.01",
     "s.json: /duration_s: must be a whole number of frames: 0.01 at 30 a second are 0.3; the "
     "nearest is "
     "0.0333333333333"},
    {"/poster_time_s", "2.5", "s.json: /poster_time_s: must be within duration_s, 2"},
    // Kinds and what goes with them
    {"/bodies/2/rail_axis", nullptr,
     "s.json: /bodies/2: rail_axis is missing (a rail body moves along it: [0, 1] is up and down)"},
    {"/bodies/2/rail_axis", "[0, 0]",
     "s.json: /bodies/2/rail_axis: must have a direction: its length is zero or nearly so"},
    {"/bodies/2/velocity_m_s", "[1, 1]",
     "s.json: /bodies/2/velocity_m_s: must point along rail_axis"},
    {"/bodies/1/rail_axis", "[0, 1]",
     "s.json: /bodies/1/rail_axis: has no effect on a body that is not on a rail; leave it out"},
    {"/bodies/0/velocity_m_s", "[1, 0]",
     "s.json: /bodies/0/velocity_m_s: has no effect on a fixed_axle body; leave it out"},
    {"/bodies/0/kind", R"("fixed")",
     "s.json: /bodies/0/mass_kg: has no effect on a fixed body; leave it out"},
    // Names
    {"/bodies/1/name", R"("wheel")",
     "s.json: /bodies/1/name: \"wheel\" is the name of /bodies/0 already\n"
     "s.json: /cables/0/start/body: no body is called \"left weight\""},
    {"/bodies/0/name", R"("world")",
     "s.json: /bodies/0/name: \"world\" is what tables call the fixed surroundings; choose another "
     "name\n"
     "s.json: /cables/0/wraps/0/body: no body is called \"wheel\""},
    {"/cables/0/wraps/0/body", R"("weel")",
     "s.json: /cables/0/wraps/0/body: no body is called \"weel\" (did you mean \"wheel\"?)"},
    {"/cables/0/end/body", R"("anchor")",
     "s.json: /cables/0/end/body: no body is called \"anchor\""},
    {"/cables/-", R"({"name": "rope", "half_width_m": 0.1, "start": {"world_m": [0, 1]},
                      "end": {"world_m": [1, 1]}})",
     "s.json: /cables/1/name: \"rope\" is the name of /cables/0 already"},
    // Cables
    {"/cables/0/start", "{}",
     "s.json: /cables/0/start: give either world_m (a point that does not move) or body (and "
     "point_m on it)"},
    {"/cables/0/start/world_m", "[0, 0]",
     "s.json: /cables/0/start: give either world_m (a point that does not move) or body (and "
     "point_m on it)"},
    {"/cables/0/start", R"({"world_m": [0, 1], "point_m": [0, 0]})",
     "s.json: /cables/0/start/point_m: belongs to body, not to world_m; leave one out"},
    {"/cables/0/end/point_m", "[0, 0.3]",
     "s.json: /cables/0/end/point_m: lies 0.3 m from the body's centre, outside of its radius of "
     "0.2 m"},
    {"/cables/0/end/point_m", "[0.1, 0.2]",
     "s.json: /cables/0/end/point_m: lies 0.22360679775 m from the body's centre, outside of its "
     "radius of 0.2 m"},
    {"/cables/0/wraps/-", R"({"body": "wheel", "turn": "clockwise"})",
     "s.json: /cables/0/wraps/1: is on the same body as the wrap before it; say extra_turns for "
     "more than one "
     "turn"},
    {"/cables/0/creep", "true",
     "s.json: /cables/0/creep: belongs to an elastic cable; give axial_stiffness_n too"},
    {"/cables/0/slack_m", "-0.1",
     "s.json: /cables/0/slack_m: a cable that cannot stretch cannot be shorter than its path; give "
     "axial_stiffness_n too"},
    {"/cables/0",
     R"({"name": "belt", "half_width_m": 0.1, "closed": true, "start": {"world_m": [0, 1]},
       "wraps": [{"body": "wheel", "turn": "clockwise"}, {"body": "left weight", "turn": "clockwise"}]})",
     "s.json: /cables/0/start: a closed cable has no ends; leave it out, or leave out closed"},
    {"/cables/0", R"({"name": "belt", "half_width_m": 0.1, "closed": true,
       "wraps": [{"body": "wheel", "turn": "clockwise"}]})",
     "s.json: /cables/0: a closed cable needs at least two wraps, not 1"},
    {"/cables/0", R"({"name": "belt", "half_width_m": 0.1, "closed": true})",
     "s.json: /cables/0: a closed cable needs at least two wraps, not 0"},
    {"/cables/0", R"({"name": "belt", "half_width_m": 0.1, "closed": true,
       "wraps": [{"body": "wheel", "turn": "clockwise"}, {"body": "left weight", "turn": "clockwise"},
                 {"body": "wheel", "turn": "clockwise"}]})",
     "s.json: /cables/0/wraps/0: is on the same body as the wrap before it; say extra_turns for "
     "more than one "
     "turn"},
    {"/cables/0", R"({"name": "coil", "half_width_m": 0.1,
       "start": {"body": "wheel", "rim_angle_rad": 0},
       "wraps": [{"body": "wheel", "turn": "clockwise"}],
       "end": {"body": "wheel", "rim_angle_rad": 2}})",
     "s.json: /cables/0: is on body \"wheel\" alone, where it can do nothing; let an end or a wrap "
     "be elsewhere"},
    // Walls and view
    {"/walls/0/to_m", "[-3, -4]",
     "s.json: /walls/0/to_m: must differ from from_m: the wall's length is zero or nearly so"},
    {"/view", R"("fill")",
     "s.json: /view: must be \"fit\" or an object with low_m and high_m, not \"fill\""},
    {"/view", "7",
     "s.json: /view: must be \"fit\" or an object with low_m and high_m, not a number"},
    {"/view/high_m", "[2.5, -4.2]",
     "s.json: /view/high_m/1: must be at least 0.001 above the one in low_m"},
};

TEST(SceneErrors, EachSaysPlaceAndCure) {
  for (const BadScene& bad : bad_scenes) {
    json scene = small_scene();
    const json::json_pointer pointer(bad.pointer);
    if (bad.value == nullptr) {
      scene.at(pointer.parent_pointer()).erase(pointer.back());
    } else {
      scene[pointer] = json::parse(bad.value);
    }
    EXPECT_EQ(error_of(scene.dump()), bad.message) << "at " << bad.pointer;
  }
}

struct BadText {
  const char* text;
  const char* message;
};

const BadText bad_texts[] = {
    {"",
     "s.json: line 1, column 1: not JSON: unexpected end of input; expected '[', '{', or a "
     "literal"},
    {"{\"title\": \"x\",\n  \"bodies\" []}",
     "s.json: line 2, column 12: not JSON: unexpected '['; expected ':'"},
    {"{\"title\": \"x\"} {}",
     "s.json: line 1, column 16: not JSON: unexpected '{'; expected end of input"},
    {"{\"duration_s\": NaN}",
     "s.json: line 1, column 16: not JSON: invalid literal (NaN, Infinity, comments and bare words "
     "are not JSON)"},
    {"{\"duration_s\": Infinity}",
     "s.json: line 1, column 16: not JSON: invalid literal (NaN, Infinity, comments and bare words "
     "are not JSON)"},
    {"{\"duration_s\": 1e999}",
     "s.json: line 1, column 20: not JSON: number overflow parsing '1e999'"},
    {"// a comment\n{}",
     "s.json: line 1, column 1: not JSON: invalid literal (NaN, Infinity, comments and bare words "
     "are not JSON)"},
    {"{\"title\": \"\xff\"}",
     "s.json: line 1, column 12: not JSON: invalid string: ill-formed UTF-8 byte"},
    {"{\"title\": \"a\", \"title\": \"b\"}", "s.json: /title: key given twice; keep one of them"},
    {R"({"bodies": [{}, {"name": "a", "radius_m": 1, "name": "b"}]})",
     "s.json: /bodies/1/name: key given twice; keep one of them"},
    {"[[[[[[[[[[[[[[[[[[[[",
     "s.json: /0/0/0/0/0/0/0/0/0/0/0/0/0/0/0: nested deeper than 16 levels"},
};

TEST(SceneErrors, SyntaxSaysLineAndColumn) {
  for (const BadText& bad : bad_texts) {
    EXPECT_EQ(error_of(bad.text), bad.message) << bad.text;
  }
}

TEST(SceneErrors, AllMistakesOfFormAreReportedAtOnce) {
  json scene = small_scene();
  scene["titel"] = "x";
  scene["bodies"][0]["mass_kg"] = -1;
  scene["bodies"][2].erase("position_m");
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /bodies/0/mass_kg: must be 1e-09 to 1e+12, not -1\n"
            "s.json: /bodies/2: position_m is missing\n"
            "s.json: /titel: unknown key (did you mean title?)");
}

TEST(SceneErrors, OnlyTheFirstTwentyAreShown) {
  json scene = small_scene();
  for (int i = 0; i < 30; ++i) {
    scene["walls"].push_back(i);
  }
  const std::string message = error_of(scene.dump());
  EXPECT_EQ(std::ranges::count(message, '\n'), 20);
  EXPECT_TRUE(message.ends_with("\ns.json: and 10 more")) << message;
}

TEST(SceneErrors, TooManyFrames) {
  json scene = small_scene();
  scene["duration_s"] = 3600;
  scene["frames_per_second"] = 100;
  EXPECT_EQ(error_of(scene.dump()),
            "s.json: /duration_s: asks for 360000 frames; at most 216000 can be made");
}

TEST(SceneErrors, TooManyEntries) {
  json scene = small_scene();
  for (int i = 0; i < 1001; ++i) {
    scene["walls"].push_back(scene["walls"][0]);
  }
  EXPECT_EQ(error_of(scene.dump()), "s.json: /walls: must have 0 to 1000 entries, not 1002");
}

TEST(SceneErrors, LongKeysAndControlCharactersAreCutAndEscaped) {
  json scene = small_scene();
  scene["a\x1b[31m" + std::string(500, 'x')] = 1;
  const std::string message = error_of(scene.dump());
  EXPECT_EQ(message.find('\x1b'), std::string::npos);
  EXPECT_TRUE(message.starts_with("s.json: /a\\u001b[31mxxx")) << message;
  EXPECT_LT(message.size(), 300U);
}

TEST(SceneErrors, FileName) {
  const std::string cure =
      ": a scene file is called NN-name.json: up to 64 letters, digits, - and _, then .json; "
      "rename it";
  for (const char* name : {"my scene.json", "scene.txt", ".json", "a,b.json"}) {
    try {
      parse_scene(small_scene().dump(), name);
      FAIL() << name;
    } catch (const SceneFileError& error) {
      EXPECT_EQ(error.what(), name + cure);
    }
  }
}

TEST(SceneErrors, FilesThatCannotBeRead) {
  const auto read_error = [](const std::string& path) -> std::string {
    try {
      read_scene_file(path);
    } catch (const SceneFileError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(read_error("no-such.json"),
            "no-such.json: No such file or directory; name a scene file, as those of demos/");
  EXPECT_EQ(read_error("/tmp"), "/tmp: is not a file");
  const test::TemporaryFolder folder;
  const std::string large = folder.write("large.json", std::string(max_scene_bytes + 1, ' '));
  EXPECT_EQ(read_error(large), large + ": is larger than 4000000 bytes");
}

// Text with a byte changed, a piece cut out, or a piece doubled is refused in the usual way, or it
// is a scene that starts or whose geometry is refused in the usual way.
TEST(SceneErrors, DamagedTextIsRefusedOrRead) {
  const std::string good = small_scene().dump(1);
  std::uint64_t state = 1;
  const auto below = [&state](std::size_t limit) {  // Knuth's MMIX generator
    state = state * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>(state >> 33U) % limit;
  };
  int refused = 0;
  constexpr int trials = 3000;
  for (int i = 0; i < trials; ++i) {
    std::string text = good;
    const std::size_t at = below(text.size()), length = 1 + below(12);
    switch (below(3)) {
      case 0:
        text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      default:
        text.insert(at, text.substr(at, length));
    }
    try {
      start_world(parse_scene(text, "s.json").scene, "s.json", Method::pinch);
    } catch (const SceneFileError& error) {
      EXPECT_TRUE(std::string(error.what()).starts_with("s.json: ")) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, trials / 2);
  EXPECT_LT(refused, trials);
}

}  // namespace
}  // namespace pinchlab
