// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether walls that look alike are the same walls. No two were built or broken alike to the millimetre. A
/// scan does not show that, its noise is ten times larger; but noise is another one in every scan, and rock
/// stays. Where two maps are laid over one another and one stands off the other, it stands off on the same
/// side in all of their scans.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/agreement.hpp"

namespace adit {

/// A square metre of wall, in the frame of a map, and the side that it faces.
using WallPatch = std::array<std::int32_t, 4>;

struct PatchOffset {
  WallPatch patch;
  double metres = 0.0;  ///< By which b stands off a, towards the free side; the mean over the points of b.
};

/// Of all patches near a that both scans saw. `T_a_b` brings the points of b into the frame of a, as well as
/// the surfaces allow; `T_map_a` those of a into the frame of the map in which patches are told apart.
[[nodiscard]] std::vector<PatchOffset> patch_offsets(const SeenSurface& a, const SeenSurface& b,
                                                     const Pose& T_a_b, const Pose& T_map_a);

class StandingOffsets;

/// Which share of the patches stands off, by what a robot sees in its own map. Of one wall it is a little
/// more than half: where on an edge the beams fall is no chance. Where too little was seen: 0.52 and 0.5.
class StandingShares {
 public:
  void add_same(const StandingOffsets& offsets);
  /// Of walls that only look alike.
  void add_other(const StandingOffsets& offsets);

  [[nodiscard]] double same() const;
  /// A third of what those seen have beyond chance: the one that is most like the truth is not the average.
  [[nodiscard]] double other() const;

 private:
  struct Count {
    std::size_t num_patches = 0;
    std::size_t num_standing = 0;
    void add(const StandingOffsets& offsets);
    [[nodiscard]] double share() const;  ///< Chance, where too little was seen.
  };
  Count same_;
  Count other_;
};

/// Offsets from several pairs of scans, none of which is part of two pairs. Of each patch that two or more
/// pairs saw, the mean of one half of them is compared with that of the other, where both are more than two
/// millimetres: noise puts them on one side as often as not.
class StandingOffsets {
 public:
  void add(const std::vector<PatchOffset>& of_a_pair);
  [[nodiscard]] std::size_t num_patches() const;   ///< That two pairs or more saw.
  [[nodiscard]] std::size_t num_standing() const;  ///< Of which both halves stand off on the same side.
  /// So many stand that this happens less often than `rate` where the walls are the same; never with fewer
  /// than 300 patches.
  [[nodiscard]] bool are_of_other_walls(const StandingShares& shares, double rate) const;
  /// That the walls are the same: the logarithm of the likelihood ratio of the two shares. None, 0, where
  /// other walls stand off no more often than the same.
  [[nodiscard]] double evidence(const StandingShares& shares) const;

 private:
  struct Halves {
    std::array<double, 2> sums{};
    std::size_t num_pairs = 0;
    [[nodiscard]] double mean(std::size_t half) const;
    [[nodiscard]] bool can_be_compared() const;
    [[nodiscard]] bool stands() const { return can_be_compared() && sums[0] * sums[1] > 0.0; }
  };
  std::map<WallPatch, Halves> patches_;
};

}  // namespace adit
