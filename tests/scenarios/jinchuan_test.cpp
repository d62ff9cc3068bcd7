// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Two real sessions of one mine drift, 22 days apart (Jinchuan): finished maps of a hand-held LiDAR, without
/// scans or trajectory. Registered as they are, in cuts, and as the maps of robots (decision 0039).
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "adit/io/cloud_files.hpp"
#include "adit/registration/registration.hpp"
#include "adit/slam/meeting.hpp"
#include "support/data.hpp"
#include "support/drift_sessions.hpp"

namespace adit {
namespace {

using Line = std::vector<Eigen::Vector2d>;

constexpr const char* kApril = "scans/jinchuan/session_2025-04-21.ply";
constexpr const char* kMay = "scans/jinchuan/session_2025-05-13.ply";
/// Where the April map ends, along x of the May map; from there on the drift climbs a ramp.
constexpr double kSharedEnds = 72.0;

PointCloud jinchuan_map(const char* relative) {
  const Result<PointCloud> cloud = read_cloud(test::shared_data(relative));
  EXPECT_TRUE(cloud.has_value()) << cloud.error().message;
  return cloud.value_or(PointCloud{});
}

/// An estimate over 100 m of overlap that comes with the data, not a survey.
Pose stated_T_may_april() {
  std::ifstream file(test::shared_data("scans/jinchuan/T_2025-05-13_from_2025-04-21.txt"));
  Eigen::Matrix4d T;
  for (int k = 0; k < 16; ++k) file >> T(k / 4, k % 4);
  return Pose::from_matrix(T);
}

/// The middle of the drift and its ramp from x = `from` to `to`, read off a plan of the May map.
Line middle_of_drift(double from, double to) {
  const Line all = {{-14.0, 2.3},   {-2.0, 0.9},    {17.4, -0.35},  {33.3, -1.8},   {47.4, -3.0},
                    {59.7, -4.0},   {72.0, -5.3},   {89.6, -8.5},   {100.0, -13.0}, {116.0, -20.6},
                    {133.6, -28.2}, {149.5, -34.7}, {165.3, -41.7}, {183.0, -47.0}, {192.0, -51.0}};
  const auto at = [&](double x) {
    std::size_t i = 1;
    while (i + 1 < all.size() && all[i].x() < x) ++i;
    const double share = (x - all[i - 1].x()) / (all[i].x() - all[i - 1].x());
    return Eigen::Vector2d(all[i - 1] + share * (all[i] - all[i - 1]));
  };
  Line part = {at(from)};
  for (const Eigen::Vector2d& corner : all)
    if (corner.x() > from && corner.x() < to) part.push_back(corner);
  part.push_back(at(to));
  return part;
}

/// That line in the April map. `may` gives the height of the floor: the frames are inclined to one another.
Line in_april(const Line& line, const PointCloud& may) {
  Line out;
  for (const Eigen::Vector2d& p : line) {
    const Vector3 on_floor(p.x(), p.y(), test::floor_at(may, p));
    out.push_back((stated_T_may_april().inverse() * on_floor).head<2>());
  }
  return out;
}

RegistrationConfig registration_of_the_program() { return SlamConfig{}.agent().registration_in_use(); }

TEST(Jinchuan, TwoSessionsRegisterToTheStatedTransform) {
  ADIT_NEED_DATA("scans/jinchuan/session_2025-04-21.ply");
  const Registration found =
      register_clouds(jinchuan_map(kMay), jinchuan_map(kApril), registration_of_the_program());
  ASSERT_EQ(found.verdict, LoopVerdict::accepted) << found.reason;
  const Pose stated = stated_T_may_april();
  // Where the maps overlap. 0.02 m and 0.01 degrees; the stated estimate leaves 0.10 m to half of the points.
  for (const double x : {0.0, 30.0, 60.0}) {
    const Vector3 p = stated.inverse() * Vector3(x, -0.06 * x, 0.0);
    EXPECT_LT((*found.T_a_b * p - stated * p).norm(), 0.05) << "at " << x;
  }
  EXPECT_LT((stated.inverse() * *found.T_a_b).angle(), 0.1 * kDegree);
}

/// Balls of a map around points in the drift, ready to be registered.
std::vector<Features> cuts(const PointCloud& map, const std::vector<Vector3>& middles, double radius_m) {
  std::vector<Features> out(middles.size());
  parallel_for_each(middles.size(), [&](std::size_t i) {
    PointCloud cut;
    for (const Eigen::Vector3f& p : map.points)
      if ((p.cast<double>() - middles[i]).norm() < radius_m) cut.points.push_back(p);
    out[i] = compute_features(cut, registration_of_the_program());
  });
  return out;
}

/// In the drift of the May map, in its middle and 1.5 m above the floor, every `apart_m` metres.
std::vector<Vector3> middles_of(const PointCloud& may, double from, double to, double apart_m) {
  std::vector<Vector3> out;
  for (const Pose& T : test::stands_along(may, {.way = middle_of_drift(from, to), .spacing_m = apart_m}))
    out.push_back(T * Vector3(0.0, 0.0, 1.5));
  return out;
}

TEST(Jinchuan, CutsOfTheRampAndItsCrosscutsRegisterToNoCutOfTheDriftBefore) {
  ADIT_NEED_DATA("scans/jinchuan/session_2025-04-21.ply");
  constexpr double kRadius = 15.0;  // metres
  const PointCloud april = jinchuan_map(kApril);
  const PointCloud may = jinchuan_map(kMay);
  const std::vector<Vector3> before = middles_of(may, 0.0, 60.0, 10.0);
  std::vector<Vector3> before_in_april;
  for (const Vector3& p : before) before_in_april.push_back(stated_T_may_april().inverse() * p);
  std::vector<Vector3> beyond = middles_of(may, kSharedEnds + 30.0, 185.0, 10.0);
  beyond.insert(beyond.end(),
                {{117.0, -24.0, 11.5}, {152.5, -24.0, 18.5}, {184.0, -40.0, 21.5}});  // crosscuts
  const std::vector<Features> of_april = cuts(april, before_in_april, kRadius);
  const std::vector<Features> of_ramp = cuts(may, beyond, kRadius);
  const std::vector<Features> same_places = cuts(may, before, kRadius);

  std::vector<char> is_accepted(of_april.size() * of_ramp.size());
  parallel_for_each(is_accepted.size(), [&](std::size_t i) {
    const Registration found = register_features(of_april[i / of_ramp.size()], of_ramp[i % of_ramp.size()],
                                                 registration_of_the_program());
    is_accepted[i] = found.verdict == LoopVerdict::accepted;
  });
  std::size_t num_right = 0;
  std::size_t num_found = 0;
  for (std::size_t i = 0; i < of_april.size(); ++i) {
    const Registration found = register_features(of_april[i], same_places[i], registration_of_the_program());
    if (found.verdict != LoopVerdict::accepted) continue;
    ++num_found;
    const Pose error = stated_T_may_april() * *found.T_a_b;
    const Vector3 off = error * before[i] - before[i];
    if (off.norm() < 0.3 && error.angle() < 1.0 * kDegree) ++num_right;
  }
  const auto num_false = std::ranges::count(is_accepted, 1);
  std::printf("cuts of 15 m: %zu of %zu of the same places register, %zu rightly; of %zu other places %td\n",
              num_found, of_april.size(), num_right, is_accepted.size(), num_false);
  EXPECT_EQ(num_false, 0);
  EXPECT_EQ(num_right, num_found);
  EXPECT_GE(num_right, of_april.size() - 1);
}

/// Both robots meet under the default policy; `T_a_b` joins the frames of the maps that they drove through.
struct RealMeeting {
  PairOutcome pair;
  MergeCheck check;
  int num_loops = 0;  ///< Accepted by the registration,
  int num_right = 0;  ///< and of these within 0.5 m and 3 degrees of where the stated transform puts them.
  std::optional<test::MergeError> error;
};

RealMeeting meet(const test::DriftRobot& a, const test::DriftRobot& b, const Pose& T_a_b) {
  const SlamConfig config;
  const Result<Meeting> meeting = hold_meeting({a.map, b.map}, config);
  EXPECT_TRUE(meeting.has_value()) << meeting.error().message;
  const FleetGraph& known = meeting->agents.front().known();
  const FleetSolution solution = solve(known, config.back_end);
  RealMeeting out{solution.pairs.at(0), {}, 0, 0, test::merge_error(solution, a, b, T_a_b)};
  const auto check = known.checks.find({a.map->id, b.map->id});
  if (check != known.checks.end()) out.check = check->second;
  for (const auto& [ends, loop] : known.loops) {
    if (loop.verdict != LoopVerdict::accepted || loop.from.robot == loop.to.robot) continue;
    ++out.num_loops;
    const Pose truth = a.T_session_base[loop.from.index].inverse() * T_a_b * b.T_session_base[loop.to.index];
    const Pose error = truth.inverse() * loop.T_from_to;
    if (error.translation().norm() < 0.5 && error.angle() < 3.0 * kDegree) ++out.num_right;
  }
  std::printf("%s and %s: %d loops, %d of them right; %s; evidence %.1f of %.1f\n", a.map->name.c_str(),
              b.map->name.c_str(), out.num_loops, out.num_right,
              out.pair.merged ? "merged" : out.pair.refused_reason.c_str(), out.check.evidence,
              out.check.needed);
  if (out.pair.merged && out.error)
    std::printf("  off by %.2f m (median), %.2f m at most; %.2f and %.2f degrees\n", out.error->median_m,
                out.error->largest_m, out.error->median_deg, out.error->largest_deg);
  return out;
}

test::DriftRobot robot_of(const PointCloud& map, const Line& way, double side_m, RobotId id,
                          const std::string& name) {
  return test::drive_through(map, {.way = way, .side_m = side_m, .spacing_m = 1.0, .seed = 1U + id.value}, id,
                             name);
}

void expect_nothing_wrong(const RealMeeting& meeting) {
  EXPECT_EQ(meeting.num_right, meeting.num_loops);
  if (meeting.pair.merged) {
    ASSERT_TRUE(meeting.error.has_value());
    EXPECT_LT(meeting.error->largest_m, 1.0);
  } else {
    EXPECT_FALSE(meeting.pair.refused_reason.empty());
  }
}

/// First-look data: that it is found is asked for, that it is merged is not (decision 0039).
TEST(Jinchuan, RobotsOfTwoSessionsFindOneAnotherAndAreNotMergedWrongly) {
  ADIT_NEED_DATA("scans/jinchuan/session_2025-04-21.ply");
  const PointCloud april = jinchuan_map(kApril);
  const PointCloud may = jinchuan_map(kMay);
  const RealMeeting meeting =
      meet(robot_of(april, in_april(middle_of_drift(-8.0, 70.0), may), 0.6, {0}, "april"),
           robot_of(may, middle_of_drift(-8.0, 140.0), -0.6, {1}, "may"), stated_T_may_april().inverse());
  EXPECT_GE(meeting.num_right, 10);
  expect_nothing_wrong(meeting);
}

TEST(Jinchuan, RobotsOfDisjointPartsStayApart) {
  ADIT_NEED_DATA("scans/jinchuan/session_2025-04-21.ply");
  const PointCloud april = jinchuan_map(kApril);
  const PointCloud may = jinchuan_map(kMay);
  const test::DriftRobot ramp = robot_of(may, middle_of_drift(105.0, 188.0), -0.6, {1}, "ramp");
  const test::DriftRobot drift = robot_of(may, middle_of_drift(-8.0, 60.0), 0.6, {0}, "drift in may");
  const test::DriftRobot earlier =
      robot_of(april, in_april(middle_of_drift(-8.0, 60.0), may), 0.6, {0}, "drift in april");
  EXPECT_FALSE(meet(drift, ramp, Pose()).pair.merged);
  EXPECT_FALSE(meet(earlier, ramp, stated_T_may_april().inverse()).pair.merged);
}

TEST(Jinchuan, RobotsOfHalfThePointsEachFindOneAnotherAndAreNotMergedWrongly) {
  ADIT_NEED_DATA("scans/jinchuan/session_2025-05-13.ply");
  const PointCloud may = jinchuan_map(kMay);
  const Line way = middle_of_drift(-8.0, 70.0);
  const RealMeeting meeting =
      meet(robot_of(test::part_of(may, 0, 2, 9), way, 0.6, {0}, "half"),
           robot_of(test::part_of(may, 1, 2, 9), way, -0.6, {1}, "other half"), Pose());
  EXPECT_GE(meeting.num_right, 15);
  expect_nothing_wrong(meeting);
}

}  // namespace
}  // namespace adit
