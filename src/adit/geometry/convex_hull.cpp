// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/convex_hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "adit/core/check.hpp"

namespace adit {
namespace {

using Index = std::uint32_t;
using Wide = __int128;
using Point = Eigen::Vector3d;  // Whole numbers of at most 2^24, so differences have 25 bits and cross
                                // products 51: exact.

constexpr Index kNone = ~Index{0};
constexpr double kGrid = 0x1p24;

/// The finite points on the integer grid; `source[i]` is where point i stands in the cloud.
struct GridCloud {
  std::vector<Point> points;
  std::vector<Index> source;
};

GridCloud on_grid(std::span<const Eigen::Vector3f> cloud) {
  float largest = 0.0F;
  for (const Eigen::Vector3f& p : cloud) {
    if (p.allFinite()) largest = std::max(largest, p.cwiseAbs().maxCoeff());
  }
  int exponent = 0;
  std::frexp(largest, &exponent);  // largest < 2^exponent; a power of two scales without rounding.
  const double scale = std::ldexp(kGrid, -exponent);
  GridCloud grid;
  grid.points.reserve(cloud.size());
  grid.source.reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud[i].allFinite()) continue;
    grid.points.push_back((cloud[i].cast<double>() * scale).array().round());
    grid.source.push_back(static_cast<Index>(i));
  }
  return grid;
}

Point normal_of(const Point& a, const Point& b, const Point& c) { return (b - a).cross(c - a); }

Wide whole(double value) { return static_cast<Wide>(static_cast<std::int64_t>(value)); }

/// normal . (p - a), whose sign tells the side of the plane. In double its error stays below 2^27 (three
/// products of 2^76, each rounded once, and two sums); only nearer to the plane than that the whole numbers
/// decide.
double side(const Point& normal, const Point& a, const Point& p) {
  const Point d = p - a;
  const double rounded = normal.x() * d.x() + normal.y() * d.y() + normal.z() * d.z();
  if (std::abs(rounded) > 0x1p27) return rounded;
  return static_cast<double>(whole(normal.x()) * whole(d.x()) + whole(normal.y()) * whole(d.y()) +
                             whole(normal.z()) * whole(d.z()));
}

bool parallel(const Point& a, const Point& b) {
  const auto equal_products = [&](int i, int j) {
    return whole(a[i]) * whole(b[j]) == whole(a[j]) * whole(b[i]);
  };
  return equal_products(0, 1) && equal_products(1, 2) && equal_products(2, 0);
}

template <class Measure>
Index index_of_greatest(const std::vector<Point>& points, const Measure& measure) {
  Index best = 0;
  double greatest = measure(points[0]);
  for (Index i = 1; i < points.size(); ++i) {
    if (const double value = measure(points[i]); value > greatest) {
      greatest = value;
      best = i;
    }
  }
  return best;
}

/// Four points that span what the cloud spans: far apart, so that most points fall inside at once. Entries
/// beyond the dimension are kNone.
std::array<Index, 4> spanning_simplex(const std::vector<Point>& points) {
  std::array<Index, 4> simplex = {kNone, kNone, kNone, kNone};
  // The least in dictionary order, and the farthest from it, are extreme points: of a line its two ends.
  const auto least =
      std::ranges::min_element(points, {}, [](const Point& p) { return std::tuple(p.x(), p.y(), p.z()); });
  simplex[0] = static_cast<Index>(least - points.begin());
  const Point& first = *least;
  const Index second = index_of_greatest(points, [&](const Point& p) { return (p - first).squaredNorm(); });
  if (points[second] == first) return simplex;
  simplex[1] = second;
  const auto off_line = [&](const Point& p) { return normal_of(first, points[second], p).squaredNorm(); };
  const Index third = index_of_greatest(points, off_line);
  const Point normal = normal_of(first, points[second], points[third]);
  if (normal.isZero(0.0)) return simplex;
  simplex[2] = third;
  const Index fourth =
      index_of_greatest(points, [&](const Point& p) { return std::abs(side(normal, first, p)); });
  if (side(normal, first, points[fourth]) != 0.0) simplex[3] = fourth;
  return simplex;
}

/// The extreme points of a planar cloud: Andrew's monotone chain on the coordinate plane it is least tilted
/// to.
std::vector<Index> planar_vertices(const std::vector<Point>& points, const Point& normal) {
  int drop = 0;
  normal.cwiseAbs().maxCoeff(&drop);
  const int u = (drop + 1) % 3;
  const int v = (drop + 2) % 3;
  std::vector<Index> order(points.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::ranges::sort(order, {}, [&](Index i) { return std::tuple(points[i][u], points[i][v], i); });
  const auto turns_left = [&](Index a, Index b, Index c) {
    const Point ab = points[b] - points[a];
    const Point ac = points[c] - points[a];
    return ab[u] * ac[v] - ab[v] * ac[u] > 0.0;
  };
  std::vector<Index> chain;
  const auto sweep = [&](const auto& range) {
    const std::size_t start = chain.size();
    for (const Index i : range) {
      while (chain.size() >= start + 2 && !turns_left(chain[chain.size() - 2], chain.back(), i))
        chain.pop_back();
      chain.push_back(i);
    }
    chain.pop_back();  // The last of one sweep is the first of the other.
  };
  sweep(order);
  std::ranges::reverse(order);
  sweep(order);
  return chain;
}

/// A triangle of the growing hull with the points outside that it is charged with.
struct Face {
  std::array<Index, 3> corners;
  std::array<Index, 3> neighbors = {kNone, kNone, kNone};  ///< Across the edge from corner i to corner i + 1.
  Point normal;                                            ///< Outward, not of unit length.
  std::vector<Index> outside;
  Index farthest = kNone;  ///< Of `outside`.
  double farthest_side = 0.0;
  bool alive = true;
};

class QuickHull {
 public:
  QuickHull(const std::vector<Point>& points, const std::array<Index, 4>& simplex) : points_(points) {
    start(simplex);
    for (Index face = 0; face < faces_.size(); ++face) {  // Grows while it runs: new faces go to the end.
      if (faces_[face].alive && !faces_[face].outside.empty()) add_point(face);
    }
  }

  [[nodiscard]] std::vector<std::array<Index, 3>> triangles() const {
    std::vector<std::array<Index, 3>> triangles;
    for (const Face& face : faces_) {
      if (face.alive) triangles.push_back(face.corners);
    }
    return triangles;
  }

 private:
  struct HorizonEdge {
    Index from, to;
    Index beyond;      ///< The face behind the edge, which stays.
    std::size_t side;  ///< Which of its edges this is.
  };

  Index add_face(const std::array<Index, 3>& corners) {
    Face face;
    face.corners = corners;
    face.normal = normal_of(points_[corners[0]], points_[corners[1]], points_[corners[2]]);
    faces_.push_back(std::move(face));
    return static_cast<Index>(faces_.size() - 1);
  }

  [[nodiscard]] double side_of(const Face& face, Index p) const {
    return side(face.normal, points_[face.corners[0]], points_[p]);
  }

  /// Charges p to the first face from `first` on that it lies outside of; a point outside of none is inside
  /// the hull.
  void charge(Index p, std::size_t first) {
    for (std::size_t f = first; f < faces_.size(); ++f) {
      Face& face = faces_[f];
      const double distance = side_of(face, p);
      if (distance <= 0.0) continue;
      face.outside.push_back(p);
      if (distance > face.farthest_side) {
        face.farthest_side = distance;
        face.farthest = p;
      }
      return;
    }
  }

  void start(std::array<Index, 4> s) {
    if (side(normal_of(points_[s[0]], points_[s[1]], points_[s[2]]), points_[s[0]], points_[s[3]]) > 0.0) {
      std::swap(s[1], s[2]);
    }
    for (const auto& corners : {std::array{s[0], s[1], s[2]}, std::array{s[0], s[3], s[1]},
                                std::array{s[1], s[3], s[2]}, std::array{s[2], s[3], s[0]}}) {
      add_face(corners);
    }
    faces_[0].neighbors = {1, 2, 3};
    faces_[1].neighbors = {3, 2, 0};
    faces_[2].neighbors = {1, 3, 0};
    faces_[3].neighbors = {2, 1, 0};
    for (Index p = 0; p < points_.size(); ++p) charge(p, 0);
  }

  /// Removes the faces that `p` sees, from `seed` on, and returns the edges around them. With exact sides
  /// those faces are connected and their border is one simple loop.
  std::vector<HorizonEdge> open_hull(Index p, Index seed, std::vector<Index>& orphans) {
    std::vector<HorizonEdge> horizon;
    std::vector<Index> visible = {seed};
    faces_[seed].alive = false;
    for (std::size_t next = 0; next < visible.size(); ++next) {
      const Index current = visible[next];
      for (std::size_t i = 0; i < 3; ++i) {
        const Index beyond = faces_[current].neighbors[i];
        Face& neighbor = faces_[beyond];
        if (!neighbor.alive) continue;
        if (side_of(neighbor, p) > 0.0) {
          neighbor.alive = false;
          visible.push_back(beyond);
          continue;
        }
        const auto back = std::ranges::find(neighbor.neighbors, current) - neighbor.neighbors.begin();
        horizon.push_back({faces_[current].corners[i], faces_[current].corners[(i + 1) % 3], beyond,
                           static_cast<std::size_t>(back)});
      }
      std::vector<Index> outside = std::exchange(faces_[current].outside, {});
      orphans.insert(orphans.end(), outside.begin(), outside.end());
    }
    return horizon;
  }

  void add_point(Index seed) {
    const Index p = faces_[seed].farthest;
    std::vector<Index> orphans;
    std::vector<HorizonEdge> horizon = open_hull(p, seed, orphans);
    std::ranges::sort(horizon, {}, &HorizonEdge::from);
    const std::size_t first = faces_.size();
    for (const HorizonEdge& edge : horizon) {
      const Index face = add_face({edge.from, edge.to, p});
      faces_[face].neighbors[0] = edge.beyond;
      faces_[edge.beyond].neighbors[edge.side] = face;
    }
    for (std::size_t i = 0; i < horizon.size(); ++i) {
      const auto next = std::ranges::lower_bound(horizon, horizon[i].to, {}, &HorizonEdge::from);
      ADIT_CHECK(next != horizon.end() && next->from == horizon[i].to,
                 "the horizon of a hull is a closed loop");
      const std::size_t follower = first + static_cast<std::size_t>(next - horizon.begin());
      faces_[first + i].neighbors[1] = static_cast<Index>(follower);
      faces_[follower].neighbors[2] = static_cast<Index>(first + i);
    }
    for (const Index orphan : orphans) {
      if (orphan != p) charge(orphan, first);
    }
  }

  const std::vector<Point>& points_;
  std::vector<Face> faces_;
};

/// Corners where at least three different planes meet; others lie inside a flat face or on an edge.
std::vector<Index> extreme_corners(const std::vector<Point>& points,
                                   const std::vector<std::array<Index, 3>>& triangles) {
  std::vector<std::pair<Index, Point>> planes;
  for (const auto& [a, b, c] : triangles) {
    const Point normal = normal_of(points[a], points[b], points[c]);
    for (const Index corner : {a, b, c}) planes.emplace_back(corner, normal);
  }
  std::ranges::stable_sort(planes, {}, &std::pair<Index, Point>::first);
  std::vector<Index> extreme;
  for (std::size_t begin = 0, end = 0; begin < planes.size(); begin = end) {
    std::vector<Point> distinct;
    for (; end < planes.size() && planes[end].first == planes[begin].first; ++end) {
      const Point& normal = planes[end].second;
      if (std::ranges::none_of(distinct, [&](const Point& n) { return parallel(n, normal); }))
        distinct.push_back(normal);
    }
    if (distinct.size() >= 3) extreme.push_back(planes[begin].first);
  }
  return extreme;
}

}  // namespace

ConvexHull convex_hull(std::span<const Eigen::Vector3f> cloud) {
  const GridCloud grid = on_grid(cloud);
  ConvexHull hull;
  if (grid.points.empty()) return hull;
  const std::array<Index, 4> simplex = spanning_simplex(grid.points);
  if (simplex[1] == kNone) {
    hull.shape = HullShape::point;
    hull.vertices = {simplex[0]};
  } else if (simplex[2] == kNone) {
    hull.shape = HullShape::segment;
    hull.vertices = {simplex[0], simplex[1]};
  } else if (simplex[3] == kNone) {
    hull.shape = HullShape::planar;
    const auto& p = grid.points;
    hull.vertices = planar_vertices(p, normal_of(p[simplex[0]], p[simplex[1]], p[simplex[2]]));
  } else {
    hull.shape = HullShape::solid;
    hull.triangles = QuickHull(grid.points, simplex).triangles();
    hull.vertices = extreme_corners(grid.points, hull.triangles);
  }
  for (Index& vertex : hull.vertices) vertex = grid.source[vertex];
  std::ranges::sort(hull.vertices);
  for (auto& triangle : hull.triangles) {
    for (Index& corner : triangle) corner = grid.source[corner];
  }
  return hull;
}

double volume(const ConvexHull& hull, std::span<const Eigen::Vector3f> points) {
  if (hull.shape != HullShape::solid) return 0.0;
  const Point apex = points[hull.triangles.front()[0]].cast<double>();
  double six_volumes = 0.0;
  for (const auto& [a, b, c] : hull.triangles) {
    const Point pa = points[a].cast<double>() - apex;
    six_volumes += pa.cross(points[b].cast<double>() - apex).dot(points[c].cast<double>() - apex);
  }
  return six_volumes / 6.0;
}

}  // namespace adit
