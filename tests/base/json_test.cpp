// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "base/input_error.h"
#include "base/json_object.h"
#include "base/strict_json.h"
#include "tests/base/message_of.h"
#include "tests/base/temporary_folder.h"

namespace pinchlab {
namespace {

using nlohmann::json;
using pinchlab::test::message_of;

// "place: message" of the first mistake.
std::string mistake(std::string_view text, std::size_t max_depth = 16) {
  try {
    parse_strict_json(text, max_depth);
  } catch (const JsonError& error) {
    return error.place + ": " + error.what();
  }
  return "";
}

TEST(StrictJson, ReadsWhatIsRight) {
  EXPECT_EQ(parse_strict_json(R"( {"a": [1, -2.5e3, true, null, "x"], "b": {}} )"),
            json({{"a", {1, -2500.0, true, nullptr, "x"}}, {"b", json::object()}}));
  EXPECT_EQ(mistake("[[[]]]", 3), "");
}

TEST(StrictJson, RefusesTheRest) {
  EXPECT_EQ(mistake(R"({"a": {"b": 1, "b": 2}})"), "/a/b: key given twice; keep one of them");
  EXPECT_EQ(mistake(std::string("{}\n\0, and more", 14)),
            "line 2, column 1: not JSON: a byte of zero; save the file as UTF-8");
  EXPECT_EQ(mistake(R"([{"a/b~c": 0, "a/b~c": 0}])"),
            "/0/a~1b~0c: key given twice; keep one of them");
  EXPECT_EQ(mistake("[[[]]]", 2), "/0: nested deeper than 2 levels");
  EXPECT_TRUE(mistake("{\n \"å\": }").starts_with("line 2, column 7: not JSON: "))
      << mistake("{\n \"å\": }");
  for (const char* bad : {"", "{", "[1,]", "NaN", "[1e999]", "// x\n1", "1 2", "\"\xff\"", "'a'"}) {
    EXPECT_NE(mistake(bad), "") << bad;
  }
  EXPECT_NE(mistake(std::string(1'000'000, '[')), "") << "no stack is deep enough for everything";
}

TEST(StrictJson, FilesAreNamed) {
  const pinchlab::test::TemporaryFolder folder;
  const std::string path = folder.write("a.json", "{\"a\": 1, \"a\": 1}").string();
  EXPECT_EQ(message_of<InputError>([&] { read_json_file(path, 100); }),
            path + ": /a: key given twice; keep one of them");
  EXPECT_EQ(message_of<InputError>([&] { read_json_file(path, 3); }),
            path + ": is larger than 3 bytes");
}

TEST(JsonObject, TellsThePlace) {
  const json value = {{"number", 3}, {"text", "x"}, {"a/b", true}, {"list", {1, 2}}};
  JsonObject object(value, "f.json", "/top");
  EXPECT_EQ(object.whole("number", 0, 3), 3);
  EXPECT_EQ(message_of<InputError>([&] { object.whole("number", 0, 2); }),
            "f.json: /top/number: must be a whole number from 0 to 2");
  EXPECT_EQ(message_of<InputError>([&] { object.text("number", 10); }),
            "f.json: /top/number: must be a string, not number");
  EXPECT_EQ(message_of<InputError>([&] { object.whole("a/b", 0, 2); }),
            "f.json: /top/a~1b: must be a whole number from 0 to 2");
  EXPECT_EQ(message_of<InputError>([&] { object.need("txt"); }),
            "f.json: /top: key `txt` is missing (did you mean `text`?)");
  EXPECT_TRUE(object.has("text"));
  EXPECT_EQ(message_of<InputError>([&] { object.need("txt"); }),
            "f.json: /top: key `txt` is missing")
      << "what is known by now is meant as it is";
  EXPECT_EQ(message_of<InputError>([&] { object.array("list", 1); }),
            "f.json: /top/list: more than 1 entries");
  EXPECT_THROW(JsonObject(value["list"], "f.json", "/list"), InputError);
}

TEST(JsonObject, KeysThatNobodyKnows) {
  const json value = {{"text", "x"}, {"mumber", 3}};
  JsonObject object(value, "f.json", "");
  EXPECT_EQ(object.text("text", 10), "x");
  EXPECT_FALSE(object.has("number"));
  EXPECT_EQ(message_of<InputError>([&] { object.finish("; see the manual"); }),
            "f.json: /mumber: unknown key (did you mean `number`?); see the manual");
  EXPECT_NO_THROW(object.expect_only({"mumber", "text"}, ""));
  EXPECT_EQ(message_of<InputError>([&] { object.expect_only({"text"}, ""); }),
            "f.json: /mumber: unknown key");
}

TEST(JsonObject, Moments) {
  const json value = {{"good", "2024-02-29T23:59:60.125Z"}, {"bad", "2023-02-29T00:00:00Z"}};
  JsonObject object(value, "f.json", "");
  EXPECT_EQ(object.utc("good"), "2024-02-29T23:59:60.125Z");
  EXPECT_THROW(object.utc("bad"), InputError);
}

}  // namespace
}  // namespace pinchlab
