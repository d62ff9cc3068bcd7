// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/core/refusal_kind.hpp"

#include <algorithm>

namespace adit {

std::string_view to_string(RefusalKind kind) {
  switch (kind) {
    case RefusalKind::no_loop:
      return "no loop";
    case RefusalKind::too_little:
      return "too little";
    case RefusalKind::rival:
      return "two hypotheses";
    case RefusalKind::other_tunnel:
      return "other tunnel";
    case RefusalKind::changed_place:
      return "changed place";
    case RefusalKind::changed_or_other:
      return "changed place or other tunnel";
    case RefusalKind::sensor:
      return "sensor";
    case RefusalKind::taken_back:
      return "taken back";
    case RefusalKind::vetoed:
      return "vetoed";
    case RefusalKind::unknown:
      break;
  }
  return "unknown";
}

RefusalKind refusal_kind(std::string_view words) {
  const auto* found =
      std::ranges::find_if(kRefusalKinds, [&](RefusalKind kind) { return to_string(kind) == words; });
  return found == kRefusalKinds.end() ? RefusalKind::unknown : *found;
}

}  // namespace adit
