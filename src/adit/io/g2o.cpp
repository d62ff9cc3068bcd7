// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/io/g2o.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <iterator>
#include <map>
#include <optional>
#include <ostream>
#include <string_view>
#include <unordered_map>

#include "adit/core/format.hpp"
#include "adit/core/progress.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/far_out.hpp"
#include "adit/io/stated_pose.hpp"

namespace adit {
namespace {

// The words of one line, taken from the left.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}

  std::string_view next() {
    const std::size_t begin = rest_.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return rest_ = {};
    const std::size_t end = std::min(rest_.find_first_of(" \t\r", begin), rest_.size());
    const std::string_view word = rest_.substr(begin, end - begin);
    rest_.remove_prefix(end);
    return word;
  }

  template <class T>
  Result<T> number() {
    const std::string_view word = next();
    if (word.empty()) return fail("a number is missing");
    const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
    T value{};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc{} || end != digits.data() + digits.size())
      return fail(format("'{}' is not a number", word));
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) return fail(format("'{}' is not finite", word));
    }
    return value;
  }

  template <std::size_t N>
  Result<std::array<double, N>> numbers() {
    std::array<double, N> out{};
    for (double& value : out) {
      const Result<double> parsed = number<double>();
      if (!parsed) return tl::unexpected(parsed.error());
      value = *parsed;
    }
    return out;
  }

  Result<> end() {
    const std::string_view word = next();
    if (!word.empty()) return fail(format("'{}' is one number too many", word));
    return {};
  }

 private:
  std::string_view rest_;
};

// How each kind of pose is written.
template <class P>
struct Format;
template <>
struct Format<Pose> {
  static constexpr std::string_view kVertex = "VERTEX_SE3:QUAT";
  static constexpr std::string_view kEdge = "EDGE_SE3:QUAT";
  static constexpr std::size_t kNumbers = 7;
  static Result<Pose> pose(const std::array<double, 7>& v) {
    return stated_pose({v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]});
  }
  static std::array<double, 7> numbers(const Pose& T) {
    const Eigen::Quaterniond& q = T.rotation();
    return {T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w()};
  }
};
template <>
struct Format<Pose2> {
  static constexpr std::string_view kVertex = "VERTEX_SE2";
  static constexpr std::string_view kEdge = "EDGE_SE2";
  static constexpr std::size_t kNumbers = 3;
  static Result<Pose2> pose(const std::array<double, 3>& v) {
    if (const Result<> checked = check_not_far_out(Eigen::Vector2d(v[0], v[1])); !checked)
      return tl::unexpected(checked.error());
    return Pose2(v[0], v[1], v[2]);
  }
  static std::array<double, 3> numbers(const Pose2& T) {
    return {T.translation().x(), T.translation().y(), T.theta()};
  }
};

// An edge whose ends are still keys.
template <class P>
struct KeyedEdge {
  std::uint64_t from;
  std::uint64_t to;
  typename BasicPoseGraph<P>::Edge edge;
  std::size_t line;
};

EdgeKind kind_of(std::uint64_t from, std::uint64_t to) {
  return from + 1 == to ? EdgeKind::odometry : EdgeKind::loop;
}

template <class P>
class Reader {
 public:
  [[nodiscard]] bool empty() const { return graph_.nodes.empty() && edges_.empty(); }

  Result<> vertex(Words words) {
    const Result<std::uint64_t> key = words.number<std::uint64_t>();
    if (!key) return tl::unexpected(key.error());
    const auto pose = pose_of(words);
    if (!pose) return tl::unexpected(pose.error());
    if (!node_of_.emplace(*key, graph_.nodes.size()).second)
      return fail(format("vertex {} comes twice", *key));
    graph_.nodes.push_back({*key, *pose});
    return words.end();
  }

  Result<> edge(Words words, std::size_t line) {
    constexpr int D = P::kDof;
    KeyedEdge<P> out{0, 0, {}, line};
    for (std::uint64_t* key : {&out.from, &out.to}) {
      const Result<std::uint64_t> parsed = words.number<std::uint64_t>();
      if (!parsed) return tl::unexpected(parsed.error());
      *key = *parsed;
    }
    if (out.from == out.to) return fail(format("an edge from vertex {} to itself", out.from));
    const auto pose = pose_of(words);
    if (!pose) return tl::unexpected(pose.error());
    const auto upper = words.numbers<D*(D + 1) / 2>();
    if (!upper) return tl::unexpected(upper.error());
    std::size_t next = 0;
    for (int i = 0; i < D; ++i) {
      for (int j = i; j < D; ++j) out.edge.information(i, j) = out.edge.information(j, i) = (*upper)[next++];
    }
    out.edge.T_from_to = *pose;
    out.edge.kind = kind_of(out.from, out.to);
    edges_.push_back(std::move(out));
    return words.end();
  }

  G2oFile finish(std::vector<std::string> notes) {
    std::vector<std::uint64_t> missing;
    for (const KeyedEdge<P>& e : edges_) {
      for (const std::uint64_t key : {e.from, e.to}) {
        if (!node_of_.contains(key)) missing.push_back(key);
      }
    }
    std::ranges::sort(missing);
    missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
    std::vector<bool> is_known(graph_.nodes.size(), true);
    is_known.resize(graph_.nodes.size() + missing.size(), false);
    for (const std::uint64_t key : missing) {
      node_of_.emplace(key, graph_.nodes.size());
      graph_.nodes.push_back({key, P()});
    }
    std::vector<std::size_t> lines;
    for (KeyedEdge<P>& e : edges_) {
      e.edge.from = node_of_.at(e.from);
      e.edge.to = node_of_.at(e.to);
      graph_.edges.push_back(std::move(e.edge));
      lines.push_back(e.line);
    }
    if (!missing.empty()) {
      notes.push_back(
          format("{} vertices have no line; their poses are composed along the edges", missing.size()));
      const std::vector<P> poses = spanning_tree_poses(graph_, is_known);
      for (std::size_t i = 0; i < poses.size(); ++i) graph_.nodes[i].pose = poses[i];
    }
    return {std::move(graph_), std::move(lines), {}, std::move(notes)};
  }

 private:
  static Result<P> pose_of(Words& words) {
    return words.numbers<Format<P>::kNumbers>().and_then([](const auto& v) { return Format<P>::pose(v); });
  }

  BasicPoseGraph<P> graph_;
  std::vector<KeyedEdge<P>> edges_;
  std::unordered_map<std::uint64_t, std::size_t> node_of_;  // looked up only, never walked through
};

// Reads line by line; the tag of a line decides what it means.
class FileReader {
 public:
  Result<> line(std::string_view text) {
    ++line_;
    Words words(text);
    const std::string_view tag = words.next();
    if (tag.empty() || tag.front() == '#') return {};
    if (tag == "FIX" || tag.starts_with("PARAMS_")) {
      ++skipped_[std::string(tag)];
      return {};
    }
    if (tag == Format<Pose>::kVertex) return space_.vertex(words);
    if (tag == Format<Pose>::kEdge) return space_.edge(words, line_);
    if (tag == Format<Pose2>::kVertex) return plane_.vertex(words);
    if (tag == Format<Pose2>::kEdge) return plane_.edge(words, line_);
    return fail(
        format("unknown tag '{}'; known are VERTEX_SE3:QUAT, EDGE_SE3:QUAT, VERTEX_SE2, EDGE_SE2, FIX and "
               "PARAMS_*",
               tag.substr(0, 40)));
  }
  [[nodiscard]] std::size_t line_number() const { return line_; }

  Result<G2oFile> finish() {
    if (space_.empty() && plane_.empty()) return fail("no vertex and no edge in it: is this a g2o file?");
    if (!space_.empty() && !plane_.empty())
      return fail("both 2-D and 3-D lines in it; split it in two files");
    std::vector<std::string> notes;
    for (const auto& [tag, count] : skipped_) {
      notes.push_back(format("{} {} line{} skipped", count, tag, count == 1 ? "" : "s"));
    }
    return plane_.empty() ? space_.finish(std::move(notes)) : plane_.finish(std::move(notes));
  }

 private:
  Reader<Pose> space_;
  Reader<Pose2> plane_;
  std::map<std::string, std::size_t> skipped_;
  std::size_t line_ = 0;
};

template <std::size_t N>
void append_numbers(std::string& out, const std::array<double, N>& numbers) {
  for (const double number : numbers) out += format(" {}", number);
}

template <class P>
void write(std::ostream& stream, const BasicPoseGraph<P>& graph) {
  constexpr int D = P::kDof;
  std::string out;
  for (const auto& node : graph.nodes) {
    out += format("{} {}", Format<P>::kVertex, node.key);
    append_numbers(out, Format<P>::numbers(node.pose));
    out += '\n';
  }
  for (const auto& edge : graph.edges) {
    out += format("{} {} {}", Format<P>::kEdge, graph.nodes[edge.from].key, graph.nodes[edge.to].key);
    append_numbers(out, Format<P>::numbers(edge.T_from_to));
    for (int i = 0; i < D; ++i) {
      for (int j = i; j < D; ++j) out += format(" {}", edge.information(i, j));
    }
    out += '\n';
  }
  stream << out;
}

template <class P>
bool same_edge(const typename BasicPoseGraph<P>::Edge& a, const typename BasicPoseGraph<P>::Edge& b) {
  return Format<P>::numbers(a.T_from_to) == Format<P>::numbers(b.T_from_to) && a.information == b.information;
}

template <class P>
Result<G2oFile> merge(const std::vector<G2oFile>& files) {
  BasicPoseGraph<P> merged;
  G2oFile out;
  std::unordered_map<std::uint64_t, std::size_t> node_of;
  std::map<std::pair<std::size_t, std::size_t>, std::vector<std::size_t>> edges_of;
  std::size_t repeated = 0;
  for (std::size_t f = 0; f < files.size(); ++f) {
    const G2oFile& file = files[f];
    const auto* graph = std::get_if<BasicPoseGraph<P>>(&file.graph);
    if (graph == nullptr) return fail("2-D and 3-D graphs cannot be merged");
    out.notes.insert(out.notes.end(), file.notes.begin(), file.notes.end());
    for (const auto& node : graph->nodes) {
      if (node_of.emplace(node.key, merged.nodes.size()).second) merged.nodes.push_back(node);
    }
    const std::size_t before = merged.edges.size();
    for (std::size_t e = 0; e < graph->edges.size(); ++e) {
      auto edge = graph->edges[e];
      edge.from = node_of.at(graph->nodes[edge.from].key);
      edge.to = node_of.at(graph->nodes[edge.to].key);
      auto& same_ends = edges_of[{edge.from, edge.to}];
      // Only what another file repeats counts as repeated: within one file it may well be a second
      // measurement.
      const bool known = std::ranges::any_of(
          same_ends, [&](std::size_t i) { return i < before && same_edge<P>(merged.edges[i], edge); });
      repeated += known ? 1U : 0U;
      if (known) continue;
      same_ends.push_back(merged.edges.size());
      merged.edges.push_back(std::move(edge));
      out.edge_lines.push_back(file.edge_lines[e]);
      out.edge_files.push_back(f);
    }
  }
  if (repeated > 0)
    out.notes.push_back(format("{} edges that several files repeat are counted once", repeated));
  out.graph = std::move(merged);
  return out;
}

Result<G2oFile> parse_g2o(const std::string& text, const std::string& name) {
  FileReader reader;
  for (std::size_t begin = 0; begin < text.size();) {
    throw_if_cancelled();
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const Result<> read = reader.line(std::string_view(text).substr(begin, end - begin));
    if (!read) return fail(format("{}: line {}", name, reader.line_number()), read.error());
    begin = end + 1;
  }
  Result<G2oFile> file = reader.finish();
  return file ? std::move(file) : fail(name, file.error());
}

}  // namespace

Result<G2oFile> read_g2o(std::istream& stream, const std::string& name) {
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) return fail(name + ": reading failed");
  return parse_g2o(text, name);
}

Result<G2oFile> read_g2o(const std::filesystem::path& path) {
  const Result<std::string> text = read_bytes(path);
  if (!text) return tl::unexpected(text.error());
  return parse_g2o(*text, path.string());
}

void write_g2o(std::ostream& stream, const PoseGraph& graph) { write(stream, graph); }
void write_g2o(std::ostream& stream, const PoseGraph2& graph) { write(stream, graph); }

Result<G2oFile> merge_g2o(const std::vector<G2oFile>& files) {
  if (files.empty()) return fail("no graphs to merge");
  const bool space = std::holds_alternative<PoseGraph>(files.front().graph);
  return space ? merge<Pose>(files) : merge<Pose2>(files);
}

}  // namespace adit
