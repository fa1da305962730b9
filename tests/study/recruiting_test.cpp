// SPDX-License-Identifier: GPL-3.0-or-later
// Participants who are sent by a site: ids in, addresses back, one participation each.
#include "study/recruiting.h"

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "study/jatos.h"
#include "study/tables.h"
#include "tests/study/config_error.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* completion_url = "https://app.prolific.com/submissions/complete?cc=C1";

Config recruiting_config(const json& more = json::object()) {
  json document = {{"format", "pinchlab-study 1"},
                   {"demonstrations", demonstrations},
                   {"recruiting", {{"preset", "prolific"}, {"completion_url", completion_url}}}};
  document["recruiting"].update(more);
  return parse_config(document, "study.json");
}

DeskOptions recruiting_desk(const fs::path& folder) {
  DeskOptions options = desk_options(folder);
  options.config = recruiting_config();
  return options;
}

std::string start(Desk& desk, const std::string& participant) {
  return desk.start("", "", "", {participant, "s", ""});
}

std::string finish(Desk& desk, const std::string& token) {
  for (std::size_t i = 0; i < desk.progress(token).trials.size(); ++i) {
    desk.show(token, i);
    desk.answer(token, parse_answer(answer_body(i)));
  }
  return desk.save(token, {});
}

TEST(Recruiting, PresetsAndOwnNames) {
  const Config prolific = recruiting_config();
  EXPECT_EQ(
      for_page(*prolific.recruiting),
      (json{{"parameters",
             {{"participant", "PROLIFIC_PID"}, {"study", "STUDY_ID"}, {"session", "SESSION_ID"}}}}))
      << "nobody is told how to be done before it";
  EXPECT_EQ(completion(*prolific.recruiting), (json{{"url", completion_url}}));
  const Config sona = recruiting_config(
      {{"preset", "sona"},
       {"completion_url", "https://x.sona-systems.com/?survey_code={participant}"},
       {"declined_url", "https://x.sona-systems.com/"},
       {"session_parameter", "visit"}});
  EXPECT_EQ(for_page(*sona.recruiting),
            (json{{"parameters", {{"participant", "survey_code"}, {"session", "visit"}}},
                  {"declined_url", "https://x.sona-systems.com/"}}));
}

TEST(Recruiting, ParticipantsAreToldWhatIsKept) {
  const auto english = delivered_texts("en");
  const Config config = recruiting_config();
  const std::string& rights = config.texts.at("information_rights");
  EXPECT_EQ(rights, english.at("collected_rights") + "\n\n" + english.at("recruiting_rights"));
  EXPECT_EQ(rights.find("No personal data"), std::string::npos);
  const Config own = parse_config({{"format", "pinchlab-study 1"},
                                   {"texts", {{"information_rights", "Ours."}}},
                                   {"recruiting", {{"preset", "sona"}}}},
                                  "study.json");
  EXPECT_EQ(own.texts.at("information_rights"), "Ours.\n\n" + english.at("recruiting_rights"));
  for (const auto& [key, text] : default_config().texts) {
    EXPECT_FALSE(key.starts_with("recruiting_") || key.starts_with("collected_")) << key;
    EXPECT_EQ(text, english.at(key));
  }
}

TEST(Recruiting, ErrorsNamePlaceAndCure) {
  const std::vector<std::pair<json, const char*>> bad = {
      {{{"preset", "mturk"}}, "/recruiting/preset"},
      {{{"complete_url", "https://a.org"}}, "did you mean `completion_url`?"},
      {{{"participant_parameter", "a b"}}, "/recruiting/participant_parameter: must be 1 to 64"},
      {{{"participant_parameter", ""}}, "must be 1 to 64"},
      {{{"participant_parameter", std::string(65, 'x')}}, "longer than 64"},
      {{{"study_parameter", "PROLIFIC_PID"}}, "has another meaning"},
      {{{"session_parameter", "link"}}, "has another meaning"},
      {{{"completion_url", "http://a.org"}}, "must be an address such as https://"},
      {{{"completion_url", "javascript:alert(1)"}}, "must be an address"},
      {{{"completion_url", "https://"}}, "must be an address"},
      {{{"completion_url", "https://user@a.org/"}}, "must be an address"},
      {{{"completion_url", "https://{participant}.org/"}}, "must be an address"},
      {{{"completion_url", "https://a.org/ b"}}, "must be an address"},
      {{{"completion_url", "https://a.org/\"x"}}, "must be an address"},
      {{{"completion_url", "https://a.org/?{name}"}}, "no other braces"},
      {{{"completion_url", "https://a.org/?{participant"}}, "no other braces"},
      {{{"completion_url", "https://a.org/?}"}}, "no other braces"},
      {{{"full_url", 7}}, "/recruiting/full_url"},
      {{{"screen_out_url", "https://a.org/" + std::string(2000, 'x')}}, "longer than 2000"},
      {{{"completion_code", "<b>"}}, "/recruiting/completion_code"},
  };
  for (const auto& [more, message] : bad) {
    try {
      recruiting_config(more);
      ADD_FAILURE() << more << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
    }
  }
  EXPECT_NE(error_with_format({{"recruiting", json::object()}}).find("name the parameter"),
            std::string::npos);
  for (const char* other : {"one_time_links", "shared_computer"}) {
    EXPECT_NE(error_with_format({{other, true}, {"recruiting", {{"preset", "sona"}}}})
                  .find("cannot be combined"),
              std::string::npos);
  }
  EXPECT_NE(error_with_format(
                {{"recruiting", {{"preset", "sona"}, {"full_url", "https://a.org/?s={study}"}}}})
                .find("no other braces"),
            std::string::npos)
      << "SONA names no study";
}

TEST(Recruiting, IdsAreChecked) {
  const auto status = [](const json& recruited) {
    return refused([&] { parse_recruited({{"recruited", recruited}}); });
  };
  EXPECT_EQ(status({{"participant", "5f0-a_b.c~9"}, {"study", "s"}, {"session", "t"}}), 0);
  for (const json& bad :
       {json("p"), json::object(), json{{"participant", ""}}, json{{"participant", 7}},
        json{{"participant", "{{%PROLIFIC_PID%}}"}}, json{{"participant", "a b"}},
        json{{"participant", "å"}}, json{{"participant", std::string(129, 'a')}},
        json{{"participant", "a"}, {"study", ""}}, json{{"participant", "a"}, {"name", "b"}}}) {
    EXPECT_EQ(status(bad), 422) << bad;
  }
}

TEST(Recruiting, OneParticipationAnId) {
  const fs::path folder = scratch_folder();
  std::string finished;
  {
    Desk desk(recruiting_desk(folder));
    EXPECT_EQ(refused([&] { desk.start("", ""); }), 403) << "without an id";
    const std::string lost = start(desk, "a");  // the reply is lost
    const std::string token = start(desk, "a");
    EXPECT_EQ(refused([&] { desk.progress(lost); }), 401);
    desk.show(token, 0);
    EXPECT_EQ(refused([&] { start(desk, "a"); }), 410) << "is taking part";
    desk.leave(token);
    finished = start(desk, "a");  // nothing was kept
    finish(desk, finished);
    EXPECT_EQ(refused([&] { start(desk, "a"); }), 410) << "has taken part";
    desk.show(start(desk, "b"), 0);
  }
  Desk desk(recruiting_desk(folder));
  EXPECT_EQ(refused([&] { start(desk, "a"); }), 410) << "after a restart too";
  EXPECT_EQ(refused([&] { start(desk, "b"); }), 410);
  const json file = json::parse(read_whole(answer_files(folder / "answers").front()));
  EXPECT_EQ(file["recruited"], (json{{"participant", "a"}, {"study", "s"}}));
}

TEST(Recruiting, OverHttp) {
  const fs::path folder = scratch_folder();
  DeskOptions options = recruiting_desk(folder);
  options.config.participant_limit = 1;
  RunningServer running(std::move(options));
  HttpClient client(running.server.address());
  const json study = json::parse(client.get("/api/study")->body);
  EXPECT_EQ(study["recruiting"]["parameters"]["participant"], "PROLIFIC_PID");
  EXPECT_EQ(client.get("/api/study")->body.find("cc=C1"), std::string::npos);
  const auto starting = [&](const json& recruited) {
    return client.post("/api/start", {{"consent", true}, {"recruited", recruited}});
  };
  EXPECT_EQ(client.post("/api/start", {{"consent", true}})->status, 403);
  EXPECT_EQ(starting({{"participant", "a b"}})->status, 422);
  EXPECT_EQ(starting(json::array())->status, 422);
  const auto started = starting({{"participant", "a"}});
  ASSERT_EQ(started->status, 200);
  const std::string token = json::parse(started->body)["token"];
  EXPECT_EQ(started->body.find("cc=C1"), std::string::npos);
  for (std::size_t i = 0; i < demonstrations.size(); ++i) {
    client.post("/api/show", {{"index", i}}, token);
    client.post("/api/answer", answer_body(i), token);
  }
  const json body = {{"free_text", json::object()}};
  const json saved = json::parse(client.post("/api/save", body, token)->body);
  EXPECT_EQ(saved["completion"], (json{{"url", completion_url}}));
  EXPECT_EQ(json::parse(client.post("/api/save", body, token)->body), saved) << "sent again";
  EXPECT_EQ(starting({{"participant", "a"}})->status, 410);
  EXPECT_EQ(starting({{"participant", "b"}})->status, 409) << "the study is full";
}

TEST(Recruiting, IdsAreInNoTableForOthers) {
  const fs::path folder = scratch_folder();
  {
    Desk desk(recruiting_desk(folder));
    finish(desk, start(desk, "5f0abc"));
  }
  EXPECT_NE(participants_csv(folder / "answers").find("recruited_session\n"), std::string::npos);
  EXPECT_NE(participants_csv(folder / "answers").find(",5f0abc,s,\n"), std::string::npos);
  EXPECT_EQ(answers_csv(folder / "answers").find("5f0abc"), std::string::npos);
  for (const auto& files : {bids_files(folder / "answers"), psych_ds_files(folder / "answers")}) {
    for (const auto& [name, bytes] : files) {
      EXPECT_EQ(bytes.find("5f0abc"), std::string::npos) << name;
      EXPECT_EQ(bytes.find("recruited"), std::string::npos) << name;
    }
  }
}

TEST(Recruiting, JatosHasItsOwn) {
  const fs::path folder = scratch_folder();
  write_clips(folder / "clips");
  const Config config = recruiting_config();
  EXPECT_THROW(export_jatos(config, open_clips(folder / "clips", config), 7, 4, folder / "a.jzip"),
               std::runtime_error);
  EXPECT_FALSE(fs::exists(folder / "a.jzip"));
}

}  // namespace
}  // namespace pinchlab::study
