// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pinchlab {

/// The project's version, "+", and 12 digits of the SHA-256 of the sources that the clips depend on
/// (base, sim, render, demos): the same for everybody who builds the same sources.
extern const char* const version;

}  // namespace pinchlab
