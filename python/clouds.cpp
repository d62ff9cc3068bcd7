// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>

#include "adit/io/cloud_files.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

static_assert(sizeof(Eigen::Vector3f) == 3 * sizeof(float), "points are rows of an array");

void write_points(const std::filesystem::path& path, const PointArray& points) {
  value_of(write_cloud(path, cloud_of(points)));
}

}  // namespace

PointCloud cloud_of(const PointArray& points) {
  if (points.ndim() != 2 || points.shape(1) != 3)
    throw py::value_error("points are an array of shape (n, 3)");
  PointCloud cloud;
  cloud.points.reserve(static_cast<std::size_t>(points.shape(0)));
  for (const float* row = points.data(); row != points.data() + points.size(); row += 3)
    cloud.points.emplace_back(row[0], row[1], row[2]);
  return cloud;
}

PointArray array_of(const std::vector<Eigen::Vector3f>& points) {
  const std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(points.size()), 3};
  return points.empty() ? PointArray(shape) : PointArray(shape, points.front().data());
}

PoseArray array_of(const std::vector<Pose>& poses) {
  PoseArray array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(poses.size()), 4, 4});
  double* row = array.mutable_data();
  for (const Pose& pose : poses) {
    Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>{row} = pose.matrix();
    row += 16;
  }
  return array;
}

std::vector<Pose> poses_of(const PoseArray& array) {
  if (array.ndim() != 3 || array.shape(1) != 4 || array.shape(2) != 4)
    throw py::value_error("poses are an array of shape (n, 4, 4)");
  std::vector<Pose> poses;
  for (py::ssize_t i = 0; i < array.shape(0); ++i)
    poses.push_back(Pose::from_matrix(
        Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(array.data() + 16 * i)));
  return poses;
}

StampArray array_of(const std::vector<Stamp>& stamps) {
  StampArray array(static_cast<py::ssize_t>(stamps.size()));
  std::ranges::transform(stamps, array.mutable_data(), [](Stamp stamp) { return stamp.ns; });
  return array;
}

void add_clouds(py::module_& m) {
  m.def(
      "read_cloud",
      [](const std::filesystem::path& path) { return array_of(value_of(read_cloud(path)).points); },
      py::arg("path"), "The points of a .pcd, .ply or .bin file, (n, 3).");
  m.def("write_cloud", &write_points, py::arg("path"), py::arg("points"),
        "Writes points (n, 3) as .pcd, .ply or .bin.");
}

}  // namespace adit::python
