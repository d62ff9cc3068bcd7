// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
/// What the files of the Python module share. Each adds one group of functions and classes;
/// python/adit/__init__.pyi describes them for users.
#pragma once

#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <atomic>
#include <chrono>
#include <future>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "adit/core/progress.hpp"
#include "adit/core/records.hpp"
#include "adit/core/result.hpp"
#include "adit/slam/run_config.hpp"

namespace adit::python {

namespace py = pybind11;

void add_clouds(py::module_& m);
void add_recordings(py::module_& m);
void add_odometry(py::module_& m);
void add_registration(py::module_& m);
void add_sessions(py::module_& m);
void add_graphs(py::module_& m);
void add_evaluation(py::module_& m);

// ---- errors ----------------------------------------------------------------------------------------------

/// An `Error` of adit on its way to Python, where it is `adit.Error` with the same text.
class DataError : public std::runtime_error {
 public:
  explicit DataError(const Error& error) : std::runtime_error(error.message) {}
};

template <class T>
T value_of(Result<T> result) {
  if (!result) throw DataError(result.error());
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

// ---- long calls ------------------------------------------------------------------------------------------

/// Stops work that polls it.
class Stop : public ProgressObserver {
 public:
  void now() { stopped_ = true; }
  PhaseId begin(std::string_view /*name*/, std::size_t /*total*/, PhaseId /*parent*/) override { return 1; }
  void advance(PhaseId /*phase*/, std::size_t /*steps*/) override {}
  void end(PhaseId /*phase*/) noexcept override {}
  [[nodiscard]] bool cancelled() const noexcept override { return stopped_; }

 private:
  std::atomic<bool> stopped_ = false;
};

/// The result of `work`, which touches no Python object: other Python threads run meanwhile, and Ctrl-C ends
/// it with KeyboardInterrupt.
template <class Work>
auto without_gil(const Work& work) {
  Stop stop;
  std::future<decltype(work())> done = std::async(std::launch::async, [&] {
    const ObserverScope scope(stop);
    return work();
  });
  const auto is_ready = [&] {
    const py::gil_scoped_release release;
    return done.wait_for(std::chrono::milliseconds(100)) == std::future_status::ready;
  };
  while (!is_ready()) {
    if (PyErr_CheckSignals() == 0) continue;
    py::error_already_set interrupt;
    stop.now();
    const py::gil_scoped_release release;
    done.wait();
    throw interrupt;
  }
  return done.get();
}

// ---- configuration ---------------------------------------------------------------------------------------

/// The profile of that name, with the settings of `config`: None, a dict of dotted keys, or TOML.
[[nodiscard]] RunConfig run_config(const py::object& config, const std::string& profile);

/// A trajectory as a Python object. (A list of stamped poses would be copied into one, pose by pose.)
struct Path {
  Trajectory poses;
};

// ---- arrays ----------------------------------------------------------------------------------------------

/// Rows of three numbers, any number type.
using PointArray = py::array_t<float, py::array::c_style | py::array::forcecast>;

/// As an array of shape (n, 3).
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Throws ValueError unless `points` has the shape (n, 3).
[[nodiscard]] PointCloud cloud_of(const PointArray& points);
[[nodiscard]] PointArray array_of(const std::vector<Eigen::Vector3f>& points);

/// A copy.
template <class T>
[[nodiscard]] py::array_t<T> array_of(const std::vector<T>& values) {
  return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

using StampArray = py::array_t<std::int64_t, py::array::c_style>;
using PoseArray = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// (n, 4, 4), T_a_b of each pose.
[[nodiscard]] PoseArray array_of(const std::vector<Pose>& poses);
/// Throws ValueError where the shape is not (n, 4, 4) or a matrix is no rigid motion.
[[nodiscard]] std::vector<Pose> poses_of(const PoseArray& array);

/// Nanoseconds.
[[nodiscard]] StampArray array_of(const std::vector<Stamp>& stamps);

/// An argument that is a pose (4, 4).
[[nodiscard]] inline py::arg_v identity_by_default(const char* name) {
  return {name, Eigen::Matrix4d(Eigen::Matrix4d::Identity()), "numpy.eye(4)"};
}

}  // namespace adit::python
