// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pinchlab::test {

/// The message of the exception of type Error that `act` throws; empty if it throws none.
template <typename Error, typename Act>
std::string message_of(Act act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

}  // namespace pinchlab::test
