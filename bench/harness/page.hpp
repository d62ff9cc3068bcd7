// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What people read: the table on the terminal and the growth curves. tools/performance_page makes
/// docs/performance.md from the recorded figures.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "harness/compare.hpp"

namespace adit::bench {

struct Results {
  std::vector<CaseResult> cases;
  std::vector<GrowthResult> growths;
};
[[nodiscard]] nlohmann::json json_of(const Results& results);
/// Throws nlohmann::json::exception when the file is no such document.
[[nodiscard]] Results results_from(const nlohmann::json& document);

/// `now` with the cases and curves that only `before` has: a run of a few cases keeps the others' rows.
[[nodiscard]] Results merged(Results now, const Results& before);

/// What may be recorded: `now` and, for what it lacks, `before`, without rows of cases that no longer exist
/// and without rows of `before` from a tree with uncommitted changes. Throws std::runtime_error when `now`
/// has such rows.
[[nodiscard]] Results recordable(Results now, const Results& before);

/// One line per case. `recorded` holds the last recorded version.
[[nodiscard]] std::string table_head();
[[nodiscard]] std::string table_row(const CaseResult& result, const Results& recorded);

[[nodiscard]] std::string plot_growth(const GrowthResult& growth);
/// File name of the picture.
[[nodiscard]] std::string figure_name(const GrowthResult& growth);

}  // namespace adit::bench
