// SPDX-License-Identifier: GPL-3.0-or-later
// Archives for JATOS, and results that come back from it.
#include "study/jatos.h"

#include <zlib.h>

#include <map>
#include <set>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "study/answers.h"
#include "study/zip.h"
#include "tests/study/support.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

std::uint64_t number(const std::string& bytes, std::size_t at, unsigned size) {
  std::uint64_t value = 0;
  for (unsigned i = size; i > 0; --i) {
    value = (value << 8U) | static_cast<unsigned char>(bytes.at(at + i - 1));
  }
  return value;
}

std::string inflated(std::string packed, std::size_t size) {
  std::string bytes(size, '\0');
  z_stream stream = {};
  EXPECT_EQ(inflateInit2(&stream, -MAX_WBITS), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(size);
  // With nothing to write, the end is still to be read.
  EXPECT_EQ(inflate(&stream, Z_FINISH), Z_STREAM_END);
  inflateEnd(&stream);
  return bytes;
}

// The entries of an archive as its central directory has them.
std::map<std::string, std::string> unzip(const fs::path& path) {
  const std::string zip = read_whole(path);
  const std::size_t end = zip.rfind("PK\x05\x06");
  std::map<std::string, std::string> entries;
  std::size_t at = number(zip, end + 16, 4);
  for (std::uint64_t i = 0; i < number(zip, end + 10, 2); ++i) {
    EXPECT_EQ(zip.substr(at, 4), "PK\x01\x02");
    const std::uint64_t name_length = number(zip, at + 28, 2);
    const std::string name = zip.substr(at + 46, name_length);
    const std::uint64_t local = number(zip, at + 42, 4);
    EXPECT_EQ(zip.substr(local, 4), "PK\x03\x04");
    EXPECT_EQ(zip.substr(local + 30, name_length), name) << "both heads";
    constexpr std::uint64_t new_year_1980 = (1U << 5U) | 1U;  // the earliest that there is
    EXPECT_EQ(number(zip, at + 12, 4), new_year_1980 << 16U) << "a date tells something";
    const std::uint64_t data = local + 30 + number(zip, local + 26, 2) + number(zip, local + 28, 2);
    const std::string bytes =
        inflated(zip.substr(data, number(zip, at + 20, 4)), number(zip, at + 24, 4));
    const uLong crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    EXPECT_EQ(crc, number(zip, at + 16, 4)) << name;
    entries[name] = bytes;
    at += 46 + name_length + number(zip, at + 30, 2) + number(zip, at + 32, 2);
  }
  return entries;
}

// What the page submits for somebody with this plan.
json result(const json& input, int participant_number, std::size_t trials, const std::string& id) {
  json answers = json::array();
  for (std::size_t i = 0; i < trials; ++i) {
    answers.push_back(answer_body(0, i % 2 == 0 ? "left" : "right"));
    answers.back().erase("index");
    answers.back()["shown_utc"] = "2026-11-20T12:05:01.250Z";
  }
  return {{"format", "study-answers 1"},
          {"study", input["study"]},
          {"participant", id},
          {"number", participant_number},
          {"language", "en"},
          {"user_agent", "browser"},
          {"started_utc", "2026-11-20T12:05:00.000Z"},
          {"saved_utc", "2026-11-20T12:15:00.000Z"},
          {"resumed_count", 0},
          {"withdrawal_code", "7K3M-9Q2X-0BVA"},
          {"free_text", {{"thoughts", "none"}}},
          {"answers", answers}};
}

struct Exported {
  fs::path folder;
  std::map<std::string, std::string> entries;
  json input;
};

Exported exported(const Config& config) {
  Exported exported;
  exported.folder = scratch_folder();
  write_clips(exported.folder / "clips");
  export_jatos(config, open_clips(exported.folder / "clips", config), 7, 4,
               exported.folder / "study.jzip");
  exported.entries = unzip(exported.folder / "study.jzip");
  const json jas = json::parse(exported.entries.at("moving_cables.jas"));
  exported.input = json::parse(jas["data"]["componentList"][0]["jsonData"].get<std::string>());
  return exported;
}

TEST(Zip, EntriesComeBack) {
  const fs::path path = scratch_folder() / "a.zip";
  std::string noise(300000, '\0');
  for (std::size_t i = 0; i < noise.size(); ++i) {
    noise[i] = static_cast<char>((i * i * 2654435761U) >> 13U);
  }
  const std::map<std::string, std::string> entries = {
      {"a/empty", ""}, {"a/noise", noise}, {"b", std::string(1000000, 'x')}, {"å.txt", "text"}};
  {
    ZipWriter zip(path);
    for (const auto& [name, bytes] : entries) {
      zip.add(name, bytes);
    }
    EXPECT_FALSE(fs::exists(path)) << "not before it is complete";
    zip.finish();
  }
  EXPECT_EQ(unzip(path), entries);
  { ZipWriter interrupted(path.parent_path() / "b.zip"); }
  EXPECT_FALSE(fs::exists(path.parent_path() / "b.zip"));
  EXPECT_FALSE(fs::exists(path.parent_path() / "b.zip.partial"));
  EXPECT_THROW(ZipWriter(path.parent_path() / "none" / "c.zip"), std::runtime_error);
}

TEST(Jatos, PlansNameClipsThatTellNothing) {
  Config config = small_config();
  config.repetitions = 2;
  const Exported study = exported(config);
  const json key = read_json_file(study.folder / "study.key.json", 1U << 20U);
  std::set<std::size_t> sizes;
  for (int participant = 0; participant < 4; ++participant) {
    const json plan = json::parse(
        study.entries.at("moving_cables/plans/" + std::to_string(participant) + ".json"));
    const std::vector<PlannedTrial> expected =
        make_plan(7, static_cast<std::uint64_t>(participant), plan_options(config));
    ASSERT_EQ(plan.size(), expected.size());
    std::set<std::string> names;
    for (std::size_t i = 0; i < plan.size(); ++i) {
      const auto media = plan[i]["mp4"].get<std::string>();
      EXPECT_TRUE(names.insert(media).second) << "a name that is shown twice";
      const std::string& clip = study.entries.at("moving_cables/" + media);
      sizes.insert(clip.size());
      // It is the clip that the plan asks for.
      const std::string side = expected[i].pinch == Side::left ? "pinch" : "baseline";
      const std::string file = read_whole(study.folder / "clips" /
                                          (expected[i].demonstration + ".left-" + side + ".mp4"));
      EXPECT_EQ(clip.substr(0, file.size()), file);
      EXPECT_EQ(
          "media/" +
              key["plans"][static_cast<std::size_t>(participant)][i]["media"].get<std::string>() +
              ".mp4",
          media);
    }
  }
  EXPECT_EQ(sizes.size(), 1U);
  for (const auto& [name, bytes] : study.entries) {
    for (const char* word : {"pinch", "baseline", "01-first", "02-second", "03-third"}) {
      EXPECT_EQ(name.find(word), std::string::npos) << name;
      if (name.find("jspsych") == std::string::npos) {
        EXPECT_EQ(bytes.find(word), std::string::npos) << name << " holds " << word;
      }
    }
  }
}

TEST(Jatos, ResultsBecomeAnswerFiles) {
  const Exported study = exported(small_config());
  const fs::path results = study.folder / "results";
  fs::create_directories(results / "study_result_1" / "comp-result_1");
  write_text(results / "study_result_1" / "comp-result_1" / "data.txt",
             result(study.input, 2, 3, "0123456789abcdef").dump());
  write_text(results / "more.txt",
             "\n" + result(study.input, 3, 3, "0123456789abcde0").dump() + "\n\n");
  const auto bring = [&] {
    return import_jatos({results}, study.folder / "study.key.json", study.folder / "answers");
  };
  EXPECT_EQ(bring().added, 2);
  EXPECT_EQ(bring().known, 2) << "a second time changes nothing";
  const json file = json::parse(read_whole(study.folder / "answers" / "0123456789abcdef.json"));
  parse_answer_file(file, "answers");
  const std::vector<PlannedTrial> plan = make_plan(7, 2, plan_options(small_config()));
  for (std::size_t i = 0; i < plan.size(); ++i) {
    EXPECT_EQ(file["trials"][i]["demonstration"], plan[i].demonstration);
    EXPECT_EQ(file["trials"][i]["left"], plan[i].pinch == Side::left ? "pinch" : "baseline");
    EXPECT_EQ(file["trials"][i]["choice"], i % 2 == 0 ? "left" : "right");
  }
  EXPECT_EQ(withdraw(study.folder / "answers", "7K3M-9Q2X-0BVA").value(), "0123456789abcde0")
      << "both have the code of this test; the first goes";
}

TEST(Jatos, OwnQuestionsComeBackChecked) {
  const Config config = parse_config({{"format", "pinchlab-study 1"},
                                      {"demonstrations", demonstrations},
                                      {"questionnaire_after",
                                       {{{"name", "age"},
                                         {"kind", "number"},
                                         {"text", "How old are you?"},
                                         {"min", 18},
                                         {"max", 120},
                                         {"required", true}}}}},
                                     "study.json");
  const Exported study = exported(config);
  EXPECT_EQ(study.input["questionnaires"]["after"][0]["name"], "age");
  const auto bring = [&](const json& given) {
    json one = result(study.input, 0, 3, "0123456789abcdef");
    if (!given.is_null()) one["questionnaires"] = given;
    write_text(study.folder / "results.txt", one.dump());
    return import_jatos({study.folder / "results.txt"}, study.folder / "study.key.json",
                        study.folder / "answers");
  };
  EXPECT_THROW(bring(nullptr), InputError) << "the answers are missing";
  EXPECT_THROW(bring({{"after", {{"age", 17}}}}), InputError);
  EXPECT_THROW(bring({{"after", {{"age", 44}}}, {"before", json::object()}}), InputError);
  EXPECT_FALSE(fs::exists(study.folder / "answers"));
  EXPECT_EQ(bring({{"after", {{"age", 44}}}}).added, 1);
  const json file = json::parse(read_whole(study.folder / "answers" / "0123456789abcdef.json"));
  EXPECT_EQ(file["questionnaires"]["after"]["age"]["answer"], 44);
}

TEST(Jatos, WhatWasAskedInTrialsComesBackChecked) {
  const Config config = parse_config({{"format", "pinchlab-study 1"},
                                      {"demonstrations", demonstrations},
                                      {"preference", "graded"},
                                      {"confidence", 3}},
                                     "study.json");
  const Exported study = exported(config);
  EXPECT_EQ(study.input["trial_options"], (json{{"preference", "graded"}, {"confidence", 3}}));
  const auto bring = [&](const json& more) {
    json one = result(study.input, 0, 3, "0123456789abcdef");
    for (json& answer : one["answers"]) answer.update(more);
    write_text(study.folder / "results.txt", one.dump());
    return import_jatos({study.folder / "results.txt"}, study.folder / "study.key.json",
                        study.folder / "answers");
  };
  const json tie = {{"choice", "tie"}, {"preference", 0}};
  EXPECT_THROW(bring(json::object()), InputError) << "nothing of it is there";
  EXPECT_THROW(bring(tie), InputError) << "the confidence is missing";
  json full = tie;
  full["confidence"] = 4;
  EXPECT_THROW(bring(full), InputError) << "beyond the scale";
  full["confidence"] = 3;
  full["reason"] = "none";
  EXPECT_THROW(bring(full), InputError) << "was not asked";
  EXPECT_FALSE(fs::exists(study.folder / "answers"));
  full.erase("reason");
  EXPECT_EQ(bring(full).added, 1);
}

TEST(Jatos, WhatCannotBeIsToldAndNothingIsWritten) {
  const Exported study = exported(small_config());
  const auto error = [&](const std::string& text) -> std::string {
    write_text(study.folder / "results.txt", text);
    try {
      import_jatos({study.folder / "results.txt"}, study.folder / "study.key.json",
                   study.folder / "answers");
    } catch (const std::exception& problem) {
      return problem.what();
    }
    return "no error";
  };
  const json good = result(study.input, 0, 3, "0123456789abcdef");
  const auto with = [&](const char* key, const json& value) {
    json document = good;
    document[key] = value;
    return good.dump() + "\n" + document.dump();
  };
  const std::vector<std::pair<std::string, std::string>> bad = {
      {good.dump() + "\nnonsense", "results.txt:2: is not JSON"},
      {with("number", 4), "results.txt:2"},
      {with("study", "another"), "belongs to another archive"},
      {with("participant", "../escape"), "results.txt:2"},
      {with("withdrawal_code", "x"), "no withdrawal code"},
      {with("answers", json::array()), "left to answer"},
      {with("extra", 1), "extra"},
  };
  for (const auto& [text, message] : bad) {
    EXPECT_NE(error(text).find(message), std::string::npos) << error(text);
    EXPECT_FALSE(fs::exists(study.folder / "answers"));
  }
  EXPECT_EQ(error(good.dump()), "no error");
}

TEST(Jatos, AParticipantDoesNotChooseTwice) {
  const Exported study = exported(small_config());
  const auto bring = [&](const std::vector<json>& results) {
    std::string text;
    for (const json& one : results) text += one.dump() + "\n";
    write_text(study.folder / "results.txt", text);
    return import_jatos({study.folder / "results.txt"}, study.folder / "study.key.json",
                        study.folder / "answers");
  };
  const json first = result(study.input, 0, 3, "0123456789abcdef");
  json other = first, later = first;
  other["answers"][2]["choice"] = "right";
  later["saved_utc"] = "2026-11-20T12:16:00.000Z";
  const auto refusal = [&](const std::vector<json>& results) -> std::string {
    try {
      bring(results);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_NE(refusal({first, other}).find("results.txt:2: participant 0123456789abcdef chose"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(study.folder / "answers"));
  EXPECT_EQ(bring({first, later}).known, 1);
  EXPECT_NE(refusal({other}).find("chose otherwise in " + (study.folder / "answers").string()),
            std::string::npos);
  EXPECT_EQ(bring({first}).known, 1);
}

TEST(Jatos, AClockThatWasSetBackIsTold) {
  const Exported study = exported(small_config());
  json document = result(study.input, 0, 3, "0123456789abcdef");
  document["saved_utc"] = "2026-11-20T11:15:00.000Z";
  write_text(study.folder / "results.txt", document.dump());
  const Imported imported = import_jatos({study.folder / "results.txt"},
                                         study.folder / "study.key.json", study.folder / "answers");
  EXPECT_EQ(imported.added, 1);
  ASSERT_EQ(imported.notes.size(), 1U);
  EXPECT_NE(imported.notes[0].find("results.txt:1: saved_utc 2026-11-20T11:15:00.000Z is before"),
            std::string::npos);
}

// A key that was changed by hand: what it makes of good results is no answer file.
TEST(Jatos, NothingIsWrittenWithADamagedKey) {
  const Exported study = exported(small_config());
  const fs::path results = study.folder / "results.txt", key = study.folder / "study.key.json";
  write_text(results, result(study.input, 0, 3, "0123456789abcdef").dump() + "\n" +
                          result(study.input, 1, 3, "0123456789abcde0").dump());
  json damaged = json::parse(read_whole(key));
  damaged["shown"]["question"] = 7;
  write_text(key, damaged.dump());
  try {
    import_jatos({results}, key, study.folder / "answers");
    FAIL() << "a question that is a number was taken";
  } catch (const InputError& error) {
    EXPECT_TRUE(error.place.starts_with(results.string() + ":1")) << error.what();
  }
  EXPECT_FALSE(fs::exists(study.folder / "answers"));
}

TEST(Jatos, AKeyIsNotWrittenOver) {
  const Exported study = exported(small_config());
  const Config config = small_config();
  EXPECT_THROW(export_jatos(config, open_clips(study.folder / "clips", config), 7, 4,
                            study.folder / "study.jzip"),
               std::runtime_error);
}

}  // namespace
}  // namespace pinchlab::study
