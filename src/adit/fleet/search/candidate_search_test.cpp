// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/candidate_search.hpp"

#include <gtest/gtest.h>

#include "adit/core/rng.hpp"
#include "adit/odometry/path_uncertainty.hpp"

namespace adit {
namespace {

constexpr RobotId kSearching{0};
constexpr RobotId kSearched{1};

ScanContext a_random_place(Rng& rng) {
  const ScanContextConfig grid;
  std::vector<float> heights(static_cast<std::size_t>(grid.num_rings * grid.num_sectors));
  for (float& height : heights) height = static_cast<float>(rng.uniform(0.5, 5.0));
  return from_heights(grid.num_rings, grid.num_sectors, heights);
}

/// A straight drive of `num` keyframes, two metres apart, past places of which no two are alike but those
/// that are named.
struct StraightDrive {
  std::shared_ptr<RobotMap> map = std::make_shared<RobotMap>();
  OdometryChain chain;

  explicit StraightDrive(std::size_t num, const std::vector<std::pair<std::size_t, std::size_t>>& alike = {})
      : chain(made(num, alike)) {}

  [[nodiscard]] CandidateSearch search(const SearchConfig& config) const {
    return {map, chain, PlaceIndexConfig(), config};
  }

 private:
  OdometryChain made(std::size_t num, const std::vector<std::pair<std::size_t, std::size_t>>& alike) {
    Rng rng(7);
    std::vector<Pose> poses;
    map->id = kSearching;
    for (std::size_t k = 0; k < num; ++k) {
      poses.push_back(Pose::planar(2.0 * static_cast<double>(k), 0.0, 0.0));
      map->keyframes.push_back({{kSearching, static_cast<std::uint32_t>(k)}, {}, poses.back(), nullptr});
      map->places.push_back(a_random_place(rng));
    }
    for (const auto& [one, other] : alike) map->places[other] = map->places[one];
    return {poses, std::vector<Matrix6>(num - 1, random_walk({}, 2.0))};
  }
};

LoopCandidate found_candidate(std::uint32_t query, std::uint32_t match, double distance) {
  return {{kSearching, query}, {kSearched, match}, 0.0, distance};
}

std::vector<std::uint32_t> queries_of(const std::vector<LoopCandidate>& candidates) {
  std::vector<std::uint32_t> out;
  for (const LoopCandidate& c : candidates) out.push_back(c.query.index);
  return out;
}

TEST(SelfSimilarity, FindsThePlaceThatLooksAlikeAndNotTheOneBeside) {
  const StraightDrive drive(60, {{10, 40}, {20, 22}});
  const SelfSimilarity self(drive.map, drive.chain, PlaceIndexConfig());
  const auto there = self.most_similar(10);
  ASSERT_TRUE(there);
  EXPECT_EQ(there->match.index, 40U);
  EXPECT_NEAR(there->distance, 0.0, 1e-6);
  const std::vector<double> distances = self.distances();
  EXPECT_NEAR(distances[40], 0.0, 1e-6);
  EXPECT_GT(distances[20], 0.05);  // its like is four metres on: the same place
}

TEST(CandidateSearch, PlacesThatLookLikeOthersOfTheOwnMapComeLast) {
  const StraightDrive drive(60, {{10, 40}});
  const std::vector<LoopCandidate> found = {found_candidate(10, 5, 0.02), found_candidate(30, 9, 0.03)};
  SearchConfig config;
  EXPECT_EQ(queries_of(drive.search(config).most_promising(found)), (std::vector{30U, 10U}));
  config.stand_out = false;
  EXPECT_EQ(queries_of(drive.search(config).most_promising(found)), (std::vector{10U, 30U}));
}

TEST(CandidateSearch, TakesAFewOfEachPlaceAndNoMoreThanAreAskedFor) {
  const StraightDrive drive(60);
  std::vector<LoopCandidate> found;
  for (std::uint32_t k = 0; k < 60; ++k) found.push_back(found_candidate(k, k, 0.001 * (k + 1)));
  SearchConfig config;
  config.stand_out = false;
  config.of_a_place = 2;
  config.place_keyframes = 10;
  config.candidates = 5;
  EXPECT_EQ(queries_of(drive.search(config).most_promising(found)), (std::vector{0U, 1U, 10U, 11U, 20U}));
}

TEST(CandidateSearch, AKeyframeIsTakenOnceFromItsBestLane) {
  const std::vector<LoopCandidate> chosen =
      StraightDrive(30).search({}).most_promising({found_candidate(4, 8, 0.3), found_candidate(4, 7, 0.1)});
  ASSERT_EQ(chosen.size(), 1U);
  EXPECT_EQ(chosen[0].match.index, 7U);
}

}  // namespace
}  // namespace adit
