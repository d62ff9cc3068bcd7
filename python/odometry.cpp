// SPDX-FileCopyrightText: 2026 The adit authors
// SPDX-License-Identifier: MIT
#include <memory>
#include <mutex>

#include "adit/odometry/methods.hpp"
#include "adit/robot/nothing_mapped.hpp"
#include "adit/robot/robot_slam.hpp"
#include "adit/robot/scan_loop.hpp"
#include "adit/robot/sensor_checks.hpp"
#include "bindings.hpp"

namespace adit::python {
namespace {

struct OdometryRun {
  Path trajectory;
  std::vector<std::string> statuses;
  std::vector<std::string> notes;
};

/// What `adit odometry` does.
Result<OdometryRun> run_odometry(Recording recording, const RunConfig& config) {
  OdometryRun out;
  if (config.slam.check_sensors)
    for (const SensorFinding& finding : use_sound_sensors(recording)) out.notes.push_back(finding.sentence);
  const OdometryConfig& method = config.slam.robot.odometry;
  const Result<> wheels = check_wheels(recording, method, "robot.odometry.method = kiss-icp");
  if (!wheels) return tl::unexpected(wheels.error());
  const std::unique_ptr<Odometry> odometry = make_odometry(method, recording.T_base_lidar);
  bool anything = false;
  const auto take = [&](const Scan& scan, const SensedMotion& motion) {
    throw_if_cancelled();
    const OdometryStep step = odometry->register_scan(scan, motion);
    anything |= step.status != StepStatus::too_few_points;
    out.trajectory.poses.push_back({step.stamp, step.T_odom_base});
    out.statuses.emplace_back(to_string(step.status));
    return true;
  };
  LeftOut left_out("scans");
  const Result<> done = for_each_scan(with_damaged_scans_empty(recording, left_out), take);
  if (!done) return tl::unexpected(done.error());
  if (const Result<> any = left_out.unless_all(); !any) return fail(recording.name, any.error());
  if (const auto sentence = left_out.sentence()) out.notes.push_back(*sentence);
  if (!anything) return fail(why_nothing_mapped(recording));
  return out;
}

OdometryRun odometry(const Recording& recording, const py::object& config, const std::string& profile) {
  const RunConfig values = run_config(config, profile);
  return without_gil([&] { return value_of(run_odometry(recording, values)); });
}

/// A method, for scans that come one by one. Calls from several Python threads wait for one another.
class ScanByScan {
 public:
  explicit ScanByScan(std::unique_ptr<Odometry> odometry) : odometry_(std::move(odometry)) {}

  OdometryStep register_scan(const Scan& scan, const SensedMotion* motion) {
    // First, so that other Python threads run while this one waits for the lock.
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return odometry_->register_scan(scan, motion == nullptr ? SensedMotion{} : *motion);
  }
  std::vector<Eigen::Vector3f> points_of_last_scan() {
    const py::gil_scoped_release release;
    const std::scoped_lock lock(mutex_);
    return odometry_->cloud_of_last_scan().points;
  }

 private:
  std::mutex mutex_;
  std::unique_ptr<Odometry> odometry_;
};

std::unique_ptr<ScanByScan> method_of(const Eigen::Matrix4d& T_base_lidar, const py::object& config,
                                      const std::string& profile) {
  return std::make_unique<ScanByScan>(
      make_odometry(run_config(config, profile).slam.robot.odometry, Pose::from_matrix(T_base_lidar)));
}

void add_step(py::module_& m) {
  py::class_<OdometryStep>(m, "OdometryStep")
      .def_property_readonly("stamp", [](const OdometryStep& step) { return step.stamp.ns; })
      .def_property_readonly("T_odom_base",
                             [](const OdometryStep& step) { return step.T_odom_base.matrix(); })
      .def_readonly("information", &OdometryStep::information)
      .def_property_readonly("status",
                             [](const OdometryStep& step) { return std::string(to_string(step.status)); })
      .def_readonly("num_correspondences", &OdometryStep::num_correspondences)
      .def_readonly("iterations", &OdometryStep::iterations);
}

}  // namespace

void add_odometry(py::module_& m) {
  add_step(m);
  py::class_<ScanByScan>(m, "Odometry")
      .def(py::init(&method_of), identity_by_default("T_base_lidar"), py::arg("config") = py::none(),
           py::arg("profile") = "default")
      .def("register_scan", &ScanByScan::register_scan, py::arg("scan"), py::arg("motion") = py::none())
      .def_property_readonly("points_of_last_scan",
                             [](ScanByScan& o) { return array_of(o.points_of_last_scan()); });
  py::class_<OdometryRun>(m, "OdometryRun")
      .def_readonly("trajectory", &OdometryRun::trajectory)
      .def_readonly("statuses", &OdometryRun::statuses)
      .def_readonly("notes", &OdometryRun::notes);
  m.def("odometry", &odometry, py::arg("recording"), py::arg("config") = py::none(),
        py::arg("profile") = "default",
        "The odometry of a recording, scan by scan, as 'adit odometry' computes it.");
}

}  // namespace adit::python
