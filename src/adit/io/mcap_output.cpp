// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap_output.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/core/version.hpp"
#include "adit/io/ascending.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

std::string base_frame(const Recording& recording) { return recording.name + "/base_link"; }
std::string lidar_frame(const Recording& recording) { return recording.name + "/lidar"; }
std::string imu_frame(const Recording& recording) { return recording.name + "/imu"; }

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

// One chunk per scan, and what the other sensors measured in a few seconds in chunks of their own, so that a
// reader gets all of that without expanding any scan.

/// A trajectory, or the samples of an IMU, on its way into the file.
struct Track {
  std::vector<Stamp> stamps;
  std::function<std::string(std::size_t)> encode;
  std::uint16_t channel = 0;
  std::size_t next = 0;
};

struct RecordingWriter {
  mcap::Writer file;
  std::vector<Track> tracks;
  std::vector<mcap::Message> pending;  ///< Of the tracks, for their next chunk.
};

mcap::Message message_of(std::uint16_t channel, std::size_t sequence, Stamp stamp, std::string data) {
  return {channel, static_cast<std::uint32_t>(sequence), stamp, stamp, std::move(data)};
}

void flush_tracks(RecordingWriter& writer) {
  if (writer.pending.empty()) return;
  std::ranges::stable_sort(writer.pending, {}, &mcap::Message::log_time);
  writer.file.write_chunk(writer.pending);
  writer.pending.clear();
}

void write_tracks_until(RecordingWriter& writer, Stamp end) {
  constexpr std::size_t kMessagesPerChunk = 512;
  for (Track& track : writer.tracks) {
    for (; track.next < track.stamps.size() && track.stamps[track.next] <= end; ++track.next) {
      writer.pending.push_back(
          message_of(track.channel, track.next, track.stamps[track.next], track.encode(track.next)));
    }
  }
  if (writer.pending.size() >= kMessagesPerChunk) flush_tracks(writer);
}

std::uint16_t add_schema(RecordingWriter& writer, std::string_view type) {
  return writer.file.add_schema(std::string(type), "ros2msg", ros::definition_of(type));
}

void add_poses(RecordingWriter& writer, const Recording& recording) {
  if (recording.wheel.empty() && recording.truth.empty()) return;
  const std::uint16_t schema = add_schema(writer, ros::kOdometry);
  const auto add = [&](const Trajectory& poses, const std::string& topic, const std::string& frame) {
    if (poses.empty()) return;
    const auto encode = [&poses, frame, base = base_frame(recording)](std::size_t i) {
      return ros::encode_odometry({{frame, base, poses[i]}});
    };
    writer.tracks.push_back(
        {stamps_of(poses), encode, writer.file.add_channel("/" + recording.name + topic, "cdr", schema)});
  };
  add(recording.wheel, "/wheel_odometry", recording.name + "/odom");
  add(recording.truth, "/ground_truth", "world");
}

void add_imu(RecordingWriter& writer, const Recording& recording) {
  if (recording.imu.empty()) return;
  ros::ImuMessage message;
  message.frame = imu_frame(recording);
  message.orientation_covariance(0, 0) = ros::kUnmeasured;
  message.covariance = recording.imu_covariance;
  const auto encode = [&recording, message](std::size_t i) mutable {
    message.sample = recording.imu[i];
    return ros::encode_imu(message);
  };
  writer.tracks.push_back(
      {stamps_of(recording.imu), encode,
       writer.file.add_channel("/" + recording.name + "/imu", "cdr", add_schema(writer, ros::kImu))});
}

void write_mounts(RecordingWriter& writer, const Recording& recording) {
  const std::uint16_t channel =
      writer.file.add_channel("/tf_static", "cdr", add_schema(writer, ros::kTransforms));
  const Stamp stamp = recording.scan_stamps.front();
  const std::string base = base_frame(recording);
  std::vector<ros::TransformMessage> mounts = {
      {base, lidar_frame(recording), {stamp, recording.T_base_lidar}}};
  if (!recording.imu.empty()) mounts.push_back({base, imu_frame(recording), {stamp, recording.T_base_imu}});
  writer.file.write_chunk({message_of(channel, 0, stamp, ros::encode_transforms(mounts))});
}

mcap::Metadata metadata_of(const Recording& recording) {
  mcap::Metadata metadata{"adit", {{"robot", recording.name}, {"lidar", recording.lidar}}};
  if (!recording.imu_name.empty()) metadata.entries["imu"] = recording.imu_name;
  if (!recording.assumptions.empty())
    metadata.entries["assumed"] = format("{}", fmt::join(recording.assumptions, "\n"));
  return metadata;
}

Result<> write_scans(RecordingWriter& writer, const Recording& recording, std::ostream& out) {
  const std::uint16_t schema = add_schema(writer, ros::kPointCloud2);
  const std::uint16_t channel = writer.file.add_channel("/" + recording.name + "/points", "cdr", schema);
  const Phase phase("writing scans", recording.num_scans());
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(format("scan {}", i), scan.error());
    const Stamp stamp = recording.scan_stamps[i];
    write_tracks_until(writer, stamp);
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
      .and_then([&] { return check_stamps(stamps_of(recording.truth), "ground truth"); })
      .and_then([&] { return check_stamps(stamps_of(recording.imu), "IMU"); });
}

Result<> write_recording(std::ostream& out, const Recording& recording) {
  if (Result<> checked = check_fits_mcap(recording); !checked) return checked;
  RecordingWriter writer{{out, {"ros2", "adit " + std::string(version())}}, {}, {}};
  writer.file.write_metadata(metadata_of(recording));
  add_poses(writer, recording);
  add_imu(writer, recording);
  write_mounts(writer, recording);
  if (Result<> written = write_scans(writer, recording, out); !written) return written;
  write_tracks_until(writer, {std::numeric_limits<std::int64_t>::max()});
  flush_tracks(writer);
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
