// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/odometry/correspondences.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

std::vector<Eigen::Vector3f> random_points(std::size_t n, double half_width, Rng& rng) {
  const auto draw = [&] { return static_cast<float>(rng.uniform(-half_width, half_width)); };
  std::vector<Eigen::Vector3f> points(n);
  for (Eigen::Vector3f& p : points) p = {draw(), draw(), draw()};
  return points;
}

// Each point's neighbour by a search of its own.
int expect_nearest(Correspondences& pairs, const std::vector<Eigen::Vector3f>& source, const LocalMap& map,
                   const Pose& T, double max_distance) {
  const Matrix3 R = T.rotation_matrix();
  Correspondences::Block block;
  int found = 0;
  for (std::size_t index = 0; index < pairs.num_blocks(); ++index) {
    pairs.residuals(index, T, block);
    for (std::size_t k = 0; k < Correspondences::kBlock; ++k) {
      const std::size_t i = index * Correspondences::kBlock + k;
      const Vector3 r(block.rx[k], block.ry[k], block.rz[k]);
      if (i >= source.size()) {
        EXPECT_EQ(block.found[k], 0.0);
        EXPECT_EQ(r, Vector3::Zero());
        continue;
      }
      const Vector3 p = source[i].cast<double>();
      const Vector3 at = R * p + T.translation();
      const auto nearest = map.nearest(at.cast<float>(), static_cast<float>(max_distance));
      EXPECT_EQ(block.found[k], nearest ? 1.0 : 0.0);
      EXPECT_EQ(Vector3(block.px[k], block.py[k], block.pz[k]), p);
      const Vector3 expected =
          nearest ? Vector3(R.transpose() * (at - nearest->point.cast<double>())) : Vector3::Zero();
      EXPECT_LT((r - expected).norm(), 1e-9);
      found += nearest ? 1 : 0;
    }
  }
  return found;
}

// Steps that shrink as those of ICP do, now and then a large one, here and far from the map's origin.
TEST(Correspondences, AreTheNearestAtEveryPose) {
  for (const double far : {0.0, 2000.0}) {
    Rng rng(4);
    const Vector3 origin(far, -far, 0.1 * far);
    LocalMap map(0.8, 20);
    map.add(random_points(6000, 5.0, rng), Pose(Eigen::Quaterniond::Identity(), origin));
    const std::vector<Eigen::Vector3f> source = random_points(700, 5.5, rng);
    for (const double max_distance : {0.1, 0.5, 3.0}) {
      Correspondences pairs(source, map, max_distance);
      Pose T(so3::exp({0.02, 0.01, 0.3}), origin);
      int found = 0;
      double step = 0.2;
      for (int i = 0; i < 40; ++i) {
        found += expect_nearest(pairs, source, map, T, max_distance);
        Vector6 motion;
        for (int k = 0; k < 6; ++k) motion[k] = step * rng.uniform(-1.0, 1.0) * (k < 3 ? 1.0 : 0.2);
        T = T * Pose::exp(motion);
        step = i % 15 == 14 ? 0.3 : 0.7 * step;
      }
      EXPECT_GT(found, max_distance < 0.2 ? 300 : 20000);
    }
  }
}

TEST(Correspondences, NothingToPair) {
  const LocalMap map(1.0, 20);
  EXPECT_EQ(Correspondences({}, map, 1.0).num_blocks(), 0U);
  const std::vector<Eigen::Vector3f> source = {{1.0F, 2.0F, 3.0F}};
  Correspondences pairs(source, map, 1.0);
  EXPECT_EQ(expect_nearest(pairs, source, map, Pose(), 1.0), 0);
}

}  // namespace
}  // namespace adit
