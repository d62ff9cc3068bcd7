// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/file_info.hpp"

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

/// One "key: value" per line, nested values as JSON.
void print_text(const nlohmann::ordered_json& info) {
  for (const auto& [key, value] : info.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    if (!value.is_array() || value.empty() || !value.front().is_object()) {
      std::printf("%s: %s\n", key.c_str(), text.c_str());
      continue;
    }
    std::printf("%s:\n", key.c_str());
    for (const nlohmann::ordered_json& entry : value) std::printf("  %s\n", entry.dump().c_str());
  }
}

}  // namespace

void add_info(Program& program) {
  struct InfoOptions {
    std::string input;
    RecordingConfig recording;
  };
  const auto options = std::make_shared<InfoOptions>();
  const Command command = program.add_command(
      "info", "Show what a recording, cloud, mesh, trajectory, graph, routes file or session holds",
      [options](const Common& common) {
        return file_info(options->input, recording_config(configured(common)->recording, options->recording))
            .map([&](const std::string& info) {
              if (common.json) {
                std::printf("%s\n", info.c_str());
              } else {
                print_text(nlohmann::ordered_json::parse(info));
              }
            });
      });
  command.add_option("FILE", options->input, "File or folder").required();
  add_recording_options(command, options->recording);
  add_truth_topic(command, options->recording);
}

}  // namespace adit::app
