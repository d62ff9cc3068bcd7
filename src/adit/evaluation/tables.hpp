// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The paper's tables as data; report/text_tables turns them into text, Markdown or HTML.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/evaluation/study_result.hpp"

namespace adit {

/// A title over several neighbouring columns.
struct ColumnGroup {
  std::string title;        ///< Empty over columns that need none.
  std::size_t columns = 1;  ///< How many it spans.
};

/// Cells are UTF-8 text. Every row is as long as the header. The first column is left-aligned; the writer
/// centres or right-aligns the others.
struct Table {
  std::string title;                ///< A heading, without a full stop.
  std::string caption;              ///< What the columns mean, in sentences.
  std::vector<ColumnGroup> groups;  ///< Over the header; empty, or as many columns in all as the header has.
  std::vector<std::string> header;  ///< A heading for each column.
  std::vector<std::vector<std::string>> rows;  ///< From top to bottom.
};

/// Whether the paper's own figures stand beside ours. They are comparable where the study has four robots on
/// a world like the paper's; rows that the paper does not have stay blank in its columns.
enum class PaperFigures { hide, show };

/// Path length, duration, average speed, scans and keyframes of each robot, as the paper's table 1.
[[nodiscard]] Table trajectories_table(const StudyResult& study, PaperFigures paper = PaperFigures::hide);
/// Per cent of wrong loops of each pair and keyframe policy, as the paper's tables 2 and 3; "-" stands for 0
/// as there, "none" for "there was no loop at all".
///@{
[[nodiscard]] Table outliers_before_pcm_table(const StudyResult& study,
                                              PaperFigures paper = PaperFigures::hide);
[[nodiscard]] Table outliers_after_pcm_table(const StudyResult& study,
                                             PaperFigures paper = PaperFigures::hide);
///@}
/// "✓" success, "✗" merged but wrong by the 1 % rule, "○" not merged (refused with a reason).
[[nodiscard]] Table success_table(const StudyResult& study, PaperFigures paper = PaperFigures::hide);
/// Largest ATE of both robots of each pair with PCM, for each keyframe policy, as the paper's table 5.
[[nodiscard]] Table max_ate_table(const StudyResult& study, PaperFigures paper = PaperFigures::hide);

/// Beyond the paper: the odometries of each robot, and all robots merged jointly.
///@{
[[nodiscard]] Table odometry_table(const StudyResult& study);
[[nodiscard]] Table joint_table(const StudyResult& study);
///@}

/// The five of the paper, then the odometries and the joint run where the study has them.
[[nodiscard]] std::vector<Table> study_tables(const StudyResult& study,
                                              PaperFigures paper = PaperFigures::hide);

}  // namespace adit
