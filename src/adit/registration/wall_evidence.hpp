// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the relief of walls says about two maps: one tunnel, or another one. Measured by the share of equal
/// signs (WallOffsets), weighed against what a robot found on its own map
/// (docs/decisions/0015-what-walls-say.md, 0063-stretches-of-wall.md).
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "adit/registration/registration_config.hpp"

namespace adit {

/// The signs on one side of 10 m of tunnel, which fresh lining or a widened face would move as a whole.
struct StretchSigns {
  double num = 0.0;    ///< Of pairs of scans, beyond the first one that saw each patch.
  double equal = 0.0;  ///< Of these, by which the wall is on the same side.
  /// Of equal signs, 0 to 1; `num` is not 0.
  [[nodiscard]] double share() const { return equal / num; }
  bool operator==(const StretchSigns&) const = default;
};

/// The share of equal signs: how often two pairs of scans that saw a patch put the wall on the same side.
/// 0.5, as by chance, where no patch was seen twice.
struct EqualSignShare {
  std::size_t num_patches = 0;  ///< On which two pairs of scans or more put the wall on a side.
  double share = 0.5;           ///< 0 to 1.
  double sigma = 0.5;           ///< Standard deviation of that share.
  double noise_m = 0.0;  ///< Of the offset of one pair of scans, about its patch: one standard deviation.
  std::vector<StretchSigns> stretches = {};  ///< What the share is made of.
  bool operator==(const EqualSignShare&) const = default;
};

/// The distribution of the share over stretches of one wall: normal, beside the error of counting.
struct SameWalls {
  double mean = 0.5;   ///< Of the share, 0 to 1.
  double sigma = 0.0;  ///< Standard deviation from stretch to stretch.
};

/// The distribution of the share over tunnels with other walls. Its part beyond one half grows with the ratio
/// of relief to noise, a factor that varies from tunnel to tunnel: the logarithm of that part is normal.
struct OtherWalls {
  double mean_log = 0.0;   ///< Mean of log(share - 0.5).
  double sigma_log = 0.0;  ///< Its standard deviation from tunnel to tunnel.
};

/// The shares that a robot found in its own map. What follows from them is computed when it is first asked
/// for and kept, so that no two threads may ask one object at the same time.
class EqualSignShares {
 public:
  EqualSignShares() = default;
  /// As long as nothing is measured, what `model` states counts.
  explicit EqualSignShares(const ReliefModel& model) : model_(model) {}

  /// The share of the robot's own walls, seen twice.
  void set_same(const EqualSignShare& share);
  /// The share of a tunnel that only looks like another one.
  void add_other(const EqualSignShare& share);

  /// A little more than half even for one wall, because where the beams fall on an edge is not random.
  [[nodiscard]] SameWalls same() const;
  /// Predicted share for different walls where offsets have the noise `noise_m`, from the robot's own
  /// look-alikes of `few_patches` or more, each by how likely its walls are others; 0: the noise of each.
  /// None if there are none such.
  [[nodiscard]] std::optional<OtherWalls> other(double noise_m = 0.0) const;
  /// What is believed where none was measured.
  [[nodiscard]] OtherWalls believed(double noise_m) const;
  /// P(walls of another tunnel were cast in one mould with those of the first): that share of the own
  /// look-alikes, counted by how likely the walls of each are the same.
  [[nodiscard]] double chance_of_one_mould() const;

  /// Log likelihood ratio of what was found between two maps, one tunnel to another; 0 if fewer than
  /// `min_patches` patches were seen. Walls may have been moved between the visits, along some of the
  /// stretches. Walls of one tunnel may seem to be others, at the rate `changed`, and those of another may
  /// be cast in one mould: between log(changed) and log(1 / chance_of_one_mould), nearly. Where the share of
  /// other walls was not measured, the one believed before counts. `elsewhere`: what other alignments of the
  /// two maps have shown, which are false if this one is true, so that their walls are others or of one
  /// mould, as those of the own look-alikes; what less than `min_patches` patches show is left out. `times`:
  /// as if there were so many times as many stretches, with the same shares.
  [[nodiscard]] double evidence(const EqualSignShare& found, double times = 1.0,
                                const std::vector<EqualSignShare>& elsewhere = {}) const;
  /// The most that `evidence` can be.
  [[nodiscard]] double most_evidence(const std::vector<EqualSignShare>& elsewhere = {}) const;
  /// As it was given; its defaults where none was.
  [[nodiscard]] const ReliefModel& model() const { return model_; }

 private:
  /// P(the walls of each look-alike are the same), and with them the share of those that are, from the prior
  /// `prior_moulded` worth one look-alike: a mixture, by expectation and maximisation (Dempster, Laird,
  /// Rubin, "Maximum likelihood from incomplete data via the EM algorithm", 1977). Many that may be the same
  /// are.
  [[nodiscard]] std::vector<double> estimated_chances() const;
  /// The same, estimated once.
  [[nodiscard]] const std::vector<double>& chances_to_be_the_same() const;
  [[nodiscard]] double weighed(const EqualSignShare& found, double times) const;
  /// With the shares of look-alikes between two maps beside the own ones.
  [[nodiscard]] EqualSignShares beside(const std::vector<EqualSignShare>& elsewhere) const;
  void forget_what_follows();

  /// An answer of `evidence`.
  struct Answer {
    EqualSignShare found;
    std::vector<EqualSignShare> elsewhere;
    double times = 1.0;
    double evidence = 0.0;
  };

  ReliefModel model_;
  EqualSignShare same_;
  std::vector<EqualSignShare> others_;                  ///< Of each look-alike that was seen well.
  mutable std::optional<std::vector<double>> chances_;  ///< Until a share is set or added, as the next.
  /// The last few, oldest first: a check of a merge weighs the walls of few hypotheses again and again.
  mutable std::vector<Answer> answers_;
};

}  // namespace adit
