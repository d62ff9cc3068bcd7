// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// The text of metrics.json, version 1: the keys of docs/interface.md, indented. What is unknown (no truth,
/// not run) and what is not finite is null.
[[nodiscard]] std::string metrics_json(const StudyResult& study);

}  // namespace adit
