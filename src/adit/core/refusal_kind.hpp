// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace adit {

/// What kept two maps apart, decided with the refusal (docs/decisions/0042).
enum class RefusalKind : std::uint8_t {
  no_loop,           ///< Nothing was registered: nobody knows whether the robots shared anything.
  too_little,        ///< What was found agrees, but is no proof.
  rival,             ///< Two places explain the loops alike.
  other_tunnel,      ///< Scans differ as those of two tunnels do.
  changed_place,     ///< Scans differ at some places; those around them speak for the same stretch.
  changed_or_other,  ///< Scans differ at so many places that changes and another tunnel cannot be told apart.
  sensor,            ///< All places agree; walls lie apart, mostly by what errors of range would make.
  taken_back,        ///< Merges with further robots contradict it.
  unknown,           ///< No decision gave one.
  vetoed,            ///< A person keeps the maps apart, whatever the test says.
};
/// All of them, in the order above.
inline constexpr std::array kRefusalKinds{RefusalKind::no_loop,       RefusalKind::too_little,
                                          RefusalKind::rival,         RefusalKind::other_tunnel,
                                          RefusalKind::changed_place, RefusalKind::changed_or_other,
                                          RefusalKind::sensor,        RefusalKind::taken_back,
                                          RefusalKind::unknown,       RefusalKind::vetoed};
/// In words, for tables and files.
[[nodiscard]] std::string_view to_string(RefusalKind kind);
/// Of such words; unknown for any other.
[[nodiscard]] RefusalKind refusal_kind(std::string_view words);

}  // namespace adit
