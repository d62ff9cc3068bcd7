// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/distinctive_stretch.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <span>

#include "adit/core/parallel.hpp"
#include "adit/core/progress.hpp"
#include "adit/evaluation/loop_stats.hpp"
#include "adit/study/surface_fit.hpp"

namespace adit {
namespace {

// In samples of a path, one per metre.
constexpr auto kStretchSamples = static_cast<std::size_t>(kDistinctiveStretch);
constexpr std::size_t kStretchEvery = 5;  ///< From the begin of a stretch to that of the next.
constexpr std::size_t kSamplesApart = 3;  ///< Of alignments that are tried, along one path.

constexpr double kShared = 4.0;   ///< Metres, as shared_stretch_m.
constexpr double kAlike = 0.005;  ///< Share of directions that may differ. A niche of 2 m has twice that.
constexpr std::size_t kMostAlikeSurfaces = 16;  ///< Alignments tried, of those that look most alike.

enum class Sense { same, opposite };

/// A place that a stretch could be laid over: where its first sample would come to lie.
struct LaidOver {
  std::size_t robot = 0;
  std::size_t begin = 0;  ///< The sample of lowest number.
  Sense sense = Sense::same;
  int difference = 0;  ///< Of the profiles.
};

using SurfacePath = std::vector<SurfaceSample>;
/// Ranges of one sample, in steps of 5 cm.
using WallProfile = std::array<std::uint8_t, kRays>;
constexpr float kProfileStep = 0.05F;

WallProfile profile_of(const SurfaceSample& sample, Sense sense) {
  constexpr float kMost = 255.0F;
  WallProfile profile;
  for (std::size_t ray = 0; ray < kRays; ++ray) {
    const float range = sample.ranges[sense == Sense::same ? ray : turned_ray(ray)];
    profile[ray] = static_cast<std::uint8_t>(std::min(range / kProfileStep, kMost));
  }
  return profile;
}

std::vector<WallProfile> profiles_of(const SurfacePath& path, Sense sense) {
  std::vector<WallProfile> profiles;
  for (const SurfaceSample& sample : path) profiles.push_back(profile_of(sample, sense));
  return profiles;
}

int difference_of(const WallProfile& a, const WallProfile& b) {
  constexpr int kMost = 10;  // half a metre: a niche that is twice as deep is not twice as different
  int sum = 0;
  for (std::size_t ray = 0; ray < kRays; ++ray) sum += std::min(std::abs(a[ray] - b[ray]), kMost);
  return sum;
}

/// x along the stretch, origin in its middle.
Pose frame_of(std::span<const SurfaceSample> stretch) {
  const Vector3 begin = stretch.front().T_world_view.translation();
  const Vector3 end = stretch.back().T_world_view.translation();
  const Vector3 x = (end - begin).normalized();
  const Vector3 y = Vector3::UnitZ().cross(x).normalized();
  if (!x.allFinite() || !y.allFinite()) return stretch[stretch.size() / 2].T_world_view;
  Matrix3 R;
  R << x, y, x.cross(y);
  return {R, stretch[stretch.size() / 2].T_world_view.translation()};
}

/// All paths of a world, to look for one stretch among them.
class StretchSurfaces {
 public:
  StretchSurfaces(const Raycaster& world, const std::vector<Trajectory>& truths) : world_(world) {
    for (const Trajectory& truth : truths) {
      paths_.push_back(surface_along(world, truth));
      same_.push_back(profiles_of(paths_.back(), Sense::same));
      opposite_.push_back(profiles_of(paths_.back(), Sense::opposite));
    }
  }

  [[nodiscard]] const SurfacePath& path(std::size_t robot) const { return paths_[robot]; }

  [[nodiscard]] bool is_distinctive(std::size_t robot, std::size_t begin) const {
    const std::span<const SurfaceSample> stretch = at(robot, begin);
    const Vector3 middle = frame_of(stretch).translation();
    return std::ranges::none_of(most_alike(robot, begin), [&](const LaidOver& alignment) {
      const SurfaceFit fit = fit_surface(world_, stretch, laid_over(stretch, alignment));
      // What is aligned beside its own place slides home: that is no other place.
      return fit.differing <= kAlike && is_elsewhere(fit.T_there_here * middle, middle);
    });
  }

 private:
  [[nodiscard]] std::span<const SurfaceSample> at(std::size_t robot, std::size_t begin) const {
    return std::span(paths_[robot]).subspan(begin, kStretchSamples + 1);
  }

  [[nodiscard]] static bool is_elsewhere(const Vector3& there, const Vector3& here) {
    return (there - here).norm() > LoopTolerance{}.place_m;
  }

  [[nodiscard]] Pose laid_over(std::span<const SurfaceSample> stretch, const LaidOver& there) const {
    const Pose T_world_there = frame_of(at(there.robot, there.begin));
    const Pose turn = Pose::planar(0, 0, there.sense == Sense::same ? 0.0 : std::numbers::pi);
    return T_world_there * turn * frame_of(stretch).inverse();
  }

  [[nodiscard]] int difference(const WallProfile* stretch, std::size_t robot, std::size_t begin,
                               Sense sense) const;
  [[nodiscard]] std::vector<LaidOver> along(std::size_t robot, std::size_t begin, std::size_t other,
                                            Sense sense) const;
  [[nodiscard]] std::vector<LaidOver> most_alike(std::size_t robot, std::size_t begin) const;

  const Raycaster& world_;
  std::vector<SurfacePath> paths_;
  std::vector<std::vector<WallProfile>> same_;      ///< By robot, by sample.
  std::vector<std::vector<WallProfile>> opposite_;  ///< The same as who drives the other way sees them.
};

/// How much the profiles differ with the stretch's first sample on sample `begin` of the robot's path, or in
/// the opposite sense its last.
int StretchSurfaces::difference(const WallProfile* stretch, std::size_t robot, std::size_t begin,
                                Sense sense) const {
  const std::vector<WallProfile>& path = sense == Sense::same ? same_[robot] : opposite_[robot];
  int sum = 0;
  for (std::size_t k = 0; k <= kStretchSamples; ++k)
    sum += difference_of(stretch[k], path[sense == Sense::same ? begin + k : begin + kStretchSamples - k]);
  return sum;
}

/// Places along one path at which the stretch looks more alike than at those beside them, the most alike
/// first.
std::vector<LaidOver> StretchSurfaces::along(std::size_t robot, std::size_t begin, std::size_t other,
                                             Sense sense) const {
  const std::size_t num = paths_[other].size() - std::min(paths_[other].size(), kStretchSamples);
  const Vector3 middle = paths_[robot][begin + kStretchSamples / 2].T_world_view.translation();
  std::vector<LaidOver> all;
  for (std::size_t i = 0; i < num; ++i)
    if (is_elsewhere(paths_[other][i + kStretchSamples / 2].T_world_view.translation(), middle))
      all.push_back({other, i, sense, difference(&same_[robot][begin], other, i, sense)});
  std::ranges::stable_sort(all, {}, &LaidOver::difference);
  std::vector<LaidOver> found;
  for (const LaidOver& one : all) {
    const bool is_beside = std::ranges::any_of(found, [&](const LaidOver& better) {
      return std::max(one.begin, better.begin) - std::min(one.begin, better.begin) <= kSamplesApart;
    });
    if (!is_beside) found.push_back(one);
    if (found.size() == kMostAlikeSurfaces) break;
  }
  return found;
}

std::vector<LaidOver> StretchSurfaces::most_alike(std::size_t robot, std::size_t begin) const {
  std::vector<LaidOver> all;
  for (std::size_t other = 0; other < paths_.size(); ++other)
    for (const Sense sense : {Sense::same, Sense::opposite})
      std::ranges::copy(along(robot, begin, other, sense), std::back_inserter(all));
  std::ranges::stable_sort(all, {}, &LaidOver::difference);
  if (all.size() > kMostAlikeSurfaces) all.resize(kMostAlikeSurfaces);
  return all;
}

/// Whether each sample lies on the other robot's path.
std::vector<bool> shared_with(const SurfacePath& path, const SurfacePath& other) {
  std::vector<bool> shared;
  for (const SurfaceSample& sample : path)
    shared.push_back(std::ranges::any_of(other, [&](const SurfaceSample& theirs) {
      return (theirs.T_world_view.translation() - sample.T_world_view.translation()).norm() < kShared;
    }));
  return shared;
}

/// Begins of the stretches that lie wholly on a shared path.
std::vector<std::size_t> begins_on(const std::vector<bool>& shared) {
  std::vector<std::size_t> begins;
  for (std::size_t begin = 0; begin + kStretchSamples < shared.size(); begin += kStretchEvery) {
    const auto first = shared.begin() + static_cast<std::ptrdiff_t>(begin);
    if (std::all_of(first, first + kStretchSamples + 1, [](bool is_shared) { return is_shared; }))
      begins.push_back(begin);
  }
  return begins;
}

/// Metres that are covered by stretches which begin there.
double covered_m(const std::vector<std::size_t>& begins) {
  std::size_t covered = 0;
  std::size_t end = 0;
  for (const std::size_t begin : begins) {
    covered += begin + kStretchSamples - std::max(begin, end);
    end = begin + kStretchSamples;
  }
  return static_cast<double>(covered);
}

}  // namespace

DistinctiveMetres distinctive_stretches(const Raycaster& world, const std::vector<Trajectory>& truths) {
  const StretchSurfaces surfaces(world, truths);
  DistinctiveMetres metres(truths.size(), std::vector<double>(truths.size(), 0.0));
  const Phase phase("distinctive stretches", truths.size());
  for (std::size_t a = 0; a < truths.size(); ++a) {
    // Of each stretch of a's path; a char, since threads may not share the bits of a vector of bool.
    std::vector<std::vector<std::size_t>> begins(truths.size());
    std::vector<char> is_wanted(surfaces.path(a).size(), 0);
    for (std::size_t b = a + 1; b < truths.size(); ++b) {
      begins[b] = begins_on(shared_with(surfaces.path(a), surfaces.path(b)));
      for (const std::size_t begin : begins[b]) is_wanted[begin] = 1;
    }
    std::vector<char> is_distinctive(is_wanted.size(), 0);
    parallel_for_each(is_wanted.size(), [&](std::size_t begin) {
      if (is_wanted[begin] != 0) is_distinctive[begin] = surfaces.is_distinctive(a, begin) ? 1 : 0;
    });
    for (std::size_t b = a + 1; b < truths.size(); ++b) {
      std::erase_if(begins[b], [&](std::size_t begin) { return is_distinctive[begin] == 0; });
      metres[a][b] = metres[b][a] = covered_m(begins[b]);
    }
    phase.advance();
  }
  return metres;
}

}  // namespace adit
