// SPDX-License-Identifier: GPL-3.0-or-later
// The reader's tables, the JSON Schema and the documentation say the same.

#include "demos/scenes/scene_format.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "demos/scenes/scene_json.h"

namespace pinchlab {
namespace {

using nlohmann::json;

std::string source_text(const std::string& name) {
  std::ifstream in(std::string(PINCHLAB_SOURCE_DIR) + "/" + name, std::ios::binary);
  EXPECT_TRUE(in) << name;
  return {std::istreambuf_iterator<char>(in), {}};
}

// All object formats, each once.
void collect(const ObjectFormat& format, std::vector<const ObjectFormat*>& formats) {
  if (std::ranges::find(formats, &format) != formats.end()) {
    return;
  }
  formats.push_back(&format);
  for (const KeyFormat& key : format.keys) {
    if (key.child != nullptr) {
      collect(*key.child, formats);
    }
  }
}

std::vector<const ObjectFormat*> all_formats() {
  std::vector<const ObjectFormat*> formats;
  collect(scene_format(), formats);
  return formats;
}

// What the schema must say of a key, its description aside.
json schema_of(const KeyFormat& key) {
  const std::string child = key.child == nullptr ? "" : "#/$defs/" + key.child->name;
  switch (key.type) {
    case KeyType::number:
      return {{"type", "number"}, {"minimum", key.low}, {"maximum", key.high}};
    case KeyType::integer:
      return {{"type", "integer"}, {"minimum", key.low}, {"maximum", key.high}};
    case KeyType::vector:
      return {{"type", "array"},
              {"items", {{"type", "number"}, {"minimum", key.low}, {"maximum", key.high}}},
              {"minItems", 2},
              {"maxItems", 2}};
    case KeyType::points: {
      KeyFormat point;
      point.type = KeyType::vector;
      point.low = -most_coordinate;
      point.high = most_coordinate;
      return {{"type", "array"},
              {"items", schema_of(point)},
              {"minItems", key.low},
              {"maxItems", key.high}};
    }
    case KeyType::text:
      return {{"type", "string"},
              {"minLength", key.low},
              {"maxLength", key.high},
              {"pattern", R"(^[^\u0000-\u001f\u007f-\u009f]*$)"}};
    case KeyType::name:
      return {{"type", "string"},
              {"minLength", key.low},
              {"maxLength", key.high},
              {"pattern", R"(^(?! )[^,"\u0000-\u001f\u007f-\u009f]*(?<! )$)"}};
    case KeyType::boolean:
      return {{"type", "boolean"}};
    case KeyType::choice:
      return {{"enum", key.choices}};
    case KeyType::integer_or_word:
      return {{"oneOf",
               {{{"type", "integer"}, {"minimum", key.low}, {"maximum", key.high}},
                {{"enum", key.choices}}}}};
    case KeyType::friction:
      return {{"oneOf",
               {{{"type", "number"}, {"minimum", key.low}, {"maximum", key.high}},
                {{"const", "no_slip"}}}}};
    case KeyType::colour:
      return {{"type", "string"}, {"pattern", "^#[0-9A-Fa-f]{6}([0-9A-Fa-f]{2})?$"}};
    case KeyType::object:
      return {{"$ref", child}};
    case KeyType::object_or_word:
      return {{"oneOf", {{{"$ref", child}}, {{"enum", key.choices}}}}};
    case KeyType::list:
      return {{"type", "array"},
              {"items", {{"$ref", child}}},
              {"minItems", key.low},
              {"maxItems", key.high}};
  }
  return {};
}

TEST(SceneFormat, SchemaAgreesWithTheReader) {
  const json schema = json::parse(source_text("demos/scene.schema.json"));
  const auto formats = all_formats();
  EXPECT_EQ(schema["$defs"].size() + 1, formats.size());
  for (const ObjectFormat* format : formats) {
    const json& object = format == &scene_format() ? schema : schema["$defs"].at(format->name);
    EXPECT_EQ(object["type"], "object") << format->name;
    EXPECT_EQ(object["additionalProperties"], false) << format->name;
    EXPECT_EQ(object["properties"].size(), format->keys.size()) << format->name;
    std::set<std::string> required;
    for (const KeyFormat& key : format->keys) {
      json property = object["properties"].at(key.name);
      EXPECT_FALSE(property["description"].get<std::string>().empty())
          << format->name << " " << key.name;
      property.erase("description");
      EXPECT_EQ(property, schema_of(key)) << format->name << " " << key.name;
      if (key.required) {
        required.insert(key.name);
      }
    }
    EXPECT_EQ(object["required"].get<std::set<std::string>>(), required) << format->name;
  }
}

std::string documented_range(const KeyFormat& key) {
  switch (key.type) {
    case KeyType::number:
    case KeyType::integer:
    case KeyType::friction:
      return fmt::format("{:g} to {:g}", key.low, key.high);
    case KeyType::integer_or_word:
      return fmt::format("{:g} to {:g}, `{}`", key.low, key.high, fmt::join(key.choices, "`, `"));
    case KeyType::vector:
      return fmt::format("each {:g} to {:g}", key.low, key.high);
    case KeyType::text:
    case KeyType::name:
      return fmt::format("{} to {} characters", key.low, key.high);
    case KeyType::points:
    case KeyType::list:
      return fmt::format("{} to {} entries", key.low, key.high);
    case KeyType::choice:
    case KeyType::object_or_word:
      return fmt::format("`{}`", fmt::join(key.choices, "`, `"));
    default:
      return "";
  }
}

TEST(SceneFormat, DocumentationAgreesWithTheReader) {
  const std::string page = source_text("demos/README.md");
  std::vector<const ObjectFormat*> formats = all_formats();
  formats.push_back(&theme_format());
  for (const ObjectFormat* format : formats) {
    const std::size_t begin = page.find("### " + format->name + "\n");
    ASSERT_NE(begin, std::string::npos) << format->name;
    std::istringstream section(page.substr(begin, page.find("\n##", begin + 4) - begin));
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(section, line);) {
      if (line.starts_with("| `")) {
        rows.emplace_back();
        std::istringstream cells(line.substr(2));
        for (std::string cell; std::getline(cells, cell, '|');) {
          cell.erase(0, cell.find_first_not_of(' '));
          cell.erase(cell.find_last_not_of(' ') + 1);
          rows.back().push_back(cell);
        }
      }
    }
    ASSERT_EQ(rows.size(), format->keys.size()) << format->name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const KeyFormat& key = format->keys[i];
      ASSERT_EQ(rows[i].size(), 6U) << format->name << " " << key.name;
      EXPECT_EQ(rows[i][0], "`" + key.name + "`");
      EXPECT_EQ(rows[i][3], documented_range(key)) << format->name << " " << key.name;
      EXPECT_EQ(rows[i][4] == "**required**", key.required) << format->name << " " << key.name;
      EXPECT_FALSE(rows[i][5].empty()) << format->name << " " << key.name;
    }
  }
}

TEST(SceneFormat, TheDocumentationsExampleRuns) {
  const std::string page = source_text("demos/README.md");
  const std::size_t begin = page.find("```json\n") + 8;
  const SceneFile file =
      parse_scene(page.substr(begin, page.find("```\n", begin) - begin), "01-weights.json");
  EXPECT_EQ(file.scene.bodies.size(), 3U);
  for (const Method method : {Method::pinch, Method::pinch_no_contact, Method::cable}) {
    EXPECT_EQ(start_world(file.scene, file.path, method).cables.size(), 1U);
  }
}

}  // namespace
}  // namespace pinchlab
