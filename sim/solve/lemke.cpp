// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/lemke.h"

#include <algorithm>
#include <cmath>

#include "base/at.h"

namespace pinchlab {

namespace {

// What is left of a diagonal of about 1, or of an entry, that is round-off.
constexpr double dependent = 1e-12;

/// The tableau B^-1 (w - M z - e z0 = q) of the basis B: of each row the coefficients of w, of z
/// and of the artificial z0, and its value.
class Tableau {
 public:
  explicit Tableau(Complementarity& p) : p_(p), n_(p.size), width_(2 * n_ + 2) {
    p_.tableau.assign(index(n_) * index(width_), 0.0);
    p_.basis.resize(index(n_));
    for (int i = 0; i < n_; ++i) {
      double* row = row_of(i);
      row[i] = 1.0;
      for (int k = 0; k < n_; ++k) row[n_ + k] = -p_.entry(i, k);
      if (!at(p_.either, i)) row[artificial()] = -1.0;
      row[value()] = at(p_.q, i);
      at(p_.basis, i) = i;
    }
  }

  int artificial() const { return 2 * n_; }

  /// What the artificial variable is, while it is one of the basis.
  double missing() {
    for (int i = 0; i < n_; ++i) {
      if (basic(i) == artificial()) return value_of(i);
    }
    return 0.0;
  }
  double value_of(int row) { return row_of(row)[value()]; }
  int basic(int row) const { return at(p_.basis, row); }

  /// w_i of z_i and the other way round.
  int complement_of(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }

  /// Whether the row's variable may not become negative.
  bool is_bound(int row) const {
    const int v = basic(row);
    return v == artificial() || !at(p_.either, v < n_ ? v : v - n_);
  }

  double entry(int row, int column) { return row_of(row)[column]; }

  void pivot(int row, int column) {
    double* const pivoted = row_of(row);
    const double inverse = 1.0 / pivoted[column];
    for (int k = 0; k < width_; ++k) pivoted[k] *= inverse;
    pivoted[column] = 1.0;
    for (int i = 0; i < n_; ++i) {
      double* const other = row_of(i);
      const double factor = other[column];
      if (i == row || factor == 0.0) continue;
      for (int k = 0; k < width_; ++k) other[k] -= factor * pivoted[k];
      other[column] = 0.0;
    }
    at(p_.basis, row) = column;
  }

  /// The row whose variable is the first to come down to zero while `column` grows; -1: none does.
  /// The artificial variable goes before others.
  int first_to_vanish(int column) {
    int first = -1;
    for (int i = 0; i < n_; ++i) {
      if (!is_bound(i) || entry(i, column) <= dependent) continue;
      if (first < 0 || vanishes_before(i, first, column)) first = i;
    }
    return first;
  }

 private:
  double* row_of(int row) { return p_.tableau.data() + index(row) * index(width_); }
  int value() const { return 2 * n_ + 1; }

  /// Of two rows, in the order of value, coefficient of w_0, of w_1, ... over their entries.
  bool vanishes_before(int i, int j, int column) {
    const double *a = row_of(i), *b = row_of(j);
    const auto difference = [&](int k) { return a[k] * b[column] - b[k] * a[column]; };
    const auto tells = [&](int k) {
      return std::abs(difference(k)) >
             1e-14 * (std::abs(a[k] * b[column]) + std::abs(b[k] * a[column]));
    };
    if (tells(value())) return difference(value()) < 0.0;
    if (basic(i) == artificial() || basic(j) == artificial()) return basic(i) == artificial();
    for (int k = 0; k < n_; ++k) {
      if (tells(k)) return difference(k) < 0.0;
    }
    return false;
  }

  Complementarity& p_;
  int n_, width_;
};

/// Brings in what may have either sign; what repeats others stays out.
void solve_for_either(const Complementarity& p, Tableau& tableau) {
  for (int i = 0; i < p.size; ++i) {
    if (!at(p.either, i)) continue;
    if (std::abs(tableau.entry(i, p.size + i)) > dependent) tableau.pivot(i, p.size + i);
  }
}

/// The bound row of least value; -1: none is negative.
int most_negative(const Complementarity& p, Tableau& tableau) {
  int worst = -1;
  for (int i = 0; i < p.size; ++i) {
    if (!tableau.is_bound(i) || tableau.value_of(i) >= 0.0) continue;
    if (worst < 0 || tableau.value_of(i) < tableau.value_of(worst)) worst = i;
  }
  return worst;
}

}  // namespace

void Complementarity::begin(int count) {
  size = count;
  matrix.assign(index(count) * index(count), 0.0);
  q.assign(index(count), 0.0);
  either.assign(index(count), 0);
}

bool solve_complementarity(Complementarity& p) {
  Tableau tableau(p);
  solve_for_either(p, tableau);
  if (int leaving = most_negative(p, tableau); leaving >= 0) {
    int entering = tableau.artificial();
    const int most_pivots = 50 + 4 * p.size;  // mostly it takes about as many as the size
    // Of what it starts with elimination leaves some hundred units in the last place.
    const double least = -1e-13 * tableau.value_of(leaving);
    for (int pivots = 0; leaving >= 0 && pivots < most_pivots; ++pivots) {
      const int left = tableau.basic(leaving);
      tableau.pivot(leaving, entering);
      if (tableau.missing() <= least) break;
      entering = tableau.complement_of(left);
      leaving = tableau.first_to_vanish(entering);
    }
    if (tableau.missing() > std::max(least, p.round_off)) return false;
  }
  p.z.assign(index(p.size), 0.0);
  p.bears.assign(index(p.size), 0);
  for (int i = 0; i < p.size; ++i) {
    const int z = tableau.basic(i) - p.size;
    if (z < 0 || z >= p.size) continue;
    at(p.z, z) = tableau.value_of(i);
    at(p.bears, z) = 1;
  }
  return true;
}

void correct(const std::vector<double>& missing, Complementarity& p) {
  const std::size_t width = 2 * index(p.size) + 2;
  for (std::size_t i = 0; i < index(p.size); ++i) {
    const int z = p.basis[i] - p.size;
    if (z < 0 || z >= p.size) continue;
    for (std::size_t k = 0; k < index(p.size); ++k) {
      at(p.z, z) += p.tableau[i * width + k] * missing[k];
    }
  }
}

}  // namespace pinchlab
