// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_output.hpp"

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

std::string base_frame(const Recording& recording) { return recording.name + "/base_link"; }
std::string lidar_frame(const Recording& recording) { return recording.name + "/lidar"; }

Result<> check_stamps(const std::vector<Stamp>& stamps, std::string_view what) {
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    if (!ros::fits_ros(stamps[i])) {
      return fail(format("{} {}: stamp {} is outside what ROS messages hold (0 to 2^31 s)", what, i,
                         stamp_text(stamps[i])));
    }
    if (i > 0 && stamps[i] <= stamps[i - 1]) {
      return fail(format("{} {}: stamp {} is not after {}, that of the one before", what, i,
                         stamp_text(stamps[i]), stamp_text(stamps[i - 1])));
    }
  }
  return {};
}

std::vector<Stamp> stamps_of(const Trajectory& trajectory) {
  std::vector<Stamp> stamps;
  for (const StampedPose& pose : trajectory) stamps.push_back(pose.stamp);
  return stamps;
}

// One chunk per scan, and the poses of a few seconds in chunks of their own, so that a reader gets the
// trajectories without expanding any scan.

/// A trajectory on its way into the file.
struct PoseTopic {
  const Trajectory* poses = nullptr;
  std::uint16_t channel = 0;
  std::string frame;
  std::size_t next = 0;
};

struct RecordingWriter {
  mcap::Writer file;
  std::string base;
  std::vector<PoseTopic> topics;
  std::vector<mcap::Message> pending;  ///< Poses for the next chunk of poses.
};

mcap::Message message_of(std::uint16_t channel, std::size_t sequence, Stamp stamp, std::string data) {
  return {channel, static_cast<std::uint32_t>(sequence), stamp, stamp, std::move(data)};
}

void flush_poses(RecordingWriter& writer) {
  if (writer.pending.empty()) return;
  std::ranges::stable_sort(writer.pending, {}, &mcap::Message::log_time);
  writer.file.write_chunk(writer.pending);
  writer.pending.clear();
}

void write_poses_until(RecordingWriter& writer, Stamp end) {
  constexpr std::size_t kPosesPerChunk = 512;
  for (PoseTopic& topic : writer.topics) {
    for (; topic.next < topic.poses->size() && (*topic.poses)[topic.next].stamp <= end; ++topic.next) {
      const StampedPose& pose = (*topic.poses)[topic.next];
      writer.pending.push_back(message_of(topic.channel, topic.next, pose.stamp,
                                          ros::encode_odometry({topic.frame, writer.base, pose})));
    }
  }
  if (writer.pending.size() >= kPosesPerChunk) flush_poses(writer);
}

void add_pose_topics(RecordingWriter& writer, const Recording& recording) {
  if (recording.wheel.empty() && recording.truth.empty()) return;
  const std::uint16_t schema =
      writer.file.add_schema(std::string(ros::kOdometry), "ros2msg", ros::definition_of(ros::kOdometry));
  const auto add = [&](const Trajectory& poses, const std::string& topic, const std::string& frame) {
    if (poses.empty()) return;
    writer.topics.push_back(
        {&poses, writer.file.add_channel("/" + recording.name + topic, "cdr", schema), frame});
  };
  add(recording.wheel, "/wheel_odometry", recording.name + "/odom");
  add(recording.truth, "/ground_truth", "world");
}

void write_lidar_pose(RecordingWriter& writer, const Recording& recording) {
  const std::uint16_t schema =
      writer.file.add_schema(std::string(ros::kTransforms), "ros2msg", ros::definition_of(ros::kTransforms));
  const std::uint16_t channel = writer.file.add_channel("/tf_static", "cdr", schema);
  const Stamp stamp = recording.scan_stamps.front();
  const std::string transforms = ros::encode_transforms(
      {{base_frame(recording), lidar_frame(recording), {stamp, recording.T_base_lidar}}});
  writer.file.write_chunk({message_of(channel, 0, stamp, transforms)});
}

mcap::Metadata metadata_of(const Recording& recording) {
  mcap::Metadata metadata{"adit", {{"robot", recording.name}, {"lidar", recording.lidar}}};
  if (!recording.assumptions.empty())
    metadata.entries["assumed"] = format("{}", fmt::join(recording.assumptions, "\n"));
  return metadata;
}

Result<> write_scans(RecordingWriter& writer, const Recording& recording, std::ostream& out) {
  const std::uint16_t schema = writer.file.add_schema(std::string(ros::kPointCloud2), "ros2msg",
                                                      ros::definition_of(ros::kPointCloud2));
  const std::uint16_t channel = writer.file.add_channel("/" + recording.name + "/points", "cdr", schema);
  const Phase phase("writing scans", recording.num_scans());
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(format("scan {}", i), scan.error());
    const Stamp stamp = recording.scan_stamps[i];
    write_poses_until(writer, stamp);
    writer.file.write_chunk(
        {message_of(channel, i, stamp, ros::encode_cloud(*scan, lidar_frame(recording)))});
    if (!out) return fail(format("scan {}: writing failed; is the disk full?", i));
    phase.advance();
  }
  return {};
}

}  // namespace

Result<> check_fits_mcap(const Recording& recording) {
  if (recording.num_scans() < 2) {
    return fail(format("a recording needs two scans or more; there are {}", recording.num_scans()));
  }
  return check_stamps(recording.scan_stamps, "scan")
      .and_then([&] { return check_stamps(stamps_of(recording.wheel), "wheel odometry"); })
      .and_then([&] { return check_stamps(stamps_of(recording.truth), "ground truth"); });
}

Result<> write_recording(std::ostream& out, const Recording& recording) {
  if (Result<> checked = check_fits_mcap(recording); !checked) return checked;
  RecordingWriter writer{{out, {"ros2", "adit " + std::string(version())}}, base_frame(recording), {}, {}};
  writer.file.write_metadata(metadata_of(recording));
  add_pose_topics(writer, recording);
  write_lidar_pose(writer, recording);
  if (Result<> written = write_scans(writer, recording, out); !written) return written;
  write_poses_until(writer, {std::numeric_limits<std::int64_t>::max()});
  flush_poses(writer);
  writer.file.finish();
  if (!out) return fail("writing failed; is the disk full?");
  return {};
}

Result<> write_recording(const std::filesystem::path& path, const Recording& recording) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const Result<> written = write_recording(file->stream(), recording);
  if (!written) return fail(path.string(), written.error());
  return file->commit();
}

}  // namespace adit
