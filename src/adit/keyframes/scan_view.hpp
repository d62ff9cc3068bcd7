// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// One scan as its sensor saw it: which returns lie in which direction, and how far away. It tells which of
/// its own returns are confirmed by others, and which places it looked through.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/point_cloud.hpp"

namespace adit {

/// When a return is believed. Walls, things and people are seen by many rays; a grain of dust or a drop by
/// one, and a thing that moves stands in no two scans in the same place.
struct ConfirmConfig {
  double window_deg = 0.75;  ///< Rings of the sparsest LiDAR of 32 rings (OS2-32) are 0.7 degrees apart.
  double farther = 0.1;      ///< A wall 5 degrees off the ray: this much between rays half a degree apart.
  double nearer = 0.5;       ///< Walls at a slant have returns far nearer beside; dust has what is behind it.
  int min_neighbours = 2;    ///< Both neighbours on one ring.
  double min_share = 0.15;   ///< The rays that the narrowest pole holds of a window: a column or two of ten.
  double clear_m = 0.3;      ///< Thicker than errors of the odometry from keyframe to keyframe; less than
                             ///< what a pedestrian walks meanwhile.
  double clear_share = 0.02;  ///< 1 degree of error across the ray, as for windows at their edge.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(ConfirmConfig& config);

/// Points are metres in the base frame of the scan, deskewed. Angles count from the base frame's axes, about
/// the position of the LiDAR. Points that are not finite are in no direction: they are not confirmed and hide
/// nothing.
class ScanView {
 public:
  /// `viewpoint`: the position of the LiDAR. Throws ContractViolation when `config` is out of its ranges.
  ScanView(std::span<const Eigen::Vector3f> points, const Vector3& viewpoint, const ConfirmConfig& config);

  /// 1 for each return that its neighbours confirm: of the others in a window about its direction
  /// (`window_deg` to each side), `min_share` and `min_neighbours` are about as far away as itself: from
  /// `nearer` to 1 + `farther` times its range. The window is doubled up to twice for a sensor that has fewer
  /// than twelve other returns in it; a cloud that is thinner still is confirmed as a whole.
  [[nodiscard]] std::vector<std::uint8_t> confirmed_by_neighbours() const;

  /// From now on the scan has only the returns whose flag is 1.
  void keep(std::span<const std::uint8_t> flags);

  /// Whether rays on all sides of that place, not farther than a window (twice that upwards and downwards),
  /// went on beyond it, and none ended at or before it.
  [[nodiscard]] bool looks_through(const Eigen::Vector3f& point) const;

  /// To each side, degrees: `window_deg` or its double or fourfold.
  [[nodiscard]] double window_deg() const;
  /// Whether windows hold enough returns for neighbours to say anything.
  [[nodiscard]] bool is_dense() const { return is_dense_; }

 private:
  struct Direction {
    float azimuth = 0.0F;
    float elevation = 0.0F;
    float range = 0.0F;
  };
  struct Counts {
    int others = 0;
    int similar = 0;
  };

  [[nodiscard]] Direction direction_of(const Eigen::Vector3f& point) const;
  void sort_by_cell(float window, std::span<const Direction> directions);
  [[nodiscard]] bool has_enough_others() const;
  [[nodiscard]] Counts counts_at(const Direction& direction) const;
  template <class Visit>
  void visit_around(const Direction& direction, float half_height, const Visit& visit) const;

  ConfirmConfig config_;
  Eigen::Vector3f viewpoint_;
  float window_ = 0.0F;  ///< Radians.
  bool is_dense_ = false;
  std::size_t num_points_ = 0;
  std::size_t num_columns_ = 0;
  // By cell, row by row upwards: where each cell begins, and its returns. A forgotten return has range NaN.
  std::vector<std::uint32_t> begins_;
  std::vector<float> azimuths_;
  std::vector<float> elevations_;
  std::vector<float> ranges_;
  std::vector<std::uint32_t> indices_;
};

/// The flagged points of a cloud (1: kept), in their order, with what belongs to them.
[[nodiscard]] PointCloud only(const PointCloud& cloud, std::span<const std::uint8_t> flags);

}  // namespace adit
