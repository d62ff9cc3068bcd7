# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Recordings, odometry, registration, and maps of several robots."""
import json
import os
import signal
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

import adit

CONFORMANCE = Path(__file__).resolve().parents[2] / "tests" / "conformance"


def robots():
    """Two robots of the tunnels zab on a stretch of 70 m that both drive along, with a thinned sensor."""
    zab = adit.simulate({"simulation.lidars": "os2-32"})
    return zab[1][1050:1450:2], zab[3][1130:1530:2]


class Recordings(unittest.TestCase):
    def test_every_kind_of_bag_is_read(self):
        for kind in ("mcap", "db3", "bag"):
            recording = adit.open_recording(CONFORMANCE / f"tube.{kind}")
            expected = json.loads((CONFORMANCE / f"tube.{kind}.json").read_text())
            self.assertEqual((len(recording), recording.name), (expected["scans"], expected["name"]))
            self.assertEqual(len(recording[0]), expected["points_first_scan"])
            self.assertAlmostEqual(recording.wheel.length, expected["wheel_odometry"]["path_length_m"], places=6)
            self.assertEqual(recording.mount_source, expected["mount_from"])
            scans = list(recording)
            self.assertEqual([scan.stamp for scan in scans], list(recording.stamps))
            for scan in scans:
                self.assertEqual(scan.points.shape, (len(scan), 3))
                self.assertTrue(np.isfinite(scan.points).all())
            self.assertEqual(recording.T_base_lidar.shape, (4, 4))

    def test_scans_are_counted_as_in_a_list(self):
        recording, _ = robots()
        part = recording[10:20:3]
        np.testing.assert_array_equal(part.stamps, recording.stamps[10:20:3])
        np.testing.assert_array_equal(part[-1].points, recording[19].points)
        with self.assertRaises(IndexError):
            part[4]
        with self.assertRaises(ValueError):
            recording[::-1]

    def test_what_cannot_be_opened_says_why(self):
        with self.assertRaisesRegex(adit.Error, "/nowhere/a.mcap"):
            adit.open_recording("/nowhere/a.mcap")
        with tempfile.TemporaryDirectory() as folder:
            cut = Path(folder) / "cut.mcap"
            cut.write_bytes(b"no bag")
            with self.assertRaisesRegex(adit.Error, "cut.mcap"):
                adit.open_recording(cut)

    def test_a_recording_of_arrays_is_mapped_as_any_other(self):
        recording = robots()[0][:20]
        copy = adit.Recording("copy", [adit.Scan(s.stamp, s.points, s.intensities, s.time_offsets) for s in recording],
                              recording.T_base_lidar, recording.wheel, recording.imu, recording.T_base_imu, recording.truth)
        np.testing.assert_array_equal(adit.odometry(copy, {"check_sensors": False}).trajectory.poses,
                                      adit.odometry(recording, {"check_sensors": False}).trajectory.poses)
        with self.assertRaisesRegex(ValueError, "ascend"):
            adit.Recording("twice", [recording[0], recording[0]])
        with self.assertRaisesRegex(ValueError, "intensities"):
            adit.Scan(0, np.zeros((3, 3)), intensities=[1.0])


class Odometry(unittest.TestCase):
    def test_a_drive_is_followed(self):
        recording = robots()[0]
        run = adit.odometry(recording)
        self.assertEqual(len(run.trajectory), len(recording))
        self.assertEqual(run.statuses[0], "no_map")
        self.assertLess(adit.ate(run.trajectory, recording.truth).max, 0.3)

    def test_scan_by_scan_gives_the_same(self):
        recording = robots()[0][:30]
        odometry = adit.Odometry(recording.T_base_lidar)
        poses = [odometry.register_scan(recording[i], recording.motion_before(i)).T_odom_base for i in range(30)]
        np.testing.assert_array_equal(poses, adit.odometry(recording, {"check_sensors": False}).trajectory.poses)
        self.assertGreater(len(odometry.points_of_last_scan), 1000)

    def test_threads_that_share_one_wait_for_one_another(self):
        recording = robots()[0][:30]
        alone = adit.odometry(recording, {"check_sensors": False})
        odometry = adit.Odometry(recording.T_base_lidar)
        is_over = threading.Event()
        errors = []

        def look_on():
            try:
                while not is_over.is_set():
                    points = odometry.points_of_last_scan
                    if not np.isfinite(points).all():
                        errors.append("points that are no numbers")
            except Exception as error:  # shown below: what a thread throws fails no test
                errors.append(error)

        threads = [threading.Thread(target=look_on) for _ in range(2)]
        for thread in threads:
            thread.start()
        poses = [odometry.register_scan(recording[i], recording.motion_before(i)).T_odom_base for i in range(30)]
        is_over.set()
        for thread in threads:
            thread.join()
        self.assertEqual(errors, [])
        np.testing.assert_array_equal(poses, alone.trajectory.poses)

    def test_wheels_of_the_caller_count(self):
        recording = robots()[0][:2]
        wheels = np.eye(4)
        wheels[0, 3] = 0.5
        empty = adit.Scan(int(recording.stamps[1]), np.zeros((0, 3)))
        odometry = adit.Odometry(recording.T_base_lidar)
        odometry.register_scan(recording[0])
        step = odometry.register_scan(empty, adit.Motion(wheels, 0.2, 1e-4 * np.eye(6)))
        self.assertEqual(step.status, "too_few_points")
        self.assertAlmostEqual(step.T_odom_base[0, 3], 0.5, delta=0.05)

    def test_wheels_that_are_missing_are_named(self):
        recording = robots()[0][:3]
        bare = adit.Recording("bare", list(recording), recording.T_base_lidar)
        with self.assertRaisesRegex(adit.Error, "kiss-icp"):
            adit.odometry(bare, profile="paper", config={"robot.odometry.method": "kinematic-icp"})


class Registration(unittest.TestCase):
    def test_a_turned_cloud_is_placed(self):
        points = robots()[0][0].points
        T_a_b = np.array([[0, -1, 0, 2], [1, 0, 0, 1], [0, 0, 1, 0.1], [0, 0, 0, 1.0]])
        inverse = np.linalg.inv(T_a_b)
        found = adit.register(points, points @ inverse[:3, :3].T + inverse[:3, 3])
        self.assertIsNotNone(found.T_a_b)
        np.testing.assert_allclose(found.T_a_b, T_a_b, atol=0.05)
        self.assertEqual(found.information.shape, (6, 6))

    def test_no_points_no_answer(self):
        found = adit.register(np.zeros((0, 3)), np.zeros((0, 3)))
        self.assertFalse(found.accepted)
        self.assertIsNone(found.T_a_b)
        self.assertTrue(found.reason)


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.recordings = robots()
        cls.session = adit.slam(cls.recordings)
        cls.path = Path(cls.folder.name) / "session"
        cls.session.save(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_two_robots_share_one_map(self):
        a, b = self.session.robots
        self.assertEqual(self.session.components, [[a, b]])
        (pair,) = self.session.pairs
        self.assertTrue(pair.merged, pair.reason)
        truths = [recording.truth for recording in self.recordings]
        errors = adit.joint_ate([self.session.trajectory(a), self.session.trajectory(b)], truths)
        self.assertLess(max(error.max for error in errors), 0.5)
        self.assertEqual(self.session.failures, [])
        self.assertTrue(any(loop.in_use and {loop.from_robot, loop.to_robot} == {a, b} for loop in self.session.loops))
        self.assertEqual(len(self.session.odometry(a)), len(self.recordings[0]))
        self.assertTrue(self.session.metrics)
        with self.assertRaisesRegex(KeyError, "robot_9"):
            self.session.trajectory("robot_9")

    def test_the_saved_session_is_the_same(self):
        saved = adit.read_session(self.path)
        self.assertEqual(saved.robots, self.session.robots)
        self.assertEqual(saved.components, self.session.components)
        for robot in saved.robots:
            np.testing.assert_allclose(saved.trajectory(robot).poses, self.session.trajectory(robot).poses, atol=1e-6)
            self.assertEqual(len(saved.points(robot, 0.3)), len(self.session.points(robot, 0.3)))
        evaluation = saved.evaluate({robot: recording.truth for robot, recording in zip(saved.robots, self.recordings)})
        self.assertTrue(evaluation)

    def test_points_of_a_robot_need_no_other_map(self):
        alone = Path(self.folder.name) / "alone"
        self.session.save(alone)
        a, b = self.session.robots
        (alone / b / "map.adit").unlink()
        saved = adit.read_session(alone)
        self.assertEqual(len(saved.points(a, 0.3)), len(self.session.points(a, 0.3)))
        with self.assertRaisesRegex(adit.Error, "map.adit"):
            saved.points(b)

    def test_other_threads_run_while_a_session_is_saved(self):
        ticks = []
        done = threading.Event()

        def tick():
            while not done.wait(0.001):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        self.session.save(Path(self.folder.name) / "threads")
        end = time.monotonic()
        done.set()
        thread.join()
        # In the middle half: a call that holds the interpreter lets others in at its ends alone.
        quarter = (end - begin) / 4
        self.assertTrue(any(begin + quarter < tick < end - quarter for tick in ticks))

    def test_a_veto_keeps_them_apart_until_it_is_withdrawn(self):
        robots = tuple(self.session.robots)
        apart = adit.merge([self.path], veto=[robots])
        self.assertEqual(len(apart.components), 2)
        (pair,) = apart.pairs
        self.assertFalse(pair.merged)
        self.assertIn("a person keeps these maps apart", pair.reason)
        path = Path(self.folder.name) / "apart"
        apart.save(path)
        (again,) = adit.merge([path], withdraw=[robots]).pairs
        self.assertTrue(again.merged)

    def test_what_went_wrong_is_said(self):
        with self.assertRaises(adit.Error):
            adit.slam([])
        with self.assertRaisesRegex(adit.Error, "nowhere"):
            adit.merge(["/nowhere"])
        foreign = Path(self.folder.name) / "mine"
        foreign.mkdir()
        (foreign / "thesis.tex").write_text("do not touch")
        with self.assertRaisesRegex(adit.Error, "mine"):
            self.session.save(foreign)
        self.assertEqual((foreign / "thesis.tex").read_text(), "do not touch")


class LongCalls(unittest.TestCase):
    def test_other_threads_run_meanwhile(self):
        recording = robots()[0][:60]
        ticks = []
        stop = threading.Event()

        def tick():
            while not stop.wait(0.002):
                ticks.append(time.monotonic())

        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        adit.odometry(recording)
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [t for t in ticks if begin < t < end]
        self.assertGreater(len(during), 3)

    def test_ctrl_c_ends_them(self):
        recordings = robots()
        timer = threading.Timer(0.5, lambda: os.kill(os.getpid(), signal.SIGINT))
        timer.start()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(100):
                adit.slam(recordings)


if __name__ == "__main__":
    unittest.main()
