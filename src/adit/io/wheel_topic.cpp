// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/wheel_topic.hpp"

#include <algorithm>
#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/joint_odometry.hpp"
#include "adit/io/ros_messages.hpp"
#include "adit/io/tum.hpp"
#include "adit/robot/wheel_covariance.hpp"

namespace adit {
namespace {

/// What all readers of wheels share: the place of a message, and stamps that ascend.
class AscendingReader : public PoseReader {
 public:
  AscendingReader(const Bag& bag, std::size_t topic) : bag_(bag), topic_(bag.topics[topic].name) {}

 protected:
  template <class Decode>
  [[nodiscard]] auto next(const BagMessage& message, Decode decode) {
    place_ = format("{}, message {}", topic_, num_messages_++);
    return decoded(bag_, message, decode);
  }
  /// Whether the message is to be taken.
  [[nodiscard]] bool ascends(Stamp stamp) {
    const bool is_later = !last_ || stamp > *last_;
    if (is_later) {
      last_ = stamp;
    } else if (num_left_out_++ == 0) {
      first_left_out_ = stamp;
    }
    return is_later;
  }
  void warn_of_left_out(PoseTrack& track) const {
    if (num_left_out_ == 0) return;
    track.warnings.push_back(format(
        "{}: {} of {} messages are left out, whose stamps are not after those before (check the driver's "
        "clock); the first is at {} s",
        topic_, num_left_out_, num_messages_, stamp_text(first_left_out_)));
  }
  [[nodiscard]] const std::string& place() const { return place_; }
  [[nodiscard]] const std::string& topic() const { return topic_; }

 private:
  const Bag& bag_;
  std::string topic_;
  std::string place_;
  std::size_t num_messages_ = 0;
  std::optional<Stamp> last_;
  std::size_t num_left_out_ = 0;
  Stamp first_left_out_;
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

class OdometryReader final : public AscendingReader {
 public:
  using AscendingReader::AscendingReader;
  Result<> add(const BagMessage& message) override {
    const Result<ros::OdometryMessage> pose = next(message, ros::decode_odometry);
    if (!pose) return fail(place(), pose.error());
    if (!ascends(pose->pose.stamp)) return {};
    take_covariance(track_.covariance, pose->covariance, track_.poses.empty());
    track_.poses.push_back(pose->pose);
    return {};
  }
  Result<PoseTrack> finish() override {
    warn_of_left_out(track_);
    return std::move(track_);
  }

 private:
  PoseTrack track_;
};

/// A gap is driven through as if the mean of the twists around it held.
class TwistReader final : public AscendingReader {
 public:
  using AscendingReader::AscendingReader;
  Result<> add(const BagMessage& message) override {
    constexpr double kFastest = 1000.0;  // m/s, rad/s: beyond it a message is damaged
    const Result<ros::TwistMessage> twist = next(message, ros::decode_twist);
    if (!twist) return fail(place(), twist.error());
    if (!(twist->twist.cwiseAbs().maxCoeff() < kFastest))
      return fail(format("{}: no robot is faster than {} m/s or rad/s", place(), kFastest));
    if (!ascends(twist->stamp)) return {};
    Pose T_odom_body;
    if (!track_.poses.empty()) {
      const StampedPose& before = track_.poses.back();
      const double dt = to_seconds(twist->stamp - before.stamp);
      longest_gap_ = std::max(longest_gap_, dt);
      T_odom_body = before.T_world_body * Pose::exp(0.5 * dt * (last_ + twist->twist));
    }
    track_.poses.push_back({twist->stamp, T_odom_body});
    last_ = twist->twist;
    return {};
  }
  Result<PoseTrack> finish() override {
    constexpr double kLongestGap = 0.5;  // seconds
    if (longest_gap_ > kLongestGap) {
      track_.warnings.push_back(
          format("{}: a gap of {:.1f} s was driven through at the mean of the twists around it", topic(),
                 longest_gap_));
    }
    warn_of_left_out(track_);
    return std::move(track_);
  }

 private:
  PoseTrack track_;
  Vector6 last_ = Vector6::Zero();
  double longest_gap_ = 0.0;
};

class JointReader final : public AscendingReader {
 public:
  JointReader(const Bag& bag, std::size_t topic, JointOdometry odometry)
      : AscendingReader(bag, topic), odometry_(std::move(odometry)) {}
  Result<> add(const BagMessage& message) override {
    const Result<ros::JointStateMessage> joints = next(message, ros::decode_joint_state);
    if (!joints) return fail(place(), joints.error());
    // Drivers share the topic; only messages with the wheels have to ascend.
    if (!odometry_.has_wheels(*joints) || !ascends(joints->stamp)) return {};
    odometry_.add(*joints);
    return {};
  }
  Result<PoseTrack> finish() override {
    Result<JointTrack> joints = std::move(odometry_).finish();
    if (!joints) return fail(topic(), joints.error());
    PoseTrack track{std::move(joints->poses), {}};
    for (const std::string& warning : joints->warnings) track.warnings.push_back(topic() + ": " + warning);
    warn_of_left_out(track);
    return track;
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
