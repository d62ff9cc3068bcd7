// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What a benchmark is made of. A case is one piece of work that two or more sides do on the same input:
/// adit, and a peer or a plain oracle. Each side runs in a process of its own, on the same processors and
/// with the same number of threads. It prepares once, untimed, and then does one timed run whenever the
/// driver asks; the driver alternates between the sides, so that all see the same load of the machine.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace adit::bench {

/// What a run found besides the time: errors, costs, iterations. Names end in their unit (`rmse_m`, `chi2`).
using Figures = std::map<std::string, double>;

/// One timed run. It may be called many times and does the same work each time.
using Work = std::function<Figures()>;

/// Thrown by a preparation that lacks its input or its library; the table then says SKIPPED and why.
struct Skipped {
  std::string why;
};

/// Loads or makes the input (untimed) and returns the work.
using Prepare = std::function<Work()>;

/// A row of the table.
struct CaseInfo {
  std::string name{};   ///< topic/what, e.g. "posegraph/sphere2500".
  std::string work{};   ///< What one run does, in a few words.
  std::string scene{};  ///< The input: which data, how large.
  int num_threads = 1;  ///< Threads and processors that each side gets.
  std::string peer{};   ///< The side that the aim is about: "ceres", "embree", "kiss-icp", ...
  double aim = 0.0;     ///< Wanted: time of the peer over time of adit. 0: no aim, context only.
  std::string note{};   ///< Least operations and bytes that the work needs. May be empty.
  double per_run = 1;   ///< Units (scans, queries) that one run handles; times are shown for one unit.
  std::string unit{};   ///< Name of the unit; empty: the whole run.
};

/// What a reader has to know to judge a time. Each side states it; one that does not is left out.
struct About {
  std::string version{};  ///< Of the program or library.
  std::string build{};    ///< Compiler and flags, or the package.
  std::string timed{};    ///< What happens between start and stop of the clock, and what does not.
  int num_threads = 0;    ///< Threads that it uses; 0: those of the case.
  std::map<std::string, std::string> environment{};  ///< Set before the process starts, e.g. for its BLAS.
};

/// Static objects of these types in `*_cases.cpp` fill the table.
struct Case {
  explicit Case(CaseInfo info);
};
struct Side {
  /// `side` is "adit" for ours. Of sides in this repository an empty `version` is that of adit, an empty
  /// `build` that of this program, and an empty `timed` stands for `work` alone, input in memory.
  Side(const std::string& case_name, const std::string& side, Prepare prepare, About about = {});
};

/// A curve of cost over size: adit alone, one thread, one process per size, drawn into docs/figures/. With
/// `shares`, the time is that of one of `shares(size)` equal parts of the work.
struct Growth {
  Growth(const std::string& name, const std::string& title, const std::string& size_label,
         std::vector<double> sizes, std::function<Work(double size)> prepare,
         std::function<double(double size)> shares = {});
};

/// Writes the inputs of a topic (scans, clouds, graphs) into a folder, for programs outside this repository
/// that take part as further sides: `adit_bench export FOLDER`.
struct Export {
  Export(const std::string& topic, std::function<void(const std::filesystem::path& folder)> write);
};

/// The shared data folder; throws Skipped when `relative` is not in it.
std::filesystem::path shared_data(const std::filesystem::path& relative);

}  // namespace adit::bench
