// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/merge_decision.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "support/merge_checks.hpp"

namespace adit {
namespace {

using test::along_x;
using test::by_places;
using test::kAgrees;
using test::kDiffers;
using test::kNum;
using test::kTrueLoops;
using test::look_alikes;
using test::loop_at;
using test::measured;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

WeighedHypotheses hypotheses_from(const std::vector<PcmLoop>& loops, MeasuredWhenAsked measured_own) {
  AdaptiveConfig config;
  config.merge_check = by_places();
  const OdometryChain own = along_x(kNum);
  const OdometryChain theirs = own;
  return {{own, theirs, loops, {}, nullptr}, {50.0, std::move(measured_own)}, config};
}

// Of four, three and two loops, 20 m apart.
WeighedHypotheses three_hypotheses() {
  std::vector<PcmLoop> loops = kTrueLoops;
  loops.push_back(loop_at(95));
  for (const std::size_t a : {70U, 120U, 130U}) loops.push_back(loop_at(a, 20.0));
  for (const std::size_t a : {60U, 65U}) loops.push_back(loop_at(a, -20.0));
  return hypotheses_from(loops, measured(look_alikes(0.5)));
}

void compare_all(Hypothesis& hypothesis, const ComparedPlace& found) {
  for (std::size_t i = hypothesis.compared.size(); i < hypothesis.plan.size(); ++i) hypothesis.add(found);
}

TEST(BestFirst, RanksByEvidence) {
  WeighedHypotheses hypotheses = three_hypotheses();
  ASSERT_EQ(hypotheses.all().size(), 3U);
  EXPECT_EQ(best_first(hypotheses), (std::vector<std::size_t>{0, 1, 2})) << "by their loops";
  hypotheses[2].known_before = 5.0;
  EXPECT_EQ(best_first(hypotheses), (std::vector<std::size_t>{2, 0, 1}));
}

// Evidence that is no number may not lose to a smaller one: where it comes first it refuses.
TEST(BestFirst, EvidenceThatIsNoNumberComesFirstAndWhatIsRefutedLast) {
  WeighedHypotheses hypotheses = three_hypotheses();
  ASSERT_EQ(hypotheses.all().size(), 3U);
  hypotheses[1].known_before = kNotANumber;
  EXPECT_EQ(best_first(hypotheses), (std::vector<std::size_t>{1, 0, 2}));
  hypotheses[0].known_before = kNotANumber;
  EXPECT_EQ(best_first(hypotheses), (std::vector<std::size_t>{0, 1, 2}));
  compare_all(hypotheses[0], kDiffers);
  ASSERT_TRUE(hypotheses.differs_too_often(hypotheses[0]));
  EXPECT_EQ(best_first(hypotheses), (std::vector<std::size_t>{1, 2, 0}));
}

TEST(BestFirst, DoesNotMeasureTheOwnMapToRankASingleOne) {
  const WeighedHypotheses hypotheses = hypotheses_from(kTrueLoops, []() -> const Measured& {
    ADD_FAILURE() << "measured";
    static const Measured nothing{look_alikes(0.5), {}};
    return nothing;
  });
  EXPECT_EQ(best_first(hypotheses), std::vector<std::size_t>{0});
  EXPECT_TRUE(best_first(hypotheses_from({}, nullptr)).empty());
}

TEST(Decide, AcceptsTheBestOneWithWhatIsNeededAndNotWithLess) {
  WeighedHypotheses hypotheses = hypotheses_from(kTrueLoops, measured(look_alikes(0.5)));
  const std::vector<std::size_t> order = best_first(hypotheses);
  Hypothesis& best = hypotheses[0];
  best.known_before = 1e9;
  EXPECT_EQ(decide(hypotheses, order), MergeDecision::nothing_compared);
  compare_all(best, kAgrees);
  best.known_before += hypotheses.needed() - hypotheses.evidence(best) - 1e-3;
  EXPECT_EQ(decide(hypotheses, order), MergeDecision::too_little_evidence);
  best.known_before += 2e-3;
  EXPECT_EQ(decide(hypotheses, order), MergeDecision::accepted);
  best.known_before = kNotANumber;
  EXPECT_EQ(decide(hypotheses, order), MergeDecision::too_little_evidence);
}

}  // namespace
}  // namespace adit
