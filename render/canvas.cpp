// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "render/gl.h"
#include "render/gl_context.h"
#include "render/text.h"

namespace pinchlab {

namespace {

/// The one vertex layout; gl.cpp says what `place` and `shape` mean to each program.
struct Vertex {
  std::array<float, 2> position, place;
  std::array<float, 4> shape;
  Colour fill, edge, mark;
};

/// Consecutive triangles of one program, and of one texture if they are text.
struct Batch {
  Picture::Kind kind;
  GLuint texture;
  std::size_t first, count;  // indices
};

struct LabelTexture {
  GLuint name = 0;
  int width = 0, height = 0;              // px
  double centre_x = 0.0, centre_y = 0.0;  // px
};

/// World metres to px of a viewport, from its top left.
struct Fit {
  double scale;  // px/m
  Vec2 origin;   // px, of the world's origin
  Fit(const View& view, int width, int height) {
    const Vec2 size = view.high - view.low, middle = 0.5 * (view.low + view.high);
    scale = std::min(width / size.x(), height / size.y());
    origin = Vec2(0.5 * width - scale * middle.x(), 0.5 * height + scale * middle.y());
  }
  Vec2 point(const Vec2& p) const {
    return {origin.x() + scale * p.x(), origin.y() - scale * p.y()};
  }
  Vec2 vector(const Vec2& v) const { return {v.x(), -v.y()}; }
};

constexpr double fringe = 0.5;  // px outside a shape's edge that still see some of it

float narrow(double value) {
  return static_cast<float>(value);
}

}  // namespace

struct Canvas::State {
  int width, height;
  GlContext context;
  Gl gl = load_gl();
  Programs programs = build_programs(gl);
  Font font;
  std::map<std::pair<std::string, int>, LabelTexture> labels;  // by text and size in 1/64 px
  std::vector<Vertex> vertices;
  std::vector<GLuint> indices;
  std::vector<Batch> batches;
  std::vector<std::uint8_t> pixels;

  State(int width_, int height_) : width(width_), height(height_) {
    pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    make_frame();
    make_vertex_array();
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl.Enable(GL_SCISSOR_TEST);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    check("set-up");
  }

  void make_frame() {
    GLuint frame = 0, colour = 0;
    gl.GenRenderbuffers(1, &colour);
    gl.BindRenderbuffer(GL_RENDERBUFFER, colour);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    gl.GenFramebuffers(1, &frame);
    gl.BindFramebuffer(GL_FRAMEBUFFER, frame);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error(
          fmt::format("OpenGL cannot draw into a frame of {} x {} px", width, height));
    }
  }

  void make_vertex_array() {
    GLuint array = 0, vertex_buffer = 0, index_buffer = 0;
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &vertex_buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer);
    gl.GenBuffers(1, &index_buffer);
    gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer);
    const auto attribute = [this](GLuint location, GLint size, GLenum type, GLboolean normalised,
                                  std::size_t offset) {
      gl.EnableVertexAttribArray(location);
      gl.VertexAttribPointer(location, size, type, normalised, sizeof(Vertex),
                             reinterpret_cast<const void*>(offset));
    };
    attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
    attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, place));
    attribute(2, 4, GL_FLOAT, GL_FALSE, offsetof(Vertex, shape));
    attribute(3, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, fill));
    attribute(4, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, edge));
    attribute(5, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, mark));
  }

  void check(const char* stage) const {
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR) {
      throw std::runtime_error(fmt::format("OpenGL error 0x{:04x} in {}", error, stage));
    }
  }

  void vertex(const Vec2& position, double place_x, double place_y, const Vertex& common) {
    Vertex& v = vertices.emplace_back(common);
    v.position = {narrow(position.x()), narrow(position.y())};
    v.place = {narrow(place_x), narrow(place_y)};
  }

  /// Two triangles over the last two pairs of a band's vertices, `first` being the earlier pair's.
  void quad(std::size_t first) {
    for (const std::size_t i : {0, 1, 2, 2, 1, 3})
      indices.push_back(static_cast<GLuint>(first + i));
  }

  /// Opens a batch for what follows, unless the last one will take it.
  void batch(Picture::Kind kind, GLuint texture, std::size_t first_batch) {
    if (batches.size() == first_batch || batches.back().kind != kind ||
        batches.back().texture != texture) {
      batches.push_back({kind, texture, indices.size(), 0});
    }
  }

  void add(const Stroke& stroke, const Fit& fit) {
    const Vec2 a = fit.point(stroke.a), b = fit.point(stroke.b);
    const double length = (b - a).norm(), half = fit.scale * stroke.half_width,
                 reach = half + fringe;
    const Vec2 along = length > 0.0 ? Vec2((b - a) / length) : Vec2(1.0, 0.0);
    const Vec2 across(-along.y(), along.x());
    const Vertex common{
        {},
        {},
        {narrow(length), narrow(half), narrow(half - fit.scale * stroke.edge_width), 0.0f},
        stroke.fill,
        stroke.edge,
        {}};
    const std::size_t first = vertices.size();
    for (const double x : {-reach, length + reach}) {
      for (const double y : {-reach, reach}) vertex(a + x * along + y * across, x, y, common);
    }
    quad(first);
  }

  void add(const Strip& strip, const Picture& picture, const Fit& fit) {
    const double half = fit.scale * strip.half_width, reach = half + fringe;
    const Vertex common{
        {},
        {},
        {narrow(half), narrow(half - fit.scale * strip.edge_width),
         narrow(fit.scale * strip.mark_spacing), narrow(0.5 * fit.scale * strip.mark_length)},
        strip.fill,
        strip.edge,
        strip.mark};
    for (std::size_t i = 0; i < strip.count; ++i) {
      const StripPoint& point = picture.points[strip.first + i];
      const Vec2 middle = fit.point(point.position), along = fit.vector(point.tangent);
      const Vec2 across(-along.y(), along.x());
      const double material = point.material / strip.mark_spacing;
      vertex(middle - reach * across, -reach, material, common);
      vertex(middle + reach * across, reach, material, common);
      if (i > 0) quad(vertices.size() - 4);
    }
  }

  const LabelTexture& texture(const std::string& text, double height_px) {
    const int size = static_cast<int>(std::lround(64.0 * height_px));
    LabelTexture& label = labels[{text, size}];
    if (label.name != 0) return label;
    const TextBitmap bitmap = font.draw(text, size / 64.0);
    label = {0, bitmap.width, bitmap.height, bitmap.centre_x, bitmap.centre_y};
    gl.GenTextures(1, &label.name);
    gl.BindTexture(GL_TEXTURE_2D, label.name);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, bitmap.width, bitmap.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                  bitmap.coverage.data());
    return label;
  }

  void add(const Label& label, const LabelTexture& image, const Fit& fit) {
    const Vec2 corner = fit.point(label.centre) - Vec2(image.centre_x, image.centre_y);
    const Vertex common{{}, {}, {}, label.colour, {}, {}};
    const std::size_t first = vertices.size();
    for (const double x : {0.0, 1.0}) {
      for (const double y : {0.0, 1.0}) {
        vertex(corner + Vec2(x * image.width, y * image.height), x, y, common);
      }
    }
    quad(first);
  }

  void build(const Picture& picture, const Fit& fit) {
    const std::size_t first_batch = batches.size();
    for (const Picture::Item& item : picture.order) {
      if (item.kind == Picture::Kind::label) {
        const Label& label = picture.labels[item.index];
        const LabelTexture& image = texture(label.text, fit.scale * label.height);
        batch(item.kind, image.name, first_batch);
        add(label, image, fit);
      } else {
        batch(item.kind, 0, first_batch);
        if (item.kind == Picture::Kind::stroke) add(picture.strokes[item.index], fit);
        if (item.kind == Picture::Kind::strip) add(picture.strips[item.index], picture, fit);
      }
      batches.back().count = indices.size() - batches.back().first;
    }
  }

  void draw_batch(const Batch& one, int viewport_width) {
    const GLuint program = one.kind == Picture::Kind::stroke  ? programs.stroke
                           : one.kind == Picture::Kind::strip ? programs.strip
                                                              : programs.label;
    gl.UseProgram(program);
    gl.Uniform2f(gl.GetUniformLocation(program, "frame_size"), narrow(viewport_width),
                 narrow(height));
    if (one.texture != 0) gl.BindTexture(GL_TEXTURE_2D, one.texture);
    gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(one.count), GL_UNSIGNED_INT,
                    reinterpret_cast<const void*>(one.first * sizeof(GLuint)));
  }

  void forget_labels() {
    for (const auto& [key, label] : labels) gl.DeleteTextures(1, &label.name);
    labels.clear();
  }

  void draw(std::span<const Picture* const> pictures) {
    context.make_current();
    constexpr std::size_t enough_labels = 500;
    if (labels.size() > enough_labels) forget_labels();
    vertices.clear();
    indices.clear();
    batches.clear();

    // All vertices go up in one piece, then each picture is drawn into its share of the frame.
    const int count = static_cast<int>(pictures.size());
    std::vector<std::size_t> batches_until;
    const auto left_of = [&](int i) { return width * i / count; };
    for (int i = 0; i < count; ++i) {
      const Picture& picture = *pictures[static_cast<std::size_t>(i)];
      build(picture, Fit(picture.view, left_of(i + 1) - left_of(i), height));
      batches_until.push_back(batches.size());
    }
    gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
                  vertices.data(), GL_STREAM_DRAW);
    gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(GLuint)),
                  indices.data(), GL_STREAM_DRAW);

    // The first row in OpenGL's memory is its bottom one; the shaders put the frame's top there.
    std::size_t next = 0;
    for (int i = 0; i < count; ++i) {
      const int viewport_width = left_of(i + 1) - left_of(i);
      gl.Viewport(left_of(i), 0, viewport_width, height);
      gl.Scissor(left_of(i), 0, viewport_width, height);
      const Colour& paper = pictures[static_cast<std::size_t>(i)]->background;
      gl.ClearColor(narrow(paper.red / 255.0), narrow(paper.green / 255.0),
                    narrow(paper.blue / 255.0), 1.0f);
      gl.Clear(GL_COLOR_BUFFER_BIT);
      for (; next < batches_until[static_cast<std::size_t>(i)]; ++next)
        draw_batch(batches[next], viewport_width);
    }
    gl.ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
    check("drawing");
  }
};

Canvas::Canvas(int width, int height) {
  if (width < smallest_frame || height < smallest_frame || width > largest_frame ||
      height > largest_frame) {
    throw std::runtime_error(
        fmt::format("a frame of {} x {} px cannot be drawn: each side must be {} to {} px", width,
                    height, smallest_frame, largest_frame));
  }
  state_ = std::make_unique<State>(width, height);
}

Canvas::~Canvas() = default;

int Canvas::width() const {
  return state_->width;
}
int Canvas::height() const {
  return state_->height;
}

const std::uint8_t* Canvas::draw(const Picture& picture) {
  const Picture* const one = &picture;
  return draw(std::span<const Picture* const>(&one, 1));
}

const std::uint8_t* Canvas::draw(std::span<const Picture* const> pictures) {
  if (pictures.empty()) throw std::runtime_error("nothing to draw: no picture given");
  state_->draw(pictures);
  return state_->pixels.data();
}

}  // namespace pinchlab
