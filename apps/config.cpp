// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>
#include <string>

#include "adit/io/config_toml.hpp"
#include "adit/slam/settings_to_watch.hpp"
#include "command_line.hpp"

namespace adit::app {

void add_config(Program& program) {
  struct ConfigOptions {
    bool markdown = false;
    SimulationOptions simulation;
  };
  const auto options = std::make_shared<ConfigOptions>();
  const Command command = program.add_command(
      "config", "Print every configuration field as TOML; every command takes it with --config",
      [options](const Common& common) -> Result<> {
        Result<RunConfig> config = configured(common, options->simulation);
        if (!config) return tl::unexpected(config.error());
        const Fields fields = fields_of(*config);
        const std::string text = options->markdown
                                     ? markdown_of_settings_to_watch() + "\n" + to_markdown(fields)
                                     : to_toml(fields);
        std::printf("%s", text.c_str());
        return {};
      });
  command.add_flag("--markdown", options->markdown, "As the tables of docs/configuration.md");
  add_simulation_options(command, options->simulation);
}

}  // namespace adit::app
