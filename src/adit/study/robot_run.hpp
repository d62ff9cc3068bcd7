// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The drives of a study: every robot of a world under every odometry that is compared.
#pragma once

#include <memory>
#include <vector>

#include "adit/evaluation/study_result.hpp"
#include "adit/slam/run_config.hpp"

namespace adit {

/// One robot after its drive.
struct RobotRun {
  std::shared_ptr<const RobotMap> map;        ///< By the configured odometry.
  std::shared_ptr<const RobotMap> paper_map;  ///< By `paper_odometry`; the same map where that is the same.
  std::string lidar;                          ///< As the recording names it; empty where maps were read.
  Trajectory truth;                           ///< For evaluation alone.
  RobotResult result;                         ///< What tables say of the drive.

  /// The map from which `policy` selects keyframes.
  [[nodiscard]] const std::shared_ptr<const RobotMap>& map_for(KeyframeSelection policy) const {
    return policy == KeyframeSelection::adaptive ? map : paper_map;
  }
};

/// Drives every recording once, with the configured odometry, the paper's, and KISS-ICP for the comparison of
/// section 3.1; robots in parallel, as one phase of progress. Fails with the first robot that cannot be
/// driven.
[[nodiscard]] Result<std::vector<RobotRun>> run_robots(const std::vector<Recording>& recordings,
                                                       const RunConfig& config);

/// The maps of those robots under the keyframe policy of `config`.
[[nodiscard]] std::vector<std::shared_ptr<const RobotMap>> selected_maps(
    const std::vector<const RobotRun*>& runs, const SlamConfig& config);

}  // namespace adit
