// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// 300 real scans of a campus drive (NCLT), thinned unevenly and without per-point times; as one robot, and
/// its even and odd scans as two.
#include <gtest/gtest.h>

#include "adit/evaluation/ate.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/robot/robot_slam.hpp"
#include "support/data.hpp"
#include "support/meeting.hpp"

namespace adit {
namespace {

Recording nclt(const std::string& part) {
  Result<Recording> recording = open_recording(test::shared_data("scans/nclt").string() + part);
  EXPECT_TRUE(recording.has_value()) << recording.error().message;
  return recording.value_or(Recording{});
}

RobotSlamConfig lidar_alone() {
  RobotSlamConfig config;
  config.odometry.method = OdometryMethod::kiss_icp;
  return config;
}

TEST(Nclt, KissIcpFollowsUnevenStepsUnasked) {
  ADIT_NEED_DATA("scans/nclt/groundtruth.tum");
  const Recording recording = nclt("");
  ASSERT_EQ(recording.num_scans(), 300U);
  KissIcp odometry(lidar_alone().odometry.kiss_icp, recording.T_base_lidar);
  Trajectory estimate;
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const OdometryStep step = odometry.register_scan(recording.read_scan(i).value(), {});
    estimate.push_back({step.stamp, step.T_odom_base});
  }
  const Result<AteResult> error = ate(estimate, recording.truth);
  ASSERT_TRUE(error.has_value()) << error.error().message;
  EXPECT_LT(error->max_m, 1.5);  // 0.96 m over 201 m; 86 m without the second start
  EXPECT_LT(error->rmse_m, 0.8);
}

TEST(Nclt, EvenAndOddScansAreTwoRobotsThatThePapersPolicyMergesByCorrectLoopsOnly) {
  ADIT_NEED_DATA("scans/nclt/groundtruth.tum");
  const std::vector<Recording> recordings = {nclt("@even"), nclt("@odd")};
  const test::Joint joint = test::map_and_meet(recordings, lidar_alone(), test::paper());
  ASSERT_EQ(joint.solution.pairs.size(), 1U);
  ASSERT_TRUE(joint.solution.pairs[0].merged) << joint.solution.pairs[0].refused_reason;
  const LoopCounts loops = test::loops_in_use(joint, recordings);
  EXPECT_GE(loops.total, 30);
  EXPECT_EQ(loops.wrong(), 0);

  const auto joint_error =
      joint_ate(test::joint_trajectories(joint), std::vector{recordings[0].truth, recordings[1].truth});
  ASSERT_TRUE(joint_error.has_value()) << joint_error.error().message;
  // One alignment for both robots. The even scans hold a step at which their odometry slips by 5 m, and PCM
  // keeps the loops on the longer side of it, so that one error stays in the joint map and no other is added.
  double worst_alone = 0.0;
  double worst_joint = 0.0;
  for (std::size_t i = 0; i < 2; ++i) {
    const Result<AteResult> alone = ate(joint.maps[i]->odometry, recordings[i].truth);
    ASSERT_TRUE(alone.has_value()) << alone.error().message;
    worst_alone = std::max(worst_alone, alone->max_m);
    worst_joint = std::max(worst_joint, (*joint_error)[i].max_m);
  }
  EXPECT_LT(worst_joint, 1.5 * worst_alone);
}

TEST(Nclt, ByDefaultRobotsMergeThoughTheOdometryOfOneSlips) {
  ADIT_NEED_DATA("scans/nclt/groundtruth.tum");
  const std::vector<Recording> recordings = {nclt("@even"), nclt("@odd")};
  const test::Joint joint = test::map_and_meet(recordings, lidar_alone());
  ASSERT_TRUE(joint.solution.pairs.at(0).merged) << joint.solution.pairs[0].refused_reason;
  const LoopCounts used = test::loops_in_use(joint, recordings);
  EXPECT_GE(used.total, 30);
  EXPECT_EQ(used.wrong_registration, 0);
  EXPECT_EQ(used.wrong_place, 0);
  const auto errors =
      joint_ate(test::joint_trajectories(joint), std::vector{recordings[0].truth, recordings[1].truth});
  ASSERT_TRUE(errors.has_value()) << errors.error().message;
  // 1.17 m; the odometry of the even scans alone, with its slip, 2.20 m.
  EXPECT_LT((*errors)[0].rmse_m, 0.7 * ate(joint.maps[0]->odometry, recordings[0].truth).value().rmse_m);
}

}  // namespace
}  // namespace adit
