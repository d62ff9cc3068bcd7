// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_solids.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Ring = std::vector<Vector3>;

struct Section {
  Vector3 centre;
  Vector3 tangent;  ///< Normal of the mitre plane.
  Vector3 left;     ///< Lies in it, longer than one so that the swept facets run parallel to each segment.
};

std::vector<Section> mitre_sections(std::span<const Vector3> line) {
  std::vector<Section> sections;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const Vector3 after = (i + 1 < line.size() ? line[i + 1] - line[i] : line[i] - line[i - 1]).normalized();
    const Vector3 before = (i > 0 ? line[i] - line[i - 1] : line[1] - line[0]).normalized();
    const Vector3 tangent = (before + after).normalized();
    sections.push_back({line[i], tangent, Vector3::UnitZ().cross(tangent) / tangent.dot(after)});
  }
  return sections;
}

Ring ring_of(const Profile& profile, const Section& section) {
  Ring ring;
  for (const Eigen::Vector2d& p : profile)
    ring.emplace_back(section.centre + section.left * p.x() + Vector3::UnitZ() * p.y());
  return ring;
}

Vector3 mean_of(const Ring& ring) {
  Vector3 sum = Vector3::Zero();
  for (const Vector3& p : ring) sum += p;
  return sum / static_cast<double>(ring.size());
}

/// A face through `corners` that looks towards `inside`.
Face face_towards(std::vector<Vector3> corners, const Vector3& inside) {
  Vector3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  if (normal.dot(inside - corners[0]) < 0.0) {
    std::ranges::reverse(corners);
    normal = -normal;
  }
  return {std::move(corners), normal};
}

HalfSpace plane_behind(const Face& face) { return {-face.normal, -face.normal.dot(face.corners[0])}; }

void add_wall(Solid& solid, ConvexPiece& piece, Face face) {
  piece.planes.push_back(plane_behind(face));
  ++piece.num_walls;
  solid.faces.push_back(std::move(face));
}

ConvexPiece side_walls(Solid& solid, const Ring& from, const Ring& to) {
  const Vector3 inside = 0.5 * (mean_of(from) + mean_of(to));
  ConvexPiece piece;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const std::size_t next = (k + 1) % from.size();
    add_wall(solid, piece, face_towards({from[k], from[next], to[next], to[k]}, inside));
    piece.box.extend(from[k]).extend(to[k]);
  }
  return piece;
}

double depth_in(const ConvexPiece& piece, const Vector3& point) {
  double depth = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < piece.planes.size(); ++k) {
    const double distance = piece.planes[k].distance(point);
    if (k < piece.num_walls)
      depth = std::min(depth, -distance);
    else if (distance > 0.0)
      return -std::numeric_limits<double>::infinity();
  }
  return depth;
}

}  // namespace

Profile arch_profile(const Arch& arch) {
  const double half = 0.5 * arch.width;
  Profile profile{{-half, 0.0}, {half, 0.0}};
  for (int k = 0; k <= arch.num_facets; ++k) {
    const double angle = std::numbers::pi * k / arch.num_facets;
    profile.emplace_back(half * std::cos(angle),
                         arch.spring_height + (arch.height - arch.spring_height) * std::sin(angle));
  }
  return profile;
}

Profile box_profile(double width, double bottom, double top) {
  const double half = 0.5 * width;
  return {{-half, bottom}, {half, bottom}, {half, top}, {-half, top}};
}

Profile shifted(Profile profile, double left) {
  for (Eigen::Vector2d& p : profile) p.x() += left;
  return profile;
}

Solid sweep(const Profile& profile, std::span<const Vector3> line, Ends ends) {
  return sweep_part(profile, line, {0, line.size() - 1, ends, ends});
}

Solid sweep_part(const Profile& profile, std::span<const Vector3> line, const LinePart& part) {
  const auto [first, last, begin, end] = part;
  ADIT_CHECK(line.size() >= 2 && profile.size() >= 3, "a sweep needs a line and a profile");
  ADIT_CHECK(first < last && last < line.size(), "a part of a sweep lies within its line");
  const std::vector<Section> sections = mitre_sections(line);
  Solid solid;
  Ring from = ring_of(profile, sections[first]);
  for (std::size_t i = first; i < last; ++i) {
    const Ring to = ring_of(profile, sections[i + 1]);
    const Vector3 inside = 0.5 * (mean_of(from) + mean_of(to));
    ConvexPiece piece = side_walls(solid, from, to);
    const bool wall_before = i == first && begin == Ends::closed;
    const bool wall_after = i + 1 == last && end == Ends::closed;
    if (wall_before) add_wall(solid, piece, face_towards(from, inside));
    if (wall_after) add_wall(solid, piece, face_towards(to, inside));
    if (!wall_before)
      piece.planes.push_back({-sections[i].tangent, -sections[i].tangent.dot(sections[i].centre)});
    if (!wall_after)
      piece.planes.push_back({sections[i + 1].tangent, sections[i + 1].tangent.dot(sections[i + 1].centre)});
    solid.box.extend(piece.box);
    solid.pieces.push_back(std::move(piece));
    from = to;
  }
  return solid;
}

Solid upright_prism(std::span<const Eigen::Vector2d> corners, double height) {
  ADIT_CHECK(corners.size() >= 3 && height > 0.0, "a room needs three corners and a height");
  Ring floor;
  Ring roof;
  for (const Eigen::Vector2d& p : corners) {
    floor.emplace_back(p.x(), p.y(), 0.0);
    roof.emplace_back(p.x(), p.y(), height);
  }
  const Vector3 inside = 0.5 * (mean_of(floor) + mean_of(roof));
  Solid solid;
  ConvexPiece piece = side_walls(solid, floor, roof);
  add_wall(solid, piece, face_towards(floor, inside));
  add_wall(solid, piece, face_towards(roof, inside));
  solid.box = piece.box;
  solid.pieces.push_back(std::move(piece));
  return solid;
}

Solid box_between(const Vector3& from, const Vector3& to, const Profile& profile) {
  return sweep(profile, Polyline{from, to}, Ends::closed);
}

Solid turned_out(Solid solid) {
  for (Face& face : solid.faces) {
    std::ranges::reverse(face.corners);
    face.normal = -face.normal;
  }
  return solid;
}

double depth_inside(std::span<const Solid> spaces, const Vector3& point) {
  double depth = -std::numeric_limits<double>::infinity();
  for (const Solid& space : spaces) {
    if (!space.box.contains(point)) continue;
    for (const ConvexPiece& piece : space.pieces) depth = std::max(depth, depth_in(piece, point));
  }
  return depth;
}

double distance_to(std::span<const Solid> obstacles, const Vector3& point) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Solid& obstacle : obstacles)
    for (const ConvexPiece& piece : obstacle.pieces) {
      double distance = -std::numeric_limits<double>::infinity();
      for (const HalfSpace& plane : piece.planes) distance = std::max(distance, plane.distance(point));
      nearest = std::min(nearest, distance);
    }
  return nearest;
}

}  // namespace adit
