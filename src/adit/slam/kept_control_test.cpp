// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/slam/kept_control.hpp"

#include <gtest/gtest.h>

namespace adit {
namespace {

/// A map with points of these names, on the robot of that name.
Georeference map_of(const std::string& robot, const std::string& crs, const std::vector<std::string>& names) {
  Georeference map;
  map.robots = {robot};
  map.crs = crs;
  for (const std::string& name : names) {
    JudgedControl judged;
    judged.point.name = name;
    judged.point.mark = {robot, Stamp{5}, Vector3(1.0, 2.0, 3.0)};
    map.points.push_back(judged);
  }
  return map;
}

std::vector<std::string> names_of(const KeptControl& kept) {
  std::vector<std::string> names;
  for (const ControlPoint& point : kept.points) names.push_back(point.name);
  return names;
}

TEST(KeptControl, PointsOfARobotThatTwoSessionsHoldCountOnce) {
  const EarlierGeoreferences session{"s", {map_of("ada", "EPSG:25833", {"T1", "T2", "T3"})}};
  const KeptControl twice = kept_control({session, session});
  EXPECT_EQ(names_of(twice), (std::vector<std::string>{"T1", "T2", "T3"}));
  EXPECT_EQ(twice.crs, "EPSG:25833");
  EXPECT_TRUE(twice.notes.empty()) << twice.notes.front();
  // Nobody asks for the system of points that are not new.
  const EarlierGeoreferences nameless{"n", {map_of("ada", "", {"T1"})}};
  EXPECT_EQ(kept_control({nameless, nameless}).points.size(), 1U);

  const EarlierGeoreferences other{
      "t", {map_of("ada", "EPSG:25833", {"P1", "T1"}), map_of("eve", "EPSG:25833", {"T1"})}};
  const KeptControl both = kept_control({session, other});
  EXPECT_EQ(names_of(both), (std::vector<std::string>{"T1", "T2", "T3", "T1"}));
  ASSERT_EQ(both.notes.size(), 1U);
  EXPECT_NE(both.notes[0].find("points P1 of t are left out"), std::string::npos) << both.notes[0];
}

TEST(KeptControl, ASessionOfSeveralMapsGoesOnWithoutANameOfItsSystem) {
  const std::vector<Georeference> maps = {map_of("ada", "", {"T1"}), map_of("eve", "", {"T2"})};
  const KeptControl one = kept_control({{"s", maps}});
  EXPECT_EQ(names_of(one), (std::vector<std::string>{"T1", "T2"}));
  EXPECT_TRUE(one.notes.empty());
}

TEST(KeptControl, SystemsOfSeveralSessionsAreNotTakenForOne) {
  const EarlierGeoreferences named{"s", {map_of("ada", "EPSG:25833", {"T1"})}};
  const EarlierGeoreferences nameless{"t", {map_of("eve", "", {"T2"})}};
  const EarlierGeoreferences another{"u", {map_of("kim", "", {"T3"})}};
  const auto note_of = [](const std::vector<EarlierGeoreferences>& sessions) {
    const KeptControl kept = kept_control(sessions);
    EXPECT_TRUE(kept.points.empty());
    EXPECT_EQ(kept.notes.size(), 1U);
    return kept.notes.empty() ? "" : kept.notes.front();
  };
  EXPECT_NE(note_of({named, nameless}).find("(s: EPSG:25833; t: no --crs was given)"), std::string::npos);
  EXPECT_NE(note_of({nameless, another}).find("(t: no --crs was given; u: no --crs"), std::string::npos);
}

}  // namespace
}  // namespace adit
