// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "harness/registry.hpp"

#include "adit/core/check.hpp"
#include "adit/core/version.hpp"

namespace adit::bench {

Registry& registry() {
  static Registry all;
  return all;
}

Case::Case(CaseInfo info) {
  const std::string name = info.name;
  ADIT_CHECK(registry().cases.emplace(name, std::move(info)).second, "each case has a name of its own");
}

Side::Side(const std::string& case_name, const std::string& side, Prepare prepare, About about) {
  if (about.version.empty()) about.version = "adit " + std::string(version());
  if (about.build.empty()) about.build = ADIT_BENCH_BUILD;
  if (about.timed.empty()) about.timed = "the work alone; input in memory, results not written";
  ADIT_CHECK(
      registry()
          .sides.emplace(std::pair(case_name, side), RegisteredSide{std::move(prepare), std::move(about)})
          .second,
      "each side is given once");
}

Growth::Growth(const std::string& name, const std::string& title, const std::string& size_label,
               std::vector<double> sizes, std::function<Work(double size)> prepare,
               std::function<double(double size)> shares) {
  registry().growths[name] = {
      name, title, size_label, std::move(sizes), std::move(prepare), std::move(shares)};
}

Export::Export(const std::string& topic, std::function<void(const std::filesystem::path& folder)> write) {
  registry().exports[topic] = std::move(write);
}

std::filesystem::path shared_data(const std::filesystem::path& relative) {
  std::filesystem::path path = std::filesystem::path(ADIT_SHARED_DATA) / relative;
  if (!std::filesystem::exists(path)) throw Skipped{"the shared data has no " + relative.string()};
  return path;
}

}  // namespace adit::bench
