// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <limits>
#include <memory>
#include <utility>

#include "adit/core/result.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit {

/// World frame, metres; `direction` has unit length.
struct Ray {
  Eigen::Vector3f origin = Eigen::Vector3f::Zero();      ///< Where distances count from.
  Eigen::Vector3f direction = Eigen::Vector3f::UnitX();  ///< Where the ray goes.
};

/// Where a ray first meets the mesh.
struct RayHit {
  static constexpr float kMiss = std::numeric_limits<float>::infinity();  ///< More than any distance.
  float distance = kMiss;                            ///< Metres along the ray; `kMiss` when nothing is met.
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< Unit; the side follows the triangle's winding.

  /// Whether a surface was met.
  [[nodiscard]] bool hit() const { return distance < kMiss; }
};

/// Many rays and their hits, side by side: the fast form of casting.
struct RayBlock {
  static constexpr std::size_t kCapacity = 128;  ///< Most rays of a block.
  using Numbers = std::array<float, kCapacity>;  ///< One number per ray.
  /// One vector per ray, component by component.
  struct Vectors {
    /// Of each ray.
    ///@{
    Numbers x;
    Numbers y;
    Numbers z;
    ///@}
  };

  std::size_t size = 0;  ///< Entries in use of the arrays below.
  Vectors origins;       ///< World frame, metres.
  Vectors directions;    ///< World frame, of unit length.
  Numbers distances;     ///< As in RayHit. Casting fills in these and the cosines.
  Numbers cosines;       ///< Of the angle between the ray and the normal, 0 to 1; undefined for a miss.
};

/// What happens to a ray that runs exactly through an edge or a corner that triangles share.
enum class EdgeRule {
  fast,        ///< About one such ray in 1e5 slips through: harmless in a scan, fatal under a wheel.
  watertight,  ///< It is a hit. Slower to build and to cast at.
};

/// Casts rays against a triangle mesh (Embree behind it). Cheap to copy: copies share one acceleration
/// structure. All casting is const and may run on any number of threads at once.
///
/// A hit's distance and normal are computed from the triangle itself and not taken from Embree, whose kernels
/// round differently from processor to processor; so single rays, packets and all machines agree on them.
class Raycaster {
 public:
  /// Copies what it needs of `mesh`. Fails as `check_mesh` does: no triangles, an index out of range, a NaN.
  [[nodiscard]] static Result<Raycaster> build(const TriangleMesh& mesh, EdgeRule edges = EdgeRule::fast);

  /// The first surface, from either side, within `max_distance`.
  [[nodiscard]] RayHit cast(const Ray& ray, float max_distance) const;

  /// The same for many rays at once: fastest when neighbours in the block start and point alike.
  void cast(RayBlock& block, float max_distance) const;

  /// How far the nearest surface is from `point`, metres; `RayHit::kMiss` when none is within `max_distance`.
  [[nodiscard]] float distance(const Eigen::Vector3f& point, float max_distance = RayHit::kMiss) const;

 private:
  struct Scene;
  explicit Raycaster(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}
  std::shared_ptr<const Scene> scene_;
};

}  // namespace adit
