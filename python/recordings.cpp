// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>

#include "adit/io/bag.hpp"
#include "adit/io/recording_files.hpp"
#include "adit/io/trajectory_files.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/simulation/world.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

// ---- trajectories ----------------------------------------------------------------------------------------

/// Nanoseconds are integers; seconds, as floating-point numbers, are refused.
py::array integers_in(const py::object& values, const char* what) {
  py::array array = py::array::ensure(values);
  const bool is_integral = array && (array.dtype().kind() == 'i' || array.dtype().kind() == 'u');
  if (!is_integral && (!array || array.size() > 0))
    throw py::value_error(std::string(what) + ": integers are needed, in nanoseconds");
  return array;
}

Trajectory trajectory_of(const StampArray& stamps, const PoseArray& array) {
  const std::vector<Pose> poses = poses_of(array);
  if (stamps.ndim() != 1 || static_cast<std::size_t>(stamps.size()) != poses.size())
    throw py::value_error("a trajectory has one stamp for each pose");
  Trajectory trajectory;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Stamp stamp{stamps.data()[i]};
    if (i > 0 && stamp <= trajectory.back().stamp)
      throw py::value_error("stamps of a trajectory ascend strictly");
    trajectory.push_back({stamp, poses[i]});
  }
  return trajectory;
}

StampArray stamps_of(const Trajectory& trajectory) {
  std::vector<Stamp> stamps;
  for (const StampedPose& pose : trajectory) stamps.push_back(pose.stamp);
  return array_of(stamps);
}

PoseArray poses_in(const Trajectory& trajectory) {
  std::vector<Pose> poses;
  for (const StampedPose& pose : trajectory) poses.push_back(pose.T_world_body);
  return array_of(poses);
}

Rows positions_in(const Trajectory& trajectory) {
  Rows rows(static_cast<Eigen::Index>(trajectory.size()), 3);
  Eigen::Index row = 0;
  for (const StampedPose& pose : trajectory) rows.row(row++) = pose.T_world_body.translation();
  return rows;
}

void add_trajectory(py::module_& m) {
  py::class_<Path>(m, "Trajectory")
      .def(py::init([](const py::object& stamps, const PoseArray& poses) {
             return Path{trajectory_of(integers_in(stamps, "stamps").cast<StampArray>(), poses)};
           }),
           py::arg("stamps"), py::arg("poses"))
      .def("__len__", [](const Path& path) { return path.poses.size(); })
      .def_property_readonly("stamps", [](const Path& path) { return stamps_of(path.poses); })
      .def_property_readonly("poses", [](const Path& path) { return poses_in(path.poses); })
      .def_property_readonly("positions", [](const Path& path) { return positions_in(path.poses); })
      .def_property_readonly("length", [](const Path& path) { return path_length(path.poses); })
      .def(
          "write",
          [](const Path& path, const std::filesystem::path& file) {
            value_of(write_trajectory(file, path.poses));
          },
          py::arg("path"));
  m.def(
      "read_trajectory",
      [](const std::filesystem::path& file) { return Path{value_of(read_trajectory(file))}; },
      py::arg("path"), "A trajectory of a TUM or .csv file.");
}

// ---- scans -----------------------------------------------------------------------------------------------

template <class T>
std::vector<T> per_point(const py::object& values, std::size_t num_points, const char* what) {
  if (values.is_none()) return {};
  const auto array = py::array_t<T, py::array::c_style | py::array::forcecast>::ensure(values);
  if (!array || array.ndim() != 1 || static_cast<std::size_t>(array.size()) != num_points)
    throw py::value_error(std::string(what) + ": one value for each point is needed");
  return {array.data(), array.data() + array.size()};
}

/// Nanoseconds; times that are not offsets are refused.
std::vector<std::int32_t> offsets_of(const py::object& values, std::size_t num_points) {
  if (values.is_none()) return {};
  const py::array array = integers_in(values, "time_offsets");
  std::vector<std::int32_t> offsets;
  for (const std::int64_t offset : per_point<std::int64_t>(array, num_points, "time_offsets")) {
    if (offset < std::numeric_limits<std::int32_t>::min() ||
        offset > std::numeric_limits<std::int32_t>::max())
      throw py::value_error("time_offsets: nanoseconds after the stamp, at most two seconds, are needed");
    offsets.push_back(static_cast<std::int32_t>(offset));
  }
  return offsets;
}

Scan scan_of(std::int64_t stamp, const PointArray& points, const py::object& intensities,
             const py::object& time_offsets) {
  Scan scan{{stamp}, cloud_of(points)};
  scan.cloud.intensities = per_point<float>(intensities, scan.cloud.size(), "intensities");
  scan.cloud.time_offsets_ns = offsets_of(time_offsets, scan.cloud.size());
  return scan;
}

template <class T>
py::object array_or_none(const std::vector<T>& values) {
  return values.empty() ? py::object(py::none()) : py::object(array_of(values));
}

void add_scan(py::module_& m) {
  py::class_<Scan>(m, "Scan")
      .def(py::init(&scan_of), py::arg("stamp"), py::arg("points"), py::arg("intensities") = py::none(),
           py::arg("time_offsets") = py::none())
      .def_property_readonly("stamp", [](const Scan& scan) { return scan.stamp.ns; })
      .def_property_readonly("points", [](const Scan& scan) { return array_of(scan.cloud.points); })
      .def_property_readonly("intensities",
                             [](const Scan& scan) { return array_or_none(scan.cloud.intensities); })
      .def_property_readonly("time_offsets",
                             [](const Scan& scan) { return array_or_none(scan.cloud.time_offsets_ns); })
      .def("__len__", [](const Scan& scan) { return scan.cloud.size(); });
}

// ---- recordings ------------------------------------------------------------------------------------------

/// Stamps (n), angular velocities and specific forces (n, 3).
using ImuArrays = std::tuple<StampArray, Rows, Rows>;

std::vector<ImuSample> samples_of(const ImuArrays& arrays) {
  const auto& [stamps, turns, forces] = arrays;
  if (stamps.ndim() != 1 || stamps.size() != turns.rows() || stamps.size() != forces.rows())
    throw py::value_error("imu: one angular velocity and one specific force for each stamp is needed");
  std::vector<ImuSample> samples;
  for (Eigen::Index i = 0; i < turns.rows(); ++i) {
    const Stamp stamp{stamps.data()[i]};
    if (i > 0 && stamp <= samples.back().stamp) throw py::value_error("imu: stamps ascend strictly");
    samples.push_back({stamp, turns.row(i), forces.row(i)});
  }
  return samples;
}

std::optional<ImuArrays> arrays_of(const std::vector<ImuSample>& imu) {
  if (imu.empty()) return std::nullopt;
  std::vector<Stamp> stamps;
  Rows turns(static_cast<Eigen::Index>(imu.size()), 3);
  Rows forces = turns;
  for (const ImuSample& sample : imu) {
    const auto row = static_cast<Eigen::Index>(stamps.size());
    turns.row(row) = sample.angular_velocity;
    forces.row(row) = sample.specific_force;
    stamps.push_back(sample.stamp);
  }
  return ImuArrays{array_of(stamps), turns, forces};
}

/// A recording of scans that Python hands over.
Recording recording_of(const std::string& name, const std::vector<Scan>& scans,
                       const Eigen::Matrix4d& T_base_lidar, const Path* wheel,
                       const std::optional<ImuArrays>& imu, const Eigen::Matrix4d& T_base_imu,
                       const Path* truth) {
  Recording recording;
  recording.name = name;
  recording.T_base_lidar = Pose::from_matrix(T_base_lidar);
  recording.mount_source = "the program that made the recording";
  for (const Scan& scan : scans) {
    if (!recording.scan_stamps.empty() && scan.stamp <= recording.scan_stamps.back())
      throw py::value_error(name + ": stamps of scans ascend strictly");
    recording.scan_stamps.push_back(scan.stamp);
  }
  recording.read_scan = [kept = std::make_shared<const std::vector<Scan>>(scans)](std::size_t i) {
    return Result<Scan>(kept->at(i));
  };
  if (wheel != nullptr) recording.wheel = wheel->poses;
  if (imu) recording.imu = samples_of(*imu);
  if (imu) recording.T_base_imu = Pose::from_matrix(T_base_imu);
  if (truth != nullptr) recording.truth = truth->poses;
  return recording;
}

std::size_t index_in(const Recording& recording, py::ssize_t index) {
  const auto size = static_cast<py::ssize_t>(recording.num_scans());
  const py::ssize_t counted = index < 0 ? index + size : index;
  if (counted < 0 || counted >= size) throw py::index_error("the recording has no such scan");
  return static_cast<std::size_t>(counted);
}

Scan scan_at(const Recording& recording, py::ssize_t index) {
  const std::size_t i = index_in(recording, index);
  const py::gil_scoped_release release;
  return value_of(recording.read_scan(i));
}

Recording part_of(const Recording& recording, const py::slice& slice) {
  std::size_t start = 0, stop = 0, step = 0, length = 0;
  if (!slice.compute(recording.num_scans(), &start, &stop, &step, &length)) throw py::error_already_set();
  if (static_cast<py::ssize_t>(step) < 0) throw py::value_error("scans of a recording ascend in time");
  Recording part = recording;
  part.scan_stamps.clear();
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < length; ++i) {
    chosen.push_back(start + i * step);
    part.scan_stamps.push_back(recording.scan_stamps[chosen.back()]);
  }
  part.read_scan = [read = recording.read_scan, chosen](std::size_t i) { return read(chosen.at(i)); };
  return part;
}

py::object path_or_none(const Trajectory& trajectory) {
  return trajectory.empty() ? py::object(py::none()) : py::cast(Path{trajectory});
}

void add_recording(py::module_& m) {
  py::class_<Recording>(m, "Recording")
      .def(py::init(&recording_of), py::arg("name"), py::arg("scans"), identity_by_default("T_base_lidar"),
           py::arg("wheel") = py::none(), py::arg("imu") = py::none(), identity_by_default("T_base_imu"),
           py::arg("truth") = py::none())
      .def_readwrite("name", &Recording::name)
      .def_readonly("lidar", &Recording::lidar)
      .def_property_readonly("T_base_lidar", [](const Recording& r) { return r.T_base_lidar.matrix(); })
      .def_readonly("mount_source", &Recording::mount_source)
      .def_readonly("assumptions", &Recording::assumptions)
      .def_readonly("warnings", &Recording::warnings)
      .def_property_readonly("stamps", [](const Recording& r) { return array_of(r.scan_stamps); })
      .def_property_readonly("wheel", [](const Recording& r) { return path_or_none(r.wheel); })
      .def_property_readonly("truth", [](const Recording& r) { return path_or_none(r.truth); })
      .def_property_readonly("imu", [](const Recording& r) { return arrays_of(r.imu); })
      .def_property_readonly("T_base_imu", [](const Recording& r) { return r.T_base_imu.matrix(); })
      .def("__len__", &Recording::num_scans)
      .def("__getitem__", &scan_at, py::arg("index"))
      .def("__getitem__", &part_of, py::arg("part"))
      .def(
          "motion_before",
          [](const Recording& r, py::ssize_t index) { return sensed_before(r, index_in(r, index)); },
          py::arg("index"));
}

// ---- where they come from --------------------------------------------------------------------------------

Recording open_one(const std::string& input, const py::object& config) {
  const RecordingConfig how = run_config(config, "default").recording;
  return without_gil([&] { return value_of(open_recording(input, how)); });
}

std::vector<Recording> simulated(const py::object& config) {
  const RunConfig values = run_config(config, "default");
  return without_gil([&] {
    return value_of(make_world(values.world).and_then([&](const World& world) {
      return simulate(world, values.simulation);
    }));
  });
}

}  // namespace

void add_recordings(py::module_& m) {
  add_trajectory(m);
  add_scan(m);
  py::class_<SensedMotion>(m, "Motion")
      .def(py::init([](const Eigen::Matrix4d& T_base0_base1, double duration_s, const Matrix6& covariance) {
             return SensedMotion{
                 .wheel = WheelDelta{from_seconds(duration_s), Pose::from_matrix(T_base0_base1), covariance}};
           }),
           py::arg("T_base0_base1"), py::arg("duration"), py::arg("covariance"));
  add_recording(m);
  m.def(
      "open_recording",
      [](const std::filesystem::path& path, const py::object& config) {
        return open_one(path.string(), config);
      },
      py::arg("path"), py::arg("config") = py::none(),
      "Opens a bag or a folder of clouds; scans are read when asked for.");
  m.def("simulate", &simulated, py::arg("config") = py::none(),
        "Drives robots through a generated world; scans are cast when asked for.");
}

}  // namespace adit::python
