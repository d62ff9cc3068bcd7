// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/robot_slam.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "adit/core/decompositions.hpp"
#include "adit/core/rng.hpp"
#include "adit/robot/scan_checks.hpp"
#include "adit/robot/scan_loop.hpp"
#include "support/files.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

const Pose kBaseLidar = Pose::translation_of(0.0, 0.0, 0.9);
constexpr int kScans = 60;

test::Drive straight_drive() {
  test::Drive drive;
  drive.T_world_start = Pose::planar(-4.0, 0.0, 0.0);
  drive.velocity[0] = 1.5;
  return drive;
}

RobotSlamConfig config_of(OdometryMethod method) {
  RobotSlamConfig config;
  config.odometry.method = method;
  config.odometry.kiss_icp.scan_to_map.voxel_size = config.odometry.kinematic_icp.scan_to_map.voxel_size =
      0.5;
  return config;
}

test::Lidar dense_lidar() {
  test::Lidar lidar;
  lidar.rows = 64;
  lidar.columns = 512;
  lidar.jitter = 0.5;
  return lidar;
}

/// 6 s through a furnished room, about 7.5 m.
Recording room_recording(bool with_wheels) {
  Recording recording;
  recording.name = "walker";
  recording.T_base_lidar = kBaseLidar;
  const test::Lidar lidar = dense_lidar();
  Trajectory truth;
  for (int i = 0; i < kScans; ++i) {
    recording.scan_stamps.push_back(Stamp{lidar.period.count() * i});
    truth.push_back({recording.scan_stamps.back(), straight_drive().at(0.1 * i)});
  }
  recording.read_scan = [lidar](std::size_t i) {
    return test::scan_of(test::furnished_room(), lidar, kBaseLidar, straight_drive(), static_cast<int>(i));
  };
  if (with_wheels) recording.wheel = truth;
  recording.truth = std::move(truth);
  return recording;
}

void expect_sound(const RobotMap& map, const Recording& recording) {
  EXPECT_EQ(map.odometry.size(), recording.num_scans());
  ASSERT_GE(map.keyframes.size(), 5U);
  EXPECT_EQ(map.places.size(), map.keyframes.size());
  EXPECT_EQ(map.searchable.size(), map.keyframes.size());
  ASSERT_EQ(map.step_covariances.size(), map.keyframes.size());
  ASSERT_EQ(map.pose_noise.size(), map.keyframes.size());
  EXPECT_TRUE(map.step_covariances[0].isZero());
  const Pose T_odom_world = recording.truth.front().T_world_body.inverse();
  for (std::uint32_t k = 0; k < map.keyframes.size(); ++k) {
    const Keyframe& keyframe = map.keyframes[k];
    EXPECT_EQ(keyframe.id, (KeyframeId{{7}, k}));
    EXPECT_FALSE(keyframe.cloud->empty());
    EXPECT_FALSE(keyframe.cloud->has_times());
    const Pose T_true = T_odom_world * pose_at(recording.truth, keyframe.stamp).value();
    EXPECT_LT((T_true.translation() - keyframe.T_odom_base.translation()).norm(), 0.1) << k;
    if (k == 0) continue;
    const Pose step = map.keyframes[k - 1].T_odom_base.inverse() * keyframe.T_odom_base;
    EXPECT_GE(step.translation().norm(), KeyframePolicyConfig{}.distance_m - 1e-9);
    EXPECT_TRUE(is_positive_definite(map.step_covariances[k])) << k;
    EXPECT_TRUE(is_positive_definite(map.pose_noise[k])) << k;
  }
}

TEST(RobotSlam, MapsARoomWithEachOdometry) {
  for (const OdometryMethod method : kOdometryMethods) {
    const Recording recording = room_recording(true);
    const Result<RobotMap> map = map_recording(recording, {7}, config_of(method));
    ASSERT_TRUE(map.has_value()) << map.error().message;
    SCOPED_TRACE(to_string(method));
    expect_sound(*map, recording);
    EXPECT_EQ(map->num_refused, 0);
  }
}

// The wheels alone would have moved the robot on, and made keyframes of it.
TEST(RobotSlam, WithoutAScanThatIsRegisteredThereIsNoMap) {
  Recording recording = room_recording(true);
  recording.read_scan = [read = recording.read_scan](std::size_t i) {
    return read(i).map([](Scan scan) {
      scan.cloud.points.resize(40);
      scan.cloud.intensities.clear();
      scan.cloud.time_offsets_ns.resize(40);
      return scan;
    });
  };
  EXPECT_ERROR(map_recording(recording, {7}, config_of(OdometryMethod::plane_icp)),
               "none of 60 scans could be mapped");
}

TEST(RobotSlam, WithoutWheelsAndImuKissIcpStepsIn) {
  OdometryConfig config;
  EXPECT_FALSE(use_kiss_icp_without_sensors(room_recording(true), config));
  EXPECT_EQ(config.method, OdometryMethod::plane_icp);
  const std::optional<std::string> note = use_kiss_icp_without_sensors(room_recording(false), config);
  ASSERT_TRUE(note);
  EXPECT_EQ(*note,
            "walker: no wheel odometry in this recording, so kiss-icp (LiDAR alone) instead of plane-icp");
  EXPECT_EQ(config.method, OdometryMethod::kiss_icp);
  EXPECT_FALSE(use_kiss_icp_without_sensors(room_recording(false), config));
}

/// Points of the inner keyframes, each of which others look at from both sides, for which `is_meant` holds.
template <class Test>
std::size_t num_points(const RobotMap& map, const Test& is_meant) {
  std::size_t num = 0;
  for (std::size_t k = 1; k + 1 < map.keyframes.size(); ++k)
    num += static_cast<std::size_t>(std::ranges::count_if(map.keyframes[k].cloud->points, is_meant));
  return num;
}

TEST(RobotSlam, DustAndWhoWalksAheadLeaveTheMap) {
  const Recording clean = room_recording(false);
  Recording recording = clean;
  recording.read_scan = [](std::size_t i) {
    const test::Drive drive = straight_drive();
    test::Scene scene = test::furnished_room();
    const Vector3 person = drive.at(0.1 * static_cast<double>(i)).translation() + Vector3(3.0, 1.0, 0.0);
    scene.boxes.push_back({person + Vector3(-0.2, -0.2, 0.3), person + Vector3(0.2, 0.2, 2.0)});
    Scan scan = test::scan_of(scene, dense_lidar(), kBaseLidar, drive, static_cast<int>(i));
    Rng rng(i);
    for (Eigen::Vector3f& p : scan.cloud.points) {
      const auto range = static_cast<float>(rng.uniform(0.5, 1.4));
      if (rng.uniform() < 0.05) p *= range / p.norm();
    }
    return scan;
  };
  RobotSlamConfig config = config_of(OdometryMethod::kiss_icp);
  const Result<RobotMap> of_clean = map_recording(clean, {7}, config);
  const Result<RobotMap> map = map_recording(recording, {7}, config);
  config.confirm.min_neighbours = 0;
  config.confirm.min_share = 0.0;
  config.confirm.clear_m = 1000.0;
  const Result<RobotMap> believing = map_recording(recording, {7}, config);
  ASSERT_TRUE(of_clean.has_value() && map.has_value() && believing.has_value());
  ASSERT_GE(map->keyframes.size(), 5U);
  ASSERT_EQ(map->unconfirmed.size(), map->keyframes.size());
  // All returns are judged, and by these settings believed.
  for (const std::optional<float>& share : believing->unconfirmed) EXPECT_EQ(share.value(), 0.0F);
  for (const std::optional<float>& share : of_clean->unconfirmed) EXPECT_LT(share.value(), 0.01F);
  for (const std::optional<float>& share : map->unconfirmed) EXPECT_NEAR(share.value(), 0.055F, 0.015F);
  const auto is_person = [](const Eigen::Vector3f& p) {
    return std::abs(p.x() - 3.0F) < 0.3F && std::abs(p.y() - 1.0F) < 0.3F && p.z() > 0.5F && p.z() < 2.0F;
  };
  ASSERT_GT(num_points(*believing, is_person), 100U);
  EXPECT_LT(3 * num_points(*map, is_person), num_points(*believing, is_person));  // 180 of 695 stay
  const auto is_near = [&](const Eigen::Vector3f& p) {
    return (p.cast<double>() - map->viewpoint).norm() < 1.5;
  };
  const std::size_t walls = num_points(*of_clean, is_near);
  ASSERT_GT(num_points(*believing, is_near), walls + 1000U);
  EXPECT_LT(20 * (num_points(*map, is_near) - walls), num_points(*believing, is_near) - walls);
}

TEST(RobotSlam, AScanTooThinToBeJudgedIsNotSaidToBeClean) {
  RobotSlamConfig config = config_of(OdometryMethod::kiss_icp);
  config.confirm.window_deg = 0.1;  // doubled twice it holds one or two other returns, not twelve
  const Result<RobotMap> map = map_recording(room_recording(false), {7}, config);
  ASSERT_TRUE(map.has_value()) << map.error().message;
  ASSERT_GE(map->keyframes.size(), 5U);
  ASSERT_EQ(map->unconfirmed.size(), map->keyframes.size());
  for (const std::optional<float>& share : map->unconfirmed) EXPECT_FALSE(share);
}

TEST(RobotSlam, WheelsThatCountTwiceAreOneStretchOfSlip) {
  Recording recording = room_recording(true);
  EXPECT_TRUE(map_recording(recording, {7}, config_of(OdometryMethod::plane_icp))->slips.empty());
  for (std::size_t i = 20; i < recording.wheel.size(); ++i) {
    const Pose T_before = recording.truth[i - 1].T_world_body;
    const Pose T_step = T_before.inverse() * recording.truth[i].T_world_body;
    recording.wheel[i].T_world_body =
        recording.wheel[i - 1].T_world_body * (i < 40 ? T_step * T_step : T_step);
  }
  const Result<RobotMap> map = map_recording(recording, {7}, config_of(OdometryMethod::plane_icp));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  ASSERT_EQ(map->slips.size(), 1U);
  const SlipStretch& slip = map->slips[0];
  EXPECT_GE(slip.begin.ns, recording.scan_stamps[19].ns);
  EXPECT_LE(slip.begin.ns, recording.scan_stamps[25].ns);
  EXPECT_GE(slip.end.ns, recording.scan_stamps[38].ns);
  EXPECT_NEAR(slip.counted_m, 20 * 0.125, 1.0);  // the drive is 7.5 m in 60 scans
  // One prediction per scan but the first was tested, those of the burst's beginning badly.
  EXPECT_GT(map->innovations.size(), 50U);
}

TEST(RobotSlam, DamagedScansAreMappedAsScansWithoutPoints) {
  const Recording recording = room_recording(true);
  Recording damaged = recording;
  damaged.read_scan = [read = recording.read_scan](std::size_t i) -> Result<Scan> {
    if (i == 20 || i == 21) return fail("a byte has flipped");
    return read(i);
  };
  EXPECT_ERROR(map_recording(damaged, {7}, config_of(OdometryMethod::plane_icp)), "a byte has flipped");
  LeftOut left_out("scans");
  const Result<RobotMap> map =
      map_recording(with_damaged_scans_empty(damaged, left_out), {7}, config_of(OdometryMethod::plane_icp));
  ASSERT_TRUE(map) << map.error().message;
  EXPECT_EQ(left_out.sentence(), "2 of 60 scans are left out; the first, 20: a byte has flipped");
  EXPECT_EQ(map->num_refused, 2);
  expect_sound(*map, recording);
}

TEST(ScanChecks, DamagedScansAreCountedUnlessAllAre) {
  Recording recording = room_recording(true);
  EXPECT_FALSE(look_at_scans(recording, 20).value().damaged);
  recording.read_scan = [read = recording.read_scan](std::size_t i) -> Result<Scan> {
    if (i == 21 || i == 30) return fail("a byte has flipped");
    return read(i);
  };
  const ScansSeen seen = look_at_scans(recording, 20).value();
  EXPECT_EQ(seen.damaged, "2 of 20 scans looked at cannot be read; the first is scan 21: a byte has flipped");
  EXPECT_EQ(seen.num_scans, 18U);
  recording.read_scan = [](std::size_t) -> Result<Scan> { return fail("no disk"); };
  EXPECT_ERROR(look_at_scans(recording, 20), "walker: 20 of 20 scans looked at cannot be read");
}

TEST(RobotSlam, KeyframeCloudsLieInTheBaseFrame) {
  const Recording recording = room_recording(false);
  const Result<RobotMap> map = map_recording(recording, {7}, config_of(OdometryMethod::kiss_icp));
  ASSERT_TRUE(map.has_value()) << map.error().message;
  for (const Keyframe& keyframe : map->keyframes) {
    float lowest = 1e9F;
    for (const Eigen::Vector3f& p : keyframe.cloud->points) lowest = std::min(lowest, p.z());
    EXPECT_NEAR(lowest, -1.0F, 0.15F);  // the room's floor, in a frame whose origin drives 1 m above it
  }
}

TEST(RobotSlam, SeveralConfigurationsReadTheRecordingOnce) {
  const Recording recording = room_recording(true);
  const Result<std::vector<RobotMap>> maps = map_recording(
      recording, {7},
      std::vector{config_of(OdometryMethod::kinematic_icp), config_of(OdometryMethod::plane_icp)});
  ASSERT_TRUE(maps.has_value()) << maps.error().message;
  ASSERT_EQ(maps->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const RobotMap alone =
        map_recording(recording, {7},
                      config_of(i == 0 ? OdometryMethod::kinematic_icp : OdometryMethod::plane_icp))
            .value();
    ASSERT_EQ((*maps)[i].odometry.size(), alone.odometry.size());
    EXPECT_EQ((*maps)[i].odometry.back().T_world_body.matrix(), alone.odometry.back().T_world_body.matrix());
  }
}

TEST(RobotSlam, KinematicIcpWithoutWheelsIsRefusedWithTheRemedy) {
  const Result<RobotMap> map =
      map_recording(room_recording(false), {0}, config_of(OdometryMethod::kinematic_icp));
  ASSERT_FALSE(map.has_value());
  EXPECT_NE(map.error().message.find("walker"), std::string::npos);
  EXPECT_NE(map.error().message.find("kiss-icp"), std::string::npos);
}

TEST(RobotSlam, UnreadableScanNamesTheRobot) {
  Recording recording = room_recording(false);
  recording.read_scan = [](std::size_t) -> Result<Scan> { return fail("0003.pcd: no such file"); };
  const Result<RobotMap> map = map_recording(recording, {0}, config_of(OdometryMethod::kiss_icp));
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(map.error().message, "walker: 0003.pcd: no such file");
}

TEST(RobotSlam, ScansWithoutPointsBecomeNoKeyframe) {
  Recording recording = room_recording(false);
  recording.read_scan = [stamps = recording.scan_stamps](std::size_t i) { return Scan{stamps[i], {}}; };
  const Result<RobotMap> map = map_recording(recording, {0}, config_of(OdometryMethod::kiss_icp));
  ASSERT_FALSE(map.has_value());
  EXPECT_NE(map.error().message.find("too few points"), std::string::npos);
}

TEST(RobotSlam, ObserverCountsAndStops) {
  std::size_t last = 0;
  const Result<RobotMap> map = map_recording(room_recording(false), {0}, config_of(OdometryMethod::kiss_icp),
                                             [&](std::size_t num_done) {
                                               last = num_done;
                                               return num_done < 5;
                                             });
  ASSERT_FALSE(map.has_value());
  EXPECT_EQ(last, 5U);
  EXPECT_NE(map.error().message.find("interrupted"), std::string::npos);
}

TEST(RobotSlam, ConfigOutOfRangeIsABug) {
  RobotSlamConfig config = config_of(OdometryMethod::kiss_icp);
  config.cloud_voxel = -1.0;
  EXPECT_THROW(RobotSlam({0}, "walker", config, kBaseLidar), ContractViolation);
}

TEST(RobotSlam, TakesAnOdometryOfOnesOwn) {
  /// Believes the wheels and looks at no scan.
  class Wheels : public Odometry {
   public:
    OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) override {
      if (motion.wheel) step_.T_odom_base = step_.T_odom_base * motion.wheel->T_base0_base1;
      step_.stamp = scan.stamp;
      cloud_ = scan.cloud;
      return step_;
    }
    [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }

   private:
    OdometryStep step_;
    PointCloud cloud_;
  };
  const Recording recording = room_recording(true);
  RobotSlam robot({0}, "walker", RobotSlamConfig{}, kBaseLidar, std::make_unique<Wheels>());
  const Result<> done = for_each_scan(recording, [&](const Scan& scan, const SensedMotion& motion) {
    robot.process(scan, motion);
    return true;
  });
  ASSERT_TRUE(done) << done.error().message;
  const Pose T_wheels = recording.wheel.front().T_world_body.inverse() *
                        pose_at(recording.wheel, recording.scan_stamps.back()).value();
  const Pose T_start = recording.wheel.front().T_world_body.inverse() *
                       pose_at(recording.wheel, recording.scan_stamps.front()).value();
  EXPECT_LT(
      (robot.map().odometry.back().T_world_body.inverse() * (T_start.inverse() * T_wheels)).log().norm(),
      1e-6);
  EXPECT_GT(robot.map().keyframes.size(), 2U);
}

TEST(RobotSlam, WheelsMayBeSilentForAWhile) {
  Recording recording = room_recording(true);
  const Stamp begin = recording.scan_stamps[10];
  std::erase_if(recording.wheel, [&](const StampedPose& pose) {
    return pose.stamp > begin && pose.stamp < begin + std::chrono::milliseconds(1500);
  });
  ASSERT_FALSE(sensed_before(recording, 12).wheel.has_value());
  for (const OdometryMethod method : {OdometryMethod::kinematic_icp, OdometryMethod::plane_icp}) {
    SCOPED_TRACE(to_string(method));
    const Result<RobotMap> mapped = map_recording(recording, {7}, config_of(method));
    ASSERT_TRUE(mapped.has_value()) << mapped.error().message;
    expect_sound(*mapped, recording);
  }
}

TEST(SensedBefore, NoWheelsForTheFirstScanAndWithoutThem) {
  const Recording with = room_recording(true);
  EXPECT_FALSE(sensed_before(with, 0).wheel.has_value());
  EXPECT_FALSE(sensed_before(room_recording(false), 3).wheel.has_value());
  Recording late = room_recording(true);
  late.wheel.erase(late.wheel.begin(), late.wheel.begin() + 15);
  EXPECT_FALSE(sensed_before(late, 1).wheel.has_value());
  const std::optional<WheelDelta> delta = sensed_before(with, 30).wheel;
  ASSERT_TRUE(delta.has_value());
  EXPECT_EQ(delta->duration, std::chrono::milliseconds(100));
  EXPECT_GT(delta->T_base0_base1.translation().x(), 0.1);
}

TEST(SensedBefore, TheImuCoversTheIntervalOrIsSilent) {
  Recording recording = room_recording(false);
  EXPECT_TRUE(sensed_before(recording, 3).imu.empty());
  for (Stamp stamp = recording.scan_stamps.front(); stamp <= recording.scan_stamps[20];
       stamp = stamp + std::chrono::milliseconds(7))
    recording.imu.push_back({stamp, Vector3::Zero(), Vector3(0, 0, 9.81)});
  EXPECT_GT(sensed_before(recording, 0).imu.size(),
            50U);  // of the half second after it, as there is none before
  const std::vector<ImuSample> imu = sensed_before(recording, 3).imu;
  ASSERT_GT(imu.size(), 14U);
  EXPECT_LE(imu.front().stamp, recording.scan_stamps[2]);
  EXPECT_GT(imu[1].stamp, recording.scan_stamps[2]);
  EXPECT_GE(imu.back().stamp, recording.scan_stamps[3]);
  EXPECT_LT(imu[imu.size() - 2].stamp, recording.scan_stamps[3]);
  EXPECT_TRUE(sensed_before(recording, 21).imu.empty());  // it ends before
  std::erase_if(recording.imu, [&](const ImuSample& sample) {
    return sample.stamp > recording.scan_stamps[9] + std::chrono::milliseconds(10) &&
           sample.stamp < recording.scan_stamps[11];
  });
  EXPECT_FALSE(sensed_before(recording, 9).imu.empty());
  EXPECT_TRUE(sensed_before(recording, 10).imu.empty());
  EXPECT_TRUE(sensed_before(recording, 11).imu.empty());
}

}  // namespace
}  // namespace adit
