// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// session.toml: where a session came from and what was decided in it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "adit/io/session_dir.hpp"

namespace adit {

[[nodiscard]] std::string session_toml(const Session& session);

/// What is read back of it.
struct SessionHeader {
  std::string version;  ///< Of the adit that wrote it.
  Provenance provenance;
  std::vector<std::string> robots;                   ///< In id order.
  std::vector<std::vector<std::string>> components;  ///< Names that share one frame.
};
/// Fails with the line on text that is not TOML. What is missing, as in sessions of earlier versions, is left
/// empty.
[[nodiscard]] Result<SessionHeader> parse_session_toml(std::string_view text);

}  // namespace adit
