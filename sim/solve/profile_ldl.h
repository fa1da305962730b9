// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// A direct solver for symmetric matrices that are narrow about their diagonal.

#include <cstddef>
#include <vector>

#include "base/at.h"

namespace pinchlab {

/// L D L^T factors without pivoting inside the matrix' profile (George & Liu 1981, ch. 4): row u is
/// kept from its first entry to the diagonal. The work is the sum of the squared widths: linear for
/// a cable, whose matrix is tridiagonal; then it goes by a shorter way to the same bits.
///
/// A pivot below `dependence` times the diagonal's scale, or below what elimination makes of the
/// round-off of earlier ones,
///     noise(u) = round_off scale(u) + unsure(u) + sum L(u,v)^2 noise(v),
/// means that the row repeats earlier ones; its unknown is left at zero (a basic solution) and
/// counted. Only rows that repeat none count to the widths: n of which r do so take n r^2.
class ProfileLdl {
 public:
  /// Of a row that repeats others, elimination leaves round-off: 1e-16 of the scale for each of the
  /// rows that couple with it. What is left with less than a thousand times that shows no digit.
  static constexpr double dependence = 1e-13;

  /// Of the scale: some units in a pivot's last place.
  static constexpr double round_off = 1e-15;

  /// Starts an empty matrix.
  void clear() {
    first_.clear();
    offset_.clear();
    used_ = 0;
    narrow_ = true;
  }

  /// Appends row u = size(), of zeros, whose first entry stands in column `first` <= u. The row's
  /// entry in column v is the result's [v], until the next call.
  double* append(int first) {
    const int u = size();
    narrow_ = narrow_ && first + 1 >= u;
    first_.push_back(first);
    offset_.push_back(static_cast<int>(used_) - first);
    const std::size_t begin = used_;
    used_ += index(u - first + 1);
    if (entries_.size() < used_) entries_.resize(2 * used_);
    for (std::size_t k = begin; k < used_; ++k) entries_[k] = 0.0;
    return row(u);
  }

  int size() const { return static_cast<int>(first_.size()); }

  /// First column of row u, and its entries as from `append`.
  int first(int u) const { return at(first_, u); }
  double* row(int u) { return entries_.data() + at(offset_, u); }

  /// Factors the matrix with scale[u] (1 + ridge) added to its diagonal, and leaves it as it is.
  /// scale[u] > 0 is also the size against which pivot u is judged. Of matrices J J^T whose rows J
  /// are not known to all digits, unsure[u] is the square of what row u may be off by; empty: none
  /// is. Returns how many rows were dependent.
  int factor(const std::vector<double>& scale, double ridge,
             const std::vector<double>& unsure = {});

  /// Pivot u of the factors, over its scale; 0: of a dependent row.
  double pivot(int u, double scale) const;

  /// Solves in place.
  void solve(std::vector<double>& x) const;

 private:
  int factor_narrow(const std::vector<double>& scale, double ridge,
                    const std::vector<double>& unsure);
  void solve_narrow(std::vector<double>& x) const;
  void solve_independent(std::vector<double>& x) const;

  std::vector<int> first_;
  std::vector<int> offset_;      // A(u,v) is entries_[offset_[u] + v]
  std::size_t used_ = 0;         // of entries_
  bool narrow_ = true;           // no row reaches back beyond the one before: tridiagonal
  std::vector<double> entries_;  // rows of the matrix

  // By factor. Of a narrow matrix all rows are factored, of any other those that repeat none.
  std::vector<int> independent_;                   // these rows; u and v below count them
  std::vector<int> independent_before_;            // of each row, how many of them come before it
  std::vector<int> factor_first_, factor_offset_;  // L(u,v) is factors_[factor_offset_[u] + v]
  std::vector<double> factors_;     // rows of L, unit diagonal not stored; of a narrow matrix
                                    // L(u, u - 1) of each u, or 0
  std::vector<double> reciprocal_;  // of the pivots (0: dependent, of a narrow matrix)
  std::vector<double> noise_;       // of the pivots
};

}  // namespace pinchlab
