// SPDX-License-Identifier: GPL-3.0-or-later
// The entry of libFuzzer, for the target PINCHLAB_FUZZ_TARGET.
#include <cstdio>
#include <cstdlib>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  try {
    pinchlab::fuzz::PINCHLAB_FUZZ_TARGET(bytes);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    std::abort();  // so that libFuzzer keeps the input
  }
  return 0;
}
