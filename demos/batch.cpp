// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/batch.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <map>
#include <set>
#include <stdexcept>
#include <thread>

#include "base/folder_lock.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/progress.h"
#include "base/sha256.h"
#include "demos/legibility.h"
#include "demos/manifest.h"
#include "demos/report_page.h"
#include "demos/scenes/find_scenes.h"
#include "demos/worker_pool.h"
#include "render/canvas.h"
#include "render/equal_sizes.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

// What an interrupted run left. Only safe under the lock.
void remove_partial_files(const fs::path& folder) {
  constexpr std::array ours = {".mp4", ".webm", ".mkv",  ".apng",     ".webp",   ".gif",
                               ".png", ".json", ".html", ".unpadded", ".partial"};
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (std::ranges::any_of(ours, [&](const char* end) { return is_partial_of(name, end); })) {
      fs::remove(entry.path());
    }
  }
}

std::vector<SceneFile> read_scenes(const std::vector<fs::path>& paths, const Timing& timing) {
  std::vector<SceneFile> scenes;
  std::set<std::string> names;
  for (const fs::path& path : find_scenes(paths)) {
    scenes.push_back(read_scene_file(path, timing));
    if (!names.insert(scenes.back().scene.name).second) {
      throw std::invalid_argument(fmt::format("{}: a scene called {} is in the list already",
                                              path.string(), scenes.back().scene.name));
    }
  }
  return scenes;
}

std::int64_t pictures_a_tick(const ClipPlan& plan) {
  return plan.product == Product::poster ? 1 : static_cast<std::int64_t>(plan.methods.size());
}

std::int64_t panels_to_draw(const ClipPlan& plan) {
  return plan.product == Product::poster
             ? 1
             : pictures_a_tick(plan) * static_cast<std::int64_t>(plan.steps.size());
}

double cpu_seconds(int who) {
  struct rusage usage = {};
  ::getrusage(who, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

// Drops what is up to date, puts the longest first so that no core is left idle at the end. Files
// of equal sizes are made together.
std::vector<ClipPlan> plans_to_make(const std::vector<ClipPlan>& plans, const Manifest& manifest,
                                    const fs::path& out) {
  std::set<std::string> stale;
  for (const ClipPlan& plan : plans) {
    if (is_up_to_date(manifest, out, plan_entry(plan))) continue;
    stale.insert(plan.file);
    stale.insert(plan.equal_sizes_with.begin(), plan.equal_sizes_with.end());
  }
  std::vector<ClipPlan> to_make;
  std::ranges::copy_if(plans, std::back_inserter(to_make),
                       [&](const ClipPlan& plan) { return stale.contains(plan.file); });
  std::ranges::stable_sort(to_make, std::ranges::greater(), panels_to_draw);
  return to_make;
}

// An error that names the file by what it is called while it is made.
std::string with_own_name(const ClipPlan& plan, std::string error) {
  const std::string made = made_as(plan);
  if (const std::size_t place = error.find(made); place != std::string::npos) {
    error.replace(place, made.size(), plan.file);
  }
  return error;
}

struct Outcome {
  int signal = 0, made = 0, failed = 0;
};

/// What workers have made, and the manifest with it.
class Made {
 public:
  Made(const std::vector<ClipPlan>& plans, const fs::path& folder, Manifest& manifest)
      : plans_(plans), folder_(folder), manifest_(manifest) {
    for (std::size_t i = 0; i < plans.size(); ++i) index_[plans[i].file] = i;
  }

  /// Takes a file's entry. It goes to the manifest at once, or when all that are to be as large as
  /// it are there and have been padded. Returns how many files that has finished.
  int add(std::size_t plan, ordered_json entry) {
    entries_[plan] = std::move(entry);
    const std::vector<std::size_t> group = group_of(plan);
    if (!std::ranges::all_of(group, [&](std::size_t i) { return entries_.contains(i); })) return 0;
    try {
      if (group.size() > 1) pad(group);
    } catch (const std::runtime_error& error) {
      for (const std::size_t i : group) errors_[i] = error.what();
      return 0;
    }
    for (const std::size_t i : group) {
      put(manifest_, std::move(entries_[i]));
      entries_.erase(i);
    }
    write_manifest(folder_, manifest_);
    return static_cast<int>(group.size());
  }

  /// Gives up what could not be finished: removes it, and returns each file and why.
  std::map<std::string, std::string> give_up() {
    std::map<std::string, std::string> reasons;
    for (const auto& [i, entry] : entries_) {
      fs::remove(folder_ / made_as(plans_[i]));
      reasons[plans_[i].file] =
          errors_.contains(i) ? errors_[i] : "a clip that it goes with has failed";
    }
    return reasons;
  }

 private:
  std::vector<std::size_t> group_of(std::size_t plan) const {
    std::vector<std::size_t> group = {plan};
    for (const std::string& file : plans_[plan].equal_sizes_with) group.push_back(index_.at(file));
    std::ranges::sort(group);
    return group;
  }

  void pad(const std::vector<std::size_t>& group) {
    std::vector<std::string> from, to;
    for (const std::size_t i : group) {
      from.push_back((folder_ / made_as(plans_[i])).string());
      to.push_back((folder_ / plans_[i].file).string());
    }
    equal_sizes(plans_[group.front()].video.codec, from, to);
    for (std::size_t k = 0; k < group.size(); ++k) {
      fs::remove(from[k]);
      entries_[group[k]]["sha256"] = sha256_of_file(to[k]);
    }
  }

  const std::vector<ClipPlan>& plans_;
  const fs::path& folder_;
  Manifest& manifest_;
  std::map<std::string, std::size_t> index_;     // of a plan, by its file
  std::map<std::size_t, ordered_json> entries_;  // by plan, until in the manifest
  std::map<std::size_t, std::string> errors_;    // by plan
};

Outcome make_all(const std::vector<ClipPlan>& plans, const BatchOptions& options, int jobs,
                 Manifest& manifest) {
  std::vector<Work> work;
  std::int64_t total = 0;
  for (const ClipPlan& plan : plans) {
    work.emplace_back([&plan, &options](const std::function<void()>& tick) {
      return make_clip(plan, options.out, tick, options.time_limit).dump();
    });
    total += panels_to_draw(plan);
  }
  Outcome outcome;
  Made files(plans, options.out, manifest);
  Progress progress("rendering", "pictures", total);
  const auto fail = [&](const std::string& file, const std::string& error) {
    progress.clear();
    fmt::print(stderr, "{}: not made: {}\n", file, error);
    ++outcome.failed;
  };
  const WorkerPoolEvents events = {
      .tick = [&](std::size_t i) { progress.add(pictures_a_tick(plans[i])); },
      .done =
          [&](std::size_t i, const std::string& entry) {
            outcome.made += files.add(i, ordered_json::parse(entry));
          },
      .failed =
          [&](std::size_t i, const std::string& error) {
            fail(plans[i].file, with_own_name(plans[i], error));
          },
      .idle = [&] { progress.add(0); }};
  outcome.signal = run_in_processes(work, jobs, events);
  if (outcome.signal == 0) {
    for (const auto& [file, reason] : files.give_up()) fail(file, reason);
  }
  return outcome;
}

void check_size(const BatchOptions& options) {
  const int width = options.width * (options.side_by_side || options.checks ? 2 : 1);  // px
  if (std::min(options.width, options.height) < smallest_frame ||
      std::max(width, options.height) > largest_frame) {
    throw std::invalid_argument(
        fmt::format("frames of {} x {} pixels cannot be drawn: each must be {} to {}", width,
                    options.height, smallest_frame, largest_frame));
  }
  if (needs_even_sides(options.codec) && (options.width % 2 != 0 || options.height % 2 != 0)) {
    throw std::invalid_argument(
        fmt::format("{} needs an even size, not {}x{}; change --size, or use --codec ffv1",
                    to_string(options.codec), options.width, options.height));
  }
}

// Of a clip that was made just now, or kept.
void tell_notes(const fs::path& folder, const std::string& file, const Manifest& manifest) {
  const std::string path = (folder / file).string();
  for (const ordered_json& entry : manifest.entries) {
    if (entry["file"] != file) continue;
    if (entry.contains("hard_to_see")) tell_hard_to_see(path, entry["hard_to_see"]);
    if (entry.contains("broken_promises")) tell_broken_promises(path, entry["broken_promises"]);
  }
}

}  // namespace

Configuration method_of(const Scene& scene, const std::string& name) {
  if (name == "baseline") return scene.baseline;
  if (const auto known = configuration_from_string(name)) return *known;
  throw std::invalid_argument("no method is called " + name);
}

MethodPair pair_from(const std::string& text) {
  const std::size_t comma = text.find(',');
  MethodPair pair = {text.substr(0, comma),
                     comma == std::string::npos ? "" : text.substr(comma + 1)};
  for (const std::string& name : {pair.first, pair.second}) {
    if (name != "baseline" && !configuration_from_string(name)) {
      throw std::invalid_argument(fmt::format(
          "a pair is two of pinch, pinch_no_contact, cable, baseline and thesis with a comma "
          "between, as pinch,thesis, not {}",
          text));
    }
  }
  if (pair.first == pair.second) {
    throw std::invalid_argument(fmt::format("{}: a pair needs two methods", text));
  }
  return pair;
}

namespace {

ClipPlan plan_one(const SceneFile& source, const Scene& scene, const BatchOptions& options,
                  const std::string& role, std::vector<Configuration> methods,
                  const std::string& ending) {
  ClipPlan clip;
  clip.file = scene.name + "." + role + ending;
  clip.role = role;
  clip.source = &source;
  clip.scene = scene;
  clip.product = role == "poster"   ? Product::poster
                 : role == "report" ? Product::report
                                    : Product::clip;
  clip.methods = std::move(methods);
  const int panels = static_cast<int>(clip.methods.size());
  clip.theme = options.theme;
  clip.burn_time = options.burn_time;
  if (clip.product == Product::clip) clip.playback = options.playback;
  clip.steps = steps_shown(scene, clip.playback);
  clip.video.codec = options.codec;
  clip.video.width = options.width * (clip.product == Product::clip ? panels : 1);
  clip.video.height = options.height;
  clip.video.frames_per_second = scene.frames_per_second;
  if (clip.product == Product::clip) check_video(clip.file, clip.video);
  return clip;
}

/// Adds clips whose files must be of one size, where their kind can.
void add_equal(std::vector<ClipPlan> group, std::vector<ClipPlan>& plans) {
  for (ClipPlan& one : group) {
    for (const ClipPlan& other : group) {
      if (&one != &other && can_have_equal_sizes(one.video.codec)) {
        one.equal_sizes_with.push_back(other.file);
      }
    }
  }
  std::ranges::move(group, std::back_inserter(plans));
}

}  // namespace

std::vector<ClipPlan> plan_clips(const SceneFile& source, const BatchOptions& options) {
  check_size(options);
  if (options.theme.theme.background.alpha < 255) {
    throw std::invalid_argument(
        fmt::format("theme {}: a clip cannot be transparent; give its background no alpha (stills "
                    "may have one)",
                    options.theme.name));
  }
  const Scene scene = with_timing(source.scene, options.timing);
  const auto plan = [&](const std::string& role, std::vector<Configuration> methods,
                        const std::string& ending) {
    return plan_one(source, scene, options, role, std::move(methods), ending);
  };
  const std::string ending = file_ending(options.codec);
  if (options.method) {
    return {plan(*options.method, {method_of(scene, *options.method)}, ending)};
  }
  std::vector<ClipPlan> plans;
  const bool usual = options.pairs.empty();
  const std::vector<MethodPair> pairs =
      usual ? std::vector<MethodPair>{{"pinch", "baseline"}} : options.pairs;
  if (options.singles) {
    std::vector<ClipPlan> singles;
    for (const auto& [first, second] : pairs) {
      for (const std::string& name : {first, second}) {
        if (std::ranges::find(singles, name, &ClipPlan::role) != singles.end()) continue;
        singles.push_back(plan(name, {method_of(scene, name)}, ending));
      }
    }
    add_equal(std::move(singles), plans);
  }
  std::set<MethodPair> known;
  for (const auto& [first, second] : pairs) {
    if (!known.insert(std::minmax(first, second)).second) {
      throw std::invalid_argument(fmt::format("the pair {},{} is asked for twice", first, second));
    }
    const Configuration one = method_of(scene, first), other = method_of(scene, second);
    if (!usual && one == other) {
      throw std::invalid_argument(
          fmt::format("{},{}: the baseline of {} is {}, and a pair needs two methods", first,
                      second, scene.name, to_string(scene.baseline)));
    }
    const std::string both = fmt::format("{}-{}", first, second);
    const std::string swapped = fmt::format("{}-{}", second, first);
    if (options.singles) {
      plans.push_back(plan("poster", {one, other}, ".png"));
      if (!usual) plans.back().file = fmt::format("{}.{}.poster.png", scene.name, both);
    }
    if (options.side_by_side) {
      add_equal({plan(usual ? "left-pinch" : both, {one, other}, ending),
                 plan(usual ? "left-baseline" : swapped, {other, one}, ending)},
                plans);
    }
    if (options.report) plans.push_back(plan("report", {one, other}, ".png"));
  }
  if (options.checks) {
    const Configuration pinch = Method::pinch;
    std::vector<ClipPlan> checks = {plan("check-left", {pinch, pinch}, ending),
                                    plan("check-right", {pinch, pinch}, ending)};
    checks[0].upside_down = 1;
    checks[1].upside_down = 0;
    add_equal(std::move(checks), plans);
  }
  return plans;
}

int render_batch(const BatchOptions& options) {
  // Everything that can be wrong with the input is found before the first file is touched.
  const std::vector<SceneFile> scenes = read_scenes(options.scenes, options.timing);
  std::vector<ClipPlan> plans;
  for (const SceneFile& scene : scenes) {
    std::ranges::move(plan_clips(scene, options), std::back_inserter(plans));
  }
  std::vector<Configuration> methods;
  for (const ClipPlan& plan : plans) {
    methods.insert(methods.end(), plan.methods.begin(), plan.methods.end());
  }
  check_error_is_heeded(options.timing, methods);
  for (const ClipPlan& plan : plans) {
    for (const Configuration& method : plan.methods) {
      start_world(plan.scene, plan.source->path, method);
    }
  }

  make_folders(options.out);
  const FolderLock lock(
      options.out,
      fmt::format("{}: another process is rendering into it; wait for it or use another --out",
                  options.out.string()));
  remove_partial_files(options.out);
  Manifest manifest = read_manifest(options.out);
  check_can_be_written(options.out / "manifest.json");
  const auto is_gone = [&](const ordered_json& entry) {
    return !fs::exists(options.out / entry["file"].get<std::string>());
  };
  if (std::erase_if(manifest.entries, is_gone) > 0) {
    write_manifest(options.out, manifest);
  }
  const std::vector<ClipPlan> to_make = plans_to_make(plans, manifest, options.out);

  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  const auto start = std::chrono::steady_clock::now();
  const double cpu_before = cpu_seconds(RUSAGE_CHILDREN);
  const Outcome outcome =
      make_all(to_make, options, options.jobs > 0 ? options.jobs : cores, manifest);
  if (outcome.signal != 0) {
    remove_partial_files(options.out);
    end_by(outcome.signal);
  }
  const double wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();  // s
  for (const ClipPlan& plan : plans) tell_notes(options.out, plan.file, manifest);
  fmt::print(stderr, "{}: {} made, {} up to date already, {} failed", options.out.string(),
             outcome.made, plans.size() - to_make.size(), outcome.failed);
  if (outcome.made > 0) {
    fmt::print(stderr, "; {:.1f} s, {:.2f} of {} cores busy", wall,
               (cpu_seconds(RUSAGE_CHILDREN) - cpu_before) / wall, cores);
  }
  fmt::print(stderr, "\n");
  if (options.report) {
    write_report_page(options.out, manifest);
    print_result(report_table(manifest));
  }
  return outcome.failed;
}

}  // namespace pinchlab
