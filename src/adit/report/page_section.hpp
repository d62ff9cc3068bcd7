// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "adit/core/result.hpp"

namespace adit {

/// `page` with what stands between its lines `<!-- NAME begin -->` and `<!-- NAME end -->` replaced by
/// `content`. Fails when the page does not hold both lines, in that order.
[[nodiscard]] Result<std::string> with_section(std::string_view page, std::string_view name,
                                               std::string_view content);

}  // namespace adit
