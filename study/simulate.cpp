// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/simulate.h"

#include <fmt/format.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "study/http_client.h"
#include "study/server.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

double logistic(double x) {
  return 1 / (1 + std::exp(-x));
}

/// Asks again, as the page does, while the server says that too many ask from one address (429).
template <class Ask>
auto patiently(Ask ask) {
  constexpr int most = 300;
  constexpr std::chrono::milliseconds pause(200);
  auto answer = ask();
  for (int i = 0; i < most && answer && answer->status == 429; ++i) {
    std::this_thread::sleep_for(pause);
    answer = ask();
  }
  return answer;
}

// One who is not there.
class Simulated {
 public:
  Simulated(Desk& desk, const Truth& truth, std::uint64_t seed)
      : desk_(desk), truth_(truth), seed_(seed) {}

  void take_part(const std::string& address) {
    HttpClient client(address);
    const json started = post(client, "/api/start", {{"consent", true}});
    token_ = started.at("token");
    const std::string id = token_.substr(0, token_.find('.'));
    const auto [number, first_plan] = desk_.plan_of(id);
    const std::size_t count = first_plan.size();
    become(number);
    answer_questionnaire(client, "screen");
    answer_questionnaire(client, "before");
    for (std::size_t i = started.at("next"); i < count; ++i) {
      post(client, "/api/show", {{"index", i}});
      const std::string mp4 = started.at("trials").at(i).at("mp4");
      const auto clip = patiently([&] { return client.get(mp4, {{"Range", "bytes=0-0"}}); });
      if (!clip || clip->status != 206) throw std::runtime_error("a clip could not be fetched");
      post(client, "/api/answer", answer_to(desk_.plan_of(id).second[i], i));
    }
    answer_questionnaire(client, "after");
    post(client, "/api/save", {{"free_text", json::object()}});
  }

 private:
  // What one is like goes by the number, so that who comes first changes nothing.
  void become(std::uint64_t number) {
    gsl_rng_set(rng_.get(), (seed_ * 1000003 + number) & 0xFFFFFFFFU);  // mt19937 takes 32 bits
    own_lean_ = normal(truth_.spread);
    for (const auto& [name, value] : truth_.methods)
      own_values_[name] = value + normal(truth_.spread);
    for (const auto& [name, series] : truth_.series)
      own_thresholds_[name] = series.threshold + normal(series.spread);
  }

  double uniform() { return gsl_rng_uniform(rng_.get()); }
  double normal(double sd) { return gsl_ran_gaussian(rng_.get(), sd); }

  json post(HttpClient& client, const std::string& path, const json& body) {
    const auto answer = patiently([&] { return client.post(path, body, token_); });
    if (!answer || answer->status != 200) {
      throw std::runtime_error(fmt::format("{} was answered with {}", path,
                                           answer ? std::to_string(answer->status) : "nothing"));
    }
    return json::parse(answer->body);
  }

  // Every question, each answer as likely as another.
  void answer_questionnaire(HttpClient& client, const char* part) {
    const Questionnaire* questionnaire = desk_.config().questionnaires.find(part);
    if (questionnaire == nullptr) return;
    json answers = json::object();
    for (const Question& question : *questionnaire) answers[question.name] = answer_to(question);
    post(client, "/api/questionnaire", {{"part", part}, {"answers", answers}});
  }

  json answer_to(const Question& question) {
    const auto one_of = [&](std::size_t count) {
      return gsl_rng_uniform_int(rng_.get(), static_cast<unsigned long>(count));
    };
    switch (question.kind) {
      case QuestionKind::choice:
        return question.choices[one_of(question.choices.size())];
      case QuestionKind::scale:
        return 1 + one_of(static_cast<std::size_t>(question.points));
      case QuestionKind::number: {
        const double number = question.least + uniform() * (question.most - question.least);
        return question.is_whole ? std::clamp(std::round(number), std::ceil(question.least),
                                              std::floor(question.most))
                                 : number;
      }
      case QuestionKind::text:
        break;
    }
    return std::string("simulated").substr(0, question.longest);
  }

  // P(the first is chosen), sides and lapses left out.
  double share_of_first(const PlannedTrial& trial) {
    if (trial.level) {
      const TrueThreshold& series = truth_.series.at(trial.demonstration);
      const double from = *trial.level - own_thresholds_.at(trial.demonstration);
      const double g = logistic(2 * std::log(19.0) * from / series.width);
      const double hit = 0.5 + 0.5 * g;
      return desk_.config().graded_hit == "reference" ? hit : 1 - hit;
    }
    if (trial.first == "pinch" && trial.second == "baseline") {
      const auto known = truth_.shares.find(trial.demonstration);
      const double share = known == truth_.shares.end() ? 0.5 : known->second;
      return logistic(std::log(share / (1 - share)) + own_lean_);
    }
    return logistic(own_values_.at(trial.first) - own_values_.at(trial.second));
  }

  json answer_to(const PlannedTrial& trial, std::size_t index) {
    double share = trial.kind == TrialKind::attention ? 1.0 : share_of_first(trial);
    if (truth_.left != 0 && share > 0 && share < 1) {
      const double side = trial.pinch == Side::left ? truth_.left : -truth_.left;
      share = logistic(std::log(share / (1 - share)) + side);
    }
    const bool is_lapse = uniform() < truth_.lapses;
    const bool is_first = uniform() < (is_lapse ? 0.5 : share);
    const Side choice = is_first ? trial.pinch : opposite(trial.pinch);
    json body = {
        {"index", index},
        {"choice", to_string(choice)},
        {"reaction_time_s", std::round(1000 * gsl_ran_lognormal(rng_.get(), 0, 0.5)) / 1000},
        {"loops_watched", 1},
        {"focus_lost_count", 0},
        {"frame_count", 240},
        {"dropped_frames", 0},
        {"playback_errors", json::array()},
        {"input", "mouse"},
        {"encoding", "mp4"},
        {"window_width_px", 1920},
        {"window_height_px", 1080},
        {"clip_width_px", 1920},
        {"clip_height_px", 960},
        {"screen_width_px", 1920},
        {"screen_height_px", 1080},
        {"device_pixel_ratio", 1}};
    answer_besides(body, choice);
    return body;
  }

  // What is asked besides the choice: a tenth of ties, and the rest by throws of dice.
  void answer_besides(json& body, Side choice) {
    const TrialOptions& asked = desk_.config().trial;
    const auto die = [&](int sides) {
      return 1 +
             static_cast<int>(gsl_rng_uniform_int(rng_.get(), static_cast<unsigned long>(sides)));
    };
    if (asked.is_graded) {
      const bool is_tie = uniform() < 0.1;
      const int grade = is_tie ? 0 : die(3);
      body["preference"] = choice == Side::left ? -grade : grade;
      if (is_tie) body["choice"] = "tie";
    }
    if (asked.confidence > 0) body["confidence"] = die(asked.confidence);
    if (asked.reason > 0) {
      body["reason"] = std::string("simulated").substr(0, static_cast<std::size_t>(asked.reason));
    }
    if (asked.click_where) {
      body.update({{"where_side", to_string(opposite(choice))},
                   {"where_x", uniform()},
                   {"where_y", uniform()},
                   {"where_time_s", uniform()}});
    }
  }

  Desk& desk_;
  const Truth& truth_;
  std::uint64_t seed_;
  std::unique_ptr<gsl_rng, void (*)(gsl_rng*)> rng_{gsl_rng_alloc(gsl_rng_mt19937), &gsl_rng_free};
  double own_lean_ = 0;
  std::map<std::string, double> own_values_, own_thresholds_;
  std::string token_;
};

// Runs a server until it goes out of scope.
class Serving {
 public:
  explicit Serving(Server& server) : server_(server), thread_([&server] { server.run(); }) {}
  ~Serving() {
    server_.stop();
    thread_.join();
  }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;

 private:
  Server& server_;
  std::thread thread_;
};

// Who was broken off has answered a part; all who are running here are simulated.
void release_running(Desk& desk) {
  for (const Overview::Participant& participant : desk.overview().running) {
    desk.release(participant.id);
  }
}

}  // namespace

int simulate(Desk& desk, const Truth& truth, const SimulationOptions& options) {
  check_truth(desk.config(), truth);
  release_running(desk);
  const auto before = static_cast<int>(desk.overview().finished);
  const int to_come = std::max(options.participants - before, 0);
  if (options.begin) options.begin(to_come);
  if (to_come == 0) return 0;
  Server server(desk, ServerOptions{});
  const Serving serving(server);
  std::atomic<int> next = 0, finished = 0;
  std::mutex mutex;
  std::exception_ptr problem;
  std::vector<std::thread> threads;
  const int at_once = std::min(options.at_once, to_come);
  threads.reserve(static_cast<std::size_t>(at_once));
  for (int i = 0; i < at_once; ++i) {
    threads.emplace_back([&] {
      for (int who = next++; who < to_come; who = next++) {
        try {
          Simulated(desk, truth, options.seed).take_part(server.address());
          if (options.progress) options.progress(++finished);
        } catch (...) {
          const std::scoped_lock lock(mutex);
          problem = std::current_exception();
          next = to_come;
        }
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  if (problem) std::rethrow_exception(problem);
  return to_come;
}

}  // namespace pinchlab::study
