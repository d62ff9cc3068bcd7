// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "adit/evaluation/study_result.hpp"
#include "adit/evaluation/tables.hpp"
#include "adit/report/figures.hpp"

namespace adit {

/// One self-contained page: facts, tables, figures (inline SVG), refusals with their reasons, a section per
/// robot pair, and the configuration at the end. No script, no network. `tables` and `figures` are those of
/// `study_tables` and `study_figures`: the caller makes them once and uses them for the terminal and the PNG
/// files too.
[[nodiscard]] std::string html_report(const StudyResult& study, std::span<const Table> tables,
                                      std::span<const Figure> figures);

}  // namespace adit
