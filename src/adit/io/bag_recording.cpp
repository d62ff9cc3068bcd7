// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_recording.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "adit/core/format.hpp"
#include "adit/core/left_out.hpp"
#include "adit/io/ascending.hpp"
#include "adit/io/bag_clouds.hpp"
#include "adit/io/bag_mounts.hpp"
#include "adit/io/bag_pass.hpp"
#include "adit/io/bag_topics.hpp"
#include "adit/io/frame_tracks.hpp"
#include "adit/io/imu_topic.hpp"
#include "adit/io/joint_odometry.hpp"
#include "adit/io/moving_lidar.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/text.hpp"
#include "adit/io/wheel_topic.hpp"

namespace adit {
namespace {

/// What `decode` makes of the first message of these topics that is not damaged, if there is one.
template <class Decode>
auto first_decoded(const Bag& bag, const TopicIndices& topics, const Decode& decode) {
  auto first = std::optional<typename decltype(decoded(bag, bag.messages.front(), decode))::value_type>();
  for (const BagMessage& message : bag.messages) {
    if (std::ranges::find(topics, message.topic) == topics.end()) continue;
    if (auto read = decoded(bag, message, decode)) {
      first = *std::move(read);
      break;
    }
  }
  return first;
}

/// The robot's frame as the first messages of wheels name it; "" where they differ, or do not.
std::string body_frame(const Bag& bag, const TopicIndices& topics) {
  std::string body;
  for (const std::size_t topic : topics) {
    if (bag.topics[topic].type == ros::kJointState) continue;
    std::optional<std::string> frame;
    if (bag.topics[topic].type == ros::kTwist) {
      if (const auto header = first_decoded(bag, {topic}, ros::decode_header)) frame = header->frame;
    } else if (const auto odometry = first_decoded(bag, {topic}, ros::decode_odometry)) {
      frame = odometry->child;
    }
    if (!frame) continue;
    if (!body.empty() && FrameTree::bare(body) != FrameTree::bare(*frame)) return "";
    body = *frame;
  }
  return body;
}

/// What is read of all messages, in one pass.
struct Tracks {
  std::vector<BagMessage> scans;
  std::vector<Stamp> stamps;
  std::vector<std::string> warnings;  // about scans
  std::size_t num_left_out = 0;       // Recording::num_scans_left_out
  PoseTrack wheel;
  PoseTrack truth;
  ImuTrack imu;
  FrameTracks frames{"", {}};
};

/// Leaves the scans at whose time the pose of a LiDAR that moves on the robot is known; the place of the
/// first is the mount.
Result<> leave_scans_with_pose(Recording& recording, Tracks& tracks, const MovingPose& T_base_lidar) {
  std::vector<BagMessage> scans;
  std::vector<Stamp> stamps;
  for (std::size_t i = 0; i < tracks.stamps.size(); ++i) {
    if (!T_base_lidar.at(tracks.stamps[i])) continue;
    scans.push_back(tracks.scans[i]);
    stamps.push_back(tracks.stamps[i]);
  }
  if (stamps.empty())
    return fail(
        format("the LiDAR moves on the robot ({}), and /tf never says where it was at a scan's time: "
               "look at the clocks with adit info, or {}",
               recording.mount_source, kMountRemedy));
  const std::size_t num_without = tracks.stamps.size() - stamps.size();
  recording.num_scans_left_out += num_without;
  if (num_without > 0)
    recording.warnings.push_back(format(
        "{} of {} scans are left out, as /tf does not say where the LiDAR was then ({}); --mount takes it "
        "for fixed",
        num_without, tracks.stamps.size(), recording.mount_source));
  tracks.scans = std::move(scans);
  tracks.stamps = std::move(stamps);
  recording.T_base_lidar = *T_base_lidar.at(tracks.stamps.front());
  recording.clouds_in_mount_frame = false;
  recording.mount_source += ", which moves; scans are given as from the place of the first";
  return {};
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

/// How the messages of clouds become scans.
struct ScanReading {
  std::shared_ptr<const Bag> bag;
  KnownTimes times;
  bool stamp_at_end = false;
  std::optional<MovingPose> T_base_moving;  ///< Of a LiDAR that moves on the robot.
  Pose T_base_lidar;
};

std::function<Result<Scan>(std::size_t)> scan_reader(ScanReading reading, std::vector<BagMessage> scans,
                                                     std::vector<Stamp> stamps) {
  return [reading = std::move(reading), scans = std::move(scans),
          stamps = std::move(stamps)](std::size_t i) -> Result<Scan> {
    ADIT_CHECK(i < scans.size(), "no scan of that index");
    Result<ros::CloudMessage> message = read_cloud_message(*reading.bag, scans[i], reading.times);
    if (!message) return fail(format("scan {}", i), message.error());
    Scan& scan = message->scan;
    if (scan.stamp != stamps[i]) return fail(format("scan {}: its stamp differs from the index", i));
    if (reading.stamp_at_end) {
      if (Result<> moved = put_stamp_at_end(scan); !moved) return fail(format("scan {}", i), moved.error());
    }
    if (reading.T_base_moving) hold_still(scan, *reading.T_base_moving, reading.T_base_lidar);
    return std::move(scan);
  };
}

/// What nobody has asked for and may be wheels.
void note_other_wheels(Recording& recording, const Bag& bag, const BagTopics& topics,
                       const RecordingConfig& config) {
  if (!topics.wheel.empty() || config.wheel == kNoWheel) return;
  if (!topics.twists.empty())
    recording.warnings.push_back(
        format("wheels: none; if the wheels have measured {} (TwistStamped), and it is no command, give "
               "--wheel {}",
               names_of(bag, topics.twists), bag.topics[topics.twists.front()].name));
  for (const std::size_t topic : topics.joints) {
    const std::vector<std::string> joints = first_joints(bag, topic);
    recording.warnings.push_back(
        format("wheels: none; if {} has the wheels' joints (there are: {}), give --wheel {} {}",
               bag.topics[topic].name, joints_text(joints), bag.topics[topic].name, drive_options(joints)));
  }
}

FrameNames frame_names(const Bag& bag, const BagTopics& topics, const std::string& lidar) {
  FrameNames names{body_frame(bag, topics.wheel), lidar, {}};
  if (const auto imu = first_decoded(bag, topics.imu, ros::decode_header)) names.imu = imu->frame;
  return names;
}

/// Adds the links of some topics. Static ones go first, wherever they stand.
BagPass::Visit into(const Bag& bag, FrameTracks& frames, LeftOut& left_out,
                    void (FrameTracks::*add)(const std::vector<ros::TransformMessage>&)) {
  return [&bag, &frames, &left_out, add](const BagMessage& message) {
    const auto transforms = decoded(bag, message, ros::decode_transforms);
    if (!transforms) return left_out.leave(transforms.error());
    for (const Error& reason : transforms->left_out) left_out.leave(reason);
    for (std::size_t i = 0; i < transforms->links.size(); ++i) left_out.take();
    (frames.*add)(transforms->links);
  };
}

/// A reader of at most one topic, which takes part in the pass.
Result<std::unique_ptr<PoseReader>> reader_in(BagPass& pass, const Bag& bag, const TopicIndices& topics,
                                              const JointDriveConfig& drive) {
  if (topics.empty()) return std::unique_ptr<PoseReader>();
  Result<std::unique_ptr<PoseReader>> reader = pose_reader(bag, topics.front(), drive);
  if (reader) pass.add(topics, [reader = reader->get()](const BagMessage& message) { reader->add(message); });
  return reader;
}

Result<PoseTrack> finished(const std::unique_ptr<PoseReader>& reader) {
  return reader ? reader->finish() : PoseTrack();
}

/// adit's own files are logged at the scan's stamp; others when a scan arrived, so each message must be
/// looked into.
BagPass::Visit stamps_into(const Bag& bag, Tracks& tracks, LeftOut& left_out) {
  return [&bag, &tracks, &left_out](const BagMessage& scan) {
    const Result<Stamp> stamp = bag.own ? scan.log_time : decoded(bag, scan, ros::decode_stamp);
    if (!stamp) return left_out.leave(stamp.error());
    left_out.take();
    tracks.scans.push_back(scan);
    tracks.stamps.push_back(*stamp);
  };
}

/// Of the scans that are not kept, those that no other stands for: a scan that was sent twice costs nothing.
std::size_t num_lost(const Tracks& tracks, const std::vector<std::size_t>& kept) {
  constexpr double kTogether = 1.0;  // seconds between the times of recording of one scan that was sent twice
  std::size_t num = 0;
  for (std::size_t i = 0, next = 0; i < tracks.stamps.size(); ++i) {
    if (next < kept.size() && kept[next] == i) {
      ++next;
      continue;
    }
    const auto twin =
        std::ranges::lower_bound(kept, tracks.stamps[i], {}, [&](std::size_t k) { return tracks.stamps[k]; });
    const bool is_there =
        twin != kept.end() && tracks.stamps[*twin] == tracks.stamps[i] &&
        std::abs(to_seconds(tracks.scans[*twin].log_time - tracks.scans[i].log_time)) < kTogether;
    num += is_there ? 0U : 1U;
  }
  return num;
}

/// Leaves out scans whose stamps do not ascend with the others'.
Result<> put_in_order(Tracks& tracks, const std::string& topic) {
  const std::vector<std::size_t> kept = longest_ascending(tracks.stamps);
  tracks.num_left_out += num_lost(tracks, kept);
  const std::optional<std::string> note = note_of_left_out("scans", tracks.stamps, kept);
  if (note && kept.size() < 2) return fail(topic + ": " + *note);
  if (note) tracks.warnings.push_back(topic + ": " + *note);
  tracks.scans = taken(std::move(tracks.scans), kept);
  tracks.stamps = taken(std::move(tracks.stamps), kept);
  return {};
}

Result<Tracks> read_tracks(const Bag& bag, const BagTopics& topics, const RecordingConfig& config,
                           const FrameNames& names) {
  Tracks tracks;
  tracks.frames = FrameTracks(names.base, {names.lidar, names.imu});
  LeftOut static_links("links");
  BagPass first_pass(bag);
  first_pass.add(topics.static_transforms, into(bag, tracks.frames, static_links, &FrameTracks::add_static));
  first_pass.run(bag);
  LeftOut links("links");
  BagPass pass(bag);
  if (config.mount.empty() || config.imu_mount.empty())
    pass.add(topics.transforms, into(bag, tracks.frames, links, &FrameTracks::add));
  LeftOut scans("scans");
  pass.add(topics.points, stamps_into(bag, tracks, scans));
  ImuReader imu(bag);
  pass.add(topics.imu, [&](const BagMessage& message) { imu.add(message); });
  const bool has_wheels = config.wheel != kNoWheel;
  const auto wheel = reader_in(pass, bag, has_wheels ? topics.wheel : TopicIndices(), config.drive);
  if (!wheel) return tl::unexpected(wheel.error());
  const auto truth = reader_in(pass, bag, topics.truth, {});
  if (!truth) return tl::unexpected(truth.error());
  pass.run(bag);
  if (const Result<> any = scans.unless_all(); !any) return fail(names_of(bag, topics.points), any.error());
  const auto warn = [&](const TopicIndices& of, const LeftOut& left_out) {
    if (const auto sentence = left_out.sentence())
      tracks.warnings.push_back(names_of(bag, of) + ": " + *sentence);
  };
  warn(topics.points, scans);
  tracks.num_left_out += scans.num();
  warn(topics.static_transforms, static_links);
  warn(topics.transforms, links);
  if (Result<> done = put_in_order(tracks, names_of(bag, topics.points)); !done)
    return tl::unexpected(done.error());
  Result<PoseTrack> wheels = finished(*wheel);
  if (!wheels) return tl::unexpected(wheels.error());
  tracks.wheel = std::move(*wheels);
  tracks.imu = imu.finish();
  return finished(*truth).map([&](PoseTrack poses) {
    tracks.truth = std::move(poses);
    return std::move(tracks);
  });
}

/// All that does not need the mounts.
Recording recording_of(Tracks& tracks, const Bag& bag, const BagTopics& topics,
                       const RecordingConfig& config) {
  Recording recording;
  take_metadata(recording, bag, names_of(bag, topics.points));
  if (!config.topics_under.empty())
    recording.name = config.topics_under.substr(config.topics_under.rfind('/') + 1);
  std::ranges::copy(tracks.warnings, std::back_inserter(recording.warnings));
  recording.num_scans_left_out = tracks.num_left_out;
  recording.wheel = std::move(tracks.wheel.poses);
  recording.wheel_covariance = tracks.wheel.covariance;
  std::ranges::copy(tracks.wheel.warnings, std::back_inserter(recording.warnings));
  std::ranges::copy(tracks.truth.warnings, std::back_inserter(recording.warnings));
  note_other_wheels(recording, bag, topics, config);
  recording.truth = std::move(tracks.truth.poses);
  recording.imu = std::move(tracks.imu.samples);
  recording.imu_covariance = tracks.imu.covariance;
  std::ranges::copy(tracks.imu.remarks, std::back_inserter(recording.assumptions));
  return recording;
}

Result<Recording> recording_in(const std::shared_ptr<const Bag>& bag, RecordingConfig config) {
  while (config.topics_under.ends_with('/')) config.topics_under.pop_back();
  if (Result<> checked = check_stamp_at(config); !checked) return tl::unexpected(checked.error());
  const Result<BagTopics> topics = choose_topics(*bag, config);
  if (!topics) return tl::unexpected(topics.error());
  const Result<KnownTimes> stated = stated_times(*bag, config);
  if (!stated) return tl::unexpected(stated.error());
  const Result<ros::CloudMessage> first = first_cloud(*bag, topics->points, *stated);
  if (!first) return tl::unexpected(first.error());
  const FrameNames names = frame_names(*bag, *topics, first->frame);
  Result<Tracks> tracks = read_tracks(*bag, *topics, config, names);
  if (!tracks) return tl::unexpected(tracks.error());
  Recording recording = recording_of(*tracks, *bag, *topics, config);
  const KnownTimes times = known_after(first->times, *stated);
  const bool at_end = stamp_at_end(*bag, tracks->scans, times, config);
  note_point_times(recording, *bag, *first, at_end, config);
  const Result<std::optional<MovingPose>> moving = take_lidar_mount(recording, tracks->frames, names, config);
  if (!moving) return tl::unexpected(moving.error());
  if (*moving) {
    if (Result<> left = leave_scans_with_pose(recording, *tracks, **moving); !left)
      return tl::unexpected(left.error());
  }
  if (Result<> taken = take_imu_mount(recording, tracks->frames, names, config); !taken)
    return tl::unexpected(taken.error());
  recording.scan_stamps = tracks->stamps;
  if (Result<> checked = check_fits_mcap(recording); !checked) return tl::unexpected(checked.error());
  recording.read_scan = scan_reader({bag, times, at_end, *moving, recording.T_base_lidar},
                                    std::move(tracks->scans), std::move(tracks->stamps));
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
  const std::vector<std::string> warnings = bag->warnings;
  Result<Recording> recording = read_recording(std::move(*bag), config);
  if (!recording && !warnings.empty())  // what is missing may lie in what could not be read
    return fail(format("{}: {} ({})", path.string(), recording.error().message, fmt::join(warnings, "; ")));
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
