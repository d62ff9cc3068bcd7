// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// adit_bench: times adit and its peers alternately, in one table.
#include <CLI/CLI.hpp>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <thread>

#include "adit/core/version.hpp"
#include "harness/compare.hpp"
#include "harness/page.hpp"
#include "harness/serve.hpp"

namespace {

using namespace adit::bench;
namespace fs = std::filesystem;

std::string read(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write(const fs::path& path, const std::string& text) {
  if (path.has_parent_path()) fs::create_directories(path.parent_path());
  std::ofstream(path) << text;
}

Results read_results(const fs::path& path) {
  if (path.empty() || !fs::exists(path)) return {};
  return results_from(nlohmann::json::parse(read(path)));
}

std::string machine() {
  std::ifstream cpu("/proc/cpuinfo");
  for (std::string line; std::getline(cpu, line);) {
    if (line.starts_with("model name"))
      return line.substr(line.find(':') + 2) + ", " + std::to_string(std::thread::hardware_concurrency()) +
             " threads";
  }
  return "unknown processor";
}

std::string today() {
  const std::time_t now = std::time(nullptr);
  char text[16];
  std::strftime(text, sizeof text, "%F", std::gmtime(&now));
  return text;
}

bool wanted(const std::string& name, const std::vector<std::string>& filters) {
  return filters.empty() || std::ranges::any_of(filters, [&](const std::string& f) {
           return name.find(f) != std::string::npos;
         });
}

struct Files {
  fs::path results;   // of this run, and of earlier ones of other cases
  fs::path recorded;  // of the last recorded version
};

void run(const std::vector<std::string>& filters, const CompareConfig& config, const Files& files) {
  const Results recorded = read_results(files.recorded);
  const Measured measured{config.version, machine(), today()};
  Results now;
  std::cout << table_head() << std::flush;
  for (const auto& [name, info] : registry().cases) {
    if (!wanted(name, filters)) continue;
    CaseResult& result = now.cases.emplace_back(compare(info, config));
    result.measured = measured;
    std::cout << table_row(result, recorded) << std::flush;
  }
  for (const auto& [name, info] : registry().growths) {
    if (wanted(name, filters)) now.growths.emplace_back(grow(info, config)).measured = measured;
  }
  write(files.results, json_of(merged(now, read_results(files.results))).dump(1) + "\n");
}

void record(const Files& files) {
  const Results kept = recordable(read_results(files.results), read_results(files.recorded));
  write(files.recorded, json_of(kept).dump(1) + "\n");
}

void plot(const Files& files, const fs::path& folder) {
  for (const GrowthResult& growth : read_results(files.results).growths)
    write(folder / figure_name(growth), plot_growth(growth));
}

void list_cases() {
  for (const auto& [key, prepare] : registry().sides) {
    if (key.second == "adit") std::cout << key.first << "\n";
  }
}

}  // namespace

int main(int argc, char** argv) try {
  CLI::App app("Times adit and its peers: each side in its own process, alternating, on the same input.");
  app.require_subcommand(1);
  app.add_subcommand("list", "name the cases that adit takes part in")->callback(list_cases);

  std::string name;
  std::string side;
  int status = 0;
  auto* server = app.add_subcommand("serve", "be one side of a case (used by `run`)");
  server->add_option("case", name)->required();
  server->add_option("side", side)->required();
  server->callback([&] { status = serve(name, side); });

  std::vector<std::string> filters;
  CompareConfig config;
  config.version = adit::version();
  Files files;
  auto* runner = app.add_subcommand("run", "time the cases and growth curves, print the table");
  runner->add_option("filters", filters, "only those whose name holds one of these");
  runner->add_option("--rounds", config.rounds, "runs of each side")->check(CLI::PositiveNumber);
  runner->add_option("--seconds", config.seconds_per_case, "time for one case, about");
  runner->add_option("--peers", config.peers, "folder of further programs, see bench/README.md")
      ->check(CLI::ExistingDirectory);
  runner->add_option("--inputs", config.inputs, "folder that `export` has filled, for these programs");
  runner->add_option("--base", config.base, "an older adit_bench to compare with")->check(CLI::ExistingFile);
  runner->add_option("--version-name", config.version, "name of what is measured");
  runner->add_option("--results", files.results, "where the figures go")->required();
  runner->add_option("--recorded", files.recorded, "figures of the last recorded version");
  runner->callback([&] {
    config.program = fs::canonical("/proc/self/exe").string();
    run(filters, config, files);
  });

  fs::path folder;
  auto* exporter = app.add_subcommand("export", "write the inputs for programs outside");
  exporter->add_option("folder", folder)->required();
  exporter->callback([&] {
    for (const auto& [topic, write_inputs] : registry().exports) {
      fs::create_directories(folder / topic);
      write_inputs(folder / topic);
    }
  });

  auto* recorder = app.add_subcommand("record", "make figures of a committed version the recorded ones");
  recorder->add_option("--results", files.results)->required()->check(CLI::ExistingFile);
  recorder->add_option("--recorded", files.recorded)->required();
  recorder->callback([&] { record(files); });

  fs::path figures;
  auto* plotter = app.add_subcommand("plot", "draw the growth curves");
  plotter->add_option("--results", files.results)->required()->check(CLI::ExistingFile);
  plotter->add_option("--out", figures, "folder for the pictures")->required();
  plotter->callback([&] { plot(files, figures); });

  CLI11_PARSE(app, argc, argv);
  return status;
} catch (const Skipped& skipped) {
  std::cerr << "adit_bench: " << skipped.why << "\n";
  return 1;
} catch (const std::exception& error) {
  std::cerr << "adit_bench: " << error.what() << "\n";
  return 1;
}
