// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/config_toml.hpp"
#include "command_line.hpp"

namespace adit::app {

Result<> configure(const Fields& fields, const Common& common) {
  if (!common.config_file.empty()) {
    if (Result<> loaded = load_config(common.config_file, fields); !loaded) return loaded;
  }
  for (const std::string& entry : common.sets) {
    const std::size_t equals = entry.find('=');
    if (equals == std::string::npos) usage_error("--set " + entry + ": key=value is needed");
    const Result<> set = set_field(fields, entry.substr(0, equals), entry.substr(equals + 1));
    if (!set) return fail("--set " + entry, set.error());
  }
  return {};
}

}  // namespace adit::app
