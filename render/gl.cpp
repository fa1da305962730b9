// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/gl.h"

#include <array>
#include <stdexcept>
#include <string>

namespace pinchlab {

namespace {

constexpr const char* vertex_source = R"(#version 330 core
uniform vec2 frame_size;
layout(location = 0) in vec2 position;  // px, from the top left
layout(location = 1) in vec2 place;     // where in the shape, see each fragment shader
layout(location = 2) in vec4 shape;
layout(location = 3) in vec3 curve;
layout(location = 4) in vec4 fill;
layout(location = 5) in vec4 edge;
layout(location = 6) in vec4 mark;
noperspective out vec2 at;
flat out vec4 form;
flat out vec3 bend;
flat out vec4 edge_colour, fill_less_edge, mark_less_fill;  // premultiplied
void main() {
  gl_Position = vec4(2.0 * position / frame_size - 1.0, 0.0, 1.0);
  at = place;
  form = shape;
  bend = curve;
  vec4 fill_colour = vec4(fill.rgb * fill.a, fill.a);
  edge_colour = vec4(edge.rgb * edge.a, edge.a);
  fill_less_edge = fill_colour - edge_colour;
  mark_less_fill = vec4(mark.rgb * mark.a, mark.a) - fill_colour;
}
)";

// coverage: the share of a pixel whose centre lies `t` px from the middle of a band of half width
// `h`, that is the overlap of [t - 1/2, t + 1/2] and [-h, h]; right for bands thinner than a pixel
// too.
constexpr const char* coverage_source = R"(#version 330 core
noperspective in vec2 at;
flat in vec4 form;
flat in vec3 bend;
flat in vec4 edge_colour, fill_less_edge, mark_less_fill;
out vec4 colour;
float coverage(float t, float h) { return clamp(h + 0.5 - t, 0.0, min(2.0 * h, 1.0)); }
)";

// at: px along and across the line; form: its length, outer and inner half width, px.
constexpr const char* stroke_source = R"(
void main() {
  float t = length(vec2(at.x - clamp(at.x, 0.0, form.x), at.y));
  colour = edge_colour * coverage(t, form.y) + fill_less_edge * coverage(t, form.z);
}
)";

// A piece of a circular arc of radius bend.x, or straight if that is 0.
// at: px outwards from the arc's centre and along it, or to the right and along;
// form: outer and inner half width, mark spacing, half a mark's length, px;
// bend: radius, px; material at the middle, in mark spacings; material a px.
// Pieces turn little, so a few terms of the arc tangent's series do.
constexpr const char* strip_source = R"(
void main() {
  bool curved = bend.x > 0.0;
  float t = curved ? abs(length(at) - bend.x) : abs(at.x);
  float u = at.y / max(at.x, 1e-3), q = u * u;
  float s = curved ? bend.x * u * (1.0 + q * (-1.0 / 3.0 + q * 0.2)) : at.y;
  float m = bend.y + bend.z * s;
  float marked = coverage(form.z * abs(fract(m + 0.5) - 0.5), form.w);
  vec4 core_less_edge = fill_less_edge + mark_less_fill * marked;
  colour = edge_colour * coverage(t, form.x) + core_less_edge * coverage(t, form.y);
}
)";

// at: texture coordinates.
constexpr const char* label_source = R"(
uniform sampler2D text;
void main() { colour = (edge_colour + fill_less_edge) * texture(text, at).r; }
)";

GLuint compile(const Gl& gl, GLenum kind, const char* head, const char* body) {
  const GLuint shader = gl.CreateShader(kind);
  const std::array<const GLchar*, 2> parts = {head, body};
  gl.ShaderSource(shader, static_cast<GLsizei>(parts.size()), parts.data(), nullptr);
  gl.CompileShader(shader);
  GLint good = GL_FALSE;
  gl.GetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good == GL_FALSE) {
    std::array<char, 2048> log{};
    gl.GetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("OpenGL shader does not compile: ") + log.data());
  }
  return shader;
}

GLuint link(const Gl& gl, const char* fragment_body) {
  const GLuint vertex = compile(gl, GL_VERTEX_SHADER, vertex_source, "");
  const GLuint fragment = compile(gl, GL_FRAGMENT_SHADER, coverage_source, fragment_body);
  const GLuint program = gl.CreateProgram();
  gl.AttachShader(program, vertex);
  gl.AttachShader(program, fragment);
  gl.LinkProgram(program);
  gl.DeleteShader(vertex);
  gl.DeleteShader(fragment);
  GLint good = GL_FALSE;
  gl.GetProgramiv(program, GL_LINK_STATUS, &good);
  if (good == GL_FALSE) {
    std::array<char, 2048> log{};
    gl.GetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
    throw std::runtime_error(std::string("OpenGL program does not link: ") + log.data());
  }
  return program;
}

}  // namespace

Gl load_gl(const GlContext& context) {
  Gl gl{};
  const auto load = [&context]<typename Pointer>(Pointer& pointer, const char* name) {
    pointer = reinterpret_cast<Pointer>(context.function(name));
    if (pointer == nullptr) {
      throw std::runtime_error(std::string("OpenGL function missing: ") + name);
    }
  };
  load(gl.AttachShader, "glAttachShader");
  load(gl.BindBuffer, "glBindBuffer");
  load(gl.BindFramebuffer, "glBindFramebuffer");
  load(gl.BindRenderbuffer, "glBindRenderbuffer");
  load(gl.BindTexture, "glBindTexture");
  load(gl.BindVertexArray, "glBindVertexArray");
  load(gl.BlendFunc, "glBlendFunc");
  load(gl.BlitFramebuffer, "glBlitFramebuffer");
  load(gl.BufferData, "glBufferData");
  load(gl.CheckFramebufferStatus, "glCheckFramebufferStatus");
  load(gl.Clear, "glClear");
  load(gl.ClearColor, "glClearColor");
  load(gl.CompileShader, "glCompileShader");
  load(gl.CreateProgram, "glCreateProgram");
  load(gl.CreateShader, "glCreateShader");
  load(gl.DeleteShader, "glDeleteShader");
  load(gl.DeleteTextures, "glDeleteTextures");
  load(gl.DrawElements, "glDrawElements");
  load(gl.Enable, "glEnable");
  load(gl.EnableVertexAttribArray, "glEnableVertexAttribArray");
  load(gl.FramebufferRenderbuffer, "glFramebufferRenderbuffer");
  load(gl.GenBuffers, "glGenBuffers");
  load(gl.GenFramebuffers, "glGenFramebuffers");
  load(gl.GenRenderbuffers, "glGenRenderbuffers");
  load(gl.GenTextures, "glGenTextures");
  load(gl.GenVertexArrays, "glGenVertexArrays");
  load(gl.GetError, "glGetError");
  load(gl.GetProgramInfoLog, "glGetProgramInfoLog");
  load(gl.GetProgramiv, "glGetProgramiv");
  load(gl.GetShaderInfoLog, "glGetShaderInfoLog");
  load(gl.GetShaderiv, "glGetShaderiv");
  load(gl.GetUniformLocation, "glGetUniformLocation");
  load(gl.LinkProgram, "glLinkProgram");
  load(gl.PixelStorei, "glPixelStorei");
  load(gl.ReadPixels, "glReadPixels");
  load(gl.RenderbufferStorage, "glRenderbufferStorage");
  load(gl.Scissor, "glScissor");
  load(gl.ShaderSource, "glShaderSource");
  load(gl.TexImage2D, "glTexImage2D");
  load(gl.TexParameteri, "glTexParameteri");
  load(gl.Uniform2f, "glUniform2f");
  load(gl.UseProgram, "glUseProgram");
  load(gl.VertexAttribPointer, "glVertexAttribPointer");
  load(gl.Viewport, "glViewport");
  return gl;
}

Programs::Programs(const Gl& gl)
    : names_{link(gl, stroke_source), link(gl, strip_source), link(gl, label_source)} {}

}  // namespace pinchlab
