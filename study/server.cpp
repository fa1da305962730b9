// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/server.h"

#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "base/answer_file.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "study/answers.h"
#include "study/html_page.h"
#include "study/http_server.h"
#include "study/page_assets.h"
#include "study/rate_limit.h"
#include "study/results.h"
#include "study/secrets.h"
#include "study/session.h"
#include "study/study_file.h"
#include "study/tables.h"
#include "study/utc.h"
#include "study/zip.h"

namespace pinchlab::study {
namespace {

using nlohmann::json;

constexpr std::size_t deepest_json = 8;
constexpr double requests_per_second = 500, requests_at_once = 5000;  // of one address

// No inline code, nothing from elsewhere, no frames; clips are played from memory (blob:).
const std::vector<std::pair<std::string, std::string>> common_headers = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
     "media-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Permissions-Policy", "camera=(), geolocation=(), microphone=()"},
    {"Cache-Control", "no-store"}};

// A file that goes with it.
struct Removed {
  std::filesystem::path path;
  ~Removed() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

HttpReply reply(const json& body, int status = 200) {
  HttpReply result;
  result.status = status;
  result.type = "application/json";
  result.body = body.dump(-1, ' ', false, json::error_handler_t::replace);
  return result;
}

HttpReply refusal(int status, const std::string& reason) {
  return reply({{"error", reason}}, status);
}

// A body of JSON that is small, flat and without doubled keys.
json parse_body(const HttpRequest& request) {
  const std::string type = request.header("content-type");
  if (type != "application/json" && !type.starts_with("application/json;")) {
    throw Refused(415, "the body must be application/json");
  }
  try {
    return parse_strict_json(request.body, deepest_json);
  } catch (const JsonError& error) {
    throw Refused(400, fmt::format("{}: {}", error.place, error.what()));
  }
}

void check_keys(const json& body, const std::set<std::string>& known) {
  if (!body.is_object()) {
    throw Refused(422, "the body must be an object");
  }
  for (const auto& item : body.items()) {
    if (!known.contains(item.key())) {
      throw Refused(422, "unknown key");
    }
  }
}

std::string token_of(const HttpRequest& request) {
  const std::string header = request.header("authorization");
  constexpr std::string_view scheme = "Bearer ";
  if (!header.starts_with(scheme)) {
    throw Refused(401, "no session");
  }
  return header.substr(scheme.size());
}

json progress_json(const Progress& progress) {
  json trials = json::array();
  for (const Progress::Trial& trial : progress.trials) {
    json entry = {{"practice", trial.is_practice}, {"mp4", "/media/" + trial.media + ".mp4"}};
    if (progress.has_webm) {
      entry["webm"] = "/media/" + trial.media + ".webm";
    }
    trials.push_back(entry);
  }
  json object = {{"trials", trials}, {"next", progress.next}, {"language", progress.language}};
  if (progress.is_adaptive) object["ahead"] = 1;
  if (!progress.questionnaires.empty()) object["questionnaires"] = progress.questionnaires;
  return object;
}

}  // namespace

struct Server::Implementation {
  using Route = std::function<HttpReply(const HttpRequest&)>;

  Implementation(Desk& desk_, const ServerOptions& options_)
      : desk(desk_),
        options(options_),
        http(options.host, options.port, options.limits,
             [this](const HttpRequest& request) { return serve(request); }) {
    add_page();
    add_interface();
    add_researcher();
    http.every(options.idle_check, [this] { desk.drop_idle(); });
  }

  HttpReply serve(const HttpRequest& request) {
    HttpReply result = answer(request);
    result.headers.insert(result.headers.end(), common_headers.begin(), common_headers.end());
    return result;
  }

  HttpReply answer(const HttpRequest& request) {
    try {
      if (!is_our_host(request.header("host"), options.names)) {
        throw Refused(421, "this server has another name; see --name");
      }
      if (!rate.allows(request.address, RateLimit::Clock::now())) {
        HttpReply busy = refusal(429, "too many requests");
        busy.headers.emplace_back("Retry-After", "1");
        return busy;
      }
      if (request.path.starts_with("/media/")) {
        return media(request);
      }
      const std::string method = request.method == "HEAD" ? "GET" : request.method;
      const auto route = routes.find({method, request.path});
      if (route == routes.end()) {
        const bool is_path =
            routes.contains({"GET", request.path}) || routes.contains({"POST", request.path});
        throw is_path ? Refused(405, "not with this method")
                      : Refused(404, "there is no such page");
      }
      return route->second(request);
    } catch (const Refused& refused) {
      return refusal(refused.status, refused.what());
    } catch (const std::exception& error) {
      // Participants need not know what it is, who runs the study must.
      fmt::print(stderr, "{} {} {}: {}\n", utc_now(), request.method, request.path, error.what());
      return refusal(500, "the server has a problem");
    }
  }

  void add_page() {
    for (const PageAsset& asset : page_assets()) {
      const std::string path = "/" + std::string(asset.path);
      if (path.ends_with(".html") ||
          (path.starts_with("/texts/") && !path.starts_with("/texts/researcher"))) {
        continue;
      }
      routes[{"GET", path}] = [&asset](const HttpRequest&) {
        HttpReply result;
        result.type = asset.type;
        result.body = asset.bytes;
        return result;
      };
    }
    for (const auto& [path, file] :
         {std::pair{"/", "index.html"}, {"/researcher", "researcher.html"}}) {
      routes[{"GET", path}] = [this, name = file](const HttpRequest&) {
        HttpReply result;
        result.type = "text/html; charset=utf-8";
        result.body = html_page(name, desk.config(), "server", "");
        return result;
      };
    }
  }

  // /media/<32 hexadecimal digits>.<mp4 or webm>, whole or in part.
  HttpReply media(const HttpRequest& request) {
    if (request.method != "GET" && request.method != "HEAD") {
      throw Refused(405, "not with this method");
    }
    const std::string name = request.path.substr(std::string_view("/media/").size());
    const std::size_t dot = name.find('.');
    const std::string ending = dot == std::string::npos ? "" : name.substr(dot + 1);
    const Encoding encoding = ending == "mp4" ? Encoding::mp4 : Encoding::webm;
    const Clip* clip =
        ending == to_string(encoding) ? desk.clip(name.substr(0, dot), encoding) : nullptr;
    if (clip == nullptr) {
      throw Refused(404, "there is no such file");
    }
    const std::uint64_t size = clip->served_size();
    HttpReply result;
    ByteRange part(0, size - 1);
    if (const std::string range = request.header("range"); !range.empty()) {
      const auto wanted = byte_range(range, size);
      if (!wanted) {
        result = refusal(416, "there is no such part");
        result.headers.emplace_back("Content-Range", fmt::format("bytes */{}", size));
        return result;
      }
      part = *wanted;
      result.status = 206;
      result.headers.emplace_back("Content-Range",
                                  fmt::format("bytes {}-{}/{}", part.first, part.second, size));
    }
    result.type = std::string("video/") + to_string(encoding);
    result.headers.emplace_back("Accept-Ranges", "bytes");
    result.length = part.second - part.first + 1;
    result.read = [clip, first = part.first](std::uint64_t offset, std::size_t length) {
      return clip->read(first + offset, length);
    };
    return result;
  }

  // What the page needs to know of the study.
  [[nodiscard]] json study_json() const {
    const Config& config = desk.config();
    json study = {{"language", config.language},
                  {"texts", config.texts},
                  {"needs_link", config.one_time_links},
                  {"shared_computer", config.shared_computer}};
    if (!config.translations.empty()) study["translations"] = config.translations;
    if (config.is_pilot) study["pilot"] = true;
    if (config.trial != TrialOptions()) study["trial_options"] = to_json(config.trial);
    if (!config.questionnaires.empty()) {
      study["questionnaires"] = to_json(config.questionnaires);
    }
    if (config.recruiting) study["recruiting"] = for_page(*config.recruiting);
    return study;
  }

  void add_interface() {
    routes[{"GET", "/api/study"}] = [this](const HttpRequest&) { return reply(study_json()); };
    routes[{"POST", "/api/start"}] = [this](const HttpRequest& request) { return start(request); };
    routes[{"GET", "/api/session"}] = [this](const HttpRequest& request) {
      return reply(progress_json(desk.progress(token_of(request))));
    };
    routes[{"POST", "/api/resume"}] = [this](const HttpRequest& request) {
      check_keys(parse_body(request), {});
      return reply(progress_json(desk.resume(token_of(request))));
    };
    routes[{"POST", "/api/show"}] = [this](const HttpRequest& request) {
      const json body = parse_body(request);
      check_keys(body, {"index"});
      const json index = body.value("index", json());
      if (!index.is_number_unsigned()) {
        throw Refused(422, "index must be a whole number");
      }
      desk.show(token_of(request), index.get<std::size_t>());
      return reply({{"done", true}});
    };
    routes[{"POST", "/api/questionnaire"}] = [this](const HttpRequest& request) {
      desk.questionnaire(token_of(request), parse_body(request));
      return reply({{"done", true}});
    };
    routes[{"POST", "/api/answer"}] = [this](const HttpRequest& request) {
      desk.answer(token_of(request), parse_answer(parse_body(request)));
      return reply({{"done", true}});
    };
    routes[{"POST", "/api/save"}] = [this](const HttpRequest& request) {
      const std::string code = desk.save(token_of(request), parse_free_text(parse_body(request)));
      json saved = {{"done", true}, {"code", code}};
      if (const auto& recruiting = desk.config().recruiting; recruiting) {
        saved["completion"] = completion(*recruiting);
      }
      return reply(saved);
    };
    routes[{"POST", "/api/leave"}] = [this](const HttpRequest& request) {
      check_keys(parse_body(request), {});
      desk.leave(token_of(request));
      return reply({{"done", true}});
    };
    routes[{"GET", "/api/overview"}] = [this](const HttpRequest& request) {
      check_researcher(request);
      return reply(overview_json(desk.overview()));
    };
    routes[{"POST", "/api/release"}] = [this](const HttpRequest& request) {
      check_researcher(request);
      const json body = parse_body(request);
      check_keys(body, {"participant"});
      const json participant = body.value("participant", json());
      if (!participant.is_string()) {
        throw Refused(422, "participant must be a string");
      }
      desk.release(participant.get<std::string>());
      return reply({{"done", true}});
    };
  }

  void add_researcher() {
    routes[{"POST", "/api/results"}] = [this](const HttpRequest& request) {
      check_researcher(request);
      const json body = parse_body(request);
      check_keys(body, {"reveal"});
      const json reveal = body.value("reveal", json(false));
      if (!reveal.is_boolean()) {
        throw Refused(422, "reveal must be true or false");
      }
      json result = results.read(reveal.get<bool>());
      result["pilot"] = desk.config().is_pilot;
      return reply(result);
    };
    routes[{"POST", "/api/preview"}] = [this](const HttpRequest& request) {
      check_researcher(request);
      const json body = parse_body(request);
      check_keys(body, {"number"});
      const json number = body.value("number", json());
      if (!number.is_number_unsigned() || number.get<std::uint64_t>() > 1000000000) {
        throw Refused(422, "number must be a whole number");
      }
      return reply(progress_json(desk.preview(number.get<std::uint64_t>())));
    };
    routes[{"POST", "/api/withdraw"}] = [this](const HttpRequest& request) {
      check_researcher(request);
      const json body = parse_body(request);
      check_keys(body, {"code"});
      const json code = body.value("code", json());
      if (!code.is_string()) {
        throw Refused(422, "code must be a string");
      }
      return reply({{"participant", desk.withdraw(code.get<std::string>())}});
    };
    for (const char* what : {"answers.zip", "answers.csv", "psych-ds.zip"}) {
      routes[{"GET", std::string("/api/download/") + what}] = [this,
                                                               what](const HttpRequest& request) {
        check_researcher(request);
        return download(what);
      };
    }
  }

  // All answers as they are, or as tables; made in memory, but for archives, which libarchive
  // writes to a file.
  HttpReply download(const std::string& what) {
    HttpReply result;
    result.type = what.ends_with(".zip") ? "application/zip" : "text/csv; charset=utf-8";
    result.headers.emplace_back("Content-Disposition", "attachment; filename=" + what);
    const std::filesystem::path& answers = desk.answers();
    if (what == "answers.csv") {
      result.body = answers_csv(answers);
      return result;
    }
    const Removed archive{running_folder(answers) / (random_hex(8) + ".zip")};
    {
      ZipWriter zip(archive.path);
      if (what == "psych-ds.zip") {
        for (const auto& [name, bytes] : psych_ds_files(answers)) zip.add(name, bytes);
      } else {
        for (const std::filesystem::path& file : answer_files(answers)) {
          zip.add("answers/" + file.filename().string(), read_whole(file));
        }
      }
      zip.finish();
    }
    result.body = read_whole(archive.path);
    return result;
  }

  void check_researcher(const HttpRequest& request) const {
    if (!equal_in_constant_time(token_of(request), researcher_token)) {
      throw Refused(401, "this needs the token that was printed at start");
    }
  }

  HttpReply start(const HttpRequest& request) {
    const json body = parse_body(request);
    check_keys(body, {"consent", "link", "recruited", "language"});
    if (body.value("consent", json()) != true) {
      throw Refused(422, "without consent nothing begins");
    }
    const json link = body.value("link", json(""));
    const json language = body.value("language", json(""));
    if (!link.is_string() || !language.is_string()) {
      throw Refused(422, "link and language must be strings");
    }
    const std::string token =
        desk.start(link.get<std::string>(), request.header("user-agent"), request.address,
                   parse_recruited(body), language.get<std::string>());
    json started = progress_json(desk.progress(token));
    started["token"] = token;
    return reply(started);
  }

  static json overview_json(const Overview& overview) {
    json running = json::array();
    for (const Overview::Participant& participant : overview.running) {
      running.push_back({{"participant", participant.id},
                         {"number", participant.number},
                         {"answered", participant.answered},
                         {"trials", participant.trials},
                         {"started_utc", participant.started_utc},
                         {"last_seen_utc", participant.last_seen_utc}});
    }
    return {{"running", running}, {"finished", overview.finished}, {"left", overview.left}};
  }

  Desk& desk;
  Results results{desk.answers()};
  ServerOptions options;
  std::string researcher_token = random_hex(16);
  RateLimit rate{requests_per_second, requests_at_once};
  std::map<std::pair<std::string, std::string>, Route> routes;  // by method and path
  HttpServer http;
};

Server::Server(Desk& desk, const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(desk, options)) {}

Server::~Server() = default;

std::string Server::address() const {
  const std::string host = openable_host(implementation_->options.host);
  const bool is_ipv6 = host.find(':') != std::string::npos;
  return fmt::format("http://{}:{}", is_ipv6 ? "[" + host + "]" : host,
                     implementation_->http.port());
}

const std::string& Server::researcher_token() const {
  return implementation_->researcher_token;
}

void Server::run() {
  implementation_->http.run();
}

void Server::stop() {
  implementation_->http.stop();
}

}  // namespace pinchlab::study
