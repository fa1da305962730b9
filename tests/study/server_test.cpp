// SPDX-License-Identifier: GPL-3.0-or-later
// The server over HTTP: many participants at once, and being killed.
#include "study/server.h"
#include "base/read_file.h"
#include "base/sha256.h"

#include <array>
#include <atomic>
#include <barrier>
#include <random>
#include <thread>

#include "base/answer_file.h"
#include "study/answers.h"
#include "study/connections.h"
#include "study/http_client.h"
#include "study/http_server.h"
#include "study/page_assets.h"
#include "tests/study/raw_connection.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

// A whole session up to saving. Returns the token.
std::string take_part(HttpClient& client, bool fetches_media) {
  const auto started = client.post("/api/start", {{"consent", true}});
  if (!started || started->status != 200) {
    ADD_FAILURE() << "start";
    return "";
  }
  const json session = json::parse(started->body);
  const std::string token = session["token"];
  for (std::size_t i = 0; i < session["trials"].size(); ++i) {
    if (fetches_media) {
      const auto media = client.get(session["trials"][i]["mp4"].get<std::string>());
      EXPECT_TRUE(media && media->status == 200 && media->body.size() > 100000);
    }
    EXPECT_EQ(client.post("/api/show", {{"index", i}}, token)->status, 200);
    EXPECT_EQ(client.post("/api/answer", answer_body(i), token)->status, 200);
  }
  return token;
}

TEST(Server, AHundredParticipantsAtOnce) {
  const fs::path folder = scratch_folder();
  RunningServer running(desk_options(folder));
  std::vector<std::thread> people;
  std::atomic<int> saved = 0;
  people.reserve(100);
  for (int i = 0; i < 100; ++i) {
    people.emplace_back([&] {
      HttpClient client(running.server.address());
      const std::string token = take_part(client, true);
      const auto result = client.post("/api/save", {{"free_text", json::object()}}, token);
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
    parse_answer_file(file, path.string());
    numbers.insert(file["participant_number"].get<long>());
  }
  EXPECT_EQ(numbers.size(), 100U) << "every plan once";
  EXPECT_EQ(*numbers.rbegin(), 99);
}

TEST(Server, PartsOfClips) {
  RunningServer running(desk_options(scratch_folder()));
  HttpClient client(running.server.address());
  const json session = json::parse(client.post("/api/start", {{"consent", true}})->body);
  const std::string path = session["trials"][0]["mp4"];
  const std::string whole = client.get(path)->body;
  const auto part = [&](const std::string& range) { return client.get(path, {{"Range", range}}); };
  EXPECT_EQ(part("bytes=0-9")->body, whole.substr(0, 10));
  EXPECT_EQ(part("bytes=0-9")->status, 206);
  EXPECT_EQ(part("bytes=5-")->body, whole.substr(5));
  EXPECT_EQ(part("bytes=-7")->body, whole.substr(whole.size() - 7));
  EXPECT_EQ(part("bytes=100-99999999999")->body, whole.substr(100));
  EXPECT_EQ(part("bytes=100-99999999999")->header("content-range"),
            "bytes 100-" + std::to_string(whole.size() - 1) + "/" + std::to_string(whole.size()));
  for (const char* bad : {"bytes=99999999-", "bytes=5-2", "bytes=0-1,3-4", "bytes=-0", "bytes=x"}) {
    EXPECT_EQ(part(bad)->status, 416) << bad;
  }
}

// The answer to a header alone: the server must not wait for a body that it will not take.
TEST(Server, WhatIsTooLongIsRefusedBeforeItIsRead) {
  RunningServer running(desk_options(scratch_folder()));
  const std::string head = "POST /api/start HTTP/1.1\r\nHost: 127.0.0.1\r\n";
  const std::string& address = running.server.address();
  EXPECT_EQ(raw_status(address, head + "Content-Length: 400000000\r\n\r\n"), 413);
  EXPECT_EQ(raw_status(address, head + "Transfer-Encoding: chunked\r\n\r\n"), 411);
  EXPECT_EQ(raw_status(address, head + "Content-Length: 5\r\nContent-Length: 5\r\n\r\n"), 400);
  EXPECT_EQ(raw_status(address, head + "X: " + std::string(8192, 'a')), 431) << "without an end";
}

// Connections that send nothing, or a byte now and then, take nobody's place.
TEST(Server, SlowConnectionsHoldUpNobodyAndEnd) {
  const fs::path folder = scratch_folder();
  ServerOptions options;
  options.limits.header_time = options.limits.body_time = std::chrono::seconds(2);
  options.limits.connections_of_address = 40;
  RunningServer running(desk_options(folder), options);
  const std::string get = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ";
  const std::string post =
      "POST /api/start HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 9\r\n\r\n";
  std::vector<std::unique_ptr<RawConnection>> slow;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) {
    slow.push_back(std::make_unique<RawConnection>(running.server.address()));
    slow.back()->send(i % 3 == 0 ? "" : i % 3 == 1 ? get : post);
  }
  HttpClient client(running.server.address());
  EXPECT_EQ(client.get("/api/study")->status, 200);
  while (!std::ranges::all_of(slow, &RawConnection::has_ended)) {
    for (const auto& connection : slow) {
      connection->send("x");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  EXPECT_GE(std::chrono::steady_clock::now() - begin, options.limits.header_time)
      << "the last was cut off before its time";
}

TEST(Server, FourHundredFetchesAtOnceAreAllServed) {
  RunningServer running(desk_options(scratch_folder()));
  HttpClient client(running.server.address());
  const json session = json::parse(client.post("/api/start", {{"consent", true}})->body);
  const std::string path = session["trials"][0]["mp4"];
  const std::string whole = client.get(path)->body;
  std::atomic<int> good = 0;
  std::barrier begin(400);
  std::vector<std::jthread> people;
  people.reserve(400);
  for (int i = 0; i < 400; ++i) {
    people.emplace_back([&] {
      HttpClient browser(running.server.address());
      begin.arrive_and_wait();
      const auto answer = browser.get(path);
      good += answer && answer->body == whole ? 1 : 0;
    });
  }
  people.clear();
  EXPECT_EQ(good, 400);
}

TEST(Connections, TheLongestWaitingMakesRoom) {
  Connections connections(5, 3);
  for (const Connections::Id id : {1U, 2U, 3U}) {
    EXPECT_TRUE(connections.add(id, "a").is_admitted);
  }
  connections.works(1);
  auto admission = connections.add(4, "a");
  EXPECT_EQ(admission.closed, 2U) << "1 has a request";
  EXPECT_EQ(connections.size(), 3U);
  connections.waits(1);
  EXPECT_EQ(connections.add(5, "a").closed, 3U) << "the time of 1 began anew";
  EXPECT_FALSE(connections.add(6, "b").closed);
  EXPECT_FALSE(connections.add(7, "b").closed);
  admission = connections.add(8, "c");
  EXPECT_EQ(admission.closed, 4U) << "of the address that has most";
  EXPECT_TRUE(admission.is_admitted);
  for (const Connections::Id id : {1U, 5U, 6U, 7U, 8U}) {
    connections.works(id);
  }
  EXPECT_FALSE(connections.add(9, "d").is_admitted) << "nobody's work is cut off";
  connections.remove(6);
  connections.remove(6);
  EXPECT_TRUE(connections.add(10, "d").is_admitted);
  EXPECT_EQ(connections.size(), 5U);
}

TEST(Http, Hosts) {
  for (const char* host : {"127.0.0.1", "127.0.0.1:8080", "192.168.1.7:80", "localhost",
                           "LocalHost:8080", "[::1]", "[::1]:8080", "study.example.org:443"}) {
    EXPECT_TRUE(is_our_host(host, {"Study.example.org"})) << host;
  }
  for (const char* host : {"", "evil.example", "study.example.org.evil", "127.0.0.1:99999",
                           "127.0.0.1:", "1.2.3", "[::1]x", "[::1]:", "[]", "localhost:80:80"}) {
    EXPECT_FALSE(is_our_host(host, {"study.example.org"})) << host;
  }
}

bool has_ipv6() {
  const int socket = ::socket(AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ::close(socket);
  return socket >= 0;
}

TEST(Http, AnAddressForAllIsToldAsOneThatCanBeOpened) {
  EXPECT_EQ(openable_host("127.0.0.1"), "127.0.0.1");
  EXPECT_EQ(openable_host("::1"), "::1");
  for (const std::string all : {"0.0.0.0", "::"}) {
    if (all == "::" && !has_ipv6()) continue;
    Desk desk(desk_options(scratch_folder()));
    ServerOptions options;
    options.host = all;
    Server server(desk, options);
    std::thread thread([&] { server.run(); });
    EXPECT_EQ(server.address().find(all), std::string::npos) << server.address();
    EXPECT_EQ(raw_status(server.address(), "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"), 200);
    server.stop();
    thread.join();
  }
}

// What would help is told, and no more.
TEST(Http, AnAddressThatCannotBeHadSaysWhatHelps) {
  const auto why = [](const std::string& host, int port) -> std::string {
    try {
      const HttpServer server(host, port, {}, [](const HttpRequest&) { return HttpReply(); });
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  };
  const RunningServer running(desk_options(scratch_folder()));
  const std::string address = running.server.address();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  const std::string cure = "is another server running? Use another --port";
  EXPECT_NE(why("127.0.0.1", port).find(cure), std::string::npos) << why("127.0.0.1", port);
  EXPECT_THROW(check_address("127.0.0.1", port), std::runtime_error);
  EXPECT_NO_THROW(check_address("127.0.0.1", 0));
  for (const char* host : {"300.1.1.1", "192.0.2.1"}) {
    EXPECT_EQ(why(host, 0).find("another server"), std::string::npos) << why(host, 0);
    EXPECT_NE(why(host, 0).find("use another --host"), std::string::npos) << why(host, 0);
  }
}

TEST(Server, HeadersOfEveryReply) {
  RunningServer running(desk_options(scratch_folder()));
  HttpClient client(running.server.address());
  for (const char* path :
       {"/", "/main.js", "/researcher", "/api/study", "/api/session", "/nothing"}) {
    const auto reply = client.get(path);
    ASSERT_TRUE(reply) << path;
    const std::string policy = reply->header("content-security-policy");
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos) << path;
    EXPECT_EQ(policy.find("unsafe"), std::string::npos) << path;
    EXPECT_EQ(reply->header("cache-control"), "no-store") << path;
    EXPECT_FALSE(reply->has("access-control-allow-origin")) << path;
    EXPECT_FALSE(reply->has("server")) << path;
  }
  const auto overview = client.get("/api/overview", bearer(running.server.researcher_token()));
  EXPECT_EQ(overview->status, 200);
  EXPECT_EQ(client.get("/api/overview", bearer(std::string(32, '0')))->status, 401);
}

struct Participant {
  std::string token, code;  // the code once the server has confirmed
};

// Everybody saves at the same time; the server is killed `delay` after so many of them have got an
// answer.
void save_all_and_kill(ServerProcess& server, std::vector<Participant>& people, int answers,
                       std::chrono::microseconds delay) {
  const std::string address = server.address();
  std::atomic<int> answered = 0;
  std::vector<std::thread> threads;
  threads.reserve(people.size());
  for (Participant& person : people) {
    threads.emplace_back([&] {
      HttpClient client(address);
      const auto result = client.post("/api/save", {{"free_text", json::object()}}, person.token);
      if (result && result->status == 200) {
        person.code = json::parse(result->body)["code"];
      }
      ++answered;
      answered.notify_one();
    });
  }
  for (int now = 0; now < answers; now = answered) {
    answered.wait(now);
  }
  std::this_thread::sleep_for(delay);
  server.kill();
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
    ServerProcess server(PINCHLAB_PROGRAM, folder);
    const std::string address = server.address();
    ASSERT_NE(address, "");
    std::vector<Participant> people(4);
    for (Participant& person : people) {
      HttpClient client(address);
      person.token = take_part(client, false);
    }
    const int answers = static_cast<int>(random() % people.size());
    save_all_and_kill(server, people, answers, std::chrono::microseconds(random() % 4000));
    for (const Participant& person : people) {
      (person.code.empty() ? cut_off : told) += 1;
      if (!person.code.empty()) {
        confirmed.insert(person.token.substr(0, 16));
      }
    }
    // Every file under a final name is whole, and nobody who was told is missing.
    std::set<std::string> kept;
    for (const fs::path& path : answer_files(folder / "answers")) {
      ASSERT_NO_THROW(parse_answer_file(json::parse(read_whole(path)), path.string()));
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
