// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/simulation/raycaster.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "adit/core/parallel.hpp"
#include "adit/geometry/triangle_distance.hpp"
#include "support/meshes.hpp"

namespace adit {
namespace {

TriangleMesh random_soup(int num_triangles) {
  Rng rng(11);
  TriangleMesh mesh;
  for (int i = 0; i < num_triangles; ++i) {
    const Vector3 middle = test::random_vector(rng, 10.0);
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back((middle + test::random_vector(rng, 2.0)).cast<float>());
    }
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  return mesh;
}

std::vector<Ray> random_rays(int num_rays) {
  Rng rng(12);
  std::vector<Ray> rays;
  for (int i = 0; i < num_rays; ++i) {
    Vector3 direction = test::random_vector(rng, 1.0);
    if (i % 5 == 0) direction = Vector3::Unit(i % 3) * (i % 2 == 0 ? 1.0 : -1.0);  // along an axis
    rays.push_back({test::random_vector(rng, 12.0).cast<float>(), direction.normalized().cast<float>()});
  }
  return rays;
}

struct BlockHit {
  float distance;
  float cosine;
};

std::vector<BlockHit> cast_in_blocks(const Raycaster& raycaster, const std::vector<Ray>& rays,
                                     float max_distance, std::size_t block_size = RayBlock::kCapacity) {
  std::vector<BlockHit> hits;
  for (std::size_t begin = 0; begin < rays.size(); begin += block_size) {
    RayBlock block;
    block.size = std::min(block_size, rays.size() - begin);
    for (std::size_t i = 0; i < block.size; ++i) {
      const auto& [origin, direction] = rays[begin + i];
      std::tie(block.origins.x[i], block.origins.y[i], block.origins.z[i]) =
          std::tuple(origin.x(), origin.y(), origin.z());
      std::tie(block.directions.x[i], block.directions.y[i], block.directions.z[i]) =
          std::tuple(direction.x(), direction.y(), direction.z());
    }
    raycaster.cast(block, max_distance);
    for (std::size_t i = 0; i < block.size; ++i) hits.push_back({block.distances[i], block.cosines[i]});
  }
  return hits;
}

struct OracleHit {
  double distance = std::numeric_limits<double>::infinity();
  bool near_edge = false;  // some triangle is met so near its rim that rounding decides
};

// Moeller and Trumbore, "Fast, minimum storage ray/triangle intersection", 1997, over all triangles.
OracleHit brute_force(const TriangleMesh& mesh, const Ray& ray) {
  const Vector3 origin = ray.origin.cast<double>();
  const Vector3 direction = ray.direction.cast<double>();
  OracleHit best;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const auto corner = [&](int i) {
      return Vector3(mesh.vertices[static_cast<std::size_t>(t[i])].cast<double>());
    };
    const Vector3 ab = corner(1) - corner(0);
    const Vector3 ac = corner(2) - corner(0);
    const Vector3 p = direction.cross(ac);
    const double determinant = ab.dot(p);
    if (std::abs(determinant) < 1e-12) continue;
    const Vector3 s = origin - corner(0);
    const double u = s.dot(p) / determinant;
    const Vector3 q = s.cross(ab);
    const double v = direction.dot(q) / determinant;
    const double distance = ac.dot(q) / determinant;
    const double rim = std::min({u, v, 1.0 - u - v});
    if (std::abs(rim) < 1e-4 && distance > -1e-3) best.near_edge = true;
    if (rim >= 0.0 && distance > 0.0) best.distance = std::min(best.distance, distance);
  }
  return best;
}

TEST(Raycaster, agrees_with_brute_force_on_a_triangle_soup) {
  const TriangleMesh mesh = random_soup(300);
  const Raycaster raycaster = Raycaster::build(mesh).value();
  int hits = 0;
  int misses = 0;
  for (const Ray& ray : random_rays(3000)) {
    const OracleHit expected = brute_force(mesh, ray);
    if (expected.near_edge) continue;
    const RayHit got = raycaster.cast(ray, 1000.0F);
    ASSERT_EQ(got.hit(), std::isfinite(expected.distance));
    got.hit() ? ++hits : ++misses;
    if (got.hit()) {
      EXPECT_NEAR(got.distance, expected.distance, 1e-4 * (1.0 + expected.distance));
      EXPECT_NEAR(got.normal.norm(), 1.0F, 1e-6F);
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(misses, 200);
}

TEST(Raycaster, many_rays_at_once_are_the_same_as_one_by_one) {
  const Raycaster raycaster = Raycaster::build(random_soup(300)).value();
  const std::vector<Ray> rays = random_rays(1000);
  for (const std::size_t block_size : {1U, 7U, 127U, 128U}) {
    const std::vector<BlockHit> together = cast_in_blocks(raycaster, rays, 50.0F, block_size);
    ASSERT_EQ(together.size(), rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const RayHit alone = raycaster.cast(rays[i], 50.0F);
      EXPECT_EQ(together[i].distance, alone.distance);
      const float cosine = std::abs(alone.normal.dot(rays[i].direction));
      EXPECT_EQ(alone.hit() ? together[i].cosine : cosine, cosine);
    }
  }
}

TEST(Raycaster, any_thread_may_cast) {
  const Raycaster raycaster = Raycaster::build(random_soup(300)).value();
  const std::vector<Ray> rays = random_rays(5000);
  std::vector<float> parallel(rays.size());
  parallel_for_each(
      rays.size(), [&](std::size_t i) { parallel[i] = raycaster.cast(rays[i], 50.0F).distance; }, 100);
  for (std::size_t i = 0; i < rays.size(); ++i)
    EXPECT_EQ(parallel[i], raycaster.cast(rays[i], 50.0F).distance);
}

TEST(Raycaster, building_leaves_the_thread_limit_of_the_process_alone) {
  const int before = num_threads();
  const Raycaster raycaster = Raycaster::build(random_soup(300)).value();
  EXPECT_EQ(num_threads(), before);
}

TEST(Raycaster, at_edges_and_corners_the_same_triangle_wins_with_any_number_of_threads) {
  const Eigen::AlignedBox2d area(Eigen::Vector2d(0, 0), Eigen::Vector2d(100, 100));
  const TriangleMesh mesh =
      test::floor_of(area, 0.5, [](double x, double y) { return std::sin(x) * std::cos(y); });
  std::vector<Ray> rays;
  for (const Eigen::Vector3i& t : mesh.triangles) {
    const Eigen::Vector3f corner = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Eigen::Vector3f edge = 0.5F * (corner + mesh.vertices[static_cast<std::size_t>(t[2])]);
    rays.push_back({corner + 5.0F * Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ()});
    rays.push_back({edge + 5.0F * Eigen::Vector3f::UnitZ(), -Eigen::Vector3f::UnitZ()});
  }
  const int before = num_threads();
  set_num_threads(1);
  const std::vector<BlockHit> one = cast_in_blocks(Raycaster::build(mesh).value(), rays, 50.0F);
  set_num_threads(4);
  const std::vector<BlockHit> four = cast_in_blocks(Raycaster::build(mesh).value(), rays, 50.0F);
  set_num_threads(before);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(one[i].distance, four[i].distance);
    ASSERT_EQ(one[i].cosine, four[i].cosine);
  }
}

TEST(Raycaster, sees_both_sides_and_stops_at_the_given_distance) {
  TriangleMesh mesh;
  test::add_quad(mesh, {5, -1, -1}, {5, 1, -1}, {5, 1, 1}, {5, -1, 1});
  const Raycaster raycaster = Raycaster::build(mesh).value();
  const Ray ahead{{0, 0.1F, 0.2F}, Eigen::Vector3f::UnitX()};
  const Ray from_behind{{10, 0.1F, 0.2F}, -Eigen::Vector3f::UnitX()};
  EXPECT_FLOAT_EQ(raycaster.cast(ahead, 200.0F).distance, 5.0F);
  EXPECT_FLOAT_EQ(raycaster.cast(from_behind, 200.0F).distance, 5.0F);
  EXPECT_EQ(raycaster.cast(ahead, 200.0F).normal, raycaster.cast(from_behind, 200.0F).normal);
  EXPECT_FALSE(raycaster.cast(ahead, 4.9F).hit());
  EXPECT_FALSE(raycaster.cast({{0, 0, 0}, -Eigen::Vector3f::UnitX()}, 200.0F).hit());
}

TEST(Raycaster, a_ray_within_the_plane_of_a_triangle_meets_nothing) {
  TriangleMesh mesh;
  test::add_quad(mesh, {1, -1, 0}, {2, -1, 0}, {2, 1, 0}, {1, 1, 0});
  const Raycaster raycaster = Raycaster::build(mesh).value();
  EXPECT_FALSE(raycaster.cast({{0, 0, 0}, Eigen::Vector3f::UnitX()}, 10.0F).hit());
  EXPECT_FALSE(raycaster.cast({{0, 0, 0.01F}, Eigen::Vector3f::UnitX()}, 10.0F).hit());
}

TEST(Raycaster, triangles_without_area_are_never_met) {
  TriangleMesh mesh = test::room({-2, -2, -2}, {2, 2, 2});
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.triangles.emplace_back(3, 3, 3);
  const Raycaster raycaster = Raycaster::build(mesh).value();
  for (const Ray& ray : random_rays(1000)) {
    const RayHit hit = raycaster.cast(Ray{Eigen::Vector3f::Zero(), ray.direction}, 100.0F);
    ASSERT_TRUE(hit.hit());
    EXPECT_NEAR((hit.distance * ray.direction).cwiseAbs().maxCoeff(), 2.0F, 1e-5F);
    EXPECT_NEAR(hit.normal.norm(), 1.0F, 1e-6F);
  }
}

TEST(Raycaster, far_from_the_origin_distances_keep_a_tenth_of_a_millimetre) {
  const Vector3 far(800.0, -600.0, 50.0);
  const Raycaster raycaster =
      Raycaster::build(test::room(far - Vector3(4, 4, 2), far + Vector3(4, 4, 2))).value();
  const RayHit hit = raycaster.cast({far.cast<float>(), Eigen::Vector3f::UnitY()}, 100.0F);
  EXPECT_NEAR(hit.distance, 4.0F, 1e-4F);
}

TEST(Raycaster, refuses_what_is_not_a_mesh) {
  EXPECT_FALSE(Raycaster::build({}).has_value());
  TriangleMesh mesh = test::room({0, 0, 0}, {1, 1, 1});
  mesh.vertices[2].y() = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(Raycaster::build(mesh).has_value());
  mesh = test::room({0, 0, 0}, {1, 1, 1});
  mesh.triangles[1].x() = 24;
  EXPECT_FALSE(Raycaster::build(mesh).has_value());
}

TEST(Raycaster, TheNearestSurfaceIsThatOfAllTriangles) {
  const TriangleMesh mesh = random_soup(300);
  const Result<Raycaster> raycaster = Raycaster::build(mesh);
  ASSERT_TRUE(raycaster) << raycaster.error().message;
  Rng rng(13);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3f p = test::random_vector(rng, 14.0).cast<float>();
    double nearest = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3i& t : mesh.triangles) {
      const auto corner = [&](int c) -> Vector3 {
        return mesh.vertices[static_cast<std::size_t>(t[c])].cast<double>();
      };
      nearest = std::min(nearest,
                         squared_distance_to_triangle(p.cast<double>(), {corner(0), corner(1), corner(2)}));
    }
    const auto distance = static_cast<float>(std::sqrt(nearest));
    EXPECT_FLOAT_EQ(raycaster->distance(p), distance);
    EXPECT_EQ(raycaster->distance(p, 0.9F * distance), RayHit::kMiss);
    EXPECT_FLOAT_EQ(raycaster->distance(p, 1.1F * distance), distance);
  }
}

}  // namespace
}  // namespace adit
