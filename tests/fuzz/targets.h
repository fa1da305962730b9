// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// What is fuzzed: each function takes any bytes, and returns whether they were used (true) or
// refused as they should be (false). It throws a Finding, or lets through an error that a reader
// does not promise, if neither.

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace pinchlab::fuzz {

struct Finding : std::logic_error {
  using std::logic_error::logic_error;
};

bool fuzz_scene(std::string_view bytes);         ///< a scene file, and its first steps
bool fuzz_answers(std::string_view bytes);       ///< an answer file
bool fuzz_counts(std::string_view bytes);        ///< a CSV table of answers or of counts
bool fuzz_study_config(std::string_view bytes);  ///< study.json
bool fuzz_jatos(std::string_view bytes);         ///< results that JATOS gave back
bool fuzz_jatos_key(std::string_view bytes);     ///< the key of an archive for JATOS
bool fuzz_theme(std::string_view bytes);         ///< a theme of the pictures
bool fuzz_truth(std::string_view bytes);         ///< what simulated participants answer by
bool fuzz_design(std::string_view bytes);        ///< design.json, its hash put right
bool fuzz_sweep(std::string_view bytes);         ///< the table of a sweep over a scene
bool fuzz_world(std::string_view bytes);         ///< a valid scene made of the bytes

struct Target {
  const char* name;  ///< of its executable (fuzz_NAME), and of its folders in corpus and found
  bool (*run)(std::string_view bytes);
};
inline constexpr Target targets[] = {
    {"scene", fuzz_scene},   {"answers", fuzz_answers},
    {"counts", fuzz_counts}, {"study_config", fuzz_study_config},
    {"jatos", fuzz_jatos},   {"jatos_key", fuzz_jatos_key},
    {"theme", fuzz_theme},   {"truth", fuzz_truth},
    {"design", fuzz_design}, {"sweep", fuzz_sweep},
    {"world", fuzz_world},
};

/// The scene file that fuzz_world makes of the bytes.
std::string scene_of(std::string_view bytes);

/// What the world that fuzz_world makes of the bytes breaks of sim/README.md's promises in so many
/// steps, or how it fails. Throws a Finding where a step is ok and not finite.
std::vector<std::string> told_of_world(std::string_view bytes, int steps);

/// A folder of this process' own, which goes with it.
const std::filesystem::path& scratch_folder();

/// A file of this process' own with these bytes; the next one of the same name replaces it.
std::filesystem::path file_with(std::string_view bytes, const std::string& name);

/// Throws Finding unless what() of an error names `file` first, as every message to users does.
void must_name(const std::exception& error, const std::string& file);

}  // namespace pinchlab::fuzz
