// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <cstdio>
#include <filesystem>
#include <memory>

#include "adit/core/format.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/io/cloud_files.hpp"
#include "adit/io/mesh_files.hpp"
#include "adit/io/tum.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/slam/session_evaluation.hpp"
#include "adit/slam/session_log.hpp"
#include "command_line.hpp"
#include "inputs.hpp"

namespace adit::app {
namespace {

struct EvaluateOptions {
  std::string input;  ///< A session or a cloud.
  std::vector<std::string> truths;
  std::string mesh;
  std::vector<std::string> trajectories;
  std::string log;  ///< A .jrl to write.
};

Result<std::vector<GivenTruth>> read_truths(const std::vector<std::string>& files) {
  std::vector<GivenTruth> given;
  for (const std::string& file : files) {
    const auto [robot, path] = name_and_path(file);
    Result<Trajectory> truth = read_tum(path);
    if (!truth) return tl::unexpected(truth.error());
    given.push_back({path, robot, std::move(*truth)});
  }
  return given;
}

Result<TrueSurface> read_surface(const std::string& file) {
  return read_mesh(file).and_then([](const TriangleMesh& mesh) { return TrueSurface::build(mesh); });
}

Result<> compare_maps(const EvaluateOptions& options, const SightConfig& config,
                      const std::vector<std::optional<Trajectory>>& truths, SessionEvaluation& evaluation) {
  const Result<TrueSurface> surface = read_surface(options.mesh);
  if (!surface) return tl::unexpected(surface.error());
  const Result<PlacedSession> placed = read_placed_session(options.input);
  if (!placed) return tl::unexpected(placed.error());
  return add_map_accuracy(evaluation, *placed, truths, *surface, config);
}

Result<> evaluate_session(const EvaluateOptions& options, const SightConfig& config, const Common& common) {
  const Result<SavedSession> session = read_session(options.input);
  if (!session) return tl::unexpected(session.error());
  const Result<std::vector<GivenTruth>> given = read_truths(options.truths);
  if (!given) return tl::unexpected(given.error());
  const auto truths = match_truths(*session, *given);
  if (!truths) return tl::unexpected(truths.error());
  for (std::size_t i = 0; i < truths->size(); ++i)
    if (!(*truths)[i]) print_notes("evaluate", {session->robots[i] + " has no truth and is left out"});
  Result<SessionEvaluation> evaluation = evaluate(*session, *truths);
  if (!evaluation) return tl::unexpected(evaluation.error());
  if (!options.mesh.empty())
    if (const Result<> compared = compare_maps(options, config, *truths, *evaluation); !compared)
      return compared;
  if (common.json) {
    std::printf("%s\n", json_of(*evaluation).c_str());
  } else {
    for (const Table& table : tables_of(*evaluation)) std::printf("%s\n", text_of(table).c_str());
  }
  const Result<> saved = save_evaluation(options.input, *evaluation);
  if (!saved) print_notes("evaluate", {"the session itself is unchanged: " + saved.error().message});
  if (options.log.empty()) return {};
  if (evaluation->num_unjudged > 0)
    print_notes("evaluate", {format("{} loops that the truth cannot judge are left out of {}",
                                    evaluation->num_unjudged, options.log)});
  return write_labelled_log(options.log, options.input, *session, *evaluation, *truths);
}

Result<std::vector<Trajectory>> read_trajectories(const std::vector<std::string>& files) {
  std::vector<Trajectory> trajectories;
  for (const std::string& file : files) {
    Result<Trajectory> trajectory = read_tum(file);
    if (!trajectory) return tl::unexpected(trajectory.error());
    if (trajectory->empty()) return fail(file + ": holds no pose");
    trajectories.push_back(std::move(*trajectory));
  }
  return trajectories;
}

/// From the frame of the cloud to that of the mesh: the alignment of the trajectories with their truths.
Result<Pose> alignment_of(const std::vector<Trajectory>& trajectories,
                          const std::vector<Trajectory>& truths) {
  if (trajectories.empty()) return Pose();
  return joint_ate(trajectories, truths).map([](const std::vector<AteResult>& errors) {
    return errors.front().T_world_estimate;
  });
}

Result<> evaluate_cloud(const EvaluateOptions& options, const SightConfig& config, const Common& common) {
  Result<PointCloud> cloud = read_cloud(options.input);
  if (!cloud) return tl::unexpected(cloud.error());
  const Result<std::vector<Trajectory>> trajectories = read_trajectories(options.trajectories);
  if (!trajectories) return tl::unexpected(trajectories.error());
  const Result<std::vector<Trajectory>> truths = read_trajectories(options.truths);
  if (!truths) return tl::unexpected(truths.error());
  const Result<Pose> T_world_map = alignment_of(*trajectories, *truths);
  if (!T_world_map) return tl::unexpected(T_world_map.error());
  const Result<TrueSurface> surface = read_surface(options.mesh);
  if (!surface) return tl::unexpected(surface.error());
  std::vector<Eigen::Vector3f> eyes;
  for (std::size_t i = 0; i < truths->size(); ++i) {
    const Trajectory& truth = (*truths)[i];
    // Where a trajectory says when the map was made, that stretch counts.
    const Trajectory& mapped = trajectories->empty() ? truth : (*trajectories)[i];
    const Vector3 sensor(0.0, 0.0, config.sensor_height_m);
    const auto own = eyes_of(truth, mapped.front().stamp, mapped.back().stamp, sensor);
    eyes.insert(eyes.end(), own.begin(), own.end());
  }
  if (trajectories->empty()) print_notes("evaluate", {"the cloud is taken to be in the frame of the mesh"});
  if (truths->empty()) print_notes("evaluate", {"no completeness: --truth says what could have been seen"});
  const Result<MapAccuracy> accuracy =
      surface->compare(transformed(*T_world_map, std::move(*cloud)).points, eyes, config);
  if (!accuracy) return fail(options.input, accuracy.error());
  std::printf("%s\n",
              common.json ? json_of(*accuracy).c_str() : text_of(table_of(*accuracy, options.input)).c_str());
  return {};
}

Result<> evaluate_command(const EvaluateOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  if (options.mesh.empty() || std::filesystem::is_directory(options.input)) {
    if (options.truths.empty()) usage_error("--truth is required: the true trajectories of the robots");
    if (!options.trajectories.empty()) usage_error("--trajectory goes with a cloud; a session has its own");
    return evaluate_session(options, config->sight, common);
  }
  if (!options.log.empty()) usage_error("--jrl is the graph of a session, and a cloud has none");
  if (!options.trajectories.empty() && options.trajectories.size() != options.truths.size())
    usage_error(format("--trajectory names {} files and --truth {}; each needs its truth, in the same order",
                       options.trajectories.size(), options.truths.size()));
  return evaluate_cloud(options, config->sight, common);
}

}  // namespace

void add_evaluate(Program& program) {
  const auto options = std::make_shared<EvaluateOptions>();
  const Command command = program.add_command(
      "evaluate",
      "Compute ATE, RPE and loop precision of a session from the true trajectories, and its map's error",
      [options](const Common& common) { return evaluate_command(*options, common); });
  command
      .add_option("session", options->input,
                  "Session directory of adit slam; with --mesh also a cloud (PLY, PCD)")
      .required();
  command.add_option("--truth", options->truths,
                     "True trajectories (TUM) in any order, each named after its robot (robot_0.tum, "
                     "robot_0_truth.tum, robot_0/truth.tum) or given as NAME=FILE");
  command.add_option(
      "--mesh", options->mesh,
      "True surface (PLY, OBJ, STL, DAE, GLB), in the frame of the truth: the map's distance from "
      "it, and how much of it is mapped");
  command.add_option(
      "--trajectory", options->trajectories,
      "With a cloud: the trajectories (TUM) in its frame, in the order of --truth, which align it; "
      "without them it is taken to be in the frame of the mesh");
  command.add_option(
      "--jrl", options->log,
      "Writes the loops that the truth can judge as a JSON Robot Log (.jrl) with the truth of each "
      "keyframe and wrong loops labelled, so that any solver can be judged");
  command.footer(
      "Writes the class of each loop into loops.csv of the session, and the errors into its metrics.json.");
}

}  // namespace adit::app
