// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/version.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/mcap_writer.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

using mcap::MessageRef;

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

Result<> check_recording(const Recording& recording) {
  if (recording.num_scans() < 2) {
    return fail(format("a recording needs two scans or more; there are {}", recording.num_scans()));
  }
  return check_stamps(recording.scan_stamps, "scan")
      .and_then([&] { return check_stamps(stamps_of(recording.wheel), "wheel odometry"); })
      .and_then([&] { return check_stamps(stamps_of(recording.truth), "ground truth"); });
}

// Writing: one chunk a scan, and the poses of a few seconds in chunks of their own, so that a reader gets the
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

Result<> write_scans(RecordingWriter& writer, const Recording& recording, std::ostream& out,
                     const std::function<void(std::size_t)>& progress) {
  const std::uint16_t schema = writer.file.add_schema(std::string(ros::kPointCloud2), "ros2msg",
                                                      ros::definition_of(ros::kPointCloud2));
  const std::uint16_t channel = writer.file.add_channel("/" + recording.name + "/points", "cdr", schema);
  for (std::size_t i = 0; i < recording.num_scans(); ++i) {
    const Result<Scan> scan = recording.read_scan(i);
    if (!scan) return fail(format("scan {}", i), scan.error());
    const Stamp stamp = recording.scan_stamps[i];
    write_poses_until(writer, stamp);
    writer.file.write_chunk(
        {message_of(channel, i, stamp, ros::encode_cloud(*scan, lidar_frame(recording)))});
    if (!out) return fail(format("scan {}: writing failed; is the disk full?", i));
    if (progress) progress(i + 1);
  }
  return {};
}

// Reading.

struct Topics {
  std::vector<mcap::Channel> points;
  std::vector<mcap::Channel> wheel;
  std::vector<mcap::Channel> truth;
  std::vector<mcap::Channel> transforms;
};

Topics find_topics(const mcap::Contents& contents) {
  Topics topics;
  for (const auto& [id, channel] : contents.channels) {
    const auto schema = contents.schemas.find(channel.schema_id);
    if (schema == contents.schemas.end() || channel.message_encoding != "cdr") continue;
    const std::string& type = schema->second.name;
    const std::string topic = lower_case(channel.topic);
    const bool is_truth = topic.find("truth") != std::string::npos || topic.find("gt") != std::string::npos;
    if (type == ros::kPointCloud2) topics.points.push_back(channel);
    if (type == ros::kOdometry) (is_truth ? topics.truth : topics.wheel).push_back(channel);
    if (type == ros::kTransforms && topic.ends_with("tf_static")) topics.transforms.push_back(channel);
  }
  return topics;
}

Result<> check_single(const std::vector<mcap::Channel>& channels, std::string_view what) {
  if (channels.size() < 2) return {};
  std::vector<std::string> names;
  for (const mcap::Channel& channel : channels) names.push_back(channel.topic);
  return fail(format("several topics of {}: {}; keep one of them in the file", what, fmt::join(names, ", ")));
}

Result<> check_topics(const Topics& topics) {
  if (topics.points.empty())
    return fail("no topic of sensor_msgs/msg/PointCloud2 in CDR; there are no scans to read");
  return check_single(topics.points, "PointCloud2")
      .and_then([&] { return check_single(topics.wheel, "wheel odometry"); })
      .and_then([&] { return check_single(topics.truth, "ground truth"); });
}

std::vector<MessageRef> messages_of(const mcap::Contents& contents,
                                    const std::vector<mcap::Channel>& channels) {
  std::vector<MessageRef> refs;
  std::ranges::copy_if(contents.messages, std::back_inserter(refs), [&](const MessageRef& ref) {
    return std::ranges::any_of(channels,
                               [&](const mcap::Channel& channel) { return channel.id == ref.channel_id; });
  });
  return refs;
}

struct PoseTrack {
  Trajectory poses;
  std::string child;  ///< Frame of the body.
};

Result<PoseTrack> read_poses(const mcap::Reader& reader, const std::vector<mcap::Channel>& channels) {
  PoseTrack track;
  for (const MessageRef& ref : messages_of(reader.contents(), channels)) {
    const Result<ros::TransformMessage> pose = reader.read(ref).and_then(
        [](const mcap::Message& message) { return ros::decode_odometry(message.data); });
    const std::string place = format("{}, message {}", channels.front().topic, track.poses.size());
    if (!pose) return fail(place, pose.error());
    if (!track.poses.empty() && pose->pose.stamp <= track.poses.back().stamp) {
      return fail(format("{}: stamp {} is not after {}, that of the one before", place,
                         stamp_text(pose->pose.stamp), stamp_text(track.poses.back().stamp)));
    }
    track.poses.push_back(pose->pose);
    track.child = pose->child;
  }
  return track;
}

/// adit's own files are logged at the scan's stamp; others when a scan arrived, so each message must be
/// looked into.
Result<std::vector<Stamp>> read_stamps(const mcap::Reader& reader, const std::vector<MessageRef>& scans,
                                       bool is_own) {
  std::vector<Stamp> stamps;
  for (const MessageRef& ref : scans) {
    const Result<Stamp> stamp =
        is_own ? ref.log_time : reader.read(ref).and_then([](const mcap::Message& message) {
          return ros::decode_stamp(message.data);
        });
    if (!stamp) return fail(format("scan {}", stamps.size()), stamp.error());
    stamps.push_back(*stamp);
  }
  return stamps;
}

/// T_base_lidar where /tf_static links the cloud's frame straight to the body's; the identity elsewhere.
Result<Pose> read_lidar_pose(const mcap::Reader& reader, const Topics& topics, const std::string& lidar,
                             const std::string& base) {
  Pose T_base_lidar;
  for (const MessageRef& ref : messages_of(reader.contents(), topics.transforms)) {
    const auto transforms = reader.read(ref).and_then(
        [](const mcap::Message& message) { return ros::decode_transforms(message.data); });
    if (!transforms) return fail(topics.transforms.front().topic, transforms.error());
    for (const ros::TransformMessage& link : *transforms) {
      if (link.child == lidar && (base.empty() || link.frame == base)) T_base_lidar = link.pose.T_world_body;
    }
  }
  return T_base_lidar;
}

Result<ros::CloudMessage> read_cloud_message(const mcap::Reader& reader, const MessageRef& ref) {
  return reader.read(ref).and_then(
      [](const mcap::Message& message) { return ros::decode_cloud(message.data); });
}

void take_names(Recording& recording, const mcap::Contents& contents, const std::string& topic) {
  // "/robot_0/points" -> "robot_0"; "/points" -> "points".
  recording.name = topic.substr(topic.starts_with('/') ? 1 : 0);
  recording.name = recording.name.substr(0, recording.name.find('/'));
  for (const mcap::Metadata& metadata : contents.metadata) {
    if (metadata.name != "adit") continue;
    if (const auto robot = metadata.entries.find("robot"); robot != metadata.entries.end())
      recording.name = robot->second;
    if (const auto lidar = metadata.entries.find("lidar"); lidar != metadata.entries.end())
      recording.lidar = lidar->second;
  }
}

bool is_own_file(const mcap::Contents& contents) {
  return std::ranges::any_of(contents.metadata,
                             [](const mcap::Metadata& metadata) { return metadata.name == "adit"; });
}

/// Scans are decoded when asked for; the reader lives as long as the function.
std::function<Result<Scan>(std::size_t)> scan_reader(std::shared_ptr<const mcap::Reader> reader,
                                                     std::vector<MessageRef> scans,
                                                     std::vector<Stamp> stamps) {
  return [reader = std::move(reader), scans = std::move(scans),
          stamps = std::move(stamps)](std::size_t i) -> Result<Scan> {
    ADIT_CHECK(i < scans.size(), "no scan of that index");
    Result<ros::CloudMessage> message = read_cloud_message(*reader, scans[i]);
    if (!message) return fail(format("scan {}", i), message.error());
    if (message->scan.stamp != stamps[i]) return fail(format("scan {}: its stamp differs from the index", i));
    return std::move(message->scan);
  };
}

Result<Recording> read_recording(const std::shared_ptr<const mcap::Reader>& reader) {
  const mcap::Contents& contents = reader->contents();
  const Topics topics = find_topics(contents);
  if (Result<> checked = check_topics(topics); !checked) return tl::unexpected(checked.error());
  const std::vector<MessageRef> scans = messages_of(contents, topics.points);
  Recording recording;
  take_names(recording, contents, topics.points.front().topic);
  Result<PoseTrack> wheel = read_poses(*reader, topics.wheel);
  if (!wheel) return tl::unexpected(wheel.error());
  Result<PoseTrack> truth = read_poses(*reader, topics.truth);
  if (!truth) return tl::unexpected(truth.error());
  Result<std::vector<Stamp>> stamps = read_stamps(*reader, scans, is_own_file(contents));
  if (!stamps) return tl::unexpected(stamps.error());
  recording.scan_stamps = std::move(*stamps);
  recording.wheel = std::move(wheel->poses);
  recording.truth = std::move(truth->poses);
  if (Result<> checked = check_recording(recording); !checked) return tl::unexpected(checked.error());
  const Result<ros::CloudMessage> first = read_cloud_message(*reader, scans.front());
  if (!first) return fail("scan 0", first.error());
  const Result<Pose> T_base_lidar = read_lidar_pose(*reader, topics, first->frame, wheel->child);
  if (!T_base_lidar) return tl::unexpected(T_base_lidar.error());
  recording.T_base_lidar = *T_base_lidar;
  recording.read_scan = scan_reader(reader, scans, recording.scan_stamps);
  return recording;
}

}  // namespace

Result<> write_recording(std::ostream& out, const Recording& recording,
                         const std::function<void(std::size_t)>& progress) {
  if (Result<> checked = check_recording(recording); !checked) return checked;
  RecordingWriter writer{{out, {"ros2", "adit " + std::string(version())}}, base_frame(recording), {}, {}};
  writer.file.write_metadata({"adit", {{"robot", recording.name}, {"lidar", recording.lidar}}});
  add_pose_topics(writer, recording);
  write_lidar_pose(writer, recording);
  if (Result<> written = write_scans(writer, recording, out, progress); !written) return written;
  write_poses_until(writer, {std::numeric_limits<std::int64_t>::max()});
  flush_poses(writer);
  writer.file.finish();
  if (!out) return fail("writing failed; is the disk full?");
  return {};
}

Result<> write_recording(const std::filesystem::path& path, const Recording& recording,
                         const std::function<void(std::size_t)>& progress) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return tl::unexpected(file.error());
  const Result<> written = write_recording(file->stream(), recording, progress);
  if (!written) return fail(path.string(), written.error());
  return file->commit();
}

Result<Recording> read_recording(ByteSource source) {
  return mcap::Reader::open(std::move(source)).and_then([](mcap::Reader reader) {
    return read_recording(std::make_shared<const mcap::Reader>(std::move(reader)));
  });
}

Result<Recording> read_recording(const std::filesystem::path& path) {
  const Result<ByteSource> source = open_source(path);
  if (!source) return tl::unexpected(source.error());
  Result<Recording> recording = read_recording(*source);
  if (!recording) return fail(path.string(), recording.error());
  recording->read_scan = [read = std::move(recording->read_scan),
                          name = path.string()](std::size_t i) -> Result<Scan> {
    Result<Scan> scan = read(i);
    if (!scan) return fail(name, scan.error());
    return scan;
  };
  return recording;
}

}  // namespace adit
