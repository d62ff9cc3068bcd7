// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/robot/robot_map.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr std::uint32_t kKeyframes = 12;

Vector6 random_twist(Rng& rng, double size) {
  Vector6 xi;
  for (int i = 0; i < 6; ++i) xi[i] = rng.uniform(-size, size);
  return xi;
}

Matrix6 random_covariance(Rng& rng) {
  Matrix6 root;
  for (int i = 0; i < 36; ++i) root(i / 6, i % 6) = rng.uniform(-0.1, 0.1);
  return root * root.transpose() + 1e-4 * Matrix6::Identity();
}

constexpr TunnelFilterConfig kFilter{.width_threshold_m = 2.0};

/// The corners of a box of that width and height.
std::shared_ptr<const PointCloud> box(float width_m) {
  auto cloud = std::make_shared<PointCloud>();
  for (const float x : {-5.0F, 5.0F})
    for (const float y : {-width_m / 2.0F, width_m / 2.0F})
      for (const float z : {0.0F, width_m}) cloud->points.emplace_back(x, y, z);
  return cloud;
}

/// A winding drive in space with full covariances; the keyframes in `tunnel` are tunnel-like by `kFilter`,
/// the last of them as it saw nothing.
RobotMap winding_drive(const std::vector<std::uint32_t>& tunnel) {
  Rng rng(17);
  RobotMap map;
  map.id = {3};
  map.name = "robot_3";
  map.num_degenerate = 4;
  map.num_refused = 5;
  Pose T_odom_base = Pose::exp(random_twist(rng, 2.0));
  for (std::uint32_t k = 0; k < kKeyframes; ++k) {
    map.step_covariances.push_back(k == 0 ? Matrix6(Matrix6::Zero()) : random_covariance(rng));
    map.pose_noise.push_back(random_covariance(rng));
    if (k > 0) T_odom_base = T_odom_base * Pose::exp(random_twist(rng, 1.0));
    const Stamp stamp{k * 100};
    map.keyframes.push_back({{map.id, k}, stamp, T_odom_base, nullptr});
    if (std::ranges::find(tunnel, k) == tunnel.end())
      map.keyframes.back().cloud = box(4.0F);
    else
      map.keyframes.back().cloud = k == tunnel.back() ? std::make_shared<const PointCloud>() : box(1.0F);
    map.places.push_back(from_heights(2, 3, std::vector<float>(6, static_cast<float>(k) + 1.0F)));
    map.searchable.push_back(true);
    map.unconfirmed.push_back(0.0F);
    map.odometry.push_back({stamp, T_odom_base});
  }
  return map;
}

/// Covariance of T_a_b to first order, by brute force: each step's error carried through the product of all
/// steps by central differences.
Matrix6 dense_covariance(const RobotMap& map, std::size_t a, std::size_t b) {
  const auto product = [&](std::size_t disturbed, const Vector6& error) {
    Pose T;
    for (std::size_t k = a + 1; k <= b; ++k) {
      T = T * (map.keyframes[k - 1].T_odom_base.inverse() * map.keyframes[k].T_odom_base);
      if (k == disturbed) T = T * Pose::exp(error);
    }
    return T;
  };
  const Pose T_b_a = product(0, Vector6::Zero()).inverse();
  Matrix6 total = Matrix6::Zero();
  for (std::size_t k = a + 1; k <= b; ++k) {
    Matrix6 J;
    for (int i = 0; i < 6; ++i) {
      const Vector6 error = 1e-5 * Vector6::Unit(i);
      J.col(i) = ((T_b_a * product(k, error)).log() - (T_b_a * product(k, -error)).log()) / 2e-5;
    }
    total += J * map.step_covariances[k] * J.transpose();
  }
  return total;
}

TEST(RobotMap, CovariancesComposeOverTheGapsThatTunnelKeyframesLeave) {
  const RobotMap map = winding_drive({0, 3, 4, 5, 8, 11});
  const std::vector<std::size_t> kept = {1, 2, 6, 7, 9, 10};
  const RobotMap selected = select_keyframes(map, KeyframeSelection::tunnel_filter, kFilter);
  ASSERT_EQ(selected.keyframes.size(), kept.size());
  EXPECT_TRUE(selected.step_covariances[0].isZero());
  for (std::size_t i = 1; i < kept.size(); ++i) {
    const Matrix6 expected = dense_covariance(map, kept[i - 1], kept[i]);
    EXPECT_LT((selected.step_covariances[i] - expected).norm(), 1e-7 * expected.norm()) << i;
  }
}

TEST(RobotMap, KeyframesThatStayAreNumberedAnewAndKeepTheirContent) {
  const RobotMap map = winding_drive({0, 3, 4, 5, 8, 11});
  const std::vector<std::size_t> kept = {1, 2, 6, 7, 9, 10};
  const RobotMap selected = select_keyframes(map, KeyframeSelection::tunnel_filter, kFilter);
  ASSERT_EQ(selected.keyframes.size(), kept.size());
  for (std::uint32_t i = 0; i < kept.size(); ++i) {
    EXPECT_EQ(selected.keyframes[i].id, (KeyframeId{{3}, i}));
    EXPECT_EQ(selected.keyframes[i].stamp, map.keyframes[kept[i]].stamp);
    EXPECT_EQ(selected.keyframes[i].cloud, map.keyframes[kept[i]].cloud);
    EXPECT_EQ(selected.places[i].norms, map.places[kept[i]].norms);
    EXPECT_TRUE(selected.searchable[i]);
  }
  EXPECT_EQ(selected.name, map.name);
  EXPECT_EQ(selected.odometry.size(), map.odometry.size());
  EXPECT_EQ(selected.num_degenerate, 4);
  EXPECT_EQ(selected.num_refused, 5);
}

TEST(RobotMap, AllKeyframesTunnelLikeLeaveAnEmptyMap) {
  std::vector<std::uint32_t> everyone(kKeyframes);
  for (std::uint32_t k = 0; k < kKeyframes; ++k) everyone[k] = k;
  const RobotMap selected =
      select_keyframes(winding_drive(everyone), KeyframeSelection::tunnel_filter, kFilter);
  EXPECT_TRUE(selected.keyframes.empty());
  EXPECT_TRUE(selected.step_covariances.empty());
  EXPECT_EQ(selected.name, "robot_3");
}

TEST(RobotMap, KeepingTunnelKeyframesOnlyBarsThemFromTheSearch) {
  const RobotMap map = winding_drive({2, 7});
  const RobotMap kept = select_keyframes(map, KeyframeSelection::tunnel_filter_keep, kFilter);
  const RobotMap all = select_keyframes(kept, KeyframeSelection::all, kFilter);
  ASSERT_EQ(kept.keyframes.size(), kKeyframes);
  for (std::uint32_t k = 0; k < kKeyframes; ++k) {
    EXPECT_EQ(kept.searchable[k], k != 2 && k != 7);
    EXPECT_TRUE(all.searchable[k]);
    EXPECT_EQ(kept.step_covariances[k], map.step_covariances[k]);
    EXPECT_EQ(kept.pose_noise[k], map.pose_noise[k]);
  }
}

TEST(RobotMap, SelectionsAreReadFromTheirNames) {
  for (const KeyframeSelection selection :
       {KeyframeSelection::all, KeyframeSelection::tunnel_filter, KeyframeSelection::tunnel_filter_keep}) {
    EXPECT_EQ(keyframe_selection(to_string(selection)), selection);
  }
  EXPECT_NE(keyframe_selection("tunnel").error().message.find("tunnel_filter_keep"), std::string::npos);
}

TEST(RobotMap, TheMeanShareIsThatOfScansThatWereJudged) {
  const std::vector<std::optional<float>> shares = {0.25F, std::nullopt, 0.75F, 0.5F};
  EXPECT_EQ(mean_of_judged(shares), 0.5);
  EXPECT_FALSE(mean_of_judged(std::vector<std::optional<float>>(3)));
  EXPECT_FALSE(mean_of_judged({}));
}

}  // namespace
}  // namespace adit
