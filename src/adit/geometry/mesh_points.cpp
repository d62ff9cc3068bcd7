// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/mesh_points.hpp"

#include <cmath>

#include "adit/core/check.hpp"
#include "adit/core/rng.hpp"

namespace adit {

std::vector<MeshPoint> mesh_points(const TriangleMesh& mesh, double spacing) {
  ADIT_CHECK(spacing > 0.0, "samples have a distance");
  std::vector<MeshPoint> samples;
  Rng rng(mesh.triangles.size());
  double area =
      0.5;  // in units of what a sample stands for; the next one falls where it reaches a whole number
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) -> Vector3 {
      return mesh.vertices[static_cast<std::size_t>(t[i])].cast<double>();
    };
    const Vector3 a = corner(0);
    const Vector3 normal = (corner(1) - a).cross(corner(2) - a);
    area += 0.5 * normal.norm() / (spacing * spacing);
    for (; area >= 1.0; area -= 1.0) {
      const double edge = std::sqrt(rng.uniform());
      const double along = rng.uniform();
      samples.push_back(
          {a + edge * ((1.0 - along) * (corner(1) - a) + along * (corner(2) - a)), normal.normalized()});
    }
  }
  return samples;
}

}  // namespace adit
