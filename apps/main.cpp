// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "command_line.hpp"

int main(int argc, char** argv) {
  adit::app::Program program;
  add_register(program);
  return program.run(argc, argv);
}
