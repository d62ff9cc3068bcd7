// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/frame_tracks.hpp"

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/foreign_mcap.hpp"

namespace adit {
namespace {

using test::ForeignFile;

ros::TransformMessage link_at(const std::string& parent, const std::string& child, Stamp stamp,
                              const Pose& pose) {
  return {parent, child, {stamp, pose}};
}

Stamp after_start(double seconds) { return test::make_scan(0, 0).stamp + from_seconds(seconds); }

double distance(const Pose& a, const Pose& b) { return (a.inverse() * b).log().norm(); }

/// A mast that turns by one radian a second, and a head on it that nods.
const Pose kHead = Pose::translation_of(0.1, 0, 0.4);
Pose mast_at(double seconds) { return Pose::planar(0.5, 0, seconds, 1.2); }
Pose nod_at(double seconds) {
  return {Eigen::Quaterniond(Eigen::AngleAxisd(0.3 * seconds, Vector3::UnitY())), kHead.translation()};
}

FrameTracks mast() {
  FrameTracks tracks("base_link", {"lidar"});
  tracks.add_static({test::link("head", "lidar", kHead)});
  for (int i = 0; i <= 100; ++i) {
    const double t = 0.02 * i;
    tracks.add({link_at("base_link", "mast", after_start(t), mast_at(t)),
                link_at("mast", "head", after_start(t), nod_at(t)),
                link_at("odom", "base_link", after_start(t), Pose::translation_of(t, 0, 0)),
                link_at("base_link", "wheel", after_start(t), Pose::planar(0, 0, 9 * t))});
  }
  return tracks;
}

TEST(FrameTracks, AChainIsInterpolatedLinkByLink) {
  const FrameTracks tracks = mast();
  const auto chain = tracks.tree().between("base_link", "lidar");
  ASSERT_TRUE(chain) << chain.error().message;
  EXPECT_EQ(chain->frames, (std::vector<std::string>{"base_link", "mast", "head", "lidar"}));
  EXPECT_FALSE(tracks.are_static(chain->frames));
  EXPECT_TRUE(tracks.are_static({"head", "lidar"}));
  const MovingPose moving = tracks.along(chain->frames);
  EXPECT_TRUE(moving.moves());
  for (const double t : {0.0, 0.013, 0.5, 1.234, 2.0}) {
    ASSERT_TRUE(moving.at(after_start(t))) << t;
    EXPECT_LT(distance(*moving.at(after_start(t)), mast_at(t) * nod_at(t) * kHead), 1e-9) << t;
  }
  EXPECT_FALSE(moving.at(after_start(-0.001)));
  EXPECT_FALSE(moving.at(after_start(2.001)));
  const MovingPose back = tracks.along({"lidar", "head", "mast", "base_link"});
  EXPECT_LT(distance(*back.at(after_start(0.5)), moving.at(after_start(0.5))->inverse()), 1e-12);
}

TEST(FrameTracks, ALinkFromAFrameToItselfSaysNothing) {
  FrameTracks tracks("base_link", {"lidar"});
  tracks.add_static({test::link("base_link", "lidar", kHead), test::link("lidar", "lidar", Pose())});
  const MovingPose T_base_lidar = tracks.along({"base_link", "lidar"});
  EXPECT_LT(distance(*T_base_lidar.at(after_start(0.0)), kHead), 1e-12);
}

// One message whose clock was not set yet does not freeze the link.
TEST(FrameTracks, StampsMayGoBack) {
  FrameTracks tracks("base_link", {"lidar"});
  tracks.add({link_at("base_link", "lidar", after_start(1e6), mast_at(0.0))});
  for (int i = 0; i <= 10; ++i)
    tracks.add({link_at("base_link", "lidar", after_start(0.1 * i), mast_at(0.1 * i))});
  const MovingPose T_base_lidar = tracks.along({"base_link", "lidar"});
  ASSERT_TRUE(T_base_lidar.moves());
  EXPECT_LT(distance(*T_base_lidar.at(after_start(0.5)), mast_at(0.5)), 1e-9);
}

TEST(FrameTracks, WhatCarriesTheRobotIsLeftOut) {
  const FrameTracks tracks = mast();
  EXPECT_EQ(tracks.tree().frames(),
            (std::vector<std::string>{"base_link", "head", "lidar", "mast", "wheel"}));
  FrameTracks unnamed("", {"lidar"});
  unnamed.add({link_at("robot/odom", "robot/base_link", after_start(0), Pose()),
               link_at("robot/base_link", "lidar", after_start(0), Pose())});
  EXPECT_EQ(unnamed.tree().body_of("lidar"), "robot/base_link");
  FrameTracks underscored("", {"lidar"});
  underscored.add({link_at("robot_odom", "robot_base_link", after_start(0), Pose()),
                   link_at("robot_base_link", "lidar", after_start(0), Pose())});
  EXPECT_EQ(underscored.tree().body_of("lidar"), "robot_base_link");
  FrameTracks other("base", {"lidar"});
  other.add(
      {link_at("start", "base", after_start(0), Pose()), link_at("start", "lidar", after_start(0), Pose())});
  EXPECT_FALSE(other.tree().between("base", "lidar"));
}

TEST(FrameTracks, SilencesCountWhereTheLinkMoved) {
  FrameTracks tracks("base", {"lidar"});
  const auto put = [&](double t, double angle) {
    tracks.add({link_at("base", "lidar", after_start(t), Pose::planar(0, 0, angle))});
  };
  put(0.0, 0.0);
  put(0.4, 0.1);
  put(2.0, 0.1);  // it stood
  put(2.1, 0.2);
  put(4.0, 0.5);  // it moved
  const MovingPose moving = tracks.along({"base", "lidar"});
  EXPECT_TRUE(moving.at(after_start(0.2)));
  EXPECT_TRUE(moving.at(after_start(1.0)));
  EXPECT_FALSE(moving.at(after_start(3.0)));
  EXPECT_TRUE(moving.at(after_start(4.0)));
}

TEST(FrameTracks, ALinkThatNeverMovesHoldsForAllTimes) {
  FrameTracks tracks("base", {"lidar"});
  for (int i = 0; i < 1000; ++i)
    tracks.add({link_at("base", "lidar", after_start(i), Pose::planar(0.3, 0, 1e-5 * (i % 2), 0.9))});
  const MovingPose still = tracks.along({"base", "lidar"});
  EXPECT_FALSE(still.moves());
  EXPECT_TRUE(still.at(after_start(-100)));
}

TEST(FrameTracks, StaticLinksGoFirst) {
  FrameTracks tracks("base", {"lidar"});
  tracks.add_static({test::link("base", "lidar", kHead)});
  tracks.add({link_at("map", "lidar", after_start(0), Pose()),
              link_at("base", "lidar", after_start(1), Pose()),
              link_at("vicon", "lidar", after_start(1), Pose())});
  const auto chain = tracks.tree().between("base", "lidar");
  ASSERT_TRUE(chain);
  EXPECT_LT(distance(chain->T_a_b, kHead), 1e-12);
  EXPECT_FALSE(tracks.along(chain->frames).moves());
}

/// Clouds of three points that stand around the robot, from a LiDAR on the mast: each point as it is seen at
/// its own time.
const std::vector<Vector3> kSeen = {{5, 1, 0}, {-3, 4, 1}, {0, -6, 2}};
std::vector<std::pair<Stamp, std::string>> clouds_from_the_mast(int num) {
  std::vector<std::pair<Stamp, std::string>> clouds;
  for (int i = 0; i < num; ++i) {
    Scan scan{after_start(0.1 * i), {}};
    for (std::size_t k = 0; k < kSeen.size(); ++k) {
      const double t = 0.1 * i - 0.02 * static_cast<double>(k);
      const Pose T_base_lidar = mast_at(std::max(t, 0.0)) * kHead;
      scan.cloud.points.push_back((T_base_lidar.inverse() * kSeen[k]).cast<float>());
      scan.cloud.time_offsets_ns.push_back(-20'000'000 * static_cast<std::int32_t>(k));
    }
    clouds.emplace_back(scan.stamp, ros::encode_cloud(scan, "lidar"));
  }
  return clouds;
}

std::vector<ros::TransformMessage> mast_links(double until) {
  std::vector<ros::TransformMessage> links;
  for (double t = 0.0; t <= until + 1e-9; t += 0.01)
    links.push_back(link_at("base_link", "mast", after_start(t), mast_at(t)));
  return links;
}

ForeignFile file_with_mast(const std::string& tf = "/tf") {
  ForeignFile file;
  file.cloud_messages("/points", clouds_from_the_mast(10), Duration(5'000'000))
      .odometry("/odom")
      .links({test::link("mast", "lidar", kHead)}, tf + "_static")
      .moving_links(mast_links(0.75), tf);
  return file;
}

TEST(MovingLidar, ScansAreGivenAsFromOnePlace) {
  const Result<Recording> recording = file_with_mast().read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_LT(distance(recording->T_base_lidar, mast_at(0.0) * kHead), 1e-9);
  EXPECT_FALSE(recording->clouds_in_mount_frame);
  EXPECT_NE(recording->mount_source.find("/tf: base_link -> mast -> lidar, which moves"), std::string::npos);
  ASSERT_EQ(recording->num_scans(), 8U);  // two came after the last link
  ASSERT_EQ(recording->warnings.size(), 1U);
  EXPECT_NE(recording->warnings[0].find("2 of 10 scans are left out"), std::string::npos)
      << recording->warnings[0];
  for (std::size_t i = 0; i < recording->num_scans(); ++i) {
    const Result<Scan> scan = recording->read_scan(i);
    ASSERT_TRUE(scan) << scan.error().message;
    for (std::size_t k = i == 0 ? kSeen.size() : 0; k < kSeen.size(); ++k) {
      const Vector3 seen = recording->T_base_lidar * scan->cloud.points[k].cast<double>();
      EXPECT_LT((seen - kSeen[k]).norm(), 1e-3) << i << " " << k;
    }
  }
}

TEST(MovingLidar, AMountThatIsGivenIsTaken) {
  const Result<Recording> recording = file_with_mast().read({.mount = "1,2,3"});
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_EQ(recording->num_scans(), 10U);
  EXPECT_EQ(recording->T_base_lidar.translation(), Vector3(1, 2, 3));
  EXPECT_TRUE(recording->clouds_in_mount_frame);
  EXPECT_EQ(recording->read_scan(3)->cloud.points[0],
            ros::decode_cloud(clouds_from_the_mast(4).back().second)->scan.cloud.points[0]);
}

TEST(MovingLidar, TopicsOfLinksCanBeChosen) {
  ForeignFile file = file_with_mast("/robot/tf");
  file.links({test::link("mast", "lidar", Pose())}, "/other/tf_static");
  EXPECT_LT(distance(file.read({.tf = "/robot/tf"})->T_base_lidar, mast_at(0.0) * kHead), 1e-9);
  EXPECT_ERROR(file.read({.tf = "/other/tf_static"}),
               "no links connect 'base_link' and 'lidar' (frames that it links: lidar, mast)");
  EXPECT_ERROR(file.read({.tf = "/tf"}),
               "no topic of links between frames (TFMessage) '/tf'; there are: "
               "/robot/tf_static, /robot/tf, /other/tf_static");
}

TEST(MovingLidar, AnImuThatMovesIsLeftOut) {
  ForeignFile file = file_with_mast();
  ros::ImuMessage imu;
  imu.frame = "lidar";
  imu.sample.stamp = after_start(0);
  imu.sample.specific_force = {0, 0, 9.81};
  file.imu("/imu", {imu});
  const Result<Recording> recording = file.read();
  ASSERT_TRUE(recording) << recording.error().message;
  EXPECT_TRUE(recording->imu.empty());
  ASSERT_FALSE(recording->assumptions.empty());
  EXPECT_NE(recording->assumptions.back().find("it moves on the robot"), std::string::npos);
  EXPECT_EQ(file.read({.imu_mount = "0,0,1"})->imu.size(), 1U);
}

TEST(MovingLidar, WithoutALinkAtAnyScanItIsAnError) {
  ForeignFile file;
  file.clouds("/points", "lidar")
      .odometry("/odom")
      .moving_links({link_at("base_link", "lidar", after_start(-9), Pose()),
                     link_at("base_link", "lidar", after_start(-8), kHead)});
  EXPECT_ERROR(file.read(), "/tf never says where it was at a scan's time");
}

}  // namespace
}  // namespace adit
