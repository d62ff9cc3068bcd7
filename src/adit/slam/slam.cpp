// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/slam.hpp"

#include "adit/core/progress.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/slam/meeting.hpp"
#include "adit/slam/naming.hpp"
#include "adit/slam/session_pages.hpp"

namespace adit {
namespace {

Provenance provenance_of(const Mapping& mapping, SlamConfig config) {
  Provenance provenance;
  provenance.command = "adit::slam";
  provenance.configuration = to_toml(fields_of(config));
  for (const MappedRobot& robot : mapping.robots)
    provenance.robots.push_back(
        {robot.map->name, robot.odometry, robot.lidar, robot.map->odometry.size(), ""});
  for (const FailedRobot& robot : mapping.failed)
    provenance.robots.push_back({robot.name, "", "", 0, robot.reason});
  return provenance;
}

}  // namespace

Result<SlamRun> slam(std::vector<Recording> recordings, const SlamConfig& config) {
  std::vector<std::string> notes = name_robots(recordings);
  Result<Mapping> mapping = map_robots(recordings, config);
  if (!mapping) return tl::unexpected(mapping.error());
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (const MappedRobot& robot : mapping->robots) maps.push_back(robot.map);
  Result<Meeting> meeting = hold_meeting(std::move(maps), config);
  if (!meeting) return tl::unexpected(meeting.error());
  SlamRun run;
  run.session.provenance = provenance_of(*mapping, config);
  run.session.fleet = meeting->agents.front().known();
  {
    const Phase phase("solving");
    run.session.solution = meeting->agents.front().solve(config.back_end);
    measure_merges(run.session.solution);
    Agent& first = meeting->agents.front();
    for (const std::string& problem : first.update_estimate(config.back_end).problems)
      run.notes.push_back("online estimate: " + problem);
    run.online = difference(first.estimate(), run.session.solution);
  }
  run.session.maps = std::move(meeting->maps);
  run.bytes_sent = std::move(meeting->bytes_sent);
  run.failed = std::move(mapping->failed);
  run.notes.insert(run.notes.end(), notes.begin(), notes.end());
  run.notes.insert(run.notes.end(), mapping->notes.begin(), mapping->notes.end());
  for (const std::string& failure : meeting->failures)
    run.notes.push_back("a message was left out: " + failure);
  return run;
}

Result<> write_slam(const std::filesystem::path& dir, const SlamRun& run) {
  Result<> done = write_session(dir, run.session, MapFiles::write);
  if (done) done = write_bytes(dir / "metrics.json", session_metrics(run));
  if (done) done = write_bytes(dir / "report.html", session_page(run.session));
  return done;
}

}  // namespace adit
