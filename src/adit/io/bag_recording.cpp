// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_recording.hpp"

#include <algorithm>
#include <memory>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/frame_tree.hpp"
#include "adit/io/imu_topic.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/wheel_covariance.hpp"

namespace adit {
namespace {

std::vector<BagMessage> messages_of(const Bag& bag, const TopicIndices& topics) {
  std::vector<BagMessage> messages;
  std::ranges::copy_if(bag.messages, std::back_inserter(messages), [&](const BagMessage& message) {
    return std::ranges::find(topics, message.topic) != topics.end();
  });
  return messages;
}

struct PoseTrack {
  Trajectory poses;
  std::string child;  ///< Frame of the body.
  WheelCovariance covariance = {};
  std::string warning = {};
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

Result<> check_after(Stamp stamp, const Trajectory& before, const std::string& place) {
  if (before.empty() || stamp > before.back().stamp) return {};
  return fail(format("{}: stamp {} is not after {}, that of the one before", place, stamp_text(stamp),
                     stamp_text(before.back().stamp)));
}

Result<PoseTrack> read_poses(const Bag& bag, const TopicIndices& topics) {
  PoseTrack track;
  for (const BagMessage& message : messages_of(bag, topics)) {
    const Result<ros::OdometryMessage> pose = decoded(bag, message, ros::decode_odometry);
    const std::string place = format("{}, message {}", names_of(bag, topics), track.poses.size());
    if (!pose) return fail(place, pose.error());
    if (Result<> after = check_after(pose->pose.stamp, track.poses, place); !after)
      return tl::unexpected(after.error());
    take_covariance(track.covariance, pose->covariance, track.poses.empty());
    track.poses.push_back(pose->pose);
    track.child = pose->child;
  }
  return track;
}

/// Adds up twists: between two of them their mean. A gap is driven through as if that held.
Result<PoseTrack> read_twists(const Bag& bag, const TopicIndices& topics) {
  constexpr double kLongestGap = 0.5;  // seconds
  constexpr double kFastest = 1000.0;  // m/s, rad/s: beyond it a message is damaged
  PoseTrack track;
  Vector6 last = Vector6::Zero();
  double longest = 0.0;
  for (const BagMessage& message : messages_of(bag, topics)) {
    const Result<ros::TwistMessage> twist = decoded(bag, message, ros::decode_twist);
    const std::string place = format("{}, message {}", names_of(bag, topics), track.poses.size());
    if (!twist) return fail(place, twist.error());
    if (!(twist->twist.cwiseAbs().maxCoeff() < kFastest))
      return fail(format("{}: no robot is faster than {} m/s or rad/s", place, kFastest));
    if (Result<> after = check_after(twist->stamp, track.poses, place); !after)
      return tl::unexpected(after.error());
    Pose T_odom_body;
    if (!track.poses.empty()) {
      const StampedPose& before = track.poses.back();
      const double dt = to_seconds(twist->stamp - before.stamp);
      longest = std::max(longest, dt);
      T_odom_body = before.T_world_body * Pose::exp(0.5 * dt * (last + twist->twist));
    }
    track.poses.push_back({twist->stamp, T_odom_body});
    track.child = twist->frame;
    last = twist->twist;
  }
  if (longest > kLongestGap) {
    track.warning = format("{}: a gap of {:.1f} s was driven through at the mean of the twists around it",
                           names_of(bag, topics), longest);
  }
  return track;
}

/// adit's own files are logged at the scan's stamp; others when a scan arrived, so each message must be
/// looked into.
Result<std::vector<Stamp>> read_stamps(const Bag& bag, const std::vector<BagMessage>& scans) {
  std::vector<Stamp> stamps;
  for (const BagMessage& scan : scans) {
    const Result<Stamp> stamp = bag.own ? scan.log_time : decoded(bag, scan, ros::decode_stamp);
    if (!stamp) return fail(format("scan {}", stamps.size()), stamp.error());
    stamps.push_back(*stamp);
  }
  return stamps;
}

Result<FrameTree> read_frames(const Bag& bag, const BagTopics& topics) {
  FrameTree tree;
  for (const BagMessage& message : messages_of(bag, topics.transforms)) {
    const auto transforms = decoded(bag, message, ros::decode_transforms);
    if (!transforms) return fail(bag.topics[message.topic].name, transforms.error());
    for (const ros::TransformMessage& link : *transforms)
      tree.add(link.frame, link.child, link.pose.T_world_body);
  }
  return tree;
}

/// The robot's frame as topics of wheel odometry name it that are not used; "" where they differ.
Result<std::string> body_frame(const Bag& bag, const TopicIndices& topics) {
  std::string body;
  for (const std::size_t topic : topics) {
    const std::vector<BagMessage> messages = messages_of(bag, {topic});
    if (messages.empty()) continue;
    const Result<ros::OdometryMessage> first = decoded(bag, messages.front(), ros::decode_odometry);
    if (!first) return fail(format("{}, message 0", bag.topics[topic].name), first.error());
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

Result<ros::CloudMessage> read_cloud_message(const Bag& bag, const BagMessage& message,
                                             std::optional<TimeUnit> time_unit) {
  const bool from_livox = ros::is_livox(bag.topics[message.topic].type);
  return decoded(bag, message, [&](std::string_view content, MessageEncoding encoding) {
    return from_livox ? ros::decode_livox(content, encoding)
                      : ros::decode_cloud(content, encoding, time_unit);
  });
}

/// adit's own times are nanoseconds.
Result<std::optional<TimeUnit>> time_unit_of(const Bag& bag, const RecordingConfig& config) {
  if (bag.own && config.point_times.empty()) return std::optional(TimeUnit::nanoseconds);
  return parse_time_unit(config.point_times);
}

/// Name, sensor and assumptions: adit's own metadata say them. Elsewhere "/robot_0/points" is of robot_0.
void take_metadata(Recording& recording, const Bag& bag, const std::string& topic) {
  recording.name = topic.substr(topic.starts_with('/') ? 1 : 0);
  recording.name = recording.name.substr(0, recording.name.find('/'));
  recording.warnings = bag.warnings;
  if (!bag.own) return;
  const auto take = [&](const char* key, std::string& target) {
    if (const auto entry = bag.own->find(key); entry != bag.own->end()) target = entry->second;
  };
  take("robot", recording.name);
  take("lidar", recording.lidar);
  take("imu", recording.imu_name);
  std::string assumed;
  take("assumed", assumed);
  recording.assumptions = lines_of(assumed);
}

std::function<Result<Scan>(std::size_t)> scan_reader(std::shared_ptr<const Bag> bag,
                                                     std::vector<BagMessage> scans, std::vector<Stamp> stamps,
                                                     std::optional<TimeUnit> time_unit) {
  return [bag = std::move(bag), scans = std::move(scans), stamps = std::move(stamps),
          time_unit](std::size_t i) -> Result<Scan> {
    ADIT_CHECK(i < scans.size(), "no scan of that index");
    Result<ros::CloudMessage> message = read_cloud_message(*bag, scans[i], time_unit);
    if (!message) return fail(format("scan {}", i), message.error());
    if (message->scan.stamp != stamps[i]) return fail(format("scan {}: its stamp differs from the index", i));
    return std::move(message->scan);
  };
}

/// What was found about the times of points.
void note_point_times(Recording& recording, const ros::CloudMessage& first) {
  if (!first.scan.cloud.has_times())
    recording.assumptions.push_back(
        "point times: none, so that scans are not corrected for the motion during a sweep");
  else if (!first.has_usual_time_unit)
    recording.assumptions.push_back(point_times_note(*first.time_unit));
}

/// What nobody has asked for and may be wheels.
void note_twists(Recording& recording, const Bag& bag, const BagTopics& topics,
                 const RecordingConfig& config) {
  if (!topics.wheel.empty() || topics.twists.empty() || config.wheel == kNoWheel) return;
  recording.warnings.push_back(
      format("wheels: none; if the wheels have measured {} (TwistStamped), and it is no command, give "
             "--wheel {}",
             names_of(bag, topics.twists), bag.topics[topics.twists.front()].name));
}

/// Stamps, wheels, ground truth and IMU.
struct Tracks {
  std::vector<Stamp> scans;
  PoseTrack wheel;
  PoseTrack truth;
  ImuTrack imu;
};

/// Without wheels (`kNoWheel`) only the frame that they are of.
Result<PoseTrack> read_wheels(const Bag& bag, const BagTopics& topics, const RecordingConfig& config) {
  if (config.wheel != kNoWheel) {
    const bool is_twist = !topics.wheel.empty() && bag.topics[topics.wheel.front()].type == ros::kTwist;
    return is_twist ? read_twists(bag, topics.wheel) : read_poses(bag, topics.wheel);
  }
  return body_frame(bag, topics.wheel).map([](std::string&& child) {
    return PoseTrack{{}, std::move(child)};
  });
}

Result<Tracks> read_tracks(const Bag& bag, const BagTopics& topics, const RecordingConfig& config) {
  Result<PoseTrack> wheel = read_wheels(bag, topics, config);
  if (!wheel) return tl::unexpected(wheel.error());
  Result<PoseTrack> truth = read_poses(bag, topics.truth);
  if (!truth) return tl::unexpected(truth.error());
  Result<ImuTrack> imu = read_imu(bag, messages_of(bag, topics.imu));
  if (!imu) return tl::unexpected(imu.error());
  return read_stamps(bag, messages_of(bag, topics.points)).map([&](std::vector<Stamp> stamps) {
    return Tracks{std::move(stamps), std::move(*wheel), std::move(*truth), std::move(*imu)};
  });
}

Result<Recording> recording_in(const std::shared_ptr<const Bag>& bag, RecordingConfig config) {
  while (config.topics_under.ends_with('/')) config.topics_under.pop_back();
  const Result<BagTopics> topics = choose_topics(*bag, config);
  if (!topics) return tl::unexpected(topics.error());
  const Result<std::optional<TimeUnit>> time_unit = time_unit_of(*bag, config);
  if (!time_unit) return tl::unexpected(time_unit.error());
  Result<Tracks> tracks = read_tracks(*bag, *topics, config);
  if (!tracks) return tl::unexpected(tracks.error());
  Recording recording;
  take_metadata(recording, *bag, names_of(*bag, topics->points));
  if (!config.topics_under.empty())
    recording.name = config.topics_under.substr(config.topics_under.rfind('/') + 1);
  recording.scan_stamps = std::move(tracks->scans);
  recording.wheel = std::move(tracks->wheel.poses);
  recording.wheel_covariance = tracks->wheel.covariance;
  if (!tracks->wheel.warning.empty()) recording.warnings.push_back(tracks->wheel.warning);
  note_twists(recording, *bag, *topics, config);
  recording.truth = std::move(tracks->truth.poses);
  recording.imu = std::move(tracks->imu.samples);
  recording.imu_covariance = tracks->imu.covariance;
  std::ranges::copy(tracks->imu.remarks, std::back_inserter(recording.assumptions));
  if (Result<> checked = check_fits_mcap(recording); !checked) return tl::unexpected(checked.error());
  const std::vector<BagMessage> scans = messages_of(*bag, topics->points);
  const Result<ros::CloudMessage> first = read_cloud_message(*bag, scans.front(), *time_unit);
  if (!first) return tl::unexpected(first.error());
  if (!bag->own) note_point_times(recording, *first);
  // What the first scan has shown holds for all.
  recording.read_scan = scan_reader(bag, scans, recording.scan_stamps, first->time_unit);
  const Result<> mounted = read_frames(*bag, *topics).and_then([&](const FrameTree& tree) {
    return take_mounts(recording, tree, {tracks->wheel.child, first->frame, tracks->imu.frame}, config);
  });
  if (!mounted) return tl::unexpected(mounted.error());
  return recording;
}

}  // namespace

Result<Recording> read_recording(Bag bag, const RecordingConfig& config) {
  return recording_in(std::make_shared<const Bag>(std::move(bag)), config);
}

Result<Recording> read_recording(ByteSource source, const RecordingConfig& config) {
  return open_mcap_bag(std::move(source)).and_then([&](Bag bag) {
    return read_recording(std::move(bag), config);
  });
}

Result<Recording> read_recording(const std::filesystem::path& path, const RecordingConfig& config) {
  Result<Bag> bag = open_bag(path);
  if (!bag) return tl::unexpected(bag.error());
  Result<Recording> recording = read_recording(std::move(*bag), config);
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
