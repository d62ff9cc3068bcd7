// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/loops_csv.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <type_traits>

#include "adit/core/format.hpp"
#include "adit/fleet/joint/loop_account.hpp"
#include "adit/io/csv.hpp"
#include "adit/io/stated_pose.hpp"
#include "adit/io/tum.hpp"

namespace adit {
namespace {

using Cells = std::vector<std::string>;

/// All files begin with these columns; how many later ones follow, each file says itself.
const Cells& first_columns() {
  static const Cells columns = {"from_robot",
                                "from_keyframe",
                                "from_stamp",
                                "to_robot",
                                "to_keyframe",
                                "to_stamp",
                                "place_distance",
                                "inliers",
                                "overlap",
                                "weak_axis",
                                "verdict",
                                "pcm",
                                "gnc_weight",
                                "class",
                                "x",
                                "y",
                                "z",
                                "qx",
                                "qy",
                                "qz",
                                "qw",
                                "reason"};
  return columns;
}
constexpr std::size_t kClassColumn = 13;

Cells header() {
  Cells columns = first_columns();
  columns.insert(columns.end(), {"hypothesis", "merge_check", "registration"});
  return columns;
}

/// Sentences have no commas or line breaks in this file, so that tools that split at commas can read it.
std::string sentence(std::string text) {
  std::ranges::replace(text, ',', ';');
  std::ranges::replace(text, '\n', ' ');
  return text;
}

template <class Number>
std::string number_text(Number value) {
  return format("{}", value);
}

std::string loop_row(const Session& session, const LoopOutcome& outcome, std::string_view loop_class) {
  const LoopClosure& loop = outcome.loop;
  const bool accepted = loop.verdict == LoopVerdict::accepted;
  const auto name = [&](KeyframeId id) { return session.fleet.robots.at(id.robot).name; };
  const auto stamp = [&](KeyframeId id) {
    return stamp_text(session.fleet.robots.at(id.robot).nodes.at(id.index).stamp);
  };
  const Vector3& t = loop.T_from_to.translation();
  const Eigen::Quaterniond& q = loop.T_from_to.rotation();
  const LoopAccount account = account_of(outcome, session.fleet, session.solution);
  return csv_row({name(loop.from),
                  number_text(loop.from.index),
                  stamp(loop.from),
                  name(loop.to),
                  number_text(loop.to.index),
                  stamp(loop.to),
                  format("{:.4f}", loop.place_distance),
                  number_text(loop.num_inliers),
                  format("{:.4f}", loop.overlap),
                  format("{:.5f}", loop.weak_axis),
                  std::string(to_string(loop.verdict)),
                  !accepted             ? ""
                  : outcome.is_selected ? "kept"
                                        : "dropped",
                  accepted ? format("{:.4f}", outcome.weight) : "",
                  std::string(loop_class),
                  number_text(t.x()),
                  number_text(t.y()),
                  number_text(t.z()),
                  number_text(q.x()),
                  number_text(q.y()),
                  number_text(q.z()),
                  number_text(q.w()),
                  sentence(account.reason),
                  account.hypothesis ? number_text(*account.hypothesis + 1) : "",
                  account.merge_check,
                  sentence(loop.reason)});
}

/// Reads the numbers of a row. The first cell that holds none is kept for the error.
class NumberCells {
 public:
  explicit NumberCells(const Cells& cells) : cells_(cells) {}

  /// The whole cell as a finite number.
  template <class T>
  T at(std::size_t column) {
    const std::string& cell = cells_[column];
    T value{};
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    bool is_number = error == std::errc{} && end == cell.data() + cell.size();
    if constexpr (std::is_floating_point_v<T>) is_number = is_number && std::isfinite(value);
    if (!is_number && !bad_column_) bad_column_ = column;
    return is_number ? value : T{};
  }
  /// 0 where the cell is empty.
  template <class T>
  T at_or_zero(std::size_t column) {
    return cells_[column].empty() ? T{} : at<T>(column);
  }
  [[nodiscard]] Result<> checked() const {
    if (!bad_column_) return {};
    return fail(format("{}: '{}' is not a number as adit writes them; take the file from the run again",
                       first_columns()[*bad_column_], cells_[*bad_column_].substr(0, 40)));
  }

 private:
  const Cells& cells_;
  std::optional<std::size_t> bad_column_;
};

Result<Pose> pose_in(NumberCells& numbers) {
  constexpr double kRounded = 1e-3;  // numbers of adit's own
  const Eigen::Quaterniond q(numbers.at<double>(20), numbers.at<double>(17), numbers.at<double>(18),
                             numbers.at<double>(19));
  const Vector3 t(numbers.at<double>(14), numbers.at<double>(15), numbers.at<double>(16));
  if (const Result<> checked = numbers.checked(); !checked) return tl::unexpected(checked.error());
  const Result<Pose> pose = stated_pose(t, q, kRounded);
  return pose ? pose : fail("x to qw", pose.error());
}

Result<SavedLoop> saved_loop(const Cells& cells) {
  SavedLoop saved;
  const std::optional<Stamp> from = parse_stamp(cells[2]);
  const std::optional<Stamp> to = parse_stamp(cells[5]);
  if (!from || !to) return fail("a stamp is not a number of seconds");
  saved.from_robot = cells[0];
  saved.to_robot = cells[3];
  saved.from_stamp = *from;
  saved.to_stamp = *to;
  NumberCells numbers(cells);
  LoopClosure& loop = saved.loop;
  loop.from.index = numbers.at<std::uint32_t>(1);
  loop.to.index = numbers.at<std::uint32_t>(4);
  loop.place_distance = numbers.at<double>(6);
  loop.num_inliers = numbers.at<int>(7);
  loop.overlap = numbers.at<double>(8);
  loop.weak_axis = numbers.at<double>(9);
  loop.verdict = cells[10] == "accepted" ? LoopVerdict::accepted : LoopVerdict::rejected;
  saved.in_clique = cells[11] == "kept";
  saved.weight = numbers.at_or_zero<double>(12);  // of rejected loops the cell is empty
  const Result<Pose> pose = pose_in(numbers);
  if (!pose) return tl::unexpected(pose.error());
  loop.T_from_to = *pose;
  loop.reason = cells[21];
  return saved;
}

/// The rows of a file whose header and row lengths are right.
Result<std::vector<CsvRow>> checked_rows(std::string_view text) {
  Result<std::vector<CsvRow>> rows = parse_csv(text);
  if (!rows) return rows;
  const std::size_t num_first = first_columns().size();
  if (rows->empty() || rows->front().cells.size() < num_first ||
      !std::ranges::equal(first_columns(),
                          Cells(rows->front().cells.begin(),
                                rows->front().cells.begin() + static_cast<std::ptrdiff_t>(num_first))))
    return fail("line 1: not the header of a loops.csv");
  for (const CsvRow& row : *rows)
    if (row.cells.size() != rows->front().cells.size())
      return fail(
          format("line {}: {} cells instead of {}", row.line, row.cells.size(), rows->front().cells.size()));
  return rows;
}

}  // namespace

std::string loops_csv(const Session& session) {
  std::map<std::pair<KeyframeId, KeyframeId>, std::size_t> accepted;
  for (std::size_t l = 0; l < session.solution.loops.size(); ++l) {
    const LoopClosure& loop = session.solution.loops[l].loop;
    accepted[{loop.from, loop.to}] = l;
  }
  std::string text = csv_row(header());
  for (const auto& [ends, loop] : session.fleet.loops) {
    // Messages about a keyframe may come before the graph that it belongs to.
    if (!session.fleet.knows(loop.from) || !session.fleet.knows(loop.to)) continue;
    const auto found = accepted.find(ends);
    if (found == accepted.end()) {
      text += loop_row(session, {loop, false, 0.0}, "");
      continue;
    }
    const bool judged = !session.loop_classes.empty();
    text += loop_row(session, session.solution.loops[found->second],
                     judged ? to_string(session.loop_classes[found->second]) : "");
  }
  return text;
}

Result<std::vector<SavedLoop>> parse_loops_csv(std::string_view text) {
  const Result<std::vector<CsvRow>> rows = checked_rows(text);
  if (!rows) return tl::unexpected(rows.error());
  std::vector<SavedLoop> loops;
  for (std::size_t r = 1; r < rows->size(); ++r) {
    Result<SavedLoop> loop = saved_loop((*rows)[r].cells);
    if (!loop) return fail(format("line {}", (*rows)[r].line), loop.error());
    loops.push_back(std::move(*loop));
  }
  return loops;
}

Result<std::string> with_classes(std::string_view text, const std::vector<std::string>& classes) {
  Result<std::vector<CsvRow>> rows = checked_rows(text);
  if (!rows) return tl::unexpected(rows.error());
  if (rows->size() != classes.size() + 1)
    return fail(format("{} loops, and {} classes were given", rows->size() - 1, classes.size()));
  std::string out = csv_row(rows->front().cells);
  for (std::size_t r = 1; r < rows->size(); ++r) {
    (*rows)[r].cells[kClassColumn] = classes[r - 1];
    out += csv_row((*rows)[r].cells);
  }
  return out;
}

}  // namespace adit
