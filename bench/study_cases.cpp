// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The whole study of zab as users run it: simulate, odometry, loops, all pairs, report.
#include <sys/resource.h>

#include <cstdlib>
#include <stdexcept>

#include "harness/bench_case.hpp"

namespace adit::bench {
namespace {

const Growth study("study/zab", "adit study on zab, from world to report", "beams of the sensor", {32, 128},
                   [](double beams) -> Work {
                     const auto bench = std::filesystem::canonical("/proc/self/exe");
                     const auto program = bench.parent_path().parent_path() / "adit";
                     if (!std::filesystem::exists(program)) throw Skipped{"no " + program.string()};
                     const auto out = std::filesystem::temp_directory_path() / "adit_bench_study";
                     const std::string command = program.string() + " study --lidar " +
                                                 (beams < 100 ? "os2-32" : "os2-128") + " --out " +
                                                 out.string() + " > /dev/null 2>&1";
                     return [command, out] {
                       std::filesystem::remove_all(out);
                       if (std::system(command.c_str()) != 0) throw std::runtime_error("failed: " + command);
                       rusage usage{};
                       getrusage(RUSAGE_CHILDREN, &usage);
                       return Figures{{"study_peak_mb", static_cast<double>(usage.ru_maxrss) / 1024.0}};
                     };
                   });

}  // namespace
}  // namespace adit::bench
