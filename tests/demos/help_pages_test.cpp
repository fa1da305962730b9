// SPDX-License-Identifier: GPL-3.0-or-later
// The manual page and the completion against what --help says of every command.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "run_program.h"

namespace pinchlab {
namespace {

namespace fs = std::filesystem;

using Words = std::vector<std::string>;

/// What stands first in the lines of --help: options below "Options:", commands below
/// "Subcommands:".
struct Help {
  std::set<std::string> options, commands;
  std::string text;
};

Help help_of(const fs::path& folder, Words command) {
  command.emplace_back("--help");
  const RunResult run = run_program(folder, command);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  Help help;
  help.text = run.out;
  std::istringstream lines(run.out);
  std::string part;
  for (std::string line; std::getline(lines, line);) {
    std::smatch found;
    if (!line.empty() && line.front() != ' ') part = line;
    if (std::regex_search(line, found, std::regex("^  (?:-.,)?(--[a-z-]+)"))) {
      help.options.insert(found[1]);
    } else if (part == "Subcommands:" &&
               std::regex_search(line, found, std::regex("^  ([a-z-]+)"))) {
      help.commands.insert(found[1]);
    }
  }
  return help;
}

/// All commands with what --help says of them, by their words.
void collect(const fs::path& folder, const Words& command, std::map<Words, Help>& all) {
  const Help& help = all[command] = help_of(folder, command);
  for (const std::string& sub : help.commands) {
    Words longer = command;
    longer.push_back(sub);
    collect(folder, longer, all);
  }
}

/// What bash offers after these words, the last of which is begun.
std::set<std::string> offered(const fs::path& folder, Words words) {
  words.insert(words.begin(), "pinchlab");
  std::string quoted;
  for (const std::string& word : words) quoted += " '" + word + "'";
  std::ofstream(folder / "complete.sh")
      << fmt::format("source '{}'\nCOMP_WORDS=({})\nCOMP_CWORD={}\n_pinchlab\n",
                     (folder / "completion.bash").string(), quoted, words.size() - 1)
      << "printf '%s\\n' \"${COMPREPLY[@]}\"\n";
  const std::string out = (folder / "offered.txt").string();
  EXPECT_EQ(
      std::system(fmt::format("bash '{}' > '{}'", (folder / "complete.sh").string(), out).c_str()),
      0);
  std::set<std::string> lines;
  std::istringstream text(text_of(out));
  for (std::string line; std::getline(text, line);) {
    if (!line.empty()) lines.insert(line);
  }
  return lines;
}

fs::path folder_with_completion() {
  fs::path folder = scratch_folder();
  const RunResult run = run_program(folder, {"completion", "bash"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_EQ(run.err, "");
  std::ofstream(folder / "completion.bash") << run.out;
  return folder;
}

TEST(HelpPages, CompletionOffersWhatHelpNames) {
  const fs::path folder = folder_with_completion();
  std::map<Words, Help> all;
  collect(folder, {}, all);
  EXPECT_GT(all.size(), 20U);
  for (const auto& [command, help] : all) {
    Words words = command;
    words.emplace_back("");
    const std::set<std::string> offers = offered(folder, words);
    for (const std::string& name : help.options) {
      EXPECT_TRUE(offers.contains(name)) << fmt::format("{} {}", fmt::join(command, " "), name);
    }
    for (const std::string& name : help.commands) {
      EXPECT_TRUE(offers.contains(name)) << fmt::format("{} {}", fmt::join(command, " "), name);
    }
  }
}

TEST(HelpPages, CompletionKnowsBeginningsAndValues) {
  const fs::path folder = folder_with_completion();
  using Set = std::set<std::string>;
  EXPECT_EQ(offered(folder, {"st"}), (Set{"still", "stopping", "study"}));
  EXPECT_EQ(offered(folder, {"study", "ser"}), (Set{"serve"}));
  EXPECT_EQ(offered(folder, {"render", "--co"}), (Set{"--codec"}));
  EXPECT_EQ(offered(folder, {"render", "--codec", ""}),
            (Set{"h264", "vp9", "ffv1", "apng", "webp", "gif"}));
  EXPECT_EQ(offered(folder, {"simulate", "--out", "x.csv", "--method", "t"}), (Set{"thesis"}));
  EXPECT_EQ(offered(folder, {"completion", "b"}), (Set{"bash"}));
  EXPECT_EQ(offered(folder, {"simulate", "my-scene"}), (Set{}));  // bash then offers files
}

TEST(HelpPages, ManualHasEveryOptionOfEveryCommand) {
  const fs::path folder = scratch_folder();
  const RunResult manual = run_program(folder, {"manual"});
  EXPECT_EQ(manual.exit_code, 0);
  EXPECT_EQ(manual.err, "");
  std::map<Words, Help> all;
  collect(folder, {}, all);
  for (const auto& [command, help] : all) {
    if (command.empty()) continue;
    const std::string heading = std::regex_replace(
        fmt::format(".SS pinchlab {} [", fmt::join(command, " ")), std::regex("-"), "\\-");
    const std::size_t begin = manual.out.find(heading);
    ASSERT_NE(begin, std::string::npos) << heading;
    const std::string section = manual.out.substr(begin, manual.out.find("\n.SS ", begin) - begin);
    for (const std::string& name : help.options) {
      if (name == "--help") continue;
      const std::string entry = std::regex_replace(name, std::regex("-"), "\\-");
      EXPECT_NE(section.find(entry), std::string::npos) << heading << ' ' << name;
    }
  }
}

// Its own, not those of the command that it is one of.
TEST(HelpPages, EveryCommandHasAnExample) {
  std::map<Words, Help> all;
  collect(scratch_folder(), {}, all);
  for (const auto& [command, help] : all) {
    if (command.empty()) continue;
    const std::string typed = fmt::format("pinchlab {} ", fmt::join(command, " "));
    const std::size_t usage = help.text.find(typed);
    ASSERT_NE(usage, std::string::npos) << typed;
    EXPECT_NE(help.text.find(typed, usage + 1), std::string::npos) << help.text;
  }
}

TEST(HelpPages, ManualIsCleanRoff) {
  const fs::path folder = scratch_folder();
  std::ofstream(folder / "pinchlab.1") << run_program(folder, {"manual"}).out;
  const std::string check =
      fmt::format("cd '{}' && groff -man -Tutf8 -ww -z pinchlab.1 2> said.txt", folder.string());
  EXPECT_EQ(std::system(check.c_str()), 0);
  EXPECT_EQ(text_of(folder / "said.txt"), "");
}

// Where there is nothing else to run, so that nothing is installed or built either.
TEST(HelpPages, ScriptsTellWhatTheyDo) {
  const fs::path folder = scratch_folder();
  for (const char* tool : {"dirname", "sed"}) {
    fs::create_symlink(fs::path("/usr/bin") / tool, folder / tool);
  }
  for (const char* script : {"demos/run", "study/run", "tests/run"}) {
    for (const char* flag : {"--help", "-h"}) {
      const std::string line =
          fmt::format("PATH='{0}' {1}/{2} {3} > '{0}/out.txt' 2> '{0}/err.txt'", folder.string(),
                      PINCHLAB_SOURCE_DIR, script, flag);
      EXPECT_EQ(std::system(line.c_str()), 0) << line;
      EXPECT_NE(text_of(folder / "out.txt").find(fmt::format("\n  {} ", script)), std::string::npos)
          << text_of(folder / "out.txt");
      EXPECT_EQ(text_of(folder / "err.txt"), "");
    }
  }
}

}  // namespace
}  // namespace pinchlab
