// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// MCAP files as other programs write them: no chunks, no index, frames and topics of any name.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/io/bag_recording.hpp"
#include "adit/io/cdr.hpp"
#include "adit/io/mcap_records.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit::test {

inline Scan make_scan(std::size_t index, std::size_t num_points) {
  Rng rng(index + 1);
  Scan scan{{1'700'000'000'123'456'789 + static_cast<std::int64_t>(index) * 100'000'000}, {}};
  for (std::size_t i = 0; i < num_points; ++i) {
    scan.cloud.points.emplace_back(static_cast<float>(rng.uniform(-50, 50)), static_cast<float>(rng.normal()),
                                   1.5F);
    scan.cloud.intensities.push_back(static_cast<float>(rng.uniform(0, 255)));
    scan.cloud.time_offsets_ns.push_back(-static_cast<std::int32_t>(rng.below(100'000'000)));
  }
  return scan;
}

/// The records in front of the summary, put together by hand: no chunks, no index.
inline std::string plain_file(const std::vector<std::string>& records) {
  std::string bytes(mcap::kMagic);
  bytes += mcap::framed(mcap::Opcode::header, mcap::encode(mcap::Header{"ros2", "hand"}));
  for (const std::string& record : records) bytes += record;
  bytes += mcap::framed(mcap::Opcode::data_end, std::string(4, '\0'));
  bytes += mcap::framed(mcap::Opcode::footer, mcap::encode(mcap::Footer{}));
  return bytes + std::string(mcap::kMagic);
}

/// The frames of an Ouster on a robot: where its sensor frame lies on the base, and its LiDAR frame on that.
inline const Pose T_base_ouster = Pose::planar(0.2, 0.1, 0.7, 0.8);
inline const Pose T_ouster_lidar = Pose::planar(0, 0, 3.0, 0.036);

inline ros::TransformMessage link(const std::string& frame, const std::string& child,
                                  const Pose& T_frame_child) {
  return {frame, child, {{5}, T_frame_child}};
}

/// Files of other programs, message by message.
class ForeignFile {
 public:
  ForeignFile() {
    schema(1, ros::kPointCloud2);
    schema(2, ros::kOdometry);
    schema(3, ros::kTransforms);
    schema(4, ros::kImu);
    schema(5, ros::kTwist);
    schema(6, ros::kJointState);
  }
  /// Three clouds in the frame `frame`, recorded 5 ms after the scans' own stamps.
  ForeignFile& clouds(const std::string& topic, const std::string& frame = "os_lidar") {
    const std::uint16_t id = channel(1, topic);
    for (std::size_t i = 0; i < 3; ++i) {
      const Scan scan = make_scan(i, 4);
      message(id, scan.stamp + Duration(5'000'000), ros::encode_cloud(scan, frame));
    }
    return *this;
  }
  ForeignFile& odometry(const std::string& topic, const std::string& child = "base_link",
                        const WheelCovariance& covariance = {}) {
    return odometry(topic, child, {covariance, covariance, covariance});
  }
  /// Three poses, with a covariance each.
  ForeignFile& odometry(const std::string& topic, const std::string& child,
                        const std::vector<WheelCovariance>& covariances) {
    const std::uint16_t id = channel(2, topic);
    for (std::size_t i = 0; i < 3; ++i) {
      const Stamp stamp = make_scan(i, 0).stamp;
      message(id, stamp, ros::encode_odometry({{"odom", child, {stamp, Pose()}}, covariances.at(i)}));
    }
    return *this;
  }
  /// Poses with these stamps, recorded in their order, 50 ms apart.
  ForeignFile& odometry_stamped(const std::string& topic, const std::vector<Stamp>& stamps) {
    const std::uint16_t id = channel(2, topic);
    Stamp recorded = make_scan(0, 0).stamp;
    for (const Stamp stamp : stamps) {
      message(id, recorded, ros::encode_odometry({{"odom", "base_link", {stamp, Pose()}}, {}}));
      recorded = recorded + Duration(50'000'000);
    }
    return *this;
  }
  ForeignFile& imu(const std::string& topic, const std::vector<ros::ImuMessage>& samples) {
    const std::uint16_t id = channel(4, topic);
    for (const ros::ImuMessage& sample : samples) message(id, sample.sample.stamp, ros::encode_imu(sample));
    return *this;
  }
  ForeignFile& twists(const std::string& topic, const std::vector<ros::TwistMessage>& twists) {
    const std::uint16_t id = channel(5, topic);
    for (const ros::TwistMessage& twist : twists) {
      CdrWriter writer;
      writer.number(static_cast<std::int32_t>(twist.stamp.ns / 1'000'000'000))
          .number(static_cast<std::uint32_t>(twist.stamp.ns % 1'000'000'000))
          .text(twist.frame);
      for (const double value : twist.twist) writer.number(value);
      message(id, twist.stamp, writer.take());
    }
    return *this;
  }
  /// A cloud as it stands, recorded some time after its stamp.
  ForeignFile& cloud_messages(const std::string& topic,
                              const std::vector<std::pair<Stamp, std::string>>& clouds,
                              Duration recorded_after) {
    const std::uint16_t id = channel(1, topic);
    for (const auto& [stamp, cloud] : clouds) message(id, stamp + recorded_after, cloud);
    return *this;
  }
  /// Transforms or odometry (`type` as in ros_messages.hpp) as they stand.
  ForeignFile& messages_of(std::string_view type, const std::string& topic,
                           const std::vector<std::string>& contents) {
    const std::uint16_t id = channel(type == ros::kOdometry ? 2 : 3, topic);
    for (std::size_t i = 0; i < contents.size(); ++i) message(id, make_scan(i, 0).stamp, contents[i]);
    return *this;
  }
  ForeignFile& joints(const std::string& topic, const std::vector<ros::JointStateMessage>& messages) {
    const std::uint16_t id = channel(6, topic);
    for (const ros::JointStateMessage& joints : messages) message(id, joints.stamp, encoded(joints));
    return *this;
  }
  ForeignFile& links(const std::vector<ros::TransformMessage>& transforms,
                     const std::string& topic = "/tf_static") {
    message(channel(3, topic), make_scan(0, 0).stamp, ros::encode_transforms(transforms));
    return *this;
  }
  /// Each link in a message of its own, recorded at its stamp.
  ForeignFile& moving_links(const std::vector<ros::TransformMessage>& transforms,
                            const std::string& topic = "/tf") {
    const std::uint16_t id = channel(3, topic);
    for (const ros::TransformMessage& link : transforms)
      message(id, link.pose.stamp, ros::encode_transforms({link}));
    return *this;
  }
  [[nodiscard]] std::string bytes() const { return plain_file(records_); }
  [[nodiscard]] Result<Recording> read(const RecordingConfig& config = {}) const {
    return read_recording(memory_source(bytes()), config);
  }

 private:
  /// As sensor_msgs/msg/JointState defines it.
  static std::string encoded(const ros::JointStateMessage& joints) {
    CdrWriter writer;
    writer.number(static_cast<std::int32_t>(joints.stamp.ns / 1'000'000'000))
        .number(static_cast<std::uint32_t>(joints.stamp.ns % 1'000'000'000))
        .text("")
        .number(static_cast<std::uint32_t>(joints.names.size()));
    for (const std::string& name : joints.names) writer.text(name);
    for (const std::vector<double>& values : {joints.positions, joints.velocities, std::vector<double>()}) {
      writer.number(static_cast<std::uint32_t>(values.size()));
      for (const double value : values) writer.number(value);
    }
    return writer.take();
  }
  void schema(std::uint16_t id, std::string_view type) {
    records_.push_back(mcap::framed(mcap::Opcode::schema,
                                    mcap::encode(mcap::Schema{id, std::string(type), "ros2msg", "..."})));
  }
  std::uint16_t channel(std::uint16_t schema, const std::string& topic) {
    records_.push_back(mcap::framed(mcap::Opcode::channel,
                                    mcap::encode(mcap::Channel{++num_channels_, schema, topic, "cdr", {}})));
    return num_channels_;
  }
  void message(std::uint16_t channel, Stamp stamp, std::string data) {
    records_.push_back(mcap::framed(mcap::Opcode::message,
                                    mcap::encode(mcap::Message{channel, 0, stamp, stamp, std::move(data)})));
  }

  std::vector<std::string> records_;
  std::uint16_t num_channels_ = 0;
};

}  // namespace adit::test
