// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/study.hpp"

#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/version.hpp"
#include "adit/io/folders.hpp"
#include "adit/io/session_dir.hpp"
#include "adit/io/tum.hpp"
#include "adit/slam/merge_pictures.hpp"
#include "adit/slam/naming.hpp"
#include "adit/slam/session_pages.hpp"
#include "adit/study/judging.hpp"

namespace adit {
namespace {

constexpr double kFigureMapVoxel = 0.4;  // metres

Provenance provenance_of(const Study& study, const SlamConfig& config,
                         const std::vector<const RobotRun*>& runs) {
  Provenance provenance = study.provenance;
  provenance.robots.clear();
  for (const RobotRun* run : runs)
    provenance.robots.push_back({run->result.name, std::string(to_string(config.robot.odometry.method)),
                                 run->lidar, run->map->odometry.size(), ""});
  return provenance;
}

Result<> save_session(const std::filesystem::path& folder, const Session& session, MapFiles map_files) {
  return make_folder(folder).and_then([&] { return write_session(folder, session, map_files); });
}

/// What one policy makes of all robots.
struct UnderPolicy {
  SlamConfig config;
  std::vector<std::shared_ptr<const RobotMap>> maps;
};

std::vector<UnderPolicy> under_policies(const Study& study, const std::vector<const RobotRun*>& runs) {
  std::vector<UnderPolicy> all;
  for (const KeyframeSelection policy : study.policies) {
    const SlamConfig config = with_policy(policy, study.config).slam;
    all.push_back({config, selected_maps(runs, config)});
  }
  return all;
}

/// The two solutions of a pair under one policy, without and with PCM, and the session of the latter.
Result<> study_pair(const Study& study, const std::vector<const RobotRun*>& runs, const SlamConfig& config,
                    std::vector<std::shared_ptr<const RobotMap>> maps, StudyResult& result) {
  const std::string policy(to_string(config.keyframes));
  const Result<Meeting> meeting = hold_meeting(std::move(maps), config);
  if (!meeting) return tl::unexpected(meeting.error());
  for (const bool pcm_on : {false, true}) {
    BackEndConfig back_end = config.back_end;
    back_end.pcm_on = pcm_on;
    const Result<JudgedSolution> judged = judge(runs, *meeting, meeting->agents.front().solve(back_end));
    if (!judged) return tl::unexpected(judged.error());
    PairResult pair = pair_result(runs, *meeting, *judged);
    pair.keyframes = policy;
    pair.pcm = pcm_on;
    result.pairs.push_back(std::move(pair));
    if (!pcm_on) continue;
    const Session session{provenance_of(study, config, runs), meeting->maps, meeting->agents.front().known(),
                          judged->solution, judged->loop_classes};
    const std::filesystem::path folder =
        study.folder / "pairs" / format("{}-{}", runs[0]->result.name, runs[1]->result.name) / policy;
    if (const Result<> saved = save_session(folder, session, MapFiles::leave_out); !saved) return saved;
  }
  return {};
}

Result<> study_pairs(const Study& study, const std::vector<const RobotRun*>& runs,
                     const std::vector<UnderPolicy>& policies, StudyResult& result) {
  const Phase phase("pairs of robots", runs.size() * (runs.size() - 1) / 2 * policies.size());
  for (std::size_t a = 0; a < runs.size(); ++a) {
    for (std::size_t b = a + 1; b < runs.size(); ++b) {
      for (const auto& [config, maps] : policies) {
        const Result<> done = study_pair(study, {runs[a], runs[b]}, config, {maps[a], maps[b]}, result);
        if (!done) return done;
        phase.advance();
      }
    }
  }
  return {};
}

Result<> study_joint(const Study& study, const TriangleMesh& mesh, const std::vector<const RobotRun*>& runs,
                     const UnderPolicy& policy, StudyResult& result) {
  const SlamConfig& config = policy.config;
  const Result<Meeting> meeting = hold_meeting(policy.maps, config);
  if (!meeting) return tl::unexpected(meeting.error());
  const FleetGraph& known = meeting->agents.front().known();
  const Result<JudgedSolution> judged = judge(runs, *meeting, meeting->agents.front().solve(config.back_end));
  if (!judged) return tl::unexpected(judged.error());
  JointResult& joint = result.joint.emplace(joint_result(runs, *meeting, *judged));
  joint.keyframes = to_string(config.keyframes);
  const Result<TrueSurface> surface = TrueSurface::build(mesh);
  if (!surface) return tl::unexpected(surface.error());
  joint.map_accuracy = map_accuracies(runs, *meeting, *judged, joint, *surface, study.config.sight);
  joint.loop_map = loop_map(known, judged->solution);
  joint.merges = merge_pictures(known, judged->solution);
  for (const auto& map : meeting->maps)
    joint.maps.push_back(merged_cloud(*map, judged->solution.T_world_keyframe.at(map->id), kFigureMapVoxel));
  const Session session{provenance_of(study, config, runs), meeting->maps, known, judged->solution,
                        judged->loop_classes};
  return save_session(study.folder / "joint", session, MapFiles::write);
}

Result<> write_trajectories(const std::vector<RobotRun>& runs, const std::filesystem::path& dir) {
  for (const RobotRun& run : runs) {
    const std::filesystem::path folder = dir / "robots" / run.result.name;
    Result<> done = make_folder(folder);
    if (done) done = write_tum(folder / "odometry.tum", run.map->odometry);
    if (done && !run.truth.empty()) done = write_tum(folder / "truth.tum", run.truth);
    if (!done) return done;
  }
  return {};
}

/// The facts of the report: which odometry the policies ran on, and where.
std::vector<std::string> facts_of(const Study& study, const std::vector<const RobotRun*>& runs) {
  std::vector<std::string> lines;
  for (const KeyframeSelection policy : study.policies)
    lines.push_back(format("keyframes {}: odometry {}", to_string(policy),
                           to_string(with_policy(policy, study.config).slam.robot.odometry.method)));
  for (std::string& line : what_ran(provenance_of(study, study.config.slam, runs)))
    lines.push_back(std::move(line));
  return lines;
}

}  // namespace

Result<StudyResult> run_study(const Study& study, const World& world) {
  Result<std::vector<Recording>> recordings = simulate(world, study.config.simulation);
  if (!recordings) return tl::unexpected(recordings.error());
  name_robots(*recordings);
  const Result<std::vector<RobotRun>> runs = run_robots(*recordings, study.config);
  if (!runs) return tl::unexpected(runs.error());
  std::vector<const RobotRun*> all;
  for (const RobotRun& run : *runs) all.push_back(&run);
  StudyResult result;
  result.version = version();
  result.world = world.name;
  result.lidar = sensors_text(study.config.simulation);
  result.seed = study.config.simulation.seed;
  result.configuration = study.provenance.configuration;
  result.command = study.provenance.command;
  result.what_ran = facts_of(study, all);
  result.floor_plan = floor_plan_of(world.mesh);
  for (const RobotRun& run : *runs) result.robots.push_back(run.result);
  Result<> done = write_trajectories(*runs, study.folder);
  const std::vector<UnderPolicy> policies = under_policies(study, all);
  if (done) done = study_pairs(study, all, policies, result);
  if (done && runs->size() > 1) done = study_joint(study, world.mesh, all, policies.back(), result);
  if (!done) return tl::unexpected(done.error());
  return result;
}

}  // namespace adit
