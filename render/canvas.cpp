// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <stdexcept>
#include <utility>

#include "render/frame_changes.h"
#include "render/gl.h"
#include "render/gl_context.h"
#include "render/mesh.h"
#include "render/text.h"

namespace pinchlab {

namespace {

float narrow(double value) {
  return static_cast<float>(value);
}

/// OpenGL takes a place in the bound buffer as a pointer.
const void* buffer_place(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
}

}  // namespace

struct Canvas::State {
  int width, height;
  std::unique_ptr<GlContext> context = make_gl_context();
  Gl gl = load_gl(*context);
  Programs programs{gl};
  Font font;
  std::map<std::pair<std::string, int>, LabelImage> labels;  // by text and size in 1/64 px
  GLuint frame = 0, paper = 0;  // framebuffers: the frame, and its background alone
  Mesh mesh, last_mesh;
  std::vector<PixelRect> quads;        // where each of the mesh may be seen
  std::vector<std::uint32_t> indices;  // of the vertices to draw
  std::vector<PixelRect> changed;
  std::vector<std::uint8_t> pixels;

  State(int width_, int height_) : width(width_), height(height_) {
    pixels.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
    paper = make_framebuffer();
    frame = make_framebuffer();
    make_vertex_array();
    gl.Enable(GL_BLEND);
    gl.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl.Enable(GL_SCISSOR_TEST);
    gl.Viewport(0, 0, width, height);
    for (const Program program : {Program::stroke, Program::strip, Program::label}) {
      gl.UseProgram(programs[program]);
      gl.Uniform2f(gl.GetUniformLocation(programs[program], "frame_size"), narrow(width),
                   narrow(height));
    }
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.PixelStorei(GL_PACK_ROW_LENGTH, width);
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    check("set-up");
  }

  GLuint make_framebuffer() const {
    GLuint made = 0, colour = 0;
    gl.GenRenderbuffers(1, &colour);
    gl.BindRenderbuffer(GL_RENDERBUFFER, colour);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    gl.GenFramebuffers(1, &made);
    gl.BindFramebuffer(GL_FRAMEBUFFER, made);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error(
          fmt::format("OpenGL cannot draw into a frame of {} x {} px", width, height));
    }
    return made;
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
                             buffer_place(offset));
    };
    attribute(0, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, position));
    attribute(1, 2, GL_FLOAT, GL_FALSE, offsetof(Vertex, place));
    attribute(2, 4, GL_FLOAT, GL_FALSE, offsetof(Vertex, shape));
    attribute(3, 3, GL_FLOAT, GL_FALSE, offsetof(Vertex, curve));
    attribute(4, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, fill));
    attribute(5, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, edge));
    attribute(6, 4, GL_UNSIGNED_BYTE, GL_TRUE, offsetof(Vertex, mark));
  }

  void check(const char* stage) const {
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR) {
      throw std::runtime_error(fmt::format("OpenGL error 0x{:04x} in {}", error, stage));
    }
  }

  const LabelImage& image_of(const std::string& text, double height_px) {
    const int size = static_cast<int>(std::lround(64.0 * height_px));
    LabelImage& label = labels[{text, size}];
    if (label.texture != 0) return label;
    const TextBitmap bitmap = font.draw(text, size / 64.0);
    label = {0, bitmap.width, bitmap.height, bitmap.centre_x, bitmap.centre_y};
    gl.GenTextures(1, &label.texture);
    gl.BindTexture(GL_TEXTURE_2D, label.texture);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, bitmap.width, bitmap.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                  bitmap.coverage.data());
    return label;
  }

  void build(const Picture& picture, int left, int columns) {
    const Fit fit(picture.view, left, columns, height);
    for (const Picture::Item& item : picture.order) {
      switch (item.kind) {
        case Picture::Kind::stroke:
          mesh.add(picture.strokes[item.index], fit);
          break;
        case Picture::Kind::strip:
          mesh.add(picture.strips[item.index], picture.points, fit);
          break;
        case Picture::Kind::patch:
          mesh.add(picture.patches[item.index], picture.corners, fit);
          break;
        case Picture::Kind::label: {
          const Label& label = picture.labels[item.index];
          mesh.add(label, image_of(label.text, fit.scale * label.height), fit);
          break;
        }
      }
    }
    mesh.end_sheet(left, columns, picture.background);
  }

  template <typename Element>
  void upload(GLenum buffer, const std::vector<Element>& data) const {
    gl.BufferData(buffer, static_cast<GLsizeiptr>(data.size() * sizeof(Element)), data.data(),
                  GL_STREAM_DRAW);
  }

  void forget_labels() {
    for (const auto& [key, label] : labels) gl.DeleteTextures(1, &label.texture);
    labels.clear();
  }

  void paint_paper() const {
    gl.BindFramebuffer(GL_FRAMEBUFFER, paper);
    for (const Sheet& sheet : mesh.sheets()) {
      gl.Scissor(sheet.left, 0, sheet.width, height);
      const Colour& colour = sheet.background;
      const double alpha = colour.alpha / 255.0;
      gl.ClearColor(narrow(alpha * colour.red / 255.0), narrow(alpha * colour.green / 255.0),
                    narrow(alpha * colour.blue / 255.0), narrow(alpha));
      gl.Clear(GL_COLOR_BUFFER_BIT);
    }
    gl.BindFramebuffer(GL_FRAMEBUFFER, frame);
  }

  /// Copying costs a fraction of what clearing a part does.
  void clear_changes() const {
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, paper);
    gl.Scissor(0, 0, width, height);
    for (const PixelRect& r : changed) {
      const int right = r.left + r.width, bottom = r.top + r.height;
      gl.BlitFramebuffer(r.left, r.top, right, bottom, r.left, r.top, right, bottom,
                         GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    gl.BindFramebuffer(GL_READ_FRAMEBUFFER, frame);
  }

  /// What a changed part needs of a batch, from where on its indices are.
  struct Piece {
    const Batch* batch;
    PixelRect part;
    std::size_t first, count;
  };

  /// Cuts the drawing into the parts of the frame that have changed, batch by batch: a change of
  /// program costs more than one of part. What a quad gives a pixel does not depend on them.
  void cut(std::vector<Piece>& pieces) {
    quads.clear();
    for (std::size_t i = 0; i < mesh.vertices().size(); i += quad_corners) {
      quads.push_back(quad_bounds(mesh.vertices().data() + i, width, height));
    }
    indices.clear();
    std::size_t next = 0;
    for (const Sheet& sheet : mesh.sheets()) {
      for (; next < sheet.end; ++next) {
        for (const PixelRect& r : changed) {
          const int left = std::max(r.left, sheet.left);
          const int right = std::min(r.left + r.width, sheet.left + sheet.width);
          cut(mesh.batches()[next], {left, r.top, std::max(0, right - left), r.height}, pieces);
        }
      }
    }
  }

  void cut(const Batch& batch, const PixelRect& part, std::vector<Piece>& pieces) {
    const std::size_t first = indices.size();
    for (std::size_t q = batch.first; q < batch.first + batch.count; ++q) {
      if (!overlap(quads[q], part)) continue;
      for (const std::uint32_t corner : quad_triangles) {
        indices.push_back(static_cast<std::uint32_t>(q * quad_corners) + corner);
      }
    }
    if (indices.size() > first) pieces.push_back({&batch, part, first, indices.size() - first});
  }

  /// All vertices go up at once.
  void draw_changes() {
    std::vector<Piece> pieces;
    cut(pieces);
    upload(GL_ARRAY_BUFFER, mesh.vertices());
    upload(GL_ELEMENT_ARRAY_BUFFER, indices);
    const Batch* batch = nullptr;
    for (const Piece& piece : pieces) {
      if (piece.batch != batch) {
        batch = piece.batch;
        gl.UseProgram(programs[batch->program]);
        if (batch->texture != 0) gl.BindTexture(GL_TEXTURE_2D, batch->texture);
      }
      gl.Scissor(piece.part.left, piece.part.top, piece.part.width, piece.part.height);
      gl.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(piece.count), GL_UNSIGNED_INT,
                      buffer_place(piece.first * sizeof(GLuint)));
    }
  }

  /// Only what changed is read back. The first row in OpenGL's memory is its bottom one; the
  /// shaders put the frame's top there.
  void read_changes() {
    const auto row = static_cast<std::size_t>(width);
    for (const PixelRect& r : changed) {
      const std::size_t first =
          static_cast<std::size_t>(r.top) * row + static_cast<std::size_t>(r.left);
      gl.ReadPixels(r.left, r.top, r.width, r.height, GL_RGBA, GL_UNSIGNED_BYTE,
                    pixels.data() + 4 * first);
    }
  }

  void draw(std::span<const Picture* const> pictures) {
    context->make_current();
    constexpr std::size_t enough_labels = 500;
    if (labels.size() > enough_labels) forget_labels();
    mesh.clear();
    const int count = static_cast<int>(pictures.size());
    for (int i = 0; i < count; ++i) {
      const int left = width * i / count;
      build(*pictures[static_cast<std::size_t>(i)], left, width * (i + 1) / count - left);
    }
    changed = frame_changes(last_mesh, mesh, width, height);
    if (!changed.empty()) {
      if (mesh.sheets() != last_mesh.sheets()) paint_paper();
      clear_changes();
      draw_changes();
      read_changes();
      check("drawing");
    }
    std::swap(mesh, last_mesh);
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

const std::vector<PixelRect>& Canvas::changed() const {
  return state_->changed;
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
