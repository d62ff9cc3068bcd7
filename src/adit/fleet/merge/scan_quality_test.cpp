// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/scan_quality.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace adit {
namespace {

constexpr double kNoShare = std::numeric_limits<double>::quiet_NaN();

TEST(ScanQuality, IsToldWhereMoreIsMissingThanInCleanScans) {
  EXPECT_EQ(what_was_unconfirmed({0.06, 0.22}, "ada", "bo"),
            "of the scans compared, 6 % of ada's returns and 22 % of bo's were confirmed by no other return");
  EXPECT_EQ(what_was_unconfirmed({0.001, 0.03}, "ada", "bo"),
            "of the scans compared, 0 % of ada's returns and 3 % of bo's were confirmed by no other return");
  EXPECT_EQ(what_was_unconfirmed({0.029, 0.001}, "ada", "bo"), "");
  EXPECT_EQ(what_was_unconfirmed({}, "ada", "bo"), "") << "not judged is neither clean nor dusty";
}

TEST(ScanQuality, NothingIsSaidOfAShareThatIsNotKnown) {
  EXPECT_EQ(what_was_unconfirmed({std::nullopt, 0.03}, "ada", "bo"),
            "of the scans compared, 3 % of bo's returns were confirmed by no other return; ada's scans were "
            "too sparse to judge");
  EXPECT_EQ(what_was_unconfirmed({0.22, std::nullopt}, "ada", "bo"),
            "of the scans compared, 22 % of ada's returns were confirmed by no other return; bo's scans were "
            "too sparse to judge");
  for (const auto& [shares, words] :
       {std::pair(UnconfirmedShares{0.25, std::nullopt}, "25 % of the first robot's returns were"),
        std::pair(UnconfirmedShares{std::nullopt, 0.08}, "8 % of the second robot's returns were")}) {
    const std::string clause = what_dust_may_have_done(RefusalKind::sensor, shares);
    EXPECT_NE(clause.find(words), std::string::npos) << clause;
  }
}

TEST(ScanQuality, OfTwoSharesTheLargerOneDecidesWhicheverIsFirst) {
  for (const UnconfirmedShares& low : {UnconfirmedShares{kNoShare, 0.01}, UnconfirmedShares{0.01, kNoShare}})
    EXPECT_EQ(what_was_unconfirmed(low, "ada", "bo"), "");
  for (const UnconfirmedShares& high : {UnconfirmedShares{kNoShare, 0.5}, UnconfirmedShares{0.5, kNoShare},
                                        UnconfirmedShares{0.01, 0.5}, UnconfirmedShares{0.5, 0.01}})
    EXPECT_NE(what_was_unconfirmed(high, "ada", "bo"), "");
}

TEST(ScanQuality, MayBeWhyWallsOrPlacesDiffer) {
  for (const RefusalKind kind : kRefusalKinds) {
    const bool may_be = kind == RefusalKind::changed_place || kind == RefusalKind::sensor;
    EXPECT_EQ(!what_dust_may_have_done(kind, {0.05, std::nullopt}).empty(), may_be) << to_string(kind);
    EXPECT_EQ(what_dust_may_have_done(kind, {0.049, 0.04}), "");
    EXPECT_EQ(what_dust_may_have_done(kind, {}), "");
  }
}

}  // namespace
}  // namespace adit
