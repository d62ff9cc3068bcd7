// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Runs the program `adit` (ADIT_PROGRAM, set by CMake) as a user does.
#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "support/files.hpp"

namespace adit::test {

struct ProgramRun {
  int exit_code = -1;  ///< -1 when a signal ended it.
  std::string out;
  std::string err;
};

/// `arguments` go through the shell: paths in them must be free of blanks.
inline ProgramRun run_adit(const std::string& arguments) {
  const std::string base =
      (std::filesystem::temp_directory_path() / ("adit_run_" + std::to_string(getpid()))).string();
  const std::string command =
      std::string(ADIT_PROGRAM) + " " + arguments + " >" + base + ".out 2>" + base + ".err";
  const int status = std::system(command.c_str());
  ProgramRun run{WIFEXITED(status) ? WEXITSTATUS(status) : -1, get_file(base + ".out"),
                 get_file(base + ".err")};
  std::filesystem::remove(base + ".out");
  std::filesystem::remove(base + ".err");
  return run;
}

inline void expect_done(const std::string& arguments) {
  const ProgramRun run = run_adit(arguments);
  EXPECT_EQ(run.exit_code, 0) << arguments << ": " << run.err;
}

/// The command fails with that exit code, one line on stderr that holds `text`, and nothing on stdout.
inline void expect_refused(const std::string& arguments, int exit_code, const std::string& text) {
  const ProgramRun run = run_adit(arguments);
  EXPECT_EQ(run.exit_code, exit_code) << arguments << ": " << run.err;
  EXPECT_NE(run.err.find(text), std::string::npos) << arguments << ": " << run.err;
  EXPECT_EQ(std::ranges::count(run.err, '\n'), 1) << arguments << ": " << run.err;
  EXPECT_EQ(run.out, "") << arguments;
}

}  // namespace adit::test
