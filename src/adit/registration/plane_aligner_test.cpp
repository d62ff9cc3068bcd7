// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/plane_aligner.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/parallel.hpp"
#include "adit/core/rng.hpp"
#include "adit/core/robust_kernel.hpp"
#include "adit/geometry/point_to_plane.hpp"

namespace adit {
namespace {

/// A rough floor and a rough wall, with some normals turned away.
OrientedPoints rough_corner(std::size_t n, std::uint64_t seed) {
  Rng rng(seed);
  OrientedPoints out;
  for (std::size_t k = 0; k < n; ++k) {
    const bool is_floor = rng.uniform() < 0.5;
    const Vector3 p(rng.uniform(-8.0, 8.0), is_floor ? rng.uniform(-8.0, 8.0) : 8.0,
                    is_floor ? -1.0 : rng.uniform(-1.0, 5.0));
    const Vector3 noise(rng.normal(), rng.normal(), rng.normal());
    out.points.push_back((p + 0.03 * noise).cast<float>());
    const Vector3 normal = is_floor ? Vector3(0.0, 0.0, 1.0) : Vector3(0.0, -1.0, 0.0);
    out.normals.push_back((normal + 0.3 * noise).normalized().cast<float>());
  }
  return out;
}

/// Pair by pair in double precision, each by looking at all points.
PlaneEquations by_definition(const OrientedPoints& a, const OrientedPoints& b, std::size_t stride,
                             double max_distance, const Pose& T_a_b, double kernel) {
  PlaneEquations sum;
  const auto add = [&](const PlaneResidual& r) {
    const double root = geman_mcclure_root(kernel * kernel, r.value * r.value);
    sum.H += root * root * r.jacobian * r.jacobian.transpose();
    sum.g += root * root * r.jacobian * r.value;
    return root;
  };
  for (std::size_t j = 0; j < b.size(); j += stride) {
    const Vector3 p_b = b.points[j].cast<double>();
    const Vector3 q = T_a_b * p_b;
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < a.size(); ++i) {
      if ((a.points[i].cast<double>() - q).norm() < (a.points[nearest].cast<double>() - q).norm())
        nearest = i;
    }
    const Vector3 p_a = a.points[nearest].cast<double>();
    if ((p_a - q).norm() > max_distance) continue;
    const Vector3 n_a = a.normals[nearest].cast<double>();
    const Vector3 n_b = T_a_b.rotation() * b.normals[j].cast<double>();
    sum.num_pairs += 1.0;
    const auto residual_with = [&](const Vector3& normal) {
      return plane_residual(T_a_b.rotation_matrix(), T_a_b.translation(), {p_a, normal}, p_b);
    };
    const PlaneResidual r = residual_with(n_a);
    sum.fit += kernel * kernel / (kernel * kernel + r.value * r.value);
    if (std::abs(n_a.dot(n_b)) < 0.8) continue;
    add(r);
    add(residual_with(n_b));
  }
  return sum;
}

void expect_near(const PlaneEquations& sum, const PlaneEquations& expected) {
  EXPECT_EQ(sum.num_pairs, expected.num_pairs);
  EXPECT_NEAR(sum.fit, expected.fit, 1e-4 * expected.num_pairs);
  EXPECT_LT((sum.H - expected.H).norm(), 1e-5 * expected.H.norm());
  EXPECT_LT((sum.g - expected.g).norm(), 1e-5 * std::sqrt(expected.H.norm() * expected.num_pairs));
}

TEST(PlaneAligner, AgreesWithTheDefinitionAtEachPoseOfADescent) {
  const OrientedPoints a = rough_corner(1500, 1);
  const OrientedPoints b = rough_corner(1300, 2);
  const PointGrid grid(a.points, 1.0);
  PlaneAligner aligner(a, grid, b, 3, 0.5);
  const Vector6 off = (Vector6() << 0.2, -0.1, 0.3, 0.03, -0.02, 0.05).finished();
  for (const double share : {1.0, 0.4, 0.41, 0.1, 0.03, 0.02, 0.0199, 0.0, 0.6}) {  // large steps, small ones
    const Pose T_a_b = Pose::exp(share * off);
    expect_near(aligner.linearize(T_a_b, 0.1), by_definition(a, b, 3, 0.5, T_a_b, 0.1));
  }
}

TEST(PlaneAligner, SameBytesWithAnyNumberOfThreads) {
  const OrientedPoints a = rough_corner(4000, 1);
  const OrientedPoints b = rough_corner(4000, 2);
  const PointGrid grid(a.points, 1.0);
  set_num_threads(1);
  const PlaneEquations one = PlaneAligner(a, grid, b, 1, 0.5).linearize(Pose(), 0.1);
  set_num_threads(4);
  const PlaneEquations four = PlaneAligner(a, grid, b, 1, 0.5).linearize(Pose(), 0.1);
  EXPECT_EQ(one.H, four.H);
  EXPECT_EQ(one.g, four.g);
}

TEST(PlaneAligner, PointsFarFromEverythingTakeNoPart) {
  const OrientedPoints a = rough_corner(100, 1);
  const PointGrid grid(a.points, 1.0);
  PlaneAligner aligner(a, grid, a, 1, 0.5);
  EXPECT_EQ(aligner.linearize(Pose::translation_of(500.0, 0.0, 0.0), 0.1).num_pairs, 0.0);
  EXPECT_EQ(aligner.linearize(Pose(), 0.1).num_pairs, 100.0);
  const PointGrid nothing;
  PlaneAligner alone(a, nothing, a, 1, 0.5);
  EXPECT_EQ(alone.linearize(Pose(), 0.1).num_pairs, 0.0);
}

}  // namespace
}  // namespace adit
