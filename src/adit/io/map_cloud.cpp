// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/map_cloud.hpp"

#include "adit/core/check.hpp"
#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/packed_cloud.hpp"
#include "adit/io/text.hpp"

namespace adit {
namespace {

/// A number of each point.
struct Column {
  std::string in_ply;
  std::string in_pcd;
  bool is_float = true;  // or a uint16
};

std::vector<Column> columns_of(const MapCloud& map) {
  std::vector<Column> columns = {{"x", "x"}, {"y", "y"}, {"z", "z"}};
  if (!map.cloud.intensities.empty()) columns.push_back({"intensity", "intensity"});
  if (!map.normals.empty())
    for (const std::string axis : {"x", "y", "z"}) columns.push_back({"n" + axis, "normal_" + axis});
  columns.push_back({"robot", "robot", false});
  return columns;
}

std::string rows_of(const MapCloud& map) {
  std::string rows;
  for (std::size_t i = 0; i < map.cloud.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) append_little_endian(rows, map.cloud.points[i][axis]);
    if (!map.cloud.intensities.empty()) append_little_endian(rows, map.cloud.intensities[i]);
    for (Eigen::Index axis = 0; !map.normals.empty() && axis < 3; ++axis)
      append_little_endian(rows, map.normals[i][axis]);
    append_little_endian(rows, map.robots[i]);
  }
  return rows;
}

std::string ply_header(const MapCloud& map, const std::string& comment) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  if (!comment.empty()) text += "comment " + comment + "\n";
  text += format("element vertex {}\n", map.cloud.size());
  for (const Column& column : columns_of(map))
    text += format("property {} {}\n", column.is_float ? "float" : "ushort", column.in_ply);
  return text + "end_header\n";
}

std::string pcd_header(const MapCloud& map, const std::string& comment) {
  std::string names;
  std::string sizes;
  std::string types;
  std::string counts;
  for (const Column& column : columns_of(map)) {
    names += " " + column.in_pcd;
    sizes += column.is_float ? " 4" : " 2";
    types += column.is_float ? " F" : " U";
    counts += " 1";
  }
  return format(
      "# .PCD v0.7 - Point Cloud Data file format\n{}VERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\nCOUNT{}\nWIDTH "
      "{}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA binary\n",
      comment.empty() ? "" : "# " + comment + "\n", names, sizes, types, counts, map.cloud.size(),
      map.cloud.size());
}

}  // namespace

Result<> write_map_cloud(const std::filesystem::path& path, const MapCloud& map, const std::string& comment) {
  map.cloud.check();
  ADIT_CHECK(map.robots.size() == map.cloud.size(), "one robot per point");
  ADIT_CHECK(map.normals.empty() || map.normals.size() == map.cloud.size(), "one normal per point, or none");
  if (map.cloud.empty()) return fail(path.string() + ": the map has no points");
  const std::string extension = lower_case(path.extension().string());
  if (extension == ".ply") return write_bytes(path, ply_header(map, comment) + rows_of(map));
  if (extension == ".pcd") return write_bytes(path, pcd_header(map, comment) + rows_of(map));
  return fail(path.string() + ": the cloud of a map becomes .ply or .pcd");
}

}  // namespace adit
