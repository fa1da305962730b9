// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What the analysis needs around GSL: errors that do not abort, generators that free themselves.

#include <gsl/gsl_errno.h>
#include <gsl/gsl_rng.h>

#include <cstdint>
#include <memory>

namespace pinchlab::analysis {

/// While this lives, GSL returns its error codes (and values such as 0 on underflow) instead of
/// aborting the program. GSL keeps the handler in a global: not for several threads at once.
class GslErrorsOff {
 public:
  GslErrorsOff() : before_(gsl_set_error_handler_off()) {}
  ~GslErrorsOff() { gsl_set_error_handler(before_); }
  GslErrorsOff(const GslErrorsOff&) = delete;
  GslErrorsOff& operator=(const GslErrorsOff&) = delete;

 private:
  gsl_error_handler_t* before_;
};

/// What a stream of random numbers is for; streams of one seed are independent of each other.
enum class RandomUse : std::uint64_t {
  bootstrap = 1,
  sign_flip,
  order_flip,
  side_flip,
  study,
  power
};

struct FreeRng {
  void operator()(gsl_rng* rng) const { gsl_rng_free(rng); }
};
using Rng = std::unique_ptr<gsl_rng, FreeRng>;

/// The generator (GSL's mt19937) of one use, seed and index: the same three always give the same
/// numbers.
Rng make_rng(RandomUse use, std::uint64_t seed, std::uint64_t index = 0);

}  // namespace pinchlab::analysis
