// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "adit/registration/changed_thing.hpp"
#include "adit/registration/icp_refine.hpp"

namespace adit {
namespace {

// Cells of a view, three degrees wide: some points of a thinned cloud fall into each that sees a surface.
constexpr int kColumns = 120;
constexpr int kRows = 60;
// A point lies in front of a surface or behind it when the distance exceeds this many voxels plus this share
// of the range.
constexpr float kMarginVoxels = 1.0F;
constexpr float kMarginShare = 0.01F;
// Between two rings, as far apart as those of sparse LiDARs, floors and roofs are seen from aside.
constexpr float kRingGap = 0.035F;                             // radians
constexpr float kSameSurface = 0.8F;                           // cosine between normals
constexpr std::size_t kEnoughToAlign = 1500;                   // points, or up to twice as many
constexpr double kWideVoxels = 5.0;                            // farthest pairs of the first of two fits
constexpr double kMaxCorrection = 2.5;                         // metres
constexpr std::array kOtherStarts = {-1.5, 1.5, -0.75, 0.75};  // metres along the path
constexpr double kHopeless = 10.0;     // times `enough`: a difference that no small displacement removes
constexpr int kMaxIterations = 10;     // per fit
constexpr double kSameMinimum = 0.02;  // apart [m; rad]: searches end within a tenth of it

std::size_t place(int row, int column) {
  return static_cast<std::size_t>(row) * kColumns + static_cast<std::size_t>(column);
}

/// The angle of (x, y) to 1e-5 radians (Abramowitz, Stegun, "Handbook of Mathematical Functions", 4.4.49).
float rough_angle(float y, float x) {
  constexpr float kHalfPi = 0.5F * std::numbers::pi_v<float>;
  const float larger = std::max(std::abs(x), std::abs(y));
  const float t = larger > 0.0F ? std::min(std::abs(x), std::abs(y)) / larger : 0.0F;
  const float t2 = t * t;
  const float octant =
      t * (0.9998660F + t2 * (-0.3302995F + t2 * (0.1801410F + t2 * (-0.0851330F + t2 * 0.0208351F))));
  const float quadrant = std::abs(y) > std::abs(x) ? kHalfPi - octant : octant;
  const float upper = x < 0.0F ? 2.0F * kHalfPi - quadrant : quadrant;
  return y < 0.0F ? -upper : upper;
}

/// Which of `num` parts of `whole` radians, the middle one beginning at 0, holds the angle of (x, y). The
/// exact angle is computed only where a rough one does not tell.
int part_of_angle(float y, float x, float whole, int num) {
  constexpr float kUnsure = 1e-3F;
  const auto parts = [&](float angle) { return (angle / whole + 0.5F) * static_cast<float>(num); };
  const float rough = parts(rough_angle(y, x));
  const float within = rough - std::floor(rough);
  const bool is_sure = within > kUnsure && within < 1.0F - kUnsure;
  return std::clamp(static_cast<int>(is_sure ? rough : parts(std::atan2(y, x))), 0, num - 1);
}

std::size_t cell_of(const Eigen::Vector3f& direction) {
  constexpr float kPi = std::numbers::pi_v<float>;
  return place(part_of_angle(direction.z(), direction.head<2>().norm(), kPi, kRows),
               part_of_angle(direction.y(), direction.x(), 2.0F * kPi, kColumns));
}

OrientedPoints every_nth(const OrientedPoints& all) {
  const std::size_t step = std::max<std::size_t>(all.size() / kEnoughToAlign, 1);
  OrientedPoints some;
  for (std::size_t i = 0; i < all.size(); i += step) {
    some.points.push_back(all.points[i]);
    some.normals.push_back(all.normals[i]);
  }
  return some;
}

// By the points around some of those within 10 m: on a plane without gaps about seven lie within 1.5 voxels.
double thinness_of(const SearchableSurface& surface, float voxel) {
  constexpr float kNear = 10.0F;
  constexpr std::size_t kSamples = 64;
  constexpr float kRadiusVoxels = 1.5F;
  constexpr double kThinnest = 4.0;
  const float reach = kRadiusVoxels * voxel;
  const double without_gaps = std::numbers::pi * static_cast<double>(kRadiusVoxels * kRadiusVoxels);
  const std::vector<Eigen::Vector3f>& all = surface.points().points;
  std::vector<std::size_t> counts;
  const std::size_t step = std::max<std::size_t>(all.size() / kSamples, 1);
  for (std::size_t i = 0; i < all.size(); i += step) {
    if ((all[i] - surface.viewpoint()).norm() > kNear) continue;
    counts.push_back(surface.grid().num_nearer(all[i], reach * reach));
  }
  if (counts.empty()) return 1.0;
  const auto middle = counts.begin() + std::ssize(counts) / 2;
  std::ranges::nth_element(counts, middle);
  return std::clamp(without_gaps / static_cast<double>(*middle), 1.0, kThinnest);
}

// By how much the range of a surface changes from one ring to the next.
float between_rings(const Eigen::Vector3f& ray, float range, const Eigen::Vector3f& normal) {
  constexpr float kLeastCosine = 0.05F;
  const Eigen::Vector3f direction = ray / range;
  const Eigen::Vector3f upward = Eigen::Vector3f::UnitZ() - direction.z() * direction;
  return kRingGap * range * std::abs(normal.dot(upward)) /
         std::max(std::abs(normal.dot(direction)), kLeastCosine);
}

// What a saw where a point of b lies, given in the frame of a.
Compared compared(const SeenSurface& a, const Eigen::Vector3f& p, const Eigen::Vector3f& normal,
                  const RegistrationConfig& config) {
  const auto voxel = static_cast<float>(config.voxel_size);
  const auto reach = static_cast<float>(config.overlap_distance_voxels) * voxel;
  const auto thickness = static_cast<float>(config.refine_kernel_voxels) * voxel;
  const Eigen::Vector3f ray = p - a.viewpoint();
  const SeenSurface::Ranges& seen = a.towards(ray);
  if (seen.empty()) return Compared::unseen;
  const float range = ray.norm();
  const float margin = kMarginVoxels * voxel + kMarginShare * range + between_rings(ray, range, normal);
  if (range > seen.farthest + margin) return Compared::unseen;  // hidden
  if (range < seen.nearest - margin) return Compared::differs;
  const auto near = a.grid().nearest(p, reach);
  if (!near) return Compared::unseen;  // between the beams
  const Eigen::Vector3f& a_normal = a.points().normals[near->index];
  const float off = a_normal.dot(p - a.points().points[near->index]);
  if (!(std::abs(off) < thickness)) {
    // Behind that surface is what it hides: the wall beside something that stands in front of it.
    const bool is_behind = off * a_normal.dot(ray) > 0.0F;
    return is_behind ? Compared::unseen : Compared::differs;
  }
  return a_normal.dot(normal) > kSameSurface ? Compared::same_surface : Compared::confirmed;
}

struct Counts {
  std::size_t confirmed = 0;
  std::size_t differing = 0;
  double largest_difference = 0.0;
  std::vector<DifferingPatch> structures;  // in the frame of b, the largest first
  std::vector<DifferingPatch> things;
};

// Compares the points of b with what a saw in the same space.
Counts seen_by(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
               const RegistrationConfig& config) {
  const Eigen::Matrix3f R = T_a_b.rotation_matrix().cast<float>();
  const Eigen::Vector3f t = T_a_b.translation().cast<float>();
  const OrientedPoints& points = b.points();
  Counts counts;
  std::vector<Compared> all(points.size());
  std::vector<std::size_t> differing;
  std::vector<Eigen::Vector3f> where;  // those differ, in the frame of a
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f p = R * points.points[i] + t;
    all[i] = compared(a, p, R * points.normals[i], config);
    if (all[i] == Compared::unseen) continue;
    if (all[i] != Compared::differs) {
      ++counts.confirmed;
      continue;
    }
    differing.push_back(i);
    where.push_back(p);
  }
  counts.differing = differing.size();
  for (std::vector<std::size_t>& patch : connected_patches(where, static_cast<float>(config.voxel_size))) {
    for (std::size_t& i : patch) i = differing[i];
    const bool is_thing = patch.size() >= kLeastPatch && may_be_a_thing(b, patch, all, config);
    const double size = b.thinness() * static_cast<double>(patch.size());
    if (!is_thing) counts.largest_difference = std::max(counts.largest_difference, size);
    if (patch.size() < kLeastPatch) break;
    Vector3 sum = Vector3::Zero();
    for (const std::size_t i : patch) sum += points.points[i].cast<double>();
    (is_thing ? counts.things : counts.structures).push_back({sum / static_cast<double>(patch.size()), size});
  }
  return counts;
}

}  // namespace

void SeenSurface::Ranges::add(const Ranges& other) {
  nearest = std::min(nearest, other.nearest);
  farthest = std::max(farthest, other.farthest);
}

SeenSurface::SeenSurface(OrientedPoints points, const Vector3& viewpoint, double voxel_m)
    : SearchableSurface(std::move(points), viewpoint, voxel_m),
      some_(every_nth(this->points())),
      ranges_(std::size_t{kRows} * kColumns),
      thinness_(thinness_of(*this, static_cast<float>(voxel_m))) {
  std::vector<Ranges> own(ranges_.size());
  for (const Eigen::Vector3f& p : this->points().points) {
    const Eigen::Vector3f ray = p - this->viewpoint();
    const float range = ray.norm();
    own[cell_of(ray)].add({range, range});
    lowest_ = std::min(lowest_, ray.z() / range);
    highest_ = std::max(highest_, ray.z() / range);
  }
  for (int row = 0; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column) {
      const std::size_t cell = place(row, column);
      if (own[cell].empty()) continue;
      for (int i = std::max(row - 1, 0); i <= std::min(row + 1, kRows - 1); ++i)
        for (int j = -1; j <= 1; ++j) ranges_[cell].add(own[place(i, (column + j + kColumns) % kColumns)]);
    }
  }
}

const SeenSurface::Ranges& SeenSurface::towards(const Eigen::Vector3f& direction) const {
  static constexpr Ranges kNothing;
  const float sine = direction.z() / direction.norm();
  if (sine < lowest_ || sine > highest_) return kNothing;
  return ranges_[cell_of(direction)];
}

std::size_t SeenSurface::num_bytes() const {
  return SearchableSurface::num_bytes() + 2 * some_.size() * sizeof(Eigen::Vector3f) +
         ranges_.size() * sizeof(Ranges);
}

Agreement agreement(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b,
                    const RegistrationConfig& config, double below) {
  std::array<Counts, 2> both;
  both[0] = seen_by(a, b, T_a_b, config);
  if (!(both[0].largest_difference < below)) return {};
  both[1] = seen_by(b, a, T_a_b.inverse(), config);
  Agreement out{1.0, 0.0, both[1].structures, both[1].things};
  for (const DifferingPatch& patch : both[0].structures)
    out.structures.push_back({T_a_b * patch.position, patch.num_points});
  for (const DifferingPatch& patch : both[0].things)
    out.things.push_back({T_a_b * patch.position, patch.num_points});
  for (const Counts& counts : both) {
    if (counts.confirmed == 0) return {};
    out.confirmed = std::min(out.confirmed, static_cast<double>(counts.confirmed) /
                                                static_cast<double>(counts.confirmed + counts.differing));
    out.largest_difference = std::max(out.largest_difference, counts.largest_difference);
  }
  return out;
}

namespace {

/// The fit with the smallest difference; where no fit differs by less than `below` points, `T_a_b` itself,
/// which is not comparable.
LocalFit best_fit_near(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b, double enough,
                       const RegistrationConfig& config, FitFrom from, double below) {
  LocalFit best{T_a_b, {.largest_difference = below}};
  if (a.points().empty() || b.points().empty()) return best;
  RegistrationConfig narrow = config;
  narrow.refine_max_iterations = std::min(config.refine_max_iterations, kMaxIterations);
  RegistrationConfig wide = narrow;
  wide.refine_distance_voxels = kWideVoxels;
  std::vector<Pose> minima;  // that were looked at: most starts lead to one of few
  const auto fit_from = [&](const Pose& start) {
    const auto [near, has_arrived] = approach_planes(a.points(), a.grid(), b.some(), start, narrow);
    const auto is_near = [&near = near](const Pose& other) {
      return (near.inverse() * other).log().norm() < kSameMinimum;
    };
    if (has_arrived && std::ranges::any_of(minima, is_near)) return;
    if (has_arrived) minima.push_back(near);
    const Pose T = has_arrived ? align_to_planes(a.points(), a.grid(), b.some(), near, narrow) : near;
    if (!((T.translation() - T_a_b.translation()).norm() < kMaxCorrection)) return;
    const Agreement found = agreement(a, b, T, config, best.agreement.largest_difference);
    if (found.largest_difference < best.agreement.largest_difference) best = {T, found};
  };
  const auto found = [&](const Pose& guess) {
    fit_from(approach_planes(a.points(), a.grid(), b.some(), guess, wide).T_a_b);
    return best.agreement.largest_difference <= enough;
  };
  fit_from(T_a_b);
  if (best.agreement.largest_difference <= enough || found(T_a_b) || from == FitFrom::guess) return best;
  for (const double ahead : kOtherStarts) {
    if (best.agreement.largest_difference > kHopeless * enough) break;
    if (found(T_a_b * Pose::translation_of(ahead, 0.0, 0.0))) break;
  }
  return best;
}

}  // namespace

LocalFit fit_near(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b, double enough,
                  const RegistrationConfig& config, FitFrom from) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  return best_fit_near(a, b, T_a_b, enough, config, from, kAny);
}

std::optional<Pose> agreeing_fit(const SeenSurface& a, const SeenSurface& b, const Pose& T_a_b, double enough,
                                 const RegistrationConfig& config) {
  // A difference of exactly `enough` agrees.
  const double below = std::nextafter(enough, std::numeric_limits<double>::infinity());
  const LocalFit found = best_fit_near(a, b, T_a_b, enough, config, FitFrom::guess, below);
  if (!found.agreement.is_comparable()) return {};
  return found.T_a_b;
}

}  // namespace adit
