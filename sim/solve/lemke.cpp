// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/solve/lemke.h"

#include <cmath>
#include <utility>

#include "base/at.h"

namespace pinchlab {

namespace {

// What is nothing of an entry of about 1 in the matrix itself.
constexpr double repeated = 1e-26;

/// What is nothing among such numbers: of an entry of about 1 on the way, where each pivot divides
/// what round-off there is; of two terms that may be the same, some hundred units in their last
/// place; and of what the artificial variable starts with, as speeds are known to 1e-16.
template <class Number>
struct Nothing;
template <>
struct Nothing<double> {
  static constexpr double dependent = 1e-9, difference = 1e-13, missing = 1e-12;
};
template <>
struct Nothing<Extended> {
  static constexpr double dependent = 1e-17, difference = 1e-29, missing = 1e-20;
};

/// The tableau B^-1 (w - M z - e z0 = q) of the basis B: of each row the coefficients of what is
/// outside of B, of the variables w, z and the artificial z0, and its value.
template <class Number>
class Tableau {
 public:
  Tableau(Complementarity& p, std::vector<Number>& entries)
      : p_(p), entries_(entries), n_(p.size), width_(n_ + 2) {
    entries_.assign(index(n_) * index(width_), Number(0.0));
    p_.basis.resize(index(n_));
    p_.place.assign(2 * index(n_) + 1, -1);
    p_.outside.resize(index(n_) + 1);
    for (int i = 0; i < n_; ++i) {
      Number* const row = row_of(i);
      for (int k = 0; k < n_; ++k) row[k] = static_cast<Number>(-p_.entry(i, k));
      row[i] -= p_.yielding;
      if (!at(p_.either, i)) row[n_] = -1.0;
      row[value()] = static_cast<Number>(at(p_.q, i));
      at(p_.basis, i) = i;
      put_outside(n_ + i, i);
    }
    put_outside(artificial(), n_);
  }

  int artificial() const { return 2 * n_; }

  /// What the artificial variable is, while it is one of the basis.
  Number missing() {
    for (int i = 0; i < n_; ++i) {
      if (basic(i) == artificial()) return value_of(i);
    }
    return 0.0;
  }
  Number value_of(int row) { return row_of(row)[value()]; }
  int basic(int row) const { return at(p_.basis, row); }

  /// w_i of z_i and the other way round.
  int complement_of(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }

  /// Of a variable that is not one of the basis; -1: it is.
  int column_of(int variable) const { return at(p_.place, variable); }

  /// Whether the row's variable may not become negative.
  bool is_bound(int row) const {
    const int v = basic(row);
    return v == artificial() || !at(p_.either, v < n_ ? v : v - n_);
  }

  Number entry(int row, int column) { return row_of(row)[column]; }

  /// Exchanges the row's variable for the column's.
  void pivot(int row, int column) {
    Number* const pivoted = row_of(row);
    const Number inverse = Number(1.0) / pivoted[column];
    for (int k = 0; k < width_; ++k) pivoted[k] *= inverse;
    pivoted[column] = inverse;
    for (int i = 0; i < n_; ++i) {
      Number* const other = row_of(i);
      const Number factor = other[column];
      if (i == row || factor == 0.0) continue;
      other[column] = 0.0;
      for (int k = 0; k < width_; ++k) other[k] -= factor * pivoted[k];
    }
    const int left = basic(row);
    at(p_.basis, row) = at(p_.outside, column);
    at(p_.place, basic(row)) = -1;
    put_outside(left, column);
  }

  /// The row whose variable is the first to come down to zero while the column's grows; -1: none
  /// does. The artificial variable goes before others.
  int first_to_vanish(int column) {
    int first = -1;
    for (int i = 0; i < n_; ++i) {
      if (!is_bound(i) || !(entry(i, column) > Nothing<Number>::dependent)) continue;
      if (first < 0 || vanishes_before(i, first, column)) first = i;
    }
    return first;
  }

 private:
  Number* row_of(int row) { return entries_.data() + index(row) * index(width_); }
  int value() const { return n_ + 1; }

  void put_outside(int variable, int column) {
    at(p_.outside, column) = variable;
    at(p_.place, variable) = column;
  }

  /// Of two rows, in the order of value, coefficient of w_0, of w_1, ... over their entries.
  bool vanishes_before(int i, int j, int column) {
    using std::abs;
    const Number of_i = entry(i, column), of_j = entry(j, column);
    Number difference = 0.0;
    const auto tells = [&](const Number& a, const Number& b) {
      const Number before = a * of_j, after = b * of_i;
      difference = before - after;
      return abs(difference) > Nothing<Number>::difference * (abs(before) + abs(after));
    };
    if (tells(value_of(i), value_of(j))) return difference < 0.0;
    if (basic(i) == artificial() || basic(j) == artificial()) return basic(i) == artificial();
    for (int w = 0; w < n_; ++w) {
      const int k = column_of(w);
      const auto of_w = [&](int row) {
        return k >= 0 ? entry(row, k) : Number(basic(row) == w ? 1.0 : 0.0);
      };
      if (tells(of_w(i), of_w(j))) return difference < 0.0;
    }
    return false;
  }

  Complementarity& p_;
  std::vector<Number>& entries_;
  int n_, width_;
};

/// Brings in what may have either sign; what repeats others stays out.
template <class Number>
void solve_for_either(const Complementarity& p, Tableau<Number>& tableau) {
  using std::abs;
  for (int i = 0; i < p.size; ++i) {
    if (!at(p.either, i)) continue;
    const int column = tableau.column_of(p.size + i);
    if (abs(tableau.entry(i, column)) > Nothing<Number>::dependent) tableau.pivot(i, column);
  }
}

/// The bound row of least value; -1: none is negative.
template <class Number>
int most_negative(const Complementarity& p, Tableau<Number>& tableau) {
  int worst = -1;
  for (int i = 0; i < p.size; ++i) {
    if (!tableau.is_bound(i) || !(tableau.value_of(i) < 0.0)) continue;
    if (worst < 0 || tableau.value_of(i) < tableau.value_of(worst)) worst = i;
  }
  return worst;
}

template <class Number>
bool find_bearing(Complementarity& p, std::vector<Number>& entries) {
  Tableau<Number> tableau(p, entries);
  solve_for_either(p, tableau);
  if (int leaving = most_negative(p, tableau); leaving >= 0) {
    int entering = tableau.artificial();
    const int most_pivots = 50 + 4 * p.size;  // mostly it takes about as many as the size
    const double least = -Nothing<Number>::missing * static_cast<double>(tableau.value_of(leaving));
    for (int pivots = 0; leaving >= 0 && pivots < most_pivots; ++pivots) {
      const int left = tableau.basic(leaving);
      tableau.pivot(leaving, tableau.column_of(entering));
      if (!(tableau.missing() > least)) break;
      entering = tableau.complement_of(left);
      leaving = tableau.first_to_vanish(tableau.column_of(entering));
    }
    if (tableau.missing() > least) return false;
  }
  p.bears.assign(index(p.size), 0);
  for (int i = 0; i < p.size; ++i) {
    const int z = tableau.basic(i) - p.size;
    if (z >= 0 && z < p.size) at(p.bears, z) = 1;
  }
  return true;
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

bool find_bearing(Complementarity& p, Numbers numbers) {
  return numbers == Numbers::doubles ? find_bearing(p, p.rough_tableau)
                                     : find_bearing(p, p.tableau);
}

}  // namespace pinchlab
