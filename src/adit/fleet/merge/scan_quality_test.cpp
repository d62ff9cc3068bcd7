// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/scan_quality.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>

namespace adit {
namespace {

TEST(ScanQuality, IsToldWhereMoreIsMissingThanInCleanScans) {
  EXPECT_EQ(what_was_unconfirmed({0.06, 0.22}, "ada", "bo"),
            "of the scans compared, 6 % of ada's returns and 22 % of bo's were confirmed by no second look");
  EXPECT_EQ(what_was_unconfirmed({0.001, 0.03}, "ada", "bo"),
            "of the scans compared, 0 % of ada's returns and 3 % of bo's were confirmed by no second look");
  EXPECT_EQ(what_was_unconfirmed({std::nullopt, 0.03}, "ada", "bo"),
            "of the scans compared, an unknown share of ada's returns and 3 % of bo's were confirmed by no "
            "second look");
  EXPECT_EQ(what_was_unconfirmed({0.02, 0.001}, "ada", "bo"), "");
  EXPECT_EQ(what_was_unconfirmed({}, "ada", "bo"), "") << "not judged is neither clean nor dusty";
  EXPECT_EQ(what_was_unconfirmed({std::numeric_limits<double>::quiet_NaN(), 0.01}, "ada", "bo"), "");
}

TEST(ScanQuality, MayBeWhyWallsOrPlacesDiffer) {
  for (const RefusalKind kind : kRefusalKinds) {
    const bool may_be = kind == RefusalKind::changed_place || kind == RefusalKind::sensor;
    EXPECT_EQ(!what_dust_may_have_done(kind, {0.06, std::nullopt}).empty(), may_be) << to_string(kind);
    EXPECT_EQ(what_dust_may_have_done(kind, {0.05, 0.04}), "");
    EXPECT_EQ(what_dust_may_have_done(kind, {}), "");
  }
}

}  // namespace
}  // namespace adit
