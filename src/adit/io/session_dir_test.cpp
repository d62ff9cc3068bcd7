// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/session_dir.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <sstream>

#include "adit/core/format.hpp"
#include "adit/io/session_toml.hpp"
#include "support/files.hpp"

namespace adit {
namespace {

using test::get_file;
using test::put_file;
using test::TemporaryFolder;

constexpr std::uint32_t kNum = 20;

std::shared_ptr<const RobotMap> straight_map(RobotId id, const std::string& name) {
  RobotMap map;
  map.id = id;
  map.name = name;
  for (std::uint32_t k = 0; k < kNum; ++k) {
    const Stamp stamp{1'000'000'000LL * (k + 1)};
    const Pose pose = Pose::translation_of(k, 0, 0);
    map.keyframes.push_back({{id, k}, stamp, pose, std::make_shared<PointCloud>()});
    map.odometry.push_back({stamp, pose});
  }
  return std::make_shared<const RobotMap>(std::move(map));
}

void add_loop(FleetGraph& fleet, std::uint32_t a, std::uint32_t b, double along_m, LoopVerdict verdict) {
  LoopClosure loop;
  loop.from = {{0}, a};
  loop.to = {{1}, b};
  loop.T_from_to = Pose::translation_of(along_m, 1, 0);
  loop.verdict = verdict;
  loop.reason = verdict == LoopVerdict::accepted ? "70 inliers, overlap 0.93" : "4 inliers, 10 needed";
  fleet.loops[{loop.from, loop.to}] = loop;
}

/// Three loops that a test accepted, two that it refuted, one that could not be registered.
Session session_of_two() {
  Session session;
  session.maps = {straight_map({0}, "ada"), straight_map({1}, "bo")};
  for (const auto& map : session.maps) {
    RobotGraph& graph = session.fleet.robots[map->id];
    graph.name = map->name;
    for (const Keyframe& k : map->keyframes)
      graph.nodes.push_back({k.stamp, k.T_odom_base, Matrix6::Identity() * 1e-4});
  }
  MergeCheck check{{0}, {1}, 12.5, 9.21, 10, 10, true, {{2, 2}, {6, 6}, {9, 9}}, "10 of 10 places agree"};
  check.hypotheses = {{HypothesisOutcome::accepted, 12.5, 10, 10, 0.0, check.loops},
                      {HypothesisOutcome::refuted, -4.0, 8, 3, 5.0, {{3, 8}, {4, 9}}}};
  check.hypotheses[1].counts = {1, 3, 2, 456, 123.5, 0.75, 0.0625};
  session.fleet.checks[{{0}, {1}}] = check;
  for (const auto& [a, b] : check.loops) add_loop(session.fleet, a, b, 0.0, LoopVerdict::accepted);
  for (const auto& [a, b] : check.hypotheses[1].loops)
    add_loop(session.fleet, a, b, 0.0, LoopVerdict::accepted);
  add_loop(session.fleet, 11, 3, 0.0, LoopVerdict::rejected);
  session.solution = solve(session.fleet, {});
  return session;
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    std::replace(line.begin(), line.end(), ',', '\n');
    std::istringstream cells(line + "\n");
    std::vector<std::string>& row = rows.emplace_back();
    for (std::string cell; std::getline(cells, cell);) row.push_back(cell);
  }
  return rows;
}

TEST(SessionDir, EveryCandidateSaysWhyItIsInTheSolutionOrNot) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_session(folder.path(), session_of_two(), MapFiles::leave_out));
  const auto rows = cells_of(get_file(folder / "loops.csv"));
  ASSERT_EQ(rows.size(), 7U);
  const auto column = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(rows[0], name) - rows[0].begin());
  };
  std::size_t num_of_first = 0;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    ASSERT_EQ(rows[r].size(), rows[0].size());
    const std::string& hypothesis = rows[r][column("hypothesis")];
    const std::string& reason = rows[r][column("reason")];
    EXPECT_EQ(rows[r][column("merge_check")], "accepted");
    if (hypothesis == "1") {
      EXPECT_EQ(reason, "in use: scans agree at 10 of 10 places along hypothesis 1");
      EXPECT_EQ(rows[r][column("registration")], "70 inliers; overlap 0.93");
      ++num_of_first;
    } else {
      EXPECT_EQ(reason, hypothesis == "2" ? "not in use: scans differ at 5 of 8 places along hypothesis 2"
                                          : "not registered: 4 inliers; 10 needed");
    }
  }
  EXPECT_EQ(num_of_first, 3U);
}

TEST(SessionDir, TheProvenanceSaysWhatKindOfDifferenceARefusalIsAndWhereToDrive) {
  const TemporaryFolder folder;
  Session session = session_of_two();
  MergeCheck& check = session.fleet.checks.at({{0}, {1}});
  check.accepted = false;
  check.refused_kind = RefusalKind::too_little;
  check.advice = MergeAdvice{143.5, 183.25, {51.25, -8.0, 0.5}, 5.25, 4.0};
  ASSERT_TRUE(write_session(folder.path(), session, MapFiles::leave_out));
  const std::string toml = get_file(folder / "session.toml");
  for (const char* part : {"refused_kind = 'too little'", "from_m = 143.5", "to_m = 183.25",
                           "from = [ 51.25, -8.0, 0.5 ]", "gain = 5.25", "missing = 4.0"})
    EXPECT_NE(toml.find(part), std::string::npos) << part << "\n" << toml;
}

TEST(SessionDir, TheProvenanceListsTheHypotheses) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_session(folder.path(), session_of_two(), MapFiles::leave_out));
  const std::string toml = get_file(folder / "session.toml");
  for (const char* part :
       {"'10 of 10 places agree'", "outcome = 'accepted'", "outcome = 'refuted'", "places_compared = 8",
        "places_differing = 5", "compared_m = 123.5", "changes = 3", "from_best_m = 5.0", "[ 3, 8 ]"})
    EXPECT_NE(toml.find(part), std::string::npos) << part << "\n" << toml;
}

TEST(SessionDir, MergesAreReadBackAsTheyWereTested) {
  Session session = session_of_two();
  MergeCheck& check = session.fleet.checks.at({{0}, {1}});
  check.accepted = false;
  check.refused_kind = RefusalKind::too_little;
  check.advice = MergeAdvice{143.5, 183.25, {51.25, -8.0, 0.5}, 5.25, 4.0};
  session.solution = solve(session.fleet, {});
  MergeCheck revisits = check;
  revisits.b = revisits.a;
  revisits.accepted = true;
  session.fleet.checks[{{0}, {0}}] = revisits;
  const Result<std::vector<SavedMerge>> merges = parse_session_merges(session_toml(session));
  ASSERT_TRUE(merges.has_value()) << merges.error().message;
  ASSERT_EQ(merges->size(), 2U);
  const SavedMerge& merge = merges->front();
  EXPECT_EQ(merge.a + " " + merge.b, "ada bo");
  EXPECT_FALSE(merge.merged);
  EXPECT_FALSE(merge.refusal.empty());
  EXPECT_EQ(merge.check.reason, check.reason);
  EXPECT_EQ(merge.check.refused_kind, RefusalKind::too_little);
  EXPECT_EQ(merge.check.needed, check.needed);
  EXPECT_EQ(merge.check.loops, check.loops);
  ASSERT_TRUE(merge.check.advice.has_value());
  EXPECT_EQ(merge.check.advice->from, check.advice->from);
  EXPECT_EQ(merge.check.advice->gain, 5.25);
  ASSERT_EQ(merge.check.hypotheses.size(), 2U);
  const MergeHypothesis& second = merge.check.hypotheses[1];
  EXPECT_EQ(second.outcome, HypothesisOutcome::refuted);
  EXPECT_EQ(second.num_differing(), 5U);
  EXPECT_EQ(second.from_best_m, 5.0);
  EXPECT_EQ(second.counts.num_wall_patches, 456U);
  EXPECT_EQ(second.counts.equal_signs, 0.75);
  EXPECT_EQ(merges->back().a, merges->back().b);
  EXPECT_TRUE(merges->back().check.accepted);
}

TEST(SessionDir, TheProvenanceSaysWhatShareOfTheReturnsNothingConfirmed) {
  Session session = session_of_two();
  auto dusty = std::make_shared<RobotMap>(*session.maps[0]);
  dusty->unconfirmed.assign(kNum, 0.125F);
  dusty->unconfirmed.front().reset();
  session.maps[0] = dusty;
  for (const auto& map : session.maps)
    session.provenance.robots.push_back({map->name, "plane-icp", "", 12, ""});
  session.fleet.checks.at({{0}, {1}}).unconfirmed = {0.0626, std::nullopt};
  const std::string toml = session_toml(session);
  EXPECT_NE(toml.find("unconfirmed = 0.125"), std::string::npos) << toml;
  EXPECT_EQ(toml.find("unconfirmed = "), toml.rfind("unconfirmed = ")) << "bo was not judged";
  EXPECT_NE(toml.find("unconfirmed_a = 0.063"), std::string::npos) << toml;
  EXPECT_EQ(toml.find("unconfirmed_b"), std::string::npos) << toml;
  const Result<std::vector<SavedMerge>> merges = parse_session_merges(toml);
  ASSERT_TRUE(merges) << merges.error().message;
  EXPECT_EQ(merges->front().check.unconfirmed.a, 0.063);
  EXPECT_FALSE(merges->front().check.unconfirmed.b);
}

TEST(SessionDir, TheProvenanceSaysWhereTheLidarSits) {
  Session session = session_of_two();
  const Pose mount(so3::exp({0.02, -0.3, 1.1}), {0.3, -0.1, 0.9});
  session.provenance.robots = {{"ada", "plane-icp", "", 12, "", mount}, {"bo", "plane-icp", "", 12, ""}};
  const std::string toml = session_toml(session);
  const Result<SessionHeader> header = parse_session_toml(toml);
  ASSERT_TRUE(header) << header.error().message;
  ASSERT_EQ(header->provenance.robots.size(), 2U);
  const std::optional<Pose>& read = header->provenance.robots[0].T_base_lidar;
  ASSERT_TRUE(read) << toml;
  EXPECT_LT((read->inverse() * mount).log().norm(), 1e-12);
  EXPECT_FALSE(header->provenance.robots[1].T_base_lidar);
  const Result<SessionHeader> edited = parse_session_toml("[[mapping]]\nname = 'ada'\nmount = '0.3 0'\n");
  ASSERT_TRUE(edited) << edited.error().message;
  EXPECT_FALSE(edited->provenance.robots.at(0).T_base_lidar);
}

TEST(SessionDir, ARulingIsNoOutcomeOfTheTest) {
  Session session = session_of_two();
  MergeCheck& check = session.fleet.checks.at({{0}, {1}});
  check.accepted = false;  // as slam_on leaves it after a veto
  check.refused_kind = RefusalKind::vetoed;
  check.hypotheses.front().outcome = HypothesisOutcome::vetoed;
  check.reason = "a person keeps these maps apart; the test had said: 10 of 10 places agree";
  const std::string toml = session_toml(session);
  for (const char* part : {"refused_kind = 'vetoed'", "outcome = 'vetoed'", "outcome = 'refuted'"})
    EXPECT_NE(toml.find(part), std::string::npos) << part << "\n" << toml;
  const Result<std::vector<SavedMerge>> merges = parse_session_merges(toml);
  ASSERT_TRUE(merges) << merges.error().message;
  const MergeCheck& read = merges->front().check;
  EXPECT_EQ(read.refused_kind, RefusalKind::vetoed);
  EXPECT_EQ(read.hypotheses[0].outcome, HypothesisOutcome::vetoed);
  EXPECT_EQ(read.hypotheses[1].outcome, HypothesisOutcome::refuted) << "what the test found stays";

  check.accepted = true;
  check.hypotheses.front().outcome = HypothesisOutcome::accepted;
  check.reason = "a person confirmed this merge";
  EXPECT_EQ(session_toml(session).find("vetoed"), std::string::npos);
}

TEST(SessionDir, WhatIsNoIntegerIsNoCount) {
  const auto scans = [](const std::string& written) {
    const Result<SessionHeader> header =
        parse_session_toml("[[mapping]]\nname = 'ada'\nscans = " + written + "\n");
    return header ? header->provenance.robots.at(0).scans : 1U;
  };
  EXPECT_EQ(scans("12"), 12U);
  for (const char* written : {"1e300", "-1e300", "inf", "nan", "2.5", "-3", "'12'"})
    EXPECT_EQ(scans(written), 0U) << written;
}

TEST(SessionDir, APairIsListedAlsoWhereNothingWasTested) {
  Session session = session_of_two();
  session.fleet.checks.clear();
  for (const MergePolicy policy : {MergePolicy::adaptive, MergePolicy::paper}) {
    session.fleet.policy = policy;
    session.solution = solve(session.fleet, {});
    const Result<std::vector<SavedMerge>> merges = parse_session_merges(session_toml(session));
    ASSERT_TRUE(merges.has_value()) << merges.error().message;
    ASSERT_EQ(merges->size(), 1U);
    EXPECT_TRUE(merges->front().check.hypotheses.empty());
    EXPECT_EQ(merges->front().merged, policy == MergePolicy::paper) << "PCM needs no test";
    EXPECT_EQ(merges->front().share_a_map, merges->front().merged);
    EXPECT_EQ(merges->front().refusal.empty(), merges->front().merged);
  }
  EXPECT_FALSE(parse_session_merges("robots = [").has_value());
}

TEST(SessionDir, TheMergesOfAFullFleetAreRead) {
  constexpr std::size_t kNumRobots = 256;
  std::string robots;
  std::string refusals;
  for (std::size_t b = 0; b < kNumRobots; ++b) {
    robots += format("'r{}',", b);
    for (std::size_t a = 0; a < b; ++a) refusals += format("'r{} and r{}: no loop of {} {}',\n", a, b, a, b);
  }
  const Result<std::vector<SavedMerge>> merges = parse_session_merges(
      format("robots = [{}]\nrefusals = [{}]\ncomponents = [['r3', 'r0', 'r7']]\n", robots, refusals));
  ASSERT_TRUE(merges) << merges.error().message;
  ASSERT_EQ(merges->size(), kNumRobots * (kNumRobots - 1) / 2);
  EXPECT_EQ(merges->back().refusal, "no loop of 254 255");
  EXPECT_EQ(std::ranges::count_if(*merges, &SavedMerge::share_a_map), 3);
}

TEST(SessionDir, AFolderOfTheUsersIsNoRobots) {
  const TemporaryFolder folder;
  Session session = session_of_two();
  auto left = std::make_shared<RobotMap>();  // no keyframe was left of it
  left->id = {2};
  left->name = "cy";
  session.maps.push_back(left);
  session.fleet.robots[{2}].name = "cy";
  session.solution = solve(session.fleet, {});
  ASSERT_TRUE(write_session(folder.path(), session, MapFiles::leave_out));
  std::filesystem::create_directories(folder / "cy");
  put_file(folder / "cy/metadata.yaml", "of the recording");
  const Result<SavedSession> saved = read_session(folder.path());
  ASSERT_TRUE(saved) << saved.error().message;
  EXPECT_EQ(saved->robots.size(), 3U);
  EXPECT_TRUE(saved->optimized.at(2).empty());
  std::filesystem::remove(folder / "bo/trajectory.tum");
  EXPECT_ERROR(read_session(folder.path()), "bo/trajectory.tum");
}

TEST(SessionDir, WhatCannotBeLookedForIsNamed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_session(folder.path(), session_of_two(), MapFiles::leave_out));
  std::filesystem::create_symlink("georeference.toml", folder / "georeference.toml");
  EXPECT_ERROR(read_session(folder.path()), "georeference.toml: cannot be looked for");
  const std::string too_long(300, 'a');
  put_file(folder / "session.toml", "robots = ['" + too_long + "']\n");
  EXPECT_ERROR(read_session(folder.path()), too_long + "/trajectory.tum");
}

TEST(SessionDir, LoopsOfEarlierVersionsAreReadToo) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_session(folder.path(), session_of_two(), MapFiles::leave_out));
  const Result<SavedSession> now = read_session(folder.path());
  ASSERT_TRUE(now.has_value()) << now.error().message;
  ASSERT_EQ(now->loops.size(), 6U);

  std::string earlier;
  for (const auto& row : cells_of(get_file(folder / "loops.csv"))) {
    for (std::size_t c = 0; c < 22; ++c) earlier += (c == 0 ? "" : ",") + row[c];
    earlier += "\n";
  }
  put_file(folder / "loops.csv", earlier);
  const Result<SavedSession> then = read_session(folder.path());
  ASSERT_TRUE(then.has_value()) << then.error().message;
  ASSERT_EQ(then->loops.size(), 6U);
  for (std::size_t l = 0; l < 6; ++l) {
    EXPECT_EQ(then->loops[l].weight, now->loops[l].weight);
    EXPECT_EQ(then->loops[l].loop.verdict, now->loops[l].loop.verdict);
    EXPECT_EQ(then->loops[l].loop.reason, now->loops[l].loop.reason);
  }

  put_file(folder / "loops.csv", "a," + earlier);
  EXPECT_FALSE(read_session(folder.path()).has_value());
  put_file(folder / "loops.csv", earlier.insert(earlier.find('\n'), "_renamed"));
  EXPECT_FALSE(read_session(folder.path()).has_value());
}

}  // namespace
}  // namespace adit
