// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/study/loop_graphs.hpp"

#include <algorithm>
#include <deque>
#include <set>

#include "adit/core/format.hpp"
#include "adit/io/config_toml.hpp"
#include "adit/posegraph/optimizer.hpp"

namespace adit {
namespace {

Fields fields_of(ListedGraph& c) {
  return {{"name", &c.name, "", 0, 0, "what tables call the graph"},
          {"path", &c.path, "", 0, 0, "a g2o file, or a folder of them, one per robot"},
          {"injection",
           &c.injection,
           "",
           0,
           0,
           "how false loops are added, or that the file has its own",
           {"random", "clustered", "as found"}},
          {"seed", &c.seed, "", 0, 1e15, "seed of the added false loops"},
          {"keep_every", &c.keep_every, "", 1, 1e6, "one in so many true loops is kept"},
          {"information_scale", &c.information_scale, "", 1e-9, 1e9, "factor on all information matrices"},
          {"large", &c.large, "", 0, 0, "plain GNC and PCM would take too long, and are left out"},
          {"max_tilt_deg", &c.max_tilt_deg, "deg", 0.0, 90.0, "as found: loops that tilt by more are false"}};
}

Result<> check(const std::deque<ListedGraph>& graphs) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const ListedGraph& graph : graphs) {
    if (graph.name.empty()) return fail("an entry has no name; add name = \"...\"");
    if (graph.path.empty())
      return fail(graph.name + " has no path; add path = \"...\" of a g2o file or folder");
    if (!seen.emplace(graph.name, graph.injection).second)
      return fail(
          format("two entries are called '{}' with injection '{}'; rename one", graph.name, graph.injection));
    if ((graph.injection == "as found") != (graph.max_tilt_deg > 0.0))
      return fail(graph.name +
                  ": max_tilt_deg goes with injection 'as found' and with no other; add it or remove it");
  }
  return {};
}

Result<G2oFile> read_folder(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".g2o") paths.push_back(entry.path());
  if (paths.empty()) return fail(folder.string() + ": the folder holds no .g2o file; name one that does");
  std::ranges::sort(paths);
  std::vector<G2oFile> files;
  for (const std::filesystem::path& path : paths) {
    Result<G2oFile> file = read_g2o(path);
    if (!file) return file;
    files.push_back(std::move(*file));
  }
  Result<G2oFile> merged = merge_g2o(files);
  if (!merged) return fail(folder.string(), merged.error());
  return merged;
}

}  // namespace

Result<std::vector<ListedGraph>> read_graph_list(const std::filesystem::path& list,
                                                 const std::filesystem::path& data) {
  std::deque<ListedGraph> graphs;  // Entries stay where they are while others are added.
  const Result<> loaded =
      load_entries(list, "graph", [&] { return fields_of(graphs.emplace_back()); }).and_then([&] {
        return check(graphs).map_error(
            [&](const Error& error) { return Error{list.string() + ": " + error.message}; });
      });
  if (!loaded) return tl::unexpected(loaded.error());
  const std::filesystem::path base = data.empty() ? list.parent_path() : data;
  for (ListedGraph& graph : graphs) graph.path = (base / graph.path).lexically_normal().string();
  return std::vector<ListedGraph>(graphs.begin(), graphs.end());
}

Result<G2oFile> read_listed(const ListedGraph& graph) {
  Result<G2oFile> file =
      std::filesystem::is_directory(graph.path) ? read_folder(graph.path) : read_g2o(graph.path);
  if (!file) return file;
  std::visit(
      [&](auto& g) {
        for (auto& edge : g.edges) edge.information *= graph.information_scale;
      },
      file->graph);
  const std::size_t bad = std::visit([](const auto& g) { return indefinite_edges(g).size(); }, file->graph);
  if (bad > 0)
    return fail(
        format("{}: {} information matrices are indefinite; repair the file (adit solve --repair "
               "--out) or remove it from the list",
               graph.path, bad));
  return file;
}

}  // namespace adit
