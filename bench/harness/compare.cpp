// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "harness/compare.hpp"

#include <algorithm>
#include <chrono>
#include <memory>
#include <nlohmann/json.hpp>

#include "adit/evaluation/statistics.hpp"
#include "harness/child_process.hpp"

namespace adit::bench {
namespace {

namespace fs = std::filesystem;

// A side under way.
struct Runner {
  SideResult result;
  std::unique_ptr<ChildProcess> process;
  std::vector<double> seconds;
};

bool does(const fs::path& program, const std::string& case_name) {
  ChildProcess list({program.string(), "list"});
  while (const auto line = list.read_line()) {
    if (*line == case_name) return true;
  }
  return false;
}

std::vector<std::pair<std::string, std::vector<std::string>>> commands_of(const CaseInfo& info,
                                                                          const CompareConfig& config) {
  std::vector<std::pair<std::string, std::vector<std::string>>> out;
  for (const auto& [key, prepare] : registry().sides) {
    if (key.first == info.name)
      out.emplace_back(key.second, std::vector{config.program, std::string("serve"), info.name, key.second});
  }
  if (!config.base.empty() && does(config.base, info.name))
    out.emplace_back("previous",
                     std::vector{config.base.string(), std::string("serve"), info.name, std::string("adit")});
  if (!config.peers.empty()) {
    for (const auto& entry : fs::directory_iterator(config.peers)) {
      if (does(entry.path(), info.name))
        out.emplace_back(
            entry.path().filename().string(),
            std::vector{entry.path().string(), std::string("serve"), info.name, config.inputs.string()});
    }
  }
  const auto rank = [&](const std::string& side) { return side == "adit" ? 0 : side == info.peer ? 1 : 2; };
  std::ranges::sort(out, [&](const auto& a, const auto& b) {
    return std::pair(rank(a.first), a.first) < std::pair(rank(b.first), b.first);
  });
  return out;
}

// One run; its seconds for one unit. A side that fails is skipped from then on.
void run_once(Runner& runner, double per_run, bool counts) {
  if (!runner.result.skipped.empty()) return;
  runner.process->write_line("run");
  const auto line = runner.process->read_line();
  if (!line) {
    runner.result.skipped = "the program ended in the middle";
    return;
  }
  const auto answer = nlohmann::json::parse(*line);
  runner.result.figures = answer.at("figures").get<Figures>();
  runner.result.peak_mb = runner.process->peak_mb();
  if (counts) runner.seconds.push_back(answer.at("seconds").get<double>() / per_run);
}

Runner started(const std::string& side, const std::vector<std::string>& command) {
  Runner runner;
  runner.result.side = side;
  runner.process = std::make_unique<ChildProcess>(command);
  const std::string answer = runner.process->read_line().value_or("skip the program did not start");
  if (answer != "ready") runner.result.skipped = answer.starts_with("skip ") ? answer.substr(5) : answer;
  return runner;
}

void run_in_turns(std::vector<Runner>& runners, double per_run, const CompareConfig& config) {
  const auto begin = std::chrono::steady_clock::now();
  for (Runner& runner : runners) run_once(runner, per_run, false);
  for (int round = 0; round < config.rounds; ++round) {
    const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin;
    if (round >= 3 && used.count() > config.seconds_a_case) break;
    for (Runner& runner : runners) run_once(runner, per_run, true);
  }
}

}  // namespace

Spread spread_of(std::vector<double> values) {
  if (values.empty()) return {};
  return {*std::ranges::min_element(values), median(values), *std::ranges::max_element(values)};
}

const SideResult* CaseResult::side(const std::string& name) const {
  const auto found = std::ranges::find(sides, name, &SideResult::side);
  return found == sides.end() ? nullptr : &*found;
}

CaseResult compare(const CaseInfo& info, const CompareConfig& config) {
  std::vector<Runner> runners;
  for (const auto& [side, command] : commands_of(info, config)) runners.push_back(started(side, command));
  run_in_turns(runners, info.per_run, config);
  CaseResult result{info, {}};
  for (Runner& runner : runners) {
    runner.result.seconds = spread_of(runner.seconds);
    std::vector<double> ratios;
    const std::vector<double>& ours = runners.front().seconds;
    for (std::size_t i = 0; i < std::min(ours.size(), runner.seconds.size()); ++i)
      ratios.push_back(runner.seconds[i] / ours[i]);
    runner.result.ratio = spread_of(ratios);
    result.sides.push_back(runner.result);
  }
  const auto is_there = [&](const std::string& side) { return side.empty() || result.side(side) != nullptr; };
  if (!is_there(info.peer)) {
    SideResult& absent = result.sides.emplace_back();
    absent.side = info.peer;
    absent.skipped = "not on this machine";
  }
  return result;
}

GrowthResult grow(const GrowthInfo& info, const CompareConfig& config) {
  constexpr int kRuns = 3;
  constexpr double kLongRun = 5.0;  // seconds; once is enough then
  GrowthResult result{info.name, info.title, info.size_label, {}};
  for (const double size : info.sizes) {
    Runner runner = started("adit", {config.program, "serve", info.name, std::to_string(size)});
    for (int i = 0;
         i < kRuns && runner.result.skipped.empty() && (i == 0 || runner.seconds.back() < kLongRun); ++i)
      run_once(runner, info.shares ? info.shares(size) : 1.0, true);
    runner.result.seconds = spread_of(runner.seconds);
    result.points.push_back({size, std::move(runner.result)});
  }
  return result;
}

}  // namespace adit::bench
