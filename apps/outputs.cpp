// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "outputs.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "adit/core/format.hpp"
#include "adit/core/robot_name.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/session_toml.hpp"
#include "adit/io/text.hpp"
#include "command_line.hpp"

namespace adit::app {

namespace fs = std::filesystem;

std::string trajectory_name_fault(const std::string& path) {
  constexpr std::array<std::string_view, 18> kOfOthers = {".mcap", ".db3",  ".bag", ".pcd", ".ply",   ".bin",
                                                          ".las",  ".laz",  ".g2o", ".jrl", ".cbor",  ".adit",
                                                          ".csv",  ".yaml", ".obj", ".stl", ".kitti", ".pgm"};
  const std::string extension = lower_case(fs::path(path).extension().string());
  if (std::ranges::find(kOfOthers, extension) == kOfOthers.end()) return "";
  return path + ": trajectories are written in TUM format, as .tum or .txt; adit convert makes others of it";
}

fs::path path_beside(const fs::path& out, const std::string& more) {
  fs::path path = out;
  return path.replace_filename(out.stem().string() + more + out.extension().string());
}

void refuse_to_replace_input(const std::string& in, const std::string& out) {
  std::error_code ignored;
  // FOLDER@even is read from FOLDER.
  const fs::path from = fs::exists(in, ignored) ? in : in.substr(0, in.rfind('@'));
  const auto is_input = [&](const fs::path& path) { return fs::equivalent(path, from, ignored); };
  const fs::path folder = fs::absolute(out, ignored).parent_path();
  const bool is_file_of_it = fs::is_regular_file(out, ignored) && is_input(folder);
  if (is_input(out) || is_file_of_it)
    usage_error(format("{} is what is read, and would be replaced; give another OUT", out));
}

Result<> check_keeps_robots(const std::string& path, const std::vector<std::string>& names) {
  const fs::path session = path;
  std::error_code ignored;
  if (!fs::exists(session / "session.toml", ignored)) return {};
  const auto header = read_bytes(session / "session.toml").and_then([](const std::string& text) {
    return parse_session_toml(text);
  });
  if (!header) return {};  // a damaged session names no robots
  std::vector<std::string> to_come;
  for (const std::string& name : names) to_come.push_back(robot_name(name));
  to_come = distinct_names(to_come);
  std::vector<std::string> lost;
  for (const std::string& robot : header->robots)
    if (std::ranges::find(to_come, robot) == to_come.end() && fs::exists(session / robot, ignored))
      lost.push_back(robot);
  if (lost.empty()) return {};
  return fail(format(
      "{0}: holds a session with the map{1} of {2}, which this run would replace and does not have; add "
      "to it with adit slam --session {3}, give another --out, or remove the folder",
      path, lost.size() > 1 ? "s" : "", fmt::join(lost, ", "), shell_quoted(path)));
}

}  // namespace adit::app
