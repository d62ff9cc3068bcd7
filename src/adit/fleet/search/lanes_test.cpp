// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/search/lanes.hpp"

#include <gtest/gtest.h>

#include "support/synthetic_scan.hpp"

namespace adit {
namespace {

constexpr ScanContextConfig kContext{.max_radius_m = 25.0};

// In a tube with a block on its left side, from the middle and from one metre to the left of it.
ScanContext seen_from(double y, std::shared_ptr<const PointCloud>* cloud = nullptr) {
  test::Scene scene = test::smooth_tube();
  scene.boxes = {{{6.0, 1.5, -2.0}, {8.0, 4.0, 1.0}}};
  const PointCloud scan =
      test::scan_of(scene, {32, 256, 0.6, 40.0, 0.0}, Pose(), {Pose::planar(0.0, y, 0.0), Vector6::Zero()}, 0)
          .cloud;
  if (cloud != nullptr) *cloud = std::make_shared<const PointCloud>(scan);
  return describe(scan, kContext);
}

RobotMap one_keyframe() {
  RobotMap map;
  map.scan_context = kContext;
  std::shared_ptr<const PointCloud> cloud;
  map.places.push_back(seen_from(0.0, &cloud));
  map.keyframes.push_back({{{0}, 0}, {0}, Pose(), cloud});
  return map;
}

const Lanes kLanes{1, 1.0};

TEST(Lanes, AContextFromBesideIsNearerToWhatIsSeenThere) {
  const std::vector<ScanContext> contexts = contexts_from(kLanes, one_keyframe(), 0);
  ASSERT_EQ(contexts.size(), 3U);  // driven, right, left
  const ScanContext there = seen_from(1.0);
  const auto distance = [&](std::size_t lane) { return compare(contexts[lane], there).distance; };
  EXPECT_LT(distance(2), distance(0));
}

TEST(Lanes, WithoutAnyBesideOnlyTheDrivenOneIsLookedFrom) {
  const RobotMap map = one_keyframe();
  const std::vector<ScanContext> contexts = contexts_from({}, map, 0);
  ASSERT_EQ(contexts.size(), 1U);
  EXPECT_EQ(compare(contexts[0], map.places[0]).distance, 0.0);
}

TEST(Lanes, APlaceFoundFromSeveralIsNamedOnceWithItsSmallestDistance) {
  int num_asked = 0;
  const auto find = [&](const ScanContext&) -> std::optional<LoopCandidate> {
    ++num_asked;
    if (num_asked == 2) return {};
    return LoopCandidate{{{0}, 0}, {{1}, 7}, 0.0, num_asked == 3 ? 0.1 : 0.3};
  };
  const std::vector<LoopCandidate> found = most_similar_from(kLanes, one_keyframe(), 0, find);
  EXPECT_EQ(num_asked, 3);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].match.index, 7U);
  EXPECT_EQ(found[0].distance, 0.1);
}

}  // namespace
}  // namespace adit
