// SPDX-License-Identifier: GPL-3.0-or-later
#include "demos/help_pages.h"

#include <fmt/format.h>

#include <functional>
#include <regex>
#include <sstream>
#include <vector>

#include "base/output_file.h"

namespace pinchlab {
namespace {

/// Option groups are commands without a name to CLI11; to its users their options are the command's
/// own.
bool is_group(const CLI::App& command) {
  return command.get_name().empty() || command.get_name().front() == '[';
}

std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !is_group(*command); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> options = command.get_options();
  for (const CLI::App* group :
       command.get_subcommands([](const CLI::App* part) { return is_group(*part); })) {
    for (const CLI::Option* option : group->get_options()) {
      if (option != group->get_help_ptr()) options.push_back(option);
    }
  }
  return options;
}

/// Calls `visit` with "", "render", "bench", "bench stress" and so on, in the order of --help.
void for_each_command(
    const CLI::App& app, const std::string& path,
    const std::function<void(const CLI::App& command, const std::string& path)>& visit) {
  visit(app, path);
  for (const CLI::App* command : commands_of(app)) {
    for_each_command(*command, path + (path.empty() ? "" : " ") + command->get_name(), visit);
  }
}

/// For roff: backslashes, hyphens that may be copied into a shell, and control lines.
std::string roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
  }
  return out;
}

/// Lines as they stand: footers are examples and little tables.
std::string as_it_stands(const std::string& text) {
  return text.empty() ? "" : fmt::format(".PP\n.EX\n{}\n.EE\n", roff(text));
}

std::string option_entry(const CLI::Option& option) {
  const CLI::Formatter formatter;
  const bool positional = option.get_positional();
  return fmt::format(".TP\n\\fB{}\\fR{}\n{}\n",
                     roff(formatter.make_option_name(&option, positional)),
                     roff(formatter.make_option_opts(&option)), roff(option.get_description()));
}

std::string command_section(const CLI::App& command, const std::string& path) {
  std::string arguments;
  const CLI::Formatter formatter;
  for (const CLI::Option* option : options_of(command)) {
    if (option->get_positional()) arguments += " " + formatter.make_option_usage(option);
  }
  if (!commands_of(command).empty()) arguments += " COMMAND";
  std::string page = fmt::format(".SS pinchlab {} [OPTIONS]{}\n{}\n", roff(path), roff(arguments),
                                 roff(command.get_description()));
  for (const CLI::Option* option : options_of(command)) {
    if (option != command.get_help_ptr()) page += option_entry(*option);
  }
  return page + as_it_stands(command.get_footer());
}

/// The choice in a type such as "C:{h264,vp9,ffv1}", with spaces between; "" where there is none.
std::string values_of(const CLI::Option& option) {
  static const std::regex choice(R"(\{([^{}]*)\})");
  std::smatch found;
  const std::string type = option.get_type_name();
  if (!std::regex_search(type, found, choice)) return "";
  return std::regex_replace(found[1].str(), std::regex(","), " ");
}

std::vector<std::string> names_of(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  return names;
}

/// What may follow the words of a command: its commands, its options, values of its arguments.
std::string words_of(const CLI::App& command) {
  std::string words;
  for (const CLI::App* sub : commands_of(command)) words += sub->get_name() + " ";
  for (const CLI::Option* option : options_of(command)) {
    for (const std::string& name : names_of(*option)) words += name + " ";
    if (option->get_positional() && !values_of(*option).empty()) words += values_of(*option) + " ";
  }
  if (!words.empty()) words.pop_back();
  return words;
}

}  // namespace

std::string manual_page(const CLI::App& app, const std::string& version) {
  std::string page = fmt::format(
      ".\\\" Made by `pinchlab manual`.\n"
      ".TH PINCHLAB 1 \"\" \"pinchlab {}\" \"User Commands\"\n"
      ".SH NAME\npinchlab \\- simulate, render and study cables that are pinched between bodies\n"
      ".SH SYNOPSIS\n\\fBpinchlab\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n"
      ".SH DESCRIPTION\n{}\n",
      roff(version), roff(app.get_description()));
  for (const CLI::Option* option : options_of(app)) page += option_entry(*option);
  page += as_it_stands(app.get_footer()) + ".SH COMMANDS\n";
  for_each_command(app, "", [&](const CLI::App& command, const std::string& path) {
    if (!path.empty()) page += command_section(command, path);
  });
  return page;
}

std::string bash_completion(const CLI::App& app) {
  std::string paths, values, words;
  for_each_command(app, "", [&](const CLI::App& command, const std::string& path) {
    if (!path.empty()) paths += (paths.empty() ? "'" : " | '") + path + "'";
    words += fmt::format("    '{}') words='{}' ;;\n", path, words_of(command));
    for (const CLI::Option* option : options_of(command)) {
      if (values_of(*option).empty()) continue;
      for (const std::string& name : names_of(*option)) {
        values += fmt::format("    '{} {}') words='{}' ;;\n", path, name, values_of(*option));
      }
    }
  });
  return fmt::format(R"(# bash completion of pinchlab, made by `pinchlab completion bash`.
_pinchlab() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} path='' longer word words=''
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    longer="${{path:+$path }}$word"
    case $longer in
      {}) path=$longer ;;
    esac
  done
  case "$path $before" in
{}  esac
  if [[ -z $words ]]; then
    case $path in
{}    esac
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
}}
complete -o default -F _pinchlab pinchlab
)",
                     paths, values, std::regex_replace(words, std::regex("    '"), "      '"));
}

void add_help_page_commands(CLI::App& app, const std::string& version) {
  CLI::App* manual = app.add_subcommand("manual", "Print the manual page");
  manual->footer("  pinchlab manual | man -l -");
  manual->callback([&app, version] { print_result(manual_page(app, version)); });

  CLI::App* completion = app.add_subcommand("completion", "Print a script that completes commands");
  auto shell = std::make_shared<std::string>();
  completion->add_option("shell", *shell, "Whose script")
      ->type_name("SHELL")
      ->required()
      ->check(CLI::IsMember({"bash"}));
  completion->footer(
      "  source <(pinchlab completion bash)      for this shell; or put it into\n"
      "  ~/.local/share/bash-completion/completions/pinchlab");
  completion->callback([&app, shell] { print_result(bash_completion(app)); });
}

}  // namespace pinchlab
