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
#include <optional>
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

/// How often two pairs of scans that saw a patch put the wall on one side; chance, where none was seen twice.
struct StandingShare {
  std::size_t num_patches = 0;  ///< Over which it was counted.
  double share = 0.5;           ///< Of one.
  double sigma = 0.5;           ///< By which it may be off by chance.
};

/// How the share lies among stretches of one wall: normally, beside what it is off by chance.
struct SameWalls {
  double mean = 0.5;
  double sigma = 0.0;
};

/// How the share lies among stretches of other walls. Its part beyond one half grows with the ratio of relief
/// to noise, a factor that is another one from stretch to stretch: the logarithm of that part lies normally.
struct OtherWalls {
  double mean_log = 0.0;
  double sigma_log = 0.0;
};

/// Which share of the patches stands off, by what a robot sees in its own map.
class StandingShares {
 public:
  /// Of its own walls, seen twice.
  void set_same(const StandingShare& share);
  /// Of a stretch of wall that only looks like another one.
  void add_other(const StandingShare& share);

  /// Of one wall it is a little more than half: where on an edge the beams fall is no chance.
  [[nodiscard]] SameWalls same() const;
  /// Of a further stretch that only looks like another one, by those that were seen. None where none was
  /// seen well, and where the walls of one of them may be the same: cast in one mould.
  [[nodiscard]] std::optional<OtherWalls> other() const;

 private:
  StandingShare same_;
  std::vector<StandingShare> others_;  ///< Of each stretch that was seen well.
};

/// Offsets from several pairs of scans, none of which is part of two pairs. Of each patch that two or more
/// pairs saw, beyond two millimetres, every two of them are on one side or not: noise puts them there as
/// often as not, however many have seen it.
class StandingOffsets {
 public:
  void add(const std::vector<PatchOffset>& of_a_pair);
  /// Over the patches that two pairs or more saw.
  [[nodiscard]] StandingShare counted() const;
  /// So large a share happens less often than `rate` where the walls are the same; never with fewer than 200
  /// patches.
  [[nodiscard]] bool are_of_other_walls(const StandingShares& shares, double rate) const;
  /// That the walls are the same: the logarithm of the likelihood ratio of the two. None, 0, where it is not
  /// known how often other walls stand off, or fewer than 100 patches were seen.
  [[nodiscard]] double evidence(const StandingShares& shares) const;

 private:
  struct Sides {
    std::size_t num_in_front = 0;
    std::size_t num_behind = 0;
  };
  std::map<WallPatch, Sides> patches_;
};

}  // namespace adit
