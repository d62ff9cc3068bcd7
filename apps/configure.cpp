// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>

#include "adit/io/config_toml.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {

void add_simulation_options(const Command& command, SimulationOptions& options) {
  const Option lidar = command.add_option(
      "--lidar", options.lidar,
      "Simulated LiDAR, or several for the robots in turn, separated by commas (default: os2-128)");
  if (!options.lidar.empty()) lidar.default_shown();
  const Option conditions =
      command
          .add_option("--conditions", options.conditions,
                      "Simulated conditions: ideal, where every unit of a sensor is the same and nothing "
                      "changes, or field")
          .one_of({"ideal", "field"});
  if (!options.conditions.empty()) conditions.default_shown();
}

void set_fields(const std::vector<std::string>& sets, const Fields& fields) {
  for (const std::string& entry : sets) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) usage_error("--set " + entry + ": key=value is needed");
    const Result<> set = set_field(fields, entry.substr(0, equals), entry.substr(equals + 1));
    if (!set) usage_error("--set " + entry + ": " + set.error().message);
  }
}

Result<RunConfig> configured(const Common& common, const SimulationOptions& simulation) {
  RunConfig config = config_of(common.profile);
  const Fields fields = fields_of(config);
  if (!common.config_file.empty()) {
    if (const Result<> loaded = load_config(common.config_file, fields); !loaded)
      return tl::unexpected(loaded.error());
  }
  if (!simulation.lidar.empty()) {
    if (const Result<> chosen = choose_lidars(simulation.lidar, config.simulation); !chosen)
      usage_error(chosen.error().message);
  }
  if (!simulation.imu.empty()) {
    if (const Result<> chosen = choose_imu(simulation.imu, config.simulation); !chosen)
      usage_error(chosen.error().message);
  }
  for (const Conditions conditions : kConditions)
    if (simulation.conditions == to_string(conditions)) set_conditions(conditions, config.simulation);
  set_fields(common.sets, fields);
  return config;
}

void print_notes(const std::string& command, const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    std::fprintf(stderr, "adit %s: note: %s\n", command.c_str(), note.c_str());
}

}  // namespace adit::app
