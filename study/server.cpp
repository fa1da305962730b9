// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/server.h"

#include <fmt/format.h>
#include <httplib.h>

#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "base/strict_json.h"
#include "study/page_assets.h"
#include "study/rate_limit.h"
#include "study/secrets.h"
#include "study/session.h"

namespace pinchlab::study {
namespace {

using httplib::Request;
using httplib::Response;
using nlohmann::json;

constexpr std::size_t largest_request = 1U << 18U;  // bytes
constexpr std::size_t deepest_json = 8;
constexpr std::size_t threads = 192;  // a browser keeps a few connections open
constexpr double requests_per_second = 500, requests_at_once = 5000;  // of one address

// No inline code, nothing from elsewhere, no frames; clips are played from memory (blob:).
const httplib::Headers common_headers = {
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

void reply(Response& response, const json& body, int status = 200) {
  response.status = status;
  response.set_content(body.dump(-1, ' ', false, json::error_handler_t::replace),
                       "application/json");
}

void refuse(Response& response, int status, const std::string& reason) {
  reply(response, {{"error", reason}}, status);
}

// A body of JSON that is small, flat and without doubled keys.
json parse_body(const Request& request) {
  const std::string type = request.get_header_value("Content-Type");
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

std::string token_of(const Request& request) {
  const std::string header = request.get_header_value("Authorization");
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
  return {{"trials", trials}, {"next", progress.next}};
}

// The library takes ranges as they come; this makes them what RFC 9110, 14.1.2 says. False: there
// is no such part of `size` bytes.
bool clamp_range(const Request& request, std::uint64_t size) {
  // The library's own object, not constant; it offers no other way to it.
  auto& ranges = const_cast<Request&>(request).ranges;
  if (ranges.empty()) {
    return true;
  }
  const auto last = static_cast<ssize_t>(size) - 1;
  auto& [begin, end] = ranges.front();
  if (ranges.size() > 1 || begin > last || (begin < 0 && end <= 0)) {
    ranges.clear();
    return false;
  }
  if (begin < 0) {
    begin = std::max<ssize_t>(0, last + 1 - end);
    end = last;
  }
  end = end < 0 ? last : std::min(end, last);
  return true;
}

}  // namespace

struct Server::Implementation {
  Implementation(Desk& desk_, const ServerOptions& options) : desk(desk_) {
    http.new_task_queue = [] { return new httplib::ThreadPool(threads); };
    http.set_tcp_nodelay(true);
    http.set_keep_alive_max_count(1000);
    http.set_keep_alive_timeout(2);
    http.set_read_timeout(5);
    http.set_write_timeout(10);
    http.set_payload_max_length(largest_request);
    http.set_default_headers(common_headers);
    http.set_exception_handler(
        [](const Request&, Response& response, const std::exception_ptr& error) {
          answer_exception(response, error);
        });
    http.set_error_handler([](const Request&, Response& response) {
      if (response.body.empty()) {
        refuse(response, response.status, "refused");
      }
    });
    http.set_pre_routing_handler(
        [this](const Request& request, Response& response) { return before(request, response); });
    add_page();
    add_media();
    add_interface();
    bind(options);
  }

  static void answer_exception(Response& response, const std::exception_ptr& error) {
    try {
      std::rethrow_exception(error);
    } catch (const Refused& refused) {
      refuse(response, refused.status, refused.what());
    } catch (const std::exception&) {
      refuse(response, 500, "the server has a problem");
    }
  }

  httplib::Server::HandlerResponse before(const Request& request, Response& response) {
    if (!rate.allows(request.remote_addr, RateLimit::Clock::now())) {
      response.set_header("Retry-After", "1");
      refuse(response, 429, "too many requests");
      return httplib::Server::HandlerResponse::Handled;
    }
    if (!request.path.starts_with("/media/")) {
      const_cast<Request&>(request).ranges.clear();  // only clips come in parts
    }
    return httplib::Server::HandlerResponse::Unhandled;
  }

  void add_page() {
    for (const PageAsset& asset : page_assets()) {
      const std::string path = "/" + std::string(asset.path);
      if (path.ends_with(".html") || path.starts_with("/texts/")) {
        continue;
      }
      http.Get(path, [&asset](const Request&, Response& response) {
        response.set_content(asset.bytes.data(), asset.bytes.size(), std::string(asset.type));
      });
    }
    for (const auto& [path, file] :
         {std::pair{"/", "index.html"}, {"/researcher", "researcher.html"}}) {
      http.Get(path, [this, name = file](const Request&, Response& response) {
        response.set_content(html_page(name, desk.config(), "server", ""),
                             "text/html; charset=utf-8");
      });
    }
  }

  void add_media() {
    http.Get(R"(/media/([0-9a-f]{32})\.(mp4|webm))", [this](const Request& request,
                                                            Response& response) {
      const Encoding encoding = request.matches[2] == "mp4" ? Encoding::mp4 : Encoding::webm;
      const Clip* clip = desk.clip(request.matches[1], encoding);
      if (clip == nullptr) {
        throw Refused(404, "there is no such file");
      }
      if (!clamp_range(request, clip->served_size())) {
        response.set_header("Content-Range", fmt::format("bytes */{}", clip->served_size()));
        throw Refused(416, "there is no such part");
      }
      response.set_header("Accept-Ranges", "bytes");
      response.set_content_provider(
          clip->served_size(), encoding == Encoding::mp4 ? "video/mp4" : "video/webm",
          [clip](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
            const std::string bytes = clip->read(offset, std::min<std::size_t>(length, 1U << 18U));
            return !bytes.empty() && sink.write(bytes.data(), bytes.size());
          });
    });
  }

  void add_interface() {
    http.Get("/api/study", [this](const Request&, Response& response) {
      const Config& config = desk.config();
      reply(response, {{"language", config.language},
                       {"texts", config.texts},
                       {"needs_link", config.one_time_links}});
    });
    http.Post("/api/start", [this](const Request& request, Response& response) {
      const json body = parse_body(request);
      check_keys(body, {"consent", "link"});
      if (body.value("consent", json()) != true) {
        throw Refused(422, "without consent nothing begins");
      }
      const json link = body.value("link", json(""));
      if (!link.is_string()) {
        throw Refused(422, "the link must be a string");
      }
      const std::string token =
          desk.start(link.get<std::string>(), request.get_header_value("User-Agent"));
      json started = progress_json(desk.progress(token));
      started["token"] = token;
      reply(response, started);
    });
    http.Get("/api/session", [this](const Request& request, Response& response) {
      reply(response, progress_json(desk.progress(token_of(request))));
    });
    http.Post("/api/resume", [this](const Request& request, Response& response) {
      check_keys(parse_body(request), {});
      reply(response, progress_json(desk.resume(token_of(request))));
    });
    http.Post("/api/show", [this](const Request& request, Response& response) {
      const json body = parse_body(request);
      check_keys(body, {"index"});
      const json index = body.value("index", json());
      if (!index.is_number_unsigned()) {
        throw Refused(422, "index must be a whole number");
      }
      desk.show(token_of(request), index.get<std::size_t>());
      reply(response, {{"done", true}});
    });
    http.Post("/api/answer", [this](const Request& request, Response& response) {
      desk.answer(token_of(request), parse_answer(parse_body(request)));
      reply(response, {{"done", true}});
    });
    http.Post("/api/save", [this](const Request& request, Response& response) {
      const std::string code = desk.save(token_of(request), parse_free_text(parse_body(request)));
      reply(response, {{"done", true}, {"code", code}});
    });
    http.Post("/api/leave", [this](const Request& request, Response& response) {
      check_keys(parse_body(request), {});
      desk.leave(token_of(request));
      reply(response, {{"done", true}});
    });
    http.Get("/api/overview", [this](const Request& request, Response& response) {
      if (!equal_in_constant_time(token_of(request), researcher_token)) {
        throw Refused(401, "this needs the token that was printed at start");
      }
      reply(response, overview_json(desk.overview()));
    });
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

  void bind(const ServerOptions& options) {
    int port = options.port;
    if (port == 0) {
      port = http.bind_to_any_port(options.host);
    } else if (!http.bind_to_port(options.host, port)) {
      port = -1;
    }
    if (port < 0) {
      throw std::runtime_error(
          fmt::format("{}:{} cannot be listened on; is another server running? Use another --port "
                      "or --host",
                      options.host, options.port));
    }
    const bool is_ipv6 = options.host.find(':') != std::string::npos;
    address = fmt::format("http://{}:{}", is_ipv6 ? "[" + options.host + "]" : options.host, port);
  }

  Desk& desk;
  std::string address;
  std::string researcher_token = random_hex(16);
  RateLimit rate{requests_per_second, requests_at_once};
  httplib::Server http;
};

Server::Server(Desk& desk, const ServerOptions& options)
    : implementation_(std::make_unique<Implementation>(desk, options)) {}

Server::~Server() = default;

const std::string& Server::address() const {
  return implementation_->address;
}

const std::string& Server::researcher_token() const {
  return implementation_->researcher_token;
}

void Server::run() {
  implementation_->http.listen_after_bind();
}

void Server::stop() {
  implementation_->http.stop();
}

}  // namespace pinchlab::study
