// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// Fits the evidence model to hypotheses that ground truth has judged (JudgedHypothesis): what true and false
/// alignments of two maps showed where they were compared.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "adit/evaluation/tables.hpp"
#include "adit/fleet/merge/evidence_model.hpp"
#include "adit/study/merge_calibration.hpp"

namespace adit {

/// A value of the model as these hypotheses have it.
struct FittedValue {
  std::string key;              ///< As EvidenceEntry.
  double value = 0.0;           ///< In the unit of EvidenceEntry.
  std::size_t num_samples = 0;  ///< Hypotheses that it was fitted to; at least one.
  double upper = 0.0;           ///< Of a share: its upper limit at 95 %; else the value.
};

/// What can be fitted. A value for which there is no sample is left out. Hypotheses 3 to 10 m off are not
/// read.
[[nodiscard]] std::vector<FittedValue> fitted_values(const std::vector<JudgedHypothesis>& hypotheses,
                                                     const EvidenceModel& in_use);

/// Every value of the model: in use, as fitted here where it can be, its source and date.
[[nodiscard]] Table evidence_table(const EvidenceModel& in_use, const std::vector<FittedValue>& fitted);

}  // namespace adit
