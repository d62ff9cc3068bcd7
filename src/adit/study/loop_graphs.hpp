// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// The list of pose graphs over which the rejection of false loops is measured.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "adit/core/result.hpp"
#include "adit/io/g2o.hpp"

namespace adit {

/// One entry [[graph]] of the list.
struct ListedGraph {
  std::string name;  ///< What tables call it; with `injection` unique in the list.
  std::string path;  ///< A g2o file, or a folder of them, one per robot.
  std::string injection =
      "random";  ///< How false loops are added: "random", "clustered"; "as found": the file has its own.
  std::uint64_t seed = 1;          ///< Of the injection.
  std::uint64_t keep_every = 1;    ///< One in so many true loops is kept.
  double information_scale = 1.0;  ///< Factor on information matrices; below 1 where overconfident.
  bool large = false;              ///< Plain GNC and PCM would take too long, and are left out.
  double max_tilt_deg =
      0.0;  ///< Only "as found": loops that tilt by more are false, as the robots drove on a floor.
};

/// In the order of the file. A relative `path` starts at `data`, or at the list's own folder where `data` is
/// empty. Fails, naming the file and the remedy, on an entry without name or path, on two of the same name
/// and injection, and where `max_tilt_deg` is missing or not allowed.
Result<std::vector<ListedGraph>> read_graph_list(const std::filesystem::path& list,
                                                 const std::filesystem::path& data);

/// Reads the graph, or merges all graphs of the folder, and scales the information. Does not thin it. Fails
/// on what `read_g2o` and `merge_g2o` refuse, on a folder without g2o files, and on indefinite information
/// matrices.
Result<G2oFile> read_listed(const ListedGraph& graph);

}  // namespace adit
