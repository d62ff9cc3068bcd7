// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The frames that /tf links over time, beside those of /tf_static: a LiDAR may sit on a mast that turns.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/io/frame_tree.hpp"
#include "adit/io/ros_messages.hpp"

namespace adit {

/// The pose of a frame in another one, over links of which some may move.
class MovingPose {
 public:
  /// One link. Of one that does not move the first pose is for all times.
  struct Link {
    Trajectory poses;         ///< At least one.
    bool is_inverse = false;  ///< Walked from the child to its parent.
  };
  /// `links` in their order from the one frame to the other, each with its poses in any order.
  explicit MovingPose(std::vector<Link> links);

  /// Whether a link ever leaves its first pose by more than 1 mm or 0.2 mrad.
  [[nodiscard]] bool moves() const;
  /// Interpolated; none outside the span of a link that moves, and in a silence of more than half a second
  /// in which it moved.
  [[nodiscard]] std::optional<Pose> at(Stamp stamp) const;

 private:
  struct Joint : Link {
    bool moves = false;
  };
  std::vector<Joint> joints_;
};

/// Collects links. What leads from a world or an odometry frame to the robot is left out.
class FrameTracks {
 public:
  /// `base`: the robot's frame, "" where it is not known; `followed`: the sensors' frames. Only links above
  /// these are kept over time.
  FrameTracks(const std::string& base, std::vector<std::string> followed);

  /// Of /tf_static, all before those of `add`: they hold for all times and go before those of /tf.
  void add_static(const std::vector<ros::TransformMessage>& links);
  /// Of /tf. A child that is known, from /tf_static or under another parent, keeps its link.
  void add(const std::vector<ros::TransformMessage>& links);

  /// Links that move as they were first.
  [[nodiscard]] const FrameTree& tree() const { return tree_; }
  /// Whether /tf_static has all links along `frames`.
  [[nodiscard]] bool are_static(const std::vector<std::string>& frames) const;
  /// Along `frames`, as FrameTree::Chain has them.
  [[nodiscard]] MovingPose along(const std::vector<std::string>& frames) const;

 private:
  struct Track {
    std::string parent;
    Trajectory poses;
    bool is_static = false;
  };
  /// The track of the link between neighbours of a chain.
  [[nodiscard]] const Track& between(const std::string& a, const std::string& b) const;
  [[nodiscard]] bool is_of_robot(const std::string& parent, const std::string& child) const;

  std::string base_;
  std::vector<std::string> followed_;
  FrameTree tree_;
  std::map<std::string, Track> tracks_;  ///< By child; of those not followed the first pose alone.
};

}  // namespace adit
