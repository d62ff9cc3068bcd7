// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/convex_hull.hpp"

extern "C" {
#include <libqhull_r/libqhull_r.h>
}

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "adit/core/format.hpp"

namespace adit {
namespace {

using Index = std::uint32_t;
using Point = Eigen::Vector3d;

// A cloud this thin, as a share of its largest coordinate, is flat: four roundings of a float.
constexpr double kFlat = 0x1p-22;

struct FiniteCloud {
  std::vector<Point> points;
  std::vector<Index> source;  // where point i stands in the cloud
  double largest = 0.0;       // coordinate, without its sign
};

FiniteCloud finite_points(std::span<const Eigen::Vector3f> cloud) {
  FiniteCloud out;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!cloud[i].allFinite()) continue;
    out.points.emplace_back(cloud[i].cast<double>());
    out.source.push_back(static_cast<Index>(i));
    out.largest = std::max(out.largest, out.points.back().cwiseAbs().maxCoeff());
  }
  return out;
}

/// Where a cloud lies: it spans the first `dimension` of the orthonormal `axes` from `origin`.
struct Frame {
  Point origin;
  Eigen::Matrix3d axes;  // as columns
  int dimension;

  [[nodiscard]] Point of(const Point& p) const { return axes.transpose() * (p - origin); }
};

/// Each axis points to the point that is farthest from the origin, then from the line and the plane found
/// before.
Frame frame_of(const FiniteCloud& cloud) {
  Frame frame{cloud.points.front(), Eigen::Matrix3d::Zero(), 0};
  for (; frame.dimension < 3; ++frame.dimension) {
    const Eigen::Matrix3d beside = Eigen::Matrix3d::Identity() - frame.axes * frame.axes.transpose();
    Point farthest = Point::Zero();
    for (const Point& p : cloud.points) {
      const Point off = beside * (p - frame.origin);
      if (off.squaredNorm() > farthest.squaredNorm()) farthest = off;
    }
    if (farthest.norm() <= kFlat * cloud.largest) break;
    frame.axes.col(frame.dimension) = farthest.normalized();
  }
  return frame;
}

/// One run of Qhull with what it allocates. Its messages go to a stream in memory.
class QhullRun {
 public:
  QhullRun() : log_(open_memstream(&message_, &message_size_)) { qh_zero(&qh_, log_); }
  QhullRun(const QhullRun&) = delete;
  QhullRun& operator=(const QhullRun&) = delete;
  ~QhullRun() {
    int num_long = 0;
    int bytes_long = 0;
    qh_freeqhull(&qh_, !qh_ALL);
    qh_memfreeshort(&qh_, &num_long, &bytes_long);
    fclose(log_);
    std::free(message_);  // NOLINT(cppcoreguidelines-no-malloc): open_memstream allocates it so
  }

  /// The extreme ones of points of `dimension` coordinates each, one point after another.
  Result<std::vector<Index>> vertices_of(std::vector<double>& coordinates, int dimension) {
    const int num_points = static_cast<int>(coordinates.size()) / dimension;
    std::string options = "qhull Pp";  // Pp: what it thinks of the precision is of no use to anybody here
    if (qh_new_qhull(&qh_, dimension, num_points, coordinates.data(), False, options.data(), nullptr, log_) !=
        qh_ERRnone) {
      fflush(log_);
      return fail(
          format("no convex hull of {} points in {} dimensions: {}", num_points, dimension, message_));
    }
    std::vector<Index> vertices;
    for (const vertexT* v = qh_.vertex_list; v != nullptr && v->next != nullptr; v = v->next)
      vertices.push_back(static_cast<Index>(qh_pointid(&qh_, v->point)));
    std::ranges::sort(vertices);
    return vertices;
  }

 private:
  char* message_ = nullptr;
  std::size_t message_size_ = 0;
  FILE* log_;
  qhT qh_{};
};

/// By the coordinates in `frame`; those of a solid cloud stay as they are, without rounding.
Result<std::vector<Index>> extreme_points(const std::vector<Point>& points, const Frame& frame) {
  std::vector<double> coordinates;
  coordinates.reserve(points.size() * static_cast<std::size_t>(frame.dimension));
  for (const Point& p : points) {
    const Point q = frame.dimension == 3 ? p : frame.of(p);
    coordinates.insert(coordinates.end(), q.data(), q.data() + frame.dimension);
  }
  return std::make_unique<QhullRun>()->vertices_of(coordinates, frame.dimension);
}

std::vector<Index> ends_of(const std::vector<Point>& points, const Frame& frame) {
  const auto [first, last] =
      std::ranges::minmax_element(points, {}, [&](const Point& p) { return frame.of(p).x(); });
  std::vector<Index> ends = {static_cast<Index>(first - points.begin()),
                             static_cast<Index>(last - points.begin())};
  std::ranges::sort(ends);
  return ends;
}

}  // namespace

Result<ConvexHull> convex_hull(std::span<const Eigen::Vector3f> points) {
  const FiniteCloud cloud = finite_points(points);
  if (cloud.points.empty()) return fail(format("no hull: none of {} points is finite", points.size()));
  const Frame frame = frame_of(cloud);
  ConvexHull hull{static_cast<HullShape>(frame.dimension), {0}};
  if (hull.shape == HullShape::segment) hull.vertices = ends_of(cloud.points, frame);
  if (frame.dimension >= 2) {
    Result<std::vector<Index>> vertices = extreme_points(cloud.points, frame);
    if (!vertices) return tl::unexpected(vertices.error());
    hull.vertices = std::move(*vertices);
  }
  for (Index& vertex : hull.vertices) vertex = cloud.source[vertex];
  return hull;
}

}  // namespace adit
