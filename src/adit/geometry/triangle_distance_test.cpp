// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/geometry/triangle_distance.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/meshes.hpp"

namespace adit {
namespace {

/// The nearest of many points of the triangle.
double sampled_distance(const Vector3& p, const std::array<Vector3, 3>& t) {
  constexpr int kSteps = 200;
  double nearest = (p - t[0]).norm();
  for (int i = 0; i <= kSteps; ++i)
    for (int k = 0; k + i <= kSteps; ++k) {
      const Vector3 q = t[0] + (t[1] - t[0]) * i / kSteps + (t[2] - t[0]) * k / kSteps;
      nearest = std::min(nearest, (p - q).norm());
    }
  return nearest;
}

TEST(TriangleDistance, IsThatOfTheNearestOfManyPoints) {
  Rng rng(3);
  for (int i = 0; i < 60; ++i) {
    const std::array<Vector3, 3> t = {test::random_vector(rng, 1.0), test::random_vector(rng, 1.0),
                                      test::random_vector(rng, 1.0)};
    const Vector3 p = test::random_vector(rng, 2.0);
    const double distance = std::sqrt(squared_distance_to_triangle(p, t));
    EXPECT_LE(distance, sampled_distance(p, t) + 1e-9);
    EXPECT_NEAR(distance, sampled_distance(p, t), 0.03);
    EXPECT_NEAR(distance, std::sqrt(squared_distance_to_triangle(p, {t[2], t[1], t[0]})), 1e-9);
  }
}

TEST(TriangleDistance, ALineAndAPointAreTriangles) {
  const Vector3 a(0, 0, 0);
  const Vector3 b(2, 0, 0);
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({1, 3, 0}, {a, b, a}), 9.0);
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({5, 0, 0}, {a, Vector3(1, 0, 0), b}), 9.0);
  EXPECT_DOUBLE_EQ(squared_distance_to_triangle({0, 0, 2}, {a, a, a}), 4.0);
}

}  // namespace
}  // namespace adit
