// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// An off-screen OpenGL 3.3 core context. Another platform (EGL) replaces osmesa_context.cpp and
// nothing else.

#include <memory>

namespace pinchlab {

/// Owns a context without a window. Everything is drawn into framebuffer objects, so it has no
/// size.
class GlContext {
 public:
  GlContext();  ///< Throws std::runtime_error if the driver has no OpenGL 3.3 core context.
  ~GlContext();
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;

  /// Makes the context this thread's current one; cheap if it is.
  void make_current();

  /// Address of an OpenGL function, or null.
  using Function = void (*)();
  static Function function(const char* name);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pinchlab
