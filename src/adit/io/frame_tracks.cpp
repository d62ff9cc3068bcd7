// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/frame_tracks.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace adit {
namespace {

constexpr Duration kLinkSilence = std::chrono::milliseconds(500);

/// Beyond what encoders jitter by, and what matters at 50 m.
bool differ(const Pose& a, const Pose& b) {
  constexpr double kMetres = 1e-3;
  constexpr double kRadians = 2e-4;
  const Vector6 apart = (a.inverse() * b).log();
  return apart.head<3>().norm() > kMetres || apart.tail<3>().norm() > kRadians;
}

bool is_same(const Pose& a, const Pose& b) {
  return a.translation() == b.translation() && a.rotation().coeffs() == b.rotation().coeffs();
}

/// A frame that does not move with the robot, also behind a prefix: robot1/odom, robot1_odom.
bool is_world(const std::string& frame) {
  constexpr std::array kWorlds = {"odom", "map", "world", "earth"};
  const std::string name = frame.substr(frame.find_last_of("/_") + 1);  // npos + 1 = 0: the whole name
  return std::ranges::find(kWorlds, name) != kWorlds.end();
}

/// Of poses that stay the first and the last are enough. Stamps may go back: MovingPose puts them in order.
void append_pose(Trajectory& poses, const StampedPose& pose) {
  const std::size_t num = poses.size();
  if (num > 1 && pose.stamp > poses[num - 1].stamp && poses[num - 1].stamp > poses[num - 2].stamp &&
      is_same(poses[num - 1].T_world_body, pose.T_world_body) &&
      is_same(poses[num - 2].T_world_body, pose.T_world_body)) {
    poses.back().stamp = pose.stamp;
    return;
  }
  poses.push_back(pose);
}

std::optional<Pose> link_at(const Trajectory& poses, Stamp stamp) {
  if (stamp < poses.front().stamp || stamp > poses.back().stamp) return std::nullopt;
  const auto after = std::ranges::lower_bound(poses, stamp, {}, &StampedPose::stamp);
  if (after->stamp == stamp) return after->T_world_body;
  const StampedPose& before = *(after - 1);
  if (after->stamp - before.stamp > kLinkSilence && differ(before.T_world_body, after->T_world_body))
    return std::nullopt;
  const double s = to_seconds(stamp - before.stamp) / to_seconds(after->stamp - before.stamp);
  return interpolate(before.T_world_body, after->T_world_body, s);
}

}  // namespace

MovingPose::MovingPose(std::vector<Link> links) {
  for (Link& link : links) {
    std::ranges::stable_sort(link.poses, {}, &StampedPose::stamp);
    link.poses.erase(std::unique(link.poses.begin(), link.poses.end(),
                                 [](const auto& a, const auto& b) { return a.stamp == b.stamp; }),
                     link.poses.end());
    const bool moves = std::ranges::any_of(link.poses, [&](const StampedPose& pose) {
      return differ(link.poses.front().T_world_body, pose.T_world_body);
    });
    joints_.push_back({{std::move(link)}, moves});
  }
}

bool MovingPose::moves() const { return std::ranges::any_of(joints_, &Joint::moves); }

std::optional<Pose> MovingPose::at(Stamp stamp) const {
  Pose T_a_b;
  for (const Joint& joint : joints_) {
    const std::optional<Pose> link =
        joint.moves ? link_at(joint.poses, stamp) : joint.poses.front().T_world_body;
    if (!link) return std::nullopt;
    T_a_b = T_a_b * (joint.is_inverse ? link->inverse() : *link);
  }
  return T_a_b;
}

FrameTracks::FrameTracks(const std::string& base, std::vector<std::string> followed)
    : base_(FrameTree::bare(base)), followed_(std::move(followed)) {}

bool FrameTracks::is_of_robot(const std::string& parent, const std::string& child) const {
  return child != base_ && !is_world(parent);
}

void FrameTracks::add_static(const std::vector<ros::TransformMessage>& links) {
  for (const ros::TransformMessage& link : links) {
    const std::string parent = FrameTree::bare(link.frame);
    const std::string child = FrameTree::bare(link.child);
    if (parent == child) continue;
    tree_.add(parent, child, link.pose.T_world_body);
    tracks_.insert_or_assign(child, Track{parent, {link.pose}, true});
  }
}

void FrameTracks::add(const std::vector<ros::TransformMessage>& links) {
  for (const ros::TransformMessage& link : links) {
    const std::string parent = FrameTree::bare(link.frame);
    const std::string child = FrameTree::bare(link.child);
    if (parent == child || tracks_.contains(child) || !is_of_robot(parent, child)) continue;
    tree_.add(parent, child, link.pose.T_world_body);
    tracks_.emplace(child, Track{parent, {link.pose}});
  }
  std::set<std::string> above;
  for (const std::string& frame : followed_)
    for (std::string& name : tree_.up_to_root(FrameTree::bare(frame))) above.insert(std::move(name));
  for (const ros::TransformMessage& link : links) {
    const auto track = tracks_.find(FrameTree::bare(link.child));
    if (track != tracks_.end() && !track->second.is_static && above.contains(track->first) &&
        track->second.parent == FrameTree::bare(link.frame))
      append_pose(track->second.poses, link.pose);
  }
}

const FrameTracks::Track& FrameTracks::between(const std::string& a, const std::string& b) const {
  const auto down = tracks_.find(b);
  return down != tracks_.end() && down->second.parent == a ? down->second : tracks_.at(a);
}

bool FrameTracks::are_static(const std::vector<std::string>& frames) const {
  for (std::size_t i = 1; i < frames.size(); ++i)
    if (!between(frames[i - 1], frames[i]).is_static) return false;
  return true;
}

MovingPose FrameTracks::along(const std::vector<std::string>& frames) const {
  std::vector<MovingPose::Link> links;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Track& track = between(frames[i - 1], frames[i]);
    links.push_back({track.poses, track.parent != frames[i - 1]});
  }
  return MovingPose(std::move(links));
}

}  // namespace adit
