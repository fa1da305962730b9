// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What errors of a scene are told by, and from which overlap on.

#include <cstddef>
#include <string>

#include "sim/scene.h"

namespace pinchlab {

/// Two things may overlap by this much (m) at the start, what decimal figures in a scene file
/// leave: a share of the scene's largest coordinate, length or radius.
double overlap_allowed(const Scene& scene);

/// "12.3 mm"
std::string in_mm(double metres);

/// "/bodies/3"
std::string pointer(const char* list, std::size_t i);

/// "body 'wheel'", or "the world" (-1).
std::string name_of_body(const Scene& scene, int body);

}  // namespace pinchlab
