// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows EGL.

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "render/gl_context.h"

namespace pinchlab {
namespace {

[[noreturn]] void fail(const char* what) {
  throw std::runtime_error(std::string("EGL ") + what +
                           "; install Debian's libegl1 and libgl1-mesa-dri (Mesa 22.3 or newer)");
}

class EglContext : public GlContext {
 public:
  EglContext() {
    // Mesa's own renderer, as OSMesa's: a graphics card would give other pixels.
    setenv("LIBGL_ALWAYS_SOFTWARE", "1", 0);
    display_ = eglGetPlatformDisplay(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (display_ == EGL_NO_DISPLAY || eglInitialize(display_, nullptr, nullptr) == EGL_FALSE) {
      fail("has no display without a screen");
    }
    constexpr std::array<EGLint, 7> attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                  3,
                                                  EGL_CONTEXT_MINOR_VERSION,
                                                  3,
                                                  EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                  EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                  EGL_NONE};
    if (eglBindAPI(EGL_OPENGL_API) == EGL_TRUE) {
      context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    }
    if (context_ == EGL_NO_CONTEXT) {
      eglTerminate(display_);
      fail("cannot make an OpenGL 3.3 core context");
    }
  }
  ~EglContext() override {
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglDestroyContext(display_, context_);  // the display is the process's: other contexts use it
  }
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  void make_current() override {
    if (eglGetCurrentContext() == context_) return;
    if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_FALSE) {
      fail("cannot make its context current");
    }
  }
  Function function(const char* name) const override { return eglGetProcAddress(name); }

 private:
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlContext> make_egl_context() {
  return std::make_unique<EglContext>();
}

}  // namespace pinchlab
