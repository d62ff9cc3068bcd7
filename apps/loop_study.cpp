// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/loop_study.hpp"

#include <cstdio>
#include <memory>

#include "adit/io/atomic_file.hpp"
#include "adit/io/folders.hpp"
#include "adit/report/text_tables.hpp"
#include "adit/study/incremental_study.hpp"
#include "adit/study/page_tables.hpp"
#include "command_line.hpp"

namespace adit::app {
namespace {

constexpr const char* kLoopStudySection = "false loops";

struct LoopStudyOptions {
  std::string graphs;
  std::string data;
  std::string out;
  std::string page;
  std::vector<int> shares = LoopStudy{}.shares;
  std::vector<std::string> only;
  bool incremental = false;
};

/// Every run of every chosen graph; prints one line of text per run, to stderr if JSON goes to stdout.
Result<std::vector<FalseLoopRun>> run_all(const LoopStudyOptions& options, const Common& common,
                                          const BackEndConfig& back_end) {
  const Result<std::vector<ListedGraph>> list = read_graph_list(options.graphs, options.data);
  if (!list) return tl::unexpected(list.error());
  const Result<ChosenGraphs> chosen = chosen_graphs(options.graphs, *list, options.only);
  if (!chosen) return tl::unexpected(chosen.error());
  print_notes("loop-study", chosen->notes);
  std::vector<FalseLoopRun> runs;
  const auto take = [&](FalseLoopRun run) {
    std::FILE* lines = common.json ? stderr : stdout;
    std::fprintf(lines, "%s\n", summary_line(run).c_str());
    std::fflush(lines);
    runs.push_back(std::move(run));
  };
  const LoopStudy study{back_end.gnc, back_end.pcm, options.shares, take};
  for (const ListedGraph& graph : chosen->graphs)
    if (const Result<> done = run_graph(graph, study); !done) return tl::unexpected(done.error());
  return runs;
}

Result<> loop_study(const LoopStudyOptions& options, const Common& common) {
  const Result<RunConfig> config = configured(common);
  if (!config) return tl::unexpected(config.error());
  if (const Result<> made = make_folder(options.out); !made) return made;
  const Result<std::vector<FalseLoopRun>> runs = run_all(options, common, config->slam.back_end);
  if (!runs) return tl::unexpected(runs.error());
  const std::string json = json_of(*runs);
  const std::vector<Table> tables = false_loop_tables(*runs);
  Result<> done = write_bytes(std::filesystem::path(options.out) / "false_loops.json", json);
  if (done && !options.page.empty()) done = write_tables(options.page, kLoopStudySection, tables);
  if (done && common.json) std::printf("%s", json.c_str());
  if (done && !common.json)
    for (const Table& table : tables) std::printf("\n%s", text_of(table).c_str());
  return done;
}

/// Step by step instead of at once.
Result<> incremental_study(const LoopStudyOptions& options, const Common& common) {
  if (const Result<> made = make_folder(options.out); !made) return made;
  const Result<std::vector<ListedGraph>> list = read_graph_list(options.graphs, options.data);
  if (!list) return tl::unexpected(list.error());
  const Result<ChosenGraphs> chosen = chosen_graphs(options.graphs, *list, options.only);
  if (!chosen) return tl::unexpected(chosen.error());
  print_notes("loop-study", chosen->notes);
  std::vector<IncrementalRun> runs;
  for (const ListedGraph& graph : chosen->graphs) {
    for (const int share : options.shares) {
      const auto run = run_incremental(graph, RobustIncrementalConfig{}, {share});
      if (!run) return tl::unexpected(run.error());
      runs.push_back(run->front());
      std::fprintf(common.json ? stderr : stdout, "%s\n", summary_line(runs.back()).c_str());
      std::fflush(common.json ? stderr : stdout);
    }
  }
  const std::string json = json_of(runs);
  Result<> done = write_bytes(std::filesystem::path(options.out) / "incremental.json", json);
  if (done && common.json) std::printf("%s", json.c_str());
  return done;
}

}  // namespace

void add_loop_study(Program& program) {
  const auto options = std::make_shared<LoopStudyOptions>();
  const Command command = program.add_command(
      "loop-study",
      "Measure which false loops plain GNC, PCM and adit's own search find, over a list of pose graphs",
      [options](const Common& common) {
        return options->incremental ? incremental_study(*options, common) : loop_study(*options, common);
      });
  command.add_option("--graphs", options->graphs, "The list (TOML, as bench/merge/graphs.toml)").required();
  command.add_option("--data", options->data,
                     "Folder that the paths of the list are relative to (default: the list's own)");
  command
      .add_option("--out", options->out,
                  "Folder that takes the results (false_loops.json or incremental.json)")
      .required();
  command.add_option("--shares", options->shares, "Per cent of all loops that are false, separated by commas")
      .separated_by_commas()
      .in_range(0, 99)
      .default_shown();
  command.add_flag("--incremental", options->incremental,
                   "Keyframe by keyframe, judged at every step, with random false loops (of the incremental "
                   "solver alone)");
  command.add_option("--only", options->only, "Only the graphs with these names").separated_by_commas();
  command.add_option("--page", options->page,
                     "Markdown file whose section between 'false loops' marks takes the tables");
}

}  // namespace adit::app
