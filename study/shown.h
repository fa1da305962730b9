// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What participants are asked, told and shown, by hash: kept with the study and with every answer,
// so that answers to different questions or clips are never taken for answers to the same.

#include <nlohmann/json.hpp>

#include "study/clips.h"
#include "study/config.h"

namespace pinchlab::study {

/// An object of strings (analysis/answers.schema.json, `study`): `language`; `question` as it was
/// asked; and the SHA-256 of `consent_sha256` (information and consent), `texts_sha256` (all texts
/// of the page) and `clips_sha256` (the MP4 files of all pairs with their names; each file that was
/// played is listed with the answers besides, WebM too); and, where there are questionnaires or
/// options of trials, `options_sha256` of these.
nlohmann::json what_is_shown(const Config& config, const Clips& clips);

/// In words, in what two of them differ: "the question, the clips".
std::string difference(const nlohmann::json& one, const nlohmann::json& other);

}  // namespace pinchlab::study
