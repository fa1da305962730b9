// SPDX-License-Identifier: GPL-3.0-or-later
// What the server must refuse, and must not be changed by.
#include "base/read_file.h"
#include "base/sha256.h"
#include "study/server.h"
#include "tests/study/raw_connection.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::string state_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[entry.path().string()] = sha256(read_whole(entry.path()));
    }
  }
  return json(files).dump();
}

const std::string type = "Content-Type: application/json\r\n";

std::string request(const std::string& line, const std::string& headers = "",
                    const std::string& body = "") {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n" + headers +
         (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
         body;
}

// Paths and methods that there are not, and lines that are too long.
std::vector<std::string> requests_for_nothing(const std::string& ours) {
  std::vector<std::string> requests;
  for (const char* path : {"/../../etc/passwd",
                           "/media/../../etc/passwd",
                           "/media/%2e%2e/%2e%2e/etc/passwd",
                           "/%2e%2e/%2e%2e/etc/passwd",
                           "/texts/en.json",
                           "/index.html",
                           "/media/",
                           "/media/x.mp4",
                           "/media/0123456789abcdef0123456789abcdef.mp4",
                           "/media/0123456789abcdef0123456789abcdef.json",
                           "/answers/",
                           "/.running/study.json",
                           "/api/",
                           "/api/nothing",
                           "/api/session",
                           "/api/overview",
                           "//",
                           "/main.js/",
                           "/main.js%00",
                           "/api/save"}) {
    requests.push_back(request(std::string("GET ") + path));
  }
  for (const char* method : {"PUT", "DELETE", "PATCH", "NONSENSE"}) {
    requests.push_back(request(std::string(method) + " /api/save", ours, "{}"));
  }
  requests.push_back(request("GET /" + std::string(9000, 'a')));
  requests.push_back(request("GET /", "X: " + std::string(9000, 'a') + "\r\n"));
  return requests;
}

// Bodies that say what cannot be.
std::vector<std::string> requests_with_wrong_bodies(const std::string& ours) {
  std::vector<std::string> requests;
  for (const char* body : {"{", "[]", "null", "3", "\"x\"", "{\"consent\":1}",
                           "{\"consent\":false}", "{}", "{\"consent\":true,\"consent\":true}",
                           "{\"consent\":true,\"x\":1}", "{\"consent\":true,\"link\":3}",
                           "[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]", "\xFF\xFE", "{\"consent\":NaN}"}) {
    requests.push_back(request("POST /api/start", type, body));
  }
  requests.push_back(request("POST /api/start", "", "{\"consent\":true}"));
  requests.push_back(
      request("POST /api/start", "Content-Type: text/plain\r\n", "{\"consent\":true}"));
  for (const char* body : {"{\"index\":-1}", "{\"index\":1}", "{\"index\":0.5}",
                           "{\"index\":\"0\"}", "{\"index\":0,\"x\":1}", "{}"}) {
    requests.push_back(request("POST /api/show", ours, body));
  }
  requests.push_back(request("POST /api/answer", ours, answer_body(0).dump()));
  requests.push_back(request("POST /api/answer", ours, answer_body(99999).dump()));
  requests.push_back(request("POST /api/save", ours, "{\"free_text\":{}}"));
  requests.push_back(request("POST /api/save", ours, "{\"free_text\":{\"thoughts\":1}}"));
  requests.push_back(request("POST /api/leave", ours, "{\"now\":true}"));
  requests.push_back(request("POST /api/leave", type, "{}"));
  requests.push_back(request("POST /api/resume", type + "Authorization: Basic eDp5\r\n", "{}"));
  requests.push_back(request("POST /api/show",
                             type + "Authorization: Bearer " + std::string(5000, 'a') + "\r\n",
                             "{\"index\":0}"));
  requests.push_back(request("POST /api/start", type,
                             "{\"consent\":true,\"link\":\"" + std::string(300000, 'x') + "\"}"));
  return requests;
}

// Headers that no client of HTTP sends.
std::vector<std::string> requests_with_wrong_headers() {
  std::vector<std::string> requests;
  const std::string start = "POST /api/start HTTP/1.1\r\nHost: 127.0.0.1\r\n" + type;
  const std::string consent = "{\"consent\":true}";
  // Bodies whose end two readers could take to be in two places.
  requests.push_back(start + "Transfer-Encoding: chunked\r\n\r\n10\r\n" + consent +
                     "\r\n0\r\n\r\n");
  requests.push_back(start + "Transfer-Encoding: gzip\r\nContent-Length: 16\r\n\r\n" + consent);
  requests.push_back(start + "Content-Length: 16\r\nContent-Length: 16\r\n\r\n" + consent);
  requests.push_back(start + "Content-Length: 16\r\nContent-Length: 2\r\n\r\n" + consent);
  requests.push_back(start + "Content-Length: 16, 16\r\n\r\n" + consent);
  requests.push_back(start + "Content-Length: +16\r\n\r\n" + consent);
  requests.push_back(start + "Content-Length: 16\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n");
  requests.push_back(start + "Content-Length: 16\r\nHost: 127.0.0.1\r\n\r\n" + consent);
  requests.emplace_back("GET / HTTP/1.1\r\n\r\n");
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example", "",
                           "127.0.0.1:x", "[::1", "[evil]"}) {
    requests.push_back("GET / HTTP/1.1\r\nHost: " + std::string(host) + "\r\n\r\n");
  }
  requests.emplace_back("NONSENSE\r\n\r\n");
  return requests;
}

TEST(Server, MalformedRequestsChangeNothing) {
  const fs::path folder = scratch_folder();
  RunningServer running(desk_options(folder));
  HttpClient client(running.server.address());
  const std::string token =
      json::parse(client.post("/api/start", {{"consent", true}})->body)["token"];
  const std::string before = state_of(folder);
  const std::string ours = type + "Authorization: Bearer " + token + "\r\n";
  std::vector<std::string> requests = requests_for_nothing(ours);
  for (const auto& more : {requests_with_wrong_bodies(ours), requests_with_wrong_headers()}) {
    requests.insert(requests.end(), more.begin(), more.end());
  }
  ASSERT_GE(requests.size(), 50U);
  for (const std::string& request : requests) {
    const int status = raw_status(running.server.address(), request);
    EXPECT_GE(status, 400) << request.substr(0, 300);
    EXPECT_LT(status, 500) << request.substr(0, 300);
    ASSERT_EQ(state_of(folder), before) << request.substr(0, 300);
  }
  EXPECT_EQ(client.get("/api/session", bearer(token))->status, 200)
      << "and the server still serves";
}

}  // namespace
}  // namespace pinchlab::study
