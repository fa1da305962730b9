// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/experiments/peers/mujoco_run.h"

#include <cstring>
#include <stdexcept>

#include "analysis/experiments/experiment.h"

namespace pinchlab::experiments {

MujocoModel load_mujoco(const std::string& xml) {
  // mjVFS holds room for 2000 file names: far too much for the stack.
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* name = "scene.xml";
  if (mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(xml.size()) + 1) != 0) {
    throw std::runtime_error("MuJoCo: no room for the model's text");
  }
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], xml.c_str(), xml.size() + 1);
  mju_user_warning = [](const char*) {};  // not into a log file: data->warning tells
  char error[1000] = "";
  MujocoModel model(mj_loadXML(name, files.get(), error, sizeof error), mj_deleteModel);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error);
  return model;
}

Recording record_mujoco(const Problem& problem, const mjModel& model, mjData& data,
                        const MujocoSettings& settings,
                        const std::function<std::vector<Place>()>& places) {
  if (settings.leapfrog) {  // back by half a kick
    mj_forward(&model, &data);
    for (int i = 0; i < model.nv; ++i) {
      data.qvel[i] -= 0.5 * model.opt.timestep * data.qacc[i];
    }
  }
  Recording recording;
  recording.motion.push_back(places());
  for (int frame = 0; frame < problem.frames; ++frame) {
    const double start = cpu_seconds();
    for (int i = 0; i < settings.steps_per_frame; ++i) mj_step(&model, &data);
    recording.cpu_s += cpu_seconds() - start;
    recording.motion.push_back(places());
    for (const Place& place : recording.motion.back()) {
      if (!place.centre.allFinite()) recording.finite = false;
    }
    for (const mjWarningStat& warning : data.warning) {
      if (warning.number > 0) recording.finite = false;  // MuJoCo resets what has blown up
    }
    if (!recording.finite) return recording;
  }
  return recording;
}

}  // namespace pinchlab::experiments
