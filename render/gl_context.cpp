// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/gl_context.h"

#include <cstdlib>
#include <stdexcept>
#include <string>
#if defined(__GLIBC__)
#include <malloc.h>
#endif

#if defined(__SANITIZE_ADDRESS__)
// Mesa keeps a few bytes a context for ever.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier)
  return "leak:libOSMesa\nleak:libEGL\nleak:_dri.so";
}
#endif

namespace pinchlab {
namespace {

std::unique_ptr<GlContext> make_context() {
  const char* const asked = std::getenv("PINCHLAB_GL");
  const std::string kind = asked == nullptr ? "" : asked;
#ifdef PINCHLAB_OSMESA
  if (kind.empty() || kind == "osmesa") return make_osmesa_context();
#endif
#ifdef PINCHLAB_EGL
  if (kind.empty() || kind == "egl") return make_egl_context();
#endif
  if (kind != "osmesa" && kind != "egl") {
    throw std::runtime_error("PINCHLAB_GL: `" + kind + "` must be osmesa or egl");
  }
  throw std::runtime_error("PINCHLAB_GL: there is no " + kind +
                           " in this program; leave it unset, or build with Debian's " +
                           (kind == "egl" ? "libegl-dev" : "libosmesa6-dev"));
}

}  // namespace

std::unique_ptr<GlContext> make_gl_context() {
#if defined(__GLIBC__)
  // The driver takes and frees some 256 KB with each call that draws. Giving them back to the
  // system each time, page by page, would cost as much as drawing a small part of a frame.
  constexpr int enough = 64 << 20;  // bytes
  mallopt(M_TRIM_THRESHOLD, enough);
  mallopt(M_MMAP_THRESHOLD, enough / 2);
#endif
  // The driver's own threads cost more than they give at these sizes: whole clips run side by side
  // instead.
  setenv("LP_NUM_THREADS", "0", 0);
  // Mesa 22.3 corrupts its memory where this is not what the processor has.
  unsetenv("LP_NATIVE_VECTOR_WIDTH");
  std::unique_ptr<GlContext> context = make_context();
  context->make_current();
  return context;
}

}  // namespace pinchlab
