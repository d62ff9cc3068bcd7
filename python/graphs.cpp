// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <variant>

#include "adit/core/format.hpp"
#include "adit/io/atomic_file.hpp"
#include "adit/io/g2o.hpp"
#include "adit/posegraph/gnc.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

// ---- arrays of poses of the plane ------------------------------------------------------------------------

PoseArray array_of_poses(const std::vector<Pose>& poses) { return array_of(poses); }
PoseArray array_of_poses(const std::vector<Pose2>& poses) {
  PoseArray array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(poses.size()), 3});
  double* row = array.mutable_data();
  for (const Pose2& pose : poses) {
    *row++ = pose.translation().x();
    *row++ = pose.translation().y();
    *row++ = pose.theta();
  }
  return array;
}

template <class P>
std::vector<P> poses_from(const PoseArray& array);
template <>
std::vector<Pose> poses_from<Pose>(const PoseArray& array) {
  return poses_of(array);
}
template <>
std::vector<Pose2> poses_from<Pose2>(const PoseArray& array) {
  if (array.ndim() != 2 || array.shape(1) != 3)
    throw py::value_error("poses of the plane are an array of shape (n, 3): x, y, heading in radians");
  std::vector<Pose2> poses;
  for (const double* row = array.data(); row != array.data() + array.size(); row += 3)
    poses.emplace_back(row[0], row[1], row[2]);
  return poses;
}

// ---- graphs ----------------------------------------------------------------------------------------------

using KeyArray = py::array_t<std::uint64_t, py::array::c_style | py::array::forcecast>;
using IndexArray = py::array_t<std::int64_t, py::array::c_style>;
using MatrixArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The arrays that describe a graph, in and out.
struct GraphArrays {
  KeyArray keys;
  PoseArray poses;
  IndexArray edges;
  PoseArray measurements;
  MatrixArray information;
  py::array_t<bool> is_loop;
};

template <class P>
void check_shapes(const GraphArrays& a, std::size_t num_poses, std::size_t num_measurements) {
  if (a.keys.ndim() != 1 || static_cast<std::size_t>(a.keys.size()) != num_poses)
    throw py::value_error("keys: one for each pose is needed");
  if (a.edges.ndim() != 2 || a.edges.shape(1) != 2 ||
      static_cast<std::size_t>(a.edges.shape(0)) != num_measurements)
    throw py::value_error("edges: an array of shape (m, 2) is needed, one row for each measurement");
  if (a.is_loop.ndim() != 1 || static_cast<std::size_t>(a.is_loop.size()) != num_measurements)
    throw py::value_error("is_loop: one for each edge is needed");
  if (a.information.ndim() != 3 || static_cast<std::size_t>(a.information.shape(0)) != num_measurements ||
      a.information.shape(1) != P::kDof || a.information.shape(2) != P::kDof)
    throw py::value_error(format("information: an array of shape (m, {}, {}) is needed", P::kDof, P::kDof));
}

template <class P>
BasicPoseGraph<P> graph_of(const GraphArrays& a) {
  const std::vector<P> poses = poses_from<P>(a.poses);
  const std::vector<P> measurements = poses_from<P>(a.measurements);
  check_shapes<P>(a, poses.size(), measurements.size());
  BasicPoseGraph<P> graph;
  for (std::size_t i = 0; i < poses.size(); ++i) graph.nodes.push_back({a.keys.data()[i], poses[i]});
  for (std::size_t e = 0; e < measurements.size(); ++e) {
    const double* const information = a.information.data() + e * P::kDof * P::kDof;
    const std::int64_t from = a.edges.data()[2 * e];
    const std::int64_t to = a.edges.data()[2 * e + 1];
    if (from < 0 || to < 0) throw py::value_error("edges: indices of poses are counted from 0");
    graph.edges.push_back(
        {static_cast<std::size_t>(from), static_cast<std::size_t>(to), measurements[e],
         Eigen::Map<const Eigen::Matrix<double, P::kDof, P::kDof, Eigen::RowMajor>>(information),
         a.is_loop.data()[e] ? EdgeKind::loop : EdgeKind::odometry});
  }
  graph.check();
  return graph;
}

template <class P>
KeyArray keys_of(const BasicPoseGraph<P>& graph) {
  KeyArray keys(static_cast<py::ssize_t>(graph.nodes.size()));
  std::ranges::transform(graph.nodes, keys.mutable_data(), [](const auto& node) { return node.key; });
  return keys;
}

template <class P>
IndexArray ends_of(const BasicPoseGraph<P>& graph) {
  IndexArray ends(std::vector<py::ssize_t>{static_cast<py::ssize_t>(graph.edges.size()), 2});
  std::int64_t* row = ends.mutable_data();
  for (const auto& edge : graph.edges) {
    *row++ = static_cast<std::int64_t>(edge.from);
    *row++ = static_cast<std::int64_t>(edge.to);
  }
  return ends;
}

template <class P>
PoseArray measurements_of(const BasicPoseGraph<P>& graph) {
  std::vector<P> measurements;
  for (const auto& edge : graph.edges) measurements.push_back(edge.T_from_to);
  return array_of_poses(measurements);
}

template <class P>
MatrixArray information_of(const BasicPoseGraph<P>& graph) {
  MatrixArray matrices(
      std::vector<py::ssize_t>{static_cast<py::ssize_t>(graph.edges.size()), P::kDof, P::kDof});
  double* matrix = matrices.mutable_data();
  for (const auto& edge : graph.edges) {
    Eigen::Map<Eigen::Matrix<double, P::kDof, P::kDof, Eigen::RowMajor>>{matrix} = edge.information;
    matrix += P::kDof * P::kDof;
  }
  return matrices;
}

template <class P>
py::array_t<bool> loops_of(const BasicPoseGraph<P>& graph) {
  py::array_t<bool> is_loop(static_cast<py::ssize_t>(graph.edges.size()));
  std::ranges::transform(graph.edges, is_loop.mutable_data(),
                         [](const auto& edge) { return edge.kind == EdgeKind::loop; });
  return is_loop;
}

template <class P>
void write_graph(const BasicPoseGraph<P>& graph, const std::filesystem::path& path) {
  AtomicFile file = value_of(AtomicFile::create(path));
  write_g2o(file.stream(), graph);
  value_of(file.commit());
}

// ---- solving ---------------------------------------------------------------------------------------------

template <class P>
Solution<P> solved(const BasicPoseGraph<P>& graph, bool gnc, const py::object& config) {
  const GncConfig values = run_config(config, "default").slam.back_end.gnc;
  return without_gil([&] {
    Solution<P> solution = gnc ? optimize_gnc(graph, values) : optimize(graph, values.optimizer);
    if (!solution.ok()) throw DataError({format("{}: {}", to_string(solution.status), solution.reason)});
    return solution;
  });
}

template <class P>
void add_graph(py::module_& m, const char* graph_name, const char* solution_name) {
  using Graph = BasicPoseGraph<P>;
  py::class_<Graph>(m, graph_name)
      .def(py::init([](const KeyArray& keys, const PoseArray& poses, const IndexArray& edges,
                       const PoseArray& measurements, const MatrixArray& information,
                       const py::array_t<bool, py::array::c_style | py::array::forcecast>& is_loop) {
             return graph_of<P>({keys, poses, edges, measurements, information, is_loop});
           }),
           py::arg("keys"), py::arg("poses"), py::arg("edges"), py::arg("measurements"),
           py::arg("information"), py::arg("is_loop"))
      .def_property_readonly("keys", &keys_of<P>)
      .def_property_readonly("poses", [](const Graph& graph) { return array_of_poses(poses_of(graph)); })
      .def_property_readonly("edges", &ends_of<P>)
      .def_property_readonly("measurements", &measurements_of<P>)
      .def_property_readonly("information", &information_of<P>)
      .def_property_readonly("is_loop", &loops_of<P>)
      .def("write", &write_graph<P>, py::arg("path"));
  py::class_<Solution<P>>(m, solution_name)
      .def_property_readonly("poses", [](const Solution<P>& s) { return array_of_poses(s.poses); })
      .def_readonly("cost_initial", &Solution<P>::cost_initial)
      .def_readonly("cost_final", &Solution<P>::cost_final)
      .def_readonly("iterations", &Solution<P>::iterations)
      .def_property_readonly("status", [](const Solution<P>& s) { return std::string(to_string(s.status)); })
      .def_readonly("reason", &Solution<P>::reason)
      .def_readonly("notes", &Solution<P>::notes)
      .def_property_readonly("edge_weights", [](const Solution<P>& s) { return array_of(s.edge_weights); });
  m.def("solve", &solved<P>, py::arg("graph"), py::kw_only(), py::arg("gnc") = false,
        py::arg("config") = py::none(),
        "Minimises chi2 over all poses; with gnc=True it finds and rejects false loops.");
}

}  // namespace

void add_graphs(py::module_& m) {
  add_graph<Pose>(m, "PoseGraph", "Solution");
  add_graph<Pose2>(m, "PoseGraph2", "Solution2");
  m.def(
      "read_graph", [](const std::filesystem::path& path) { return value_of(read_g2o(path)).graph; },
      py::arg("path"), "The pose graph of a g2o file, in space or in the plane.");
}

}  // namespace adit::python
