// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>

#include "render/frame_changes.h"
#include "render/gl.h"
#include "render/gl_context.h"
#include "render/painter.h"

namespace pinchlab {

namespace {

float narrow(double value) {
  return static_cast<float>(value);
}

/// OpenGL takes a place in the bound buffer as a pointer.
const void* buffer_place(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr)
}

class GlPainter : public Painter {
 public:
  GlPainter(int width, int height) : width_(width), height_(height) {
    paper_ = make_framebuffer();
    frame_ = make_framebuffer();
    make_vertex_array();
    gl_.Enable(GL_BLEND);
    gl_.BlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    gl_.Enable(GL_SCISSOR_TEST);
    gl_.Viewport(0, 0, width_, height_);
    for (const Program program : {Program::stroke, Program::strip, Program::label}) {
      gl_.UseProgram(programs_[program]);
      gl_.Uniform2f(gl_.GetUniformLocation(programs_[program], "frame_size"), narrow(width_),
                    narrow(height_));
    }
    gl_.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl_.PixelStorei(GL_PACK_ROW_LENGTH, width_);
    gl_.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    check("set-up");
  }

  std::uint32_t keep(TextBitmap image) override {
    context_->make_current();
    GLuint texture = 0;
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(GL_TEXTURE_2D, texture);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl_.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    gl_.TexImage2D(GL_TEXTURE_2D, 0, GL_R8, image.width, image.height, 0, GL_RED, GL_UNSIGNED_BYTE,
                   image.coverage.data());
    textures_.push_back(texture);
    return texture;
  }

  void forget_images() override {
    context_->make_current();
    gl_.DeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    textures_.clear();
  }

  int rectangle_cost() const override { return 2000; }

  void paint(const Mesh& mesh, const std::vector<PixelRect>& changed, bool first,
             std::uint8_t* pixels) override {
    context_->make_current();
    if (first) paint_paper(mesh);
    clear(changed);
    draw(mesh, changed);
    read(changed, pixels);
    check("drawing");
  }

 private:
  GLuint make_framebuffer() const {
    GLuint made = 0, colour = 0;
    gl_.GenRenderbuffers(1, &colour);
    gl_.BindRenderbuffer(GL_RENDERBUFFER, colour);
    gl_.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width_, height_);
    gl_.GenFramebuffers(1, &made);
    gl_.BindFramebuffer(GL_FRAMEBUFFER, made);
    gl_.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colour);
    if (gl_.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error(
          fmt::format("OpenGL cannot draw into a frame_ of {} x {} px", width_, height_));
    }
    return made;
  }

  void make_vertex_array() {
    GLuint array = 0, vertex_buffer = 0, index_buffer = 0;
    gl_.GenVertexArrays(1, &array);
    gl_.BindVertexArray(array);
    gl_.GenBuffers(1, &vertex_buffer);
    gl_.BindBuffer(GL_ARRAY_BUFFER, vertex_buffer);
    gl_.GenBuffers(1, &index_buffer);
    gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, index_buffer);
    const auto attribute = [this](GLuint location, GLint size, GLenum type, GLboolean normalised,
                                  std::size_t offset) {
      gl_.EnableVertexAttribArray(location);
      gl_.VertexAttribPointer(location, size, type, normalised, sizeof(Vertex),
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
    if (const GLenum error = gl_.GetError(); error != GL_NO_ERROR) {
      throw std::runtime_error(fmt::format("OpenGL error 0x{:04x} in {}", error, stage));
    }
  }

  template <typename Element>
  void upload(GLenum buffer, const std::vector<Element>& data) const {
    gl_.BufferData(buffer, static_cast<GLsizeiptr>(data.size() * sizeof(Element)), data.data(),
                   GL_STREAM_DRAW);
  }

  void paint_paper(const Mesh& mesh) const {
    gl_.BindFramebuffer(GL_FRAMEBUFFER, paper_);
    for (const Sheet& sheet : mesh.sheets()) {
      gl_.Scissor(sheet.left, 0, sheet.width, height_);
      const Colour& colour = sheet.background;
      const double alpha = colour.alpha / 255.0;
      gl_.ClearColor(narrow(alpha * colour.red / 255.0), narrow(alpha * colour.green / 255.0),
                     narrow(alpha * colour.blue / 255.0), narrow(alpha));
      gl_.Clear(GL_COLOR_BUFFER_BIT);
    }
    gl_.BindFramebuffer(GL_FRAMEBUFFER, frame_);
  }

  /// Copying costs a fraction of what clearing a part does.
  void clear(const std::vector<PixelRect>& changed) const {
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, paper_);
    gl_.Scissor(0, 0, width_, height_);
    for (const PixelRect& r : changed) {
      const int right = r.left + r.width, bottom = r.top + r.height;
      gl_.BlitFramebuffer(r.left, r.top, right, bottom, r.left, r.top, right, bottom,
                          GL_COLOR_BUFFER_BIT, GL_NEAREST);
    }
    gl_.BindFramebuffer(GL_READ_FRAMEBUFFER, frame_);
  }

  /// What a changed part needs of a batch, from where on its indices_ are.
  struct Piece {
    const Batch* batch;
    PixelRect part;
    std::size_t first, count;
  };

  /// Cuts the drawing into the parts of the frame_ that have changed, batch by batch: a change of
  /// program costs more than one of part. What a quad gives a pixel does not depend on them.
  void cut(const Mesh& mesh, const std::vector<PixelRect>& changed, std::vector<Piece>& pieces) {
    quads_.clear();
    for (std::size_t i = 0; i < mesh.vertices().size(); i += quad_corners) {
      quads_.push_back(quad_bounds(mesh.vertices().data() + i, width_, height_));
    }
    indices_.clear();
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
    const std::size_t first = indices_.size();
    for (std::size_t q = batch.first; q < batch.first + batch.count; ++q) {
      if (!overlap(quads_[q], part)) continue;
      for (const std::uint32_t corner : quad_triangles) {
        indices_.push_back(static_cast<std::uint32_t>(q * quad_corners) + corner);
      }
    }
    if (indices_.size() > first) pieces.push_back({&batch, part, first, indices_.size() - first});
  }

  /// All vertices go up at once.
  void draw(const Mesh& mesh, const std::vector<PixelRect>& changed) {
    std::vector<Piece> pieces;
    cut(mesh, changed, pieces);
    upload(GL_ARRAY_BUFFER, mesh.vertices());
    upload(GL_ELEMENT_ARRAY_BUFFER, indices_);
    const Batch* batch = nullptr;
    for (const Piece& piece : pieces) {
      if (piece.batch != batch) {
        batch = piece.batch;
        gl_.UseProgram(programs_[batch->program]);
        if (batch->texture != 0) gl_.BindTexture(GL_TEXTURE_2D, batch->texture);
      }
      gl_.Scissor(piece.part.left, piece.part.top, piece.part.width, piece.part.height);
      gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(piece.count), GL_UNSIGNED_INT,
                       buffer_place(piece.first * sizeof(GLuint)));
    }
  }

  /// Only what changed is read back. The first row in OpenGL's memory is its bottom one; the
  /// shaders put the frame_'s top there.
  void read(const std::vector<PixelRect>& changed, std::uint8_t* pixels) const {
    const auto row = static_cast<std::size_t>(width_);
    for (const PixelRect& r : changed) {
      const std::size_t first =
          static_cast<std::size_t>(r.top) * row + static_cast<std::size_t>(r.left);
      gl_.ReadPixels(r.left, r.top, r.width, r.height, GL_RGBA, GL_UNSIGNED_BYTE,
                     pixels + 4 * first);
    }
  }

  int width_, height_;  // px
  std::unique_ptr<GlContext> context_ = make_gl_context();
  Gl gl_ = load_gl(*context_);
  Programs programs_{gl_};
  GLuint frame_ = 0, paper_ = 0;  // framebuffers: the frame, and its background alone
  std::vector<GLuint> textures_;
  std::vector<PixelRect> quads_;        // where each of the mesh may be seen
  std::vector<std::uint32_t> indices_;  // of the vertices to draw
};

}  // namespace

std::unique_ptr<Painter> make_gl_painter(int width, int height) {
  return std::make_unique<GlPainter>(width, height);
}

}  // namespace pinchlab
