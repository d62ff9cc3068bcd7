// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Measures whether the covariances that adit states are those of its errors, over a list of worlds.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "adit/evaluation/calibration.hpp"
#include "adit/evaluation/tables.hpp"
#include "adit/study/merge_worlds.hpp"

namespace adit {

/// The errors of one source of relative poses.
struct UncertaintyRow {
  std::string source;       ///< "odometry over 10 m", "loops", ...
  Calibration calibration;  ///< Of its errors, by the covariances stated for them.
};

/// What was measured with one LiDAR and one IMU.
struct MeasuredUncertainty {
  std::string sensors;               ///< "os2-32, IMU icm-20948".
  std::vector<UncertaintyRow> rows;  ///< Each source once.
};

/// How robots are driven and merged.
struct UncertaintyStudy {
  RunConfig config;              ///< Used under the policy `adaptive`.
  std::filesystem::path folder;  ///< Keeps the robots' maps (maps/, which exists).
};

/// Drives the robots of one world, lets them meet and compares with the truth: odometry over 1, 10 and 50 m;
/// loops that were registered at the right place (within 2 m and 10 degrees of the truth: what is wrong by
/// more is a false loop, not an uncertain one); the frame between each two merged robots, as it is stated;
/// the poses of all merged robots, every ten metres, in the frame of their map. What scans say of the
/// predicted motion (innovations) needs no truth. By how much a LiDAR is turned on its mount is no error of a
/// path and is taken out of each robot's truth first. Fails on a world that cannot be driven.
[[nodiscard]] Result<std::vector<UncertaintyRow>> measure_world(const UncertaintyStudy& study,
                                                                const ListedWorld& world);

/// Adds the errors of `more` to those of the same sources.
void join(std::vector<UncertaintyRow>& rows, const std::vector<UncertaintyRow>& more);

/// Share of the errors that lie beyond the bound which, were the covariances true, one in a thousand would
/// exceed. Needs an error at least.
[[nodiscard]] double share_beyond_one_in_a_thousand(const Calibration& calibration);

/// One row per source: number, root mean square, normalised error squared (1 is true) of all axes together
/// and of each, share beyond the bound that one in a thousand exceeds.
[[nodiscard]] Table uncertainty_table(const MeasuredUncertainty& measured);

/// The same figures for programs.
[[nodiscard]] std::string uncertainty_json(const std::vector<MeasuredUncertainty>& measured);

/// A reliability diagram: of errors that should lie within the ellipsoid of each probability, how many do.
[[nodiscard]] std::string uncertainty_plot(const std::vector<UncertaintyRow>& rows);

}  // namespace adit
