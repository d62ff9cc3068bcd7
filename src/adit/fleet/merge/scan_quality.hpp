// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What is said of the scans that a merge check compared, where dust, drops or a dirty window spoilt them.
#pragma once

#include <string>
#include <string_view>

#include "adit/core/refusal_kind.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Shares of a robot's returns that nothing confirmed, from which on they are told. Clean scans of a
/// simulated mine lose less than 1 % (decision 0038).
///@{
inline constexpr double kNotableUnconfirmed = 0.03;  ///< Not the mine: dust, drops, a dirty window.
/// May be why scans or walls differ: where returns of so much dust had stayed, no pair of zab merged
/// (decision 0038).
inline constexpr double kHarmfulUnconfirmed = 0.05;
///@}

/// Which shares of the returns of robots `a` and `b` nothing confirmed: one sentence without its full stop.
/// Empty where neither is notable.
[[nodiscard]] std::string what_was_unconfirmed(const UnconfirmedShares& shares, std::string_view a,
                                               std::string_view b);

/// What a refusal of such a kind adds, with the remedy: a clause that begins with "; ". Empty where the kind
/// is not one that unconfirmed returns can make (changed place, sensor), or neither share is harmful.
[[nodiscard]] std::string what_dust_may_have_done(RefusalKind kind, const UnconfirmedShares& shares);

}  // namespace adit
