// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows OSMesa.

#include <GL/osmesa.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

#include "render/gl_context.h"

#if defined(__SANITIZE_ADDRESS__)
// OSMesa keeps a few bytes a context for ever.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libOSMesa";
}
#endif

namespace pinchlab {

struct GlContext::State {
  OSMesaContext context = nullptr;
  std::array<unsigned char, 4>
      window{};  // OSMesa wants a default framebuffer: one pixel, never drawn to
};

GlContext::GlContext() : state_(std::make_unique<State>()) {
  // The driver's own threads cost more than they give at these sizes: whole clips run side by side
  // instead.
  setenv("LP_NUM_THREADS", "0", 0);
  // Mesa 22.3 corrupts its memory where this is not what the processor has.
  unsetenv("LP_NATIVE_VECTOR_WIDTH");
  constexpr std::array<int, 9> attributes = {OSMESA_FORMAT,
                                             OSMESA_RGBA,
                                             OSMESA_PROFILE,
                                             OSMESA_CORE_PROFILE,
                                             OSMESA_CONTEXT_MAJOR_VERSION,
                                             3,
                                             OSMESA_CONTEXT_MINOR_VERSION,
                                             3,
                                             0};
  state_->context = OSMesaCreateContextAttribs(attributes.data(), nullptr);
  if (state_->context == nullptr) {
    throw std::runtime_error(
        "OSMesa cannot make an OpenGL 3.3 core context; install Debian's libosmesa6 (Mesa 22.3 or "
        "newer)");
  }
  try {
    make_current();
  } catch (...) {
    OSMesaDestroyContext(state_->context);
    throw;
  }
}

GlContext::~GlContext() {
  OSMesaDestroyContext(state_->context);
}

void GlContext::make_current() {
  if (OSMesaGetCurrentContext() == state_->context) return;
  if (OSMesaMakeCurrent(state_->context, state_->window.data(), GL_UNSIGNED_BYTE, 1, 1) ==
      GL_FALSE) {
    throw std::runtime_error("OSMesa cannot make its context current");
  }
}

GlContext::Function GlContext::function(const char* name) {
  return OSMesaGetProcAddress(name);
}

}  // namespace pinchlab
