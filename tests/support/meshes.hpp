// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Small meshes with known answers.
#pragma once

#include <functional>

#include "adit/core/pose.hpp"
#include "adit/core/rng.hpp"
#include "adit/geometry/triangle_mesh.hpp"

namespace adit::test {

inline void add_quad(TriangleMesh& mesh, const Vector3& a, const Vector3& b, const Vector3& c,
                     const Vector3& d) {
  const auto first = static_cast<int>(mesh.vertices.size());
  for (const Vector3& corner : {a, b, c, d}) mesh.vertices.push_back(corner.cast<float>());
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first, first + 2, first + 3);
}

/// The six sides of an axis-aligned room, facing inwards.
inline TriangleMesh room(const Vector3& low, const Vector3& high) {
  const auto at = [&](bool x, bool y, bool z) {
    return Vector3(x ? high.x() : low.x(), y ? high.y() : low.y(), z ? high.z() : low.z());
  };
  TriangleMesh mesh;
  add_quad(mesh, at(false, false, false), at(true, false, false), at(true, true, false),
           at(false, true, false));
  add_quad(mesh, at(false, false, true), at(false, true, true), at(true, true, true), at(true, false, true));
  add_quad(mesh, at(false, false, false), at(false, true, false), at(false, true, true),
           at(false, false, true));
  add_quad(mesh, at(true, false, false), at(true, false, true), at(true, true, true), at(true, true, false));
  add_quad(mesh, at(false, false, false), at(false, false, true), at(true, false, true),
           at(true, false, false));
  add_quad(mesh, at(false, true, false), at(true, true, false), at(true, true, true), at(false, true, true));
  return mesh;
}

/// A floor z = height(x, y) over [x0, x1] x [y0, y1], in cells of `step`.
inline TriangleMesh floor_of(const Eigen::AlignedBox2d& area, double step,
                             const std::function<double(double, double)>& height) {
  TriangleMesh mesh;
  const auto corner = [&](double x, double y) { return Vector3(x, y, height(x, y)); };
  for (double x = area.min().x(); x < area.max().x() - 0.5 * step; x += step) {
    for (double y = area.min().y(); y < area.max().y() - 0.5 * step; y += step) {
      add_quad(mesh, corner(x, y), corner(x + step, y), corner(x + step, y + step), corner(x, y + step));
    }
  }
  return mesh;
}

inline Vector3 random_vector(Rng& rng, double size) {
  const double x = rng.uniform(-size, size);
  const double y = rng.uniform(-size, size);
  return {x, y, rng.uniform(-size, size)};
}

}  // namespace adit::test
