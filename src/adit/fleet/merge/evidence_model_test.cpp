// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/evidence_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "adit/fleet/merge/adaptive_config.hpp"
#include "adit/registration/changed_thing.hpp"
#include "adit/registration/sensor_difference.hpp"

namespace adit {
namespace {

const EvidenceEntry* entry(const std::vector<EvidenceEntry>& entries, std::string_view key) {
  const auto found = std::ranges::find(entries, key, &EvidenceEntry::key);
  return found == entries.end() ? nullptr : &*found;
}

TEST(EvidenceModel, EveryValueHasAnOriginAndAMeaning) {
  std::set<std::string> keys;
  for (const EvidenceEntry& one : evidence_entries({})) {
    EXPECT_TRUE(keys.insert(one.key).second) << one.key;
    EXPECT_FALSE(one.meaning.empty()) << one.key;
    EXPECT_FALSE(one.source.empty()) << one.key;
    EXPECT_EQ(one.date.size(), 10U) << one.key;
  }
}

TEST(EvidenceModel, EntriesHoldTheValuesOfTheModel) {
  EvidenceModel model;
  model.sight_m = 17.0;
  model.walls.few_patches = 123;
  const std::vector<EvidenceEntry> entries = evidence_entries(model);
  ASSERT_NE(entry(entries, "sight_m"), nullptr);
  EXPECT_EQ(entry(entries, "sight_m")->value, 17.0);
  EXPECT_EQ(entry(entries, "walls.few_patches")->value, 123.0);
  EXPECT_EQ(entry(entries, "fleet.copied")->value, kFleetEvidence.copied);
  EXPECT_EQ(entry(entries, "things.tallest_m")->value, ThingShape().tallest_m);
  EXPECT_EQ(entry(entries, "sensors.bias_m")->value, OffsetPrior().bias_m);
}

TEST(EvidenceModel, IsSetAsPartOfTheMergeCheck) {
  MergeCheckConfig config;
  const Fields fields = fields_of(config);
  ASSERT_TRUE(set_field(fields, "evidence.walls.same_share", "0.55"));
  EXPECT_EQ(config.evidence.walls.same_share, 0.55);
  EXPECT_FALSE(set_field(fields, "evidence.error_rate", "0.9"));
}

}  // namespace
}  // namespace adit
