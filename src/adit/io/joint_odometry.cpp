// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/joint_odometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "adit/core/format.hpp"
#include "adit/io/ascending.hpp"
#include "adit/io/text.hpp"
#include "adit/robot/scan_loop.hpp"

namespace adit {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kFastestWheel = 30.0;      // m/s: no vehicle underground is faster
constexpr double kShortestInterval = 0.02;  // seconds; stamps may jitter

/// Names apart by commas or blanks.
std::vector<std::string> names_in(std::string text) {
  std::ranges::replace(text, ',', ' ');
  const std::vector<std::string_view> words = split_words(text);
  return {words.begin(), words.end()};
}

/// What is missing of the description; empty when nothing is.
std::vector<std::string> missing_in(const JointDriveConfig& drive) {
  std::vector<std::string> missing;
  const bool steers = !names_in(drive.steering).empty();
  const bool has_left = !names_in(drive.left).empty();
  const bool has_right = !names_in(drive.right).empty();
  if (!has_left && (!steers || !has_right)) missing.emplace_back("left");
  if (!has_right && !steers) missing.emplace_back("right");
  if (!(drive.wheel_radius > 0.0)) missing.emplace_back("wheel_radius");
  if (!steers && !(drive.track_width > 0.0)) missing.emplace_back("track_width");
  if (steers && !(drive.wheelbase > 0.0)) missing.emplace_back("wheelbase");
  return missing;
}

}  // namespace

Result<JointOdometry> JointOdometry::create(const JointDriveConfig& drive) {
  const std::vector<std::string> missing = missing_in(drive);
  if (missing.empty()) return JointOdometry(drive);
  return fail(
      format("joints are wheels once the drive is described; missing: recording.drive.{} (--set, or in the "
             "configuration; wheels by side, or with the joints that steer and the wheelbase)",
             fmt::join(missing, ", recording.drive.")));
}

JointOdometry::JointOdometry(JointDriveConfig drive) : drive_(std::move(drive)) {
  const auto take = [&](const std::string& names) {
    for (const std::string& name : names_in(names)) {
      const bool is_turned_round = name.starts_with('-');
      joints_.push_back({name.substr(is_turned_round ? 1 : 0), is_turned_round ? -1.0 : 1.0});
    }
    return joints_.size();
  };
  num_left_ = take(drive_.left);
  num_wheels_ = take(drive_.right);
  take(drive_.steering);
}

std::optional<double> JointOdometry::value_of(const ros::JointStateMessage& message, std::size_t joint,
                                              const std::vector<double>& values) const {
  const auto name = std::ranges::find(message.names, joints_[joint].name);
  const auto index = static_cast<std::size_t>(name - message.names.begin());
  if (name == message.names.end() || index >= values.size() || !std::isfinite(values[index]))
    return std::nullopt;
  return joints_[joint].sign * values[index];
}

bool JointOdometry::has_wheels(const ros::JointStateMessage& message) {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const bool may_be_velocity = j < num_wheels_;
    if (value_of(message, j, message.positions) ||
        (may_be_velocity && value_of(message, j, message.velocities)))
      continue;
    constexpr std::size_t kMost = 1000;  // names kept
    for (const std::string& name : message.names)
      if (seen_.size() < kMost && std::ranges::find(seen_, name) == seen_.end()) seen_.push_back(name);
    return false;
  }
  return true;
}

void JointOdometry::add(const ros::JointStateMessage& message) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  stamps_.push_back(message.stamp);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    angles_.push_back(value_of(message, j, message.positions).value_or(kNone));
    velocities_.push_back(value_of(message, j, message.velocities).value_or(kNone));
  }
}

double JointOdometry::angle(std::size_t sample, std::size_t joint) const {
  return angles_[sample * joints_.size() + joint];
}

double JointOdometry::velocity(std::size_t sample, std::size_t joint) const {
  return velocities_[sample * joints_.size() + joint];
}

/// Drivers that know velocities only leave angles out or at one value.
bool JointOdometry::has_moving_angles() const {
  bool moves = false;
  bool rolls = false;
  for (std::size_t i = 0; i < stamps_.size(); ++i) {
    for (std::size_t j = 0; j < num_wheels_; ++j) {
      if (!std::isfinite(angle(i, j))) return false;
      moves = moves || angle(i, j) != angle(0, j);
      rolls = rolls || std::abs(velocity(i, j)) > 0.0;  // not of NaN
    }
  }
  return moves || !rolls;
}

bool JointOdometry::is_wrapped(std::size_t joint) const {
  constexpr double kRounding = 0.01;
  double low = angle(0, joint);
  double high = low;
  bool leaps = false;
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    low = std::min(low, angle(i, joint));
    high = std::max(high, angle(i, joint));
    leaps = leaps || std::abs(angle(i, joint) - angle(i - 1, joint)) > 0.5 * kTurn;
  }
  return leaps && high - low <= kTurn + kRounding;
}

/// Metres of each wheel since the sample before.
std::vector<double> JointOdometry::rolled(std::size_t sample) const {
  std::vector<double> metres;
  const double dt = to_seconds(stamps_[sample] - stamps_[sample - 1]);
  for (std::size_t j = 0; j < num_wheels_; ++j) {
    double turned = 0.5 * dt * (velocity(sample, j) + velocity(sample - 1, j));
    if (by_angles_) turned = angle(sample, j) - angle(sample - 1, j);
    if (by_angles_ && wrapped_[j]) turned = std::remainder(turned, kTurn);
    metres.push_back(turned * drive_.wheel_radius);
  }
  return metres;
}

double JointOdometry::curvature(std::size_t sample) const {
  double sum = 0.0;
  double product = 1.0;
  const std::size_t num = joints_.size() - num_wheels_;
  for (std::size_t j = num_wheels_; j < joints_.size(); ++j) {
    const double tangent = std::tan(angle(sample, j));
    sum += tangent;
    product *= tangent;
  }
  // Of two wheels that point to sides of their own no centre is known but the mean of their directions.
  const bool has_centre = num == 2 && product > 0.0;
  const double tangent = has_centre ? 2.0 * product / sum : sum / static_cast<double>(num);
  return tangent / drive_.wheelbase;
}

/// The motion of the axle since the sample before.
Pose JointOdometry::step(std::size_t sample) const {
  const std::vector<double> metres = rolled(sample);
  const auto mean = [&](std::size_t begin, std::size_t end) {
    double sum = 0.0;
    for (std::size_t j = begin; j < end; ++j) sum += metres[j];
    return sum / static_cast<double>(end - begin);
  };
  Vector6 twist = Vector6::Zero();
  if (drive_.steering.empty()) {
    const double left = mean(0, num_left_);
    const double right = mean(num_left_, num_wheels_);
    twist[0] = 0.5 * (left + right);
    twist[5] = (right - left) / drive_.track_width;
  } else {
    twist[0] = mean(0, num_wheels_);
    twist[5] = twist[0] * 0.5 * (curvature(sample - 1) + curvature(sample));
  }
  return Pose::exp(twist);
}

/// Leaves out samples whose stamps do not ascend with the others', and says so.
std::optional<std::string> JointOdometry::put_in_order() {
  const std::vector<std::size_t> kept = longest_ascending(stamps_);
  const std::optional<std::string> note = note_of_left_out("messages", stamps_, kept);
  if (!note) return note;
  std::vector<double> angles;
  std::vector<double> velocities;
  for (const std::size_t sample : kept)
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      angles.push_back(angle(sample, j));
      velocities.push_back(velocity(sample, j));
    }
  angles_ = std::move(angles);
  velocities_ = std::move(velocities);
  stamps_ = taken(std::move(stamps_), kept);
  return note;
}

Result<JointTrack> JointOdometry::finish() && {
  if (stamps_.empty()) {
    std::vector<std::string> wanted;
    for (const Joint& joint : joints_) wanted.push_back(joint.name);
    std::ranges::sort(seen_);
    return fail(format("no message has all of {} with finite angles or velocities; its joints are {}",
                       joints_text(wanted), joints_text(seen_)));
  }
  const std::optional<std::string> left_out = put_in_order();
  by_angles_ = has_moving_angles();
  const auto wheels_have_velocities = [&] {
    for (std::size_t i = 0; i < stamps_.size(); ++i)
      for (std::size_t j = 0; j < num_wheels_; ++j)
        if (!std::isfinite(velocity(i, j))) return false;
    return true;
  };
  if (!by_angles_ && !wheels_have_velocities())
    return fail("some of its messages have no angles of the wheels, and some no velocities");
  for (std::size_t j = 0; j < num_wheels_; ++j) wrapped_.push_back(by_angles_ && is_wrapped(j));
  JointTrack track;
  const Pose T_base_axle = Pose::translation_of(drive_.axle_x, 0.0, 0.0);
  Pose T_odom_axle = T_base_axle;
  track.poses.push_back({stamps_.front(), Pose()});
  std::size_t num_jumps = 0;
  bool is_silent = false;
  for (std::size_t i = 1; i < stamps_.size(); ++i) {
    const double dt = to_seconds(stamps_[i] - stamps_[i - 1]);
    const std::vector<double> metres = rolled(i);
    const bool jumps = std::ranges::any_of(
        metres, [&](double d) { return !(std::abs(d) <= kFastestWheel * std::max(dt, kShortestInterval)); });
    num_jumps += jumps ? 1 : 0;
    is_silent = jumps || (is_silent && stamps_[i] - track.poses.back().stamp <= kWheelSilence);
    if (!jumps) T_odom_axle = T_odom_axle * step(i);
    if (!is_silent) track.poses.push_back({stamps_[i], T_odom_axle * T_base_axle.inverse()});
  }
  if (num_jumps > 0)
    track.warnings.push_back(format(
        "{} jumps of more than {} m/s (a driver that was started again, or another wheel_radius); for a "
        "second after each the wheels are not used",
        num_jumps, kFastestWheel));
  if (left_out) track.warnings.push_back(*left_out);
  return track;
}

std::vector<std::string> first_joints(const Bag& bag, std::size_t topic) {
  constexpr int kMessages = 20;  // drivers that share a topic take turns
  std::set<std::string> names;
  int num = 0;
  for (const BagMessage& message : bag.messages) {
    if (message.topic != topic) continue;
    if (const auto joints = decoded(bag, message, ros::decode_joint_state))
      names.insert(joints->names.begin(), joints->names.end());
    if (++num == kMessages) break;
  }
  return {names.begin(), names.end()};
}

std::string joints_text(const std::vector<std::string>& joints) {
  constexpr std::ptrdiff_t kShown = 20;
  const std::ptrdiff_t num = std::ssize(joints);
  const auto shown = std::vector(joints.begin(), joints.begin() + std::min(num, kShown));
  return format("{}{}", joints.empty() ? "none" : format("{}", fmt::join(shown, ", ")),
                num > kShown ? format(" and {} more", num - kShown) : "");
}

std::string drive_options(const std::vector<std::string>& joints) {
  const auto wheels_of = [&](std::string_view side) {
    std::vector<std::string> names;
    for (const std::string& joint : joints) {
      const std::string name = lower_case(joint);
      if (name.find("wheel") != std::string::npos && name.find(side) != std::string::npos &&
          name.find("steer") == std::string::npos)
        names.push_back(joint);
    }
    return names.empty() ? std::string("JOINTS") : shell_quoted(format("{}", fmt::join(names, ",")));
  };
  return format(
      "--set recording.drive.left={} --set recording.drive.right={} --set "
      "recording.drive.wheel_radius=METRES "
      "--set recording.drive.track_width=METRES",
      wheels_of("left"), wheels_of("right"));
}

}  // namespace adit
