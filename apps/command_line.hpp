// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What all commands of `adit` share. The one place that includes CLI11.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/slam/run_config.hpp"

namespace adit::app {

/// Options that every command takes.
struct Common {
  bool json = false;  ///< Print the result as JSON on stdout, alone.
  int threads = 0;    ///< 0: all cores.
  Profile profile = Profile::standard;
  std::string config_file;        ///< TOML, applied after the profile.
  std::vector<std::string> sets;  ///< "key=value", applied after the file.
  std::string command;            ///< The command line, without options that do not change the result.
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
  [[nodiscard]] std::string command_of(const CLI::App& command) const;

  CLI::App cli_;
  Common common_;
  std::string profile_ = "default";
  int exit_code_ = 0;
};

/// For mistakes that only show after parsing: ends the command with exit code 2.
[[noreturn]] void usage_error(const std::string& message);

/// The configuration of a command, the one tree of keys that `adit config` prints: the profile, then
/// --config, then the LiDAR of that name (`--lidar`; "": as it is), then --set. A file with an unknown key or
/// a bad value is an error; a wrong --set, profile or LiDAR is wrong usage.
Result<RunConfig> configured(const Common& common, const std::string& lidar = "");

/// Prints the lines on stderr, where they do not mix with results.
void print_notes(const std::string& command, const std::vector<std::string>& notes);

// One function per command, each in its own file of this folder.
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
