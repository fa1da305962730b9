// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/jatos.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "base/answer_file.h"
#include "base/durable_file.h"
#include "base/input_error.h"
#include "base/json_object.h"
#include "base/output_file.h"
#include "base/partial_file.h"
#include "base/read_file.h"
#include "base/strict_json.h"
#include "study/answers.h"
#include "study/html_page.h"
#include "study/page_assets.h"
#include "study/secrets.h"
#include "study/session.h"
#include "study/shown.h"
#include "study/zip.h"

namespace pinchlab::study {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* folder_name = "moving_cables";  // participants can see it
constexpr std::size_t largest_key = 512U << 20U;      // bytes

// RFC 9562, version 4.
std::string random_uuid() {
  std::string hex = random_hex(16);
  hex[12] = '4';
  hex[16] = "89ab"[static_cast<unsigned char>(hex[16]) % 4];
  return fmt::format("{}-{}-{}-{}-{}", hex.substr(0, 8), hex.substr(8, 4), hex.substr(12, 4),
                     hex.substr(16, 4), hex.substr(20));
}

// A clip's random names. A demonstration that is shown several times has another name each time, so
// that a name does not tell that the sides are the same.
class MediaNames {
 public:
  const std::string& of(const PlannedTrial& trial) {
    std::string& name = names_[{trial.demonstration, trial.pinch, trial.kind, trial.round}];
    if (name.empty()) {
      name = random_hex(16);
    }
    return name;
  }
  /// What each name stands for, in the order of the names.
  [[nodiscard]] std::map<std::string, std::pair<std::string, Side>> meanings() const {
    std::map<std::string, std::pair<std::string, Side>> result;
    for (const auto& [shown, name] : names_) {
      result[name] = {std::get<0>(shown), std::get<1>(shown)};
    }
    return result;
  }

 private:
  std::map<std::tuple<std::string, Side, TrialKind, int>, std::string> names_;
};

// What JATOS knows of the study; `input` reaches the page as jatos.componentJsonInput. A string in
// a string: so JATOS keeps inputs.
ordered_json study_properties(const Config& config, const std::string& uuid, const json& input) {
  const ordered_json component = {{"uuid", random_uuid()},
                                  {"title", config.texts.at("title")},
                                  {"htmlFilePath", "index.html"},
                                  {"reloadable", true},
                                  {"active", true},
                                  {"comments", ""},
                                  {"jsonData", input.dump()}};
  const ordered_json batch = {
      {"uuid", random_uuid()},
      {"title", "Default"},
      {"active", true},
      {"maxActiveMembers", nullptr},
      {"maxTotalMembers", nullptr},
      {"maxTotalWorkers", nullptr},
      {"allowedWorkerTypes",
       {"Jatos", "PersonalSingle", "PersonalMultiple", "GeneralSingle", "GeneralMultiple"}},
      {"comments", nullptr},
      {"jsonData", nullptr}};
  return {{"version", "3"},
          {"data",
           {{"uuid", uuid},
            {"title", config.texts.at("title")},
            {"description", ""},
            {"groupStudy", false},
            {"dirName", folder_name},
            {"comments", ""},
            {"jsonData", nullptr},
            {"componentList", ordered_json::array({component})},
            {"batchList", ordered_json::array({batch})}}}};
}

void add_page(ZipWriter& zip, const Config& config) {
  const std::string folder = std::string(folder_name) + "/";
  for (const PageAsset& asset : page_assets()) {
    const bool is_ours_only = asset.path.starts_with("researcher") ||
                              asset.path.starts_with("texts/") || asset.path == "server.js" ||
                              asset.path == "index.html";
    if (!is_ours_only) {
      zip.add(folder + std::string(asset.path), asset.bytes);
    }
  }
  // JATOS serves jatos.js itself, beside the assets.
  zip.add(folder + "index.html", html_page("index.html", config, "jatos_server",
                                           "<script src=\"jatos.js\"></script>\n  "));
}

void add_clips(ZipWriter& zip, const Clips& clips, const MediaNames& names) {
  for (const auto& [name, meaning] : names.meanings()) {
    const auto& [demonstration, side] = meaning;
    const PairFiles& files = clips.at(demonstration);
    for (const Encoding encoding : {Encoding::mp4, Encoding::webm}) {
      if (encoding == Encoding::mp4 || files.webm) {
        const Clip& clip = files.in(encoding).at(side);
        zip.add(fmt::format("{}/media/{}.{}", folder_name, name, to_string(encoding)),
                clip.read(0, clip.served_size()));
      }
    }
  }
}

json file_entry(const ClipPair& pair) {
  const auto entry = [](const Clip& clip) {
    return json{{"name", clip.name()}, {"sha256", clip.sha256()}};
  };
  return {{"left", entry(*pair.left)}, {"right", entry(*pair.right)}};
}

// What the page fetches: names of clips and nothing else.
json plan_for_page(const std::vector<PlannedTrial>& plan, MediaNames& names, const Clips& clips) {
  const bool has_webm = std::ranges::all_of(
      plan, [&](const PlannedTrial& trial) { return clips.at(clip_key(trial)).webm.has_value(); });
  json trials = json::array();
  for (const PlannedTrial& trial : plan) {
    const std::string path = "media/" + names.of(trial);
    json entry = {{"practice", trial.kind == TrialKind::training}, {"mp4", path + ".mp4"}};
    if (has_webm) {
      entry["webm"] = path + ".webm";
    }
    trials.push_back(entry);
  }
  return trials;
}

// Writes what the page fetches of each participant's plan; returns all plans, for the key.
json add_plans(ZipWriter& zip, const PlanOptions& options, std::uint64_t seed,
               std::uint64_t participants, MediaNames& names, const Clips& clips) {
  json plans = json::array();
  for (std::uint64_t number = 0; number < participants; ++number) {
    const std::vector<PlannedTrial> plan = make_plan(seed, number, options);
    zip.add(fmt::format("{}/plans/{}.json", folder_name, number),
            plan_for_page(plan, names, clips).dump());
    plans.push_back(json::array());
    for (const PlannedTrial& trial : plan) {
      plans.back().push_back(to_json(trial, names.of(trial)));
    }
  }
  return plans;
}

json page_input(const Config& config, const std::string& uuid, std::uint64_t participants) {
  json input = {{"study", uuid},
                {"participants", participants},
                {"language", config.language},
                {"texts", config.texts}};
  if (!config.translations.empty()) input["translations"] = config.translations;
  if (config.trial != TrialOptions()) input["trial_options"] = to_json(config.trial);
  if (!config.questionnaires.empty()) input["questionnaires"] = to_json(config.questionnaires);
  return input;
}

// What import_jatos needs to make answer files of the results.
ordered_json key_of_archive(const Config& config, const PlanOptions& options, const Clips& clips,
                            const std::string& uuid, std::uint64_t seed, const json& plans) {
  json files = json::object();
  for (const auto& [name, pair] : clips) {
    files[name]["mp4"] = file_entry(pair.mp4);
    if (pair.webm) {
      files[name]["webm"] = file_entry(*pair.webm);
    }
  }
  ordered_json key = {{"format", "pinchlab-jatos-key 2"},
                      {"study", uuid},
                      {"seed", seed},
                      {"options",
                       {{"demonstrations", options.demonstrations},
                        {"training", options.training},
                        {"attention_checks", options.attention_checks},
                        {"repetitions", options.repetitions},
                        {"both_orders", options.both_orders}}},
                      {"shown", what_is_shown(config, clips)},
                      {"files", files},
                      {"plans", plans}};
  if (config.trial != TrialOptions()) key["trial_options"] = to_json(config.trial);
  if (!config.questionnaires.empty()) key["questionnaires"] = to_json(config.questionnaires);
  return key;
}

// The key, read back.
// nlohmann's move, which is declared noexcept, checks itself.
struct Key {  // NOLINT(bugprone-exception-escape)
  std::string study;
  std::uint64_t seed = 0;
  PlanOptions options;
  json shown;  // what_is_shown()
  Questionnaires questionnaires;
  TrialOptions trial;
  json files, plans;
};

std::vector<std::string> read_names(JsonObject& object, const std::string& key) {
  std::vector<std::string> names;
  for (const json& name : object.array(key, 10000)) {
    if (!name.is_string()) {
      object.fail(key, "must hold names");
    }
    names.push_back(name.get<std::string>());
  }
  return names;
}

Key read_key(const fs::path& path) {
  const json document = read_json_file(path, largest_key);
  JsonObject object(document, path.string(), "");
  object.choice("format", {"pinchlab-jatos-key 2"});
  Key key;
  key.study = object.name("study");
  key.seed = static_cast<std::uint64_t>(object.whole("seed", 0, static_cast<long>(largest_seed)));
  JsonObject options = object.object("options");
  key.options.demonstrations = read_names(options, "demonstrations");
  key.options.training = read_names(options, "training");
  key.options.attention_checks = read_names(options, "attention_checks");
  key.options.repetitions = static_cast<int>(options.whole("repetitions", 1, 50));
  key.options.both_orders = options.flag("both_orders");
  options.finish();
  key.shown = object.need("shown");
  if (object.has("trial_options")) {
    JsonObject trial = object.object("trial_options");
    key.trial = read_trial_options(trial);
    trial.finish();
  }
  if (object.has("questionnaires")) {
    key.questionnaires = questionnaires_from_json(object.object("questionnaires"), path.string());
  }
  key.files = object.need("files");
  key.plans = object.array("plans", 1000000);
  object.finish();
  return key;
}

// NOLINTNEXTLINE(bugprone-exception-escape): of the same move
struct Result {
  std::string id, place;
  ordered_json file;
  std::string note;  // what is not as it was submitted; mostly empty
};

// What was answered to each part that was asked.
std::map<std::string, json> read_questionnaires(JsonObject& result, const Key& key) {
  std::map<std::string, json> checked;
  if (key.questionnaires.empty()) return checked;
  JsonObject answers = result.object("questionnaires");
  for (const char* part : questionnaire_parts) {
    const Questionnaire* asked = key.questionnaires.find(part);
    if (asked != nullptr) checked[part] = check_answers(*asked, answers.object(part));
  }
  answers.finish();
  return checked;
}

// An answer file has no saved_utc before started_utc; what it has for both is to be told.
std::string clock_note(const std::string& place, const ordered_json& file,
                       const std::string& saved_utc) {
  if (file.at("saved_utc") == saved_utc) return "";
  return fmt::format(
      "{}: saved_utc {} is before started_utc; the participant's clock was set back, and the "
      "answer file has {} for both",
      place, saved_utc, file.at("saved_utc").get<std::string>());
}

// The rest is what a session file of our own server holds, and is checked as such.
json session_document_of(JsonObject& object, long number, const std::string& saved_utc,
                         const Key& key) {
  return {{"format", "pinchlab-session 1"},
          {"id", object.name("participant")},
          {"secret_sha256", std::string(64, '0')},
          {"number", number},
          {"seed", key.seed},
          {"language", object.need("language")},
          {"user_agent", object.need("user_agent")},
          {"started_utc", object.need("started_utc")},
          {"last_seen_utc", saved_utc},
          {"resumed_count", object.need("resumed_count")},
          {"shown_utc", ""},
          {"plan", key.plans[static_cast<std::size_t>(number)]},
          {"answers", object.need("answers")}};
}

// One line of the results: what jatos_server.js submitted.
Result read_result(const std::string& line, const std::string& place, const Key& key) {
  json document;
  try {
    document = parse_strict_json(line);
  } catch (const JsonError&) {
    throw InputError(place, "is not JSON; export the results from JATOS as text, data only");
  }
  JsonObject object(document, place, "");
  object.choice("format", {"study-answers 1"});
  if (object.name("study") != key.study) {
    throw InputError(place, "belongs to another archive; give the key that was made with it");
  }
  const long number = object.whole("number", 0, static_cast<long>(key.plans.size()) - 1);
  const std::string code_hash = withdrawal_hash(object.text("withdrawal_code", 64));
  if (code_hash.empty()) {
    object.fail("withdrawal_code", "is no withdrawal code");
  }
  const std::string saved_utc = object.utc("saved_utc");
  const json session_document = session_document_of(object, number, saved_utc, key);
  const json free_text = {{"free_text", object.need("free_text")}};
  const std::map<std::string, json> questionnaires = read_questionnaires(object, key);
  object.finish();
  Result result;
  try {
    Session session = session_from_json(session_document);
    session.questionnaires = questionnaires;
    for (const AnsweredTrial& trial : session.answers) check_asked(trial.answer, key.trial);
    if (session.id.size() != 16 ||
        session.id.find_first_not_of("0123456789abcdef") != std::string::npos) {
      throw std::runtime_error("participant: must be 16 hexadecimal digits");
    }
    const auto shown = [&key](const PlannedTrial& trial, Encoding encoding) {
      const json& file =
          key.files.at(trial.demonstration).at(to_string(encoding)).at(to_string(trial.pinch));
      return ShownFile{file.at("name"), file.at("sha256")};
    };
    result = {session.id, place,
              answer_file(session, {key.options, key.shown}, shown, parse_free_text(free_text),
                          saved_utc, code_hash),
              ""};
    result.note = clock_note(place, result.file, saved_utc);
  } catch (const std::exception& error) {
    throw InputError(place, error.what());
  }
  // As it will be read: what cannot be is told before anything is written.
  parse_answer_file(json::parse(result.file.dump()), place);
  return result;
}

std::vector<fs::path> text_files(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    if (!fs::is_directory(path)) {
      files.push_back(path);
      continue;
    }
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(path)) {
      if (entry.is_regular_file() && entry.path().extension() == ".txt") {
        files.push_back(entry.path());
      }
    }
  }
  std::ranges::sort(files);
  return files;
}

// A participant answers once: who is there already must have chosen the same.
void check_same_choices(const Result& result, const json& before, const std::string& where) {
  const auto choices = [](const json& file) {
    json all = json::array();
    for (const json& trial : file.at("trials")) {
      json choice = json::array();
      for (const char* key : {"demonstration", "left", "right", "choice", "preference"})
        choice.push_back(trial.value(key, json()));
      all.push_back(choice);
    }
    return all;
  };
  if (choices(json(result.file)) == choices(before)) return;
  throw InputError(result.place,
                   fmt::format("participant {} chose otherwise in {}; find out which counts, and "
                               "remove the other",
                               result.id, where));
}

}  // namespace

fs::path key_path(const fs::path& archive) {
  return fs::path(archive).replace_extension(".key.json");
}

void check_export(const Config& config, const fs::path& archive) {
  if (fs::exists(key_path(archive))) {
    throw std::runtime_error(
        fmt::format("{}: is there already, and answers to its archive need it; choose another name",
                    key_path(archive).string()));
  }
  if (!config.methods.empty() || !config.graded.empty()) {
    throw std::runtime_error(
        "studies of several methods and of thresholds run on our own server only; use study serve");
  }
  if (config.recruiting) {
    throw std::runtime_error(
        "recruiting is for study serve, which tells nobody the way back before the answers are "
        "saved, and lets an id take part once; files on a JATOS server can do neither. Leave it "
        "out of the configuration: JATOS has study links and an End Redirect URL of its own, and "
        "keeps the address' parameters with each result");
  }
  check_can_be_written(archive);
  check_can_be_written(key_path(archive));
}

void export_jatos(const Config& config, const Clips& clips, std::uint64_t seed,
                  std::uint64_t participants, const fs::path& archive) {
  const PlanOptions options = plan_options(config);
  check_export(config, archive);
  const std::string uuid = random_uuid();
  MediaNames names;
  ZipWriter zip(archive);
  add_page(zip, config);
  const json plans = add_plans(zip, options, seed, participants, names, clips);
  add_clips(zip, clips, names);
  const json input = page_input(config, uuid, participants);
  zip.add(std::string(folder_name) + ".jas", study_properties(config, uuid, input).dump());
  const ordered_json key = key_of_archive(config, options, clips, uuid, seed, plans);
  // The key first: an archive without one would be worthless.
  write_durably(key_path(archive), key.dump(1) + "\n");
  try {
    zip.finish();
  } catch (const std::exception&) {
    remove_durably(key_path(archive));
    throw;
  }
}

Imported import_jatos(const std::vector<fs::path>& results, const fs::path& key_file,
                      const fs::path& answers) {
  const Key key = read_key(key_file);
  std::vector<Result> all;
  for (const fs::path& path : text_files(results)) {
    std::istringstream lines(read_whole(path));
    std::string line;
    for (int i = 1; std::getline(lines, line); ++i) {
      if (line.find_first_not_of(" \t\r") != std::string::npos) {
        all.push_back(read_result(line, fmt::format("{}:{}", path.string(), i), key));
      }
    }
  }
  std::map<std::string, const Result*> first;
  for (const Result& result : all) {
    const auto [found, is_new] = first.emplace(result.id, &result);
    const fs::path path = answer_path(answers, result.id);
    if (!is_new) check_same_choices(result, json(found->second->file), found->second->place);
    if (fs::exists(path)) {
      const json before = read_answer_json(path);
      parse_answer_file(before, path.string());
      check_same_choices(result, before, path.string());
    }
  }
  make_folders(answers);
  Imported imported;
  for (const Result& result : all) {
    const fs::path path = answer_path(answers, result.id);
    if (fs::exists(path)) {
      ++imported.known;
      continue;
    }
    save_answers(path, result.file);
    ++imported.added;
    if (!result.note.empty()) imported.notes.push_back(result.note);
  }
  return imported;
}

}  // namespace pinchlab::study
