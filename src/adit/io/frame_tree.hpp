// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The frames that /tf_static and /tf link, as a tree: the mount of a LiDAR is often several links away from
/// the robot's body (base_link, os_sensor, os_lidar).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Frames and the links between them.
class FrameTree {
 public:
  /// A frame id as it is compared: without the leading slash that ROS 1 allowed.
  [[nodiscard]] static std::string bare(std::string_view frame);

  /// The link from a frame to its child. A child has one parent: a later link replaces an earlier one, as in
  /// tf2. A link from a frame to itself is left out.
  void add(std::string_view frame, std::string_view child, const Pose& T_frame_child);

  /// How one frame lies in another.
  struct Chain {
    Pose T_a_b;                       ///< The product of all links between them.
    std::vector<std::string> frames;  ///< From a to b, both included.
  };
  /// The transform between two frames, whichever of them is nearer to the root. Fails when no links connect
  /// them or links run in a circle.
  [[nodiscard]] Result<Chain> between(std::string_view a, std::string_view b) const;

  /// The frame most likely to be the robot's body among those that `frame` is linked to: the first of
  /// base_footprint (on the floor), base_link, base, body (also behind a prefix, as in robot_0/base_link),
  /// else the root; "" when `frame` is in no link.
  [[nodiscard]] std::string body_of(std::string_view frame) const;

  /// From a frame (bare) to the last one that has no parent, or to the first that comes again.
  [[nodiscard]] std::vector<std::string> up_to_root(const std::string& frame) const;

  /// All frames in alphabetical order.
  [[nodiscard]] std::vector<std::string> frames() const;

 private:
  struct Link {
    std::string parent;
    Pose T_parent_child;
  };
  using Roots = std::map<std::string, std::string>;  ///< By frame.
  /// As up_to_root, but at most to a frame whose root is known.
  [[nodiscard]] std::vector<std::string> up_to(const std::string& frame, const Roots& roots) const;

  std::map<std::string, Link> links_;  ///< By child.
};

}  // namespace adit
