// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether two scans could be of the same place: surfaces that both saw coincide, and nothing in one scan
/// stands where the other one saw free space.
#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/registration/oriented_points.hpp"
#include "adit/registration/registration_config.hpp"
#include "adit/registration/searchable_surface.hpp"

namespace adit {

/// A scan: surfaces, and the free space between them and the point they were seen from.
class SeenSurface : public SearchableSurface {
 public:
  /// Ranges of the surfaces in and around one direction, metres; empty where nothing was seen.
  struct Ranges {
    float nearest = std::numeric_limits<float>::infinity();  ///< Infinite where nothing was seen.
    float farthest = 0.0F;                                   ///< 0 where nothing was seen.
    /// Whether nothing was seen.
    [[nodiscard]] bool empty() const { return farthest == 0.0F; }
    /// Widens the interval so that it holds the other one.
    void add(const Ranges& other);
  };

  /// `points` and `viewpoint`, where the sensor stood, in the same frame, metres.
  /// `voxel_m`: points are one per voxel of this edge.
  SeenSurface(OrientedPoints points, const Vector3& viewpoint, double voxel_m);

  /// A sample of the points, spread over all, that suffices for alignment.
  [[nodiscard]] const OrientedPoints& some() const { return some_; }
  /// Nothing was seen above and below the sensor's field of view, however near a surface ends there.
  [[nodiscard]] const Ranges& towards(const Eigen::Vector3f& direction) const;
  /// Into how many points, one per voxel, a sensor that leaves no gaps would see each of these, near the
  /// robot: what sparse and dense sensors see differ is compared by its area.
  [[nodiscard]] double thinness() const { return thinness_; }
  /// About what this takes, grid and ranges included.
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  OrientedPoints some_;
  std::vector<Ranges> ranges_;
  double thinness_ = 1.0;
  float lowest_ = 1.0F;  ///< Sines of the elevations between which something was seen.
  float highest_ = -1.0F;
};

/// A connected patch that differs.
struct DifferingPatch {
  Vector3 position;         ///< Of its middle, as it was seen; metres.
  double num_points = 0.0;  ///< Times SeenSurface::thinness.
};

/// Points of the smallest patch that Agreement lists.
inline constexpr std::size_t kLeastPatch = 4;

/// How well two scans agree at a given relative pose, where both could see. Of each scan, only points count
/// that lie where the other scan saw too. They are confirmed when they lie on its surfaces. They differ when
/// they lie off a surface near them, or in space that the other scan saw to be free. Points hidden behind the
/// other's surfaces, or between its beams, do not count.
struct Agreement {
  double confirmed = 0.0;  ///< Share of the points that count, the smaller of both directions.
  /// Number of points, one per voxel, times SeenSurface::thinness, in the largest connected patch that
  /// differs and is no thing that may come and go; the larger of both directions. A niche or a passage that
  /// only one of two tubes has makes one large patch; noise and beams that miss make many small ones.
  double largest_difference = std::numeric_limits<double>::infinity();
  /// All patches that are no such thing, of either direction, and those that are (changed_thing.hpp); frame
  /// of a. Patches of fewer than kLeastPatch points are left out.
  ///@{
  std::vector<DifferingPatch> structures = {};
  std::vector<DifferingPatch> things = {};
  ///@}
  [[nodiscard]] bool is_comparable() const { return confirmed > 0.0; }  ///< Points of both scans count.
};

/// `T_a_b` brings the points of b into the frame of a. Scans with nothing in common are not comparable.
/// Where the difference is `below` points or more, the rest is not computed and the answer is not comparable,
/// too.
[[nodiscard]] Agreement agreement(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                                  const RegistrationConfig& config,
                                  double below = std::numeric_limits<double>::infinity());

/// A guess from odometry, corrected by the surfaces, and their agreement there.
struct LocalFit {
  Pose T_a_b;           ///< The guess itself where no fit was accepted.
  Agreement agreement;  ///< At that pose; not comparable where no fit was accepted.
};
/// Where a fit starts.
enum class FitFrom {
  guess,           ///< The pose that is given.
  along_the_path,  ///< Also up to 1.5 m ahead of the guess and behind it, along the path of b (its x axis).
};
/// The point-to-plane fit with the smallest difference. A difference of at most `enough` points ends the
/// search. Points are first paired over short distances, as if the guess were exact, then over several
/// voxels. Fits more than 2.5 m from the guess are not accepted; if there is no other, the result is not
/// comparable.
[[nodiscard]] LocalFit fit_near(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b, double enough,
                                const RegistrationConfig& config, FitFrom from = FitFrom::along_the_path);
/// The fit that `fit_near` finds from the guess, if its difference is at most `enough` points; in less time,
/// as it is not asked by how much the others differ.
[[nodiscard]] std::optional<Pose> agreeing_fit(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                                               double enough, const RegistrationConfig& config);

}  // namespace adit
