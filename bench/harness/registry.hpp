// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The cases and sides that the `*_cases.cpp` files registered.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "harness/bench_case.hpp"

namespace adit::bench {

struct GrowthInfo {
  std::string name;
  std::string title;
  std::string size_label;
  std::vector<double> sizes;
  std::function<Work(double)> prepare;
  std::function<double(double)> shares;
};

struct RegisteredSide {
  Prepare prepare;
  About about;  ///< Complete.
};

struct Registry {
  std::map<std::string, CaseInfo> cases;  ///< By name, which is also the order of the table.
  std::map<std::pair<std::string, std::string>, RegisteredSide> sides;  ///< By case and side.
  std::map<std::string, GrowthInfo> growths;
  std::map<std::string, std::function<void(const std::filesystem::path&)>> exports;
};
Registry& registry();

}  // namespace adit::bench
