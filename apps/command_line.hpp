// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What all commands of `adit` share. CLI11 stays behind this header: it takes seconds to compile.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/slam/run_config.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace adit::app {

/// An option of a command. Each member returns the option, for the next one.
class Option {
 public:
  explicit Option(CLI::Option& option) : option_(&option) {}
  Option required() const;
  Option one_of(const std::vector<std::string>& values) const;
  Option in_range(int least, int most) const;
  Option separated_by_commas() const;
  /// The help shows the current value of the variable as the default.
  Option default_shown() const;
  /// `fault` returns what is wrong with a value, "" if nothing is.
  Option check(const std::function<std::string(const std::string&)>& fault) const;

 private:
  CLI::Option* option_;
};

/// A command under construction. Names as in CLI11: "--name" of an option, "name" of a positional argument.
/// Values go to variables that live until the command has run.
class Command {
 public:
  explicit Command(CLI::App& app) : app_(&app) {}
  Option add_option(const std::string& name, std::string& value, const std::string& help) const;
  Option add_option(const std::string& name, int& value, const std::string& help) const;
  Option add_option(const std::string& name, std::vector<std::string>& values, const std::string& help) const;
  Option add_option(const std::string& name, std::vector<int>& values, const std::string& help) const;
  Option add_option(const std::string& name, std::optional<std::uint64_t>& value,
                    const std::string& help) const;
  Option add_flag(const std::string& name, bool& value, const std::string& help) const;
  /// Giving the option `name` together with one of `others` is wrong usage. All of them exist.
  void exclude(const std::string& name, const std::vector<std::string>& others) const;
  void footer(const std::string& text) const;

 private:
  CLI::App* app_;
};

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

/// An option or an argument as the help shows it.
struct OptionHelp {
  std::string name;                  ///< "--out"; "" of an argument.
  std::string value;                 ///< "TEXT", the argument's name; "" of a flag.
  std::vector<std::string> choices;  ///< The values it takes, where they are few.
  std::string help;
};
struct CommandHelp {
  std::string name;  ///< "" of the program itself.
  std::string description;
  std::string footer;
  std::vector<OptionHelp> options;
};

/// Collects the commands; `main` owns it. Wrong usage (exit code 2) is found by CLI11 or reported by
/// `usage_error`.
class Program {
 public:
  Program();
  ~Program();
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  /// Adds `adit NAME`; options go on the returned command, `body` runs once they are parsed.
  Command add_command(const std::string& name, const std::string& description, Body body);
  /// The program with the options that every command takes, then its commands.
  [[nodiscard]] std::vector<CommandHelp> help() const;
  int run(int argc, char** argv);

 private:
  void check_command(const std::string& name) const;
  void parse(int argc, char** argv) const;
  [[nodiscard]] std::string command_of(const CLI::App& command) const;

  std::unique_ptr<CLI::App> cli_;
  Common common_;
  std::string profile_ = "default";
  int exit_code_ = 0;
};

/// For wrong usage that shows only after parsing: ends the command with exit code 2.
[[noreturn]] void usage_error(const std::string& message);

/// Names of what is simulated; "": as it is configured.
struct SimulationOptions {
  std::string lidar = {};  ///< Or several, separated by commas, for the robots in turn.
  std::string imu = {};
  std::string conditions = {};
};
/// --lidar and --conditions.
void add_simulation_options(const Command& command, SimulationOptions& options);

/// Sets fields by "key=value"; a wrong one is wrong usage.
void set_fields(const std::vector<std::string>& sets, const Fields& fields);

/// The configuration of a command, the one tree of keys that `adit config` prints: the profile, then
/// --config, then what `simulation` names, then --set. A file with an unknown key or a bad value is an error;
/// a wrong --set, profile, LiDAR, IMU or condition is wrong usage.
Result<RunConfig> configured(const Common& common, const SimulationOptions& simulation = {});

/// Prints the lines on stderr, where they do not mix with results.
void print_notes(const std::string& command, const std::vector<std::string>& notes);

// One function per command, each in its own file of this folder.
void add_world(Program& program);
void add_routes(Program& program);
void add_simulate(Program& program);
void add_odometry(Program& program);
void add_slam(Program& program);
void add_merge(Program& program);
void add_localize(Program& program);
void add_georeference(Program& program);
void add_study(Program& program);
void add_merge_study(Program& program);
void add_merge_calibration(Program& program);
void add_merge_curves(Program& program);
void add_loop_study(Program& program);
void add_uncertainty_study(Program& program);
void add_evaluate(Program& program);
void add_explain(Program& program);
void add_register(Program& program);
void add_solve(Program& program);
void add_convert(Program& program);
void add_info(Program& program);
void add_doctor(Program& program);
void add_config(Program& program);
void add_describe(Program& program);

}  // namespace adit::app
