// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// session.toml: where a session came from and what was decided in it.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "adit/io/session_dir.hpp"

namespace adit {

/// The text of the file. The provenance's configuration is its last table.
[[nodiscard]] std::string session_toml(const Session& session);

/// What is read back of it.
struct SessionHeader {
  std::string version;                               ///< Of the adit that wrote it.
  Provenance provenance;                             ///< The configuration as TOML again, without comments.
  std::vector<std::string> robots;                   ///< In id order.
  std::vector<std::vector<std::string>> components;  ///< Names that share one frame.
};
/// What became of two robots, or of the places of its own map that a robot came back to.
struct SavedMerge {
  /// Names of the robots; the same twice: a robot's own map.
  ///@{
  std::string a, b;
  ///@}
  MergeCheck check =
      {};  ///< Without hypotheses where nothing was tested. Ids, places and covariances were not saved.
  bool merged = false;       ///< By loops between the two; an accepted check may be taken back.
  bool share_a_map = false;  ///< Be it through other robots.
  std::string refusal = {};  ///< Why they are not merged, one sentence.
  std::optional<MergeAccuracy> accuracy = {};  ///< How well one is placed in the other, where that is known.
};
/// Every pair of robots in id order, tested or not, then the revisits. Fails like parse_session_toml.
[[nodiscard]] Result<std::vector<SavedMerge>> parse_session_merges(std::string_view text);

/// Fails with the line on text that is not TOML. What is missing, as in sessions of earlier versions, is left
/// empty.
[[nodiscard]] Result<SessionHeader> parse_session_toml(std::string_view text);

}  // namespace adit
