// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/wall_lines.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "adit/core/rng.hpp"
#include "adit/simulation/things.hpp"

namespace adit {
namespace {

constexpr double kPieceLength = 1.0;           ///< Metres along the path: length of one straight piece.
constexpr std::size_t kPiecesPerStretch = 40;  ///< Pieces.
constexpr double kFarthestHung = 12.0;

struct WallLine {
  double height;
  double radius;
};
constexpr std::array<WallLine, 3> kWallLines{{{1.8, 0.08}, {2.2, 0.025}, {2.35, 0.025}}};

/// Where the line hangs beside a pose.
std::optional<Vector3> hung_at(const Raycaster& floor, const Pose& pose, double side, const WallLine& line) {
  const double off_wall = line.radius + 0.05;
  const RayHit wall = wall_beside(floor, pose, side, line.height, kFarthestHung);
  const double off = static_cast<double>(wall.distance) - off_wall;
  if (!wall.hit() || off < kPassingRoom) return {};
  return pose.translation() + Vector3(0.0, 0.0, line.height) + off * direction_beside(pose, side);
}

TriangleMesh piece(const Vector3& from, const Vector3& to, double radius) {
  const Vector3 along = (to - from).normalized();
  const Vector3 across = Vector3::UnitZ().cross(along).normalized();
  Matrix3 R;
  R << along, across, along.cross(across);
  return box(Pose(R, from), {0.0, -radius, -radius}, {(to - from).norm(), radius, radius});
}

bool is_near(const std::vector<Pose>& path, const Vector3& p, double distance) {
  return std::ranges::any_of(
      path, [&](const Pose& pose) { return (pose.translation() - p).squaredNorm() < distance * distance; });
}

/// From pose to pose, where the wall goes on.
TriangleMesh line_along(const Raycaster& floor, std::span<const Pose> poses, double side,
                        const WallLine& line) {
  TriangleMesh mesh;
  std::optional<Vector3> before;
  for (const Pose& pose : poses) {
    const std::optional<Vector3> here = hung_at(floor, pose, side, line);
    if (before && here && (*here - *before).norm() < 1.5 * kPieceLength)
      append(mesh, piece(*before, *here, line.radius));
    before = here;
  }
  return mesh;
}

}  // namespace

TriangleMesh wall_lines(const Raycaster& floor, std::span<const Trajectory> paths, double share,
                        std::uint64_t seed) {
  TriangleMesh mesh;
  if (share == 0.0) return mesh;
  Rng rng(seed);
  std::vector<Pose> passed;
  for (const Trajectory& path : paths) {
    std::vector<Pose> poses = poses_along(path, kPieceLength);
    std::erase_if(poses, [&](const Pose& pose) { return is_near(passed, pose.translation(), kSameTunnel); });
    for (std::size_t begin = 0; begin < poses.size(); begin += kPiecesPerStretch) {
      const std::span<const Pose> stretch =
          std::span(poses).subspan(begin, std::min(kPiecesPerStretch, poses.size() - begin));
      const bool is_laid = rng.uniform() < share;
      const double side = rng.uniform() < 0.5 ? 1.0 : -1.0;
      for (const WallLine& line : kWallLines)
        if (is_laid) append(mesh, line_along(floor, stretch, side, line));
    }
    passed.insert(passed.end(), poses.begin(), poses.end());
  }
  return mesh;
}

}  // namespace adit
