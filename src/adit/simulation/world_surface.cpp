// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/world_surface.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <unordered_map>
#include <utility>

#include "adit/core/progress.hpp"
#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kSame = 2e-5;  ///< Metres: corners nearer than this are one vertex.

using Cell = Eigen::Matrix<std::int64_t, 3, 1>;
using Loop = std::vector<int>;
using Edge = std::pair<int, int>;

Cell cell_of(const Vector3& p, double size) {
  return (p / size).array().floor().matrix().cast<std::int64_t>();
}
std::uint64_t key_of(const Cell& c) {
  return mix64(mix64(static_cast<std::uint64_t>(c.x()), static_cast<std::uint64_t>(c.y())),
               static_cast<std::uint64_t>(c.z()));
}

/// Calls `visit(key)` for the cells that the box from `low` to `high` touches.
template <class Visit>
void for_cells(const Vector3& low, const Vector3& high, double size, const Visit& visit) {
  const Cell first = cell_of(low, size);
  const Cell last = cell_of(high, size);
  for (std::int64_t x = first.x(); x <= last.x(); ++x)
    for (std::int64_t y = first.y(); y <= last.y(); ++y)
      for (std::int64_t z = first.z(); z <= last.z(); ++z) visit(key_of(Cell(x, y, z)));
}

/// Points by cell of a grid. Cells are looked up only, never iterated over, so the order is that of
/// insertion.
class PointGrid {
 public:
  explicit PointGrid(double size) : size_(size) {}
  void add(const Vector3& p, int index) { cells_[key_of(cell_of(p, size_))].push_back(index); }
  template <class Visit>
  void visit(const Vector3& low, const Vector3& high, const Visit& visit_index) const {
    for_cells(low, high, size_, [&](std::uint64_t key) {
      const auto found = cells_.find(key);
      if (found != cells_.end())
        for (const int index : found->second) visit_index(index);
    });
  }

 private:
  double size_;
  std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

class VertexMerger {
 public:
  int index_of(const Vector3& p) {
    int found = -1;
    const Vector3 reach = Vector3::Constant(kSame);
    grid_.visit(p - reach, p + reach, [&](int i) {
      if (found < 0 && (points_[static_cast<std::size_t>(i)] - p).norm() < kSame) found = i;
    });
    if (found >= 0) return found;
    grid_.add(p, static_cast<int>(points_.size()));
    points_.push_back(p);
    return static_cast<int>(points_.size()) - 1;
  }
  std::vector<Vector3> take() { return std::move(points_); }

 private:
  PointGrid grid_{1e-2};
  std::vector<Vector3> points_;
};

std::vector<Loop> merged_loops(std::span<const Face> faces, std::vector<Vector3>& points) {
  VertexMerger merger;
  std::vector<Loop> loops;
  for (const Face& face : faces) {
    throw_if_cancelled();
    Loop loop;
    for (const Vector3& p : face.corners) {
      const int index = merger.index_of(p);
      if (std::ranges::find(loop, index) == loop.end()) loop.push_back(index);
    }
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
  points = merger.take();
  return loops;
}

/// Sorted directed edges that no loop runs through the other way.
std::vector<Edge> unmatched_edges(const std::vector<Loop>& loops) {
  std::vector<Edge> edges;
  for (const Loop& loop : loops)
    for (std::size_t i = 0; i < loop.size(); ++i) edges.emplace_back(loop[i], loop[(i + 1) % loop.size()]);
  std::ranges::sort(edges);
  std::vector<Edge> unmatched;
  for (const Edge& edge : edges)
    if (!std::ranges::binary_search(edges, Edge{edge.second, edge.first})) unmatched.push_back(edge);
  return unmatched;
}

/// The points of `grid` strictly between two ends, in order from the first end.
std::vector<int> points_between(const std::vector<Vector3>& points, const PointGrid& grid, const Edge& edge) {
  const Vector3& a = points[static_cast<std::size_t>(edge.first)];
  const Vector3& b = points[static_cast<std::size_t>(edge.second)];
  const double length = (b - a).norm();
  const Vector3 along = (b - a) / length;
  std::vector<std::pair<double, int>> between;
  const Vector3 reach = Vector3::Constant(2.0 * kSame);
  grid.visit(a.cwiseMin(b) - reach, a.cwiseMax(b) + reach, [&](int i) {
    const Vector3 d = points[static_cast<std::size_t>(i)] - a;
    const double s = d.dot(along);
    if (s > kSame && s < length - kSame && (d - s * along).norm() < 2.0 * kSame) between.emplace_back(s, i);
  });
  std::ranges::sort(between);
  std::vector<int> indices;
  for (const auto& [s, i] : between)
    if (indices.empty() || indices.back() != i) indices.push_back(i);
  return indices;
}

/// Cutting leaves corners of one face in the middle of an edge of its neighbour; here the neighbour takes
/// them over.
void close_t_junctions(const std::vector<Vector3>& points, std::vector<Loop>& loops) {
  const std::vector<Edge> open = unmatched_edges(loops);
  PointGrid grid(0.5);
  std::vector<int> ends;
  for (const Edge& edge : open) ends.insert(ends.end(), {edge.first, edge.second});
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  for (const int i : ends) grid.add(points[static_cast<std::size_t>(i)], i);

  for (Loop& loop : loops) {
    throw_if_cancelled();
    Loop full;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const Edge edge{loop[i], loop[(i + 1) % loop.size()]};
      full.push_back(edge.first);
      if (!std::ranges::binary_search(open, edge)) continue;
      for (const int between : points_between(points, grid, edge)) full.push_back(between);
    }
    loop = std::move(full);
  }
}

/// Loops of more than three corners, which may hold collinear ones, become a fan around their middle.
std::vector<Eigen::Vector3i> triangulated(const std::vector<Loop>& loops, std::vector<Vector3>& points) {
  std::vector<Eigen::Vector3i> triangles;
  for (const Loop& loop : loops) {
    if (loop.size() == 3) {
      triangles.emplace_back(loop[0], loop[1], loop[2]);
      continue;
    }
    Vector3 middle = Vector3::Zero();
    for (const int i : loop) middle += points[static_cast<std::size_t>(i)] / static_cast<double>(loop.size());
    const int centre = static_cast<int>(points.size());
    points.push_back(middle);
    for (std::size_t i = 0; i < loop.size(); ++i)
      triangles.emplace_back(loop[i], loop[(i + 1) % loop.size()], centre);
  }
  return triangles;
}

/// Halves every edge longer than wanted, each once per round, with the same midpoint for both of its
/// triangles.
class Refiner {
 public:
  Refiner(const Surfacing& surfacing, std::vector<Vector3>& points)
      : surfacing_(surfacing), points_(points) {}

  bool refine(std::vector<Eigen::Vector3i>& triangles) {
    midpoints_.clear();
    std::vector<Eigen::Vector3i> finer;
    finer.reserve(triangles.size());
    throw_if_cancelled();
    for (const Eigen::Vector3i& t : triangles) split(t, finer);
    triangles = std::move(finer);
    return !midpoints_.empty();
  }

 private:
  const Vector3& at(int i) const { return points_[static_cast<std::size_t>(i)]; }

  bool is_long(int a, int b) const {
    if (surfacing_.flat_floor && std::abs(at(a).z()) < kSame && std::abs(at(b).z()) < kSame) return false;
    return (at(a) - at(b)).squaredNorm() > surfacing_.max_edge * surfacing_.max_edge;
  }

  int midpoint(int a, int b) {
    const Edge edge = std::minmax(a, b);
    const auto [it, is_new] = midpoints_.try_emplace(
        (static_cast<std::uint64_t>(edge.first) << 32U) | static_cast<std::uint64_t>(edge.second),
        static_cast<int>(points_.size()));
    if (is_new) {
      const Vector3 middle = 0.5 * (at(edge.first) + at(edge.second));
      points_.push_back(middle);
    }
    return it->second;
  }

  void split(Eigen::Vector3i t, std::vector<Eigen::Vector3i>& out) {
    int num_long = 0;
    for (int k = 0; k < 3; ++k) num_long += is_long(t[k], t[(k + 1) % 3]) ? 1 : 0;
    if (num_long == 0) {
      out.push_back(t);
      return;
    }
    // Turn the triangle so that its first edge is long, and so is the second where there are two.
    while (!is_long(t[0], t[1]) || (num_long == 2 && !is_long(t[1], t[2]))) t = {t[1], t[2], t[0]};
    const int ab = midpoint(t[0], t[1]);
    if (num_long == 1) {
      out.insert(out.end(), {{t[0], ab, t[2]}, {ab, t[1], t[2]}});
      return;
    }
    const int bc = midpoint(t[1], t[2]);
    if (num_long == 2) {
      out.insert(out.end(), {{ab, t[1], bc}, {t[0], ab, bc}, {t[0], bc, t[2]}});
      return;
    }
    const int ca = midpoint(t[2], t[0]);
    out.insert(out.end(), {{t[0], ab, ca}, {ab, t[1], bc}, {ca, bc, t[2]}, {ab, bc, ca}});
  }

  const Surfacing& surfacing_;
  std::vector<Vector3>& points_;
  std::unordered_map<std::uint64_t, int> midpoints_;
};

}  // namespace

TriangleMesh surface_mesh(std::span<const Face> faces, const Surfacing& surfacing) {
  std::vector<Vector3> points;
  std::vector<Loop> loops = merged_loops(faces, points);
  close_t_junctions(points, loops);
  TriangleMesh mesh;
  mesh.triangles = triangulated(loops, points);
  Refiner refiner(surfacing, points);
  while (refiner.refine(mesh.triangles)) {
  }
  mesh.vertices.reserve(points.size());
  for (const Vector3& p : points) {
    throw_if_cancelled();
    mesh.vertices.emplace_back(surfacing.displaced(p).cast<float>());
  }
  return mesh;
}

}  // namespace adit
