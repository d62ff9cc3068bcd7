// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/convex_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

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

Pose any_rotation(Rng& rng) {
  Vector6 xi;
  for (double& x : xi) x = rng.uniform(-2.0, 2.0);
  return Pose::exp(xi);
}

Cloud moved(const Pose& T, const Cloud& cloud) {
  Cloud out;
  for (const Eigen::Vector3f& p : cloud) out.emplace_back((T * p.cast<double>()).cast<float>());
  return out;
}

double largest_coordinate(const Cloud& cloud) {
  double largest = 0.0;
  for (const Eigen::Vector3f& p : cloud) largest = std::max(largest, double{p.cwiseAbs().maxCoeff()});
  return largest;
}

using Indices = std::vector<std::uint32_t>;

/// The hull, which must exist, be solid and reach as far as the cloud in every direction.
Indices vertices_of_solid(const Cloud& cloud) {
  const Result<ConvexHull> hull = convex_hull(cloud);
  EXPECT_TRUE(hull) << hull.error().message;
  EXPECT_EQ(hull->shape, HullShape::solid);
  EXPECT_TRUE(std::ranges::is_sorted(hull->vertices));
  Rng rng(11);
  for (int i = 0; i < 200; ++i) {
    const Vector3 direction = Vector3(rng.normal(), rng.normal(), rng.normal()).normalized();
    double reach_of_cloud = -std::numeric_limits<double>::infinity();
    double reach_of_hull = reach_of_cloud;
    const auto along = [&](const Eigen::Vector3f& p) { return direction.dot(p.cast<double>()); };
    for (const Eigen::Vector3f& p : cloud) reach_of_cloud = std::max(reach_of_cloud, along(p));
    for (const std::uint32_t v : hull->vertices) reach_of_hull = std::max(reach_of_hull, along(cloud[v]));
    EXPECT_NEAR(reach_of_cloud, reach_of_hull, 1e-6 * largest_coordinate(cloud));
  }
  return hull->vertices;
}

/// Corners of every triangle that has all points on one side. Right where no four points are coplanar.
Indices vertices_by_brute_force(const Cloud& cloud) {
  std::set<std::uint32_t> vertices;
  const auto n = static_cast<std::uint32_t>(cloud.size());
  const auto point = [&](std::uint32_t i) { return Vector3(cloud[i].cast<double>()); };
  for (std::uint32_t a = 0; a < n; ++a) {
    for (std::uint32_t b = a + 1; b < n; ++b) {
      for (std::uint32_t c = b + 1; c < n; ++c) {
        const Vector3 normal = (point(b) - point(a)).cross(point(c) - point(a));
        int above = 0;
        int below = 0;
        for (std::uint32_t i = 0; i < n; ++i) {
          if (i == a || i == b || i == c) continue;
          ++(normal.dot(point(i) - point(a)) > 0.0 ? above : below);
        }
        if (above == 0 || below == 0) vertices.insert({a, b, c});
      }
    }
  }
  return {vertices.begin(), vertices.end()};
}

TEST(ConvexHull, EqualsBruteForceOnSmallClouds) {
  Rng rng(1);
  for (const std::size_t n : {4U, 5U, 8U, 12U, 20U, 30U}) {
    for (int round = 0; round < 10; ++round) {
      const Cloud cloud = moved(any_rotation(rng), random_cloud(n, rng, {3.0, 2.0, 1.0}));
      EXPECT_EQ(vertices_of_solid(cloud), vertices_by_brute_force(cloud));
    }
  }
}

TEST(ConvexHull, EveryPointOfASphereIsAVertex) {
  Rng rng(2);
  const Cloud cloud = sphere_cloud(1500, rng);
  EXPECT_EQ(vertices_of_solid(cloud).size(), cloud.size());
}

TEST(ConvexHull, ALatticeHasEightVerticesHoweverItIsOrdered) {
  Rng rng(3);
  Cloud cloud = lattice(9, 0.25F);
  for (int round = 0; round < 5; ++round) {
    const Indices vertices = vertices_of_solid(cloud);
    ASSERT_EQ(vertices.size(), 8U);
    for (const std::uint32_t v : vertices)
      EXPECT_TRUE((cloud[v].array() == 0.0F || cloud[v].array() == 2.0F).all());
    for (std::size_t i = cloud.size(); i > 1; --i) std::swap(cloud[i - 1], cloud[rng.below(i)]);
  }
}

TEST(ConvexHull, DuplicatesAddNoVertex) {
  Rng rng(4);
  const Cloud cloud = random_cloud(300, rng);
  Cloud thrice = cloud;
  for (int i = 0; i < 2; ++i) thrice.insert(thrice.end(), cloud.begin(), cloud.end());
  Indices again = vertices_of_solid(thrice);
  for (std::uint32_t& v : again) v %= static_cast<std::uint32_t>(cloud.size());
  std::ranges::sort(again);
  EXPECT_EQ(again, vertices_of_solid(cloud));
}

TEST(ConvexHull, ThinClouds) {
  Rng rng(5);
  for (const double thickness : {1e-2, 1e-4})
    vertices_of_solid(moved(any_rotation(rng), random_cloud(3000, rng, {10.0, 5.0, thickness})));
  const Cloud wall = moved(any_rotation(rng), random_cloud(3000, rng, {10.0, 5.0, 1e-8}));
  EXPECT_EQ(convex_hull(wall)->shape, HullShape::planar);
}

TEST(ConvexHull, FarFromTheOrigin) {
  Rng rng(6);
  vertices_of_solid(moved(Pose::translation_of(4e5, -5e6, 300.0), random_cloud(500, rng, {30.0, 30.0, 5.0})));
}

TEST(ConvexHull, ShapesOfLowerDimension) {
  const Eigen::Vector3f a(1, 2, 3);
  const Eigen::Vector3f step(2, 0, -1);
  const auto hull_of = [](const Cloud& cloud) { return convex_hull(cloud).value(); };
  EXPECT_EQ(hull_of({a, a, a}).shape, HullShape::point);
  EXPECT_EQ(hull_of({a, a, a}).vertices.size(), 1U);
  const ConvexHull segment = hull_of({a + step, a, a + 3 * step, a + 2 * step, a});
  EXPECT_EQ(segment.shape, HullShape::segment);
  EXPECT_EQ(segment.vertices, (Indices{1, 2}));
  // Along y, where the first coordinate is the same for all.
  EXPECT_EQ(hull_of({{0, 1, 0}, {0, 2, 0}, {0, 0, 0}}).vertices, (Indices{1, 2}));
  EXPECT_EQ(hull_of({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}).vertices, (Indices{0, 1, 2}));
  Rng rng(10);
  Cloud plane;
  for (int i = 0; i < 25; ++i) plane.emplace_back(static_cast<float>(i % 5), static_cast<float>(i / 5), 7.0F);
  plane.insert(plane.end(), plane.begin(), plane.end());
  const ConvexHull level = hull_of(plane);
  EXPECT_EQ(level.shape, HullShape::planar);
  ASSERT_EQ(level.vertices.size(), 4U);
  for (const std::uint32_t v : level.vertices)
    EXPECT_TRUE((plane[v].head<2>().array() == 0.0F || plane[v].head<2>().array() == 4.0F).all());
  EXPECT_EQ(hull_of(moved(any_rotation(rng), plane)).shape, HullShape::planar);
}

TEST(ConvexHull, NotFinitePointsAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  const Cloud cloud = {{nan, 0, 0}, {0, 0, 0}, {1, 0, 0},        {infinity, 0, 0},
                       {0, 1, 0},   {0, 0, 1}, {0, 0, -infinity}};
  const Result<ConvexHull> hull = convex_hull(cloud);
  EXPECT_EQ(hull->shape, HullShape::solid);
  EXPECT_EQ(hull->vertices, (Indices{1, 2, 4, 5}));
  EXPECT_FALSE(convex_hull({}));
  EXPECT_EQ(convex_hull(Cloud{{nan, nan, nan}, {0, 0, infinity}}).error().message,
            "no hull: none of 2 points is finite");
}

TEST(OrientedBox, FindsRotatedBoxesOfKnownExtents) {
  Rng rng(7);
  for (int round = 0; round < 20; ++round) {
    const Vector3 extents(rng.uniform(20.0, 40.0), rng.uniform(8.0, 12.0), rng.uniform(3.0, 6.0));
    const Pose T_world_box = any_rotation(rng);
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
    const Cloud cloud = moved(any_rotation(rng), random_cloud(400, rng, {1.0, rng.uniform(0.5, 5.0), 2.0}));
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
