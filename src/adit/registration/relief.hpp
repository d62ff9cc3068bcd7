// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether walls that look alike are the same walls, by their relief. No two walls were built or broken alike
/// to the millimetre. A single scan does not show that, its noise is ten times larger; but noise differs from
/// scan to scan, and rock stays. Lay two maps over one another: where one wall is in front of the other, it
/// is in front in all of their scans (docs/decisions/0013-relief.md, 0015-what-walls-say.md).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/registration/searchable_surface.hpp"
#include "adit/registration/sensor_difference.hpp"
#include "adit/registration/wall_evidence.hpp"

namespace adit {

/// A patch of wall in the frame of a map: the indices of its cell, and the side that it faces.
using WallPatch = std::array<std::int32_t, 4>;

/// How far apart two scans put one patch of wall.
struct PatchOffset {
  WallPatch patch;  ///< In the frame of the map that T_map_a leads to.
  /// How far b's wall is in front of a's, towards free space; mean over the points of b.
  double metres = 0.0;
  SensorTerms by_sensors = SensorTerms::Zero();  ///< By how much the errors of the sensors change that,
  Vector6 by_fit = Vector6::Zero();              ///< and an error of the fit (motion_terms).
  /// And a constant error of the returns of a and of b whose intensity is known.
  Eigen::Vector2d by_known = Eigen::Vector2d::Zero();
};

/// One offset per patch near a that both scans saw well. `T_a_b` is the fit of the points of b to a, in the
/// frame of a; `T_map_a` brings those of a into the frame of the map whose patches are meant.
[[nodiscard]] std::vector<PatchOffset> patch_offsets(const SearchableSurface& a, const SearchableSurface& b,
                                                     const Pose& T_a_b, const Pose& T_map_a,
                                                     const RegistrationConfig& config);

/// Offsets from several pairs of scans, no scan in two pairs. For each patch seen by two or more pairs it
/// counts the pairs whose offsets have equal sign. Noise gives equal signs as often as not, whatever the
/// number of pairs. What the sensors and the fits explain is taken off before; offsets of less than
/// `min_offset_m` have no sign, and stretches that were moved as a whole do not count (decision 0067).
class WallOffsets {
 public:
  /// Of `config` the offset that has no sign and the edge of a patch are used.
  explicit WallOffsets(const ReliefConfig& config = {}) : config_(config) {}
  /// What `patch_offsets` found for one pair of scans; may be empty.
  void add(const std::vector<PatchOffset>& of_a_pair);
  /// Over the patches that two pairs or more saw.
  [[nodiscard]] const EqualSignShare& counted() const;
  /// The share of the sum of squared offsets, without what the fits explain, that the sensors explain; 0
  /// without offsets.
  [[nodiscard]] double share_of_sensors() const;

 private:
  /// What one robust fit says of all offsets.
  struct Counted {
    EqualSignShare signs;
    double share_of_sensors = 0.0;
  };
  [[nodiscard]] const Counted& counted_once() const;
  [[nodiscard]] EqualSignShare signs_of(const OffsetParts& found) const;
  [[nodiscard]] OffsetParts parts() const;

  ReliefConfig config_;
  std::vector<PatchOffset> offsets_;
  std::vector<Eigen::Index> first_of_pair_;
  mutable std::optional<Counted> counted_;  ///< Until offsets are added: the fit takes milliseconds.
};

}  // namespace adit
