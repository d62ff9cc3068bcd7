// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/evaluation/ate.hpp"
#include "adit/evaluation/rpe.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

std::vector<AteResult> joint(const std::vector<Path>& estimates, const std::vector<Path>& truths) {
  const auto poses = [](const std::vector<Path>& paths) {
    std::vector<Trajectory> all;
    for (const Path& path : paths) all.push_back(path.poses);
    return all;
  };
  return value_of(joint_ate(poses(estimates), poses(truths)));
}

void add_ate(py::module_& m) {
  py::class_<AteResult>(m, "Ate")
      .def_property_readonly("stamps", [](const AteResult& r) { return array_of(r.stamps); })
      .def_property_readonly("errors", [](const AteResult& r) { return array_of(r.errors_m); })
      .def_property_readonly("positions",
                             [](const AteResult& r) {
                               Rows rows(static_cast<Eigen::Index>(r.positions.size()), 3);
                               Eigen::Index row = 0;
                               for (const Vector3& position : r.positions) rows.row(row++) = position;
                               return rows;
                             })
      .def_property_readonly("T_world_estimate",
                             [](const AteResult& r) { return r.T_world_estimate.matrix(); })
      .def_readonly("max", &AteResult::max_m)
      .def_readonly("rmse", &AteResult::rmse_m)
      .def_readonly("mean", &AteResult::mean_m)
      .def_readonly("median", &AteResult::median_m)
      .def_readonly("num_unmatched", &AteResult::num_unmatched);
}

void add_rpe(py::module_& m) {
  py::class_<RpeResult>(m, "Rpe")
      .def_property_readonly("translation_errors",
                             [](const RpeResult& r) { return array_of(r.translation_errors_m); })
      .def_property_readonly("rotation_errors",
                             [](const RpeResult& r) { return array_of(r.rotation_errors_rad); })
      .def_readonly("segment", &RpeResult::segment_m)
      .def_readonly("translation_rmse", &RpeResult::translation_rmse_m)
      .def_readonly("translation_median", &RpeResult::translation_median_m)
      .def_readonly("rotation_rmse", &RpeResult::rotation_rmse_rad)
      .def_readonly("rotation_median", &RpeResult::rotation_median_rad);
}

}  // namespace

void add_evaluation(py::module_& m) {
  add_ate(m);
  add_rpe(m);
  m.def(
      "ate",
      [](const Path& estimate, const Path& truth) { return value_of(ate(estimate.poses, truth.poses)); },
      py::arg("estimate"), py::arg("truth"), "Absolute trajectory error after a rigid alignment.");
  m.def("joint_ate", &joint, py::arg("estimates"), py::arg("truths"),
        "ATE of robots that share a frame, after one alignment of all together.");
  m.def(
      "rpe",
      [](const Path& estimate, const Path& truth, double segment, double tolerance) {
        if (!(segment > 0.0)) throw py::value_error("segment: a length above 0 m is needed");
        if (!(tolerance >= 0.0)) throw py::value_error("tolerance: a share of the segment, 0 or more");
        return value_of(rpe(estimate.poses, truth.poses, segment, tolerance));
      },
      py::arg("estimate"), py::arg("truth"), py::arg("segment") = 10.0, py::arg("tolerance") = 0.1,
      "Relative pose error over segments of the true path, metres. Each ends at the pose nearest to its "
      "length, and is left out where that is off by more than this share, as evo_rpe --all_pairs "
      "--pairs_from_reference has it.");
}

}  // namespace adit::python
