// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "base/answer_file.h"
#include "base/input_error.h"
#include "base/text_checks.h"
#include "tests/analysis/support.h"

namespace pinchlab::analysis {
namespace {

using nlohmann::json;
using test::TemporaryFolder;
namespace fs = std::filesystem;

struct Refused {
  std::string name, content, says;
};

void expect_refused(const Refused& one, const ReadOptions& options = {}) {
  const TemporaryFolder folder;
  const fs::path file = folder.write(one.name, one.content);
  try {
    read_answers({file}, options);
    ADD_FAILURE() << "was accepted: " << one.content.substr(0, 200);
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find(one.says), std::string::npos)
        << message << "\n for " << one.content.substr(0, 200);
    EXPECT_NE(message.find(one.name), std::string::npos) << "no file in: " << message;
  }
}

const std::string head = "participant,demonstration,choice";

void expect_log_refused(const std::string& content, const std::string& says) {
  expect_refused({"log.csv", content, says});
}

TEST(Malformed, TidyCsvHeaders) {
  expect_log_refused("", "empty");
  expect_log_refused("\n\n\n", "empty");
  expect_log_refused("\xEF\xBB\xBF", "empty");
  expect_log_refused(head + "\n", "no answers");
  expect_log_refused("participant,demonstration\na,1\n", "`choice` is missing");
  expect_log_refused("participant,choice\na,pinch\n", "`demonstration` is missing");
  expect_log_refused("demonstration,choice\n1,pinch\n", "`participant` is missing");
  expect_log_refused("participant;demonstration;choice\na;1;pinch\n", "--separator");
  expect_log_refused("participant\tdemonstration\tchoice\n", "--separator");
  expect_log_refused("Participant,demonstration,choice\na,1,pinch\n", "did you mean `participant`");
  expect_log_refused(head + ",postion\na,1,pinch,1\n", "did you mean `position`");
  expect_log_refused(head + ",reaction_time\na,1,pinch,1\n", "did you mean `reaction_time_s`");
  expect_log_refused(head + ",age\na,1,pinch,1\n", "--ignore-other-columns");
  expect_log_refused(head + ",choice\na,1,pinch,pinch\n", "twice");
  expect_log_refused(head + ",\na,1,pinch,\n", "unknown column");
  expect_log_refused(head + ",pinch\na,1,pinch,1\n", "unknown column `pinch`");
  expect_log_refused("pinch,cable\n1,2\n", "`demonstration` is missing");
}

TEST(Malformed, TidyCsvRecords) {
  expect_log_refused(head + "\na,1\n", ":2: 2 fields");
  expect_log_refused(head + "\na,1,pinch,x\n", ":2: 4 fields");
  expect_log_refused(head + "\na,1,pinch\n\n\nb,1\n", ":5: 2 fields");
  expect_log_refused(head + "\n\"a,1,pinch\n", "a quote is not closed");
  expect_log_refused(head + "\n\"a\"x,1,pinch\n", ":2: text after a closing quote");
  expect_log_refused(head + "\na\"x,1,pinch\n", ":2: a quote");
  expect_log_refused(head + "\n\"a\n\",1,pinch\n", "control character");
  expect_log_refused(head + "\n\"" + std::string(2 << 20, 'x') + "\",1,pinch\n", "1 MiB");
  expect_log_refused(head + "\n" + std::string(2 << 20, 'x'), "1 MiB");
  expect_log_refused(head + std::string("\na\0b,1,pinch\n", 13), "zero byte");
}

TEST(Malformed, TidyCsvNames) {
  expect_log_refused(head + "\n,1,pinch\n", "bad participant: it is empty");
  expect_log_refused(head + "\na,,pinch\n", "bad demonstration: it is empty");
  expect_log_refused(head + "\n a,1,pinch\n", "blank");
  expect_log_refused(head + "\na ,1,pinch\n", "blank");
  expect_log_refused(head + "\na,1 ,pinch\n", "blank");
  expect_log_refused(head + "\na\x01,1,pinch\n", "control character");
  expect_log_refused(head + "\na\x7f,1,pinch\n", "control character");
  expect_log_refused(head + "\na\tb,1,pinch\n", "control character");
  expect_log_refused(head + "\n\xff,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n\xc3,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n\xc0\x80,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n\xe0\x80\x80,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n\xed\xa0\x80,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n\xf4\x90\x80\x80,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\nJos\xe9,1,pinch\n", "UTF-8");
  expect_log_refused(head + "\n" + std::string(129, 'x') + ",1,pinch\n", "128 bytes");
}

TEST(Malformed, TidyCsvChoices) {
  for (const char* choice :
       {"Pinch", "PINCH", "pinc", "1", "0", "left", "right", "baseline", "NA", "nan", "pinch "}) {
    expect_log_refused(head + fmt::format("\na,1,{}\n", choice), "choice");
  }
  expect_log_refused(head + "\na,1,pnich\n", "did you mean `pinch`");
  expect_log_refused(head + "\na,1,\n", "the choice is missing");
}

TEST(Malformed, TidyCsvContradictions) {
  expect_log_refused(head + "\na,1,pinch\na,1,pinch\n", "with the same choice");
  expect_log_refused(head + "\na,1,pinch\na,1,cable\n", "contradict");
  expect_log_refused(head + "\na,1,pinch\nb,1,pinch\na,1,cable\n", "log.csv:4");
  expect_log_refused(head + "\na,1,pinch\na,2,pinch\nb,1,pinch\n", "missing: demonstration `2`");
  expect_log_refused(head + "\na,2,pinch\na,1,pinch\nb,2,pinch\n", "missing: demonstration `1`");
  expect_log_refused(head + ",position\na,1,pinch,1\na,2,pinch,1\n", "two answers at position 1");
  expect_log_refused(head + ",group\na,1,pinch,x\nb,1,pinch,y\n", "one group");
  expect_log_refused(head + ",group\na,1,pinch,x\nb,1,pinch,\n", "one group");
  expect_log_refused(head + ",group\na,1,pinch,all\n", "`all` always exists");
}

TEST(Malformed, TidyCsvOptionalColumns) {
  const std::string full = head + ",group,side,position,reaction_time_s,kind\n";
  for (const char* side : {"Left", "l", "top", "0", "leftt"}) {
    expect_log_refused(full + fmt::format("a,1,pinch,,{},1,1,main\n", side), "side");
  }
  for (const char* position :
       {"0", "-1", "1.5", "x", "65536", "1e3", "+1", " 1", "99999999999999999999", "0x1"}) {
    expect_log_refused(full + fmt::format("a,1,pinch,,left,{},1,main\n", position), "position");
  }
  for (const char* time : {"nan", "inf", "-inf", "-0.1", "86401", "1e400", "1,5", "1s", "0x1p3",
                           "--1", ".", "1e", " 1", "1 "}) {
    expect_log_refused(full + fmt::format("a,1,pinch,,left,1,\"{}\",main\n", time),
                       "reaction_time_s");
  }
  for (const char* kind : {"Main", "trial", "", "attn"}) {
    expect_log_refused(full + fmt::format("a,1,pinch,,left,1,1,{}\n", kind), "kind");
  }
  expect_log_refused(full + "a,1,pinch,,left,1,1,attention\n", "attention check");
  expect_log_refused(full + "a,1,pinch,,left,1,1,training\n", "no answers");
  expect_log_refused(full + "a,1,pinch,,left,1,1,main\nb,1,fail,,,,,attention\n", "missing");
}

TEST(Malformed, CountTables) {
  const std::string counts = "demonstration,pinch,cable\n";
  std::vector<Refused> cases;
  const auto add = [&](const std::string& content, const std::string& says) {
    cases.push_back({"counts.csv", content, says});
  };
  add(counts, "no answers");
  add("demonstration,pinch\n1,2\n", "`cable` is missing");
  add("demonstration,pinch,cables\n1,2,3\n", "did you mean `cable`");
  add(counts + "1,15\n", "2 fields");
  add(counts + "1,15,1\n1,14,2\n", ":3: demonstration `1` is counted twice");
  add(counts + "1,0,0\n", "no answers");
  for (const char* count :
       {"-1", "1.5", "", "x", "nan", "1e3", "1000000001", "15 ", "\"1,000\"", "0x10", "∞"}) {
    add(counts + fmt::format("1,{},1\n", count), "whole number");
    add(counts + fmt::format("1,1,{}\n", count), "whole number");
  }
  add(counts + "1,1000000000,1\n2,1000000000,1\n", "2000000000");
  add(counts + ",1,1\n", "bad demonstration");
  for (const Refused& one : cases) expect_refused(one);
  EXPECT_GE(cases.size(), 28U);
}

TEST(Malformed, AnswerFileText) {
  std::vector<Refused> cases;
  const auto add = [&](const std::string& content, const std::string& says) {
    cases.push_back({"p.json", content, says});
  };
  const std::string good = test::answer_document().dump();
  add("", "");
  add("[]", "must be an object");
  add("null", "must be an object");
  add("42", "must be an object");
  add("{", "line 1");
  add("{}", "`format` is missing");
  add("{\"format\": NaN}", "");
  add("{\"a\": 1, \"a\": 2}", "/a: key given twice");
  add("{\"a\": {\"b\": 1, \"b\": 1}}", "/a/b: key given twice");
  add("// comment\n{}", "");
  add(good + "x", "");
  add(good.substr(0, good.size() - 1), "");
  add("{\"format\": \"\xff\"}", "");
  add("{\"format\": 1e999}", "");
  add(std::string(100000, '['), "");
  add(good + std::string(17 << 20, ' '), "larger than");
  for (const Refused& one : cases) expect_refused(one);
}

// One thing wrong at a time, in an otherwise whole answer file.
struct Damage {
  const char* pointer;
  json value;
  const char* says;
};

void expect_damages_refused(const std::vector<Damage>& damages) {
  for (const Damage& damage : damages) {
    json document = test::answer_document();
    document[json::json_pointer(damage.pointer)] = damage.value;
    SCOPED_TRACE(damage.pointer);
    expect_refused({"p.json", document.dump(), damage.says});
  }
}

TEST(Malformed, AnswerFilePlan) {
  expect_damages_refused({
      {"/format", "pinchlab-answer", "did you mean `pinchlab-answers`"},
      {"/format", 1, "must be a string"},
      {"/version", 2, "version 1"},
      {"/version", "1", "whole number"},
      {"/version", 1.0, "whole number"},
      {"/participant", "", "empty"},
      {"/participant", 7, "must be a string"},
      {"/participant", nullptr, "must be a string"},
      {"/participant", "a\nb", "control character"},
      {"/participant", std::string(200, 'x'), "128 bytes"},
      {"/participant_number", -1, "whole number"},
      {"/seed", -1, "whole number"},
      {"/seed", 1.5, "whole number"},
      {"/seed", 9007199254740992, "whole number"},
      {"/seed", 18446744073709551615U, "whole number"},
      {"/plan", json::array(), "must be an object"},
      {"/plan/demonstrations", json::array(), "is empty"},
      {"/plan/demonstrations", "x", "must be an array"},
      {"/plan/demonstrations/0", 1, "names of demonstrations"},
      {"/plan/demonstrations/0", "", "names of demonstrations"},
      {"/plan/demonstrations/0", "07-driven-roller", "planned twice"},
      {"/plan/demonstrations/0", "01-rollover", "not in the plan"},
      {"/plan/answers_per_demonstration", 0, "whole number"},
      {"/plan/answers_per_demonstration", 101, "whole number"},
      {"/plan/answers_per_demonstration", 2, "but the plan has 2"},
      {"/plan/both_orders", 0, "true or false"},
      {"/plan/training_trials", -1, "whole number"},
      {"/plan/attention_checks", "1", "whole number"},
      {"/plan/demonstratons", 1, "did you mean `demonstrations`"},
  });
}

TEST(Malformed, AnswerFileSession) {
  expect_damages_refused({
      {"/started_utc", "yesterday", "UTC"},
      {"/started_utc", "2026-11-20 12:00:00", "UTC"},
      {"/started_utc", "2026-11-20T12:00:00+01:00", "UTC"},
      {"/started_utc", "2026-02-30T12:00:00Z", "UTC"},
      {"/started_utc", "2026-13-01T12:00:00Z", "UTC"},
      {"/started_utc", "2026-11-20T24:00:00Z", "UTC"},
      {"/started_utc", "2026-11-20T12:60:00Z", "UTC"},
      {"/started_utc", "2026-11-20T12:00:00.Z", "UTC"},
      {"/started_utc", "2026-11-20T12:00:00.1xZ", "UTC"},
      {"/started_utc", "2026-11-20T12:00:0", "UTC"},
      {"/started_utc", 0, "must be a string"},
      {"/saved_utc", "2026-11-20T11:59:59Z", "before started_utc"},
      {"/software_version", 1, "must be a string"},
      {"/software_version", std::string(300, 'x'), "longer than"},
      {"/language", 1, "must be a string"},
      {"/user_agent", std::string(5000, 'x'), "longer than"},
      {"/resumed_count", -1, "whole number"},
      {"/questionnaires", "44", "must be an object"},
      {"/questionnaires/between", nlohmann::json::object(), "unknown key"},
      {"/questionnaires/before/age", 44, "must be an object"},
      {"/questionnaires/before/age/answer", nullptr, "must be a number"},
      {"/questionnaires/before/age/unit", "years", "unknown key"},
      {"/recruited", "p-1", "must be an object"},
      {"/recruited/participant", "", "it is empty"},
      {"/recruited/session", 7, "must be a string"},
      {"/recruited/name", "x", "unknown key"},
      {"/withdrawal_code_sha256", "abc", "SHA-256"},
      {"/withdrawal_code_sha256", std::string(64, 'A'), "SHA-256"},
      {"/clips_sha256", "x", "must be an object"},
      {"/clips_sha256/01-roll-over", "x", "must be an object"},
      {"/clips_sha256/01-roll-over/pinch_left", std::string(64, 'g'), "SHA-256"},
      {"/free_text", json::array(), "must be an object"},
      {"/free_text/thoughts", 1, "must be a string"},
      {"/free_text/thoughts", std::string(100001, 'x'), "longer than"},
      {"/free_text/ bad", "x", "bad key"},
      {"/study/options_sha256", "x", "SHA-256"},
      {"/trial", 1, "did you mean `trials`"},
      {"/participants", 1, "did you mean `participant`"},
  });
}

TEST(Malformed, AnswerFileTrials) {
  expect_damages_refused({
      {"/trials", json::object(), "must be an array"},
      {"/trials", json::array(), "no answer of kind `main`"},
      {"/trials/1", 1, "must be an object"},
      {"/trials/1/position", 0, "whole number"},
      {"/trials/1/position", 1, "has position 1 too"},
      {"/trials/1/position", "2", "whole number"},
      {"/trials/1/position", 65536, "whole number"},
      {"/trials/1/kind", "man", "did you mean `main`"},
      {"/trials/1/kind", "training", "0 answers to demonstration `07-driven-roller`"},
      {"/trials/1/kind", nullptr, "must be a string"},
      {"/trials/1/demonstration", "01-roll-over", "2 answers to demonstration `01-roll-over`"},
      {"/trials/1/demonstration", "07-driven-rollr", "did you mean `07-driven-roller`"},
      {"/trials/1/demonstration", "", "empty"},
      {"/trials/1/left", "pinch", "on both sides"},
      {"/trials/1/right", "baseline", "on both sides"},
      {"/trials/1/left", "cable", "`cable` is unknown"},
      {"/trials/1/left", "check", "`check` is unknown"},
      {"/trials/1/choice", "pinch", "`pinch` is unknown"},
      {"/trials/1/choice", "tie", "must be left, right or tie as"},
      {"/trials/1/preference", 2, "must be left, right or tie as"},
      {"/trials/1/preference", -4, "from -3 to 3"},
      {"/trials/1/confidence", 10, "from 1 to 9"},
      {"/trials/1/reason", 5, "must be a string"},
      {"/trials/1/where_side", "left", "`where_x` is missing"},
      {"/trials/1/where_x", 0.5, "unknown key"},
      {"/trials/1/choice", "Left", "did you mean `left`"},
      {"/trials/1/choice", "", "unknown"},
      {"/trials/1/choice", 0, "must be a string"},
      {"/trials/1/expected", "left", "unknown key"},
      {"/trials/2/expected", "pinch", "unknown"},
  });
}

TEST(Malformed, AnswerFileCircumstances) {
  expect_damages_refused({
      {"/trials/1/reaction_time_s", -0.001, "number from 0"},
      {"/trials/1/reaction_time_s", 86400.5, "number from 0"},
      {"/trials/1/reaction_time_s", "1.5", "number from 0"},
      {"/trials/1/reaction_time_s", nullptr, "number from 0"},
      {"/trials/1/loops_watched", 1.5, "whole number"},
      {"/trials/1/focus_lost_count", -1, "whole number"},
      {"/trials/1/dropped_frames", "0", "whole number"},
      {"/trials/1/dropped_frames", 901, "901 is more than `frame_count` (900)"},
      {"/trials/1/loop_gap_max_s", -2, "loop_gap_max_s"},
      {"/trials/1/playback_errors", 0, "must be an array"},
      {"/trials/1/playback_errors", json::array({1}), "must hold strings"},
      {"/trials/1/clip", 1, "must be a string"},
      {"/trials/1/shown_utc", "now", "UTC"},
      {"/trials/1/input", "pen", "unknown"},
      {"/trials/1/window_width_px", -1, "whole number"},
      {"/trials/1/window_height_px", 100001, "whole number"},
      {"/trials/1/clip_width_px", 1.5, "whole number"},
      {"/trials/1/clip_height_px", "x", "whole number"},
      {"/trials/1/screen_width_px", "x", "whole number"},
      {"/trials/1/device_pixel_ratio", 0, "number from"},
      {"/trials/1/reaction_time", 1.0, "did you mean `reaction_time_s`"},
  });
}

TEST(Malformed, EveryRequiredKeyIsMissedByName) {
  for (const char* pointer :
       {"/format", "/version", "/participant", "/plan", "/started_utc", "/saved_utc",
        "/software_version", "/trials", "/plan/demonstrations", "/plan/answers_per_demonstration",
        "/trials/1/position", "/trials/1/kind", "/trials/1/demonstration", "/trials/1/left",
        "/trials/1/right", "/trials/1/choice", "/trials/1/reaction_time_s", "/trials/2/expected"}) {
    json document = test::answer_document();
    const json::json_pointer place(pointer);
    document[place.parent_pointer()].erase(place.back());
    expect_refused({"p.json", document.dump(), fmt::format("`{}` is missing", place.back())});
  }
}

// Cut off anywhere, a file is refused; with any byte changed it is read or refused, never more.
TEST(Malformed, DamagedBytesNeverDoMoreThanThrow) {
  const std::string good = test::answer_document().dump();
  const TemporaryFolder folder;
  for (size_t length = 0; length < good.size(); length += 7) {
    const fs::path file = folder.write("cut.json", good.substr(0, length));
    EXPECT_THROW(read_answers({file}, {}), InputError) << length;
  }
  const std::string csv = test::tidy_csv(test::clustered_rows());
  for (size_t i = 0; i < 600; ++i) {
    for (const auto& [name, text] : {std::pair("a.json", good), std::pair("a.csv", csv)}) {
      std::string damaged = text;
      damaged[(i * 7919) % damaged.size()] = static_cast<char>(i * 31 % 256);
      const fs::path file = folder.write(name, damaged);
      try {
        read_answers({file}, {});
      } catch (const InputError&) {
      }
    }
  }
}

std::string why_refused(const std::vector<fs::path>& inputs, const ReadOptions& options = {}) {
  try {
    read_answers(inputs, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "was accepted";
}

void expect_says(const std::string& text, const std::string& part) {
  EXPECT_NE(text.find(part), std::string::npos) << text;
}

const char* const small_log = "participant,demonstration,choice\na,1,pinch\n";

TEST(Malformed, InputsThatDoNotGoTogether) {
  const TemporaryFolder folder;
  const fs::path tidy = folder.write("tidy.csv", small_log);
  const fs::path counts = folder.write("counts.csv", "demonstration,pinch,cable\n1,2,3\n");
  const fs::path a = folder.write("json/a.json", test::answer_document("p-1").dump());
  const fs::path b = folder.write("json/b.json", test::answer_document("p-1").dump());
  json other_clips = test::answer_document("p-2");
  other_clips["clips_sha256"]["01-roll-over"]["pinch_left"] = std::string(64, '1');
  const fs::path c = folder.write("c.json", other_clips.dump());
  json other_design = test::answer_document("p-3");
  other_design["plan"]["answers_per_demonstration"] = 2;
  for (int again : {1, 3}) {
    json trial = other_design["trials"][static_cast<size_t>(again)];
    trial["position"] = 4 + again;
    other_design["trials"].push_back(trial);
  }
  const fs::path d = folder.write("d.json", other_design.dump());

  expect_says(why_refused({}), "name at least one");
  expect_says(why_refused({folder.path() / "none.csv"}), "no such file");
  expect_says(why_refused({folder.write("x.txt", "")}), "unknown kind of file");
  expect_says(why_refused({tidy, tidy}), "named twice");
  expect_says(why_refused({tidy, counts}), "two runs");
  expect_says(why_refused({counts, tidy}), "two runs");
  expect_says(why_refused({folder.path() / "json"}), "has a file already");
  expect_says(why_refused({a, b}), "has a file already");
  expect_says(why_refused({a, c}), "other SHA-256");
  expect_says(why_refused({a, d}), "two designs");
  fs::create_directories(folder.path() / "empty");
  expect_says(why_refused({folder.path() / "empty"}), "no answer files");
}

TEST(Malformed, FilesOfWhoIsLeftOut) {
  const TemporaryFolder folder;
  const fs::path tidy = folder.write("tidy.csv", small_log);
  ReadOptions options;
  options.exclude_file = folder.path() / "none.csv";
  expect_says(why_refused({tidy}, options), "cannot be opened");
  for (const auto& [content, says] : std::vector<std::pair<std::string, std::string>>{
           {"", "first line"},
           {"participant\na\n", "first line"},
           {"participant,why\na,b\n", "first line"},
           {"participant,reason\na\n", "1 fields"},
           {"participant,reason\na,\n", "no reason"},
           {"participant,reason\na,  \n", "no reason"},
           {"participant,reason\n,x\n", "bad participant"},
           {"participant,reason\na,x\na,y\n", "listed twice"},
           {"participant,reason\naa,x\n", "in no input"},
           {"participant,reason\na,x\n", "all participants are left out, by --exclude"}}) {
    options.exclude_file = folder.write("exclude.csv", content);
    expect_says(why_refused({tidy}, options), says);
  }
}

TEST(Malformed, FilesOfGroups) {
  const TemporaryFolder folder;
  const fs::path tidy = folder.write("tidy.csv", small_log);
  ReadOptions options;
  for (const auto& [content, says] : std::vector<std::pair<std::string, std::string>>{
           {"", "first line"},
           {"demonstration,groups\n1,x\n", "first line"},
           {"demonstration,group\n1\n", "1 fields"},
           {"demonstration,group\n1,\n", "bad group"},
           {"demonstration,group\n2,x\n", "no answers for demonstration `2`"},
           {"demonstration,group\n1,all\n", "always exists"},
           {"demonstration,group\n1,x\n1,x\n", "twice"}}) {
    options.groups_file = folder.write("groups.csv", content);
    expect_says(why_refused({tidy}, options), says);
  }
}

}  // namespace
}  // namespace pinchlab::analysis
