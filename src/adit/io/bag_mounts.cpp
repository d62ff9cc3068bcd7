// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/bag_mounts.hpp"

#include <utility>

#include "adit/core/format.hpp"
#include "adit/io/mount.hpp"

namespace adit {
namespace {

/// "/tf_static: base_link -> os_lidar"
std::string source_of(const FrameTracks& frames, const FrameTree::Chain& chain) {
  return format("{}: {}", frames.are_static(chain.frames) ? "/tf_static" : "/tf",
                fmt::join(chain.frames, " -> "));
}

/// The mount as the links have it, or how it moves; unknown is an error, never the identity.
Result<std::optional<MovingPose>> take_linked_mount(Recording& recording, const FrameTracks& frames,
                                                    FrameNames names) {
  const FrameTree& tree = frames.tree();
  if (names.base.empty()) names.base = tree.body_of(names.lidar);
  if (names.base.empty()) {
    return fail(
        format("nothing says where the LiDAR sits on the robot: no /tf_static links its frame '{}'; {}",
               names.lidar, kMountRemedy));
  }
  const Result<FrameTree::Chain> chain = tree.between(names.base, names.lidar);
  if (!chain) {
    return fail(
        format("/tf_static does not say where the LiDAR sits on the robot: {} (frames that it links: {}); {}",
               chain.error().message, fmt::join(tree.frames(), ", "), kMountRemedy));
  }
  recording.T_base_lidar = chain->T_a_b;
  recording.mount_source = chain->frames.size() == 1
                               ? "the wheel odometry is of the LiDAR's own frame " + chain->frames.front()
                               : source_of(frames, *chain);
  MovingPose T_base_lidar = frames.along(chain->frames);
  return T_base_lidar.moves() ? std::optional(std::move(T_base_lidar)) : std::nullopt;
}

/// The IMU's mount as the links have it, from the robot or, where the user gave the LiDAR's mount, from the
/// LiDAR. Unknown, it is taken for the LiDAR's.
void take_linked_imu_mount(Recording& recording, const FrameTracks& frames, const FrameNames& names) {
  const FrameTree& tree = frames.tree();
  const std::string base = names.base.empty() ? tree.body_of(names.lidar) : names.base;
  const bool is_linked = recording.mount_source != kMountGiven && !base.empty();
  const std::string& from = is_linked || FrameTree::bare(names.imu) == base ? base : names.lidar;
  const Result<FrameTree::Chain> chain = tree.between(from, names.imu);
  recording.T_base_imu = recording.T_base_lidar;
  if (chain && frames.along(chain->frames).moves()) {
    recording.imu.clear();
    recording.assumptions.push_back(
        format("imu: it is left out, as it moves on the robot ({}); if it does not, give --imu-mount",
               source_of(frames, *chain)));
    return;
  }
  if (chain) {
    recording.T_base_imu = from == base ? chain->T_a_b : recording.T_base_lidar * chain->T_a_b;
    recording.imu_mount_source = chain->frames.size() == 1
                                     ? "the IMU is in the frame " + chain->frames.front()
                                     : source_of(frames, *chain);
    return;
  }
  recording.imu_mount_source = "assumed";
  recording.assumptions.push_back(
      format("{}the LiDAR's, as no /tf_static links '{}' and '{}'; if the IMU's axes are others, {}",
             kImuMountAssumption, from, FrameTree::bare(names.imu), kImuMountRemedy));
}

}  // namespace

Result<std::optional<MovingPose>> take_lidar_mount(Recording& recording, const FrameTracks& frames,
                                                   const FrameNames& names, const RecordingConfig& config) {
  const Result<std::optional<Pose>> given = mount_of(config);
  if (!given) return tl::unexpected(given.error());
  if (!*given) return take_linked_mount(recording, frames, names);
  set_mount(recording, **given);
  return std::optional<MovingPose>();
}

Result<> take_imu_mount(Recording& recording, const FrameTracks& frames, const FrameNames& names,
                        const RecordingConfig& config) {
  const Result<std::optional<Pose>> given = imu_mount_of(config);
  if (!given) return tl::unexpected(given.error());
  if (recording.imu.empty()) return {};
  if (*given) {
    set_imu_mount(recording, **given);
  } else {
    take_linked_imu_mount(recording, frames, names);
  }
  return {};
}

}  // namespace adit
