// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/evidence_fit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

// Alignments drawn from the model's own distributions, with values that are not its defaults.
std::vector<JudgedHypothesis> drawn(std::size_t num) {
  Rng rng(3);
  const auto num_of = [&](double mean) {  // Poisson's, by the times between events
    std::uint32_t n = 0;
    for (double t = -std::log(1.0 - rng.uniform()); t < mean; t -= std::log(1.0 - rng.uniform())) ++n;
    return n;
  };
  std::vector<JudgedHypothesis> all;
  for (std::size_t i = 0; i < num; ++i) {
    JudgedHypothesis h;
    h.truth = i % 2 == 0 ? HypothesisTruth::right : HypothesisTruth::wrong;
    const bool is_right = h.truth == HypothesisTruth::right;
    HypothesisCounts& counts = h.counts;
    counts.compared_m = 100.0;
    counts.num_distinctive = is_right ? 36 : 2;
    counts.num_changes = is_right ? num_of(0.8) : num_of(6.0);
    counts.num_wall_patches = 400;
    counts.equal_signs_sigma = 0.02;
    counts.equal_signs =
        is_right ? 0.53 + std::hypot(0.01, 0.02) * rng.normal() : 0.5 + 0.2 * std::exp(0.3 * rng.normal());
    all.push_back(h);
  }
  return all;
}

double value_of(const std::vector<FittedValue>& fitted, std::string_view key) {
  const auto found = std::ranges::find(fitted, key, &FittedValue::key);
  return found == fitted.end() ? std::nan("") : found->value;
}

TEST(EvidenceFit, FindsWhatHypothesesWereDrawnFrom) {
  const std::vector<FittedValue> fitted = fitted_values(drawn(4000), {});
  EXPECT_NEAR(value_of(fitted, "fleet.agreement_if_true"), 36.0 / 36.8, 0.002);
  EXPECT_NEAR(value_of(fitted, "prior_chance"), 2.0 / 8.0, 0.01);
  // Numbers of changes are whole: a rate below the true one refuses few enough.
  EXPECT_GT(value_of(fitted, "changes_at_worst_per_km"), 3.0);
  EXPECT_LE(value_of(fitted, "changes_at_worst_per_km"), 8.0);
  EXPECT_NEAR(value_of(fitted, "walls.same_share"), 0.53, 0.002);
  EXPECT_NEAR(value_of(fitted, "walls.same_sigma"), 0.01, 0.004);
  EXPECT_NEAR(value_of(fitted, "walls.prior_other_share"), 0.7, 0.01);
  EXPECT_NEAR(value_of(fitted, "walls.prior_sigma"), 0.3, 0.03);
  EXPECT_LT(value_of(fitted, "walls.prior_moulded"), 0.01);
  EXPECT_EQ(value_of(fitted, "fleet.copied"), 0.0);
}

TEST(EvidenceFit, TheFloorUnderMouldedWallsIsNoPartOfTheFit) {
  EvidenceModel high;
  high.walls.moulded = 0.1;
  const std::vector<JudgedHypothesis> all = drawn(400);
  const double fitted = value_of(fitted_values(all, {}), "walls.prior_moulded");
  EXPECT_GE(fitted, 0.0);
  EXPECT_NEAR(value_of(fitted_values(all, high), "walls.prior_moulded"), fitted, 1e-12);
}

TEST(EvidenceFit, SharesHaveAnUpperLimit) {
  std::vector<JudgedHypothesis> all = drawn(400);
  for (std::size_t i = 1; i < 5; i += 2) {  // false ones that agree all along
    all[i].counts.num_changes = 0;
    all[i].counts.num_distinctive = 40;
  }
  const std::vector<FittedValue> fitted = fitted_values(all, {});
  const auto copied = std::ranges::find(fitted, "fleet.copied", &FittedValue::key);
  ASSERT_NE(copied, fitted.end());
  EXPECT_DOUBLE_EQ(copied->value, 0.01);
  EXPECT_GT(copied->upper, 0.02);
  EXPECT_EQ(value_of(fitted, "fleet.agreement_if_copied"), 1.0);
}

TEST(EvidenceFit, CopiesAreThoseThatAgreeMoreOftenThanLookAlikesDoByChance) {
  std::vector<JudgedHypothesis> all = drawn(400);  // whose look-alikes agree at one place in four
  all[1].counts.num_distinctive = 30;              // a copy with furniture of its own
  all[1].counts.num_changes = 10;
  all[3].counts.num_distinctive = 10;  // long, and no more alike than others
  all[3].counts.num_changes = 30;
  const std::vector<FittedValue> fitted = fitted_values(all, {});
  EXPECT_DOUBLE_EQ(value_of(fitted, "fleet.copied"), 1.0 / 200.0);
  EXPECT_DOUBLE_EQ(value_of(fitted, "fleet.agreement_if_copied"), 0.75);
}

TEST(EvidenceFit, WithoutHypothesesNothingIsFitted) {
  EXPECT_TRUE(fitted_values({}, {}).empty());
  const Table table = evidence_table({}, {});
  EXPECT_NE(table.caption.find("scales of measuring are in"), std::string::npos) << "not all that decides";
  EXPECT_EQ(table.rows.size(), evidence_entries({}).size());
  for (const auto& row : table.rows) {
    ASSERT_EQ(row.size(), table.header.size());
    EXPECT_EQ(row[3], "-");
  }
}

TEST(EvidenceFit, TheTableHasOldBesideNew) {
  const Table table =
      evidence_table({}, {{"changes_at_worst_per_km", 31.0, 200, 31.0}, {"fleet.copied", 0.0, 200, 0.015}});
  const auto row = [&](std::string_view key) {
    return *std::ranges::find_if(table.rows, [&](const auto& cells) { return cells[0] == key; });
  };
  EXPECT_EQ(row("changes_at_worst_per_km")[2], "30");
  EXPECT_EQ(row("changes_at_worst_per_km")[3], "31 (200)");
  EXPECT_EQ(row("fleet.copied")[3], "0 (200; < 0.015)");
}

}  // namespace
}  // namespace adit
