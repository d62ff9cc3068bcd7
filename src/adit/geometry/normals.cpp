// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/normals.hpp"

#include <Eigen/Eigenvalues>

#include "adit/core/check.hpp"

namespace adit {
namespace {

/// Sums over the neighbours of one point, of their offsets from it: small numbers, so floats lose nothing
/// that matters.
struct Scatter {
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  Eigen::Matrix3f sum_of_squares = Eigen::Matrix3f::Zero();
  int num_neighbors = 0;

  void add(const Eigen::Vector3f& offset, const Eigen::Matrix3f& square) {
    sum += offset;
    sum_of_squares += square;
    ++num_neighbors;
  }
};

SurfacePoint surface_from(const Scatter& scatter, const Eigen::Vector3f& point) {
  constexpr int kMinNeighbors = 3;
  constexpr double kMinWidth = 1e-6;  // of l2 to l1: thinner is a line, whose normal is anything
  SurfacePoint out;
  if (scatter.num_neighbors < kMinNeighbors) return out;
  const double n = scatter.num_neighbors + 1.0;  // the point itself counts, at offset zero
  const Eigen::Vector3d mean = scatter.sum.cast<double>() / n;
  const Eigen::Matrix3d covariance = scatter.sum_of_squares.cast<double>() / n - mean * mean.transpose();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(covariance);
  const Eigen::Vector3d& l = solver.eigenvalues();  // ascending
  if (!(l[2] > 0.0) || !(l[1] > kMinWidth * l[2])) return out;
  out.normal = solver.eigenvectors().col(0).cast<float>().normalized();
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
  std::vector<Scatter> scatters(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const Neighbor& neighbor : pairs.row(i)) {
      if (neighbor.squared_distance > radius * radius) continue;
      const Eigen::Vector3f offset = points[neighbor.index] - points[i];
      const Eigen::Matrix3f square = offset * offset.transpose();
      scatters[i].add(offset, square);
      scatters[neighbor.index].add(-offset, square);
    }
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
