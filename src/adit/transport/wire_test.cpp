// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/transport/wire.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <optional>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/core/rng.hpp"
#include "support/wire.hpp"

namespace adit {
namespace {

LoopClosure a_loop() {
  LoopClosure loop;
  loop.from = {{0}, 12};
  loop.to = {{3}, 70000};
  Vector6 xi;
  xi << 1, -2, 3, 0.1, 0.2, -0.3;
  loop.T_from_to = Pose::exp(xi);
  loop.information = Matrix6::Identity() * 7.0;
  loop.information(0, 4) = loop.information(4, 0) = 0.25;
  loop.num_inliers = 42;
  loop.overlap = 0.625;
  loop.weak_axis = 0.01;
  loop.place_distance = 0.125;
  loop.verdict = LoopVerdict::accepted;
  loop.reason = "42 inliers";
  return loop;
}

MergeCheck a_check() {
  MergeCheck check{{1}, {3}, 12.75, 9.25, 40, 39, true, {{5, 70000}, {6, 8}}, "39 of 40 places agree"};
  check.hypotheses = {{HypothesisOutcome::accepted, 12.75, 40, 39, 0.0, check.loops},
                      {HypothesisOutcome::refuted, -3.5, 20, 13, 21.5, {{7, 9}}}};
  check.hypotheses[0].places = {{5, 70000, PlaceOutcome::distinctive}, {9, 70004, PlaceOutcome::differs}};
  check.hypotheses[0].walls = 2.5;
  check.hypotheses[1].counts = {11, 3, 70001, 456, 123.5, 0.75, 0.0625};
  check.refused_kind = RefusalKind::changed_place;
  check.advice = MergeAdvice{143.5, 103.25, {51.25, -8.0, 0.5}, 5.125, 4.0};
  check.unconfirmed = {0.0625, std::nullopt};
  return check;
}

std::vector<Message> one_of_each() {
  const std::vector<float> heights(20 * 60, 1.5F);
  const ScanContext context = from_heights(20, 60, heights);
  GraphNode node{{1234567890123456789}, a_loop().T_from_to, Matrix6::Identity() * 0.5};
  return {{{0}, {1}, Hello{{{{0}, 5, 6, 3, 2}, {{1}, 7, 8, 0, 1}}, true}},
          {{1}, {0}, GraphPart{{2}, "robot_2", 4, {node, node}}},
          {{1}, {0}, Places{9, {{11, context}}, true}},
          {{0}, {1}, CloudRequest{{1, 2, 3}, CloudKind::submap}},
          {{1},
           {0},
           Clouds{{{5,
                    {0.5F, 0.0F, 0.9F},
                    {Eigen::Vector3f(1.0F, -2.0F, 3.0F), Eigen::Vector3f(0.0025F, 160.0F, -160.0F)},
                    {Eigen::Vector3f(-4.0F, 5.0F, 6.0F)},
                    {12.5F, 0.0F},
                    0.21875F}},
                  CloudKind::submap}},
          {{0}, {1}, Loops{{0}, 3, {a_loop()}}},
          {{0}, {2}, MergeChecks{{1}, 4, {a_check()}}}};
}

TEST(Wire, EveryKindOfMessageComesBack) {
  for (const Message& message : one_of_each()) {
    const std::vector<std::byte> bytes = encode(message);
    const Result<Message> back = decode(bytes);
    ASSERT_TRUE(back.has_value()) << back.error().message;
    EXPECT_EQ(back->from, message.from);
    EXPECT_EQ(back->to, message.to);
    EXPECT_EQ(back->body.index(), message.body.index());
    EXPECT_EQ(encode(*back), bytes);
  }
}

TEST(Wire, NumbersOfGraphAndLoopsTravelExactly) {
  const Result<Message> back = decode(encode({{0}, {1}, Loops{{0}, 3, {a_loop()}}}));
  ASSERT_TRUE(back.has_value());
  const LoopClosure& loop = std::get<Loops>(back->body).loops.at(0);
  EXPECT_LT((loop.T_from_to.matrix() - a_loop().T_from_to.matrix()).norm(), 1e-15);
  EXPECT_EQ(loop.information, a_loop().information);
  EXPECT_EQ(loop.to, a_loop().to);
  EXPECT_EQ(loop.reason, a_loop().reason);
  EXPECT_EQ(loop.verdict, LoopVerdict::accepted);
}

TEST(Wire, DecisionsTravelExactly) {
  const Result<Message> back = decode(encode({{0}, {2}, MergeChecks{{1}, 4, {a_check()}}}));
  ASSERT_TRUE(back.has_value());
  const auto& part = std::get<MergeChecks>(back->body);
  EXPECT_EQ(part.author, RobotId{1});
  EXPECT_EQ(part.first, 4U);
  const MergeCheck& check = part.checks.at(0);
  EXPECT_EQ(check.a, RobotId{1});
  EXPECT_EQ(check.b, RobotId{3});
  EXPECT_EQ(check.evidence, 12.75);
  EXPECT_EQ(check.needed, 9.25);
  EXPECT_EQ(check.num_checked, 40U);
  EXPECT_EQ(check.num_passed, 39U);
  EXPECT_TRUE(check.accepted);
  EXPECT_EQ(check.loops, a_check().loops);
  EXPECT_EQ(check.reason, a_check().reason);
  ASSERT_EQ(check.hypotheses.size(), 2U);
  const MergeHypothesis& second = check.hypotheses[1];
  EXPECT_EQ(second.outcome, HypothesisOutcome::refuted);
  EXPECT_EQ(second.evidence, -3.5);
  EXPECT_EQ(second.num_checked, 20U);
  EXPECT_EQ(second.num_differing(), 7U);
  EXPECT_EQ(second.from_best_m, 21.5);
  EXPECT_EQ(second.loops, a_check().hypotheses[1].loops);
  EXPECT_TRUE(second.places.empty());
  const std::vector<TestedPlace>& places = check.hypotheses[0].places;
  ASSERT_EQ(places.size(), 2U);
  EXPECT_EQ(places[1].a, 9U);
  EXPECT_EQ(places[1].b, 70004U);
  EXPECT_EQ(places[0].outcome, PlaceOutcome::distinctive);
  EXPECT_EQ(places[1].outcome, PlaceOutcome::differs);
  EXPECT_EQ(check.hypotheses[0].walls, 2.5);
  EXPECT_EQ(second.counts, a_check().hypotheses[1].counts);
  EXPECT_EQ(check.refused_kind, RefusalKind::changed_place);
  ASSERT_TRUE(check.advice);
  EXPECT_EQ(check.advice->from_m, 143.5);
  EXPECT_EQ(check.advice->to_m, 103.25);
  EXPECT_EQ(check.advice->from, Vector3(51.25, -8.0, 0.5));
  EXPECT_EQ(check.advice->gain, 5.125);
  EXPECT_EQ(check.advice->missing, 4.0);
  EXPECT_EQ(check.unconfirmed.a, 0.0625);
  EXPECT_FALSE(check.unconfirmed.b);
}

TEST(Wire, DecisionsThatCannotBeAreRefused) {
  const auto is_refused = [](const MergeCheck& check) {
    return !decode(encode({{0}, {2}, MergeChecks{{1}, 4, {check}}})).has_value();
  };
  EXPECT_FALSE(is_refused(a_check()));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::function<void(MergeCheck&)>> spoilers = {
      [&](MergeCheck& c) { c.evidence = nan; },
      [&](MergeCheck& c) { c.needed = -std::numeric_limits<double>::infinity(); },
      [&](MergeCheck& c) { c.num_passed = c.num_checked + 1; },
      [&](MergeCheck& c) { c.hypotheses[0].evidence = nan; },
      [&](MergeCheck& c) { c.hypotheses[1].from_best_m = nan; },
      [&](MergeCheck& c) { c.hypotheses[1].num_passed = c.hypotheses[1].num_checked + 1; },
      [&](MergeCheck& c) { c.hypotheses[0].outcome = static_cast<HypothesisOutcome>(6); },
      [&](MergeCheck& c) { c.hypotheses[0].places[1].outcome = static_cast<PlaceOutcome>(3); },
      [&](MergeCheck& c) { c.hypotheses[0].walls = nan; },
      [&](MergeCheck& c) { c.hypotheses[1].counts.compared_m = nan; },
      [&](MergeCheck& c) { c.refused_kind = static_cast<RefusalKind>(10); },
      [&](MergeCheck& c) { c.advice->from_m = nan; },
      [&](MergeCheck& c) { c.advice->from.z() = nan; },
      [&](MergeCheck& c) { c.advice->gain = nan; },
      [&](MergeCheck& c) { c.unconfirmed.a = nan; },
      [&](MergeCheck& c) { c.unconfirmed.b = -0.5; },
      [&](MergeCheck& c) { c.hypotheses.resize(kHypothesesPerCheck + 1); }};
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    MergeCheck check = a_check();
    spoilers[i](check);
    EXPECT_TRUE(is_refused(check)) << i;
  }
}

TEST(Wire, PosesFartherAwayThanAnyRobotAreRefused) {
  const auto is_refused = [](const Vector3& position) {
    LoopClosure loop = a_loop();
    loop.T_from_to = Pose(loop.T_from_to.rotation(), position);
    return !decode(encode({{0}, {1}, Loops{{0}, 3, {loop}}})).has_value();
  };
  EXPECT_FALSE(is_refused({500'000.0, 9'999'000.0, -20.0})) << "UTM coordinates";
  EXPECT_TRUE(is_refused({0.0, 1e300, 0.0}));
  EXPECT_TRUE(is_refused({0.0, 0.0, -1.1e7}));
}

TEST(Wire, MessagesLargerThanTheProtocolAllowsAreRefused) {
  const Message largest{{0}, {1}, CloudRequest{std::vector<std::uint32_t>(kCloudsPerMessage, 1)}};
  EXPECT_TRUE(decode(encode(largest)).has_value());
  const Message larger{{0}, {1}, CloudRequest{std::vector<std::uint32_t>(kCloudsPerMessage + 1, 1)}};
  EXPECT_FALSE(decode(encode(larger)).has_value());
}

TEST(Wire, PointsKeepFiveMillimetresAndFarOnesStayBehind) {
  Clouds clouds;
  clouds.clouds.push_back({1,
                           {0.25F, -0.125F, 0.875F},
                           {Eigen::Vector3f(12.3456F, -7.7777F, 0.1F), Eigen::Vector3f(170.0F, 0.0F, 0.0F)},
                           {}});
  const Result<Message> back = decode(encode({{0}, {1}, clouds}));
  ASSERT_TRUE(back.has_value());
  const auto& points = std::get<Clouds>(back->body).clouds.at(0).points;
  EXPECT_EQ(std::get<Clouds>(back->body).clouds.at(0).viewpoint, Eigen::Vector3f(0.25F, -0.125F, 0.875F));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_LT((points[0] - Eigen::Vector3f(12.3456F, -7.7777F, 0.1F)).cwiseAbs().maxCoeff(), 0.0026F);
}

TEST(Wire, IntensitiesKeepFourPercentAndThoseOfFarPointsStayBehind) {
  const std::vector<float> sent = {0.02F, 1.0F, 47.3F, 40000.0F, 0.0F, -1.0F, 1e9F, 5.0F};
  Clouds::Cloud cloud{1, {}, std::vector<Eigen::Vector3f>(sent.size(), Eigen::Vector3f::Ones()), {}, sent};
  cloud.points.back() = {170.0F, 0.0F, 0.0F};
  const Result<Message> back = decode(encode({{0}, {1}, Clouds{{cloud}}}));
  ASSERT_TRUE(back.has_value());
  const std::vector<float>& got = std::get<Clouds>(back->body).clouds.at(0).intensities;
  ASSERT_EQ(got.size(), sent.size() - 1);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(got[i], sent[i], 0.04F * sent[i]);
  EXPECT_EQ(got[4], 0.0F);
  EXPECT_EQ(got[5], 0.0F);
  EXPECT_GT(got[6], 90000.0F);  // beyond what a byte says, still more
}

TEST(Wire, FewerIntensitiesThanPointsAreRefused) {
  const Clouds::Cloud cloud{1, {}, {2, Eigen::Vector3f::Ones()}, {}, {2.0F, 3.0F}};
  std::vector<std::byte> bytes = encode({{0}, {1}, Clouds{{cloud}}});
  constexpr std::ptrdiff_t kChecksum = 8;  // bytes; before it the two intensities and how many
  ASSERT_EQ(*(bytes.end() - kChecksum - 2 - 4), std::byte{2});
  *(bytes.end() - kChecksum - 2 - 4) = std::byte{1};
  bytes.erase(bytes.end() - kChecksum - 1);
  EXPECT_FALSE(decode(test::resealed(bytes)).has_value());
}

Result<Message> decoded_cloud(const std::optional<float>& unconfirmed) {
  Clouds::Cloud cloud{1, Eigen::Vector3f::Zero(), {2, Eigen::Vector3f::Ones()}};
  cloud.unconfirmed = unconfirmed;
  return decode(encode({{0}, {1}, Clouds{{cloud}}}));
}

TEST(Wire, CloudsSayWhatShareOfTheirScanNothingConfirmed) {
  for (const std::optional<float> share : {std::optional<float>(), std::optional(0.0F), std::optional(0.22F)})
    EXPECT_EQ(std::get<Clouds>(decoded_cloud(share).value().body).clouds.at(0).unconfirmed, share);
  EXPECT_FALSE(decoded_cloud(1.25F).has_value());
}

/// The message of a check with one hypothesis, advice and no shares, as that version had it.
std::vector<std::byte> of_version(std::uint8_t version, std::vector<std::byte> bytes) {
  constexpr int kChecksum = 8;
  constexpr int kShares = 2;                       // whether there is one of a, and of b
  constexpr int kKindAndAdvice = 1 + 1 + 7 * 8;    // and whether there is advice
  constexpr int kLengthAndWalls = 3 * 8;           // behind the counts
  constexpr std::size_t kOfPlacesFoundAgain = 12;  // three counts that were theirs
  bytes.insert(bytes.end() - kChecksum - kShares - kKindAndAdvice - kLengthAndWalls, kOfPlacesFoundAgain,
               std::byte{7});
  if (version == 11) bytes.erase(bytes.end() - kChecksum - kShares, bytes.end() - kChecksum);
  bytes[0] = std::byte{version};
  return test::resealed(std::move(bytes));
}

// Sessions of then go on with their findings.
TEST(Wire, AMessageOfAnEarlierVersionIsRead) {
  MergeCheck check = a_check();
  check.hypotheses.erase(check.hypotheses.begin());
  check.unconfirmed = {};
  const std::vector<std::byte> bytes = encode({{0}, {2}, MergeChecks{{1}, 4, {check}}});
  for (const std::uint8_t version : {std::uint8_t{11}, std::uint8_t{12}}) {
    const Result<Message> back = decode(of_version(version, bytes));
    ASSERT_TRUE(back.has_value()) << back.error().message;
    const MergeCheck& read = std::get<MergeChecks>(back->body).checks.at(0);
    EXPECT_EQ(read.reason, check.reason);
    EXPECT_EQ(read.hypotheses.at(0).counts, check.hypotheses[0].counts);
    EXPECT_EQ(read.advice->missing, check.advice->missing);
    EXPECT_FALSE(read.unconfirmed.a || read.unconfirmed.b);
    EXPECT_EQ(encode(*back), bytes) << "it is passed on as what is said now";
  }
}

TEST(Wire, CloudsOfVersion11SayNoShares) {
  const Clouds::Cloud cloud{1, Eigen::Vector3f::Zero(), {2, Eigen::Vector3f::Ones()}, {}, {2.0F, 3.0F}};
  constexpr int kShare = 4 + 1 + 4 + 4 + 6;  // behind head, kind, number, index and viewpoint
  std::vector<std::byte> bytes = encode({{0}, {1}, Clouds{{cloud}}});
  bytes.erase(bytes.begin() + kShare);
  bytes[0] = std::byte{11};
  const Result<Message> clouds = decode(test::resealed(std::move(bytes)));
  ASSERT_TRUE(clouds.has_value()) << clouds.error().message;
  EXPECT_EQ(std::get<Clouds>(clouds->body).clouds.at(0).intensities.size(), 2U);
  EXPECT_FALSE(std::get<Clouds>(clouds->body).clouds.at(0).unconfirmed);
}

TEST(Wire, EveryCutIsAnError) {
  for (const Message& message : one_of_each()) {
    const std::vector<std::byte> bytes = encode(message);
    for (std::size_t length = 0; length < bytes.size(); ++length) {
      EXPECT_FALSE(decode(std::span(bytes).first(length)).has_value())
          << "kind " << message.body.index() << " cut at " << length;
    }
  }
}

/// `bytes` with `flips` random bytes put anywhere but into the checksum, which is left as it was.
std::vector<std::byte> damaged(std::vector<std::byte> bytes, Rng& rng, int flips) {
  const std::size_t content = bytes.size() - sizeof(std::uint64_t);
  for (int i = 0; i < flips; ++i) bytes[rng.below(content)] ^= static_cast<std::byte>(1 + rng.below(255));
  return bytes;
}

TEST(Wire, AnyDamagedByteIsAnError) {
  Rng rng(1);
  for (const Message& message : one_of_each()) {
    const std::vector<std::byte> bytes = encode(message);
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      std::vector<std::byte> flipped = bytes;
      flipped[at] ^= static_cast<std::byte>(1 + rng.below(255));
      EXPECT_FALSE(decode(flipped).has_value()) << "kind " << message.body.index() << ", byte " << at;
    }
  }
}

TEST(Wire, NonsenseUnderAValidChecksumNeverCrashes) {
  Rng rng(1);
  for (const Message& message : one_of_each()) {
    const std::vector<std::byte> bytes = encode(message);
    for (int trial = 0; trial < 1000; ++trial) {
      const Result<Message> back = decode(test::resealed(damaged(bytes, rng, 4)));
      if (!back.has_value()) continue;
      // What was taken for a message is one: it comes back as itself, from no more bytes than brought it.
      const std::vector<std::byte> again = encode(*back);
      EXPECT_LE(again.size(), bytes.size());
      const Result<Message> twice = decode(again);
      ASSERT_TRUE(twice.has_value()) << twice.error().message;
      EXPECT_EQ(encode(*twice).size(), again.size());
      // Descriptors are stored in steps of their own largest values, which nonsense moves.
      EXPECT_TRUE(std::holds_alternative<Places>(back->body) || encode(*twice) == again);
    }
  }
}

TEST(Wire, ForeignVersionAndTrailingBytesAreRefused) {
  std::vector<std::byte> bytes = encode({{0}, {1}, CloudRequest{{1}}});
  bytes.insert(bytes.end() - 8, std::byte{0});
  EXPECT_NE(decode(bytes).error().message.find("checksum"), std::string::npos);
  EXPECT_NE(decode(test::resealed(bytes)).error().message.find("more bytes"), std::string::npos);
  for (const std::uint8_t version : {std::uint8_t{10}, std::uint8_t{14}, std::uint8_t{99}}) {
    bytes[0] = std::byte{version};
    EXPECT_NE(decode(bytes).error().message.find(format("version {}, this adit reads 11 to 13", version)),
              std::string::npos);
  }
}

TEST(Wire, UnknownKindIsRefused) {
  std::vector<std::byte> bytes = encode({{0}, {1}, CloudRequest{{1}}});
  bytes[3] = std::byte{77};
  EXPECT_NE(decode(test::resealed(bytes)).error().message.find("unknown kind 77"), std::string::npos);
}

}  // namespace
}  // namespace adit
