// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "render/picture/look.h"

namespace pinchlab {

/// How a body, or a cable, of a scene file is drawn: its key `look`, checked by check_format.
BodyLook read_body_look(const nlohmann::json& body);
CableLook read_cable_look(const nlohmann::json& cable);

}  // namespace pinchlab
