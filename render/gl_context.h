// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An off-screen OpenGL 3.3 core context, from OSMesa or from EGL without a surface.

#include <memory>

namespace pinchlab {

/// Owns a context without a window. Everything is drawn into framebuffer objects, so it has no
/// size.
class GlContext {
 public:
  virtual ~GlContext() = default;

  /// Makes the context this thread's current one; cheap if it is.
  virtual void make_current() = 0;

  /// Address of an OpenGL function, or null.
  using Function = void (*)();
  virtual Function function(const char* name) const = 0;
};

/// A context of the kind that the environment variable PINCHLAB_GL names, "osmesa" or "egl", and
/// current. Empty: OSMesa's, or EGL's where the program was built without OSMesa. Both draw with
/// Mesa's llvmpipe and give the same pixels. One kind a process. Throws std::runtime_error with the
/// cure if there is none.
std::unique_ptr<GlContext> make_gl_context();

std::unique_ptr<GlContext> make_osmesa_context();  ///< not yet current
std::unique_ptr<GlContext> make_egl_context();     ///< not yet current

}  // namespace pinchlab
