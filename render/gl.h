// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The OpenGL 3.3 core functions that the OpenGL painter uses, and its shader programs.

#include <GL/glcorearb.h>

#include <array>

#include "render/gl_context.h"
#include "render/mesh.h"

namespace pinchlab {

/// Loaded by name from the current context, so that nothing is linked to one OpenGL library.
struct Gl {
  PFNGLATTACHSHADERPROC AttachShader;
  PFNGLBINDBUFFERPROC BindBuffer;
  PFNGLBINDFRAMEBUFFERPROC BindFramebuffer;
  PFNGLBINDRENDERBUFFERPROC BindRenderbuffer;
  PFNGLBINDTEXTUREPROC BindTexture;
  PFNGLBINDVERTEXARRAYPROC BindVertexArray;
  PFNGLBLENDFUNCPROC BlendFunc;
  PFNGLBLITFRAMEBUFFERPROC BlitFramebuffer;
  PFNGLBUFFERDATAPROC BufferData;
  PFNGLCHECKFRAMEBUFFERSTATUSPROC CheckFramebufferStatus;
  PFNGLCLEARPROC Clear;
  PFNGLCLEARCOLORPROC ClearColor;
  PFNGLCOMPILESHADERPROC CompileShader;
  PFNGLCREATEPROGRAMPROC CreateProgram;
  PFNGLCREATESHADERPROC CreateShader;
  PFNGLDELETESHADERPROC DeleteShader;
  PFNGLDELETETEXTURESPROC DeleteTextures;
  PFNGLDRAWELEMENTSPROC DrawElements;
  PFNGLENABLEPROC Enable;
  PFNGLENABLEVERTEXATTRIBARRAYPROC EnableVertexAttribArray;
  PFNGLFRAMEBUFFERRENDERBUFFERPROC FramebufferRenderbuffer;
  PFNGLGENBUFFERSPROC GenBuffers;
  PFNGLGENFRAMEBUFFERSPROC GenFramebuffers;
  PFNGLGENRENDERBUFFERSPROC GenRenderbuffers;
  PFNGLGENTEXTURESPROC GenTextures;
  PFNGLGENVERTEXARRAYSPROC GenVertexArrays;
  PFNGLGETERRORPROC GetError;
  PFNGLGETPROGRAMINFOLOGPROC GetProgramInfoLog;
  PFNGLGETPROGRAMIVPROC GetProgramiv;
  PFNGLGETSHADERINFOLOGPROC GetShaderInfoLog;
  PFNGLGETSHADERIVPROC GetShaderiv;
  PFNGLGETUNIFORMLOCATIONPROC GetUniformLocation;
  PFNGLLINKPROGRAMPROC LinkProgram;
  PFNGLPIXELSTOREIPROC PixelStorei;
  PFNGLREADPIXELSPROC ReadPixels;
  PFNGLRENDERBUFFERSTORAGEPROC RenderbufferStorage;
  PFNGLSCISSORPROC Scissor;
  PFNGLSHADERSOURCEPROC ShaderSource;
  PFNGLTEXIMAGE2DPROC TexImage2D;
  PFNGLTEXPARAMETERIPROC TexParameteri;
  PFNGLUNIFORM2FPROC Uniform2f;
  PFNGLUSEPROGRAMPROC UseProgram;
  PFNGLVERTEXATTRIBPOINTERPROC VertexAttribPointer;
  PFNGLVIEWPORTPROC Viewport;
};

/// Throws std::runtime_error that names the first missing function.
Gl load_gl(const GlContext& context);

/// The shader programs. All take the one vertex layout of mesh.h and the uniform `frame_size`, px.
class Programs {
 public:
  /// Compiles and links them; throws std::runtime_error with the driver's log.
  explicit Programs(const Gl& gl);
  GLuint operator[](Program program) const { return names_[static_cast<std::size_t>(program)]; }

 private:
  std::array<GLuint, 3> names_{};
};

}  // namespace pinchlab
