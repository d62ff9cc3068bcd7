// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/sensor_difference.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "adit/core/rng.hpp"

namespace adit {
namespace {

struct Errors {
  double bias = 0.0;
  double walk = 0.0;  ///< Squared in 1 - cosine, unlike the model.
  double tilt = 0.0;  ///< Of ranges, per radian of elevation: rings differ.
  [[nodiscard]] double of(const PatchView& view) const {
    const auto cosine = static_cast<double>(view.cosine);
    return bias + walk * std::pow(1.0 - cosine, 2) + tilt * static_cast<double>(view.elevation);
  }
};

PatchView random_view(Rng& rng) {
  const double cosine = rng.uniform(0.2, 1.0);
  const double elevation = rng.uniform(-0.3, 0.3);
  return {static_cast<float>(cosine), static_cast<float>(elevation)};
}

/// Offsets of patches that stand `relief` apart, by turns in front and behind.
std::vector<SeenOffset> seen(const Errors& a, const Errors& b, double relief, double noise, std::size_t num) {
  Rng rng(5);
  std::vector<SeenOffset> out(num);
  for (std::size_t i = 0; i < num; ++i) {
    out[i].by_a = random_view(rng);
    out[i].by_b = random_view(rng);
    out[i].metres = a.of(out[i].by_a) * static_cast<double>(out[i].by_a.cosine) -
                    b.of(out[i].by_b) * static_cast<double>(out[i].by_b.cosine) +
                    (i % 2 == 0 ? relief : -relief) + noise * rng.normal();
  }
  return out;
}

double rms_left(const std::vector<SeenOffset>& offsets, const SensorDifference& sensors) {
  double squares = 0.0;
  for (const SeenOffset& offset : offsets) squares += std::pow(offset.metres - sensors.explains(offset), 2);
  return std::sqrt(squares / static_cast<double>(offsets.size()));
}

TEST(SensorDifference, ExplainsWhatUnitsOfASensorDifferIn) {
  const Errors b{0.03, 0.03, 0.02};
  const auto offsets = seen({-0.02, 0.0, -0.02}, b, 0.0, 0.005, 3000);
  EXPECT_GT(rms_left(offsets, SensorDifference()), 0.03);
  const SensorDifference found(offsets, {});
  EXPECT_LT(rms_left(offsets, found), 0.0055);
  EXPECT_NEAR(found.bias_m(), 0.05, 0.005);
}

TEST(SensorDifference, ReliefIsNotOfTheSensors) {
  const auto offsets = seen({}, {}, 0.01, 0.002, 3000);
  EXPECT_NEAR(rms_left(offsets, SensorDifference(offsets, {})), 0.01, 0.001);
}

TEST(SensorDifference, ChangedPlacesDoNotDisturbIt) {
  auto offsets = seen({}, {0.02, 0.0, 0.0}, 0.0, 0.005, 3000);
  for (std::size_t i = 0; i < offsets.size(); i += 5) offsets[i].metres += 0.1;
  EXPECT_NEAR(SensorDifference(offsets, {}).bias_m(), 0.02, 0.008);
}

TEST(SensorDifference, FewOffsetsLeaveThePrior) {
  EXPECT_EQ(SensorDifference({}, {}).bias_m(), 0.0);
  const std::vector<SeenOffset> one(1, {0.5, {}, {}});
  EXPECT_LT(std::abs(SensorDifference(one, {}).explains(one.front())), 0.5);
}

}  // namespace
}  // namespace adit
