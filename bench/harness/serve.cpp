// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "harness/serve.hpp"

#include <chrono>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <nlohmann/json.hpp>

#include "adit/core/parallel.hpp"
#include "harness/registry.hpp"

namespace adit::bench {
namespace {

Work prepared(const std::string& name, const std::string& side) {
  const Registry& all = registry();
  if (const auto growth = all.growths.find(name); growth != all.growths.end())
    return growth->second.prepare(std::stod(side));
  const auto found = all.sides.find({name, side});
  if (found == all.sides.end()) throw Skipped{"no side " + side + " of " + name};
  return found->second.prepare();
}

int num_threads_of(const std::string& name) {
  if (const char* text = std::getenv("ADIT_BENCH_THREADS")) return std::atoi(text);
  const auto found = registry().cases.find(name);
  return found == registry().cases.end() ? 1 : found->second.num_threads;
}

}  // namespace

int serve(const std::string& name, const std::string& side) {
  Work work;
  try {
    set_num_threads(num_threads_of(name));
    work = prepared(name, side);
  } catch (const Skipped& skipped) {
    std::cout << "skip " << skipped.why << std::endl;
    return 0;
  } catch (const std::exception& error) {
    std::cout << "skip " << error.what() << std::endl;
    return 1;
  }
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    const auto begin = std::chrono::steady_clock::now();
    const Figures figures = work();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    std::cout << nlohmann::json{{"seconds", seconds.count()}, {"figures", figures}} << std::endl;
  }
  return 0;
}

}  // namespace adit::bench
