// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/mcap.hpp"

#include <algorithm>
#include <cctype>
#include <memory>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/frame_tree.hpp"
#include "adit/io/imu_topic.hpp"
#include "adit/io/mcap_reader.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/wheel_covariance.hpp"

namespace adit {
namespace {

using mcap::MessageRef;

struct Topics {
  std::vector<mcap::Channel> points;
  std::vector<mcap::Channel> wheel;
  std::vector<mcap::Channel> truth;
  std::vector<mcap::Channel> imu;
  std::vector<mcap::Channel> transforms;
};

/// Whether "gt", "truth" or "groundtruth" is a whole word of the topic: "/robot_0/ground_truth" is ground
/// truth,
/// "/length/odom" is not.
bool is_truth(const std::string& topic) {
  std::string words = lower_case(topic);
  std::ranges::replace_if(
      words, [](unsigned char c) { return std::isalnum(c) == 0; }, ' ');
  return std::ranges::any_of(split_words(words), [](std::string_view word) {
    return word == "gt" || word == "truth" || word == "groundtruth";
  });
}

Topics find_topics(const mcap::Contents& contents) {
  Topics topics;
  for (const auto& [id, channel] : contents.channels) {
    const auto schema = contents.schemas.find(channel.schema_id);
    if (schema == contents.schemas.end() || channel.message_encoding != "cdr") continue;
    const std::string& type = schema->second.name;
    if (type == ros::kPointCloud2) topics.points.push_back(channel);
    if (type == ros::kImu) topics.imu.push_back(channel);
    if (type == ros::kOdometry) (is_truth(channel.topic) ? topics.truth : topics.wheel).push_back(channel);
    if (type == ros::kTransforms && channel.topic.ends_with("tf_static"))
      topics.transforms.push_back(channel);
  }
  return topics;
}

std::string names_of(const std::vector<mcap::Channel>& channels) {
  std::vector<std::string> names;
  for (const mcap::Channel& channel : channels) names.push_back(channel.topic);
  return format("{}", fmt::join(names, ", "));
}

Result<> check_single(const std::vector<mcap::Channel>& channels, std::string_view what) {
  if (channels.size() < 2) return {};
  return fail(format("several topics of {}: {}; keep one of them in the file", what, names_of(channels)));
}

/// How people choose one of several topics.
struct TopicChoice {
  std::string_view type;    ///< "PointCloud2"
  std::string_view option;  ///< "--points"
  std::string topic;        ///< "": the only one.
};

/// Leaves the topic asked for, or the only one, if there is any.
Result<> choose_one(std::vector<mcap::Channel>& channels, const TopicChoice& choice) {
  const std::string all = names_of(channels);
  if (!choice.topic.empty())
    std::erase_if(channels, [&](const mcap::Channel& channel) { return channel.topic != choice.topic; });
  if (channels.empty() && !choice.topic.empty()) {
    return fail(format("no {} topic '{}'; there {}", choice.type, choice.topic,
                       all.empty() ? "is none" : "are: " + all));
  }
  if (channels.size() < 2) return {};
  return fail(format("several topics of {}: {}; choose one with {} TOPIC", choice.type, all, choice.option));
}

/// Leaves one topic of clouds and at most one of each other kind.
Result<Topics> choose_topics(Topics topics, const RecordingConfig& config) {
  if (topics.points.empty())
    return fail("no topic of sensor_msgs/msg/PointCloud2 in CDR; there are no scans to read");
  if (config.imu == kNoImu) topics.imu.clear();
  const std::string imu = config.imu == kNoImu ? "" : config.imu;
  const bool has_wheels = config.wheel != kNoWheel;
  return choose_one(topics.points, {"PointCloud2", "--points", config.points})
      .and_then([&] {
        return choose_one(topics.imu, {"Imu", "--imu", imu});
      })
      .and_then([&]() -> Result<> {
        if (!has_wheels) return {};
        return choose_one(topics.wheel, {"wheel odometry", "--wheel", config.wheel});
      })
      .and_then([&] { return check_single(topics.truth, "ground truth"); })
      .map([&] { return std::move(topics); });
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
  WheelCovariance covariance;
};

/// Keeps the first covariances, or the first that cannot be.
void take_covariance(WheelCovariance& kept, const WheelCovariance& stated, bool is_first) {
  if (is_first ||
      (fault_of_pose_covariance(kept.pose).empty() && !fault_of_pose_covariance(stated.pose).empty()))
    kept.pose = stated.pose;
  if (is_first ||
      (fault_of_twist_covariance(kept.twist).empty() && !fault_of_twist_covariance(stated.twist).empty()))
    kept.twist = stated.twist;
}

Result<PoseTrack> read_poses(const mcap::Reader& reader, const std::vector<mcap::Channel>& channels) {
  PoseTrack track;
  for (const MessageRef& ref : messages_of(reader.contents(), channels)) {
    const Result<ros::OdometryMessage> pose = reader.read(ref).and_then(
        [](const mcap::Message& message) { return ros::decode_odometry(message.data); });
    const std::string place = format("{}, message {}", channels.front().topic, track.poses.size());
    if (!pose) return fail(place, pose.error());
    if (!track.poses.empty() && pose->pose.stamp <= track.poses.back().stamp) {
      return fail(format("{}: stamp {} is not after {}, that of the one before", place,
                         stamp_text(pose->pose.stamp), stamp_text(track.poses.back().stamp)));
    }
    take_covariance(track.covariance, pose->covariance, track.poses.empty());
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

Result<FrameTree> read_frames(const mcap::Reader& reader, const Topics& topics) {
  FrameTree tree;
  for (const MessageRef& ref : messages_of(reader.contents(), topics.transforms)) {
    const auto transforms = reader.read(ref).and_then(
        [](const mcap::Message& message) { return ros::decode_transforms(message.data); });
    if (!transforms) return fail(topics.transforms.front().topic, transforms.error());
    for (const ros::TransformMessage& link : *transforms)
      tree.add(link.frame, link.child, link.pose.T_world_body);
  }
  return tree;
}

/// The robot's frame as topics of wheel odometry name it that are not used; "" where they differ.
Result<std::string> body_frame(const mcap::Reader& reader, const std::vector<mcap::Channel>& channels) {
  std::string body;
  for (const mcap::Channel& channel : channels) {
    const std::vector<MessageRef> messages = messages_of(reader.contents(), {channel});
    if (messages.empty()) continue;
    const Result<ros::OdometryMessage> first =
        reader.read(messages.front()).and_then([](const auto& message) {
          return ros::decode_odometry(message.data);
        });
    if (!first) return fail(format("{}, message 0", channel.topic), first.error());
    if (!body.empty() && FrameTree::bare(body) != FrameTree::bare(first->child)) return std::string();
    body = first->child;
  }
  return body;
}

/// How the robot's frame and the LiDAR's are called in the file.
struct FrameNames {
  std::string base;  ///< As the wheel odometry has it; "" without one.
  std::string lidar;
  std::string imu;
};

/// The mount as /tf_static has it; unknown is an error, never the identity.
Result<> take_linked_mount(Recording& recording, const FrameTree& tree, FrameNames names) {
  if (names.base.empty()) names.base = tree.body_of(names.lidar);
  if (names.base.empty()) {
    return fail(
        format("nothing says where the LiDAR sits on the robot: no /tf_static links its frame '{}'; {}",
               names.lidar, kMountRemedy));
  }
  const Result<FrameTree::Chain> chain = tree.between(names.base, names.lidar);
  if (!chain) {
    return fail(format("/tf_static does not say where the LiDAR sits on the robot: {}; {}",
                       chain.error().message, kMountRemedy));
  }
  recording.T_base_lidar = chain->T_a_b;
  recording.mount_source = chain->frames.size() == 1
                               ? "the wheel odometry is of the LiDAR's own frame " + chain->frames.front()
                               : format("/tf_static: {}", fmt::join(chain->frames, " -> "));
  return {};
}

/// The IMU's mount as /tf_static has it, from the robot or, where the user gave the LiDAR's mount, from the
/// LiDAR. Unknown, it is taken for the LiDAR's.
void take_linked_imu_mount(Recording& recording, const FrameTree& tree, const FrameNames& names) {
  const std::string base = names.base.empty() ? tree.body_of(names.lidar) : names.base;
  const bool is_linked = recording.mount_source != kMountGiven && !base.empty();
  const std::string& from = is_linked || FrameTree::bare(names.imu) == base ? base : names.lidar;
  const Result<FrameTree::Chain> chain = tree.between(from, names.imu);
  recording.T_base_imu = recording.T_base_lidar;
  if (chain) {
    recording.T_base_imu = from == base ? chain->T_a_b : recording.T_base_lidar * chain->T_a_b;
    recording.imu_mount_source = chain->frames.size() == 1
                                     ? "the IMU is in the frame " + chain->frames.front()
                                     : format("/tf_static: {}", fmt::join(chain->frames, " -> "));
    return;
  }
  recording.imu_mount_source = "assumed";
  recording.assumptions.push_back(
      format("{}the LiDAR's, as no /tf_static links '{}' and '{}'; if the IMU's axes are others, {}",
             kImuMountAssumption, from, FrameTree::bare(names.imu), kImuMountRemedy));
}

/// The mounts of the LiDAR and of the IMU, if there is one.
Result<> take_mounts(Recording& recording, const FrameTree& tree, const FrameNames& names,
                     const RecordingConfig& config) {
  const Result<std::optional<Pose>> lidar = mount_of(config);
  if (!lidar) return tl::unexpected(lidar.error());
  const Result<std::optional<Pose>> imu = imu_mount_of(config);
  if (!imu) return tl::unexpected(imu.error());
  if (*lidar) {
    set_mount(recording, **lidar);
  } else if (Result<> linked = take_linked_mount(recording, tree, names); !linked) {
    return linked;
  }
  if (recording.imu.empty()) return {};
  if (*imu) {
    set_imu_mount(recording, **imu);
  } else {
    take_linked_imu_mount(recording, tree, names);
  }
  return {};
}

Result<ros::CloudMessage> read_cloud_message(const mcap::Reader& reader, const MessageRef& ref) {
  return reader.read(ref).and_then(
      [](const mcap::Message& message) { return ros::decode_cloud(message.data); });
}

/// Name, sensor and assumptions: adit's own metadata say them. Elsewhere "/robot_0/points" is of robot_0.
void take_metadata(Recording& recording, const mcap::Contents& contents, const std::string& topic) {
  recording.name = topic.substr(topic.starts_with('/') ? 1 : 0);
  recording.name = recording.name.substr(0, recording.name.find('/'));
  for (const mcap::Metadata& metadata : contents.metadata) {
    if (metadata.name != "adit") continue;
    const auto take = [&](const char* key, std::string& target) {
      if (const auto entry = metadata.entries.find(key); entry != metadata.entries.end())
        target = entry->second;
    };
    take("robot", recording.name);
    take("lidar", recording.lidar);
    take("imu", recording.imu_name);
    std::string assumed;
    take("assumed", assumed);
    recording.assumptions = lines_of(assumed);
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

/// Stamps, wheels, ground truth and IMU.
struct Tracks {
  std::vector<Stamp> scans;
  PoseTrack wheel;
  PoseTrack truth;
  ImuTrack imu;
};

/// Without wheels (`kNoWheel`) only the frame that they are of.
Result<PoseTrack> read_wheels(const mcap::Reader& reader, const Topics& topics,
                              const RecordingConfig& config) {
  if (config.wheel != kNoWheel) return read_poses(reader, topics.wheel);
  return body_frame(reader, topics.wheel).map([](std::string&& child) {
    return PoseTrack{{}, std::move(child), {}};
  });
}

Result<Tracks> read_tracks(const mcap::Reader& reader, const Topics& topics, const RecordingConfig& config) {
  const mcap::Contents& contents = reader.contents();
  Result<PoseTrack> wheel = read_wheels(reader, topics, config);
  if (!wheel) return tl::unexpected(wheel.error());
  Result<PoseTrack> truth = read_poses(reader, topics.truth);
  if (!truth) return tl::unexpected(truth.error());
  Result<ImuTrack> imu = read_imu(reader, messages_of(contents, topics.imu));
  if (!imu) return tl::unexpected(imu.error());
  return read_stamps(reader, messages_of(contents, topics.points), is_own_file(contents))
      .map([&](std::vector<Stamp> stamps) {
        return Tracks{std::move(stamps), std::move(*wheel), std::move(*truth), std::move(*imu)};
      });
}

Result<Recording> read_recording(const std::shared_ptr<const mcap::Reader>& reader,
                                 const RecordingConfig& config) {
  const mcap::Contents& contents = reader->contents();
  const Result<Topics> topics = choose_topics(find_topics(contents), config);
  if (!topics) return tl::unexpected(topics.error());
  Result<Tracks> tracks = read_tracks(*reader, *topics, config);
  if (!tracks) return tl::unexpected(tracks.error());
  Recording recording;
  take_metadata(recording, contents, topics->points.front().topic);
  recording.scan_stamps = std::move(tracks->scans);
  recording.wheel = std::move(tracks->wheel.poses);
  recording.wheel_covariance = tracks->wheel.covariance;
  recording.truth = std::move(tracks->truth.poses);
  recording.imu = std::move(tracks->imu.samples);
  recording.imu_covariance = tracks->imu.covariance;
  std::ranges::copy(tracks->imu.remarks, std::back_inserter(recording.assumptions));
  if (Result<> checked = check_fits_mcap(recording); !checked) return tl::unexpected(checked.error());
  const std::vector<MessageRef> scans = messages_of(contents, topics->points);
  recording.read_scan = scan_reader(reader, scans, recording.scan_stamps);
  const Result<> mounted =
      read_cloud_message(*reader, scans.front()).and_then([&](const ros::CloudMessage& first) {
        return read_frames(*reader, *topics).and_then([&](const FrameTree& tree) {
          return take_mounts(recording, tree, {tracks->wheel.child, first.frame, tracks->imu.frame}, config);
        });
      });
  if (!mounted) return tl::unexpected(mounted.error());
  return recording;
}

}  // namespace

Result<Recording> read_recording(ByteSource source, const RecordingConfig& config) {
  return mcap::Reader::open(std::move(source)).and_then([&](mcap::Reader reader) {
    return read_recording(std::make_shared<const mcap::Reader>(std::move(reader)), config);
  });
}

Result<Recording> read_recording(const std::filesystem::path& path, const RecordingConfig& config) {
  const Result<ByteSource> source = open_source(path);
  if (!source) return tl::unexpected(source.error());
  Result<Recording> recording = read_recording(*source, config);
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
