// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/session_pages.hpp"

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/report/html_report.hpp"
#include "adit/slam/merge_pictures.hpp"
#include "adit/slam/robot_facts.hpp"

namespace adit {
std::vector<std::string> what_ran(const Provenance& provenance) {
  std::vector<std::string> lines;
  for (const RobotProvenance& robot : provenance.robots)
    lines.push_back(robot.failure.empty()
                        ? format("{}: {} scans{}, odometry {}", robot.name, robot.scans,
                                 robot.lidar.empty() ? "" : " of " + robot.lidar, robot.odometry)
                        : format("left out: {}", robot.failure));
  lines.push_back("profile " + provenance.profile);
  if (!provenance.world.empty()) lines.push_back("simulated in " + provenance.world);
  for (const std::string& setting : provenance.settings) lines.push_back("set " + setting);
  return lines;
}

std::string session_page(const Session& session) {
  StudyResult page;
  page.version = version();
  page.seed = session.provenance.seed;
  page.configuration = session.provenance.configuration;
  page.command = session.provenance.command;
  page.what_ran = what_ran(session.provenance);
  for (const auto& map : session.maps) page.robots.push_back(robot_facts(*map, {}));
  JointResult& joint = page.joint.emplace();
  for (const PairOutcome& pair : session.solution.pairs) {
    if (pair.merged) continue;
    joint.refusals.push_back(
        format("{} and {}: {}", session.name_of(pair.a), session.name_of(pair.b), pair.refused_reason));
  }
  joint.loop_map = loop_map(session.fleet, session.solution);
  mark_slips(joint.loop_map, session.maps);
  joint.merges = merge_pictures(session.fleet, session.solution);
  return html_report(page, {}, study_figures(page));
}

}  // namespace adit
