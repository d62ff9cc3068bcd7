// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/place_comparer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "adit/fleet/sync/fleet_graph.hpp"
#include "adit/fleet/sync/own_map_parts.hpp"
#include "support/tube_drive.hpp"

namespace adit {
namespace {

using test::in_a_tube;

const std::vector<test::Box> kBlock = {{{29.0, 1.5, -4.0}, {31.0, 4.0, 4.0}}};
constexpr std::uint32_t kBesideTheBlock = 58;
constexpr float kIntensityOfPeer = 100.0F;

/// What robot 0 finds out about one of its places by what robot 1 sends of the same, of which those points
/// are left out.
ComparedPlace compared(const std::vector<test::Box>& boxes_of_peer,
                       const std::function<bool(const Eigen::Vector3f&)>& is_seen_by_peer,
                       PlaceQuestion question = PlaceQuestion::agreement) {
  auto own = std::make_shared<RobotMap>(*in_a_tube(kBlock));
  own->unconfirmed[kBesideTheBlock] = 0.06F;
  const auto theirs = in_a_tube(boxes_of_peer, {1});
  const AdaptiveConfig config;
  Discernment discernment(
      own, chain_of(graph_of(*own)), [] { return std::vector<LoopCandidate>(); },
      std::make_shared<FeatureStore>(own, config.registration, config.submap), config);
  PlaceComparer comparer(*own, discernment, config.registration);
  Clouds::Cloud cloud =
      clouds_of(*theirs, {{kBesideTheBlock}}, {config.registration.voxel_size, config.submap, config.view})
          .clouds[0];
  PointCloud seen;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!is_seen_by_peer(cloud.points[i])) continue;
    seen.points.push_back(cloud.points[i]);
    seen.intensities.push_back(kIntensityOfPeer);
  }
  cloud.unconfirmed = 0.22F;
  cloud.points = seen.points;
  cloud.intensities = seen.intensities;
  std::erase_if(cloud.beside, [&](const Eigen::Vector3f& p) { return !is_seen_by_peer(p); });
  return comparer
      .with_views({{kBesideTheBlock, kBesideTheBlock, Pose(), question}}, {{kBesideTheBlock, cloud}})
      .front();
}

bool everything(const Eigen::Vector3f& /*point*/) { return true; }
bool away_from_the_block(const Eigen::Vector3f& p) { return p.y() < 0.0F; }

TEST(PlaceComparer, APlaceBesideABlockThatBothSeeIsDistinctive) {
  const ComparedPlace place = compared(kBlock, everything);
  EXPECT_FALSE(place.differs());
  EXPECT_TRUE(place.is_distinctive);
  ASSERT_TRUE(place.signs);
  EXPECT_FALSE(place.signs->empty());
}

TEST(PlaceComparer, APlaceIsNotDistinctiveByWhatThePeersSensorCannotSee) {
  const ComparedPlace place = compared(kBlock, away_from_the_block);
  EXPECT_FALSE(place.differs());
  EXPECT_FALSE(place.is_distinctive) << "the smooth half of the tube looks alike five metres on";
  ASSERT_TRUE(place.signs);
  EXPECT_TRUE(place.signs->empty());
}

TEST(PlaceComparer, APlaceSaysWhatShareOfBothScansNothingConfirmed) {
  for (const bool has_block : {true, false}) {
    const ComparedPlace place = compared(has_block ? kBlock : std::vector<test::Box>(), everything);
    EXPECT_EQ(place.unconfirmed_own, 0.06F);
    EXPECT_EQ(place.unconfirmed_theirs, 0.22F);
  }
}

TEST(PlaceComparer, WallsKnowTheIntensitiesThatThePeerSent) {
  const ComparedPlace place = compared(kBlock, everything);
  ASSERT_FALSE(place.offsets.empty());
  for (const PatchOffset& offset : place.offsets) {
    ASSERT_NE(offset.by_known[1], 0.0);
    EXPECT_NEAR(offset.by_sensors[kErrorsOfSensor + kIntensityError] / offset.by_known[1],
                std::log10(static_cast<double>(kIntensityOfPeer)), 1e-6);
  }
}

TEST(PlaceComparer, ABlockThatOnlyOneTubeHasDiffers) {
  const ComparedPlace place = compared({}, everything);
  EXPECT_TRUE(place.differs());
  EXPECT_FALSE(place.signs) << "not asked of a place that differs";
  EXPECT_TRUE(compared({}, everything, PlaceQuestion::displacement).signs);
}

TEST(PlaceComparer, ABlockThatBothSeeShowsBesideOneThatOnlyThePeerSees) {
  std::vector<test::Box> with_another = kBlock;
  with_another.push_back({{27.0, -4.0, -4.0}, {28.5, -1.0, 4.0}});
  EXPECT_TRUE(compared(with_another, everything).differs());
  const ComparedPlace place = compared(with_another, everything, PlaceQuestion::displacement);
  ASSERT_TRUE(place.signs);
  EXPECT_FALSE(place.signs->empty());
}

TEST(PlaceComparer, OnlyWallsAreComparedWhereOnlyTheyAreAskedFor) {
  const ComparedPlace place = compared(kBlock, everything, PlaceQuestion::walls);
  EXPECT_FALSE(place.offsets.empty());
  EXPECT_FALSE(place.signs);
  EXPECT_FALSE(place.is_distinctive);
}

}  // namespace
}  // namespace adit
