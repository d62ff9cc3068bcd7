// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "sessions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/slam/session_pages.hpp"

namespace adit::app {
namespace {

std::string slips_of(const RobotMap& map) {
  double metres = 0.0;
  for (const SlipStretch& slip : map.slips) metres += std::abs(slip.counted_m);
  return map.slips.empty() ? "" : format(", wheels slipped {} times by {:.1f} m", map.slips.size(), metres);
}

void print_robots(const SlamRun& run) {
  const Session& session = run.session;
  for (std::size_t i = 0; i < session.maps.size(); ++i) {
    const RobotMap& map = *session.maps[i];
    const auto own_loops = std::ranges::count_if(session.solution.loops, [&](const LoopOutcome& loop) {
      return loop.in_use() && loop.loop.from.robot == map.id && loop.loop.to.robot == map.id;
    });
    std::printf(
        "%s: %zu scans, %zu keyframes, %td loops of its own, %d degenerate and %d refused steps%s, %.2f MB "
        "sent\n",
        map.name.c_str(), map.odometry.size(), map.keyframes.size(), own_loops, map.num_degenerate,
        map.num_refused, slips_of(map).c_str(), static_cast<double>(run.bytes_sent[i]) * 1e-6);
  }
}

void print_pairs(const Session& session) {
  const auto name = [&](RobotId id) { return session.fleet.robots.at(id).name; };
  for (const PairOutcome& pair : session.solution.pairs) {
    int in_use = 0;
    for (const LoopOutcome& loop : session.solution.loops)
      in_use += loop.in_use() && loop.loop.from.robot == pair.a && loop.loop.to.robot == pair.b ? 1 : 0;
    std::printf("%s and %s: %s\n", name(pair.a).c_str(), name(pair.b).c_str(),
                pair.merged ? format("merged by {} of {} loops{}", in_use, pair.num_loops,
                                     pair.accuracy ? ", " + to_string(*pair.accuracy) : "")
                                  .c_str()
                            : ("not merged: " + pair.refused_reason).c_str());
  }
}

Result<> without_failures(const SlamRun& run, const std::string& out) {
  if (run.failed.empty()) return {};
  std::string reasons;
  for (const FailedRobot& robot : run.failed) reasons += "; " + robot.reason;
  return fail(format("{} of {} recordings could not be mapped and are missing in {}{}", run.failed.size(),
                     run.failed.size() + run.num_mapped, out, reasons));
}

Ruling ruling_of(const std::string& pair, Ruling::Kind kind) {
  const std::size_t comma = pair.find(',');
  if (comma == std::string::npos || comma == 0 || comma + 1 == pair.size())
    usage_error(format("'{}' names no two robots; write A,B", pair));
  return {kind, pair.substr(0, comma), pair.substr(comma + 1)};
}

}  // namespace

void refuse_configuration(const Common& common) {
  if (!common.sets.empty() || !common.config_file.empty() || common.profile != Profile::standard)
    usage_error("a session goes on with the configuration that it began with; give none");
}

void add_ruling_options(const Command& command, RulingOptions& options) {
  command.add_option("--veto", options.vetoes,
                     "Robots A,B whose loops join nothing, whatever the test says (repeatable)");
  command.add_option(
      "--confirm", options.confirmed,
      "Robots A,B whose maps are joined by the best alignment that was found, whatever the test "
      "says (repeatable)");
}

std::vector<Ruling> rulings_of(const RulingOptions& options) {
  std::vector<Ruling> rulings;
  for (const std::string& pair : options.vetoes) rulings.push_back(ruling_of(pair, Ruling::Kind::veto));
  for (const std::string& pair : options.confirmed) rulings.push_back(ruling_of(pair, Ruling::Kind::confirm));
  return rulings;
}

Result<> finish_session(SlamRun run, Job job, OutputDir& out, const std::string& path, bool json) {
  Result<> done = write_slam(out.path(), run, std::move(job));
  if (done) done = out.commit();
  if (!done) return done;
  if (json) {
    std::printf("%s", session_metrics(run).c_str());
  } else {
    print_robots(run);
    print_pairs(run.session);
  }
  return without_failures(run, path);
}

}  // namespace adit::app
