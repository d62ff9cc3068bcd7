// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What is said of the scans that a merge check compared, where dust, drops or a dirty window spoilt them.
#pragma once

#include <string>
#include <string_view>

#include "adit/core/refusal_kind.hpp"
#include "adit/fleet/sync/protocol.hpp"

namespace adit {

/// Which shares of the returns of robots `a` and `b` nothing confirmed: one sentence without its full stop.
/// Empty where neither is above 2 %: clean scans lose less.
[[nodiscard]] std::string what_was_unconfirmed(const UnconfirmedShares& shares, std::string_view a,
                                               std::string_view b);

/// What a refusal of such a kind adds, with the remedy: a clause that begins with "; ". Empty where the kind
/// is not one that unconfirmed returns can make (changed place, sensor), or neither share is above 5 %.
[[nodiscard]] std::string what_dust_may_have_done(RefusalKind kind, const UnconfirmedShares& shares);

}  // namespace adit
