// SPDX-License-Identifier: GPL-3.0-or-later
// The server over HTTP: malformed requests, many participants at once, and being killed.
#include "study/server.h"
#include "base/read_file.h"
#include "base/sha256.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <httplib.h>
#include <sys/wait.h>

#include <atomic>
#include <csignal>
#include <random>
#include <thread>

#include "analysis/answer_file.h"
#include "study/answers.h"
#include "study/page_assets.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class RunningServer {
 public:
  explicit RunningServer(const fs::path& folder)
      : desk(desk_options(folder)), server(desk, {}), thread_([this] { server.run(); }) {
    httplib::Client client(server.address());
    while (!client.Get("/api/study")) {
      std::this_thread::yield();
    }
  }
  ~RunningServer() {
    server.stop();
    thread_.join();
  }

  Desk desk;
  Server server;

 private:
  std::thread thread_;
};

httplib::Headers bearer(const std::string& token) {
  return {{"Authorization", "Bearer " + token}};
}

// One request; again where the server says that it is busy or the connection was not taken.
httplib::Result post(httplib::Client& client, const std::string& path, const json& body,
                     const std::string& token = "") {
  for (int attempt = 0; attempt < 50; ++attempt) {
    auto result = client.Post(path, token.empty() ? httplib::Headers() : bearer(token), body.dump(),
                              "application/json");
    if (result && result->status != 429) {
      return result;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return client.Post(path, bearer(token), body.dump(), "application/json");
}

// A whole session up to saving. Returns the token.
std::string take_part(httplib::Client& client, bool fetches_media) {
  const auto started = post(client, "/api/start", {{"consent", true}});
  if (!started || started->status != 200) {
    ADD_FAILURE() << "start";
    return "";
  }
  const json session = json::parse(started->body);
  const std::string token = session["token"];
  for (std::size_t i = 0; i < session["trials"].size(); ++i) {
    if (fetches_media) {
      const auto media = client.Get(session["trials"][i]["mp4"].get<std::string>());
      EXPECT_TRUE(media && media->status == 200 && media->body.size() > 100000);
    }
    EXPECT_EQ(post(client, "/api/show", {{"index", i}}, token)->status, 200);
    EXPECT_EQ(post(client, "/api/answer", answer_body(i), token)->status, 200);
  }
  return token;
}

TEST(Server, AHundredParticipantsAtOnce) {
  const fs::path folder = scratch_folder();
  RunningServer running(folder);
  std::vector<std::thread> people;
  std::atomic<int> saved = 0;
  people.reserve(100);
  for (int i = 0; i < 100; ++i) {
    people.emplace_back([&] {
      httplib::Client client(running.server.address());
      client.set_keep_alive(true);
      client.set_read_timeout(60);
      client.set_connection_timeout(60);
      const std::string token = take_part(client, true);
      const auto result = post(client, "/api/save", {{"free_text", json::object()}}, token);
      saved += result && result->status == 200 ? 1 : 0;
    });
  }
  for (std::thread& person : people) {
    person.join();
  }
  EXPECT_EQ(saved, 100);
  const auto files = answer_files(folder / "answers");
  ASSERT_EQ(files.size(), 100U);
  std::set<long> numbers;
  for (const fs::path& path : files) {
    const json file = json::parse(read_whole(path));
    analysis::parse_answer_file(file, path.string());
    numbers.insert(file["participant_number"].get<long>());
  }
  EXPECT_EQ(numbers.size(), 100U) << "every plan once";
  EXPECT_EQ(*numbers.rbegin(), 99);
}

TEST(Server, PartsOfClips) {
  RunningServer running(scratch_folder());
  httplib::Client client(running.server.address());
  const json session = json::parse(post(client, "/api/start", {{"consent", true}})->body);
  const std::string path = session["trials"][0]["mp4"];
  const std::string whole = client.Get(path)->body;
  const auto part = [&](const std::string& range) {
    return client.Get(path, httplib::Headers{{"Range", range}});
  };
  EXPECT_EQ(part("bytes=0-9")->body, whole.substr(0, 10));
  EXPECT_EQ(part("bytes=0-9")->status, 206);
  EXPECT_EQ(part("bytes=5-")->body, whole.substr(5));
  EXPECT_EQ(part("bytes=-7")->body, whole.substr(whole.size() - 7));
  EXPECT_EQ(part("bytes=100-99999999999")->body, whole.substr(100));
  EXPECT_EQ(part("bytes=100-99999999999")->get_header_value("Content-Range"),
            "bytes 100-" + std::to_string(whole.size() - 1) + "/" + std::to_string(whole.size()));
  for (const char* bad : {"bytes=99999999-", "bytes=5-2", "bytes=0-1,3-4", "bytes=-0", "bytes=x"}) {
    EXPECT_EQ(part(bad)->status, 416) << bad;
  }
}

// Sends bytes as they are and returns the status of the answer, 0 if there is none.
int raw_status(const std::string& address, const std::string& bytes) {
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  const int connection = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in to = {};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string reply;
  if (::connect(connection, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) {
    ::send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    const timeval patience = {10, 0};
    ::setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    char buffer[4096];
    ssize_t got = 0;
    while (reply.size() <= 12 && (got = ::recv(connection, buffer, sizeof buffer, 0)) > 0) {
      reply.append(buffer, static_cast<std::size_t>(got));
    }
  }
  ::close(connection);
  return reply.size() > 12 ? std::atoi(reply.c_str() + 9) : 0;
}

std::string state_of(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) {
      files[entry.path().string()] = sha256(read_whole(entry.path()));
    }
  }
  return json(files).dump();
}

std::vector<std::string> malformed_requests(const std::string& token) {
  std::vector<std::string> requests;
  const auto add = [&](const std::string& line, const std::string& headers = "",
                       const std::string& body = "") {
    requests.push_back(
        line + " HTTP/1.1\r\nHost: x\r\nConnection: close\r\n" + headers +
        (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
        body);
  };
  const std::string type = "Content-Type: application/json\r\n";
  const std::string ours = type + "Authorization: Bearer " + token + "\r\n";
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
    add(std::string("GET ") + path);
  }
  for (const char* method : {"PUT", "DELETE", "PATCH", "NONSENSE"}) {
    add(std::string(method) + " /api/save", ours, "{}");
  }
  for (const char* body : {"{", "[]", "null", "3", "\"x\"", "{\"consent\":1}",
                           "{\"consent\":false}", "{}", "{\"consent\":true,\"consent\":true}",
                           "{\"consent\":true,\"x\":1}", "{\"consent\":true,\"link\":3}",
                           "[[[[[[[[[[[[[[[[1]]]]]]]]]]]]]]]]", "\xFF\xFE", "{\"consent\":NaN}"}) {
    add("POST /api/start", type, body);
  }
  add("POST /api/start", "", "{\"consent\":true}");
  add("POST /api/start", "Content-Type: text/plain\r\n", "{\"consent\":true}");
  for (const char* body : {"{\"index\":-1}", "{\"index\":1}", "{\"index\":0.5}",
                           "{\"index\":\"0\"}", "{\"index\":0,\"x\":1}", "{}"}) {
    add("POST /api/show", ours, body);
  }
  add("POST /api/answer", ours, answer_body(0).dump());
  add("POST /api/answer", ours, answer_body(99999).dump());
  add("POST /api/save", ours, "{\"free_text\":{}}");
  add("POST /api/save", ours, "{\"free_text\":{\"thoughts\":1}}");
  add("POST /api/leave", ours, "{\"now\":true}");
  add("POST /api/leave", type, "{}");
  add("POST /api/resume", type + "Authorization: Basic eDp5\r\n", "{}");
  add("POST /api/show", type + "Authorization: Bearer " + std::string(5000, 'a') + "\r\n",
      "{\"index\":0}");
  add("POST /api/start", type, "{\"consent\":true,\"link\":\"" + std::string(300000, 'x') + "\"}");
  add("GET /" + std::string(9000, 'a'));
  add("GET /", "X: " + std::string(9000, 'a') + "\r\n");
  requests.emplace_back("NONSENSE\r\n\r\n");
  requests.emplace_back("GET / HTTP/9.9\r\n\r\n");
  return requests;
}

TEST(Server, MalformedRequestsChangeNothing) {
  const fs::path folder = scratch_folder();
  RunningServer running(folder);
  httplib::Client client(running.server.address());
  const std::string token =
      json::parse(post(client, "/api/start", {{"consent", true}})->body)["token"];
  const std::string before = state_of(folder);
  const auto requests = malformed_requests(token);
  ASSERT_GE(requests.size(), 50U);
  for (const std::string& request : requests) {
    const int status = raw_status(running.server.address(), request);
    EXPECT_GE(status, 400) << request.substr(0, 300);
    EXPECT_LT(status, 500) << request.substr(0, 300);
    ASSERT_EQ(state_of(folder), before) << request.substr(0, 300);
  }
  EXPECT_EQ(client.Get("/api/session", bearer(token))->status, 200)
      << "and the server still serves";
}

TEST(Server, HeadersOfEveryReply) {
  RunningServer running(scratch_folder());
  httplib::Client client(running.server.address());
  for (const char* path :
       {"/", "/main.js", "/researcher", "/api/study", "/api/session", "/nothing"}) {
    const auto reply = client.Get(path);
    ASSERT_TRUE(reply) << path;
    const std::string policy = reply->get_header_value("Content-Security-Policy");
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos) << path;
    EXPECT_EQ(policy.find("unsafe"), std::string::npos) << path;
    EXPECT_EQ(reply->get_header_value("Cache-Control"), "no-store") << path;
    EXPECT_FALSE(reply->has_header("Access-Control-Allow-Origin")) << path;
    EXPECT_FALSE(reply->has_header("Server")) << path;
  }
  const auto overview = client.Get("/api/overview", bearer(running.server.researcher_token()));
  EXPECT_EQ(overview->status, 200);
  EXPECT_EQ(client.Get("/api/overview", bearer(std::string(32, '0')))->status, 401);
}

// The program itself, as it is run; killed it takes nothing with it but itself.
pid_t start_program(const fs::path& folder) {
  const pid_t process = ::fork();
  if (process == 0) {
    const int out = ::open((folder / "out.txt").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(out, STDOUT_FILENO);
    ::execl(PINCHLAB_PROGRAM, "pinchlab", "study", "serve", "--clips", (folder / "clips").c_str(),
            "--answers", (folder / "answers").c_str(), "--config", (folder / "study.json").c_str(),
            "--port", "0", "--no-webm", nullptr);
    ::_exit(127);
  }
  return process;
}

std::string address_of(const fs::path& folder) {
  for (int i = 0; i < 3000; ++i) {
    const std::string out = fs::exists(folder / "out.txt") ? read_whole(folder / "out.txt") : "";
    const std::size_t at = out.find("http://");
    if (out.find("Ctrl-C ends") != std::string::npos) {
      return out.substr(at, out.find("/\n", at) - at);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return "";
}

struct Participant {
  std::string token, code;  // the code once the server has confirmed
};

// Everybody saves at the same time, over and over until it is confirmed or the server is gone.
void save_all(const std::string& address, std::vector<Participant>& people) {
  std::vector<std::thread> threads;
  threads.reserve(people.size());
  for (Participant& person : people) {
    threads.emplace_back([&] {
      httplib::Client client(address);
      const auto result =
          client.Post("/api/save", bearer(person.token), R"({"free_text":{}})", "application/json");
      if (result && result->status == 200) {
        person.code = json::parse(result->body)["code"];
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
}

TEST(Server, KilledAtAHundredRandomMomentsWhileSaving) {
  if (!has_page()) {
    GTEST_SKIP() << "the program was built without jsPsych; run npm ci --prefix study/page";
  }
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  write_text(folder / "study.json",
             json{{"format", "pinchlab-study 1"}, {"demonstrations", demonstrations}}.dump());
  std::mt19937 random(1);  // raw numbers only: the same everywhere
  std::set<std::string> confirmed;
  std::size_t told = 0, cut_off = 0;
  for (int kill = 0; kill < 100; ++kill) {
    fs::remove(folder / "out.txt");
    const pid_t process = start_program(folder);
    const std::string address = address_of(folder);
    ASSERT_NE(address, "");
    std::vector<Participant> people(4);
    for (Participant& person : people) {
      httplib::Client client(address);
      person.token = take_part(client, false);
    }
    const auto delay = std::chrono::microseconds(random() % 12000);
    std::thread killer([&] {
      std::this_thread::sleep_for(delay);
      ::kill(process, SIGKILL);
    });
    save_all(address, people);
    killer.join();
    ::waitpid(process, nullptr, 0);
    for (const Participant& person : people) {
      (person.code.empty() ? cut_off : told) += 1;
      if (!person.code.empty()) {
        confirmed.insert(person.token.substr(0, 16));
      }
    }
    // Every file under a final name is whole, and nobody who was told is missing.
    std::set<std::string> kept;
    for (const fs::path& path : answer_files(folder / "answers")) {
      ASSERT_NO_THROW(analysis::parse_answer_file(json::parse(read_whole(path)), path.string()));
      kept.insert(path.stem().string());
    }
    for (const std::string& id : confirmed) {
      ASSERT_TRUE(kept.contains(id)) << "told that it is saved, but gone after kill " << kill;
    }
  }
  EXPECT_GT(told, 0U);
  EXPECT_GT(cut_off, 0U) << "no kill came in time";
  std::printf("100 kills: %zu were told, %zu were cut off, none lost\n", told, cut_off);
}

}  // namespace
}  // namespace pinchlab::study
