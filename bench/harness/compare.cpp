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

// What a case's side needs to be started.
struct Entrant {
  std::string side;
  Launch launch;
  About about;
  std::string objection;  // why it may not take part, or empty
};

Launch launched(std::vector<std::string> command, const std::map<std::string, std::string>& environment,
                int num_threads) {
  const std::string threads = std::to_string(num_threads);
  Launch launch{std::move(command), environment, num_threads};
  launch.environment.try_emplace("ADIT_BENCH_THREADS", threads);
  launch.environment.try_emplace("OMP_NUM_THREADS", threads);
  launch.environment.try_emplace("OPENBLAS_NUM_THREADS", threads);
  return launch;
}

bool does(const fs::path& program, const std::string& case_name) {
  ChildProcess list(Launch{.command = {program.string(), "list"}});
  while (const auto line = list.read_line()) {
    if (*line == case_name) return true;
  }
  return false;
}

// What a program outside this repository states about itself; the objection when it states too little.
void ask_about(Entrant& entrant, const fs::path& program, const std::string& case_name) try {
  ChildProcess child(Launch{.command = {program.string(), "about", case_name}});
  const auto answer = nlohmann::json::parse(child.read_line().value_or(""));
  entrant.about = {answer.at("version"), answer.at("build"), answer.at("timed"), answer.at("threads"),
                   answer.value("environment", std::map<std::string, std::string>())};
} catch (const nlohmann::json::exception&) {
  entrant.objection = "states no version, build, threads and what it times";
}

std::vector<Entrant> entrants_of(const CaseInfo& info, const CompareConfig& config) {
  std::vector<Entrant> out;
  for (const auto& [key, side] : registry().sides) {
    if (key.first != info.name) continue;
    About about = side.about;
    if (key.second == "adit" && !config.version.empty()) about.version = "adit " + config.version;
    out.push_back(
        {key.second,
         launched({config.program, "serve", info.name, key.second}, about.environment, info.num_threads),
         about,
         {}});
  }
  if (!config.base.empty() && does(config.base, info.name))
    out.push_back({"previous",
                   launched({config.base.string(), "serve", info.name, "adit"}, {}, info.num_threads),
                   {"adit, the older version", "as adit", "as adit", 0, {}},
                   {}});
  if (!config.peers.empty()) {
    for (const auto& file : fs::directory_iterator(config.peers)) {
      if (!does(file.path(), info.name)) continue;
      Entrant& entrant = out.emplace_back();
      entrant.side = file.path().filename().string();
      ask_about(entrant, file.path(), info.name);
      entrant.launch = launched({file.path().string(), "serve", info.name, config.inputs.string()},
                                entrant.about.environment, info.num_threads);
    }
  }
  const auto rank = [&](const std::string& side) { return side == "adit" ? 0 : side == info.peer ? 1 : 2; };
  std::ranges::sort(out, [&](const Entrant& a, const Entrant& b) {
    return std::pair(rank(a.side), a.side) < std::pair(rank(b.side), b.side);
  });
  for (Entrant& entrant : out) {
    if (entrant.about.num_threads == 0) entrant.about.num_threads = info.num_threads;
    if (num_processors() < info.num_threads)
      entrant.objection = "needs " + std::to_string(info.num_threads) + " processors";
  }
  return out;
}

// One run; its seconds per unit. A side that fails is skipped from then on.
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

Runner started(const Entrant& entrant) {
  Runner runner;
  runner.result.side = entrant.side;
  runner.result.about = entrant.about;
  runner.result.skipped = entrant.objection;
  if (!entrant.objection.empty()) return runner;
  runner.process = std::make_unique<ChildProcess>(entrant.launch);
  const std::string answer = runner.process->read_line().value_or("skip the program did not start");
  if (answer != "ready") runner.result.skipped = answer.starts_with("skip ") ? answer.substr(5) : answer;
  return runner;
}

void run_in_turns(std::vector<Runner>& runners, double per_run, const CompareConfig& config) {
  const auto begin = std::chrono::steady_clock::now();
  for (Runner& runner : runners) run_once(runner, per_run, false);
  for (int round = 0; round < config.rounds; ++round) {
    const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin;
    if (round >= 3 && used.count() > config.seconds_per_case) break;
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
  for (const Entrant& entrant : entrants_of(info, config)) runners.push_back(started(entrant));
  run_in_turns(runners, info.per_run, config);
  CaseResult result{info, {}, {}};
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
  constexpr double kLongRun = 5.0;  // seconds of the whole run; once is enough then
  GrowthResult result{{}, info.name, info.title, info.size_label, {}};
  for (const double size : info.sizes) {
    Launch launch = launched({config.program, "serve", info.name, std::to_string(size)}, {}, 1);
    launch.num_processors = 0;  // `adit study` runs on all, as users run it
    Runner runner = started({"adit", launch, {}, {}});
    const double shares = info.shares ? info.shares(size) : 1.0;
    for (int i = 0;
         i < kRuns && runner.result.skipped.empty() && (i == 0 || runner.seconds.back() * shares < kLongRun);
         ++i)
      run_once(runner, shares, true);
    runner.result.seconds = spread_of(runner.seconds);
    result.points.push_back({size, std::move(runner.result)});
  }
  return result;
}

}  // namespace adit::bench
