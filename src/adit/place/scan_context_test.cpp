// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/place/scan_context.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

constexpr double kSector = 2.0 * std::numbers::pi / 60.0;

/// Points near the middle of cells, so that rounding moves none to another cell; `share` of the cells seen.
PointCloud cell_cloud(Rng& rng, double share) {
  PointCloud cloud;
  for (int sector = 0; sector < 60; ++sector) {
    for (int ring = 0; ring < 20; ++ring) {
      if (rng.uniform() > share) continue;
      const double angle = (sector + rng.uniform(0.1, 0.9)) * kSector;
      const double radius = (ring + rng.uniform(0.1, 0.9)) * 4.0;
      cloud.points.emplace_back(static_cast<float>(radius * std::cos(angle)),
                                static_cast<float>(radius * std::sin(angle)),
                                static_cast<float>(rng.uniform(-1.0, 8.0)));
    }
  }
  return cloud;
}

PointCloud random_cloud(std::size_t n, Rng& rng) {
  PointCloud cloud;
  for (std::size_t i = 0; i < n; ++i) {
    const Vector3 p(rng.uniform(-90, 90), rng.uniform(-90, 90), rng.uniform(-3, 10));
    cloud.points.emplace_back(p.cast<float>());
  }
  return cloud;
}

/// The definition, cell by cell.
std::vector<float> heights_by_definition(const PointCloud& cloud, const ScanContextConfig& config) {
  std::vector<float> heights(static_cast<std::size_t>(config.num_rings * config.num_sectors), 0.0F);
  for (const Eigen::Vector3f& p : cloud.points) {
    const double radius = std::hypot(p.x(), p.y());
    if (radius > config.max_radius_m) continue;
    double angle = std::atan2(static_cast<double>(p.y()), static_cast<double>(p.x()));
    if (angle < 0.0) angle += 2.0 * std::numbers::pi;
    const int ring =
        std::min(static_cast<int>(radius / config.max_radius_m * config.num_rings), config.num_rings - 1);
    const int sector = std::min(static_cast<int>(angle / (2.0 * std::numbers::pi) * config.num_sectors),
                                config.num_sectors - 1);
    float& cell = heights[static_cast<std::size_t>(sector * config.num_rings + ring)];
    cell = std::max(cell, p.z() + static_cast<float>(config.height_offset_m));
  }
  return heights;
}

/// The distance of the paper at one shift, cell by cell.
double distance_by_definition(const ScanContext& query, const ScanContext& match, int shift) {
  double sum = 0.0;
  int shared = 0;
  for (int s = 0; s < query.num_sectors; ++s) {
    const int t = (s + shift) % query.num_sectors;
    double dot = 0.0;
    double q2 = 0.0;
    double m2 = 0.0;
    for (int r = 0; r < query.num_rings; ++r) {
      const double q = query.height(r, s);
      const double m = match.height(r, t);
      dot += q * m;
      q2 += q * q;
      m2 += m * m;
    }
    if (q2 == 0.0 || m2 == 0.0) continue;
    sum += dot / std::sqrt(q2 * m2);
    ++shared;
  }
  return shared == 0 ? 1.0 : 1.0 - sum / shared;
}

void expect_heights(const ScanContext& context, const std::vector<float>& heights, float tolerance) {
  for (int s = 0; s < context.num_sectors; ++s) {
    for (int r = 0; r < context.num_rings; ++r) {
      const float expected = heights[static_cast<std::size_t>(s * context.num_rings + r)];
      ASSERT_NEAR(context.height(r, s), expected, tolerance) << "ring " << r << " sector " << s;
    }
  }
}

TEST(ScanContext, HeightsFollowTheDefinition) {
  Rng rng(1);
  for (const auto& [rings, sectors] :
       {std::pair(20, 60), std::pair(1, 3), std::pair(7, 5), std::pair(40, 720)}) {
    const ScanContextConfig config{rings, sectors, 80.0, 2.0};
    const PointCloud cloud = random_cloud(20000, rng);
    expect_heights(describe(cloud, config), heights_by_definition(cloud, config), 1e-5F);
  }
}

TEST(ScanContext, KeysAreMeans) {
  Rng rng(2);
  const ScanContext context = describe(random_cloud(3000, rng), {});
  for (int r = 0; r < 20; ++r) {
    float sum = 0.0F;
    for (int s = 0; s < 60; ++s) sum += context.height(r, s);
    EXPECT_NEAR(context.ring_key[static_cast<std::size_t>(r)], sum / 60.0F, 1e-4F);
  }
  for (int s = 0; s < 60; ++s) {
    float sum = 0.0F;
    for (int r = 0; r < 20; ++r) sum += context.height(r, s);
    EXPECT_NEAR(context.sector_key[static_cast<std::size_t>(s)], sum / 20.0F, 1e-4F);
  }
}

TEST(ScanContext, PointsOnTheSeamsFallIntoOneCell) {
  const auto seen = [](float x, float y) {
    PointCloud cloud;
    cloud.points = {{x, y, 1.0F}};
    const ScanContext context = describe(cloud, {});
    std::pair<int, int> cell{-1, -1};
    int count = 0;
    for (int r = 0; r < 20; ++r) {
      for (int s = 0; s < 60; ++s) {
        if (context.height(r, s) == 0.0F) continue;
        cell = {r, s};
        ++count;
      }
    }
    EXPECT_LE(count, 1);
    return cell;
  };
  EXPECT_EQ(seen(10.0F, 0.0F), std::pair(2, 0));
  EXPECT_EQ(seen(10.0F, -0.0F), std::pair(2, 0));
  EXPECT_EQ(seen(10.0F, -1e-4F), std::pair(2, 59));
  EXPECT_EQ(seen(10.0F, -1e-30F).first, 2);
  EXPECT_EQ(seen(0.0F, 10.0F), std::pair(2, 15));
  EXPECT_EQ(seen(-10.0F, 1e-3F), std::pair(2, 29));
  EXPECT_EQ(seen(0.0F, -10.0F).first, 2);
  EXPECT_EQ(seen(0.0F, 0.0F).first, 0);
  EXPECT_EQ(seen(80.0F, 0.0F), std::pair(19, 0));
  EXPECT_EQ(seen(80.1F, 0.0F), std::pair(-1, -1));
}

TEST(ScanContext, BadPointsAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  PointCloud cloud;
  cloud.points = {{nan, 1, 1},      {1, nan, 1},       {1, 1, nan},   {infinity, 1, 1}, {1, infinity, 1},
                  {1, 1, infinity}, {1, 1, -infinity}, {1, 1, -2.5F}, {1e30F, 1e30F, 1}};
  EXPECT_TRUE(describe(cloud, {}).empty());
  EXPECT_TRUE(describe({}, {}).empty());
  EXPECT_TRUE(ScanContext{}.empty());
}

TEST(ScanContext, PointsAboveTheElevationAreLeftOutAsTheSensorSeesThem) {
  PointCloud cloud;
  cloud.points = {{10.0F, 0.0F, 2.0F}, {10.0F, 0.0F, 4.0F}};  // 5.7 and 16.7 degrees above a sensor at 1 m
  const auto highest = [&](double degrees, const Vector3& viewpoint) {
    return describe(cloud, {.max_elevation_deg = degrees}, viewpoint).height(2, 0);
  };
  EXPECT_EQ(highest(15.0, {0, 0, 1}), 4.0F);
  EXPECT_EQ(highest(17.0, {0, 0, 1}), 6.0F);
  EXPECT_EQ(highest(15.0, {-5, 0, 1}), 6.0F) << "from farther away it stands lower";
  EXPECT_EQ(highest(90.0, {0, 0, -100}), 6.0F) << "90 leaves out none";
  EXPECT_TRUE(describe(cloud, {.max_elevation_deg = 1.0}, {0, 0, 1}).empty());
}

TEST(ScanContext, TurningTheRobotShiftsTheMatch) {
  Rng rng(3);
  const PointCloud cloud_match = cell_cloud(rng, 0.4);
  const ScanContext match = describe(cloud_match, {});
  for (int k = 0; k < 60; ++k) {
    // The query's heading in the frame of the match is k sectors: T_match_query.
    const Pose T_match_query = Pose::planar(0, 0, k * kSector);
    const ScanContext query = describe(transformed(T_match_query.inverse(), cloud_match), {});
    const ContextMatch found = compare(query, match);
    EXPECT_EQ(found.shift, k);
    EXPECT_LT(found.distance, 1e-5);
    EXPECT_NEAR(found.yaw, T_match_query.yaw(), 1e-9);
    EXPECT_LT((Eigen::Map<const Eigen::VectorXf>(query.ring_key.data(), 20) -
               Eigen::Map<const Eigen::VectorXf>(match.ring_key.data(), 20))
                  .norm(),
              1e-4F);
  }
}

/// The nearest of all shifts.
ContextMatch compare_all_shifts(const ScanContext& query, const ScanContext& match) {
  ContextMatch best{2.0, 0, 0.0};
  for (int shift = 0; shift < query.num_sectors; ++shift) {
    const double distance = distance_at(query, match, shift);
    if (distance < best.distance) best = {distance, shift, yaw_of_shift(shift, query.num_sectors)};
  }
  return best;
}

TEST(ScanContext, DistanceIsSymmetricUpToTheSignOfTheTurn) {
  Rng rng(4);
  const ScanContext a = describe(cell_cloud(rng, 0.3), {});
  const ScanContext b = describe(cell_cloud(rng, 0.3), {});
  EXPECT_NEAR(compare_all_shifts(a, b).distance, compare_all_shifts(b, a).distance, 1e-6);
  EXPECT_EQ(compare_all_shifts(a, b).shift, (60 - compare_all_shifts(b, a).shift) % 60);
}

TEST(ScanContext, DistanceFollowsTheDefinition) {
  Rng rng(5);
  for (const double share : {0.02, 0.1, 0.5, 1.0}) {
    const ScanContext a = describe(cell_cloud(rng, share), {});
    const ScanContext b = describe(cell_cloud(rng, share), {});
    for (int shift = 0; shift < 60; ++shift)
      EXPECT_NEAR(distance_at(a, b, shift), distance_by_definition(a, b, shift), 1e-5) << shift;
    const ContextMatch aligned = compare(a, b);
    EXPECT_NEAR(aligned.distance, distance_by_definition(a, b, aligned.shift), 1e-5);
    EXPECT_GE(aligned.distance, compare_all_shifts(a, b).distance);
  }
}

/// Where the sector keys are nearest, by a plain loop.
int aligned_by_definition(const ScanContext& query, const ScanContext& match) {
  int best = 0;
  double greatest = -1.0;
  for (int shift = 0; shift < query.num_sectors; ++shift) {
    double product = 0.0;
    for (int s = 0; s < query.num_sectors; ++s)
      product +=
          static_cast<double>(query.sector_key[static_cast<std::size_t>(s)]) *
          static_cast<double>(match.sector_key[static_cast<std::size_t>((s + shift) % query.num_sectors)]);
    if (product > greatest) {
      greatest = product;
      best = shift;
    }
  }
  return best;
}

// Whole heights, so that products are exact and ties are ties.
TEST(ScanContext, GridsOfAnySizeAreComparedByTheDefinition) {
  Rng rng(8);
  for (const auto& [rings, sectors] :
       {std::pair(1, 3), std::pair(7, 5), std::pair(3, 61), std::pair(8, 16), std::pair(40, 720)}) {
    const auto random_context = [&, rings = rings, sectors = sectors] {
      std::vector<float> heights;
      for (int i = 0; i < rings * sectors; ++i)
        heights.push_back(static_cast<float>(rings * static_cast<int>(rng.below(4))));
      return from_heights(rings, sectors, heights);
    };
    for (int trial = 0; trial < 20; ++trial) {
      const ScanContext a = random_context();
      const ScanContext b = random_context();
      for (const int shift : {0, 1, sectors / 2, sectors - 1})
        EXPECT_NEAR(distance_at(a, b, shift), distance_by_definition(a, b, shift), 1e-5);
      const int reach = static_cast<int>(std::lround(0.05 * sectors));
      const int off = std::abs(compare(a, b).shift - aligned_by_definition(a, b));
      EXPECT_LE(std::min(off, sectors - off), reach) << rings << " x " << sectors;
    }
  }
}

TEST(ScanContext, NoSharedSectorIsDistanceOne) {
  std::vector<float> heights(20 * 60, 0.0F);
  const ScanContext nothing = from_heights(20, 60, heights);
  heights[0] = 3.0F;
  const ScanContext one_cell = from_heights(20, 60, heights);
  EXPECT_EQ(compare(nothing, one_cell).distance, 1.0);
  EXPECT_EQ(compare(nothing, nothing).distance, 1.0);
  EXPECT_EQ(compare(one_cell, one_cell).distance, 0.0);
  std::vector<float> other_ring(20 * 60, 0.0F);
  other_ring[1] = 3.0F;  // The same sector seen at another range: compared, and nothing alike.
  EXPECT_EQ(compare(one_cell, from_heights(20, 60, other_ring)).distance, 1.0);
  EXPECT_EQ(compare(one_cell, from_heights(20, 60, other_ring)).shift, 0);  // Ties go to the smallest shift.
}

TEST(ScanContext, GridsOfDifferentSizeAreABug) {
  const ScanContext a = from_heights(1, 3, std::vector<float>{1, 2, 3});
  const ScanContext b = from_heights(3, 1, std::vector<float>{1, 2, 3});
  EXPECT_THROW(static_cast<void>(compare(a, b)), ContractViolation);
  EXPECT_THROW(static_cast<void>(compare(ScanContext{}, ScanContext{})), ContractViolation);
  EXPECT_THROW(static_cast<void>(from_heights(1, 2, std::vector<float>{1, -1})), ContractViolation);
  EXPECT_THROW(static_cast<void>(from_heights(1, 2, std::vector<float>{1})), ContractViolation);
  EXPECT_THROW(static_cast<void>(describe({}, {.num_sectors = 0})), ContractViolation);
}

TEST(ScanContext, OneByteACellKeepsTheDistance) {
  Rng rng(6);
  const ScanContext a = describe(cell_cloud(rng, 0.3), {});
  const ScanContext b = describe(cell_cloud(rng, 0.3), {});
  const std::vector<std::uint8_t> bytes = encode(a);
  EXPECT_EQ(bytes.size(), 1207U);
  const ScanContext decoded = decode(bytes).value();
  for (int s = 0; s < 60; ++s) {
    for (int r = 0; r < 20; ++r) {
      EXPECT_NEAR(decoded.height(r, s), a.height(r, s), 10.0F / 255.0F);
      EXPECT_EQ(decoded.height(r, s) > 0.0F, a.height(r, s) > 0.0F);
    }
  }
  EXPECT_NEAR(compare(decoded, b).distance, compare(a, b).distance, 1e-3);
  EXPECT_EQ(encode(decoded), bytes);
}

TEST(ScanContext, DecodeRefusesOtherBytes) {
  std::vector<std::uint8_t> bytes = encode(describe({}, {}));
  EXPECT_TRUE(decode(bytes)->empty());
  bytes.pop_back();
  EXPECT_FALSE(decode(bytes));
  EXPECT_FALSE(decode({}));
  EXPECT_FALSE(decode(std::vector<std::uint8_t>(7, 0)));
  EXPECT_FALSE(decode(std::vector<std::uint8_t>(5, 255)));
}

}  // namespace
}  // namespace adit
