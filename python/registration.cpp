// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include "adit/registration/registration.hpp"

#include "bindings.hpp"

namespace adit::python {
namespace {

Registration registered(const PointArray& a, const PointArray& b, const py::object& config) {
  const RegistrationConfig values = run_config(config, "default").slam.agent().registration_in_use();
  const PointCloud cloud_a = cloud_of(a);
  const PointCloud cloud_b = cloud_of(b);
  return without_gil([&] { return register_clouds(cloud_a, cloud_b, values); });
}

}  // namespace

void add_registration(py::module_& m) {
  py::class_<Registration>(m, "Registration")
      .def_property_readonly("accepted",
                             [](const Registration& r) { return r.verdict == LoopVerdict::accepted; })
      .def_readonly("reason", &Registration::reason)
      .def_property_readonly(
          "T_a_b",
          [](const Registration& r) { return r.T_a_b ? std::optional(r.T_a_b->matrix()) : std::nullopt; })
      .def_readonly("information", &Registration::information)
      .def_readonly("num_inliers", &Registration::num_inliers)
      .def_readonly("num_correspondences", &Registration::num_correspondences)
      .def_readonly("overlap", &Registration::overlap)
      .def_readonly("weak_axis", &Registration::weak_axis)
      .def_readonly("weak_direction", &Registration::weak_direction);
  m.def("register", &registered, py::arg("a"), py::arg("b"), py::arg("config") = py::none(),
        "The relative pose of two clouds (n, 3) without a guess, and whether it can be relied on.");
}

}  // namespace adit::python
