// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/mixed_model.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multimin.h>
#include <gsl/gsl_roots.h>

#include <cmath>
#include <initializer_list>
#include <map>
#include <memory>
#include <optional>

#include "analysis/gsl_support.h"
#include "analysis/tests_2afc.h"

namespace pinchlab::analysis {

namespace {

struct FreeGsl {
  void operator()(gsl_matrix* m) const { gsl_matrix_free(m); }
  void operator()(gsl_vector* v) const { gsl_vector_free(v); }
  void operator()(gsl_multimin_fminimizer* m) const { gsl_multimin_fminimizer_free(m); }
  void operator()(gsl_root_fsolver* s) const { gsl_root_fsolver_free(s); }
  void operator()(gsl_integration_fixed_workspace* w) const { gsl_integration_fixed_free(w); }
};
template <class T>
using Gsl = std::unique_ptr<T, FreeGsl>;

double log1p_exp(double x) {
  return x > 0.0 ? x + std::log1p(std::exp(-x)) : std::log1p(std::exp(x));
}
double logistic(double x) {
  return x >= 0.0 ? 1.0 / (1.0 + std::exp(-x)) : std::exp(x) / (1.0 + std::exp(x));
}

// Laplace: -2 log integral of exp(-f(u, v)) ~ 2 f(mode) + log det H(mode), with
//   f = sum_c w_c [sum_j (n log(1 + e^eta) - k eta) + u_c^2 / 2] + sum_j v_j^2 / 2.
// H is diagonal in u and in v with one dense block between them, so u is eliminated (Schur
// complement).
class Laplace {
 public:
  explicit Laplace(const MixedData& data)
      : data_(data),
        u_(data.patterns.size(), 0.0),
        v_(data.demonstrations, 0.0),
        schur_(gsl_matrix_alloc(data.demonstrations, data.demonstrations)),
        rhs_(gsl_vector_alloc(data.demonstrations)),
        step_v_(gsl_vector_alloc(data.demonstrations)) {}

  double deviance(const MixedParameters& parameters) {
    parameters_ = parameters;
    // Newton from the last mode: f is convex, so halving an uphill step is all the care it needs.
    double f = objective(u_, v_);
    for (int iteration = 0; iteration < 100; ++iteration) {
      if (assemble_and_solve() < 1e-12 * (1.0 + std::abs(f))) break;
      double trial = f;
      for (int halving = 0; halving < 34; ++halving) {
        try_step(std::ldexp(1.0, -halving));
        trial = objective(trial_u_, trial_v_);
        if (trial <= f) break;
      }
      if (!(trial <= f)) break;  // at round-off
      f = trial;
      u_.swap(trial_u_);
      v_.swap(trial_v_);
    }
    double log_det = log_det_u_;
    for (size_t j = 0; j < v_.size(); ++j)
      log_det += 2.0 * std::log(gsl_matrix_get(schur_.get(), j, j));
    return 2.0 * f + log_det;
  }

 private:
  [[nodiscard]] double eta(double u, double v) const {
    return parameters_.intercept + parameters_.sd_participant * u +
           parameters_.sd_demonstration * v;
  }

  [[nodiscard]] double objective(const std::vector<double>& u, const std::vector<double>& v) const {
    double f = 0.0;
    for (size_t c = 0; c < u.size(); ++c) {
      double one = 0.5 * u[c] * u[c];
      for (const Cell& cell : data_.patterns[c].cells) {
        const double x = eta(u[c], v[cell.demonstration]);
        one += cell.answers * log1p_exp(x) - cell.pinch * x;
      }
      f += data_.patterns[c].participants * one;
    }
    for (double value : v) f += 0.5 * value * value;
    return f;
  }

  // Newton's step (step_u_, step_v_) at the current (u, v); leaves the Cholesky factor of the Schur
  // complement in schur_ and log det of the u block in log_det_u_. Returns -gradient . step, twice
  // the expected fall.
  double assemble_and_solve() {
    const double sp = parameters_.sd_participant;
    const double sd = parameters_.sd_demonstration;
    const size_t k = v_.size();
    gsl_matrix_set_identity(schur_.get());
    std::vector<double> gradient_v(v_);
    std::vector<double> gradient_u(u_);
    std::vector<double> diagonal_u(u_.size(), 1.0);
    weight_.clear();
    for (size_t c = 0; c < u_.size(); ++c) {
      const double w = data_.patterns[c].participants;
      for (const Cell& cell : data_.patterns[c].cells) {
        const size_t j = cell.demonstration;
        const double mean = logistic(eta(u_[c], v_[j]));
        const double surplus = cell.answers * mean - cell.pinch;
        const double curvature = cell.answers * mean * (1.0 - mean);
        gradient_u[c] += sp * surplus;
        gradient_v[j] += w * sd * surplus;
        diagonal_u[c] += sp * sp * curvature;
        *gsl_matrix_ptr(schur_.get(), j, j) += w * sd * sd * curvature;
        weight_.push_back(sp * sd * curvature);
      }
    }
    for (size_t j = 0; j < k; ++j) gsl_vector_set(rhs_.get(), j, -gradient_v[j]);
    log_det_u_ = 0.0;
    size_t at = 0;
    for (size_t c = 0; c < u_.size(); ++c) {
      const double w = data_.patterns[c].participants;
      const auto& cells = data_.patterns[c].cells;
      const double* b = weight_.data() + at;
      for (size_t x = 0; x < cells.size(); ++x) {
        const size_t row = cells[x].demonstration;
        const double scaled = w * b[x] / diagonal_u[c];
        *gsl_vector_ptr(rhs_.get(), row) += scaled * gradient_u[c];
        // The lower triangle is all that Cholesky's factorisation reads; cells are sorted.
        double* schur_row = gsl_matrix_ptr(schur_.get(), row, 0);
        for (size_t y = 0; y <= x; ++y) schur_row[cells[y].demonstration] -= scaled * b[y];
      }
      log_det_u_ += w * std::log(diagonal_u[c]);
      at += cells.size();
    }
    gsl_linalg_cholesky_decomp1(schur_.get());
    gsl_linalg_cholesky_solve(schur_.get(), rhs_.get(), step_v_.get());

    step_u_.assign(u_.size(), 0.0);
    double fall = 0.0;
    at = 0;
    for (size_t c = 0; c < u_.size(); ++c) {
      double coupling = 0.0;
      for (const Cell& cell : data_.patterns[c].cells) {
        coupling += weight_[at++] * gsl_vector_get(step_v_.get(), cell.demonstration);
      }
      step_u_[c] = -(gradient_u[c] + coupling) / diagonal_u[c];
      fall -= data_.patterns[c].participants * gradient_u[c] * step_u_[c];
    }
    for (size_t j = 0; j < k; ++j) fall -= gradient_v[j] * gsl_vector_get(step_v_.get(), j);
    return fall;
  }

  void try_step(double scale) {
    trial_u_ = u_;
    trial_v_ = v_;
    for (size_t c = 0; c < u_.size(); ++c) trial_u_[c] += scale * step_u_[c];
    for (size_t j = 0; j < v_.size(); ++j) trial_v_[j] += scale * gsl_vector_get(step_v_.get(), j);
  }

  const MixedData& data_;
  MixedParameters parameters_;
  std::vector<double> u_, v_;              // the mode, one a pattern and one a demonstration
  std::vector<double> trial_u_, trial_v_;  // a candidate for it
  std::vector<double> step_u_;
  std::vector<double> weight_;  // d2f / du dv per cell, participants' weight left out
  double log_det_u_ = 0.0;
  Gsl<gsl_matrix> schur_;
  Gsl<gsl_vector> rhs_, step_v_;
};

struct Fit {
  MixedParameters parameters;
  double deviance = 0.0;
  bool converged = false;
};

// Minimises the deviance over both standard deviations and, unless it is given, the intercept. The
// deviance is even and smooth in a standard deviation, so its boundary 0 needs no constraint.
class Minimiser {
 public:
  explicit Minimiser(const MixedData& data) : laplace_(data) {}

  Fit minimise(const MixedParameters& start, std::optional<double> fixed_intercept,
               std::initializer_list<double> step_sizes) {
    fixed_ = fixed_intercept;
    Fit best{start};
    for (double size : step_sizes) best = run(best.parameters, size);
    // A simplex may be stuck where it has become flat: one of another size from there that comes no
    // lower says that there is nothing lower.
    constexpr double no_lower = 1e-7;  // of a deviance
    constexpr double other_sizes[] = {0.2, 0.05, 0.3};
    for (const double size : other_sizes) {
      if (best.converged) break;
      const double before = best.deviance;
      best = run(best.parameters, size);
      best.converged = best.converged || before - best.deviance < no_lower;
    }
    best.parameters.sd_participant = std::abs(best.parameters.sd_participant);
    best.parameters.sd_demonstration = std::abs(best.parameters.sd_demonstration);
    return best;
  }

 private:
  [[nodiscard]] MixedParameters unpack(const gsl_vector* x) const {
    MixedParameters parameters{fixed_ ? *fixed_ : gsl_vector_get(x, 2), gsl_vector_get(x, 0),
                               gsl_vector_get(x, 1)};
    return parameters;
  }

  static double evaluate(const gsl_vector* x, void* self) {
    auto* minimiser = static_cast<Minimiser*>(self);
    return minimiser->laplace_.deviance(minimiser->unpack(x));
  }

  Fit run(const MixedParameters& start, double size) {
    const size_t n = fixed_ ? 2 : 3;
    const Gsl<gsl_vector> x(gsl_vector_alloc(n));
    const Gsl<gsl_vector> first_steps(gsl_vector_alloc(n));
    gsl_vector_set(x.get(), 0, start.sd_participant);
    gsl_vector_set(x.get(), 1, start.sd_demonstration);
    if (!fixed_) gsl_vector_set(x.get(), 2, start.intercept);
    gsl_vector_set_all(first_steps.get(), size);
    gsl_multimin_function function{&Minimiser::evaluate, n, this};
    const Gsl<gsl_multimin_fminimizer> minimiser(
        gsl_multimin_fminimizer_alloc(gsl_multimin_fminimizer_nmsimplex2, n));
    gsl_multimin_fminimizer_set(minimiser.get(), &function, x.get(), first_steps.get());
    bool converged = false;
    for (int iteration = 0; iteration < 1000 && !converged; ++iteration) {
      if (gsl_multimin_fminimizer_iterate(minimiser.get()) != GSL_SUCCESS) break;
      converged = gsl_multimin_fminimizer_size(minimiser.get()) < 1e-5;
    }
    return {unpack(gsl_multimin_fminimizer_x(minimiser.get())),
            gsl_multimin_fminimizer_minimum(minimiser.get()), converged};
  }

  Laplace laplace_;
  std::optional<double> fixed_;
};

// Profile likelihood: the intercepts at which the best deviance is `rise` above the minimum.
class Profile {
 public:
  Profile(Minimiser& minimiser, const Fit& best, double rise)
      : minimiser_(minimiser), best_(best), rise_(rise) {}

  // The bound on one side (direction -1 or 1), or nothing within 30 log-odds.
  std::optional<double> bound(double direction) {
    double inner = best_.parameters.intercept;
    double reach = 0.25;
    while (excess(best_.parameters.intercept + direction * reach) < 0.0) {
      inner = best_.parameters.intercept + direction * reach;
      reach *= 2.0;
      if (reach > 30.0) return std::nullopt;
    }
    const double outer = best_.parameters.intercept + direction * reach;
    const Gsl<gsl_root_fsolver> solver(gsl_root_fsolver_alloc(gsl_root_fsolver_brent));
    gsl_function function{&Profile::evaluate, this};
    gsl_root_fsolver_set(solver.get(), &function, std::min(inner, outer), std::max(inner, outer));
    for (int iteration = 0; iteration < 100; ++iteration) {
      gsl_root_fsolver_iterate(solver.get());
      if (gsl_root_fsolver_x_upper(solver.get()) - gsl_root_fsolver_x_lower(solver.get()) < 1e-6)
        break;
    }
    return gsl_root_fsolver_root(solver.get());
  }

 private:
  double excess(double intercept) {
    return minimiser_.minimise(best_.parameters, intercept, {0.1}).deviance - best_.deviance -
           rise_;
  }
  static double evaluate(double intercept, void* self) {
    return static_cast<Profile*>(self)->excess(intercept);
  }

  Minimiser& minimiser_;
  const Fit& best_;
  double rise_;
};

// E[logistic(intercept + sd Z)], Z ~ N(0, 1), by Gauss-Hermite quadrature.
double population_share(double intercept, double sd) {
  constexpr size_t nodes = 64;
  const Gsl<gsl_integration_fixed_workspace> rule(
      gsl_integration_fixed_alloc(gsl_integration_fixed_hermite, nodes, 0.0, 0.5, 0.0, 0.0));
  struct Line {
    double intercept, sd;
  } line{intercept, sd};
  gsl_function function{[](double z, void* at) {
                          const auto* l = static_cast<const Line*>(at);
                          return logistic(l->intercept + l->sd * z);
                        },
                        &line};
  double integral = 0.0;
  gsl_integration_fixed(&function, &integral, rule.get());
  return integral / std::sqrt(2.0 * M_PI);
}

// Why this data cannot carry the model ("" if it can).
std::string why_not_estimable(const MixedData& data) {
  if (data.patterns.empty()) {
    return "the input is a table of counts, which does not say whose answers are whose";
  }
  double participants = 0.0;
  double answers = 0.0, pinch = 0.0, cells = 0.0;
  for (const Pattern& pattern : data.patterns) {
    participants += pattern.participants;
    cells += static_cast<double>(pattern.cells.size()) * static_cast<double>(pattern.cells.size());
    for (const Cell& cell : pattern.cells) {
      answers += pattern.participants * cell.answers;
      pinch += pattern.participants * cell.pinch;
    }
  }
  if (participants < 2.0)
    return "one participant; the spread between participants cannot be estimated";
  if (data.demonstrations < 2) {
    return "one demonstration; the spread between demonstrations cannot be estimated";
  }
  if (pinch == 0.0 || pinch == answers) {
    return "every answer is the same, so the intercept has no finite estimate";
  }
  if (cells > 1e6 || data.demonstrations > 500) {
    return "too large for the built-in fit; use the exported answers.csv with lme4 or a like "
           "package";
  }
  return "";
}

}  // namespace

MixedData mixed_data(const AnswersTable& table, const Group& group) {
  constexpr std::uint16_t outside = 0xFFFF;
  std::vector<std::uint16_t> place(table.demonstrations.size(), outside);
  for (size_t i = 0; i < group.demonstrations.size(); ++i) {
    place[group.demonstrations[i]] = static_cast<std::uint16_t>(i);
  }
  std::map<std::vector<Cell>, double> patterns;
  each_participant(table.answers, [&](std::span<const Answer> own) {
    std::vector<Cell> cells;
    for (const Answer& answer : own) {
      const std::uint16_t demonstration = place[answer.demonstration];
      if (demonstration == outside) continue;
      if (cells.empty() || cells.back().demonstration != demonstration)
        cells.push_back({demonstration, 0, 0});
      ++cells.back().answers;
      cells.back().pinch =
          static_cast<std::uint16_t>(cells.back().pinch + (answer.chose_pinch ? 1 : 0));
    }
    if (!cells.empty()) ++patterns[cells];
  });
  MixedData data;
  data.demonstrations = group.demonstrations.size();
  for (auto& [pattern, count] : patterns) data.patterns.push_back({pattern, count});
  return data;
}

double laplace_deviance(const MixedData& data, const MixedParameters& parameters) {
  return Laplace(data).deviance(parameters);
}

namespace {

MixedModel not_estimable(const std::string& reason) {
  MixedModel model;
  const Estimate none = Estimate::none(reason);
  model.intercept = model.intercept_low = model.intercept_high = model.p = none;
  model.sd_participant = model.sd_demonstration = model.mean_share = model.deviance = none;
  return model;
}

// Why a fit is no estimate ("" if it is one). Where participants or demonstrations are (nearly) all
// of one mind the likelihood rises towards infinity, and the search ends somewhere on the way;
// Laplace's approximation, which takes each mode for a normal distribution, has failed by then.
std::string why_diverged(const Fit& best, const Fit& null) {
  constexpr double farthest = 5.0;  // log-odds: 148 to 1, as good as always for any study
  const MixedParameters& p = best.parameters;
  if (!best.converged || !null.converged) return "the search for the best fit did not converge";
  if (p.sd_participant > farthest || p.sd_demonstration > farthest ||
      std::abs(p.intercept) > farthest) {
    return "the fit diverges (beyond 5 log-odds), since participants or demonstrations are nearly "
           "all of one mind";
  }
  return "";
}

}  // namespace

MixedModel fit_mixed_model(const MixedData& data, double alpha) {
  const std::string reason = why_not_estimable(data);
  if (!reason.empty()) return not_estimable(reason);
  const GslErrorsOff guard;
  Minimiser minimiser(data);
  // A second start from the first result frees a simplex that has collapsed too early.
  const Fit best = minimiser.minimise({0.0, 0.5, 0.5}, std::nullopt, {0.5, 0.1});
  const Fit null = minimiser.minimise(best.parameters, 0.0, {0.5, 0.1});
  const std::string diverged = why_diverged(best, null);
  if (!diverged.empty()) return not_estimable(diverged);
  Profile profile(minimiser, best, gsl_cdf_chisq_Qinv(alpha, 1.0));
  const std::optional<double> low = profile.bound(-1.0);
  const std::optional<double> high = profile.bound(1.0);
  if (!low || !high) {
    return not_estimable(
        "the likelihood does not bound the intercept (almost complete separation)");
  }
  MixedModel model;
  const auto at_boundary = [](double sd) { return sd < 1e-3 ? 0.0 : sd; };
  const double sd_p = at_boundary(best.parameters.sd_participant);
  const double sd_d = at_boundary(best.parameters.sd_demonstration);
  model.intercept = best.parameters.intercept;
  model.intercept_low = *low;
  model.intercept_high = *high;
  model.sd_participant = sd_p;
  model.sd_demonstration = sd_d;
  model.deviance = best.deviance;
  model.p = chi_square_p(std::max(0.0, null.deviance - best.deviance), 1.0);
  model.mean_share = population_share(best.parameters.intercept, std::hypot(sd_p, sd_d));
  return model;
}

}  // namespace pinchlab::analysis
