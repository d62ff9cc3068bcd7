// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/csv.hpp"
#include "adit/io/georeference.hpp"
#include "adit/io/text.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

constexpr std::array kNeededColumns = {"name", "x", "y", "z", "sigma"};
constexpr std::array kFurtherColumns = {"sigma_z", "role",   "robot",      "stamp",      "mark_x",
                                        "mark_y",  "mark_z", "mark_frame", "mark_sigma", "comment"};
const std::map<std::string, std::string> kOtherColumnNames = {
    {"easting", "x"}, {"northing", "y"}, {"height", "z"}, {"elevation", "z"}};

std::string trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return "";
  return std::string(text.substr(first, text.find_last_not_of(" \t") - first + 1));
}

/// The column of each name.
using Columns = std::map<std::string, std::size_t>;

Result<Columns> columns_of(const CsvRow& heading) {
  Columns columns;
  for (std::size_t i = 0; i < heading.cells.size(); ++i) {
    std::string name = lower_case(trimmed(heading.cells[i]));
    if (i == 0 && name.starts_with("\xEF\xBB\xBF")) name.erase(0, 3);  // as spreadsheets begin a file
    if (const auto other = kOtherColumnNames.find(name); other != kOtherColumnNames.end())
      name = other->second;
    const auto is_name = [&](const char* known) { return name == known; };
    if (std::ranges::none_of(kNeededColumns, is_name) && std::ranges::none_of(kFurtherColumns, is_name))
      return fail(
          format("line {}: no column is called '{}'; the columns are {}, and where they are needed {}{}",
                 heading.line, name, fmt::join(kNeededColumns, ", "), fmt::join(kFurtherColumns, ", "),
                 name.find(';') == std::string::npos ? "" : "; commas part them, not semicolons"));
    if (!columns.emplace(name, i).second)
      return fail(format("line {}: the column '{}' occurs twice", heading.line, name));
  }
  for (const char* needed : kNeededColumns)
    if (!columns.contains(needed))
      return fail(format("line {}: the column '{}' is missing; the first line names the columns {}",
                         heading.line, needed, fmt::join(kNeededColumns, ", ")));
  return columns;
}

/// One row by the names of its cells; the first thing that is wrong is kept.
class ControlRow {
 public:
  ControlRow(const Columns& columns, const CsvRow& row) : columns_(columns), row_(row) {
    if (row.cells.size() > columns.size())
      wrong(format("{} cells under {} columns", row.cells.size(), columns.size()));
  }

  [[nodiscard]] std::string text(const std::string& name) const {
    const auto column = columns_.find(name);
    return column == columns_.end() || column->second >= row_.cells.size()
               ? ""
               : trimmed(row_.cells[column->second]);
  }
  double number(const std::string& name) {
    const std::optional<double> value = parse_double(text(name));
    if (value && std::isfinite(*value)) return *value;
    wrong(text(name).empty()
              ? format("{} is missing", name)
              : format("{} is '{}', which is no number (with a point, in metres)", name, text(name)));
    return 0.0;
  }
  double sigma(const std::string& name, double otherwise) {
    if (text(name).empty()) return otherwise;
    const double value = number(name);
    if (error_.empty() && !(value > 0.0))
      wrong(format("{} is {}; a standard deviation is more than 0, in metres", name, value));
    return value;
  }
  void wrong(const std::string& what) {
    if (error_.empty()) error_ = format("line {}: {}", row_.line, what);
  }
  [[nodiscard]] const std::string& error() const { return error_; }

 private:
  const Columns& columns_;
  const CsvRow& row_;
  std::string error_;
};

/// A mark in a map has the map's frame alone. A row without a mark is about the robot's base; that the LiDAR
/// is meant has to be said by numbers.
bool is_in_lidar_frame(ControlRow& row, const ControlMark& mark, bool has_position) {
  const std::string frame = lower_case(row.text("mark_frame"));
  if (frame.empty()) return false;
  if (frame != "base" && frame != "lidar")
    row.wrong(format("mark_frame is '{}'; it is base or lidar", frame));
  else if (!mark.stamp)
    row.wrong(
        "mark_frame is for marks in a scan: give robot and stamp, or leave mark_frame empty for a mark in "
        "map.ply");
  else if (frame == "lidar" && !has_position)
    row.wrong("mark_frame is lidar, and mark_x, mark_y and mark_z are missing; 0, 0, 0 is the LiDAR itself");
  return frame == "lidar";
}

ControlMark mark_of(ControlRow& row) {
  ControlMark mark;
  mark.robot = row.text("robot");
  mark.sigma = row.sigma("mark_sigma", mark.sigma);
  const std::string stamp = row.text("stamp");
  if (!stamp.empty()) {
    mark.stamp = parse_stamp(stamp);
    if (!mark.stamp) row.wrong(format("stamp is '{}', which is no decimal number of seconds", stamp));
    if (mark.robot.empty()) row.wrong("a stamp says when, and the column robot has to say whose");
  }
  const bool has_position =
      !row.text("mark_x").empty() || !row.text("mark_y").empty() || !row.text("mark_z").empty();
  if (has_position)
    mark.position = {row.number("mark_x"), row.number("mark_y"), row.number("mark_z")};
  else if (!mark.stamp)
    row.wrong(
        "nothing says where the point is in the map: give mark_x, mark_y and mark_z as picked in map.ply, or "
        "robot and stamp of a known pose");
  mark.is_in_lidar_frame = is_in_lidar_frame(row, mark, has_position);
  return mark;
}

Result<ControlPoint> control_point_of(const Columns& columns, const CsvRow& cells) {
  ControlRow row(columns, cells);
  ControlPoint point;
  point.name = row.text("name");
  if (point.name.empty()) row.wrong("name is missing");
  point.target = {row.number("x"), row.number("y"), row.number("z")};
  if (row.text("sigma").empty())
    row.wrong("sigma is missing: the standard deviation of x, y and z in metres");
  point.sigma_xy = row.sigma("sigma", 0.0);
  point.sigma_z = row.sigma("sigma_z", point.sigma_xy);
  const std::string role = lower_case(row.text("role"));
  if (!role.empty() && role != "control" && role != "check")
    row.wrong(format("role is '{}'; it is control or check", role));
  point.is_check = role == "check";
  point.mark = mark_of(row);
  if (!row.error().empty()) return fail(row.error());
  return point;
}

}  // namespace

Result<std::vector<ControlPoint>> parse_control_points(std::string_view csv) {
  const Result<std::vector<CsvRow>> rows = parse_csv(csv);
  if (!rows) return tl::unexpected(rows.error());
  if (rows->empty())
    return fail(format("empty; the first line names the columns {}", fmt::join(kNeededColumns, ", ")));
  const Result<Columns> columns = columns_of(rows->front());
  if (!columns) return tl::unexpected(columns.error());
  std::vector<ControlPoint> points;
  std::set<std::string> names;
  for (std::size_t i = 1; i < rows->size(); ++i) {
    Result<ControlPoint> point = control_point_of(*columns, (*rows)[i]);
    if (!point) return tl::unexpected(point.error());
    if (!names.insert(point->name).second)
      return fail(format("line {}: the name '{}' occurs twice; give each sighting a name of its own",
                         (*rows)[i].line, point->name));
    points.push_back(std::move(*point));
  }
  if (points.empty()) return fail("no control points below the first line");
  return points;
}

Result<std::vector<ControlPoint>> read_control_points(const std::filesystem::path& path) {
  const Result<std::string> bytes = read_bytes(path);
  if (!bytes) return tl::unexpected(bytes.error());
  Result<std::vector<ControlPoint>> points = parse_control_points(*bytes);
  if (!points) return fail(path.string(), points.error());
  return points;
}

}  // namespace adit
