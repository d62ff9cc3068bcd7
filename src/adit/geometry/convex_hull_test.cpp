// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/convex_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "adit/core/pose.hpp"
#include "adit/core/rng.hpp"
#include "adit/geometry/oriented_box.hpp"

namespace adit {
namespace {

using Cloud = std::vector<Eigen::Vector3f>;

Cloud random_cloud(std::size_t n, Rng& rng, const Vector3& half = Vector3::Ones()) {
  Cloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 p(rng.uniform(-half.x(), half.x()), rng.uniform(-half.y(), half.y()),
                    rng.uniform(-half.z(), half.z()));
    cloud.emplace_back(p.cast<float>());
  }
  return cloud;
}

Cloud sphere_cloud(std::size_t n, Rng& rng) {
  Cloud cloud;
  while (cloud.size() < n) {
    const Vector3 p(rng.normal(), rng.normal(), rng.normal());
    cloud.emplace_back(p.normalized().cast<float>());
  }
  return cloud;
}

/// All points of {0 .. n-1}^3, times `step`.
Cloud lattice(int n, float step) {
  Cloud cloud;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        cloud.push_back(step * Eigen::Vector3i(x, y, z).cast<float>());
      }
    }
  }
  return cloud;
}

Pose random_pose(Rng& rng) {
  Vector6 xi;
  for (double& x : xi) x = rng.uniform(-2.0, 2.0);
  return Pose::exp(xi);
}

Cloud moved(const Pose& T, const Cloud& cloud) {
  Cloud out;
  for (const Eigen::Vector3f& p : cloud) out.emplace_back((T * p.cast<double>()).cast<float>());
  return out;
}

double greatest_coordinate(const Cloud& cloud) {
  double greatest = 0.0;
  for (const Eigen::Vector3f& p : cloud)
    greatest = std::max(greatest, static_cast<double>(p.cwiseAbs().maxCoeff()));
  return greatest;
}

/// The greatest distance of a point to the outside of a face, in units of what rounding the corners to the
/// grid can do there: it tilts the plane of a narrow face by the rounding over its width.
double excess(const std::array<std::uint32_t, 3>& face, const Cloud& cloud) {
  const Vector3 a = cloud[face[0]].cast<double>();
  const Vector3 ab = cloud[face[1]].cast<double>() - a;
  const Vector3 ac = cloud[face[2]].cast<double>() - a;
  const Vector3 normal = ab.cross(ac);
  if (normal.isZero(0.0)) return 0.0;
  const double size = greatest_coordinate(cloud);
  const double width = normal.norm() / std::max({ab.norm(), ac.norm(), (ab - ac).norm()});
  double farthest = 0.0;
  for (const Eigen::Vector3f& p : cloud)
    farthest = std::max(farthest, normal.normalized().dot(p.cast<double>() - a));
  return farthest / (0x1p-22 * size * (1.0 + size / width));
}

/// No point outside any face, every edge shared by two faces in opposite directions, Euler's formula.
void expect_valid_hull(const ConvexHull& hull, const Cloud& cloud) {
  ASSERT_EQ(hull.shape, HullShape::solid);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  std::vector<std::uint32_t> corners;
  for (const auto& triangle : hull.triangles) {
    const auto& [a, b, c] = triangle;
    EXPECT_LE(excess(triangle, cloud), 1.0);
    for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) ++edges[edge];
    corners.insert(corners.end(), {a, b, c});
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_TRUE(edges.contains({edge.second, edge.first}));
  }
  std::ranges::sort(corners);
  const auto repeated = std::ranges::unique(corners);
  const auto num_corners = static_cast<std::size_t>(repeated.begin() - corners.begin());
  EXPECT_EQ(num_corners + hull.triangles.size(), edges.size() / 2 + 2);
  EXPECT_TRUE(std::ranges::is_sorted(hull.vertices));
}

/// The least height of the cloud's support over random directions, from all points against from hull
/// vertices.
void expect_same_support(const Cloud& cloud, const ConvexHull& hull, Rng& rng) {
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d direction = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
    double all = -1e300;
    double vertices = -1e300;
    for (const Eigen::Vector3f& p : cloud) all = std::max(all, direction.dot(p.cast<double>()));
    for (const std::uint32_t v : hull.vertices)
      vertices = std::max(vertices, direction.dot(cloud[v].cast<double>()));
    EXPECT_NEAR(all, vertices, 1e-6 * greatest_coordinate(cloud));
  }
}

TEST(ConvexHull, RandomCloudsAreHeldByTheirHull) {
  Rng rng(1);
  for (const std::size_t n : {4U, 5U, 10U, 100U, 2000U}) {
    const Cloud cloud = moved(random_pose(rng), random_cloud(n, rng, {3.0, 2.0, 1.0}));
    const ConvexHull hull = convex_hull(cloud);
    expect_valid_hull(hull, cloud);
    expect_same_support(cloud, hull, rng);
  }
}

TEST(ConvexHull, EveryPointOfASphereIsAVertex) {
  Rng rng(2);
  const Cloud cloud = sphere_cloud(1500, rng);
  const ConvexHull hull = convex_hull(cloud);
  expect_valid_hull(hull, cloud);
  EXPECT_EQ(hull.vertices.size(), cloud.size());
  EXPECT_EQ(hull.triangles.size(), 2 * cloud.size() - 4);
  EXPECT_NEAR(volume(hull, cloud), 4.0 / 3.0 * M_PI, 0.05);
}

TEST(ConvexHull, ALatticeHasEightVerticesHoweverItIsOrdered) {
  Rng rng(3);
  Cloud cloud = lattice(9, 0.25F);
  for (int round = 0; round < 5; ++round) {
    const ConvexHull hull = convex_hull(cloud);
    expect_valid_hull(hull, cloud);
    ASSERT_EQ(hull.vertices.size(), 8U);
    for (const std::uint32_t v : hull.vertices) {
      EXPECT_TRUE((cloud[v].array() == 0.0F || cloud[v].array() == 2.0F).all());
    }
    EXPECT_DOUBLE_EQ(volume(hull, cloud), 8.0);
    for (std::size_t i = cloud.size(); i > 1; --i) std::swap(cloud[i - 1], cloud[rng.below(i)]);
  }
}

TEST(ConvexHull, DuplicatesChangeNothing) {
  Rng rng(4);
  Cloud cloud = random_cloud(300, rng);
  const ConvexHull once = convex_hull(cloud);
  Cloud thrice = cloud;
  for (int i = 0; i < 2; ++i) thrice.insert(thrice.end(), cloud.begin(), cloud.end());
  const ConvexHull again = convex_hull(thrice);
  expect_valid_hull(again, thrice);
  EXPECT_EQ(again.vertices.size(), once.vertices.size());
  EXPECT_DOUBLE_EQ(volume(again, thrice), volume(once, cloud));
}

TEST(ConvexHull, NearlyFlatCloudsHoldTogether) {
  Rng rng(5);
  for (const double thickness : {1e-2, 1e-4, 1e-6, 1e-7}) {
    const Cloud cloud = moved(random_pose(rng), random_cloud(3000, rng, {10.0, 5.0, thickness}));
    const ConvexHull hull = convex_hull(cloud);
    expect_valid_hull(hull, cloud);
    expect_same_support(cloud, hull, rng);
  }
}

TEST(ConvexHull, FarFromTheOrigin) {
  Rng rng(6);
  const Cloud cloud =
      moved(Pose::translation_of(4e5, -5e6, 300.0), random_cloud(500, rng, {30.0, 30.0, 5.0}));
  const ConvexHull hull = convex_hull(cloud);
  expect_valid_hull(hull, cloud);
  expect_same_support(cloud, hull, rng);
}

TEST(ConvexHull, ShapesOfLowerDimension) {
  const Eigen::Vector3f a(1, 2, 3);
  const Eigen::Vector3f step(2, 0, -1);
  EXPECT_EQ(convex_hull({}).shape, HullShape::empty);
  EXPECT_EQ(convex_hull(Cloud{a, a, a}).shape, HullShape::point);
  const ConvexHull segment = convex_hull(Cloud{a + step, a, a + 3 * step, a + 2 * step, a});
  EXPECT_EQ(segment.shape, HullShape::segment);
  EXPECT_EQ(segment.vertices, (std::vector<std::uint32_t>{1, 2}));
  // Along y, where the first coordinate says nothing.
  const ConvexHull along_y = convex_hull(Cloud{{0, 1, 0}, {0, 2, 0}, {0, 0, 0}});
  EXPECT_EQ(along_y.vertices, (std::vector<std::uint32_t>{1, 2}));
  Cloud plane;
  for (int i = 0; i < 25; ++i) plane.emplace_back(static_cast<float>(i % 5), static_cast<float>(i / 5), 7.0F);
  plane.insert(plane.end(), plane.begin(), plane.end());
  const ConvexHull square = convex_hull(plane);
  EXPECT_EQ(square.shape, HullShape::planar);
  EXPECT_EQ(square.vertices.size(), 4U);
  EXPECT_EQ(volume(square, plane), 0.0);
}

TEST(ConvexHull, NotFinitePointsAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Cloud cloud = {{nan, 0, 0}, {0, 0, 0}, {1, 0, 0},        {infinity, 0, 0},
                       {0, 1, 0},   {0, 0, 1}, {0, 0, -infinity}};
  const ConvexHull hull = convex_hull(cloud);
  EXPECT_EQ(hull.shape, HullShape::solid);
  EXPECT_EQ(hull.vertices, (std::vector<std::uint32_t>{1, 2, 4, 5}));
  EXPECT_EQ(convex_hull(Cloud{{nan, nan, nan}}).shape, HullShape::empty);
}

TEST(OrientedBox, FindsRotatedBoxesOfKnownExtents) {
  Rng rng(7);
  for (int round = 0; round < 20; ++round) {
    const Vector3 extents(rng.uniform(20.0, 40.0), rng.uniform(8.0, 12.0), rng.uniform(3.0, 6.0));
    const Pose T_world_box = random_pose(rng);
    Cloud cloud;
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Array3d sign((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1,
                                (corner & 4) != 0 ? 1 : -1);
      cloud.emplace_back((T_world_box * Vector3(0.5 * sign * extents.array())).cast<float>());
    }
    for (const Eigen::Vector3f& p : random_cloud(500, rng, 0.49 * extents)) {
      cloud.emplace_back((T_world_box * p.cast<double>()).cast<float>());
    }
    const Result<OrientedBox> box = oriented_box(cloud);
    ASSERT_TRUE(box);
    EXPECT_LT((box->extents - extents).norm(), 1e-4);
    EXPECT_LT((box->T_world_box.translation() - T_world_box.translation()).norm(), 1e-4);
    for (int axis = 0; axis < 3; ++axis) {
      const double cosine =
          box->T_world_box.rotation_matrix().col(axis).dot(T_world_box.rotation_matrix().col(axis));
      EXPECT_NEAR(std::abs(cosine), 1.0, 1e-6);
    }
  }
}

TEST(OrientedBox, HoldsEveryPointAndSortsItsExtents) {
  Rng rng(8);
  for (int round = 0; round < 10; ++round) {
    const Cloud cloud = moved(random_pose(rng), random_cloud(400, rng, {1.0, rng.uniform(0.5, 5.0), 2.0}));
    const OrientedBox box = oriented_box(cloud).value();
    EXPECT_GE(box.extents.x(), box.extents.y());
    EXPECT_GE(box.extents.y(), box.extents.z());
    const Pose T_box_world = box.T_world_box.inverse();
    for (const Eigen::Vector3f& p : cloud) {
      EXPECT_LE(((T_box_world * p.cast<double>()).cwiseAbs() - 0.5 * box.extents).maxCoeff(), 1e-5);
    }
    EXPECT_NEAR(box.volume(), box.extents.x() * box.extents.y() * box.extents.z(), 1e-9);
  }
}

TEST(OrientedBox, DoesNotDependOnDensity) {
  Rng rng(9);
  Cloud cloud = lattice(5, 1.0F);
  for (Eigen::Vector3f& p : cloud) p = p.cwiseProduct(Eigen::Vector3f(4, 2, 1));
  const Vector3 sparse = oriented_box(cloud)->extents;
  for (int i = 0; i < 5000; ++i) {  // One wall a hundred times denser than the others.
    cloud.emplace_back(0.0F, static_cast<float>(rng.uniform(0, 8)), static_cast<float>(rng.uniform(0, 4)));
  }
  EXPECT_TRUE(oriented_box(cloud)->extents.isApprox(sparse, 1e-12));
}

TEST(OrientedBox, DegenerateClouds) {
  EXPECT_FALSE(oriented_box({}));
  EXPECT_FALSE(oriented_box(Cloud{{std::nanf(""), 0, 0}}));
  EXPECT_EQ(oriented_box(Cloud{{1, 2, 3}})->extents, Vector3::Zero());
  EXPECT_EQ(oriented_box(Cloud{{1, 2, 3}})->T_world_box.translation(), Vector3(1, 2, 3));
  const Vector3 line = oriented_box(Cloud{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}})->extents;
  EXPECT_NEAR(line.x(), std::sqrt(12.0), 1e-9);
  EXPECT_NEAR(line.y(), 0.0, 1e-9);
  const Vector3 flat = oriented_box(Cloud{{0, 0, 1}, {4, 0, 1}, {4, 2, 1}, {0, 2, 1}, {1, 1, 1}})->extents;
  EXPECT_TRUE(flat.isApprox(Vector3(4, 2, 0), 1e-9));
}

}  // namespace
}  // namespace adit
