// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/evidence_fit.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "adit/core/format.hpp"
#include "adit/evaluation/statistics.hpp"
#include "adit/fleet/merge/merge_evidence.hpp"
#include "adit/registration/relief.hpp"

namespace adit {
namespace {

using Counts = std::vector<HypothesisCounts>;

Counts counts_of(const std::vector<JudgedHypothesis>& all, HypothesisTruth truth) {
  Counts out;
  for (const JudgedHypothesis& h : all)
    if (h.truth == truth && h.counts.compared_m > 0.0) out.push_back(h.counts);
  return out;
}

/// Those whose walls were seen on at least so many patches.
Counts with_walls(const Counts& all, int min_patches) {
  Counts out;
  std::ranges::copy_if(all, std::back_inserter(out), [&](const HypothesisCounts& counts) {
    return counts.num_wall_patches >= static_cast<std::uint32_t>(min_patches);
  });
  return out;
}

class Fit {
 public:
  Fit(const std::vector<JudgedHypothesis>& hypotheses, const EvidenceModel& model)
      : right_(counts_of(hypotheses, HypothesisTruth::right)),
        wrong_(counts_of(hypotheses, HypothesisTruth::wrong)),
        model_(model) {
    fit_places();
    fit_changes();
    fit_same_walls();
    fit_other_walls();
  }
  [[nodiscard]] std::vector<FittedValue> values() && { return std::move(values_); }

 private:
  void add(const char* key, double value, const Counts& samples) {
    if (!samples.empty()) values_.push_back({key, value, samples.size(), value});
  }
  void add_share(const char* key, std::size_t part, const Counts& samples) {
    if (samples.empty()) return;
    values_.push_back({key, static_cast<double>(part) / static_cast<double>(samples.size()), samples.size(),
                       share_upper_limit(part, samples.size())});
  }

  /// Changes are to places as ends are to steps: each new one ends a run of places that agree.
  static double chance_to_agree(const Counts& all) {
    double agreed = 0.0;
    double differed = 0.0;
    for (const HypothesisCounts& counts : all) {
      agreed += counts.num_distinctive;
      differed += counts.num_changes;
    }
    return agreed + differed > 0.0 ? agreed / (agreed + differed) : 0.0;
  }
  void fit_places() {
    add("fleet.agreement_if_true", chance_to_agree(right_), right_);
    const double goes_on = chance_to_agree(wrong_);
    add("prior_chance", goes_on, wrong_);
    // A copy changes less often than look-alikes do, beyond chance. Changes count, where the decision counts
    // places that differ: one of them may show several.
    constexpr double kConfidence = 0.999;
    Counts copies;
    std::ranges::copy_if(wrong_, std::back_inserter(copies), [&](const HypothesisCounts& counts) {
      const std::size_t num = counts.num_distinctive + counts.num_changes;
      return share_upper_limit(counts.num_changes, num, kConfidence) < 1.0 - goes_on;
    });
    add_share("fleet.copied", copies.size(), wrong_);
    add("fleet.agreement_if_copied", chance_to_agree(copies), copies);
  }

  void fit_changes() { add("changes_at_worst_per_km", changes_at_worst(), right_); }
  /// The lowest rate under which no more true alignments are refused than is stated.
  [[nodiscard]] double changes_at_worst() const {
    constexpr double kStep = 0.5;     // per km
    constexpr double kMost = 1000.0;  // the largest that the setting may be
    double rate = kStep;
    const auto is_refused = [&](const HypothesisCounts& counts) {
      return poisson_tail(counts.num_changes, rate * counts.compared_m / 1000.0) < model_.refusal_rate;
    };
    const double allowed = model_.refusal_rate * static_cast<double>(right_.size());
    while (rate<kMost&& static_cast<double>(std::ranges::count_if(right_, is_refused))> allowed)
      rate += kStep;
    return rate;
  }

  void fit_same_walls() {
    const Counts seen = with_walls(right_, model_.walls.few_patches);
    std::vector<double> shares;
    std::vector<double> counting;  // variances
    for (const HypothesisCounts& counts : seen) {
      shares.push_back(counts.equal_signs);
      counting.push_back(std::pow(counts.equal_signs_sigma, 2));
    }
    add_spread("walls.same_share", "walls.same_sigma", shares, counting, seen, [](double m) { return m; });
  }
  void fit_other_walls() {
    const Counts seen = with_walls(wrong_, model_.walls.few_patches);
    std::vector<double> logs;  // of the share beyond one half
    std::vector<double> counting;
    for (const HypothesisCounts& counts : seen) {
      const double beyond = std::max(counts.equal_signs - 0.5, counts.equal_signs_sigma);
      logs.push_back(std::log(beyond));
      counting.push_back(std::pow(counts.equal_signs_sigma / beyond, 2));
    }
    add_spread("walls.prior_other_share", "walls.prior_sigma", logs, counting, seen,
               [](double m) { return 0.5 + std::exp(m); });
    EqualSignShares shares(model_.walls);
    for (const HypothesisCounts& counts : seen)
      shares.add_other({counts.num_wall_patches, counts.equal_signs, counts.equal_signs_sigma});
    // That chance has the floor `moulded` added to what the look-alikes say.
    add("walls.prior_moulded", shares.chance_of_one_mould() - model_.walls.moulded, seen);
  }
  /// Median, and standard deviation beyond the error of counting, by the median of deviations: some walls
  /// were lined anew.
  void add_spread(const char* key, const char* sigma_key, const std::vector<double>& values,
                  const std::vector<double>& counting, const Counts& samples, const auto& as_share) {
    if (samples.empty()) return;
    constexpr double kOfMad = 1.4826;  // standard deviation by the median of deviations
    const double middle = median(values);
    std::vector<double> off;
    for (const double value : values) off.push_back(std::abs(value - middle));
    const double variance = std::pow(kOfMad * median(off), 2) - median(counting);
    add(key, as_share(middle), samples);
    add(sigma_key, std::sqrt(std::max(variance, 0.0)), samples);
  }

  Counts right_;
  Counts wrong_;
  EvidenceModel model_;
  std::vector<FittedValue> values_;
};

}  // namespace

std::vector<FittedValue> fitted_values(const std::vector<JudgedHypothesis>& hypotheses,
                                       const EvidenceModel& in_use) {
  return Fit(hypotheses, in_use).values();
}

Table evidence_table(const EvidenceModel& in_use, const std::vector<FittedValue>& fitted) {
  Table table{
      "The evidence model",
      "Every value of the evidence model: as in use, and as the hypotheses of this run have it. In brackets "
      "the number of hypotheses, and of shares the upper limit at a confidence of 95 %. Values without a fit "
      "are chosen, or no count of hypotheses shows them. docs/configuration.md has "
      "their meaning; scales of measuring are in docs/scales_of_measuring.md.",
      {},
      {"Value", "Unit", "In use", "Fitted here", "Source", "Date"},
      {}};
  for (const EvidenceEntry& entry : evidence_entries(in_use)) {
    const auto found = std::ranges::find(fitted, entry.key, &FittedValue::key);
    std::string here = "-";
    if (found != fitted.end()) {
      const std::string limit = found->upper > found->value ? format("; < {:.2g}", found->upper) : "";
      here = format("{:.3g} ({}{})", found->value, found->num_samples, limit);
    }
    table.rows.push_back({entry.key, entry.unit.empty() ? "-" : entry.unit, format("{:g}", entry.value),
                          std::move(here), std::string(entry.source), std::string(entry.date)});
  }
  return table;
}

}  // namespace adit
