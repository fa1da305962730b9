// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What of a scene its pictures hardly show.

#include <string>
#include <vector>

#include "render/picture/scenery.h"

namespace pinchlab {

/// A line where no body is in the picture at the start, for each cable that is thinner than half a
/// pixel, and for each label with letters that the font lacks, in pictures of this size, px. Throws
/// std::runtime_error as Font does.
std::vector<std::string> hard_to_see(const Scene& scene, const Scenery& scenery, int width,
                                     int height);

/// Says so on standard error, of a file.
void tell_hard_to_see(const std::string& file, const std::vector<std::string>& lines);

}  // namespace pinchlab
