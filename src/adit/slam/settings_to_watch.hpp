// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The few settings of RunConfig that a site or a robot may ask for: all others are measured on the spot, or
/// belong to the method.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace adit {

/// A setting that users change.
struct SettingToWatch {
  std::string_view key;    ///< As `adit config` prints it.
  std::string_view when;   ///< What asks for another value, and which.
  std::string_view watch;  ///< Where it shows whether that was right.
};
/// In the order of the configuration.
[[nodiscard]] std::span<const SettingToWatch> settings_to_watch();

/// The same as the table that docs/configuration.md begins with.
[[nodiscard]] std::string markdown_of_settings_to_watch();

}  // namespace adit
