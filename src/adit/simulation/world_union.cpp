// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <utility>

#include "adit/core/parallel.hpp"
#include "adit/simulation/world_surface.hpp"

namespace adit {
namespace {

using Corners = std::vector<Vector3>;

constexpr double kOnPlane = 1e-9;   ///< Metres; coordinates of some 1e3 m round to 1e-13.
constexpr double kMinArea = 1e-10;  ///< Square metres; what is smaller only touches.

enum class Side { behind, ahead };

/// The part of a convex polygon on one side of a plane; corners on the plane belong to both sides.
Corners clipped(const Corners& corners, const HalfSpace& plane, Side side) {
  const double sign = side == Side::behind ? 1.0 : -1.0;
  Corners out;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3& a = corners[i];
    const Vector3& b = corners[(i + 1) % corners.size()];
    const double da = sign * plane.distance(a);
    const double db = sign * plane.distance(b);
    if (da <= kOnPlane) out.push_back(a);
    const bool crosses = (da < -kOnPlane && db > kOnPlane) || (da > kOnPlane && db < -kOnPlane);
    if (crosses) out.emplace_back(a + (b - a) * (da / (da - db)));
  }
  return out;
}

double area_of(const Corners& corners) {
  Vector3 sum = Vector3::Zero();
  for (std::size_t i = 2; i < corners.size(); ++i)
    sum += (corners[i - 1] - corners[0]).cross(corners[i] - corners[0]);
  return 0.5 * sum.norm();
}

bool lies_in(const Corners& corners, const HalfSpace& plane) {
  return std::ranges::all_of(corners,
                             [&](const Vector3& p) { return std::abs(plane.distance(p)) <= kOnPlane; });
}

enum class Coplanar { keep, drop };

/// Whether a face survives because it lies in the plane of a wall of `piece` (joints do not count). With
/// Coplanar::drop only a face that looks out of the piece does.
bool sheltered(const Face& face, const ConvexPiece& piece, Coplanar rule) {
  for (std::size_t k = 0; k < piece.num_walls; ++k)
    if (lies_in(face.corners, piece.planes[k]))
      return rule == Coplanar::keep || face.normal.dot(piece.planes[k].normal) > 0.0;
  return false;
}

bool meets(const Face& face, const ConvexPiece& piece) {
  Corners inside = face.corners;
  for (const HalfSpace& plane : piece.planes) {
    inside = clipped(inside, plane, Side::behind);
    if (inside.size() < 3) return false;
  }
  return area_of(inside) > kMinArea;
}

/// Appends the parts of `face` outside of `piece`, each convex.
void subtract(const Face& face, const ConvexPiece& piece, Coplanar rule, std::vector<Face>& out) {
  if (sheltered(face, piece, rule) || !meets(face, piece)) {
    out.push_back(face);
    return;
  }
  Corners rest = face.corners;
  for (const HalfSpace& plane : piece.planes) {
    Corners outside = clipped(rest, plane, Side::ahead);
    if (!lies_in(outside, plane) && area_of(outside) > kMinArea)
      out.push_back({std::move(outside), face.normal});
    rest = clipped(rest, plane, Side::behind);
  }
}

Eigen::AlignedBox3d box_of(const Face& face) {
  Eigen::AlignedBox3d box;
  for (const Vector3& p : face.corners) box.extend(p);
  return box;
}

/// `faces` without what lies in `other`.
std::vector<Face> outside_of(const Solid& other, Coplanar rule, std::vector<Face> faces) {
  for (const ConvexPiece& piece : other.pieces) {
    std::vector<Face> kept;
    for (const Face& face : faces)
      if (piece.box.intersects(box_of(face)))
        subtract(face, piece, rule, kept);
      else
        kept.push_back(face);
    faces = std::move(kept);
  }
  return faces;
}

std::vector<Face> visible_parts(const Face& face, std::size_t owner, std::span<const Solid> solids) {
  std::vector<Face> parts{face};
  const Eigen::AlignedBox3d box = box_of(face);
  for (std::size_t j = 0; j < solids.size() && !parts.empty(); ++j)
    if (j != owner && solids[j].box.intersects(box))
      parts = outside_of(solids[j], j < owner ? Coplanar::drop : Coplanar::keep, std::move(parts));
  return parts;
}

}  // namespace

std::vector<Face> boundary_of_union(std::span<const Solid> solids) {
  std::vector<std::pair<std::size_t, const Face*>> all;
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (const Face& face : solids[i].faces) all.emplace_back(i, &face);
  std::vector<std::vector<Face>> parts(all.size());
  parallel_for_each(
      all.size(), [&](std::size_t i) { parts[i] = visible_parts(*all[i].second, all[i].first, solids); },
      256);
  std::vector<Face> faces;
  for (std::vector<Face>& part : parts) std::ranges::move(part, std::back_inserter(faces));
  return faces;
}

}  // namespace adit
