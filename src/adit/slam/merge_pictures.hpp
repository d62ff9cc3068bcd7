// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the report draws of a joint run, with or without ground truth.
#pragma once

#include <memory>
#include <vector>

#include "adit/evaluation/study_result.hpp"
#include "adit/fleet/joint/fleet_solution.hpp"

namespace adit {

/// The paths of all robots, each in the frame of its map, and the registered loops between them.
LoopMap loop_map(const FleetGraph& fleet, const FleetSolution& solution);

/// Marks on the path of each robot where its wheels slipped; robots are known by their names.
void mark_slips(LoopMap& map, const std::vector<std::shared_ptr<const RobotMap>>& robots);

/// One picture per pair of robots whose merge was tested.
std::vector<MergePicture> merge_pictures(const FleetGraph& fleet, const FleetSolution& solution);

}  // namespace adit
