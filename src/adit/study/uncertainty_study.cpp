// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/uncertainty_study.hpp"

#include <algorithm>

#include "adit/core/angles.hpp"
#include "adit/core/decompositions.hpp"
#include "adit/core/format.hpp"
#include "adit/evaluation/ate.hpp"
#include "adit/fleet/joint/merge_accuracy.hpp"
#include "adit/posegraph/chordal.hpp"
#include "adit/posegraph/gnc.hpp"
#include "adit/posegraph/marginals.hpp"
#include "adit/report/reliability_plot.hpp"
#include "adit/slam/meeting.hpp"

namespace adit {
namespace {

constexpr double kRightPlace = 2.0;  // metres: what a registration that found the place may be off
constexpr double kRightTurn = 10.0;  // degrees
constexpr double kEvery = 10.0;      // metres between the poses that are compared; nearer ones err alike

/// A robot's keyframes where its odometry has them, and where the truth has the base as the LiDAR is taken to
/// be mounted on it.
struct Placed {
  StatedPath path;
  std::vector<Pose> truth;
};

/// By how much the LiDAR is turned on its mount against what the robot takes it for. All poses share that,
/// and no path is longer or more bent for it: it is the rotation that is left, in the mean, where the
/// positions fit best.
Result<Pose> turn_of_mount(const Trajectory& estimate, const Trajectory& truth) {
  const Result<AteResult> fit = ate(estimate, truth);
  if (!fit) return tl::unexpected(fit.error());
  Matrix3 sum = Matrix3::Zero();
  for (const StampedPose& pose : estimate) {
    const Result<Pose> T_world_base = pose_at(truth, pose.stamp);
    if (T_world_base)
      sum += T_world_base->rotation_matrix().transpose() *
             (fit->T_world_estimate * pose.T_world_body).rotation_matrix();
  }
  return Pose(nearest_rotation(Matrix3(sum / static_cast<double>(estimate.size()))), Vector3::Zero());
}

Result<Placed> placed(const RobotRun& run) {
  Trajectory estimate;
  for (const Keyframe& keyframe : run.map->keyframes)
    estimate.push_back({keyframe.stamp, keyframe.T_odom_base});
  const Result<Pose> turn = turn_of_mount(estimate, run.truth);
  if (!turn) return fail(run.result.name, turn.error());
  Placed out;
  for (const Keyframe& keyframe : run.map->keyframes) {
    const Result<Pose> T_world_base = pose_at(run.truth, keyframe.stamp);
    if (!T_world_base) return fail(run.result.name, T_world_base.error());
    out.path.T_odom_keyframe.push_back(keyframe.T_odom_base);
    out.truth.push_back(*T_world_base * *turn);
  }
  out.path.step_covariances = run.map->step_covariances;
  out.path.pose_noise = run.map->pose_noise;
  return out;
}

Calibration& of_source(std::vector<UncertaintyRow>& rows, const std::string& source) {
  const auto found = std::ranges::find(rows, source, &UncertaintyRow::source);
  return found != rows.end() ? found->calibration : rows.emplace_back(UncertaintyRow{source, {}}).calibration;
}

void add_odometry(const Placed& placed, std::vector<UncertaintyRow>& rows) {
  for (const double metres : {1.0, 10.0, 50.0})
    of_source(rows, format("odometry over {:.0f} m", metres))
        .add(edge_calibration(placed.path, placed.truth, metres));
}

bool is_right(const Vector6& error) {
  return error.head<3>().norm() < kRightPlace && error.tail<3>().norm() < kRightTurn * kDegree;
}

void add_loops(const FleetGraph& known, const std::vector<Placed>& robots,
               std::vector<UncertaintyRow>& rows) {
  Calibration& as_registered = of_source(rows, "loops");
  for (const auto& [pair, loop] : known.loops) {
    if (loop.verdict != LoopVerdict::accepted) continue;
    const Placed& from = robots[loop.from.robot.value];
    const Placed& to = robots[loop.to.robot.value];
    const Pose T_true = from.truth[loop.from.index].inverse() * to.truth[loop.to.index];
    const Vector6 error = (loop.T_from_to.inverse() * T_true).log();
    if (!is_right(error)) continue;
    // A loop is measured between the clouds, which share the noise of their keyframes' poses.
    const std::optional<Matrix6> covariance = inverse_of_positive_definite(loop.information);
    as_registered.add(error, covariance ? with_pose_noise(*covariance, loop.T_from_to,
                                                          from.path.pose_noise[loop.from.index],
                                                          to.path.pose_noise[loop.to.index])
                                        : Matrix6(Matrix6::Zero()));
  }
}

void add_innovations(const RobotMap& map, std::vector<UncertaintyRow>& rows) {
  Calibration& innovations = of_source(rows, "innovations");
  for (const float innovation : map.innovations) innovations.add_normalised(6.0 * innovation);
}

// What `slam` prints and saves of each merge.
void add_frames(const FleetSolution& solution, const std::vector<Placed>& robots,
                std::vector<UncertaintyRow>& rows) {
  Calibration& frames = of_source(rows, "frames between robots");
  for (const PairOutcome& pair : solution.pairs) {
    if (!pair.accuracy) continue;
    const KeyframeId from = pair.accuracy->from;
    const KeyframeId to = pair.accuracy->to;
    const Placed& a = robots[from.robot.value];
    const Placed& b = robots[to.robot.value];
    const Pose T_from_to = solution.T_world_keyframe.at(from.robot)[from.index].inverse() *
                           solution.T_world_keyframe.at(to.robot)[to.index];
    const Pose T_true = a.truth[from.index].inverse() * b.truth[to.index];
    frames.add((T_from_to.inverse() * T_true).log(),
               with_pose_noise(pair.accuracy->covariance, T_from_to, a.path.pose_noise[from.index],
                               b.path.pose_noise[to.index]));
  }
}

// In the frame of the first keyframe of the map's anchor, which is held fixed.
void add_final_poses(const FleetSolution& solution, const std::vector<Placed>& robots,
                     std::vector<UncertaintyRow>& rows) {
  Calibration& finals = of_source(rows, "final poses");
  const Result<Marginals<Pose>> marginals = Marginals<Pose>::compute(solution.optimized);
  if (!marginals) return;
  std::size_t first_node = 0;
  for (const auto& [robot, poses] : solution.T_world_keyframe) {
    const auto holds_robot = [id = robot](const Component& component) {
      return std::ranges::find(component.robots, id) != component.robots.end();
    };
    const Component& map = *std::ranges::find_if(solution.components, holds_robot);
    const Placed& anchor = robots[map.anchor.value];
    const Placed& here = robots[robot.value];
    const Pose T_anchor_world = solution.T_world_keyframe.at(map.anchor).front().inverse();
    Vector3 last = poses.front().translation();
    for (std::size_t k = 1; k < poses.size(); ++k) {
      if (map.robots.size() < 2 || (poses[k].translation() - last).norm() < kEvery) continue;
      last = poses[k].translation();
      const Pose T_anchor_k = T_anchor_world * poses[k];
      const Pose T_true = anchor.truth.front().inverse() * here.truth[k];
      finals.add((T_anchor_k.inverse() * T_true).log(),
                 with_pose_noise(marginals->covariance(first_node + k), T_anchor_k,
                                 anchor.path.pose_noise.front(), here.path.pose_noise[k]));
    }
    first_node += poses.size();
  }
}

}  // namespace

Result<std::vector<UncertaintyRow>> measure_world(const UncertaintyStudy& study, const ListedWorld& world) {
  const Result<std::vector<RobotRun>> runs =
      driven_robots(world, study.config, {KeyframeSelection::adaptive}, study.folder / "maps");
  if (!runs) return tl::unexpected(runs.error());
  std::vector<UncertaintyRow> rows;
  std::vector<Placed> robots;
  std::vector<std::shared_ptr<const RobotMap>> maps;
  for (const RobotRun& run : *runs) {
    const Result<Placed> here = placed(run);
    if (!here) return tl::unexpected(here.error());
    add_odometry(*here, rows);
    add_innovations(*run.map, rows);
    robots.push_back(*here);
    maps.push_back(run.map);
  }
  const SlamConfig config = with_policy(KeyframeSelection::adaptive, study.config).slam;
  const Result<Meeting> meeting = hold_meeting(maps, config);
  if (!meeting) return tl::unexpected(meeting.error());
  add_loops(meeting->agents.front().known(), robots, rows);
  FleetSolution solution = meeting->agents.front().solve(config.back_end);
  measure_merges(solution);
  add_frames(solution, robots, rows);
  add_final_poses(solution, robots, rows);
  return rows;
}

void join(std::vector<UncertaintyRow>& rows, const std::vector<UncertaintyRow>& more) {
  for (const UncertaintyRow& row : more) of_source(rows, row.source).add(row.calibration);
}

double share_beyond_one_in_a_thousand(const Calibration& calibration) {
  return calibration.share_beyond(chi2_quantile(0.999, 6));
}

Table uncertainty_table(const MeasuredUncertainty& measured) {
  Table table;
  table.title = "Stated and true uncertainty: " + measured.sensors;
  table.caption =
      "Normalised error squared over its dimension: 1 is true, more is too confident, less too cautious. "
      "Axes "
      "are those of the robot: along, across, up, roll, pitch, heading.";
  table.header = {"source", "number", "rms m", "rms deg", "all",     "along",
                  "across", "up",     "roll",  "pitch",   "heading", "beyond 99.9 %"};
  for (const UncertaintyRow& row : measured.rows) {
    const Calibration& c = row.calibration;
    std::vector<std::string> cells = {row.source, format("{}", c.count())};
    cells.resize(table.header.size(), "-");
    if (c.has_axes()) {
      const Vector6 rms = c.rms();
      cells[2] = format("{:.3f}", rms.head<3>().norm());
      cells[3] = format("{:.3f}", rms.tail<3>().norm() / kDegree);
      for (std::size_t k = 0; k < 6; ++k)
        cells[5 + k] = format("{:.2f}", c.mean_of_axes()[static_cast<Eigen::Index>(k)]);
    }
    if (c.count() > 0) {
      cells[4] = format("{:.2f}", c.mean());
      cells[11] = format("{:.1f} %", 100.0 * share_beyond_one_in_a_thousand(c));
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

std::string uncertainty_plot(const std::vector<UncertaintyRow>& rows) {
  std::vector<ReliabilityCurve> curves;
  for (const UncertaintyRow& row : rows) {
    if (row.calibration.count() == 0) continue;
    ReliabilityCurve curve{row.source, {}};
    for (int percent = 0; percent <= 100; percent += 2) {
      const double claimed = std::clamp(0.01 * percent, 0.0, 0.999);
      const double bound = percent == 0 ? 0.0 : chi2_quantile(claimed, 6);
      curve.points.emplace_back(claimed, 1.0 - row.calibration.share_beyond(bound));
    }
    curves.push_back(std::move(curve));
  }
  return plot_reliability(curves);
}

}  // namespace adit
