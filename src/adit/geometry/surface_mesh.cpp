// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/surface_mesh.hpp"

#include <array>
#include <cstdint>
#include <optional>

#include "adit/core/check.hpp"
#include "adit/geometry/voxel_grid.hpp"

namespace adit {
namespace {

constexpr int kReach = 2;              // cells, from a point to the corners that it tells of
constexpr float kLeastWeight = 0.02F;  // of all points at a corner: less is the fringe of what was seen

/// Signed distances from the surface at the corners of cells, where points are near.
class DistanceField {
 public:
  explicit DistanceField(float cell) : cell_(cell) {}

  void add(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, VoxelKey home) {
    const Eigen::Vector3f in_cells = point / cell_;
    const Eigen::Array3i corner = home.indices().array();
    constexpr auto kFarthest = static_cast<float>(kReach * kReach);
    for (int z = 1 - kReach; z <= kReach; ++z)
      for (int y = 1 - kReach; y <= kReach; ++y)
        for (int x = 1 - kReach; x <= kReach; ++x) {
          const Eigen::Vector3f off = (corner + Eigen::Array3i(x, y, z)).cast<float>().matrix() - in_cells;
          const float near = 1.0F - off.squaredNorm() / kFarthest;
          if (near <= 0.0F) continue;
          Corner& sum = at(home.shifted(x, y, z));
          sum.weight += near * near;
          sum.distance += near * near * normal.dot(off);
        }
  }

  [[nodiscard]] std::size_t size() const { return corners_.size(); }
  [[nodiscard]] VoxelKey key(std::size_t number) const { return keys_[number]; }
  /// In cells, positive on the side of the normals; none where too little was seen.
  [[nodiscard]] std::optional<float> distance(VoxelKey key) const {
    const auto number = table_.find(key);
    if (!number || corners_[*number].weight < kLeastWeight) return {};
    return corners_[*number].distance / corners_[*number].weight;
  }

 private:
  struct Corner {
    float weight = 0.0F;
    float distance = 0.0F;
  };

  Corner& at(VoxelKey key) {
    const auto known = table_.find_or_insert(key, static_cast<std::uint32_t>(corners_.size()));
    if (known) return corners_[*known];
    keys_.push_back(key);
    return corners_.emplace_back();
  }

  float cell_;
  VoxelTable table_;
  std::vector<VoxelKey> keys_;
  std::vector<Corner> corners_;
};

/// The mean of where the surface crosses the edges of the cell whose lowest corner is `key`, in cells from
/// that corner; none where a corner is unknown or all are on one side.
std::optional<Eigen::Vector3f> crossing(const DistanceField& field, VoxelKey key) {
  std::array<float, 8> distances{};  // x fastest
  bool is_one_inside = false;
  bool is_one_outside = false;
  for (std::size_t i = 0; i < 8; ++i) {
    const auto distance = field.distance(
        key.shifted(static_cast<int>(i & 1U), static_cast<int>(i >> 1U & 1U), static_cast<int>(i >> 2U)));
    if (!distance) return {};
    distances[i] = *distance;
    (*distance < 0.0F ? is_one_inside : is_one_outside) = true;
  }
  if (!is_one_inside || !is_one_outside) return {};
  Eigen::Vector3f sum = Eigen::Vector3f::Zero();
  float num = 0.0F;
  for (std::size_t i = 0; i < 8; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t j = i | std::size_t{1} << axis;
      if (i == j || (distances[i] < 0.0F) == (distances[j] < 0.0F)) continue;
      Eigen::Vector3f at(static_cast<float>(i & 1U), static_cast<float>(i >> 1U & 1U),
                         static_cast<float>(i >> 2U));
      at[static_cast<Eigen::Index>(axis)] = distances[i] / (distances[i] - distances[j]);
      sum += at;
      num += 1.0F;
    }
  return Eigen::Vector3f(sum / num);
}

VoxelKey shifted_along(VoxelKey key, std::size_t axis, int by) {
  std::array<int, 3> shift{};
  shift[axis] = by;
  return key.shifted(shift[0], shift[1], shift[2]);
}

/// Two triangles, split along the shorter diagonal.
void add_quad(const std::array<int, 4>& corners, TriangleMesh& mesh) {
  const auto length = [&](std::size_t a, std::size_t b) {
    return (mesh.vertices[static_cast<std::size_t>(corners[a])] -
            mesh.vertices[static_cast<std::size_t>(corners[b])])
        .squaredNorm();
  };
  const std::size_t first = length(0, 2) <= length(1, 3) ? 0 : 1;
  for (const std::size_t i : {std::size_t{1}, std::size_t{2}})
    mesh.triangles.emplace_back(corners[first], corners[first + i], corners[(first + i + 1) % 4]);
}

}  // namespace

TriangleMesh surface_mesh(const std::vector<Eigen::Vector3f>& points,
                          const std::vector<Eigen::Vector3f>& normals, double cell_m) {
  ADIT_CHECK(points.size() == normals.size(), "one normal per point");
  const VoxelGrid grid(cell_m);
  DistanceField field(grid.voxel_size());
  for (std::size_t i = 0; i < points.size(); ++i)
    if (const auto home = grid.key_of(points[i]); home && !normals[i].isZero())
      field.add(points[i], normals[i], *home);

  TriangleMesh mesh;
  VoxelTable vertices;  // by the lowest corner of their cell
  for (std::size_t i = 0; i < field.size(); ++i) {
    const VoxelKey key = field.key(i);
    const auto inside = crossing(field, key);
    if (!inside) continue;
    vertices.find_or_insert(key, static_cast<std::uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back((key.indices().cast<float>() + *inside) * grid.voxel_size());
  }
  // The four cells around an edge that the surface crosses have a vertex each; seen against the edge's axis
  // they go round anticlockwise.
  for (std::size_t i = 0; i < field.size(); ++i) {
    const VoxelKey key = field.key(i);
    const auto here = field.distance(key);
    for (std::size_t axis = 0; here && axis < 3; ++axis) {
      const auto there = field.distance(shifted_along(key, axis, 1));
      if (!there || (*here < 0.0F) == (*there < 0.0F)) continue;
      const std::size_t b = (axis + 1) % 3;
      const std::size_t d = (axis + 2) % 3;
      const VoxelKey before = shifted_along(key, b, -1);
      const std::array<std::optional<std::uint32_t>, 4> around = {vertices.find(shifted_along(before, d, -1)),
                                                                  vertices.find(shifted_along(key, d, -1)),
                                                                  vertices.find(key), vertices.find(before)};
      std::array<int, 4> corners{};
      bool is_whole = true;
      for (std::size_t k = 0; k < 4; ++k) {
        is_whole = is_whole && around[k].has_value();
        corners[*here < 0.0F ? k : 3 - k] = static_cast<int>(around[k].value_or(0));
      }
      if (is_whole) add_quad(corners, mesh);
    }
  }
  return mesh;
}

}  // namespace adit
