// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "adit/core/config.hpp"
#include "adit/core/records.hpp"
#include "adit/odometry/adaptive_threshold.hpp"
#include "adit/odometry/local_map.hpp"
#include "adit/odometry/odometry.hpp"
#include "adit/odometry/scan_to_map.hpp"
#include "adit/odometry/steady_motion.hpp"

namespace adit {

/// Whether scans are taken to come at an unsteady pace.
enum class IrregularSteps { automatic, on, off };
/// All choices.
inline constexpr std::array kIrregularSteps{IrregularSteps::automatic, IrregularSteps::on,
                                            IrregularSteps::off};
[[nodiscard]] std::string_view to_string(IrregularSteps steps);  ///< auto, on, off

/// What `KissIcp` needs; initial_threshold and min_motion are by default as in KISS-ICP 1.2.
struct KissIcpConfig {
  ScanToMapConfig scan_to_map;
  double initial_threshold = 2.0;
  double min_motion = 0.1;
  IrregularSteps irregular_steps = IrregularSteps::automatic;
};
/// Those of scan_to_map, without a prefix, and initial_threshold, min_motion, irregular_steps.
[[nodiscard]] Fields fields_of(KissIcpConfig& config);

/// LiDAR-only odometry: I. Vizzo, T. Guadagnino, B. Mersch, L. Wiesmann, J. Behley, C. Stachniss, "KISS-ICP:
/// In Defense of Point-to-Point ICP - Simple, Accurate, and Robust Registration If Done the Right Way", RA-L
/// 2023. It works in the base frame: T_odom_base starts at identity.
///
/// Beyond the paper: its prediction repeats the last step, which presumes scans at a steady pace. Here the
/// velocity is kept over the time that has passed (at most two seconds, where scans are missing). Scans
/// without per-point times have often been picked or thinned from a drive, and their steps then vary; so with
/// `irregular_steps` each such scan is also aligned from the last pose, and the better fit counts
/// (docs/decisions/0003-irregular-steps.md).
///
/// A step is `degenerate` when the scene leaves a direction open. That is a diagnosis only: the method has no
/// such notion, and as in the paper the scan enters the map (in a smooth tunnel it slips, which is what is to
/// be shown). Steps that are `too_few_points` or `diverged` keep the constant-velocity prediction and stay
/// out of the map.
class KissIcp : public Odometry {
 public:
  /// With an empty map. Ranges of the settings are not checked.
  KissIcp(const KissIcpConfig& config, const Pose& T_base_lidar);

  OdometryStep register_scan(const Scan& scan, const SensedMotion& motion) override;
  [[nodiscard]] const PointCloud& cloud_of_last_scan() const override { return cloud_; }
  /// In the frame odom; empty before the first scan.
  [[nodiscard]] const LocalMap& map() const { return map_; }
  /// Of the adaptive threshold, for the next scan; metres.
  [[nodiscard]] double sigma() const { return threshold_.sigma(); }

 private:
  [[nodiscard]] OdometryStep registered(const ThinnedScan& scan, const Pose& T_prediction);
  [[nodiscard]] Alignment align(const ThinnedScan& scan, const Pose& T_prediction) const;

  KissIcpConfig config_;
  Pose T_base_lidar_;
  LocalMap map_;
  AdaptiveThreshold threshold_;
  bool irregular_ = false;  ///< The last scan is treated as one of irregular steps.
  SteadyMotion motion_;
  PointCloud cloud_;
  VoxelThinner thinner_;
};

}  // namespace adit
