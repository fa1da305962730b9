// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Random identifiers and the codes that participants keep.

#include <cstddef>
#include <string>
#include <string_view>

namespace pinchlab::study {

/// `bytes` random bytes, fit for secrets (OpenSSL's), as lower-case hexadecimal digits.
std::string random_hex(std::size_t bytes);

/// Whether two texts are equal, in a time that depends on their lengths only.
bool equal_in_constant_time(std::string_view a, std::string_view b);

/// The code by which a participant can have the answers removed, "XXXX-XXXX-XXXX" (60 bits,
/// Crockford's base 32). It follows from the participant's secret, so that the server need not keep
/// it.
std::string withdrawal_code(std::string_view secret);

/// What an answer file keeps of a code. Case, blanks and hyphens of what was typed do not matter,
/// nor does O for 0, or I and L for 1. Empty if it cannot be a code.
std::string withdrawal_hash(std::string_view typed_code);

}  // namespace pinchlab::study
