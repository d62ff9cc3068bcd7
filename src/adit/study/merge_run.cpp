// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/merge_run.hpp"

#include <algorithm>

#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/shared_stretch.hpp"
#include "adit/study/processor_time.hpp"

namespace adit {
namespace {

/// What two robots would know if there were no others.
FleetGraph between(const FleetGraph& all, RobotId a, RobotId b) {
  FleetGraph pair;
  pair.policy = all.policy;
  for (const RobotId robot : {a, b}) pair.robots[robot] = all.robots.at(robot);
  for (const auto& [ends, loop] : all.loops)
    if (pair.robots.contains(ends.first.robot) && pair.robots.contains(ends.second.robot))
      pair.loops.emplace(ends, loop);
  for (const auto& [robots, check] : all.checks)
    if (pair.robots.contains(robots.first) && pair.robots.contains(robots.second))
      pair.checks.emplace(robots, check);
  return pair;
}

int loops_in_use(const FleetSolution& solution) {
  return static_cast<int>(
      std::ranges::count_if(solution.loops, [](const LoopOutcome& loop) { return loop.in_use(); }));
}

MergeEvidence::Robot evidence_of(const MergedRobot& robot, double drift_m) {
  return {robot.path_length_m, robot.ate ? robot.ate->max_m : 0.0, drift_m};
}

/// The largest ATE of a robot; a robot without a pose to compare has none.
double ate_max(const MergedRobot& robot) { return robot.ate ? robot.ate->max_m : 0.0; }
double ate_pct(const MergedRobot& robot) { return robot.ate_max_over_path_pct().value_or(0.0); }

Result<MergePair> run_pair(const std::vector<RobotRun>& runs, const Meeting& meeting, const MergeTruth& truth,
                           std::array<std::size_t, 2> robots, const BackEndConfig& config) {
  const auto [a, b] = robots;
  const std::vector<const RobotRun*> both = {&runs[a], &runs[b]};
  const FleetGraph known = between(meeting.agents.front().known(), runs[a].map->id, runs[b].map->id);
  const Meeting of_two{{meeting.maps[a], meeting.maps[b]}, {}, {}, {}};
  const Result<JudgedSolution> judged = judge(both, of_two, solve(known, config));
  if (!judged) return tl::unexpected(judged.error());
  const PairResult result = pair_result(both, of_two, *judged);
  MergePair pair;
  pair.robots = {result.robots[0].name, result.robots[1].name};
  pair.shared_m = truth.shared_m[a][b];
  pair.distinctive_m = truth.distinctive_m[a][b];
  pair.refused_kind = result.refused_kind;
  pair.refused_reason = result.refused_reason;
  pair.registrations = static_cast<int>(known.loops.size());
  pair.loops_in_use = loops_in_use(judged->solution);
  pair.wrong_loops_in_use = result.wrong_loops_in_solution;
  pair.ate_max_m = {ate_max(result.robots[0]), ate_max(result.robots[1])};
  pair.ate_max_over_path_pct = {ate_pct(result.robots[0]), ate_pct(result.robots[1])};
  pair.outcome = judge_merge(
      {result.merged,
       pair.loops_in_use,
       pair.wrong_loops_in_use,
       {evidence_of(result.robots[0], truth.drift_m[a]), evidence_of(result.robots[1], truth.drift_m[b])}});
  return pair;
}

/// The names of the robots of each group of indices.
std::vector<std::vector<std::string>> named(const std::vector<RobotRun>& runs,
                                            const std::vector<std::vector<std::size_t>>& groups) {
  std::vector<std::vector<std::string>> names;
  for (const std::vector<std::size_t>& group : groups) {
    names.emplace_back();
    for (const std::size_t robot : group) names.back().push_back(runs[robot].result.name);
  }
  return names;
}

/// The joint solution judged like a pair, over the robots that share a map with another.
bool is_wrong(const MergeTruth& truth, const JointResult& result, int num_loops_in_use) {
  MergeEvidence evidence{num_loops_in_use > 0, num_loops_in_use, result.wrong_loops_in_solution, {}};
  for (std::size_t i = 0; i < result.robots.size(); ++i) {
    const bool is_alone = std::ranges::any_of(result.components, [&](const std::vector<std::string>& map) {
      return map.size() == 1 && map.front() == result.robots[i].name;
    });
    if (!is_alone) evidence.robots.push_back(evidence_of(result.robots[i], truth.drift_m[i]));
  }
  return judge_merge(evidence) == MergeOutcome::wrong;
}

/// Metres of shared stretch of each pair; 0 where no stretch of it is distinctive.
std::vector<std::vector<double>> mergeable_m(const MergeTruth& truth) {
  std::vector<std::vector<double>> shared_m = truth.shared_m;
  for (std::size_t a = 0; a < shared_m.size(); ++a)
    for (std::size_t b = 0; b < shared_m.size(); ++b)
      if (truth.distinctive_m[a][b] < kDistinctiveStretch) shared_m[a][b] = 0.0;
  return shared_m;
}

MergeJoint joint_of(const std::vector<RobotRun>& runs, const MergeTruth& truth, const JointResult& result,
                    int num_loops_in_use) {
  constexpr double kAnything = 1e-3;
  MergeJoint joint;
  joint.maps = result.components;
  joint.possible_maps = named(runs, groups_sharing(mergeable_m(truth), kMergeableStretch));
  joint.wrong = is_wrong(truth, result, num_loops_in_use) ||
                !are_within(joint.maps, named(runs, groups_sharing(truth.shared_m, kAnything)));
  joint.wrong_loops_in_use = result.wrong_loops_in_solution;
  for (const MergedRobot& robot : result.robots) {
    joint.ate_max_m = std::max(joint.ate_max_m, ate_max(robot));
    joint.ate_max_over_path_pct = std::max(joint.ate_max_over_path_pct, ate_pct(robot));
  }
  return joint;
}

}  // namespace

Result<MergeTruth> merge_truth(const std::vector<RobotRun>& runs, KeyframeSelection selection,
                               DistinctiveMetres distinctive_m) {
  MergeTruth truth;
  truth.distinctive_m = std::move(distinctive_m);
  for (const RobotRun& a : runs) {
    const Result<double> drift = largest_drift_m(a.map_for(selection)->odometry, a.truth);
    if (!drift) return fail(a.result.name, drift.error());
    truth.drift_m.push_back(*drift);
    std::vector<double>& row = truth.shared_m.emplace_back();
    for (const RobotRun& b : runs) row.push_back(&a == &b ? 0.0 : shared_stretch_m(a.truth, b.truth));
  }
  return truth;
}

Result<MergeRun> run_merges(const std::vector<RobotRun>& runs, const MergeTruth& truth,
                            const SlamConfig& config) {
  std::vector<const RobotRun*> all;
  for (const RobotRun& run : runs) all.push_back(&run);
  const double start_s = processor_s();
  const Result<Meeting> meeting = hold_meeting(selected_maps(all, config), config);
  if (!meeting) return tl::unexpected(meeting.error());
  const FleetGraph& known = meeting->agents.front().known();
  const FleetSolution solution = solve(known, config.back_end);
  MergeRun result;
  result.time_s = processor_s() - start_s;
  result.keyframes = to_string(config.keyframes);
  result.registrations = static_cast<int>(known.loops.size());
  const Result<JudgedSolution> judged = judge(all, *meeting, solution);
  if (!judged) return tl::unexpected(judged.error());
  result.joint = joint_of(runs, truth, joint_result(all, *meeting, *judged), loops_in_use(solution));
  for (std::size_t a = 0; a < runs.size(); ++a)
    for (std::size_t b = a + 1; b < runs.size(); ++b) {
      const Result<MergePair> pair = run_pair(runs, *meeting, truth, {a, b}, config.back_end);
      if (!pair) return tl::unexpected(pair.error());
      result.pairs.push_back(*pair);
    }
  return result;
}

bool is_same_run(const MergeRun& a, const MergeRun& b) {
  return a.world == b.world && a.keyframes == b.keyframes && a.sensors == b.sensors &&
         a.conditions == b.conditions;
}

void put_run(std::vector<MergeRun>& runs, MergeRun run) {
  const auto old = std::ranges::find_if(runs, [&](const MergeRun& other) { return is_same_run(other, run); });
  if (old == runs.end())
    runs.push_back(std::move(run));
  else
    *old = std::move(run);
}

}  // namespace adit
