// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/relief.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace adit {
namespace {

constexpr float kPatch = 1.0F;            // metres
constexpr float kRange = 15.0F;           // metres; farther away the beams are too far apart
constexpr float kNear = 0.2F;             // metres along a wall, from a point of b to one of a
constexpr float kOff = 0.15F;             // metres; what stands farther off is another thing, not relief
constexpr float kSameSide = 0.95F;        // cosine between two normals
constexpr std::size_t kEnoughPoints = 3;  // of b, in a patch
constexpr double kTells = 0.002;  // metres; what is less is left by where on a wall the beams happen to fall
constexpr double kChance = 0.5;
constexpr double kUsual = 0.52;       // share of patches that stand where walls are the same, at least
constexpr double kTolerance = 0.04;   // by which that share may be larger between two robots
constexpr double kLeast = 1.0 / 3.0;  // of what look-alikes have beyond chance
constexpr std::size_t kEnough = 300;  // patches: below, a few bad fits are a large part of them

std::int32_t side_of(const Eigen::Vector3f& normal) {
  Eigen::Index axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return static_cast<std::int32_t>(2 * axis + (normal[axis] > 0.0F ? 1 : 0));
}

}  // namespace

std::vector<PatchOffset> patch_offsets(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                                       const Pose& T_map_a) {
  struct Sum {
    double metres = 0.0;
    std::size_t num_points = 0;
  };
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  const Eigen::Matrix3f R_map = T_map_a.rotation_matrix().cast<float>();
  const Eigen::Vector3f t_map = T_map_a.translation().cast<float>();
  std::map<WallPatch, Sum> sums;
  for (std::size_t i = 0; i < b.points().size(); ++i) {
    const Eigen::Vector3f p = R * b.points().points[i] + t;
    if ((p - a.viewpoint()).norm() > kRange) continue;
    const auto near = a.tree().nearest(p, kNear);
    if (!near) continue;
    const Eigen::Vector3f& normal = a.points().normals[near->index];
    const float off = normal.dot(p - a.points().points[near->index]);
    if (std::abs(off) > kOff || (R * b.points().normals[i]).dot(normal) < kSameSide) continue;
    const Eigen::Array3f cell = ((R_map * p + t_map) / kPatch).array().floor();
    Sum& sum = sums[{static_cast<std::int32_t>(cell.x()), static_cast<std::int32_t>(cell.y()),
                     static_cast<std::int32_t>(cell.z()), side_of(R_map * normal)}];
    sum.metres += static_cast<double>(off);
    ++sum.num_points;
  }
  std::vector<PatchOffset> out;
  for (const auto& [patch, sum] : sums)
    if (sum.num_points >= kEnoughPoints)
      out.push_back({patch, sum.metres / static_cast<double>(sum.num_points)});
  return out;
}

void StandingOffsets::add(const std::vector<PatchOffset>& of_a_pair) {
  for (const PatchOffset& offset : of_a_pair) {
    Halves& halves = patches_[offset.patch];
    halves.sums[halves.num_pairs % 2] += offset.metres;
    ++halves.num_pairs;
  }
}

double StandingOffsets::Halves::mean(std::size_t half) const {
  const std::size_t num = (num_pairs + 1 - half) / 2;
  return sums[half] / static_cast<double>(num);
}

bool StandingOffsets::Halves::can_be_compared() const {
  return num_pairs >= 2 && std::abs(mean(0)) > kTells && std::abs(mean(1)) > kTells;
}

std::size_t StandingOffsets::num_patches() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(patches_, [](const auto& patch) { return patch.second.can_be_compared(); }));
}

std::size_t StandingOffsets::num_standing() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(patches_, [](const auto& patch) { return patch.second.stands(); }));
}

bool StandingOffsets::are_of_other_walls(const StandingShares& shares, double rate) const {
  if (num_patches() < kEnough) return false;
  const auto num = static_cast<double>(num_patches());
  const double at_most = std::min(shares.same() + kTolerance, 1.0);
  // The normal approximation of the binomial tail.
  const double z = (static_cast<double>(num_standing()) - at_most * num) / std::sqrt(num * 0.25);
  return 0.5 * std::erfc(z / std::numbers::sqrt2) < rate;
}

double StandingOffsets::evidence(const StandingShares& shares) const {
  const double same = shares.same();
  const double other = shares.other();
  if (!(other > same)) return 0.0;
  const auto standing = static_cast<double>(num_standing());
  const double not_standing = static_cast<double>(num_patches()) - standing;
  return standing * std::log(same / other) + not_standing * std::log((1.0 - same) / (1.0 - other));
}

void StandingShares::Count::add(const StandingOffsets& offsets) {
  num_patches += offsets.num_patches();
  num_standing += offsets.num_standing();
}

double StandingShares::Count::share() const {
  if (num_patches < kEnough) return kChance;
  return static_cast<double>(num_standing) / static_cast<double>(num_patches);
}

void StandingShares::add_same(const StandingOffsets& offsets) { same_.add(offsets); }
void StandingShares::add_other(const StandingOffsets& offsets) { other_.add(offsets); }
double StandingShares::same() const { return std::max(kUsual, same_.share()); }
double StandingShares::other() const { return kChance + kLeast * (other_.share() - kChance); }

}  // namespace adit
