// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Whether two scans could be of one place: surfaces that both saw lie on one another, and nothing of one
/// stands where the other saw through.
#pragma once

#include <limits>
#include <vector>

#include "adit/core/pose.hpp"
#include "adit/geometry/kd_tree.hpp"
#include "adit/registration/oriented_points.hpp"
#include "adit/registration/registration_config.hpp"

namespace adit {

/// A scan as the surfaces that were seen from one point, with the free space in between.
class SeenSurface {
 public:
  /// Of the surfaces in one direction and around it; empty where nothing was seen.
  struct Ranges {
    float nearest = std::numeric_limits<float>::infinity();
    float farthest = 0.0F;
    [[nodiscard]] bool empty() const { return farthest == 0.0F; }
    void add(const Ranges& other);
  };

  /// `points` in a frame in which the sensor stood at `viewpoint`.
  SeenSurface(OrientedPoints points, const Vector3& viewpoint);

  [[nodiscard]] const OrientedPoints& points() const { return points_; }
  /// Some of the points, spread over all: enough to align by.
  [[nodiscard]] const OrientedPoints& some() const { return some_; }
  [[nodiscard]] const KdTree& tree() const { return tree_; }
  [[nodiscard]] const Eigen::Vector3f& viewpoint() const { return viewpoint_; }
  [[nodiscard]] const Ranges& towards(const Eigen::Vector3f& direction) const;
  [[nodiscard]] std::size_t num_bytes() const;

 private:
  OrientedPoints points_;
  OrientedPoints some_;
  KdTree tree_;
  Eigen::Vector3f viewpoint_;
  std::vector<Ranges> ranges_;
};

/// What two scans say about their relative pose where both could see. Of each scan those points count that
/// the other one saw as well: they are confirmed when they lie on its surfaces, and differ when they lie off
/// a surface near them, or where the other scan saw through. What hides behind the other's surfaces, or lies
/// between its beams, says nothing.
struct Agreement {
  double confirmed = 0.0;  ///< Share of the points that count, the smaller of both directions.
  /// Points of the largest connected patch that differs, one a voxel, the larger of both directions: a
  /// niche or a cabinet that only one of two tubes has makes one patch, noise and beams that miss make many.
  double largest_difference = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool is_comparable() const { return confirmed > 0.0; }  ///< Some points of both count.
};

/// `T_a_b` brings the points of b into the frame of a. Nothing in common: not comparable.
[[nodiscard]] Agreement agreement(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                                  const RegistrationConfig& config);

/// A guess as odometry makes it, put right by the surfaces, and how well they agree there.
struct LocalFit {
  Pose T_a_b;
  Agreement agreement;
};
/// From where a fit is tried.
enum class FitFrom {
  guess,
  along_the_way,  ///< And from up to 1.5 m before and behind it, along the way of b (its x axis).
};
/// The fit with the smallest difference that point-to-plane finds; what differs by no more than `enough`
/// points ends the search. The guess is taken for exact first, then for off by some voxels. Farther than 2.5
/// m from it nothing is accepted: not comparable.
[[nodiscard]] LocalFit fit_near(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b, double enough,
                                const RegistrationConfig& config, FitFrom from = FitFrom::along_the_way);

}  // namespace adit
