// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The study on a JATOS server (https://www.jatos.org): an archive that JATOS imports, and the way
// from the results that it gives back to answer files.
//
// A JATOS study archive (.jzip) is a zip of one folder of assets and one .jas file of JSON, whose
// required keys are `version`, and in `data` `uuid`, `title`, `dirName` and `componentList`
// (https://www.jatos.org/JATOS-Study-Archive-JZIP). All plans are made in advance. Each is a file
// of its own, of which a browser fetches only its participant's; it names clips by random names.
// What they stand for is in a key that is not in the archive.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "study/clips.h"
#include "study/config.h"

namespace pinchlab::study {

/// Where the key of an archive is: beside it, "study.jzip" has "study.key.json".
std::filesystem::path key_path(const std::filesystem::path& archive);

/// Throws std::runtime_error where export_jatos would by what is known before there are clips: if
/// there is a key already, since the answers to its archive could not be read without it, say.
void check_export(const Config& config, const std::filesystem::path& archive);

/// Writes the archive and its key. `config` names its demonstrations. Throws as check_export does,
/// and std::runtime_error where they cannot be written.
void export_jatos(const Config& config, const Clips& clips, std::uint64_t seed,
                  std::uint64_t participants, const std::filesystem::path& archive);

struct Imported {
  int added = 0;
  int known = 0;                   ///< participants whose answers were in the folder already
  std::vector<std::string> notes;  ///< what was not written as it was submitted, in words
};

/// Turns results that JATOS gave back ("data only" as text, or the data.txt files of an unpacked
/// results archive, folders searched for .txt) into answer files. All is checked before the first
/// is written, also that nobody chose otherwise in an earlier result. Throws std::runtime_error
/// with file and line.
Imported import_jatos(const std::vector<std::filesystem::path>& results,
                      const std::filesystem::path& key, const std::filesystem::path& answers);

}  // namespace pinchlab::study
