// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether walls that look alike are the same walls, by their relief. No two walls were built or broken alike
/// to the millimetre. A single scan does not show that, its noise is ten times larger; but noise differs from
/// scan to scan, and rock stays. Lay two maps over one another: where one wall is in front of the other, it
/// is in front in all of their scans (docs/decisions/0013-relief.md, 0015-what-walls-say.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/registration/searchable_surface.hpp"
#include "adit/registration/sensor_difference.hpp"

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
};

/// One offset per patch near a that both scans saw well. `T_a_b` is the fit of the points of b to a, in the
/// frame of a; `T_map_a` brings those of a into the frame of the map whose patches are meant.
[[nodiscard]] std::vector<PatchOffset> patch_offsets(const SearchableSurface& a, const SearchableSurface& b,
                                                     const Pose& T_a_b, const Pose& T_map_a,
                                                     const RegistrationConfig& config);

/// The share of equal signs: how often two pairs of scans that saw a patch put the wall on the same side.
/// 0.5, as by chance, where no patch was seen twice.
struct EqualSignShare {
  std::size_t num_patches = 0;  ///< On which two pairs of scans or more put the wall on a side.
  double share = 0.5;           ///< 0 to 1.
  double sigma = 0.5;           ///< Standard deviation of that share.
  double noise_m = 0.0;  ///< Of the offset of one pair of scans, about its patch: one standard deviation.
};

/// The distribution of the share over stretches of one wall: normal, beside the error of counting.
struct SameWalls {
  double mean = 0.5;   ///< Of the share, 0 to 1.
  double sigma = 0.0;  ///< Standard deviation from stretch to stretch.
};

/// The distribution of the share over stretches of different walls. Its part beyond one half grows with the
/// ratio of relief to noise, a factor that varies from stretch to stretch: the logarithm of that part is
/// normal.
struct OtherWalls {
  double mean_log = 0.0;   ///< Mean of log(share - 0.5).
  double sigma_log = 0.0;  ///< Its standard deviation from stretch to stretch.
};

/// The shares that a robot found in its own map.
class EqualSignShares {
 public:
  EqualSignShares() = default;
  /// As long as nothing is measured, what `model` states counts.
  explicit EqualSignShares(const ReliefModel& model) : model_(model) {}

  /// The share of the robot's own walls, seen twice.
  void set_same(const EqualSignShare& share);
  /// The share of a stretch of wall that only looks like another one.
  void add_other(const EqualSignShare& share);

  /// A little more than half even for one wall, because where the beams fall on an edge is not random.
  [[nodiscard]] SameWalls same() const;
  /// Predicted share for different walls where offsets have the noise `noise_m`, from the robot's own
  /// look-alikes of `min_patches` patches or more, each by how likely its walls are others; 0: the noise of
  /// each. None if there are none such.
  [[nodiscard]] std::optional<OtherWalls> other(double noise_m = 0.0) const;
  /// What is believed where none was measured.
  [[nodiscard]] OtherWalls believed(double noise_m) const;
  /// P(walls of another tunnel were cast in one mould with those of the first): that share of the own
  /// look-alikes, counted by how likely the walls of each are the same.
  [[nodiscard]] double chance_of_one_mould() const;
  /// The most that WallOffsets::evidence can be, a log likelihood ratio.
  [[nodiscard]] double most_evidence() const;
  /// As it was given; its defaults where none was.
  [[nodiscard]] const ReliefModel& model() const { return model_; }

 private:
  /// P(the walls of each look-alike are the same), and with them the share of those that are, from the prior
  /// `prior_moulded` worth one look-alike: a mixture, by expectation and maximisation (Dempster, Laird,
  /// Rubin, "Maximum likelihood from incomplete data via the EM algorithm", 1977). Many that may be the same
  /// are.
  [[nodiscard]] std::vector<double> chances_to_be_the_same() const;

  ReliefModel model_;
  EqualSignShare same_;
  std::vector<EqualSignShare> others_;  ///< Of each stretch that was seen well.
};

/// Whether walls may have been moved between the scans of a pair: lined anew, or widened.
enum class Visits : std::uint8_t { one, two };

/// Offsets from several pairs of scans, no scan in two pairs. For each patch seen by two or more pairs it
/// counts the pairs whose offsets have equal sign. Noise gives equal signs as often as not, whatever the
/// number of pairs. What the sensors and the fits explain is taken off before, and offsets of less than
/// `min_offset_m` have no sign.
class WallOffsets {
 public:
  /// `visits`: of all pairs that will be added; decides how `counted` averages.
  explicit WallOffsets(const ReliefConfig& config = {}, Visits visits = Visits::two)
      : config_(config), visits_(visits) {}
  /// What `patch_offsets` found for one pair of scans; may be empty.
  void add(const std::vector<PatchOffset>& of_a_pair);
  /// Over the patches that two pairs or more saw. Of two visits it is the share of most stretches, their
  /// median over sides of 10 m of tunnel: a few whose walls were moved do not change it.
  [[nodiscard]] EqualSignShare counted() const;
  /// Log likelihood ratio, one tunnel to another; 0 if fewer than `min_patches` patches were seen. Walls of
  /// one tunnel may seem to be others, at the rate `changed`, and those of another may be cast in one mould:
  /// between log(changed) and log(1 / chance_of_one_mould), nearly. Where the share of other walls was not
  /// measured, the one believed before counts. `times`: as if so many times the patches had been seen, with
  /// the same share.
  [[nodiscard]] double evidence(const EqualSignShares& shares, double times = 1.0) const;
  /// The share of the sum of squared offsets, without what the fits explain, that the sensors explain; 0
  /// without offsets.
  [[nodiscard]] double share_of_sensors() const;

 private:
  [[nodiscard]] EqualSignShare count() const;
  [[nodiscard]] OffsetParts parts() const;

  ReliefConfig config_;
  Visits visits_;
  std::vector<PatchOffset> offsets_;
  std::vector<Eigen::Index> first_of_pair_;
  mutable std::optional<EqualSignShare> counted_;
};

}  // namespace adit
