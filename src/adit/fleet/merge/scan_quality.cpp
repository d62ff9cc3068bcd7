// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/scan_quality.hpp"

#include <algorithm>
#include <optional>

#include "adit/core/format.hpp"

namespace adit {
namespace {

constexpr double kNotable = 0.02;    // clean scans of a simulated mine lose 0.1 % (decision 0038)
constexpr double kMayMatter = 0.05;  // with so much dust left in no pair of zab merged (decision 0038)

double larger_of(const UnconfirmedShares& shares) {
  return std::max(shares.a.value_or(0.0), shares.b.value_or(0.0));
}

std::string percent(const std::optional<double>& share) {
  return share ? format("{:.0f} %", 100.0 * *share) : "an unknown share";
}

}  // namespace

std::string what_was_unconfirmed(const UnconfirmedShares& shares, std::string_view a, std::string_view b) {
  if (!(larger_of(shares) > kNotable)) return {};
  return format("of the scans compared, {} of {}'s returns and {} of {}'s were confirmed by no second look",
                percent(shares.a), a, percent(shares.b), b);
}

std::string what_dust_may_have_done(RefusalKind kind, const UnconfirmedShares& shares) {
  const bool may_come_from_it = kind == RefusalKind::changed_place || kind == RefusalKind::sensor;
  if (!may_come_from_it || !(larger_of(shares) > kMayMatter)) return {};
  return format(
      "; of the scans compared, {} and {} of the returns were confirmed by no second look, which may be why: "
      "clean the window of the LiDAR, or where it is dust drive again when it has settled",
      percent(shares.a), percent(shares.b));
}

}  // namespace adit
