// SPDX-License-Identifier: GPL-3.0-or-later
#include "analysis/gnuplot.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <stdexcept>

namespace pinchlab::analysis {

std::string gnuplot_quote(const std::string& text) {
  // In single quotes only the quote itself is special; backquotes go too, lest a script that is
  // edited by hand turns one into a command.
  std::string quoted = "'";
  for (char c : text) {
    if (c == '\'') quoted += '\'';
    quoted += c == '`' ? '"' : c;
  }
  return quoted + "'";
}

std::string gnuplot_tic(const std::string& text) {
  std::string format;
  for (const char c : text) format += c == '%' ? "%%" : std::string(1, c);
  return gnuplot_quote(format);
}

std::string gnuplot_script(const std::string& name, int width_px, int height_px,
                           const std::string& body) {
  return fmt::format(
      "# Draws {0}.svg and {0}.pdf: gnuplot {0}.gp\n"
      "set encoding utf8\n"
      "set terminal svg size {1},{2} noenhanced font 'Helvetica,14' background '#ffffff'\n"
      "set output '{0}.svg'\n{3}"
      "reset\n"
      "set terminal pdfcairo size {4:.3f},{5:.3f} noenhanced font 'Helvetica,11'\n"
      "set output '{0}.pdf'\n{3}"
      "set output\n",
      name, width_px, height_px, body, width_px / 96.0, height_px / 96.0);
}

void run_gnuplot(const std::filesystem::path& folder, const std::string& script_name) {
  const std::string log = (folder / "gnuplot.log").string();
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, "gnuplot.log", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  std::string program = "gnuplot";
  std::string defaults = "-d";  // not the user's own settings
  std::string script = script_name;
  char* arguments[] = {program.data(), defaults.data(), script.data(), nullptr};
  pid_t child = 0;
  const int error = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    throw std::runtime_error(
        fmt::format("gnuplot cannot be started ({}): install it (Debian: gnuplot-nox) or pass "
                    "--no-figures",
                    std::strerror(error)));
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::ifstream file(log);
    const std::string said{std::istreambuf_iterator<char>(file), {}};
    throw std::runtime_error(fmt::format("gnuplot failed on {}: {}", script_name, said));
  }
}

}  // namespace pinchlab::analysis
