// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/core/result.hpp"

namespace adit {

/// A coordinate system as OGC WKT 1, as LAS files state it. `crs` is what PROJ knows ("EPSG:25833",
/// "EPSG:25833+7837", "ETRS89 / UTM zone 33N", a WKT), or the name of a mine's own grid, which no authority
/// knows: then, and for "", a local system in metres. Fails where a code is not known, and on a system that
/// is not plane or not in metres.
[[nodiscard]] Result<std::string> crs_wkt(const std::string& crs);

}  // namespace adit
