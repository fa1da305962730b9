// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include <cstdint>
#include <memory>
#include <new>
#include <numeric>
#include <vector>

namespace pinchlab::study {

/// What random numbers of a plan are drawn for; each draw has a generator of its own, so that no
/// option changes what another draws.
enum class Purpose : std::uint64_t {
  sides = 1,
  labels,
  rows,
  training,
  check_sides,
  check_places,
  pair_methods,
  pair_rows,
  pair_order,
  pair_sides,
  arranged_sides
};

class Random {
 public:
  Random(std::uint64_t seed, Purpose purpose, std::uint64_t block, std::uint64_t round = 0)
      : rng_(gsl_rng_alloc(gsl_rng_mt19937), &gsl_rng_free) {
    if (!rng_) {
      throw std::bad_alloc();
    }
    const std::uint64_t mixed =
        mix(mix(mix(mix(seed) ^ static_cast<std::uint64_t>(purpose)) ^ block) ^ round);
    gsl_rng_set(rng_.get(), mixed & 0xFFFFFFFFU);  // mt19937 takes 32 bits
  }
  std::size_t below(std::size_t n) { return gsl_rng_uniform_int(rng_.get(), n); }
  bool coin() { return below(2) == 1; }
  std::vector<std::size_t> permutation(std::size_t n) {
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    gsl_ran_shuffle(rng_.get(), order.data(), n, sizeof(std::size_t));
    return order;
  }

 private:
  // Steele, Lea and Flood's SplitMix64 (OOPSLA 2014): neighbouring seeds give unrelated generators.
  static std::uint64_t mix(std::uint64_t x) {
    x += 0x9E3779B97F4A7C15U;
    x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
    x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
    return x ^ (x >> 31U);
  }

  std::unique_ptr<gsl_rng, void (*)(gsl_rng*)> rng_;
};

}  // namespace pinchlab::study
