// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/normals.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <span>
#include <tuple>

#include "adit/core/check.hpp"
#include "adit/core/simd.hpp"

namespace adit {
namespace {

using simd::Float4;

/// Sums over the neighbours of one point, of their offsets from it: small numbers, so floats lose nothing
/// that matters.
struct Scatter {
  Float4 sum = {};       ///< x, y, z; number of neighbours.
  Float4 squares = {};   ///< xx, yy, zz.
  Float4 products = {};  ///< xy, yz, zx.
};

/// The unit vector that a symmetric matrix of rank 2 maps to zero: the longest cross product of two rows.
Eigen::Vector3d kernel_of(const Eigen::Matrix3d& m) {
  Eigen::Vector3d longest = m.col(0).cross(m.col(1));
  for (const Eigen::Vector3d& other :
       {Eigen::Vector3d(m.col(1).cross(m.col(2))), Eigen::Vector3d(m.col(2).cross(m.col(0)))}) {
    if (other.squaredNorm() > longest.squaredNorm()) longest = other;
  }
  return longest.normalized();
}

SurfacePoint surface_from(const Scatter& scatter, const Eigen::Vector3f& point) {
  constexpr float kMinNeighbors = 3.0F;
  constexpr double kMinWidth = 1e-6;  // of l2 to l1: thinner is a line, whose normal is anything
  SurfacePoint out;
  if (scatter.sum[3] < kMinNeighbors) return out;
  const double n = static_cast<double>(scatter.sum[3]) + 1.0;  // the point itself counts, at offset zero
  const Eigen::Vector3d mean =
      Eigen::Vector3f(scatter.sum[0], scatter.sum[1], scatter.sum[2]).cast<double>() / n;
  const auto& [xx, yy, zz] = std::tuple(scatter.squares[0], scatter.squares[1], scatter.squares[2]);
  const auto& [xy, yz, zx] = std::tuple(scatter.products[0], scatter.products[1], scatter.products[2]);
  Eigen::Matrix3f squares;
  squares << xx, xy, zx, xy, yy, yz, zx, yz, zz;
  const Eigen::Matrix3d covariance = squares.cast<double>() / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
  const Eigen::Vector3d& l = solver.eigenvalues();  // ascending
  if (!(l[2] > 0.0) || !(l[1] > kMinWidth * l[2])) return out;
  out.normal = kernel_of(covariance - l[0] * Eigen::Matrix3d::Identity()).cast<float>();
  if (out.normal.dot(point) > 0.0F) out.normal = -out.normal;
  out.linearity = static_cast<float>((l[2] - l[1]) / l[2]);
  out.planarity = static_cast<float>((l[1] - l[0]) / l[2]);
  out.valid = out.normal.allFinite();
  return out;
}

}  // namespace

std::vector<SurfacePoint> estimate_surface(const std::vector<Eigen::Vector3f>& points,
                                           const NeighborPairs& pairs, float radius) {
  ADIT_CHECK(pairs.num_points() == points.size(), "the pairs belong to these points");
  std::vector<Float4> padded;
  padded.reserve(points.size());
  for (const Eigen::Vector3f& p : points) padded.push_back(Float4{p.x(), p.y(), p.z(), 0.0F});
  std::vector<Scatter> scatters(points.size());
  std::vector<std::uint32_t> near;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::span<const Neighbor> row = pairs.row(i);
    // written whether near or not, because no processor can guess which are
    near.resize(std::max(near.size(), row.size()));
    std::size_t num_near = 0;
    for (const Neighbor& neighbor : row) {
      near[num_near] = neighbor.index;
      num_near += neighbor.squared_distance <= radius * radius ? 1 : 0;
    }
    Scatter own = scatters[i];
    for (std::size_t k = 0; k < num_near; ++k) {
      Scatter& other = scatters[near[k]];
      const Float4 offset = padded[near[k]] - padded[i];
      const Float4 squares = offset * offset;
      const Float4 products = offset * Float4{offset[1], offset[2], offset[0], 0.0F};
      constexpr Float4 kOne = {0.0F, 0.0F, 0.0F, 1.0F};
      own.sum += offset + kOne;
      own.squares += squares;
      own.products += products;
      other.sum -= offset - kOne;
      other.squares += squares;
      other.products += products;
    }
    scatters[i] = own;
  }
  std::vector<SurfacePoint> out;
  out.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back(surface_from(scatters[i], points[i]));
  return out;
}

std::vector<Eigen::Vector3f> estimate_normals(const std::vector<Eigen::Vector3f>& points, float radius) {
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(points.size());
  for (const SurfacePoint& s : estimate_surface(points, find_pairs_within(points, radius), radius)) {
    normals.push_back(s.normal);
  }
  return normals;
}

}  // namespace adit
