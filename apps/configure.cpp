// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>

#include "adit/io/config_toml.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {

Result<RunConfig> configured(const Common& common, const std::string& lidar, const std::string& imu) {
  RunConfig config = config_of(common.profile);
  const Fields fields = fields_of(config);
  if (!common.config_file.empty()) {
    if (const Result<> loaded = load_config(common.config_file, fields); !loaded)
      return tl::unexpected(loaded.error());
  }
  if (!lidar.empty()) {
    if (const Result<> chosen = choose_lidar(lidar, config.simulation); !chosen)
      usage_error(chosen.error().message);
  }
  if (!imu.empty()) {
    if (const Result<> chosen = choose_imu(imu, config.simulation); !chosen)
      usage_error(chosen.error().message);
  }
  for (const std::string& entry : common.sets) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) usage_error("--set " + entry + ": key=value is needed");
    const Result<> set = set_field(fields, entry.substr(0, equals), entry.substr(equals + 1));
    if (!set) usage_error("--set " + entry + ": " + set.error().message);
  }
  return config;
}

void print_notes(const std::string& command, const std::vector<std::string>& notes) {
  for (const std::string& note : notes)
    std::fprintf(stderr, "adit %s: note: %s\n", command.c_str(), note.c_str());
}

}  // namespace adit::app
