// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What all commands of `adit` share. The one place that includes CLI11.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/result.hpp"

namespace adit::app {

/// Options that every command takes.
struct Common {
  bool json = false;              ///< Print the result as JSON on stdout, alone.
  int threads = 0;                ///< 0: all cores.
  std::vector<std::string> sets;  ///< "key=value", applied after the file.
  std::string config_file;        ///< TOML.
};

/// The body of a command: returns 0, or an error that main prints in one line (exit code 1).
using Body = std::function<Result<>(const Common&)>;

/// Collects the commands; `main` owns it. Wrong usage (exit code 2) is CLI11's business, and `usage_error`'s.
class Program {
 public:
  Program();
  /// Adds `adit NAME`; options go on the returned subcommand, `body` runs once they are parsed.
  CLI::App* add_command(const std::string& name, const std::string& description, Body body);
  int run(int argc, char** argv);

 private:
  void check_command(const std::string& name) const;

  CLI::App cli_;
  Common common_;
  int exit_code_ = 0;
};

/// For mistakes that only show after parsing: ends the command with exit code 2.
[[noreturn]] void usage_error(const std::string& message);

/// Sets `fields` from --config and then --set; an unknown key is an error that names the nearest one.
Result<> configure(const Fields& fields, const Common& common);

// One function a command, each in its own file of this folder.
void add_world(Program& program);
void add_simulate(Program& program);
void add_odometry(Program& program);
void add_slam(Program& program);
void add_study(Program& program);
void add_merge_study(Program& program);
void add_loop_study(Program& program);
void add_evaluate(Program& program);
void add_register(Program& program);
void add_solve(Program& program);
void add_convert(Program& program);
void add_info(Program& program);
void add_config(Program& program);

}  // namespace adit::app
