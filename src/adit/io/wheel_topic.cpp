// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/wheel_topic.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/core/left_out.hpp"
#include "adit/io/ascending.hpp"
#include "adit/io/joint_odometry.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/robot/wheel_covariance.hpp"

namespace adit {
namespace {

/// What all readers of wheels share: what is left out is counted, errors and warnings name the topic.
class TopicReader : public PoseReader {
 public:
  TopicReader(const Bag& bag, std::size_t topic) : bag_(bag), topic_(bag.topics[topic].name) {}

  void add(const BagMessage& message) final {
    if (const Result<> taken = take(message))
      left_out_.take();
    else
      left_out_.leave(taken.error());
  }
  Result<PoseTrack> finish() final {
    if (const Result<> any = left_out_.unless_all(); !any) return fail(topic_, any.error());
    Result<PoseTrack> track = take_track();
    if (!track) return fail(topic_, track.error());
    if (const auto sentence = left_out_.sentence()) track->warnings.push_back(*sentence);
    for (std::string& warning : track->warnings) warning.insert(0, topic_ + ": ");
    return track;
  }

 protected:
  virtual Result<> take(const BagMessage& message) = 0;
  virtual Result<PoseTrack> take_track() = 0;
  [[nodiscard]] const Bag& bag() const { return bag_; }

 private:
  const Bag& bag_;
  std::string topic_;
  LeftOut left_out_{"messages"};
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

class OdometryReader final : public TopicReader {
 public:
  using TopicReader::TopicReader;

 protected:
  Result<> take(const BagMessage& message) override {
    return decoded(bag(), message, ros::decode_odometry).map([&](const ros::OdometryMessage& odometry) {
      take_covariance(track_.covariance, odometry.covariance, track_.poses.empty());
      track_.poses.push_back(odometry.pose);
    });
  }
  Result<PoseTrack> take_track() override {
    const std::vector<Stamp> stamps = stamps_of(track_.poses);
    const std::vector<std::size_t> kept = longest_ascending(stamps);
    track_.poses = taken(std::move(track_.poses), kept);
    if (const auto note = note_of_left_out("messages", stamps, kept)) track_.warnings.push_back(*note);
    return std::move(track_);
  }

 private:
  PoseTrack track_;
};

/// A gap is driven through as if the mean of the twists around it held.
class TwistReader final : public TopicReader {
 public:
  using TopicReader::TopicReader;

 protected:
  Result<> take(const BagMessage& message) override {
    constexpr double kFastest = 1000.0;  // m/s, rad/s: beyond it a message is damaged
    const Result<ros::TwistMessage> read = decoded(bag(), message, ros::decode_twist);
    if (!read) return tl::unexpected(read.error());
    if (!(read->twist.cwiseAbs().maxCoeff() < kFastest))
      return fail(format("no robot is faster than {} m/s or rad/s", kFastest));
    stamps_.push_back(read->stamp);
    twists_.push_back(read->twist);
    return {};
  }
  Result<PoseTrack> take_track() override {
    constexpr double kLongestGap = 0.5;  // seconds
    const std::vector<std::size_t> kept = longest_ascending(stamps_);
    PoseTrack track;
    double longest_gap = 0.0;
    for (std::size_t k = 0; k < kept.size(); ++k) {
      Pose T_odom_body;
      if (k > 0) {
        const double dt = to_seconds(stamps_[kept[k]] - stamps_[kept[k - 1]]);
        longest_gap = std::max(longest_gap, dt);
        T_odom_body =
            track.poses.back().T_world_body * Pose::exp(0.5 * dt * (twists_[kept[k - 1]] + twists_[kept[k]]));
      }
      track.poses.push_back({stamps_[kept[k]], T_odom_body});
    }
    if (longest_gap > kLongestGap)
      track.warnings.push_back(
          format("a gap of {:.1f} s was driven through at the mean of the twists around it", longest_gap));
    if (const auto note = note_of_left_out("messages", stamps_, kept)) track.warnings.push_back(*note);
    return track;
  }

 private:
  std::vector<Stamp> stamps_;
  std::vector<Vector6> twists_;
};

class JointReader final : public TopicReader {
 public:
  JointReader(const Bag& bag, std::size_t topic, JointOdometry odometry)
      : TopicReader(bag, topic), odometry_(std::move(odometry)) {}

 protected:
  Result<> take(const BagMessage& message) override {
    return decoded(bag(), message, ros::decode_joint_state).map([&](const ros::JointStateMessage& joints) {
      if (odometry_.has_wheels(joints)) odometry_.add(joints);  // drivers share the topic
    });
  }
  Result<PoseTrack> take_track() override {
    return std::move(odometry_).finish().map([](JointTrack&& joints) {
      return PoseTrack{std::move(joints.poses), {}, std::move(joints.warnings)};
    });
  }

 private:
  JointOdometry odometry_;
};

}  // namespace

Result<std::unique_ptr<PoseReader>> pose_reader(const Bag& bag, std::size_t topic,
                                                const JointDriveConfig& drive) {
  const std::string& type = bag.topics[topic].type;
  if (type == ros::kTwist) return std::make_unique<TwistReader>(bag, topic);
  if (type != ros::kJointState) return std::make_unique<OdometryReader>(bag, topic);
  Result<JointOdometry> odometry = JointOdometry::create(drive);
  if (odometry) return std::make_unique<JointReader>(bag, topic, std::move(*odometry));
  return fail(format("{}: {}; its joints are {}", bag.topics[topic].name, odometry.error().message,
                     joints_text(first_joints(bag, topic))));
}

}  // namespace adit
