// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/relief.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace adit {
namespace {

/// Sums over the points of b on a patch.
struct OnPatch {
  double metres = 0.0;
  SensorTerms by_sensors = SensorTerms::Zero();
  Vector6 by_fit = Vector6::Zero();
  Eigen::Vector2d by_known = Eigen::Vector2d::Zero();
  int num_points = 0;
};

/// One side of a stretch of tunnel, which fresh lining or a widened face would move as a whole.
using Stretch = std::array<std::int32_t, 3>;
Stretch stretch_of(const WallPatch& patch, double patch_m) {
  constexpr double kStretch = 10.0;  // metres
  const auto cell = [&](std::int32_t i) {
    return static_cast<std::int32_t>(std::floor(i * patch_m / kStretch));
  };
  return {cell(patch[0]), cell(patch[1]), patch[3]};
}

/// For each offset the number of its stretch, counted from 0.
std::vector<std::size_t> stretches_of(const std::vector<PatchOffset>& offsets, double patch_m) {
  std::map<Stretch, std::size_t> known;
  std::vector<std::size_t> out;
  out.reserve(offsets.size());
  for (const PatchOffset& offset : offsets)
    out.push_back(known.emplace(stretch_of(offset.patch, patch_m), known.size()).first->second);
  return out;
}

/// `stretches` are not empty.
double share_of(const std::vector<StretchSigns>& stretches) {
  StretchSigns all;
  for (const StretchSigns& one : stretches) {
    all.num += one.num;
    all.equal += one.equal;
  }
  return all.share();
}

/// Of that share, by how those of the stretches differ; no share is known better than by the toss of so many
/// coins, even where all signs are equal.
double sigma_of_share(const std::vector<StretchSigns>& stretches, double share) {
  double num = 0.0;
  double squares = 0.0;
  for (const StretchSigns& one : stretches) {
    num += one.num;
    squares += std::pow(one.equal - share * one.num, 2);
  }
  return std::max(std::sqrt(squares) / num, 0.5 / std::sqrt(num));
}

/// The share of the sum of squares that the sensors explain.
double sensors_in(const OffsetParts& found) {
  const double whole = (found.by_sensors + found.left).squaredNorm();
  return whole > 0.0 ? std::clamp(1.0 - found.left.squaredNorm() / whole, 0.0, 1.0) : 0.0;
}

float intensity_of(const OrientedPoints& points, std::size_t i) {
  return points.intensities.empty() ? 0.0F : points.intensities[i];
}

std::int32_t side_of(const Eigen::Vector3f& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::int32_t>(2 * axis + (normal[axis] > 0.0F ? 1 : 0));
}

}  // namespace

std::vector<PatchOffset> patch_offsets(const SearchableSurface& a, const SearchableSurface& b,
                                       const Pose& T_a_b, const Pose& T_map_a,
                                       const RegistrationConfig& registration) {
  const ReliefConfig& config = registration.relief;
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  const Eigen::Matrix3f R_map = T_map_a.rotation_matrix().cast<float>();
  const Eigen::Vector3f t_map = T_map_a.translation().cast<float>();
  const auto patch = static_cast<float>(config.patch_m);
  const auto max_range = static_cast<float>(config.max_range_m);
  const auto pairing_distance = static_cast<float>(config.pairing_distance_m);
  const auto max_offset = static_cast<float>(config.max_offset_m);
  const auto min_cosine = static_cast<float>(config.min_normal_cosine);
  const SensorTermsOf terms_of(a, b, T_a_b);
  std::map<WallPatch, OnPatch> patches;
  for (std::size_t i = 0; i < b.points().size(); ++i) {
    const Eigen::Vector3f p = R * b.points().points[i] + t;
    if ((p - a.viewpoint()).norm() > max_range) continue;
    const auto near = a.grid().nearest(p, pairing_distance);
    if (!near) continue;
    const Eigen::Vector3f& normal_a = a.points().normals[near->index];
    const Eigen::Vector3f normal_b = R * b.points().normals[i];
    if (normal_a.dot(normal_b) < min_cosine) continue;
    // Of two points beside one another on a wall that curves, each is off the plane through the other; along
    // the mean of both normals neither is.
    const WallPair pair{a.points().points[near->index], p, (normal_a + normal_b).normalized(),
                        intensity_of(a.points(), near->index), intensity_of(b.points(), i)};
    const float off = pair.normal.dot(p - pair.seen_by_a);
    if (std::abs(off) > max_offset) continue;
    const Eigen::Array3f cell = ((R_map * p + t_map) / patch).array().floor();
    OnPatch& sum = patches[{static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y()),
                            static_cast<std::int32_t>(cell.z()), side_of(R_map * pair.normal)}];
    sum.metres += static_cast<double>(off);
    sum.by_fit += motion_terms(pair);
    terms_of.add(pair, 1.0, sum.by_sensors, sum.by_known);
    ++sum.num_points;
  }
  std::vector<PatchOffset> out;
  for (const auto& [where, sum] : patches)
    if (sum.num_points >= config.min_points)
      out.push_back({where, sum.metres / sum.num_points, sum.by_sensors / sum.num_points,
                     sum.by_fit / sum.num_points, sum.by_known / sum.num_points});
  return out;
}

void WallOffsets::add(const std::vector<PatchOffset>& of_a_pair) {
  first_of_pair_.push_back(std::ssize(offsets_));
  offsets_.insert(offsets_.end(), of_a_pair.begin(), of_a_pair.end());
  counted_.reset();
}

OffsetParts WallOffsets::parts() const {
  const Eigen::Index num = std::ssize(offsets_);
  OffsetSystem system{Eigen::VectorXd(num),
                      {num, kSensorErrors},
                      {num, 6},
                      first_of_pair_,
                      {},
                      stretches_of(offsets_, config_.patch_m)};
  Eigen::Matrix<double, Eigen::Dynamic, 2> known(num, 2);
  std::map<WallPatch, Eigen::Index> last;
  for (Eigen::Index i = 0; i < num; ++i) {
    const PatchOffset& offset = offsets_[static_cast<std::size_t>(i)];
    system.metres[i] = offset.metres;
    system.by_sensors.row(i) = offset.by_sensors.transpose();
    system.by_fit.row(i) = offset.by_fit.transpose();
    known.row(i) = offset.by_known.transpose();
    const auto [before, is_first] = last.emplace(offset.patch, i);
    if (!is_first) system.repeated.push_back({std::exchange(before->second, i), i});
  }
  centre_intensities(system.by_sensors, known);
  return taken_apart(system, {});
}

double WallOffsets::share_of_sensors() const { return counted_once().share_of_sensors; }

const EqualSignShare& WallOffsets::counted() const { return counted_once().signs; }

const WallOffsets::Counted& WallOffsets::counted_once() const {
  if (!counted_) {
    const OffsetParts found = parts();
    counted_ = {signs_of(found), sensors_in(found)};
  }
  return *counted_;
}

EqualSignShare WallOffsets::signs_of(const OffsetParts& found) const {
  struct Sides {
    std::size_t num_in_front = 0;
    std::size_t num_behind = 0;
  };
  std::map<WallPatch, Sides> patches;
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    const double metres = found.left[static_cast<Eigen::Index>(i)];
    if (std::abs(metres) <= config_.min_offset_m || found.is_moved[i]) continue;
    Sides& sides = patches[offsets_[i].patch];
    ++(metres > 0.0 ? sides.num_in_front : sides.num_behind);
  }
  EqualSignShare out;
  std::map<Stretch, StretchSigns> by_stretch;
  for (const auto& [patch, sides] : patches) {
    const auto front = static_cast<double>(sides.num_in_front);
    const auto behind = static_cast<double>(sides.num_behind);
    const double num = front + behind;
    if (num < 2.0) continue;
    ++out.num_patches;
    StretchSigns& stretch = by_stretch[stretch_of(patch, config_.patch_m)];
    stretch.num += num - 1.0;
    stretch.equal += (front * (front - 1.0) + behind * (behind - 1.0)) / num;
  }
  if (by_stretch.empty()) return out;
  for (const auto& [where, stretch] : by_stretch) out.stretches.push_back(stretch);
  out.share = share_of(out.stretches);
  out.sigma = sigma_of_share(out.stretches, out.share);
  out.noise_m = found.noise_m;
  return out;
}

}  // namespace adit
