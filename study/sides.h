// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// On which side a plan (plan.h) shows the method under test: fair coins, as often on both sides,
// and never more than three times running on one.

#include <array>
#include <cstdint>
#include <vector>

namespace pinchlab::study {

/// Orders of one participant: orders[round][position] is a demonstration.
using Orders = std::vector<std::vector<std::size_t>>;

/// Sides of participants 2 * pair and 2 * pair + 1, who see `orders`: sides[round][demonstration],
/// true where the first of the two sees the method under test on the right; the second sees it on
/// the other side. With both orders rounds 2k + 1 have the sides of rounds 2k, swapped.
std::vector<std::vector<bool>> sides_of_pair(std::uint64_t seed, std::uint64_t pair,
                                             const std::array<Orders, 2>& orders, bool both_orders);

/// Sides of trials whose levels are chosen later, balanced in every eight; the second of a pair of
/// participants sees the opposite.
std::vector<bool> sides_in_eights(std::uint64_t seed, std::uint64_t number, std::size_t trials);

}  // namespace pinchlab::study
