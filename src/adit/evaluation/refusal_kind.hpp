// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <string_view>

namespace adit {

/// What kept two maps apart.
enum class RefusalKind {
  no_loop,        ///< Nothing was registered.
  too_little,     ///< What was found agrees, but is no proof.
  other_tunnel,   ///< Scans or walls differ.
  changed_place,  ///< More things came and went than is usual.
  rival,          ///< Two places explain the loops alike.
  taken_back,     ///< Merges with further robots contradict it.
  unknown,        ///< No sentence of a decision.
};
inline constexpr std::array kRefusalKinds{
    RefusalKind::no_loop, RefusalKind::too_little, RefusalKind::other_tunnel, RefusalKind::changed_place,
    RefusalKind::rival,   RefusalKind::taken_back, RefusalKind::unknown};
/// In words, for tables.
[[nodiscard]] std::string_view to_string(RefusalKind kind);

/// Of the sentence in which a decision gives its reason (MergeCheck, PairOutcome).
[[nodiscard]] RefusalKind refusal_kind(std::string_view reason);

}  // namespace adit
