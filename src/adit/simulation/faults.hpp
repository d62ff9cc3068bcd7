// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Stretches of a drive in which a simulated sensor fails, as people write them: "slip 10:13 0.5, silent
/// 20:24.5" is slip of 0.5 from 10 to 13 seconds after the start, and silence from 20 to 24.5 seconds.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "adit/core/records.hpp"
#include "adit/core/result.hpp"

namespace adit {

/// Whether a number follows the stretch: "0.5" in "slip 10:13 0.5".
enum class FaultAmount { none, needed };

/// One that a sensor knows.
struct FaultKind {
  std::string_view name;                   ///< The first word of a fault; not owned.
  FaultAmount amount = FaultAmount::none;  ///< Without a number the amount of a fault is 0.
};

/// The faults in the order of the text, with the name of the sensor. Fails on a kind that is not among
/// `kinds`, a begin below 0, an end that is not after the begin, a number that is missing, not finite or one
/// too many.
[[nodiscard]] Result<std::vector<SensorFault>> parse_faults(const std::string& text,
                                                            const std::string& sensor,
                                                            std::span<const FaultKind> kinds, Stamp start);

/// Whether a fault of that kind lasts at `stamp`; its begin counts, its end does not.
[[nodiscard]] bool is_faulty(const std::vector<SensorFault>& faults, std::string_view kind, Stamp stamp);

}  // namespace adit
