// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Videos whose sizes do not tell them apart.

#include <string>
#include <vector>

#include "render/video.h"

namespace pinchlab {

/// Whether equal_sizes can be asked of this codec: not of previews.
bool can_have_equal_sizes(Codec codec);

/// Copies the videos `from[i]`, which VideoWriter has written with the same settings and equally
/// many frames, to `to[i]`. The copies show the same and are as large as one another:
///
/// - H.264 in MP4: frame by frame, in the order in which they are stored. Each gets the size of the
///   largest of them by a message that decoders skip, so that bit rates are equal too, over any
///   time.
/// - VP9 in WebM, FFV1 in Matroska: only as a whole, by an element at the end that players skip.
///
/// A function of the videos' bytes alone. Throws std::runtime_error where a file cannot be read or
/// written, or the frames are not those of one another's times.
void equal_sizes(Codec codec, const std::vector<std::string>& from,
                 const std::vector<std::string>& to);

}  // namespace pinchlab
