// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/relief.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

namespace adit {
namespace {

constexpr double kChance = 0.5;  ///< Share of equal signs that noise gives.

double normal_density(double off, double sigma) {
  return std::exp(-0.5 * off * off / (sigma * sigma)) / (sigma * std::sqrt(2.0 * std::numbers::pi));
}

double density(const EqualSignShare& found, const SameWalls& walls) {
  return normal_density(found.share - walls.mean, std::hypot(walls.sigma, found.sigma));
}

/// The share that walls which give `share` under one noise give under another one. Offsets of two pairs,
/// whose common part is the relief, have the correlation rho = relief^2 / (relief^2 + noise^2) and equal
/// signs at the share 1/2 + asin(rho) / pi (Sheppard, "On the application of the theory of error", 1899).
double under_noise(double share, double from_m, double to_m) {
  if (!(from_m > 0.0 && to_m > 0.0)) return share;
  constexpr double kNearlyOne = 0.999;
  const double rho = std::min(std::sin(std::numbers::pi * (share - kChance)), kNearlyOne);
  const double ratio = rho / (1.0 - rho) * std::pow(from_m / to_m, 2);
  return kChance + std::asin(ratio / (1.0 + ratio)) / std::numbers::pi;
}

/// Averages over the distribution of `walls` by steps in its standard deviation.
double density(const EqualSignShare& found, const OtherWalls& walls) {
  constexpr double kStep = 0.1;  // sigmas
  constexpr int kSteps = 60;     // to each side
  double sum = 0.0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double share =
        kChance + std::min(std::exp(walls.mean_log + kStep * i * walls.sigma_log), 1.0 - kChance);
    sum += kStep * normal_density(kStep * i, 1.0) * normal_density(found.share - share, found.sigma);
  }
  return sum;
}

/// Sums over the points of b on a patch.
struct OnPatch {
  double metres = 0.0;
  SensorTerms by_sensors = SensorTerms::Zero();
  Vector6 by_fit = Vector6::Zero();
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

/// The share of equal signs on a stretch. It weighs as much as the pairs beyond the first that saw its
/// patches.
struct OfStretch {
  double weight = 0.0;
  double agreeing = 0.0;
  [[nodiscard]] double share() const { return agreeing / weight; }
};

double weight_of(const std::vector<OfStretch>& stretches) {
  double weight = 0.0;
  for (const OfStretch& one : stretches) weight += one.weight;
  return weight;
}

/// The number below which half of the weight lies; `value` of each stretch.
template <class Value>
double weighted_median(const std::vector<OfStretch>& stretches, const Value& value) {
  std::vector<OfStretch> sorted = stretches;
  std::ranges::stable_sort(sorted, {}, value);
  const double half = 0.5 * weight_of(sorted);
  double below = 0.0;
  for (const OfStretch& one : sorted)
    if ((below += one.weight) >= half) return value(one);
  return kChance;
}

/// Of the share of equal ones among so many: no share is known better, even where all agree.
double sigma_of_signs(double num) { return 0.5 / std::sqrt(num); }

EqualSignShare mean_of(const std::vector<OfStretch>& stretches) {
  const double weight = weight_of(stretches);
  EqualSignShare out;
  double agreeing = 0.0;
  for (const OfStretch& one : stretches) agreeing += one.agreeing;
  out.share = agreeing / weight;
  double squares = 0.0;
  for (const OfStretch& one : stretches) squares += std::pow(one.agreeing - out.share * one.weight, 2);
  out.sigma = std::max(std::sqrt(squares) / weight, sigma_of_signs(weight));
  return out;
}

EqualSignShare median_of(const std::vector<OfStretch>& stretches) {
  constexpr double kOfMedian = 1.2533;  // standard deviation of a median, by that of a mean
  constexpr double kOfMad = 1.4826;     // standard deviation by the median of deviations; both of normal ones
  const double weight = weight_of(stretches);
  EqualSignShare out;
  out.share = weighted_median(stretches, [](const OfStretch& one) { return one.share(); });
  const double mad =
      weighted_median(stretches, [&](const OfStretch& one) { return std::abs(one.share() - out.share); });
  double squares = 0.0;
  for (const OfStretch& one : stretches) squares += one.weight * one.weight;
  out.sigma = kOfMedian * std::max(kOfMad * mad * std::sqrt(squares) / weight, sigma_of_signs(weight));
  return out;
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
    const WallPair pair{a.points().points[near->index], p, a.points().normals[near->index]};
    const float off = pair.normal.dot(p - pair.seen_by_a);
    if (std::abs(off) > max_offset || (R * b.points().normals[i]).dot(pair.normal) < min_cosine) continue;
    const Eigen::Array3f cell = ((R_map * p + t_map) / patch).array().floor();
    OnPatch& sum = patches[{static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y()),
                            static_cast<std::int32_t>(cell.z()), side_of(R_map * pair.normal)}];
    sum.metres += static_cast<double>(off);
    sum.by_fit += motion_terms(pair);
    terms_of.add(pair, 1.0, sum.by_sensors);
    ++sum.num_points;
  }
  std::vector<PatchOffset> out;
  for (const auto& [where, sum] : patches)
    if (sum.num_points >= config.min_points)
      out.push_back(
          {where, sum.metres / sum.num_points, sum.by_sensors / sum.num_points, sum.by_fit / sum.num_points});
  return out;
}

void WallOffsets::add(const std::vector<PatchOffset>& of_a_pair) {
  first_of_pair_.push_back(std::ssize(offsets_));
  offsets_.insert(offsets_.end(), of_a_pair.begin(), of_a_pair.end());
  counted_.reset();
}

OffsetParts WallOffsets::parts() const {
  const Eigen::Index num = std::ssize(offsets_);
  OffsetSystem system{Eigen::VectorXd(num), {num, kSensorErrors}, {num, 6}, first_of_pair_};
  for (Eigen::Index i = 0; i < num; ++i) {
    const PatchOffset& offset = offsets_[static_cast<std::size_t>(i)];
    system.metres[i] = offset.metres;
    system.by_sensors.row(i) = offset.by_sensors.transpose();
    system.by_fit.row(i) = offset.by_fit.transpose();
  }
  return taken_apart(system, {});
}

double WallOffsets::share_of_sensors() const {
  const OffsetParts found = parts();
  const double whole = (found.by_sensors + found.left).squaredNorm();
  return whole > 0.0 ? std::clamp(1.0 - found.left.squaredNorm() / whole, 0.0, 1.0) : 0.0;
}

EqualSignShare WallOffsets::counted() const {
  if (!counted_) counted_ = count();
  return *counted_;
}

EqualSignShare WallOffsets::count() const {
  constexpr std::size_t kFew = 5;  // stretches, of which a median says little
  struct Sides {
    std::size_t num_in_front = 0;
    std::size_t num_behind = 0;
  };
  const Eigen::VectorXd left = parts().left;
  std::map<WallPatch, double> last;  // offset of each patch
  std::vector<double> apart;         // of two offsets of one patch
  std::map<WallPatch, Sides> patches;
  for (std::size_t i = 0; i < offsets_.size(); ++i) {
    const double metres = left[static_cast<Eigen::Index>(i)];
    if (const auto [before, is_first] = last.emplace(offsets_[i].patch, metres); !is_first) {
      apart.push_back(std::abs(metres - before->second));
      before->second = metres;
    }
    if (std::abs(metres) <= config_.min_offset_m) continue;
    Sides& sides = patches[offsets_[i].patch];
    ++(metres > 0.0 ? sides.num_in_front : sides.num_behind);
  }
  std::map<Stretch, OfStretch> by_stretch;
  std::size_t num_patches = 0;
  for (const auto& [patch, sides] : patches) {
    const auto front = static_cast<double>(sides.num_in_front);
    const auto behind = static_cast<double>(sides.num_behind);
    const double num = front + behind;
    if (num < 2.0) continue;
    ++num_patches;
    OfStretch& stretch = by_stretch[stretch_of(patch, config_.patch_m)];
    stretch.weight += num - 1.0;
    stretch.agreeing += (front * (front - 1.0) + behind * (behind - 1.0)) / num;
  }
  if (by_stretch.empty()) return {};
  std::vector<OfStretch> stretches;
  for (const auto& [where, stretch] : by_stretch) stretches.push_back(stretch);
  const bool may_have_moved = visits_ == Visits::two && stretches.size() >= kFew;
  EqualSignShare out = may_have_moved ? median_of(stretches) : mean_of(stretches);
  out.num_patches = num_patches;
  constexpr double kOfDifference =
      1.4826 / std::numbers::sqrt2;  // by the median of |differences| of normal ones
  const auto middle = apart.begin() + std::ssize(apart) / 2;
  std::ranges::nth_element(apart, middle);
  out.noise_m = kOfDifference * *middle;
  return out;
}

double WallOffsets::evidence(const EqualSignShares& shares, double times) const {
  EqualSignShare found = counted();
  found.num_patches = static_cast<std::size_t>(times * static_cast<double>(found.num_patches));
  found.sigma /= std::sqrt(times);
  const std::optional<OtherWalls> other = shares.other(found.noise_m);
  if (found.num_patches < static_cast<std::size_t>(shares.model().min_patches)) return 0.0;
  found.share = std::max(found.share, kChance);  // less than chance is chance
  constexpr double kLeast = 1e-300;              // for the logarithm
  // The share on the own map only bounds what one wall gives: what makes signs equal there, leaves and edges,
  // may be missing between two maps.
  SameWalls same = shares.same();
  same.mean = std::clamp(found.share, std::min(shares.model().same_share, same.mean), same.mean);
  const double of_same = std::max(density(found, same), kLeast);
  const double of_other = std::max(density(found, other.value_or(shares.believed(found.noise_m))), kLeast);
  const double changed = shares.model().changed;
  const double moulded = shares.chance_of_one_mould();
  return std::log((1.0 - changed) * of_same + changed * of_other) -
         std::log(moulded * of_same + (1.0 - moulded) * of_other);
}

void EqualSignShares::set_same(const EqualSignShare& share) { same_ = share; }

void EqualSignShares::add_other(const EqualSignShare& share) {
  if (share.num_patches >= static_cast<std::size_t>(model_.min_patches)) others_.push_back(share);
}

SameWalls EqualSignShares::same() const {
  SameWalls walls{model_.same_share, model_.same_sigma};
  if (same_.num_patches >= static_cast<std::size_t>(model_.min_patches))
    walls.mean = std::max(walls.mean, same_.share);
  return walls;
}

std::vector<double> EqualSignShares::chances_to_be_the_same() const {
  constexpr int kRounds = 50;  // of expectation and maximisation, which settle within ten or so
  std::vector<double> ratios;  // of likelihoods, the same walls to others
  for (const EqualSignShare& one : others_) {
    const double of_same = density(one, same());
    ratios.push_back(of_same > 0.0 ? of_same / density(one, believed(one.noise_m)) : 0.0);
  }
  std::vector<double> chances(others_.size());
  double rate = model_.prior_moulded;
  for (int round = 0; round < kRounds; ++round) {
    double num_same = model_.prior_moulded;
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      const double odds = ratios[i] * rate / (1.0 - rate);
      chances[i] = std::isfinite(odds) ? odds / (1.0 + odds) : 1.0;
      num_same += chances[i];
    }
    rate = num_same / (1.0 + static_cast<double>(ratios.size()));
  }
  return chances;
}

double EqualSignShares::chance_of_one_mould() const {
  if (others_.empty()) return model_.prior_moulded;
  const std::vector<double> chances = chances_to_be_the_same();
  const double num_same = std::accumulate(chances.begin(), chances.end(), 0.0);
  return std::min(1.0, model_.moulded + num_same / (1.0 + static_cast<double>(chances.size())));
}

double EqualSignShares::most_evidence() const { return std::log(1.0 / chance_of_one_mould()); }

OtherWalls EqualSignShares::believed(double noise_m) const {
  return {std::log(under_noise(model_.prior_other_share, same_.noise_m, noise_m) - kChance),
          model_.prior_sigma};
}

std::optional<OtherWalls> EqualSignShares::other(double noise_m) const {
  constexpr double kFewest = 0.5;  // look-alikes that were seen to be others, in expectation
  struct Beyond {
    double weight;  // P(the walls are others)
    double log;     // of the share beyond one half
    double sigma;   // of that logarithm
  };
  std::vector<Beyond> all;
  double num = 0.0;
  double mean = 0.0;
  const std::vector<double> chances = chances_to_be_the_same();
  for (std::size_t i = 0; i < others_.size(); ++i) {
    const EqualSignShare& one = others_[i];
    // No share is known to be nearer to one half than its error.
    const double least = kChance + std::max(one.share - kChance, one.sigma);
    const double beyond = under_noise(least, one.noise_m, noise_m) - kChance;
    const double weight = 1.0 - chances[i];
    all.push_back({weight, std::log(beyond), one.sigma / beyond});
    num += weight;
    mean += weight * all.back().log;
  }
  if (num < kFewest) return {};
  mean /= num;
  double beyond_chance = model_.prior_stretches * model_.prior_sigma * model_.prior_sigma;
  for (const Beyond& one : all)
    beyond_chance += one.weight * std::max(0.0, std::pow(one.log - mean, 2) - one.sigma * one.sigma);
  const double variance = beyond_chance / std::max(model_.prior_stretches + num - 1.0, kFewest);
  return OtherWalls{mean, std::sqrt(variance * (1.0 + 1.0 / num))};
}

}  // namespace adit
