// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/fleet/merge/scan_quality.hpp"

#include <cmath>
#include <optional>

#include "adit/core/format.hpp"

namespace adit {
namespace {

/// Of those that are known.
double larger_of(const UnconfirmedShares& shares) {
  return std::fmax(shares.a.value_or(0.0), shares.b.value_or(0.0));  // NaN, whichever it is, counts as none
}

std::string percent(double share) { return format("{:.0f} %", 100.0 * share); }

/// Where one share is known, and the other robot's scans were too sparse to judge.
std::string what_one_has_unconfirmed(double share, std::string_view robot, std::string_view other) {
  return format(
      "of the scans compared, {} of {}'s returns were confirmed by no other return; {}'s scans were too "
      "sparse to judge",
      percent(share), robot, other);
}

/// Clause for which the robots' names are not known.
std::string shares_in_words(const UnconfirmedShares& shares) {
  if (shares.a && shares.b) return format("{} and {} of the returns", percent(*shares.a), percent(*shares.b));
  return shares.a ? percent(*shares.a) + " of the first robot's returns"
                  : percent(*shares.b) + " of the second robot's returns";
}

}  // namespace

std::string what_was_unconfirmed(const UnconfirmedShares& shares, std::string_view a, std::string_view b) {
  if (!(larger_of(shares) >= kNotableUnconfirmed)) return {};
  if (!shares.a) return what_one_has_unconfirmed(*shares.b, b, a);
  if (!shares.b) return what_one_has_unconfirmed(*shares.a, a, b);
  return format("of the scans compared, {} of {}'s returns and {} of {}'s were confirmed by no other return",
                percent(*shares.a), a, percent(*shares.b), b);
}

std::string what_dust_may_have_done(RefusalKind kind, const UnconfirmedShares& shares) {
  const bool may_come_from_it = kind == RefusalKind::changed_place || kind == RefusalKind::sensor;
  if (!may_come_from_it || !(larger_of(shares) >= kHarmfulUnconfirmed)) return {};
  return format(
      "; of the scans compared, {} were confirmed by no other return, which may be why: clean the window of "
      "the LiDAR, or where it is dust drive again when it has settled",
      shares_in_words(shares));
}

}  // namespace adit
