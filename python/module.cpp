// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>

#include "adit/core/check.hpp"
#include "adit/core/parallel.hpp"
#include "adit/core/version.hpp"
#include "adit/io/config_toml.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

std::string setting_text(const py::handle& value) {
  if (py::hasattr(value, "dtype")) return setting_text(value.attr("item")());  // a scalar of numpy
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  if (value.is_none()) throw py::type_error("a setting is a number, a text or a bool, not None");
  return py::str(value);
}

py::object value_of_field(const Field& field) {
  return std::visit(
      [](const auto& target) -> py::object {
        if constexpr (std::is_same_v<std::decay_t<decltype(target)>, EnumTarget>)
          return py::str(std::string(target.name()));
        else
          return py::cast(*target);
      },
      field.target);
}

py::dict configuration(const py::object& config, const std::string& profile) {
  RunConfig values = run_config(config, profile);
  py::dict all;
  for (const Field& field : fields_of(values)) all[py::str(field.key)] = value_of_field(field);
  return all;
}

}  // namespace

RunConfig run_config(const py::object& config, const std::string& profile) {
  const auto* const named = std::ranges::find(kProfiles, profile, [](Profile p) { return to_string(p); });
  if (named == kProfiles.end())
    throw py::value_error("profile '" + profile + "' is none of default, paper, lidar-only");
  RunConfig values = config_of(*named);
  const Fields fields = fields_of(values);
  if (py::isinstance<py::dict>(config)) {
    for (const auto& [key, value] : config.cast<py::dict>())
      value_of(set_field(fields, py::str(key).cast<std::string>(), setting_text(value)));
  } else if (py::isinstance<py::str>(config)) {
    value_of(parse_config(fields, config.cast<std::string>()));
  } else if (!config.is_none()) {
    throw py::type_error("a configuration is a dict of dotted keys, a text in TOML, or None");
  }
  return values;
}

}  // namespace adit::python

PYBIND11_MODULE(_adit, m) {
  using namespace adit::python;
  m.doc() = "Multi-robot LiDAR SLAM for tunnels, mines and caves.";
  m.attr("__version__") = std::string(adit::version());
  py::register_exception<DataError>(m, "Error", PyExc_RuntimeError);
  py::register_exception_translator([](std::exception_ptr error) {
    try {
      if (error) std::rethrow_exception(error);
    } catch (const adit::ContractViolation& violation) {
      PyErr_SetString(PyExc_ValueError, violation.what());
    }
  });
  m.def("set_num_threads", &adit::set_num_threads, py::arg("num_threads"),
        "How many threads the process may use. Results never depend on it.");
  m.def("configuration", &configuration, py::arg("config") = py::none(), py::arg("profile") = "default",
        "Every field of the configuration with its value.");
  add_clouds(m);
  add_recordings(m);
  add_odometry(m);
  add_registration(m);
  add_sessions(m);
  add_graphs(m);
  add_evaluation(m);
}
