// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_job.hpp"

#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/config_toml.hpp"

namespace adit {
namespace {

void append_all(std::vector<std::string>& to, const std::vector<std::string>& more) {
  to.insert(to.end(), more.begin(), more.end());
}

/// Whether a configuration maps and merges as another does; how recordings are read and worlds made is no
/// matter.
bool maps_alike(RunConfig config, const std::string& other_toml) {
  RunConfig other;
  return parse_saved_config(fields_of(other), other_toml) &&
         to_toml(fields_of(config.slam)) == to_toml(fields_of(other.slam));
}

}  // namespace

Result<SavedSessions> open_sessions(const std::vector<std::string>& paths) {
  SavedSessions saved;
  Provenance& all = saved.job.provenance;
  for (const std::string& path : paths) {
    Result<SavedFleet> fleet = read_fleet(path);
    if (!fleet) return tl::unexpected(fleet.error());
    const Provenance& one = fleet->provenance;
    if (saved.fleets.empty()) {
      const Result<std::vector<std::string>> not_taken =
          parse_saved_config(fields_of(saved.job.config), one.configuration);
      if (!not_taken) return fail(path + "/session.toml: configuration", not_taken.error());
      for (const std::string& setting : *not_taken)
        fleet->notes.push_back(
            format("{}/session.toml: configuration, {}; the default of this version counts", path, setting));
      all.world = one.world;
      all.profile = one.profile;
      all.settings = one.settings;
      all.seed = one.seed;
    } else if (!maps_alike(saved.job.config, one.configuration)) {
      fleet->notes.push_back(format(
          "{} was made with another configuration than {}, whose counts from here on", path, paths.front()));
    }
    append_all(all.inputs, one.inputs);
    append_all(all.earlier_commands, one.earlier_commands);
    all.earlier_commands.push_back(one.command);
    saved.fleets.push_back(std::move(*fleet));
  }
  return saved;
}

Result<> write_slam(const std::filesystem::path& dir, SlamRun& run, Job job) {
  job.provenance.configuration = to_toml(fields_of(job.config));
  job.provenance.robots = run.session.provenance.robots;
  run.session.provenance = std::move(job.provenance);
  return write_slam(dir, run);
}

}  // namespace adit
