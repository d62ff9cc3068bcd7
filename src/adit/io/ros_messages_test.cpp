// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/ros_messages.hpp"

#include <gtest/gtest.h>

#include "adit/io/cdr.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

Scan small_scan() {
  Scan scan{{1'700'000'000'123'456'789}, {}};
  for (int i = 0; i < 5; ++i) {
    scan.cloud.points.emplace_back(0.1F * static_cast<float>(i), -1.0F, 1.5F);
    scan.cloud.intensities.push_back(static_cast<float>(10 * i));
    scan.cloud.time_offsets_ns.push_back(-1000 * i);
  }
  return scan;
}

TEST(RosMessages, EveryTruncationIsAnError) {
  const std::string cloud = ros::encode_cloud(small_scan(), "lidar");
  // The last byte is is_dense, which is not needed.
  for (std::size_t size = 0; size + 1 < cloud.size(); ++size)
    EXPECT_FALSE(ros::decode_cloud(cloud.substr(0, size)));
  const std::string transforms = ros::encode_transforms({{"a", "b", {{5}, Pose::planar(1, 2, 3)}}});
  for (std::size_t size = 0; size < transforms.size(); ++size) {
    EXPECT_FALSE(ros::decode_transforms(transforms.substr(0, size)));
  }
  const std::string odometry = ros::encode_odometry({{"a", "b", {{5}, Pose::planar(1, 2, 3)}}});
  for (std::size_t size = 0; size < odometry.size(); ++size)
    EXPECT_FALSE(ros::decode_odometry(odometry.substr(0, size))) << size;
}

/// Laid out by hand from the definition of CustomMsg: header, timebase, point_num, lidar_id, rsvd[3], points
/// of offset_time x y z reflectivity tag line.
TEST(RosMessages, LivoxCustomMessagesAreClouds) {
  constexpr std::uint32_t kNum = 3;
  CdrWriter cdr;
  std::string ros1;
  const auto put = [&](auto value) {
    cdr.number(value);
    append_little_endian(ros1, value);
  };
  append_little_endian(ros1, std::uint32_t{7});  // ROS 1 counts its headers
  put(std::int32_t{1'700'000'000});
  put(std::uint32_t{500});
  cdr.text("livox_frame");
  append_little_endian(ros1, std::uint32_t{11});
  ros1 += "livox_frame";
  put(std::uint64_t{1'700'000'000'000'000'500});
  put(kNum);
  for (int i = 0; i < 4; ++i) put(std::uint8_t{0});
  put(kNum);
  for (std::uint32_t i = 0; i < kNum; ++i) {
    put(i * 10'000);
    for (const float value : {1.0F + static_cast<float>(i), -2.0F, 0.5F}) put(value);
    for (const std::uint8_t value : {static_cast<std::uint8_t>(100 + i), std::uint8_t{16}, std::uint8_t{2}})
      put(value);
  }
  const std::string of_ros2 = cdr.take();
  for (const auto& [message, encoding] :
       {std::pair(of_ros2, MessageEncoding::cdr), {ros1, MessageEncoding::ros1}}) {
    const Result<ros::CloudMessage> cloud = ros::decode_livox(message, encoding);
    ASSERT_TRUE(cloud) << cloud.error().message;
    EXPECT_EQ(cloud->frame, "livox_frame");
    EXPECT_EQ(cloud->scan.stamp.ns, 1'700'000'000'000'000'500);
    ASSERT_EQ(cloud->scan.cloud.size(), kNum);
    EXPECT_EQ(cloud->scan.cloud.points[2], Eigen::Vector3f(3.0F, -2.0F, 0.5F));
    EXPECT_EQ(cloud->scan.cloud.intensities[2], 102.0F);
    EXPECT_EQ(cloud->scan.cloud.time_offsets_ns, std::vector<std::int32_t>({0, 10'000, 20'000}));
    for (std::size_t size = 0; size < 120 && size < message.size() - 2; ++size)
      EXPECT_FALSE(ros::decode_livox(message.substr(0, size), encoding)) << size;
  }
}

/// A CustomMsg of ROS 1 with a point a hundredth of a second, ten of them.
std::string livox_sweep(Stamp stamp, std::uint64_t time_base) {
  std::string bytes;
  append_little_endian(bytes, std::uint32_t{7});
  append_little_endian(bytes, static_cast<std::uint32_t>(stamp.ns / 1'000'000'000));
  append_little_endian(bytes, static_cast<std::uint32_t>(stamp.ns % 1'000'000'000));
  append_little_endian(bytes, std::uint32_t{1});
  bytes += "l";
  append_little_endian(bytes, time_base);
  for (const std::uint32_t number : {10U, 0U, 10U}) append_little_endian(bytes, number);
  for (std::uint32_t i = 0; i < 10; ++i) {
    append_little_endian(bytes, 10'000'000 * i);
    for (const float value : {1.0F, 2.0F, 3.0F}) append_little_endian(bytes, value);
    bytes.append(3, '\0');
  }
  return bytes;
}

TEST(RosMessages, TimesOfLivoxHaveTheFieldOfTheirDefinition) {
  const Stamp stamp{1'700'000'000'000'000'000};
  const std::string sweep = livox_sweep(stamp, static_cast<std::uint64_t>(stamp.ns));
  EXPECT_TRUE(ros::decode_livox(sweep, MessageEncoding::ros1, {.field = "offset_time"}));
  EXPECT_ERROR(ros::decode_livox(sweep, MessageEncoding::ros1, {.field = "timestamp"}),
               "the fields are: offset_time, x, y, z, reflectivity, tag, line");
}

TEST(RosMessages, TimesOfLivoxCountFromTheTimeBase) {
  constexpr std::int64_t kStamp = 1'700'000'000'500'000'000;
  const auto first_time = [](std::int64_t time_base) {
    const Result<ros::CloudMessage> cloud = ros::decode_livox(
        livox_sweep({kStamp}, static_cast<std::uint64_t>(time_base)), MessageEncoding::ros1);
    EXPECT_TRUE(cloud) << cloud.error().message;
    const std::vector<std::int32_t> times = cloud->scan.cloud.time_offsets_ns;
    EXPECT_EQ(times.back() - times.front(), 90'000'000);
    return times.front();
  };
  EXPECT_EQ(first_time(kStamp), 0);
  EXPECT_EQ(first_time(kStamp - 120), 0) << "the rounding of seconds";
  EXPECT_EQ(first_time(kStamp - 100'000'000), -100'000'000) << "a stamp of the end of the sweep";
  EXPECT_EQ(first_time(kStamp + 20'000'000), 20'000'000);
  EXPECT_EQ(first_time(kStamp - 1'000'000'000), 0) << "another clock";
  EXPECT_EQ(first_time(7'200'000'000'000), 0) << "since the sensor was switched on";
  EXPECT_EQ(first_time(-1), 0) << "nonsense";
}

/// The bytes of the message, laid out by hand from the definition of nav_msgs/msg/Odometry.
TEST(RosMessages, OdometryHasTheLayoutOfItsDefinition) {
  ros::OdometryMessage odometry;
  odometry.frame = "odom";
  odometry.child = "base_link";
  odometry.pose = {{1'700'000'000'123'456'789}, {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {1, 2, 3}}};
  CdrWriter writer;
  writer.number(std::int32_t{1'700'000'000}).number(std::uint32_t{123'456'789});
  writer.text("odom").text("base_link");
  for (const double x : {1.0, 2.0, 3.0, 0.5, -0.5, 0.5, 0.5}) writer.number(x);  // x y z w
  for (int i = 0; i < 36; ++i) writer.number(odometry.covariance.pose(i / 6, i % 6) = i);
  for (int i = 0; i < 6; ++i) writer.number(0.0);
  for (int i = 0; i < 36; ++i) writer.number(odometry.covariance.twist(i / 6, i % 6) = 100.0 + i);
  const std::string message = writer.take();
  EXPECT_EQ(ros::encode_odometry(odometry), message);
  const Result<ros::OdometryMessage> back = ros::decode_odometry(message);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->child, "base_link");
  EXPECT_EQ(back->pose.T_world_body.translation(), Vector3(1, 2, 3));
  EXPECT_EQ(back->covariance.pose, odometry.covariance.pose);
  EXPECT_EQ(back->covariance.twist, odometry.covariance.twist);
}

ros::ImuMessage some_imu() {
  ros::ImuMessage imu;
  imu.frame = "os_imu";
  imu.sample = {{1'700'000'000'123'456'789}, {0.1, -0.2, 0.3}, {0.5, -0.25, 9.8}};
  imu.orientation = Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5);
  imu.orientation_covariance << -1, 0, 0, 0, 0, 0, 0, 0, 0;
  imu.covariance.angular_velocity << 1, 2, 3, 4, 5, 6, 7, 8, 9;
  imu.covariance.specific_force << 10, 20, 30, 40, 50, 60, 70, 80, 90;
  return imu;
}

TEST(RosMessages, ImuRoundTrip) {
  const ros::ImuMessage imu = some_imu();
  const Result<ros::ImuMessage> back = ros::decode_imu(ros::encode_imu(imu));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->frame, "os_imu");
  EXPECT_EQ(back->sample.stamp, imu.sample.stamp);
  EXPECT_EQ(back->sample.angular_velocity, imu.sample.angular_velocity);
  EXPECT_EQ(back->sample.specific_force, imu.sample.specific_force);
  EXPECT_EQ(back->orientation.coeffs(), imu.orientation.coeffs());
  EXPECT_EQ(back->covariance.angular_velocity, imu.covariance.angular_velocity);
  EXPECT_EQ(back->covariance.specific_force, imu.covariance.specific_force);
  EXPECT_TRUE(ros::is_unmeasured(back->orientation_covariance));
  EXPECT_FALSE(ros::is_unmeasured(back->covariance.angular_velocity));
}

/// The bytes of the message, laid out by hand from the definition of sensor_msgs/msg/Imu.
TEST(RosMessages, ImuHasTheLayoutOfItsDefinition) {
  const ros::ImuMessage imu = some_imu();
  CdrWriter writer;
  writer.number(std::int32_t{1'700'000'000}).number(std::uint32_t{123'456'789}).text("os_imu");
  for (const double x : {0.5, -0.5, 0.5, 0.5}) writer.number(x);  // x y z w
  for (int i = 0; i < 9; ++i) writer.number(i == 0 ? -1.0 : 0.0);
  for (const double x : {0.1, -0.2, 0.3}) writer.number(x);
  for (int i = 1; i <= 9; ++i) writer.number(double(i));
  for (const double x : {0.5, -0.25, 9.8}) writer.number(x);
  for (int i = 1; i <= 9; ++i) writer.number(10.0 * i);
  const std::string message = writer.take();
  EXPECT_EQ(ros::encode_imu(imu), message);
  for (std::size_t size = 0; size < message.size(); ++size)
    EXPECT_FALSE(ros::decode_imu(message.substr(0, size))) << size;
}

TEST(RosMessages, PaddedRowsOfAnOrganisedCloud) {
  CdrWriter writer;
  writer.number(std::int32_t{1}).number(std::uint32_t{500}).text("f");
  writer.number(std::uint32_t{2}).number(std::uint32_t{1}).number(std::uint32_t{3});
  for (const auto& [name, offset] : {std::pair{"x", 0U}, std::pair{"y", 4U}, std::pair{"z", 8U}}) {
    writer.text(name).number(std::uint32_t{offset}).number(std::uint8_t{7}).number(std::uint32_t{1});
  }
  std::string data;
  for (const float row : {1.0F, 2.0F}) {
    for (int axis = 0; axis < 3; ++axis) append_little_endian(data, row);
    data += "pad!";
  }
  writer.number(std::uint8_t{0})
      .number(std::uint32_t{12})
      .number(std::uint32_t{16})
      .blob(data)
      .number(std::uint8_t{1});
  const Result<ros::CloudMessage> cloud = ros::decode_cloud(writer.take());
  ASSERT_TRUE(cloud) << cloud.error().message;
  EXPECT_EQ(cloud->scan.stamp.ns, 1'000'000'500);
  ASSERT_EQ(cloud->scan.cloud.size(), 2U);
  EXPECT_EQ(cloud->scan.cloud.points[1], Eigen::Vector3f(2, 2, 2));
}

void expect_pose(MessageReader& reader, const Pose& pose) {
  for (const double value : pose.translation()) EXPECT_EQ(reader.number<double>(), value);
  for (const double value : pose.rotation().coeffs()) EXPECT_EQ(reader.number<double>(), value);
}

// nav_msgs/Path, field by field.
TEST(RosMessages, PathsAreAsRosDefinesThem) {
  const Trajectory poses = {{Stamp{5'000'000'001}, Pose::planar(1, 2, 0.3)}, {Stamp{6'000'000'000}, Pose()}};
  const std::string message = ros::encode_path("map", poses);
  MessageReader reader(message);
  EXPECT_EQ(reader.number<std::int32_t>(), 5);
  EXPECT_EQ(reader.number<std::uint32_t>(), 1U);
  EXPECT_EQ(reader.text(), "map");
  ASSERT_EQ(reader.number<std::uint32_t>(), 2U);
  for (const StampedPose& pose : poses) {
    EXPECT_EQ(reader.number<std::int32_t>(), pose.stamp.ns / 1'000'000'000);
    EXPECT_EQ(reader.number<std::uint32_t>(), pose.stamp.ns % 1'000'000'000);
    EXPECT_EQ(reader.text(), "map");
    expect_pose(reader, pose.T_world_body);
  }
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.offset(), message.size());
}

// visualization_msgs/MarkerArray from Humble on, field by field.
TEST(RosMessages, MarkersAreAsRosDefinesThem) {
  const ros::Marker lines{
      ros::MarkerShape::lines, "map", "loops", Stamp{7'000'000'000}, {0.25F, 0.5F, 0.75F, 1.0F}, 0.1,
      {{1, 2, 3}, {4, 5, 6}}};
  ros::Marker spheres = lines;
  spheres.shape = ros::MarkerShape::spheres;
  const std::string message = ros::encode_markers({lines, spheres});
  MessageReader reader(message);
  ASSERT_EQ(reader.number<std::uint32_t>(), 2U);
  for (std::int32_t id = 0; id < 2; ++id) {
    EXPECT_EQ(reader.number<std::int32_t>(), 7);
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);
    EXPECT_EQ(reader.text(), "map");
    EXPECT_EQ(reader.text(), "loops");
    for (const std::int32_t value : {id, id == 0 ? 5 : 7, 0})
      EXPECT_EQ(reader.number<std::int32_t>(), value);  // LINE_LIST or SPHERE_LIST, ADD
    expect_pose(reader, Pose());
    const double other_sides = id == 0 ? 0.0 : 0.1;
    for (const double scale : {0.1, other_sides, other_sides}) EXPECT_EQ(reader.number<double>(), scale);
    for (const float channel : lines.color) EXPECT_EQ(reader.number<float>(), channel);
    for (int i = 0; i < 2; ++i) EXPECT_EQ(reader.number<std::uint32_t>(), 0U);  // lifetime
    EXPECT_EQ(reader.number<std::uint8_t>(), 0);                                // frame_locked
    ASSERT_EQ(reader.number<std::uint32_t>(), 2U);
    for (const Vector3& point : lines.points)
      for (const double value : point) EXPECT_EQ(reader.number<double>(), value);
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);                              // colors
    EXPECT_EQ(reader.text(), "");                                               // texture_resource
    for (int i = 0; i < 2; ++i) EXPECT_EQ(reader.number<std::uint32_t>(), 0U);  // texture: stamp,
    EXPECT_EQ(reader.text(), "");                                               // frame,
    EXPECT_EQ(reader.text(), "");                                               // format,
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);                              // data
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);                              // uv_coordinates
    for (int i = 0; i < 3; ++i) EXPECT_EQ(reader.text(), "");  // text, mesh_resource, mesh_file.filename
    EXPECT_EQ(reader.number<std::uint32_t>(), 0U);             // mesh_file.data
    EXPECT_EQ(reader.number<std::uint8_t>(), 0);               // mesh_use_embedded_materials
  }
  EXPECT_TRUE(reader.ok());
  EXPECT_EQ(reader.offset(), message.size());
}

TEST(RosMessages, CloudsAreDescribedAsTheyStand) {
  Scan scan{Stamp{1'000'000'000}, {}};
  scan.cloud.points = {{1, 2, 3}, {4, 5, 6}};
  scan.cloud.intensities = {7, 8};
  const std::string message = ros::encode_cloud(scan, "lidar");
  EXPECT_EQ(ros::describe_cloud(message).value(),
            "x float32, y float32, z float32, intensity float32; 2 x 1 points");
  EXPECT_EQ(ros::decode_header(message)->frame, "lidar");
  EXPECT_FALSE(ros::describe_cloud(message.substr(0, 40)));
}

}  // namespace
}  // namespace adit
