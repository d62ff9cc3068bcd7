// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
// What the doctor says of recordings made in memory; simulated drives are in tests/scenarios/doctor_test.cpp.
#include "adit/slam/doctor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "adit/core/angles.hpp"
#include "adit/io/mount.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "support/foreign_mcap.hpp"
#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

/// 8 s straight through a furnished room.
Recording straight_drive() {
  constexpr int kScans = 80;
  const test::Drive drive{Pose::planar(-5.0, 0.0, 0.0), {1.5, 0.0, 0.0, 0.0, 0.0, 0.0}};
  test::Lidar lidar{16, 360, 0.4, 100.0, 0.01};
  lidar.jitter = 0.5;
  Recording recording;
  recording.name = "walker";
  recording.T_base_lidar = Pose::translation_of(0.0, 0.0, 0.9);
  recording.mount_source = "recording.toml";
  for (int i = 0; i < kScans; ++i) {
    recording.scan_stamps.push_back(Stamp{lidar.period.count() * i});
    recording.wheel.push_back({recording.scan_stamps.back(), drive.at(0.1 * i)});
  }
  recording.read_scan = [=, mount = recording.T_base_lidar](std::size_t i) {
    return test::scan_of(test::furnished_room(), lidar, mount, drive, static_cast<int>(i));
  };
  return recording;
}

/// A figure of eight in the same room, by wheels and an IMU that share a clock, which the LiDAR's is behind.
Recording winding_drive(double lidar_late_s) {
  const auto at = [](double t) {
    const double yaw = std::atan2(1.2 * std::cos(0.8 * t), 1.2 * std::cos(0.4 * t));
    return Pose::planar(3.0 * std::sin(0.4 * t), 1.5 * std::sin(0.8 * t), yaw);
  };
  constexpr int kScans = 130;
  constexpr double kStep = 0.01;  // seconds between samples of the IMU
  test::Lidar lidar{16, 720, 0.4, 100.0, 0.01};
  lidar.jitter = 0.5;
  Recording recording = straight_drive();
  recording.scan_stamps.clear();
  recording.wheel.clear();
  for (int i = 0; i < kScans; ++i)
    recording.scan_stamps.push_back(Stamp{lidar.period.count() * i} + from_seconds(lidar_late_s));
  for (int i = -100; i < 10 * kScans + 100; ++i) {
    const double t = kStep * i;
    const Stamp stamp = Stamp{} + from_seconds(t);
    if (i % 5 == 0) recording.wheel.push_back({stamp, at(t)});
    const double turned = (at(t - kStep).inverse() * at(t + kStep)).yaw();
    recording.imu.push_back({stamp, Vector3(0.0, 0.0, turned / (2.0 * kStep)), Vector3(0.0, 0.0, 9.81)});
  }
  recording.imu_covariance.angular_velocity = recording.imu_covariance.specific_force =
      1e-4 * Matrix3::Identity();
  recording.read_scan = [=, mount = recording.T_base_lidar](std::size_t i) {
    const Stamp stamp{lidar.period.count() * static_cast<int>(i)};
    Scan scan = test::sweep(test::furnished_room(), lidar, mount, stamp,
                            [&](Duration offset) { return at(to_seconds(Duration(stamp.ns) + offset)); });
    scan.stamp = stamp + from_seconds(lidar_late_s);
    return scan;
  };
  return recording;
}

Diagnosis of(const Recording& recording, std::string_view check, RecordedAs as = RecordedAs::bag) {
  const Result<std::vector<Diagnosis>> all = diagnose(recording, {}, as);
  EXPECT_TRUE(all) << all.error().message;
  if (!all) return {};
  const auto found = std::ranges::find(*all, check, &Diagnosis::check);
  EXPECT_NE(found, all->end()) << check;
  return found == all->end() ? Diagnosis{} : *found;
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

TEST(DoctorInMemory, ALeverArmThatWasNotMeasuredIsNotCalledRight) {
  const Diagnosis turn = of(straight_drive(), "mount: turn and lever arm");
  EXPECT_EQ(turn.health, Health::good);
  EXPECT_TRUE(has(turn.sentence, "lever arm: too few turns to tell")) << turn.sentence;
}

TEST(DoctorInMemory, WhatSlamCannotMapIsAProblem) {
  const Recording good = straight_drive();
  EXPECT_EQ(of(good, "mapping").health, Health::good);
  Recording sparse = good;
  sparse.read_scan = [read = good.read_scan](std::size_t i) {
    return read(i).map([](Scan scan) {
      scan.cloud.points.resize(20);
      scan.cloud.intensities.clear();
      scan.cloud.time_offsets_ns.resize(20);
      return scan;
    });
  };
  const Diagnosis mapping = of(sparse, "mapping");
  EXPECT_EQ(mapping.health, Health::spoils);
  EXPECT_TRUE(has(mapping.sentence, "nothing can be mapped")) << mapping.sentence;
  EXPECT_TRUE(has(mapping.sentence, "the first has 20 points")) << mapping.sentence;
  EXPECT_TRUE(has(mapping.sentence, "by 62 of 80 scans")) << "stretches overlap: " << mapping.sentence;
  EXPECT_TRUE(has(mapping.remedy, "whole sweeps")) << mapping.remedy;
}

TEST(DoctorInMemory, WhereNothingCanBeMappedTheRemedyFitsTheReason) {
  const auto remedy_with = [](float scale, double min_range) {
    Recording recording = straight_drive();
    recording.scan_stamps.resize(20);
    recording.read_scan = [read = recording.read_scan, scale](std::size_t i) {
      return read(i).map([&](Scan scan) {
        for (Eigen::Vector3f& p : scan.cloud.points) p *= scale;
        return scan;
      });
    };
    RobotSlamConfig config;
    config.odometry.plane_icp.scan_to_map.min_range = min_range;
    const Result<std::vector<Diagnosis>> all = diagnose(recording, config);
    EXPECT_TRUE(all) << all.error().message;
    EXPECT_EQ(all->back().check, "mapping");
    EXPECT_EQ(all->back().health, Health::spoils) << all->back().sentence;
    return all->back().remedy;
  };
  EXPECT_TRUE(has(remedy_with(1000.0F, 0.0), "where these are in millimetres"));
  EXPECT_TRUE(has(remedy_with(1.0F, 90.0), "--set robot.odometry.plane_icp.min_range="));
}

TEST(DoctorInMemory, AClockThatWheelsAndImuShareIsComparedWithThatOfTheScans) {
  EXPECT_EQ(wheels_late_by_scans(winding_drive(0.0)), 0.0);
  const Diagnosis late = of(winding_drive(0.2), "wheels and IMU");
  EXPECT_EQ(late.health, Health::noted);
  EXPECT_TRUE(has(late.sentence, " s too early by the scans")) << late.sentence;
  EXPECT_NEAR(std::stod(late.sentence.substr(late.sentence.find("are ") + 4)), 0.2, 0.03) << late.sentence;
  EXPECT_TRUE(has(late.remedy, "recording.stamp_at")) << late.remedy;
}

TEST(DoctorInMemory, WheelsThatNothingWasComparedWithAreNotCalledSound) {
  Recording recording = straight_drive();
  recording.scan_stamps.resize(3);
  const Diagnosis wheels = of(recording, "wheels and IMU");
  EXPECT_EQ(wheels.health, Health::unknown);
  EXPECT_EQ(wheels.sentence, "too little motion to compare the wheels with the scans");
}

TEST(DoctorInMemory, OfScansThatComeSeldomTheStampsAreToBeChecked) {
  Recording recording = straight_drive();
  for (std::size_t i = 0; i < recording.num_scans(); ++i)
    recording.scan_stamps[i] = Stamp{static_cast<std::int64_t>(i) * 8'000'000'000};
  const Diagnosis measured = of(recording, "scans: missing");
  EXPECT_EQ(measured.health, Health::spoils);
  EXPECT_FALSE(has(measured.remedy, "faster disk")) << measured.remedy;
  recording.assumptions = {"stamps: the number in each name counts as seconds"};
  EXPECT_TRUE(has(of(recording, "scans: missing").remedy, "stamps.txt"));
}

TEST(DoctorInMemory, ScansThatWereLeftOutAreMissing) {
  Recording recording = straight_drive();
  EXPECT_EQ(of(recording, "scans: missing").health, Health::good);
  recording.num_scans_left_out = 1;
  EXPECT_EQ(of(recording, "scans: missing").health, Health::noted);
  recording.num_scans_left_out = 40;  // a third, and no gap between those that are left
  const Diagnosis missing = of(recording, "scans: missing");
  EXPECT_EQ(missing.health, Health::spoils);
  EXPECT_TRUE(has(missing.sentence, "40 missing (33.3 %)")) << missing.sentence;
  EXPECT_TRUE(has(missing.remedy, "where a clock jumped")) << missing.remedy;
}

TEST(DoctorInMemory, CloudsInMillimetresAreAProblem) {
  Recording recording = straight_drive();
  EXPECT_EQ(of(recording, "scans: range").health, Health::good);
  recording.read_scan = [read = recording.read_scan](std::size_t i) {
    return read(i).map([](Scan scan) {
      for (Eigen::Vector3f& p : scan.cloud.points) p *= 1000.0F;
      return scan;
    });
  };
  const Diagnosis range = of(recording, "scans: range");
  EXPECT_EQ(range.health, Health::spoils);
  EXPECT_TRUE(has(range.remedy, "millimetres")) << range.remedy;
}

/// The mount that a remedy names.
Pose mount_in(const std::string& remedy) {
  const std::size_t begin = remedy.find("--mount ") + 8;
  return parse_mount(remedy.substr(begin, remedy.find(' ', begin) - begin)).value_or(Pose());
}

TEST(DoctorInMemory, AMountThatLiesDownIsAProblem) {
  const Recording good = straight_drive();
  for (const double pitch : {-45.0, 90.0}) {
    Recording recording = good;
    const Eigen::AngleAxisd turn(pitch * kDegree, Vector3::UnitY());
    recording.T_base_lidar = Pose(Eigen::Quaterniond(turn), good.T_base_lidar.translation());
    const Result<std::vector<Diagnosis>> all = diagnose(recording);
    ASSERT_TRUE(all) << all.error().message;
    const Diagnosis tilt = *std::ranges::find(*all, "mount: tilt and height", &Diagnosis::check);
    EXPECT_EQ(tilt.health, Health::spoils) << pitch;
    EXPECT_TRUE(has(tilt.sentence, "by the motion between")) << tilt.sentence;
    const Pose error = good.T_base_lidar.inverse() * mount_in(tilt.remedy);
    EXPECT_LT(error.log().tail<3>().norm(), 3.0 * kDegree) << tilt.remedy;
    const Diagnosis yaw = *std::ranges::find(*all, "mount: turn and lever arm", &Diagnosis::check);
    EXPECT_EQ(yaw.health, Health::good) << "of the levelled mount: " << yaw.sentence;
  }
}

TEST(DoctorInMemory, SensorsThatAreMissingAreNotCalledNeedless) {
  Recording recording = straight_drive();
  EXPECT_EQ(of(recording, "IMU").health, Health::good);
  recording.wheel.clear();
  const Diagnosis imu = of(recording, "IMU");
  EXPECT_EQ(imu.health, Health::noted);
  EXPECT_FALSE(has(imu.sentence, "needs none")) << imu.sentence;
  EXPECT_TRUE(has(of(recording, "scans: the robot itself").sentence, "without wheels"));
  EXPECT_TRUE(has(of(recording, "wheels").remedy, "--wheel TOPIC"));
  // Folders of clouds take no topics.
  for (const char* check : {"wheels", "IMU"})
    EXPECT_FALSE(has(of(recording, check, RecordedAs::folder_of_clouds).remedy, "TOPIC")) << check;
  EXPECT_TRUE(has(of(recording, "wheels", RecordedAs::folder_of_clouds).remedy, "odometry.tum"));
}

TEST(DoctorInMemory, PointsOfOneTimeAreTheDriversFault) {
  Recording recording = straight_drive();
  recording.scan_stamps.resize(20);
  recording.read_scan = [read = recording.read_scan](std::size_t i) {
    return read(i).map([](Scan scan) {
      for (auto& offset : scan.cloud.time_offsets_ns) offset = 0;
      return scan;
    });
  };
  const Diagnosis times = of(recording, "scans: times of points");
  EXPECT_EQ(times.health, Health::spoils);
  EXPECT_TRUE(has(times.remedy, "let the driver write")) << times.remedy;
  EXPECT_FALSE(has(times.remedy, "--point-times")) << times.remedy;
}

TEST(DoctorInMemory, BlindSectorsAreInTheAxesOfTheRobot) {
  Recording recording = straight_drive();
  recording.scan_stamps.resize(20);
  Matrix3 R_base_optical;  // z ahead, x to the right, y down
  R_base_optical << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  recording.T_base_lidar = Pose(Eigen::Quaterniond(R_base_optical), recording.T_base_lidar.translation());
  recording.read_scan = [read = recording.read_scan, R_base_optical](std::size_t i) {
    return read(i).map([&](Scan scan) {
      PointCloud kept;
      for (std::size_t k = 0; k < scan.cloud.size(); ++k) {
        const Eigen::Vector3f& p = scan.cloud.points[k];
        if (std::atan2(p.y(), p.x()) >= 120.0 * kDegree) continue;
        kept.points.push_back(R_base_optical.transpose().cast<float>() * p);
        kept.time_offsets_ns.push_back(scan.cloud.time_offsets_ns[k]);
      }
      scan.cloud = kept;
      return scan;
    });
  };
  const Diagnosis view = of(recording, "scans: view");
  EXPECT_TRUE(has(view.sentence, "blind: 120 to 180 degrees (0 is ahead of the robot, 90 to its left)"))
      << view.sentence;
}

TEST(DoctorInMemory, WheelsThatMoveLittleAreNotCalledMissing) {
  Recording recording = straight_drive();
  for (StampedPose& pose : recording.wheel) pose.T_world_body = Pose();
  EXPECT_TRUE(has(of(recording, "scans: the robot itself").sentence, "moves less than 5 m"));
}

TEST(DoctorInMemory, AMountThatIsAssumedIsNotCalledKnown) {
  Recording recording = straight_drive();
  EXPECT_EQ(of(recording, "mount: source").health, Health::good);
  recording.mount_source = "assumed: the origin of the clouds";
  const Diagnosis source = of(recording, "mount: source");
  EXPECT_EQ(source.health, Health::noted);
  EXPECT_EQ(source.sentence, "0,0,0.9,0,0,0 (assumed: the origin of the clouds)");
  EXPECT_TRUE(has(source.remedy, "--mount"));
}

TEST(DoctorInMemory, ClocksThatRunApartAreFound) {
  const auto found_with = [](std::int64_t step_ns) {
    std::vector<Stamp> stamps;
    for (std::int64_t i = 0; i < 100; ++i) stamps.push_back({1'700'000'000'000'000'000 + i * step_ns});
    test::ForeignFile file;
    file.clouds("/points").odometry_stamped("/odom", stamps);
    return diagnose_clocks(open_mcap_bag(memory_source(file.bytes())).value(), {});
  };
  EXPECT_TRUE(found_with(50'000'000).empty());
  const std::vector<Diagnosis> clocks = found_with(75'000'000);  // recorded 50 ms apart
  ASSERT_EQ(clocks.size(), 1U);
  EXPECT_EQ(clocks[0].health, Health::noted);
  EXPECT_TRUE(clocks[0].sentence.starts_with("/odom was recorded from")) << clocks[0].sentence;
}

}  // namespace
}  // namespace adit
