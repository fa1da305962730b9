// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/sequential.h"

#include <fmt/format.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_randist.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>

#include "analysis/gsl_support.h"
#include "analysis/tests_2afc.h"
#include "base/counted.h"
#include "base/input_error.h"

namespace pinchlab::analysis {
namespace {

double spent(Spending spending, double alpha, double t) {
  return spending == Spending::obrien_fleming
             ? 2 * gsl_cdf_ugaussian_Q(gsl_cdf_ugaussian_Qinv(alpha / 2) / std::sqrt(t))
             : alpha * std::log(1 + (std::numbers::e - 1) * t);
}

// The density of a Brownian motion that has not left the bounds, on an even grid with Simpson's
// weights.
struct Alive {
  std::vector<double> at, density, weight;
};

constexpr int intervals = 800;    // even
constexpr double far_away = 9.0;  // standard deviations that no bound need be beyond

Alive grid(double half_width) {
  Alive alive;
  const double step = 2 * half_width / intervals;
  for (int i = 0; i <= intervals; ++i) {
    alive.at.push_back(-half_width + step * i);
    alive.weight.push_back(step / 3 * (i == 0 || i == intervals ? 1 : i % 2 == 1 ? 4 : 2));
  }
  alive.density.resize(alive.at.size());
  return alive;
}

// P(alive until now, and beyond `bound` after a step of variance `step`), of the upper side.
double crossing(const Alive& alive, double bound, double step) {
  double sum = 0.0;
  for (std::size_t i = 0; i < alive.at.size(); ++i) {
    sum += alive.weight[i] * alive.density[i] *
           gsl_cdf_ugaussian_Q((bound - alive.at[i]) / std::sqrt(step));
  }
  return sum;
}

Alive moved(const Alive& alive, double bound, double step, double end) {
  Alive next = grid(std::min(bound, far_away * std::sqrt(end)));
  for (std::size_t j = 0; j < next.at.size(); ++j) {
    for (std::size_t i = 0; i < alive.at.size(); ++i) {
      next.density[j] += alive.weight[i] * alive.density[i] *
                         gsl_ran_gaussian_pdf(next.at[j] - alive.at[i], std::sqrt(step));
    }
  }
  return next;
}

void check(bool good, const char* flag, const char* message) {
  if (!good) throw InputError(flag, message);
}

void check_stopping(const StoppingQuestion& question) {
  check_question(question.truth);
  check(!question.participants.empty(), "--participants", "name the participants at each look");
  for (std::size_t i = 0; i < question.participants.size(); ++i) {
    const std::int64_t before = i == 0 ? 0 : question.participants[i - 1];
    check(question.participants[i] > before && question.participants[i] <= 10000, "--participants",
          "must increase, and be 10000 at most");
  }
  check(question.participants.size() <= 100, "--participants", "at most 100 looks");
  if (question.rule == StoppingRule::bayes_factor) {
    check(question.truth.trials == 1, "--trials",
          "must be 1 for the Bayes factor, which takes answers as independent");
    check(question.bayes_factor > 1 && question.bayes_factor <= 1e6, "--bayes-factor",
          "must be over 1");
  }
}

// 1: finds a preference; -1: finds that there is none; 0: goes on.
int decision(const StoppingQuestion& question, const Look& look, const std::vector<unsigned>& drawn,
             std::int64_t participants) {
  if (question.rule != StoppingRule::bayes_factor)
    return sign_flips_reject(drawn, participants, look.nominal_p) ? 1 : 0;
  const double log_factor = log_bayes_factor({drawn[1], drawn[0]});
  const double limit = std::log(question.bayes_factor);
  return log_factor >= limit ? 1 : log_factor <= -limit ? -1 : 0;
}

Characteristics simulate(const StoppingQuestion& question, const std::vector<Look>& looks,
                         int studies, std::uint64_t seed) {
  const std::vector<double> one = answers_of_one(question.truth);
  Characteristics result;
  result.stopped_at.assign(looks.size(), 0.0);
  for (int study = 0; study < studies; ++study) {
    const Rng rng = make_rng(RandomUse::power, seed, static_cast<std::uint64_t>(study));
    std::vector<unsigned> drawn(one.size()), more(one.size());
    std::int64_t have = 0;
    for (std::size_t i = 0; i < looks.size(); ++i) {
      const std::int64_t now =
          question.participants[question.participants.size() - looks.size() + i];
      gsl_ran_multinomial(rng.get(), one.size(), static_cast<unsigned>(now - have), one.data(),
                          more.data());
      for (std::size_t k = 0; k < one.size(); ++k) drawn[k] += more[k];
      have = now;
      const int found = decision(question, looks[i], drawn, now);
      if (found == 0 && i + 1 < looks.size()) continue;
      result.finds += found == 1 ? 1 : 0;
      result.finds_none += found == -1 ? 1 : 0;
      result.participants += static_cast<double>(now);
      ++result.stopped_at[i];
      break;
    }
  }
  for (double* value : {&result.finds, &result.finds_none, &result.participants}) *value /= studies;
  for (double& share : result.stopped_at) share /= studies;
  return result;
}

}  // namespace

std::vector<Look> sequential_bounds(Spending spending, double alpha,
                                    const std::vector<double>& fractions) {
  std::vector<Look> looks;
  Alive alive;
  double before = 0.0, spent_before = 0.0;
  for (const double t : fractions) {
    const double side = spent(spending, alpha / 2, t) - spent_before;
    const double step = t - before;
    // The first step begins at 0; on later ones the bound is searched for.
    double z = far_away;
    if (looks.empty()) {
      z = std::min(far_away, gsl_cdf_ugaussian_Qinv(side));
    } else {
      double low = 0.0, high = far_away;
      for (int i = 0; i < 60; ++i) {
        z = (low + high) / 2;
        (crossing(alive, z * std::sqrt(t), step) > side ? low : high) = z;
      }
    }
    const double bound = z * std::sqrt(t);
    if (looks.empty()) {
      alive = grid(std::min(bound, far_away * std::sqrt(t)));
      for (std::size_t i = 0; i < alive.at.size(); ++i)
        alive.density[i] = gsl_ran_gaussian_pdf(alive.at[i], std::sqrt(t));
    } else {
      alive = moved(alive, bound, step, t);
    }
    spent_before += side;
    before = t;
    looks.push_back({t, z, 2 * gsl_cdf_ugaussian_Q(z), 2 * spent_before});
  }
  return looks;
}

StoppingAnswer stopping_rule(const StoppingQuestion& question, int studies, std::uint64_t seed) {
  check_stopping(question);
  StoppingAnswer answer;
  answer.studies = studies;
  const double alpha = question.truth.alpha;
  const auto all = static_cast<double>(question.participants.back());
  std::vector<double> fractions;
  for (const std::int64_t n : question.participants)
    fractions.push_back(static_cast<double>(n) / all);
  if (question.rule == StoppingRule::fixed) {
    answer.looks = {{1.0, gsl_cdf_ugaussian_Qinv(alpha / 2), alpha, alpha}};
  } else if (question.rule == StoppingRule::bayes_factor) {
    for (const double t : fractions) answer.looks.push_back({t, 0.0, 0.0, 0.0});
  } else {
    answer.looks = sequential_bounds(
        question.rule == StoppingRule::pocock ? Spending::pocock : Spending::obrien_fleming, alpha,
        fractions);
  }
  answer.with = simulate(question, answer.looks, studies, seed);
  StoppingQuestion none = question;
  none.truth.share = 0.5;
  answer.without = simulate(none, answer.looks, studies, seed + 1);
  return answer;
}

namespace {

// What no answers of so many participants can do. The least p is that of as many fair coins that
// fall alike, both ways; the Bayes factor is largest there, and least where half chose either.
std::string out_of_reach(const StoppingQuestion& question, const Look& look, std::int64_t n) {
  const std::string with = "With " + counted(n, "participant");
  if (question.rule != StoppingRule::bayes_factor) {
    const double least = std::exp2(1.0 - static_cast<double>(n));
    if (look.nominal_p >= least) return "";
    return fmt::format("{} p is {:.3g} at least: no answers stop it there.\n", with, least);
  }
  const double limit = std::log(question.bayes_factor);
  const double most = log_bayes_factor({n, 0}), least = log_bayes_factor({n / 2, n - n / 2});
  if (most < limit && least > -limit) {
    return fmt::format("{} the Bayes factor is {:.3g} to {:.3g}: no answers stop it there.\n", with,
                       std::exp(least), std::exp(most));
  }
  if (least > -limit) {
    return fmt::format(
        "{} the Bayes factor is {:.3g} at least: no answers say there that none is preferred.\n",
        with, std::exp(least));
  }
  return "";
}

std::string out_of_reach(const StoppingQuestion& question, const StoppingAnswer& answer) {
  const std::size_t skipped = question.participants.size() - answer.looks.size();
  std::string looks;
  for (std::size_t i = 0; i < answer.looks.size(); ++i)
    looks += out_of_reach(question, answer.looks[i], question.participants[i + skipped]);
  return looks.empty() ? "" : "\n" + looks;
}

}  // namespace

std::string stopping_text(const StoppingQuestion& question, const StoppingAnswer& answer) {
  const bool is_bayes = question.rule == StoppingRule::bayes_factor;
  std::string text = is_bayes ? fmt::format(
                                    "Stop when the Bayes factor is {:g} or more, or 1/{:g} "
                                    "or less.\n\n",
                                    question.bayes_factor, question.bayes_factor)
                              : "Stop when p is at most that of the look.\n\n";
  text += fmt::format("{:>12} {:>10} {:>10} {:>10} {:>14} {:>14}\n", "participants", "p at most",
                      "z", "spent", "stop, no diff.", "stop, share");
  const std::size_t skipped = question.participants.size() - answer.looks.size();
  for (std::size_t i = 0; i < answer.looks.size(); ++i) {
    const Look& look = answer.looks[i];
    const auto number = [&](double value, const char* format) {
      return is_bayes ? std::string("-") : fmt::format(fmt::runtime(format), value);
    };
    text += fmt::format("{:>12} {:>10} {:>10} {:>10} {:>14.3f} {:>14.3f}\n",
                        question.participants[i + skipped], number(look.nominal_p, "{:.3g}"),
                        number(look.z, "{:.4f}"), number(look.spent, "{:.5f}"),
                        answer.without.stopped_at[i], answer.with.stopped_at[i]);
  }
  text += out_of_reach(question, answer);
  const auto line = [&](const char* what, const Characteristics& result) {
    return fmt::format(
        "{}: finds a preference in {:.1f} % of {} simulated studies{}, with {:.1f} participants on "
        "average.\n",
        what, 100 * result.finds, answer.studies,
        is_bayes ? fmt::format(", none in {:.1f} %", 100 * result.finds_none) : "",
        result.participants);
  };
  return text + "\n" + line("Without any difference", answer.without) +
         line(fmt::format("At a share of {:g}", question.truth.share).c_str(), answer.with);
}

std::string stopping_json(const StoppingQuestion& question, const StoppingAnswer& answer) {
  static const std::map<StoppingRule, const char*> names = {
      {StoppingRule::fixed, "fixed"},
      {StoppingRule::obrien_fleming, "obrien-fleming"},
      {StoppingRule::pocock, "pocock"},
      {StoppingRule::bayes_factor, "bayes-factor"}};
  const bool is_bayes = question.rule == StoppingRule::bayes_factor;
  const std::size_t skipped = question.participants.size() - answer.looks.size();
  nlohmann::ordered_json participants = nlohmann::ordered_json::array(), looks = participants;
  for (std::size_t i = 0; i < answer.looks.size(); ++i) {
    const Look& look = answer.looks[i];
    participants.push_back(question.participants[i + skipped]);
    nlohmann::ordered_json entry = nlohmann::ordered_json::object();
    if (!is_bayes) entry = {{"p_at_most", look.nominal_p}, {"z", look.z}, {"spent", look.spent}};
    looks.push_back(std::move(entry));
  }
  const auto characteristics = [](const Characteristics& result) {
    return nlohmann::ordered_json{{"finds", result.finds},
                                  {"finds_none", result.finds_none},
                                  {"participants", result.participants},
                                  {"stopped_at", result.stopped_at}};
  };
  nlohmann::ordered_json file = {{"format", "pinchlab-stopping 1"},
                                 {"rule", names.at(question.rule)},
                                 {"participants", participants},
                                 {"looks", looks},
                                 {"alpha", question.truth.alpha},
                                 {"share", question.truth.share},
                                 {"trials", question.truth.trials},
                                 {"icc", question.truth.icc},
                                 {"studies", answer.studies},
                                 {"without_difference", characteristics(answer.without)},
                                 {"at_share", characteristics(answer.with)}};
  if (is_bayes) file["bayes_factor"] = question.bayes_factor;
  return file.dump(2) + "\n";
}

}  // namespace pinchlab::analysis
