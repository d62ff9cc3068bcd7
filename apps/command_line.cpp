// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "command_line.hpp"

#include <algorithm>
#include <cstdio>
#include <exception>

#include "adit/core/parallel.hpp"
#include "adit/core/version.hpp"
#include "run_command.hpp"

namespace adit::app {

Program::Program() : cli_("Multi-robot LiDAR SLAM for tunnels, mines and caves", "adit") {
  cli_.require_subcommand(1);
  cli_.failure_message([](const CLI::App*, const CLI::Error& error) {
    return std::string("adit: ") + error.what() +
           " ('adit --help' and 'adit COMMAND --help' say what there is)\n";
  });
  cli_.set_version_flag("--version", std::string(version()));
  cli_.add_flag("--json", common_.json, "Print the result as JSON on stdout, alone");
  cli_.add_option("--threads", common_.threads, "Threads to use (default: all cores)")
      ->check(CLI::PositiveNumber);
  cli_.add_option("--config", common_.config_file, "TOML file with configuration fields")
      ->check(CLI::ExistingFile);
  cli_.add_option("--set", common_.sets, "Set one configuration field: key=value (repeatable)")
      ->allow_extra_args(false);
  cli_.fallthrough();
}

CLI::App* Program::add_command(const std::string& name, const std::string& description, Body body) {
  CLI::App* command = cli_.add_subcommand(name, description);
  command->fallthrough();
  command->callback([this, name, body = std::move(body)] {
    if (common_.threads > 0) set_num_threads(common_.threads);
    exit_code_ = run_command(name, [&] { return body(common_); });
  });
  return command;
}

// CLI11 would only say that a command is missing.
void Program::check_command(const std::string& name) const {
  if (name.starts_with('-')) return;
  std::vector<std::string> known;
  for (const CLI::App* command : cli_.get_subcommands({})) known.push_back(command->get_name());
  if (std::find(known.begin(), known.end(), name) != known.end()) return;
  const std::string nearest = nearest_key(known, name);
  usage_error("unknown command '" + name + "'" +
              (nearest.empty() ? "" : ", did you mean '" + nearest + "'?"));
}

int Program::run(int argc, char** argv) {
  try {
    if (argc > 1) check_command(argv[1]);
    cli_.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return cli_.exit(error) == 0 ? 0 : 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "adit: internal error: %s\n", error.what());
    return 1;
  }
  return exit_code_;
}

void usage_error(const std::string& message) { throw CLI::ValidationError(message); }

}  // namespace adit::app
