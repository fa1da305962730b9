// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/lemke.h"

#include <utility>

#include "base/at.h"

namespace pinchlab {

namespace {

// What is nothing of an entry of about 1: on the way, where each pivot divides what round-off there
// is, and in the matrix itself.
constexpr double dependent = 1e-17, repeated = 1e-26;
// Of numbers of 104 bits, some hundred units in the last place.
constexpr double rounding = 1e-29;

/// The tableau B^-1 (w - M z - e z0 = q) of the basis B: of each row the coefficients of w, of z
/// and of the artificial z0, and its value.
class Tableau {
 public:
  explicit Tableau(Complementarity& p) : p_(p), n_(p.size), width_(2 * n_ + 2) {
    p_.tableau.assign(index(n_) * index(width_), 0.0);
    p_.basis.resize(index(n_));
    for (int i = 0; i < n_; ++i) {
      Extended* row = row_of(i);
      row[i] = 1.0;
      for (int k = 0; k < n_; ++k) row[n_ + k] = -p_.entry(i, k);
      row[n_ + i] -= p_.yielding;
      if (!at(p_.either, i)) row[artificial()] = -1.0;
      row[value()] = at(p_.q, i);
      at(p_.basis, i) = i;
    }
  }

  int artificial() const { return 2 * n_; }

  /// What the artificial variable is, while it is one of the basis.
  Extended missing() {
    for (int i = 0; i < n_; ++i) {
      if (basic(i) == artificial()) return value_of(i);
    }
    return 0.0;
  }
  Extended value_of(int row) { return row_of(row)[value()]; }
  int basic(int row) const { return at(p_.basis, row); }

  /// w_i of z_i and the other way round.
  int complement_of(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }

  /// Whether the row's variable may not become negative.
  bool is_bound(int row) const {
    const int v = basic(row);
    return v == artificial() || !at(p_.either, v < n_ ? v : v - n_);
  }

  Extended entry(int row, int column) { return row_of(row)[column]; }

  void pivot(int row, int column) {
    Extended* const pivoted = row_of(row);
    const Extended inverse = Extended(1.0) / pivoted[column];
    for (int k = 0; k < width_; ++k) pivoted[k] *= inverse;
    pivoted[column] = 1.0;
    for (int i = 0; i < n_; ++i) {
      Extended* const other = row_of(i);
      const Extended factor = other[column];
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
  Extended* row_of(int row) { return p_.tableau.data() + index(row) * index(width_); }
  int value() const { return 2 * n_ + 1; }

  /// Of two rows, in the order of value, coefficient of w_0, of w_1, ... over their entries.
  bool vanishes_before(int i, int j, int column) {
    const Extended *a = row_of(i), *b = row_of(j);
    const auto difference = [&](int k) { return a[k] * b[column] - b[k] * a[column]; };
    const auto tells = [&](int k) {
      return abs(difference(k)) > rounding * (abs(a[k] * b[column]) + abs(b[k] * a[column]));
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
    if (abs(tableau.entry(i, p.size + i)) > dependent) tableau.pivot(i, p.size + i);
  }
}

/// Gauss' method for the unknowns p.basis, all w of which are to be zero.
class Elimination {
 public:
  Elimination(Complementarity& p, double yielding) : p_(p), n_(static_cast<int>(p.basis.size())) {
    p_.tableau.resize(index(n_) * index(n_ + 1));
    for (int i = 0; i < n_; ++i) {
      for (int k = 0; k < n_; ++k) entry(i, k) = p_.entry(unknown(i), unknown(k));
      entry(i, i) += yielding;
      entry(i, n_) = -at(p_.q, unknown(i));
    }
  }

  /// Makes an upper triangle of what does not repeat others; what does is no unknown any more.
  void run() {
    for (int column = 0; column < n_; ++column) {
      int greatest = rank_;
      for (int i = rank_ + 1; i < n_; ++i) {
        if (abs(entry(i, column)) > abs(entry(greatest, column))) greatest = i;
      }
      if (rank_ == n_ || abs(entry(greatest, column)) <= repeated) {
        unknown(column) = -1;
        continue;
      }
      for (int k = column; k <= n_; ++k) std::swap(entry(rank_, k), entry(greatest, k));
      for (int i = rank_ + 1; i < n_; ++i) {
        const Extended factor = entry(i, column) / entry(rank_, column);
        if (factor == 0.0) continue;
        for (int k = column; k <= n_; ++k) entry(i, k) -= factor * entry(rank_, k);
      }
      ++rank_;
    }
  }

  void substitute() {
    int row = rank_;
    for (int column = n_ - 1; column >= 0; --column) {
      if (unknown(column) < 0) continue;
      --row;
      Extended value = entry(row, n_);
      for (int k = column + 1; k < n_; ++k) {
        if (unknown(k) >= 0) value -= entry(row, k) * at(p_.z, unknown(k));
      }
      at(p_.z, unknown(column)) = value / entry(row, column);
    }
  }

 private:
  Extended& entry(int row, int column) {
    return p_.tableau[index(row) * index(n_ + 1) + index(column)];
  }
  int& unknown(int i) { return at(p_.basis, i); }

  Complementarity& p_;
  int n_, rank_ = 0;
};

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

void solve_for_bearing(Complementarity& p, double yielding) {
  std::vector<int>& unknowns = p.basis;
  unknowns.clear();
  for (int i = 0; i < p.size; ++i) {
    if (at(p.bears, i) != 0) unknowns.push_back(i);
  }
  Elimination elimination(p, yielding);
  p.z.assign(index(p.size), 0.0);
  elimination.run();
  elimination.substitute();
}

bool solve_complementarity(Complementarity& p) {
  Tableau tableau(p);
  solve_for_either(p, tableau);
  if (int leaving = most_negative(p, tableau); leaving >= 0) {
    int entering = tableau.artificial();
    const int most_pivots = 50 + 4 * p.size;  // mostly it takes about as many as the size
    // Of what it starts with: speeds are known to 1e-16.
    const double least = -1e-20 * static_cast<double>(tableau.value_of(leaving));
    for (int pivots = 0; leaving >= 0 && pivots < most_pivots; ++pivots) {
      const int left = tableau.basic(leaving);
      tableau.pivot(leaving, entering);
      if (tableau.missing() <= least) break;
      entering = tableau.complement_of(left);
      leaving = tableau.first_to_vanish(entering);
    }
    if (tableau.missing() > least) return false;
  }
  p.bears.assign(index(p.size), 0);
  for (int i = 0; i < p.size; ++i) {
    const int z = tableau.basic(i) - p.size;
    if (z >= 0 && z < p.size) at(p.bears, z) = 1;
  }
  solve_for_bearing(p, p.yielding);
  return true;
}

}  // namespace pinchlab
