// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/brightness.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

/// How a sensor reports the brightness of a patch.
struct Law {
  double power = 1.0;
  double fall_off = 0.0;
  double gain = 1.0;
};

/// Patches along a wall, ten to a stretch, seen by both sensors from `views` places each; of brightness the
/// share `common` is what both visits find.
std::vector<ReturnsOfPatch> wall(double common, const Law& a = {}, const Law& b = {}, std::size_t num = 400,
                                 std::size_t views = 1, std::uint64_t seed = 5) {
  Rng rng(seed);
  std::vector<ReturnsOfPatch> out;
  for (std::size_t patch = 0; patch < num; ++patch) {
    const double stays = 0.25 * rng.normal() * std::sqrt(common);
    const double in_a = stays + 0.25 * rng.normal() * std::sqrt(1.0 - common);
    const double in_b = stays + 0.25 * rng.normal() * std::sqrt(1.0 - common);
    for (std::size_t view = 0; view < views; ++view) {
      ReturnsOfPatch& one = out.emplace_back();
      one.patch = patch;
      one.stretch = patch / 10;
      const double range = std::log10(1.5 + 10.0 * rng.uniform());
      const double cosine = std::log10(0.1 + 0.9 * rng.uniform());
      const auto seen = [&](double brightness, const Law& law) {
        return WallReturn{std::log10(law.gain) + law.power * (brightness + cosine) + law.fall_off * range,
                          range, cosine};
      };
      one.by_sensor = {seen(in_a, a), seen(in_b, b)};
    }
  }
  return out;
}

TEST(Brightness, IsTheShareThatBothVisitsFind) {
  for (const double common : {0.0, 0.3, 0.6, 1.0}) {
    const BrightnessMatch match = brightness_match(wall(common, {}, {}, 4000));
    EXPECT_EQ(match.num_patches, 4000U);
    EXPECT_NEAR(match.correlation, common, 0.05);
    EXPECT_LE(match.sigma, 0.06);
  }
}

TEST(Brightness, DoesNotDependOnHowASensorReportsIt) {
  const BrightnessMatch plain = brightness_match(wall(0.6));
  const BrightnessMatch raw = brightness_match(wall(0.6, {0.7, -2.0, 100.0}, {1.3, 0.5, 0.01}));
  EXPECT_NEAR(raw.correlation, plain.correlation, 1e-3);
  EXPECT_NEAR(raw.sigma, plain.sigma, 1e-3);
}

// Both sensors see a patch from the same place, so that range and incidence are common to them.
TEST(Brightness, RangeAndIncidenceAreNoMatch) {
  const BrightnessMatch match = brightness_match(wall(0.0, {1.0, -2.0, 1.0}, {1.0, -2.0, 1.0}, 4000));
  EXPECT_NEAR(match.correlation, 0.0, 0.05);
}

// Floors are brighter than roofs, and one side than the other, in the next tunnel, too.
TEST(Brightness, TheCrossSectionIsNoMatch) {
  std::vector<ReturnsOfPatch> returns = wall(0.0, {}, {}, 4000);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const double angle = 0.1 * static_cast<double>(i);
    returns[i].normal = Vector3(0.0, -std::cos(angle), -std::sin(angle));
    returns[i].left_m = 2.5 * std::cos(angle);
    returns[i].above_m = 2.0 * std::sin(angle);
    for (WallReturn& seen : returns[i].by_sensor)
      seen.log_intensity += 0.4 * returns[i].normal.z() - 0.1 * returns[i].left_m;
  }
  EXPECT_NEAR(brightness_match(returns).correlation, 0.0, 0.05);
}

TEST(Brightness, APatchThatIsSeenOftenIsOne) {
  const BrightnessMatch once = brightness_match(wall(0.3, {}, {}, 100, 1));
  const BrightnessMatch often = brightness_match(wall(0.3, {}, {}, 100, 8));
  EXPECT_EQ(often.num_patches, once.num_patches);
  EXPECT_GE(often.sigma, 0.3) << "ten stretches";
}

TEST(Brightness, NothingIsFoundWhereNothingIsSeen) {
  EXPECT_EQ(brightness_match({}), BrightnessMatch());
  EXPECT_EQ(brightness_match(wall(1.0, {}, {}, 19)), BrightnessMatch());
  std::vector<ReturnsOfPatch> twice = wall(1.0, {}, {}, 10, 2);
  EXPECT_EQ(brightness_match(twice), BrightnessMatch()) << "20 returns of ten patches";
  std::vector<ReturnsOfPatch> even = wall(1.0);
  for (ReturnsOfPatch& patch : even) patch.by_sensor[0].log_intensity = 2.0;
  EXPECT_EQ(brightness_match(even).num_patches, 0U) << "one sensor reports the same of all";
  for (ReturnsOfPatch& patch : even) patch.by_sensor[1].log_intensity = 2.4;
  EXPECT_EQ(brightness_match(even).num_patches, 0U);
}

BrightnessMatches known() {
  BrightnessMatches matches{BrightnessModel()};
  matches.set_same({1000, 0.95, 0.05});
  return matches;
}

TEST(Brightness, SpeaksForOneTunnelTheMoreTheBetterItMatches) {
  const BrightnessModel model;
  double before = -100.0;
  for (const double correlation : {0.05, 0.3, 0.45, 0.6, 0.9}) {
    const double evidence = known().evidence({500, correlation, 0.1});
    EXPECT_GT(evidence, before) << correlation;
    before = evidence;
  }
  EXPECT_LE(before, known().most_evidence());
  EXPECT_GT(before, 0.9 * known().most_evidence());
  EXPECT_LT(known().evidence({500, 0.05, 0.05}), -0.3);
  EXPECT_GE(known().evidence({500, -0.5, 0.02}), std::log(model.changed / (1.0 - model.copied)))
      << "dust may have covered all";
}

TEST(Brightness, SaysSomethingFiniteOfWhatNobodyExpects) {
  const double least = known().evidence({500, -1.0, 1e-4});
  EXPECT_GE(least, std::log(BrightnessModel().changed / (1.0 - BrightnessModel().copied)));
  EXPECT_LE(least, 0.0);
}

TEST(Brightness, SaysNothingWhereItWasHardlySeenOrTellsNothing) {
  EXPECT_EQ(known().evidence({static_cast<std::size_t>(BrightnessModel().few_patches) - 1, 0.9, 0.1}), 0.0);
  EXPECT_EQ(BrightnessMatches(BrightnessModel()).evidence({500, 0.9, 0.1}), 0.0)
      << "own walls were not measured";
  BrightnessMatches blind{BrightnessModel()};
  blind.set_same({1000, 0.05, 0.05});  // what the sensor reports is noise
  EXPECT_EQ(blind.evidence({500, 0.05, 0.1}), 0.0);
  EXPECT_GT(known().evidence({500, 0.5, 0.3}, 4.0), known().evidence({500, 0.5, 0.3})) << "four times as far";
}

TEST(Brightness, WhereOwnLookAlikesMatchItSaysLess) {
  BrightnessMatches regular = known();
  for (int i = 0; i < 8; ++i) regular.add_other({500, 0.6, 0.1});
  EXPECT_LT(regular.evidence({500, 0.6, 0.1}), 0.3);
  double before = -100.0;
  for (const double correlation : {-0.2, 0.0, 0.1, 0.3, 0.46}) {
    EXPECT_LE(regular.evidence({500, correlation, 0.1}), 0.0) << correlation;
    EXPECT_GE(regular.evidence({500, correlation, 0.1}), before) << correlation;
    before = regular.evidence({500, correlation, 0.1});
  }
  EXPECT_GT(known().evidence({500, 0.6, 0.1}), 1.0);
  BrightnessMatches hardly = known();
  hardly.add_other({static_cast<std::size_t>(BrightnessModel().few_patches) - 1, 0.9, 0.3});
  EXPECT_EQ(hardly.evidence({500, 0.6, 0.1}), known().evidence({500, 0.6, 0.1}));
}

}  // namespace
}  // namespace adit
