// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/fpfh.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

using Points = std::vector<Eigen::Vector3f>;
using Bins = std::array<int, 3>;

Vector3 random_direction(Rng& rng) { return Vector3(rng.normal(), rng.normal(), rng.normal()).normalized(); }

int clamped_bin(double unit_value) {
  return std::clamp(static_cast<int>(std::floor(11.0 * unit_value)), 0, 10);
}

/// The Darboux-frame features as the paper writes them, with an arc tangent, in double precision.
struct PairFeature {
  double theta;
  double alpha;
  double phi;
};
PairFeature textbook_feature(Vector3 p_s, Vector3 n_s, Vector3 p_t, Vector3 n_t) {
  const Vector3 line = (p_t - p_s).normalized();
  if (std::acos(std::abs(n_s.dot(line))) > std::acos(std::abs(n_t.dot(line)))) {
    std::swap(p_s, p_t);
    std::swap(n_s, n_t);
  }
  const Vector3 d = (p_t - p_s).normalized();
  const Vector3 u = n_s;
  const Vector3 v = d.cross(u).normalized();
  const Vector3 w = u.cross(v);
  return {std::atan2(w.dot(n_t), u.dot(n_t)), v.dot(n_t), u.dot(d)};
}

Bins textbook_bins(const PairFeature& f) {
  return {clamped_bin((f.theta + std::numbers::pi) / (2.0 * std::numbers::pi)),
          clamped_bin((f.alpha + 1.0) / 2.0), clamped_bin((f.phi + 1.0) / 2.0)};
}

TEST(Fpfh, PairBinsAgreeWithTheTextbook) {
  Rng rng(1);
  int num_different = 0;
  for (int k = 0; k < 5000; ++k) {
    const Eigen::Vector3f p = random_direction(rng).cast<float>();
    const Eigen::Vector3f q = random_direction(rng).cast<float>();
    const Eigen::Vector3f n = random_direction(rng).cast<float>();
    const Eigen::Vector3f m = random_direction(rng).cast<float>();
    const auto bins = pair_feature_bins(p, n, q, m);
    ASSERT_TRUE(bins.has_value());
    EXPECT_EQ(bins, pair_feature_bins(q, m, p, n));  // symmetric
    const Bins expected = textbook_bins(
        textbook_feature(p.cast<double>(), n.cast<double>(), q.cast<double>(), m.cast<double>()));
    num_different += static_cast<int>(*bins != expected);
  }
  EXPECT_LE(num_different, 3);  // features on the border of a bin, in float
}

TEST(Fpfh, PairBinsDoNotDependOnThePose) {
  Rng rng(2);
  int num_different = 0;
  for (int k = 0; k < 1000; ++k) {
    const Pose T(so3::exp(std::numbers::pi * rng.uniform() * random_direction(rng)),
                 3.0 * random_direction(rng));
    const Vector3 p = random_direction(rng);
    const Vector3 q = random_direction(rng);
    const Vector3 n = random_direction(rng);
    const Vector3 m = random_direction(rng);
    const auto here = pair_feature_bins(p.cast<float>(), n.cast<float>(), q.cast<float>(), m.cast<float>());
    const auto there = pair_feature_bins((T * p).cast<float>(), (T.rotation() * n).cast<float>(),
                                         (T * q).cast<float>(), (T.rotation() * m).cast<float>());
    num_different += static_cast<int>(here != there);
  }
  EXPECT_LE(num_different, 3);
}

TEST(Fpfh, PairsWithoutAFrameGiveNothing) {
  const Eigen::Vector3f p(1.0F, 2.0F, 3.0F);
  const Eigen::Vector3f up = Eigen::Vector3f::UnitZ();
  EXPECT_FALSE(pair_feature_bins(p, up, p, up).has_value());              // the same point
  EXPECT_FALSE(pair_feature_bins(p, up, p + 2.0F * up, up).has_value());  // the line along the normals
  EXPECT_EQ(pair_feature_bins(p, up, p + Eigen::Vector3f::UnitX(), up), (Bins{5, 5, 5}));  // a plane
}

struct BumpyCloud {
  Points points;
  std::vector<SurfacePoint> surface;
  NeighborPairs pairs;
};

BumpyCloud bumpy_cloud(float radius) {
  Rng rng(3);
  BumpyCloud cloud;
  for (int k = 0; k < 250; ++k) {
    const double x = rng.uniform(-2.0, 2.0);
    const double y = rng.uniform(-2.0, 2.0);
    cloud.points.push_back(Vector3(x, y, 5.0 + 0.5 * std::sin(3.0 * x) * std::cos(2.0 * y)).cast<float>());
  }
  cloud.pairs = find_pairs_within(cloud.points, radius);
  cloud.surface = estimate_surface(cloud.points, cloud.pairs, 0.8F * radius);
  return cloud;
}

using Histogram = Eigen::Array<double, kDescriptorSize, 1>;

/// SPFH and FPFH point by point over full neighbour lists, as the paper words them.
std::vector<Histogram> naive_fpfh(const BumpyCloud& cloud, double radius) {
  const std::size_t n = cloud.points.size();
  const auto near = [&](std::size_t i, std::size_t j) {
    return i != j && cloud.surface[i].valid && cloud.surface[j].valid &&
           (cloud.points[i] - cloud.points[j]).cast<double>().norm() <= radius;
  };
  std::vector<Histogram> simplified(n, Histogram::Zero());
  std::vector<int> num_neighbors(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (!near(i, j)) continue;
      const Bins bins = textbook_bins(
          textbook_feature(cloud.points[i].cast<double>(), cloud.surface[i].normal.cast<double>(),
                           cloud.points[j].cast<double>(), cloud.surface[j].normal.cast<double>()));
      for (int part = 0; part < 3; ++part)
        simplified[i][11 * part + bins[static_cast<std::size_t>(part)]] += 1.0;
      ++num_neighbors[i];
    }
    if (num_neighbors[i] > 0) simplified[i] *= 100.0 / num_neighbors[i];
  }
  std::vector<Histogram> out = simplified;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (!near(i, j)) continue;
      const double distance = (cloud.points[i] - cloud.points[j]).cast<double>().norm();
      out[i] += simplified[j] / distance / num_neighbors[i];
    }
    for (Eigen::Index part = 0; part < 3; ++part) {
      const double sum = out[i].segment<11>(11 * part).sum();
      if (sum > 0.0) out[i].segment<11>(11 * part) *= 100.0 / sum;
    }
  }
  return out;
}

TEST(Fpfh, AgreesWithANaiveOracle) {
  const float radius = 0.8F;
  const BumpyCloud cloud = bumpy_cloud(radius);
  const FpfhResult result = compute_fpfh(cloud.points, cloud.surface, cloud.pairs);
  const std::vector<Histogram> expected = naive_fpfh(cloud, radius);
  int num_different = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (std::size_t b = 0; b < kDescriptorSize; ++b) {
      const double difference = result.descriptors[i][b] - expected[i][static_cast<Eigen::Index>(b)];
      num_different += static_cast<int>(std::abs(difference) > 1.0);  // more than rounding to one per cent
    }
  }
  EXPECT_LE(num_different, 80);  // of 8250: where a pair lies on the border of a bin, in float
}

TEST(Fpfh, PointsWithoutNeighborsAreNotUsable) {
  const Points points = {{0.0F, 0.0F, 5.0F}, {9.0F, 0.0F, 5.0F}, {0.3F, 0.0F, 5.0F}};
  const NeighborPairs pairs = find_pairs_within(points, 1.0F);
  const FpfhResult result = compute_fpfh(points, estimate_surface(points, pairs, 1.0F), pairs);
  EXPECT_EQ(result.usable, std::vector<bool>(3, false));
  EXPECT_TRUE(compute_fpfh({}, {}, {}).descriptors.empty());
}

}  // namespace
}  // namespace adit
