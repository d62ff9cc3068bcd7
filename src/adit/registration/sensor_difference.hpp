// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What makes two sensors see one wall at different distances: a constant error of range, an error that grows
/// with the angle of incidence, one that depends on how strong a return is, and one per ring. All move a
/// patch of wall along the ray. And where two scans were not fitted exactly, all patches of the pair move
/// together. A robust fit over many patches of many pairs tells both from relief, which belongs to a place
/// (decisions 0035, 0052 and 0068).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "adit/core/config.hpp"
#include "adit/core/pose.hpp"
#include "adit/registration/searchable_surface.hpp"

namespace adit {

/// Places among the errors of a sensor: a constant one, by incidence, by the logarithm of intensity to base
/// ten, and by elevation at nodes four degrees apart up to 32 degrees to each side, linear in between.
///@{
inline constexpr int kConstantError = 0;
inline constexpr int kIncidenceError = 1;
inline constexpr int kIntensityError = 2;
inline constexpr int kFirstElevationError = 3;
inline constexpr int kElevationNodesToEachSide = 8;
inline constexpr int kErrorsOfSensor = kFirstElevationError + 2 * kElevationNodesToEachSide + 1;
///@}
inline constexpr int kSensorErrors = 2 * kErrorsOfSensor;  ///< Those of a, then those of b.

/// The derivatives of an offset, how far b's wall is in front of a's, by the errors of both sensors.
using SensorTerms = Eigen::Matrix<double, kSensorErrors, 1>;

/// A pair of points, one of each scan, on one wall. Frame of a.
struct WallPair {
  Eigen::Vector3f seen_by_a;  ///< The point of a nearest to that of b, metres.
  Eigen::Vector3f seen_by_b;  ///< The point of b where the fit puts it, metres.
  Eigen::Vector3f normal;     ///< Of the wall there, a mean of both scans', towards free space; unit length.
  /// Of the two returns, each in the unit of its sensor; 0: not known.
  ///@{
  float intensity_a = 0.0F;
  float intensity_b = 0.0F;
  ///@}
};

/// Adds up the terms of pairs of points of two scans.
class SensorTermsOf {
 public:
  /// Keeps the viewpoints, and the z axes as the upward axes of the robots.
  SensorTermsOf(const SearchableSurface& a, const SearchableSurface& b, const Pose& T_a_b);
  /// Adds those of one pair, times `weight`, to `sum`, and to `known` those of a constant error of the
  /// returns of a and of b whose intensity is known.
  void add(const WallPair& pair, double weight, SensorTerms& sum, Eigen::Vector2d& known) const;

 private:
  Eigen::Vector3f viewpoint_a_;  // in the frame of a, as all
  Eigen::Vector3f viewpoint_b_;
  Eigen::Vector3f up_a_;  // of the robots
  Eigen::Vector3f up_b_;
};

/// By how much a pair's offset grows when b moves by [translation; rotation] in the frame of a.
[[nodiscard]] Vector6 motion_terms(const WallPair& pair);

/// Offsets of patches of wall, metres, and what moves them beside relief; a row for each.
struct OffsetSystem {
  Eigen::VectorXd metres;                                           ///< The offsets.
  Eigen::Matrix<double, Eigen::Dynamic, kSensorErrors> by_sensors;  ///< SensorTerms
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_fit;                  ///< motion_terms
  std::vector<Eigen::Index> first_of_pair;  ///< Rows of one pair of scans follow one another.
  /// Two rows of one patch each: noise alone tells them apart, wherever its wall is.
  std::vector<std::array<Eigen::Index, 2>> repeated = {};
  /// For each row the stretch of wall that it lies on, counted from 0; empty: none is known.
  std::vector<std::size_t> stretches = {};
};

/// Takes the mean logarithm of the intensities of each sensor off all of them, so that their unit does not
/// matter and a return of unknown intensity counts as one of that mean. Each row weighs as a constant error
/// moves it. `known`: a row for each of
/// `by_sensors`, as SensorTermsOf adds them up.
void centre_intensities(Eigen::Matrix<double, Eigen::Dynamic, kSensorErrors>& by_sensors,
                        const Eigen::Matrix<double, Eigen::Dynamic, 2>& known);

/// Standard deviations: of range by sensor, what data sheets allow; of the fit of two scans, chosen, as half
/// and five times as much merged as many of six pairs or one more (decision 0052).
struct OffsetPrior {
  double bias_m = 0.03;          ///< Constant.
  double walk_m = 0.03;          ///< At grazing incidence.
  double per_tenfold_m = 0.015;  ///< Between two returns, one ten times as intense as the other.
  double ring_m = 0.01;          ///< At a node of elevation.
  double fit_m = 0.02;           ///< Along each axis.
  double fit_rad = 0.004;        ///< About each axis.
};
/// The keys are the names of the fields.
[[nodiscard]] Fields fields_of(OffsetPrior& prior);

/// What offsets consist of; the rest is owed to the fits.
struct OffsetParts {
  Eigen::VectorXd by_sensors;  ///< Of each row of the system, metres.
  Eigen::VectorXd left;        ///< What neither sensors nor fits explain: relief and noise, metres.
  double noise_m =
      0.0;  ///< Standard deviation of one offset of a wall that stays; 0 if no patch is repeated.
  /// Of each row whether its stretch was moved as a whole: it is far more off than the others.
  std::vector<bool> is_moved = {};
};

/// A robust fit of the errors of both sensors and of each pair's fit with their priors, by Huber's weights
/// and then by Tukey's (Beaton and Tukey, "The fitting of power series", 1974), to which walls that were
/// moved between two visits are nothing. Residuals are measured by the noise of repeated patches, so that
/// moved walls do not make the scale, and where few are repeated by their own median. A stretch is moved if
/// its mean is an outlier among the means of all, by Tukey's weight; it then weighs nothing.
[[nodiscard]] OffsetParts taken_apart(const OffsetSystem& offsets, const OffsetPrior& prior);

}  // namespace adit
