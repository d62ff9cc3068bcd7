// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// How merging bears one effect alone, such as a range bias, from none to twice what is stated for it.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "adit/study/merge_study.hpp"

namespace adit {

/// One entry [[effect]] of the list.
struct MergeEffect {
  std::string name;     ///< What tables call it; unique in the list.
  std::string field;    ///< A key of RunConfig.
  std::string unit;     ///< Of amplitudes; may be empty.
  double stated = 0.0;  ///< What data sheets or a working mine have; amplitudes go to twice this.
  int steps = 2;        ///< Amplitudes above 0, evenly spaced.
  std::string set;      ///< Further "key=value", separated by commas, at every amplitude but 0.

  /// From 0 to twice `stated`.
  [[nodiscard]] std::vector<double> amplitudes() const;
};

/// Fails on an entry without a name, on two of one name, and on a field or value that RunConfig refuses.
Result<std::vector<MergeEffect>> read_effects(const std::filesystem::path& list);

/// `config` with that effect; unchanged at the amplitude 0.
Result<RunConfig> with_effect(const MergeEffect& effect, double amplitude, RunConfig config);

/// What merging came to under one effect of one amplitude.
struct CurvePoint {
  std::string effect;      ///< Its name.
  double amplitude = 0.0;  ///< In the unit of the effect.
  MergeCounts counts;      ///< Over the worlds.
};

/// Runs MergePolicy::adaptive on every world at every amplitude, on maps that are not kept but those without
/// an effect. `study.policies` is not read. The worlds' own conditions do not count. `runs` are those of
/// earlier calls: what they hold of the same sensors and conditions is not run again, and what is new is
/// added and written to results.json of the study's folder. Fails where a world cannot be driven or an effect
/// cannot be set.
Result<std::vector<CurvePoint>> measure_curves(const MergeStudy& study,
                                               const std::vector<ListedWorld>& worlds,
                                               const std::vector<MergeEffect>& effects,
                                               std::vector<MergeRun>& runs);

/// Each effect and amplitude; then of each effect where merges begin to be refused and to be wrong.
[[nodiscard]] std::vector<Table> curve_tables(const std::vector<MergeEffect>& effects,
                                              const std::vector<CurvePoint>& points);
/// Share of the mergeable pairs that are merged over the amplitude, in units of what is stated.
[[nodiscard]] std::string curves_plot(const std::vector<MergeEffect>& effects,
                                      const std::vector<CurvePoint>& points);

}  // namespace adit
