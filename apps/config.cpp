// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <memory>

#include "adit/io/config_toml.hpp"
#include "adit/simulation/world.hpp"
#include "run_config.hpp"

namespace adit::app {

void add_config(Program& program) {
  const auto markdown = std::make_shared<bool>(false);
  CLI::App* command =
      program.add_command("config", "Every configuration field with its value, as a TOML file to start from",
                          [markdown](const Common& common) -> Result<> {
                            RunConfig config;
                            WorldConfig world;
                            Fields fields = fields_of(config);
                            append(fields, "world", fields_of(world));
                            if (const Result<> configured = configure(fields, common); !configured)
                              return configured;
                            std::printf("%s", (*markdown ? to_markdown(fields) : to_toml(fields)).c_str());
                            return {};
                          });
  command->add_flag("--markdown", *markdown, "As the tables of docs/configuration.md");
}

}  // namespace adit::app
