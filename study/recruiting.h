// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Participants who are sent by a site (Prolific, SONA and the like): the ids that it puts into the
// address, and where it wants them back.

#include <nlohmann/json.hpp>
#include <string>

#include "base/json_object.h"

namespace pinchlab::study {

/// `recruiting` of a configuration. Addresses are https and may hold {participant}, {study} and
/// {session}, which the page fills in; empty: none.
struct Recruiting {
  /// Names of the parameters in the address; the last two may be empty.
  std::string participant_parameter, study_parameter, session_parameter;
  std::string completion_url, completion_code;  ///< told to nobody before the answers are saved
  std::string declined_url;                     ///< for who does not consent, or leaves
  std::string screen_out_url;                   ///< for who has no suitable screen or browser
  std::string full_url;                         ///< for who comes when all places are taken
};

/// What a site says of somebody; the last two can be empty. Without `participant`: nothing.
struct Recruited {
  std::string participant, study, session;

  friend bool operator==(const Recruited&, const Recruited&) = default;
};

/// Reads the entry of a configuration strictly. Throws InputError.
Recruiting read_recruiting(JsonObject object);

/// Reads ids strictly: letters, digits and `_.~-`, at most 128. Throws InputError.
Recruited read_recruited(JsonObject object);
nlohmann::json to_json(const Recruited& recruited);

/// What the page needs to know before anybody starts: parameters, and addresses without completion.
nlohmann::json for_page(const Recruiting& recruiting);

/// What the page needs to know once the answers are saved; null where there is nothing.
nlohmann::json completion(const Recruiting& recruiting);

}  // namespace pinchlab::study
