// SPDX-License-Identifier: GPL-3.0-or-later
// The only file that knows OSMesa, which Mesa has until 25.0.

#include <GL/osmesa.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

#include "render/gl_context.h"

namespace pinchlab {
namespace {

class OsMesaContext : public GlContext {
 public:
  OsMesaContext() {
    constexpr std::array<int, 9> attributes = {OSMESA_FORMAT,
                                               OSMESA_RGBA,
                                               OSMESA_PROFILE,
                                               OSMESA_CORE_PROFILE,
                                               OSMESA_CONTEXT_MAJOR_VERSION,
                                               3,
                                               OSMESA_CONTEXT_MINOR_VERSION,
                                               3,
                                               0};
    context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
    if (context_ == nullptr) {
      throw std::runtime_error(
          "OSMesa cannot make an OpenGL 3.3 core context; install Debian's libosmesa6 (Mesa 22.3 "
          "or newer)");
    }
  }
  ~OsMesaContext() override { OSMesaDestroyContext(context_); }
  OsMesaContext(const OsMesaContext&) = delete;
  OsMesaContext& operator=(const OsMesaContext&) = delete;

  void make_current() override {
    if (OSMesaGetCurrentContext() == context_) return;
    if (OSMesaMakeCurrent(context_, window_.data(), GL_UNSIGNED_BYTE, 1, 1) == GL_FALSE) {
      throw std::runtime_error("OSMesa cannot make its context current");
    }
  }
  Function function(const char* name) const override { return OSMesaGetProcAddress(name); }

 private:
  OSMesaContext context_ = nullptr;
  std::array<unsigned char, 4>
      window_{};  // OSMesa wants a default framebuffer: one pixel, never drawn to
};

}  // namespace

std::unique_ptr<GlContext> make_osmesa_context() {
  return std::make_unique<OsMesaContext>();
}

}  // namespace pinchlab
