// SPDX-License-Identifier: GPL-3.0-or-later
// Vector graphics show what a canvas draws.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <regex>
#include <set>

#include "render/picture/compose.h"
#include "render/vector_canvas.h"
#include "sim/tangent.h"
#include "tests/render/scenes.h"

namespace pinchlab {
namespace {

using test::TemporaryFolder;
using testing::atwood;

constexpr Colour grey{200, 200, 200, 255}, blue{0, 0, 255, 255}, red{255, 0, 0, 255};

std::string svg_of(const std::vector<VectorFrame>& frames, const Theme& theme = {}) {
  const TemporaryFolder folder;
  write_vector(folder.file("a.svg"), VectorFormat::svg, 100, 100, frames, 2, theme);
  const auto raw = testing::bytes_of(folder.file("a.svg"));
  return {raw.begin(), raw.end()};
}

/// The colours of a picture's lines, in the order in which they are drawn: "edge fill mark".
std::string lines_of(const Picture& picture) {
  const std::string svg = svg_of({{picture, ""}});
  const std::regex stroke("stroke:rgb\\(([^)]*)\\)");
  std::string colours;
  for (std::sregex_iterator it(svg.begin(), svg.end(), stroke), end; it != end; ++it) {
    const std::string colour = (*it)[1];
    colours += colours.empty() ? "" : " ";
    colours += colour == "0%,0%,100%" ? "edge" : colour == "100%,0%,0%" ? "mark" : "fill";
  }
  return colours;
}

Picture empty_picture() {
  Picture picture;
  picture.view = {{-1.0, -1.0}, {3.0, 3.0}};
  return picture;
}

/// A strip along a picture's points, with marks of 0.5 about the whole numbers.
void add_strip(Picture& picture) {
  Strip strip;
  strip.count = picture.points.size();
  strip.half_width = 0.1;
  strip.fill = grey;
  strip.edge = blue;
  strip.edge_width = 0.02;
  strip.mark = red;
  strip.mark_spacing = 1.0;
  strip.mark_length = 0.5;
  picture.add(strip);
}

// A mark that lies on two pieces of a cable is one shape: between two, viewers show a light line.
TEST(Vector, AMarkIsOnePath) {
  Picture picture = empty_picture();  // the pieces meet at the mark about 1
  for (const double x : {0.0, 1.0, 2.0}) picture.points.push_back({{x, 0.0}, {1.0, 0.0}, x});
  add_strip(picture);
  EXPECT_EQ(lines_of(picture), "edge fill mark mark mark");
}

// As in a canvas' frame: the turn on top has its edges, and hides the marks of the one below.
TEST(Vector, ATurnThatCrossesAnotherHidesIt) {
  Picture picture = empty_picture();
  // To the right, three quarters round a circle, and down across where it began.
  picture.points.push_back({{0.0, 0.0}, {1.0, 0.0}, 0.0});
  constexpr int pieces = 12;
  for (int k = 0; k <= pieces; ++k) {
    const double angle = (1.5 * k / pieces - 0.5) * std::numbers::pi;
    const Vec2 e(std::cos(angle), std::sin(angle));
    picture.points.push_back({Vec2(1.5, 0.5) + 0.5 * e, left(e), 0.15 * (k + 1)});
  }
  picture.points.push_back({{1.0, -0.5}, {0.0, -1.0}, 2.2});
  add_strip(picture);
  const std::string lines = lines_of(picture);
  EXPECT_LT(lines.find("mark"), lines.rfind("edge")) << lines;
  EXPECT_LT(lines.rfind("edge"), lines.rfind("fill")) << lines;
  EXPECT_TRUE(lines.ends_with("mark")) << lines;
}

TEST(Vector, WhatHasNoEdgeHasNoneUnderIt) {
  Picture picture = empty_picture();
  picture.points = {{{0.0, 0.0}, {1.0, 0.0}, 0.0}, {{1.0, 0.0}, {1.0, 0.0}, 1.0}};
  Strip strip;
  strip.count = 2;
  strip.half_width = 0.1;
  strip.fill = grey;
  strip.edge = blue;
  picture.add(strip);
  Stroke stroke;
  stroke.b = {1.0, 1.0};
  stroke.half_width = 0.1;
  stroke.fill = grey;
  stroke.edge = blue;
  picture.add(stroke);
  EXPECT_EQ(lines_of(picture), "fill fill");
}

TEST(Vector, SheetsHaveTheThemesColours) {
  Theme theme;
  theme.background = {0, 0, 255, 255};
  theme.ink = {255, 0, 0, 255};
  Picture picture = empty_picture();
  picture.background.alpha = 0;
  const std::string svg = svg_of({{picture, "A"}, {picture, "B"}}, theme);
  const std::regex fill("fill[:=]\"?rgb\\(([^)]*)\\)");
  std::set<std::string> colours;
  for (std::sregex_iterator it(svg.begin(), svg.end(), fill), end; it != end; ++it)
    colours.insert((*it)[1]);
  EXPECT_EQ(colours, (std::set<std::string>{"0%,0%,100%", "100%,0%,0%"}));
}

TEST(Vector, SvgAndPdfAreTheSameTwice) {
  Scene scene = atwood();
  scene.frame_count = 30;
  Picture picture;
  compose(scene, set_scenery(scene), make_world(scene, Method::pinch), picture);
  const TemporaryFolder folder;
  for (const auto& [format, ending, begin] :
       {std::tuple(VectorFormat::svg, ".svg", "<?xml"), {VectorFormat::pdf, ".pdf", "%PDF"}}) {
    const std::string a = folder.file(std::string("a") + ending);
    const std::string b = folder.file(std::string("b") + ending);
    write_vector(a, format, 200, 200, {{picture, ""}});
    write_vector(b, format, 200, 200, {{picture, ""}});
    // Cairo numbers the surfaces of a process.
    const auto numbered_anew = [](const std::string& path) {
      const auto bytes = testing::bytes_of(path);
      return std::regex_replace(std::string(bytes.begin(), bytes.end()),
                                std::regex("surface[0-9]+"), "surface");
    };
    const std::string raw = numbered_anew(a);
    EXPECT_TRUE(raw == numbered_anew(b));
    EXPECT_TRUE(std::string(raw.begin(), raw.end()).starts_with(begin));
  }
  const auto raw = testing::bytes_of(folder.file("a.svg"));
  const std::string svg(raw.begin(), raw.end());
  EXPECT_NE(svg.find("width=\"200"), std::string::npos);
  EXPECT_EQ(svg.find("<image"), std::string::npos) << "shapes, not pixels";
  write_vector(folder.file("sheet.svg"), VectorFormat::svg, 100, 100,
               {{picture, "A, 0.00 s"}, {picture, "B, 0.00 s"}}, 2);
  EXPECT_THROW(write_vector(folder.file("no/a.svg"), VectorFormat::svg, 10, 10, {{picture, ""}}),
               std::runtime_error);
  EXPECT_THROW(write_vector(folder.file("none.svg"), VectorFormat::svg, 10, 10, {}),
               std::invalid_argument);
}

}  // namespace
}  // namespace pinchlab
