// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How much light surfaces send back, and what that does to ranges.
///
/// A surface that fills the beam and scatters as Lambert's law says returns a power in proportion to
/// reflectivity * cos(incidence) / range^2 (W. Wagner and others, "Gaussian decomposition and calibration of
/// a novel small-footprint full-waveform digitising airborne laser scanner", 2006; B. Hoefle and N. Pfeifer,
/// "Correction of laser scanning intensity data", 2007). Noise of a range falls with the root of it, as the
/// number of photons that arrive.
#pragma once

#include <array>
#include <cstdint>

#include "adit/core/config.hpp"
#include "adit/simulation/raycaster.hpp"

namespace adit {

/// Surfaces as the laser sees them. All alike and dry by default.
struct SurfaceConfig {
  double contrast = 0.0;      ///< 0: noise depends on range alone and there is no intensity. 1: as in a mine.
  double evenness = 0.0;      ///< Each world draws its contrast: this share less than stated, to all of it.
  double visit_change = 0.0;  ///< Sigma of the decimal logarithm by which dust and damp change a patch
                              ///< between two visits.
  double patch = 3.0;         ///< Metres: size of patches of one reflectivity.
  double signs = 0.0;         ///< Share of squares of half a metre that are painted or reflecting (90 %).
  double wet = 0.0;           ///< Share of the floor under water, which mirrors at grazing angles.
};
/// The keys are the names of the members; in the configuration of a run they begin with
/// "simulation.surfaces.".
[[nodiscard]] Fields fields_of(SurfaceConfig& config);

/// Rock, coal and wet walls 5 to 20 %, shotcrete and concrete 20 to 60 % (at 900 nm lava has 8 %, asphalt 17,
/// smooth concrete 24, dry sand 57: A. Wehr and U. Lohr, "Airborne laser scanning: an introduction and
/// overview", 1999, table 2), one square in 500 a sign; one floor patch in 30 wet, which is chosen. A lining
/// is more even than that: a world's contrast is a quarter of it at least. Two visits to one drift, 22 days
/// apart, have intensities with a correlation of 0.5 (decision 0082), and these have 0.6 where the contrast
/// is whole: a patch changes by a factor of 1.7.
[[nodiscard]] SurfaceConfig field_surfaces();

/// The reflectivity for which data sheets state a sensor's reach.
inline constexpr float kNominalReflectivity = 0.1F;

/// The surfaces of one world. They depend on the seed and the position alone, so all robots see the same.
class Surfaces {
 public:
  Surfaces() : Surfaces(SurfaceConfig(), 0) {}
  /// Each number of `config` lies within its range (fields_of).
  Surfaces(const SurfaceConfig& config, std::uint64_t seed);

  /// Whether contrast is 0.
  [[nodiscard]] bool are_alike() const { return are_alike_; }
  /// As they are on one visit, of which `seed` draws what has changed.
  [[nodiscard]] Surfaces on_visit(std::uint64_t seed) const;
  /// Where each ray of the block ends (world frame); that of the nominal surface where all are alike.
  void reflectivities(const RayBlock& rays, RayBlock::Numbers& out) const;
  /// Puts what rays see in puddles below the floor: where a ray grazes a wet patch, it is reflected with
  /// Fresnel's probability (C. Schlick's approximation, 1994, for water), and its range is that of the whole
  /// way, or it is lost. `seed` draws which.
  void mirror(const Raycaster& world, float range_max, std::uint64_t seed, RayBlock& rays) const;

 private:
  bool are_alike_;
  float per_metre_;
  std::uint64_t num_signs_;  // of 2^32
  std::uint64_t num_wet_;    // of 2^32
  std::uint64_t seed_;
  std::uint64_t visit_ = 0;
  std::array<float, 256> palette_;  // equally frequent, as the next
  std::array<float, 256> changes_;  // factors
};

/// Strength of the returns of a block in units of what a sensor just detects: 1 from the nominal surface, met
/// head-on at `reach` metres.
void add_signals(const RayBlock& rays, const RayBlock::Numbers& reflectivities, float reach,
                 RayBlock::Numbers& signals);

/// Takes away returns that are too weak: none above 1.5, half at 1, all below 0.5, linear in between.
void drop_weak(const RayBlock::Numbers& signals, std::uint64_t seed, RayBlock& rays);

/// By how much of the largest walk a return of that strength is late: a weak pulse passes the threshold of
/// the detector later on its edge. 1 for the weakest; 1/2 at 100 times what is detected.
[[nodiscard]] float share_of_walk(float signal);

}  // namespace adit
