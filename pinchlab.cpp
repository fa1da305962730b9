// SPDX-License-Identifier: GPL-3.0-or-later
// The front door: reads the command line and calls one function a command.

#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"Pinchlab: 2D cable simulation, paired videos and a perception study"};
  CLI11_PARSE(app, argc, argv);
  return 0;
}
