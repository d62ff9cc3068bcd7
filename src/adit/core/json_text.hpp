// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace adit {

/// A value of nlohmann-json as text, on one line or indented by so many blanks. Names from files may be any
/// bytes: what is no UTF-8 is replaced by U+FFFD, where nlohmann's own default would throw.
template <class Json>
[[nodiscard]] std::string json_text(const Json& json, int indent = -1) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace adit
