// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/scenes/joint_reader.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "base/at.h"
#include "demos/scenes/json_values.h"
#include "demos/scenes/look_reader.h"
#include "sim/joints.h"
#include "sim/scene_error.h"

namespace pinchlab {
namespace {

using nlohmann::json;

class JointReader {
 public:
  JointReader(const json& from, std::string place, const BodyIndex& body_index,
              std::span<const Vec2> origins, std::vector<SceneProblem>& problems)
      : from_(from),
        place_(std::move(place)),
        body_index_(body_index),
        origins_(origins),
        problems_(problems) {}

  void read(Scene& scene) {
    const std::string kind = from_["kind"].get<std::string>();
    const std::string name = from_["name"].get<std::string>();
    if (kind == "hinge") return read_hinge(name, scene);
    refuse({"body", "other", "at_m"}, "a joint that is no hinge");
    const bool spring = kind == "spring";
    need(spring ? std::initializer_list<const char*>{"start", "end", "stiffness_n_m"}
                : std::initializer_list<const char*>{"start", "end"});
    if (!spring) {
      refuse({"stiffness_n_m", "natural_length_m", "damping_n_s_m"}, "a joint that is no spring");
    }
    if (wrong_) return;
    const Attachment start = read_end("start"), end = read_end("end");
    if (wrong_) return;
    refuse_between_fixed(scene, start.body, end.body);
    if (wrong_) return;
    if (!spring) return add_bar(scene, name, start, end);
    double natural = 0.0, damping = 0.0;
    take(from_, "natural_length_m", natural);
    take(from_, "damping_n_s_m", damping);
    add_spring(scene, name, start, end, from_["stiffness_n_m"].get<double>(), natural, damping);
  }

 private:
  void problem(const std::string& place, std::string message) {
    problems_.push_back({place, std::move(message)});
    wrong_ = true;
  }
  void need(std::initializer_list<const char*> keys) {
    for (const char* key : keys) {
      if (!from_.contains(key)) problem(place_, fmt::format("{} is missing", key));
    }
  }
  void refuse(std::initializer_list<const char*> keys, const std::string& what) {
    refuse_keys(from_, place_, keys, what, problems_);
  }

  /// A fixed body and the world, or another: nothing moves, with the joint or without.
  void refuse_between_fixed(const Scene& scene, int body, int other) {
    if (body < 0) std::swap(body, other);
    if (body < 0) return;  // both on the world, which is refused with every joint
    const auto is_fixed = [&scene](int b) {
      if (b < 0) return true;
      const int carrier = at(scene.bodies, b).carrier;  // of a shape
      return at(scene.bodies, carrier >= 0 ? carrier : b).kind == BodyKind::fixed;
    };
    if (!is_fixed(body) || !is_fixed(other)) return;
    problem(place_,
            fmt::format("holds the fixed body \"{}\" to {}, where it does nothing; leave it "
                        "out, or let one of the two move",
                        at(scene.bodies, body).name,
                        other < 0 ? std::string("the world")
                                  : fmt::format("\"{}\", which is fixed too",
                                                at(scene.bodies, other).name)));
  }

  int read_body(const json& from, const char* key, const std::string& place) {
    const std::size_t before = problems_.size();
    const int found = body_index_(from[key], place + "/" + key);
    wrong_ = wrong_ || problems_.size() > before;
    return found;
  }

  Attachment read_end(const char* key) {
    const json& end = from_[key];
    const std::string place = place_ + "/" + key;
    Attachment attachment;
    const std::size_t before = problems_.size();
    const EndBy by = end_by(end, place, {"point_m"}, problems_);
    wrong_ = wrong_ || problems_.size() > before;
    if (by == EndBy::neither) return attachment;
    if (by == EndBy::world_m) {
      attachment.point = vector_of(end["world_m"]);
      return attachment;
    }
    attachment.body = read_body(end, "body", place);
    take(end, "point_m", attachment.point);
    if (index(attachment.body) < origins_.size())
      attachment.point += origins_[index(attachment.body)];
    return attachment;
  }

  void read_hinge(const std::string& name, Scene& scene) {
    refuse({"start", "end", "stiffness_n_m", "natural_length_m", "damping_n_s_m"}, "a hinge");
    need({"body", "at_m"});
    if (wrong_) return;
    const int first = read_body(from_, "body", place_);
    const int other = from_.contains("other") ? read_body(from_, "other", place_) : -1;
    if (!wrong_) refuse_between_fixed(scene, first, other);
    if (!wrong_) add_hinge(scene, name, first, other, vector_of(from_["at_m"]));
  }

  const json& from_;
  std::string place_;
  const BodyIndex& body_index_;
  std::span<const Vec2> origins_;
  std::vector<SceneProblem>& problems_;
  bool wrong_ = false;
};

}  // namespace

void read_joints(const json& file, Scene& scene, SceneLook& look, const BodyIndex& body_index,
                 std::span<const Vec2> origins, std::vector<SceneProblem>& problems) {
  const json joints = file.value("joints", json::array());
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const std::string place = fmt::format("/joints/{}", i);
    try {
      JointReader(joints[i], place, body_index, origins, problems).read(scene);
    } catch (const SceneError& error) {
      problems.push_back({place, error.message});
    }
    look.cables.resize(scene.cables.size(), read_cable_look(joints[i]));
  }
  for (std::size_t b = 0; b < file["bodies"].size(); ++b) {
    if (!file["bodies"][b].contains("travel_m")) continue;
    const Vec2 travel = vector_of(file["bodies"][b]["travel_m"]);
    add_stops(scene, static_cast<int>(b), travel[0], travel[1]);
    look.cables.resize(scene.cables.size());
  }
}

}  // namespace pinchlab
