// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/look_reader.h"

#include <map>
#include <nlohmann/json.hpp>

#include "demos/scenes/format_check.h"

namespace pinchlab {

using nlohmann::json;

BodyLook read_body_look(const json& body) {
  BodyLook look;
  if (!body.contains("look")) return look;
  const json& from = body["look"];
  if (from.contains("colour")) look.colour = colour_from(from["colour"].get<std::string>());
  if (from.contains("label")) look.label = from["label"].get<std::string>();
  const std::map<std::string, LabelSide> sides = {{"automatic", LabelSide::automatic},
                                                  {"below", LabelSide::below},
                                                  {"above", LabelSide::above},
                                                  {"left", LabelSide::left},
                                                  {"right", LabelSide::right}};
  look.side = sides.at(from.value("label_side", "automatic"));
  look.marks = from.value("marks", true);
  return look;
}

CableLook read_cable_look(const json& cable) {
  CableLook look;
  if (!cable.contains("look")) return look;
  const json& from = cable["look"];
  if (from.contains("colour")) look.colour = colour_from(from["colour"].get<std::string>());
  look.marks = from.value("marks", true);
  return look;
}

}  // namespace pinchlab
