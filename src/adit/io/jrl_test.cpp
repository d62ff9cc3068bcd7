// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/jrl.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "adit/core/ids.hpp"
#include "adit/posegraph/optimizer.hpp"
#include "support/data.hpp"

namespace adit {
namespace {

using Json = nlohmann::json;

std::uint64_t key(char robot, std::uint64_t index) {
  return (static_cast<std::uint64_t>(robot) << 56U) | index;
}
Json pose3(double x) { return {{"type", "Pose3"}, {"translation", {x, 0, 0}}, {"rotation", {1, 0, 0, 0}}}; }
Json pose2(double x) { return {{"type", "Pose2"}, {"x", x}, {"y", 0}, {"theta", 0}}; }
Json diagonal(const std::vector<double>& variances) {
  Json out = Json::array();
  for (std::size_t i = 0; i < variances.size() * variances.size(); ++i)
    out.push_back(i % (variances.size() + 1) == 0 ? variances[i / variances.size()] : 0.0);
  return out;
}
Json between3(std::uint64_t from, std::uint64_t to, double x) {
  return {{"type", "BetweenFactorPose3"},
          {"key1", from},
          {"key2", to},
          {"measurement", pose3(x)},
          {"covariance", diagonal({1, 1, 1, 1, 1, 1})}};
}
Json between2(std::uint64_t from, std::uint64_t to, double x) {
  return {{"type", "BetweenFactorPose2"},
          {"key1", from},
          {"key2", to},
          {"measurement", pose2(x)},
          {"covariance", diagonal({1, 1, 1})}};
}
Json prior3(std::uint64_t node, double x) {
  return {{"type", "PriorFactorPose3"},
          {"key", node},
          {"prior", pose3(x)},
          {"covariance", diagonal({1, 1, 1, 1, 1, 1})}};
}
Json entry(std::uint64_t stamp, const Json& measurements) {
  return {{"stamp", stamp}, {"measurements", measurements}};
}
Json id(std::uint64_t entry_index, std::uint64_t measurement) {
  return Json::array({entry_index, measurement});
}
/// Robots a and b, of which b starts elsewhere; each has a step, and a loop joins them.
Json log_of_two() {
  Json file{{"name", "two"}};
  file["robots"] = Json::array({97, 98});
  file["measurements"]["a"] = Json::array({entry(0, Json::array({prior3(key('a', 0), 5)})),
                                           entry(1, Json::array({between3(key('a', 0), key('a', 1), 1)}))});
  file["measurements"]["b"] = Json::array({entry(0, Json::array({between3(key('b', 0), key('b', 1), 1)})),
                                           entry(1, Json::array({between3(key('a', 1), key('b', 1), 2)}))});
  file["potential_outlier_factors"]["a"] = Json::array();
  file["potential_outlier_factors"]["b"] = Json::array({id(1, 0)});
  return file;
}
std::string error_of(const Json& file) {
  const auto read = parse_jrl(file.dump(), "test.jrl");
  return read ? std::string() : read.error().message;
}
void expect_error(const Json& file, const std::string& text) {
  const std::string error = error_of(file);
  EXPECT_NE(error.find(text), std::string::npos) << error;
  EXPECT_EQ(error.find("test.jrl: "), 0U) << error;
}

TEST(Jrl, KnowsRobotsKindsAndPriors) {
  const auto file = parse_jrl(log_of_two().dump(), "test.jrl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->name, "two");
  EXPECT_EQ(file->robots, (std::vector<std::string>{"a", "b"}));
  const auto& jrl = std::get<JrlGraph<Pose>>(file->content);
  ASSERT_EQ(jrl.graph.nodes.size(), 4U);
  EXPECT_EQ(jrl.graph.nodes[2].key, graph_key({RobotId{1}, 0}));
  EXPECT_EQ(jrl.robot_of_node, (std::vector<std::size_t>{0, 0, 1, 1}));
  ASSERT_EQ(jrl.graph.edges.size(), 3U);
  EXPECT_EQ(jrl.graph.edges[1].kind, EdgeKind::odometry);
  EXPECT_EQ(jrl.graph.edges[2].kind, EdgeKind::loop);
  EXPECT_EQ(file->edge_places[2], "measurements.b[1].measurements[0]");
  EXPECT_EQ(jrl.labels[2], JrlLabel::unlabelled);
  ASSERT_EQ(jrl.priors.size(), 1U);
  // Composed from the prior on, through the loop that joins the robots.
  EXPECT_NEAR(jrl.graph.nodes[3].pose.translation().x(), 8.0, 1e-12);
  EXPECT_NEAR(jrl.graph.nodes[2].pose.translation().x(), 7.0, 1e-12);
}

TEST(Jrl, WrittenAndReadItIsTheSame) {
  Json log = log_of_two();
  log["outlier_factors"]["b"] = Json::array({id(1, 0)});
  log["groundtruth"]["a"] = Json::array({pose3(3)});
  log["groundtruth"]["a"][0]["key"] = key('a', 1);
  log["measurements"]["a"][1]["measurements"][0]["covariance"] = diagonal({1, 2, 4, 8, 16, 32});
  const JrlFile before = parse_jrl(log.dump(), "before.jrl").value();
  const JrlFile after = parse_jrl(jrl_text(before).value(), "after.jrl").value();
  EXPECT_EQ(after.name, before.name);
  EXPECT_EQ(after.robots, before.robots);
  const auto& a = std::get<JrlGraph<Pose>>(before.content);
  const auto& b = std::get<JrlGraph<Pose>>(after.content);
  ASSERT_EQ(b.graph.nodes.size(), a.graph.nodes.size());
  EXPECT_EQ(b.robot_of_node, a.robot_of_node);
  for (std::size_t i = 0; i < a.graph.nodes.size(); ++i) {
    EXPECT_EQ(b.graph.nodes[i].key, a.graph.nodes[i].key);
    EXPECT_LT((b.graph.nodes[i].pose.inverse() * a.graph.nodes[i].pose).log().norm(), 1e-12);
    EXPECT_EQ(b.truth[i].has_value(), a.truth[i].has_value()) << i;
  }
  ASSERT_EQ(b.graph.edges.size(), a.graph.edges.size());
  for (std::size_t e = 0; e < a.graph.edges.size(); ++e) {
    EXPECT_EQ(b.graph.edges[e].from, a.graph.edges[e].from);
    EXPECT_EQ(b.graph.edges[e].to, a.graph.edges[e].to);
    EXPECT_EQ(b.graph.edges[e].kind, a.graph.edges[e].kind);
    EXPECT_TRUE(b.graph.edges[e].information.isApprox(a.graph.edges[e].information, 1e-12)) << e;
    EXPECT_EQ(b.labels[e], a.labels[e]);
  }
  ASSERT_EQ(b.priors.size(), 1U);
  EXPECT_EQ(b.priors[0].node, a.priors[0].node);
}

TEST(Jrl, AGraphOfTwoRobotsBecomesALogOfThem) {
  PoseGraph graph;
  for (const char robot : {'a', 'c'})
    for (std::uint64_t i = 0; i < 2; ++i)
      graph.nodes.push_back({key(robot, i), Pose::planar(static_cast<double>(i), 0, 0)});
  graph.edges = {{0, 1, Pose::planar(1, 0, 0), Matrix6::Identity(), EdgeKind::odometry},
                 {2, 3, Pose::planar(1, 0, 0.5), 4.0 * Matrix6::Identity(), EdgeKind::odometry},
                 {0, 3, Pose::planar(2, 1, 0), Matrix6::Identity(), EdgeKind::loop}};
  const JrlFile file = parse_jrl(jrl_text(jrl_of("mine", graph).value()).value(), "mine.jrl").value();
  EXPECT_EQ(file.name, "mine");
  EXPECT_EQ(file.robots, (std::vector<std::string>{"a", "c"}));
  const auto& log = std::get<JrlGraph<Pose>>(file.content);
  ASSERT_EQ(log.graph.edges.size(), 3U);
  EXPECT_EQ(log.graph.edges[2].kind, EdgeKind::loop);
  EXPECT_EQ(log.labels[2], JrlLabel::unlabelled);
  EXPECT_TRUE(log.graph.edges[1].information.isApprox(graph.edges[1].information, 1e-12));

  PoseGraph2 plane;
  plane.nodes = {{0, Pose2()}, {1, Pose2(1.0, 0.5, 0.3)}};
  plane.edges = {{0, 1, Pose2(1.0, 0.5, 0.3), Matrix3(Vector3(1, 2, 3).asDiagonal()), EdgeKind::odometry}};
  const JrlFile of_plane = parse_jrl(jrl_text(jrl_of("plane", plane).value()).value(), "plane.jrl").value();
  EXPECT_EQ(of_plane.robots, std::vector<std::string>{"a"});
  EXPECT_TRUE(std::get<JrlGraph<Pose2>>(of_plane.content)
                  .graph.edges[0]
                  .information.isApprox(plane.edges[0].information, 1e-12));
  graph.edges[2].information(2, 2) = 0.0;
  const auto open = jrl_text(jrl_of("mine", graph).value());
  ASSERT_FALSE(open);
  EXPECT_NE(open.error().message.find("leaves a direction open"), std::string::npos);
  graph.nodes[0].key = std::uint64_t{7} << 56U;
  EXPECT_FALSE(jrl_of("bell", graph));
}

TEST(Jrl, ReadsTheSameFromCbor) {
  const std::vector<std::uint8_t> cbor = Json::to_cbor(log_of_two());
  const auto file = parse_jrl(std::string(cbor.begin(), cbor.end()), "test.jrl.cbor");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(std::get<JrlGraph<Pose>>(file->content).graph.edges.size(), 3U);
  const auto cut = parse_jrl(std::string(cbor.begin(), cbor.end() - 9), "cut.cbor");
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message.find("cut.cbor: not JSON, or cut off"), std::string::npos);
}

TEST(Jrl, RotationComesFirstInCovariancesOfSpace) {
  Json file = log_of_two();
  Json& covariance = file["measurements"]["a"][1]["measurements"][0]["covariance"];
  covariance = diagonal({1, 2, 4, 8, 16, 32});
  covariance[5] = covariance[30] = 1.0;  // rotation about x with translation along z
  const auto read = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(read) << read.error().message;
  const Matrix6 ours = std::get<JrlGraph<Pose>>(read->content).graph.edges[0].information.inverse();
  Matrix6 expected = Vector6(8, 16, 32, 1, 2, 4).asDiagonal();
  expected(2, 3) = expected(3, 2) = 1.0;
  EXPECT_TRUE(ours.isApprox(expected, 1e-12)) << ours;
}

TEST(Jrl, PlaneHasTranslationFirstAndAnglesInRadians) {
  Json file{{"name", "plane"}};
  file["robots"] = Json::array({"a"});
  Json step = between2(key('a', 0), key('a', 1), 1);
  step["measurement"]["theta"] = 0.5;
  step["covariance"] = diagonal({1, 2, 4});
  const Json prior{{"type", "PriorFactorPose2"},
                   {"key", key('a', 0)},
                   {"prior", pose2(3)},
                   {"covariance", diagonal({1, 1, 1})}};
  file["measurements"]["a"] = Json::array({entry(0, Json::array({prior, step}))});
  const auto read = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(read) << read.error().message;
  const auto& jrl = std::get<JrlGraph<Pose2>>(read->content);
  EXPECT_EQ(jrl.graph.edges[0].T_from_to.theta(), 0.5);
  EXPECT_TRUE(jrl.graph.edges[0].information.isApprox(Matrix3(Eigen::Vector3d(1, 0.5, 0.25).asDiagonal())));
  EXPECT_EQ(jrl.graph.nodes[1].pose.translation().x(), 4.0);
}

TEST(Jrl, LabelsAndTruthAreKeptForJudging) {
  Json file = log_of_two();
  file["outlier_factors"]["a"] = Json::array();
  file["outlier_factors"]["b"] = Json::array({id(1, 0)});
  Json a0 = pose3(-1);
  a0["key"] = key('a', 0);
  Json other_word = pose3(-2);
  other_word["key"] = key('a', 0);
  for (const char* name : {"groundtruth", "initialization"}) {
    file[name]["a"] = Json::array({a0});
    file[name]["b"] = Json::array({other_word});
  }
  const auto read = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(read) << read.error().message;
  const auto& jrl = std::get<JrlGraph<Pose>>(read->content);
  EXPECT_EQ(jrl.labels, (std::vector{JrlLabel::inlier, JrlLabel::inlier, JrlLabel::outlier}));
  ASSERT_TRUE(jrl.truth[0].has_value());
  EXPECT_EQ(jrl.truth[0]->translation().x(), -1.0);
  EXPECT_FALSE(jrl.truth[1].has_value());
  EXPECT_EQ(jrl.graph.nodes[0].pose.translation().x(), -1.0);  // its own robot's word, not the prior
}

TEST(Jrl, OtherFactorsAreLeftOutAndUnknownOnesRefused) {
  Json file = log_of_two();
  file["measurements"]["a"][1]["measurements"].push_back({{"type", "RangeFactor3D"}});
  const auto read = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_NE(read->notes.front().find("1 factors of type RangeFactor3D are left out"), std::string::npos);
  file["measurements"]["a"][1]["measurements"][1]["type"] = "BetweenFactorPos3";
  expect_error(file, "measurements.a[1].measurements[1]: unknown factor type 'BetweenFactorPos3'");
}

TEST(Jrl, WithoutAListOfPotentialOutliersKeysDecide) {
  Json file = log_of_two();
  file.erase("potential_outlier_factors");
  const auto read = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(read);
  const auto& edges = std::get<JrlGraph<Pose>>(read->content).graph.edges;
  EXPECT_EQ(edges[0].kind, EdgeKind::odometry);
  EXPECT_EQ(edges[2].kind, EdgeKind::loop);
  EXPECT_NE(read->notes.back().find("does not list potential outliers"), std::string::npos);
}

TEST(Jrl, AMeasurementThatBothRobotsLogCountsOnce) {
  Json file = log_of_two();
  const Json loop = between3(key('a', 1), key('b', 1), 2);
  file["measurements"]["a"][1]["measurements"].push_back(loop);
  const auto once = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(once) << once.error().message;
  EXPECT_EQ(std::get<JrlGraph<Pose>>(once->content).graph.edges.size(), 3U);
  file["measurements"]["a"][1]["measurements"].push_back(loop);  // a second one by the same robot
  file["measurements"]["b"][1]["measurements"] = Json();
  file["potential_outlier_factors"]["b"] = Json::array();
  const auto twice = parse_jrl(file.dump(), "test.jrl");
  ASSERT_TRUE(twice) << twice.error().message;
  EXPECT_EQ(std::get<JrlGraph<Pose>>(twice->content).graph.edges.size(), 4U);
}

TEST(Jrl, WrongCovariancesAreNamed) {
  const auto with = [](const Json& covariance) {
    Json file = log_of_two();
    file["measurements"]["b"][1]["measurements"][0]["covariance"] = covariance;
    return file;
  };
  const std::string place = "measurements.b[1].measurements[0]: ";
  expect_error(with(diagonal({1, 1, 1})), place + "'covariance' needs 36 numbers and has 9");
  expect_error(with(diagonal({1, 1, 1, 1, 1, 0})), place + "'covariance' is not positive definite");
  expect_error(with(diagonal({1, 1, 1, 1, 1, -1})), place + "'covariance' is not positive definite");
  Json crooked = diagonal({1, 1, 1, 1, 1, 1});
  crooked[1] = 0.5;
  expect_error(with(crooked), place + "'covariance' is not symmetric");
  crooked[1] = Json();  // what NaN is written as
  expect_error(with(crooked), place + "number 2 of 'covariance' is not a finite number");
}

TEST(Jrl, OtherMistakesAreNamed) {
  EXPECT_NE(parse_jrl("{\"name\": ", "test.jrl").error().message.find("test.jrl: not JSON, or cut off"),
            std::string::npos);
  expect_error(Json::array(), "not a JSON object");
  expect_error({{"solutions", Json::object()}}, "these are results (JRR)");
  Json file = log_of_two();
  file["robots"] = Json::array({97});
  expect_error(file, "measurements.b: 'b' is not in the list 'robots'");
  file = log_of_two();
  file["outlier_factors"]["a"] = Json::array({id(7, 0)});
  expect_error(file, "outlier_factors.a: there is no measurement [7, 0]");
  file = log_of_two();
  file["measurements"]["a"][1]["measurements"][0]["key2"] = 1.5;
  expect_error(file, "measurements.a[1].measurements[0]: 'key2' is not a key");
  file = log_of_two();
  file["measurements"]["a"][1]["measurements"][0]["key2"] = key('a', 0);
  expect_error(file, "to itself");
  file = log_of_two();
  file["measurements"]["a"][1]["measurements"][0]["measurement"]["rotation"] = {2, 0, 0, 0};
  expect_error(file, "'measurement': the quaternion has norm 2, not 1");
  file = log_of_two();
  file["measurements"]["a"][1]["measurements"].push_back(between2(key('a', 0), key('a', 1), 1));
  expect_error(file, "measurements.a[1].measurements[1]: both Pose2 and Pose3");
  file = log_of_two();
  file["measurements"] = Json::object();
  file["measurements"]["a"] = Json::array({entry(0, Json::array({prior3(key('a', 0), 5)}))});
  file.erase("potential_outlier_factors");
  expect_error(file, "there is no pose graph to solve");
}

/// The positions along x of the optimum.
std::vector<double> solved(const JrlGraph<Pose>& jrl) {
  const Solution<Pose> s = optimize(with_priors_as_edges(jrl));
  EXPECT_EQ(s.status, SolveStatus::converged) << s.reason;
  std::vector<double> x;
  for (const Pose& pose : in_frame_of_priors(jrl, s.poses)) x.push_back(pose.translation().x());
  return x;
}
void expect_near(const std::vector<double>& x, const std::vector<double>& expected) {
  ASSERT_EQ(x.size(), expected.size());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(x[i], expected[i], 1e-6) << i;
}

TEST(Jrl, OnePriorIsGaugeAndSeveralAreMeasurements) {
  Json file = log_of_two();
  const auto one = parse_jrl(file.dump(), "test.jrl");
  const auto& alone = std::get<JrlGraph<Pose>>(one->content);
  EXPECT_EQ(with_priors_as_edges(alone).nodes.size(), 4U);
  expect_near(solved(alone), {5, 6, 7, 8});
  // A second prior, 4 m off: five measurements of variance 1 in a ring share what is missing.
  file["measurements"]["b"][1]["measurements"].push_back(prior3(key('b', 1), 12));
  const auto two = parse_jrl(file.dump(), "test.jrl");
  const auto& both = std::get<JrlGraph<Pose>>(two->content);
  EXPECT_EQ(with_priors_as_edges(both).nodes.size(), 5U);
  expect_near(solved(both), {6, 8, 10, 11});
}

}  // namespace
}  // namespace adit
