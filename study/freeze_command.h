// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "study/prepare.h"

namespace CLI {
class App;
}

namespace pinchlab::study {

/// Adds `pinchlab study freeze`.
void add_freeze(CLI::App& study, const Stimuli& stimuli);

}  // namespace pinchlab::study
