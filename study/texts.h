// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The words of the page: those that are delivered, and what a configuration makes of them.

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "study/config.h"

namespace pinchlab::study {

/// The texts of a study with `config`'s language and options. `document` is the configuration, whose
/// `texts` replace delivered ones; texts of options that are not used are left out, so that they
/// change nothing. Throws InputError, also where a language that is not delivered lacks a text.
std::map<std::string, std::string> read_texts(const nlohmann::json& document,
                                              const std::string& file, const Config& config);

}  // namespace pinchlab::study
