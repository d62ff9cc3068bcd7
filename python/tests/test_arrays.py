# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""What goes in and out as arrays: clouds, trajectories, graphs, errors of trajectories, configurations."""
import tempfile
import unittest
from pathlib import Path

import numpy as np

import adit

CONFORMANCE = Path(__file__).resolve().parents[2] / "tests" / "conformance"


def pose(x=0.0, y=0.0, yaw=0.0, z=0.0):
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])


def circle(n=200, radius=20.0, turns=1.0):
    angles = np.linspace(0, 2 * np.pi * turns, n)
    poses = np.array([pose(radius * np.cos(a), radius * np.sin(a), a + np.pi / 2) for a in angles])
    return adit.Trajectory(np.arange(n) * 100_000_000, poses)


class Configuration(unittest.TestCase):
    def test_a_dict_and_toml_say_the_same(self):
        by_dict = adit.configuration({"robot.cloud_voxel": 0.25, "robot.odometry.method": "kiss-icp", "check_sensors": False})
        by_toml = adit.configuration("check_sensors = false\n[robot]\ncloud_voxel = 0.25\n[robot.odometry]\nmethod = 'kiss-icp'\n")
        self.assertEqual(by_dict, by_toml)
        self.assertEqual((by_dict["robot.cloud_voxel"], by_dict["robot.odometry.method"], by_dict["check_sensors"]),
                         (0.25, "kiss-icp", False))

    def test_what_it_prints_it_takes(self):
        paper = adit.configuration(profile="paper")
        self.assertNotEqual(paper, adit.configuration())
        self.assertEqual(adit.configuration(paper), paper)

    def test_an_unknown_key_is_refused_with_the_nearest(self):
        with self.assertRaisesRegex(adit.Error, "robot.cloud_voxel"):
            adit.configuration({"robot.cloud_voxle": 0.25})
        with self.assertRaisesRegex(adit.Error, "line 2"):
            adit.configuration("[robot]\ncloud_voxel = -1")
        with self.assertRaises(TypeError):
            adit.configuration(3)
        with self.assertRaisesRegex(ValueError, "lidar-only"):
            adit.configuration(profile="fast")


class Clouds(unittest.TestCase):
    def test_points_come_back(self):
        points = np.random.default_rng(1).normal(size=(100, 3)).astype(np.float32)
        with tempfile.TemporaryDirectory() as folder:
            for name in ("a.pcd", "a.ply", "a.bin"):
                adit.write_cloud(Path(folder) / name, points)
                np.testing.assert_array_equal(adit.read_cloud(f"{folder}/{name}"), points)
            adit.write_cloud(f"{folder}/b.pcd", np.asfortranarray(points.astype(float)))
            np.testing.assert_array_equal(adit.read_cloud(f"{folder}/b.pcd"), points)

    def test_a_wrong_shape_is_refused(self):
        for points in (np.zeros(3), np.zeros((4, 2)), np.zeros((2, 2, 3))):
            with self.assertRaisesRegex(ValueError, r"\(n, 3\)"):
                adit.write_cloud("x.pcd", points)

    def test_a_missing_file_is_named(self):
        with self.assertRaisesRegex(adit.Error, "/nowhere/a.pcd"):
            adit.read_cloud("/nowhere/a.pcd")


class Trajectories(unittest.TestCase):
    def test_a_trajectory_comes_back(self):
        path = circle()
        with tempfile.TemporaryDirectory() as folder:
            path.write(f"{folder}/a.tum")
            again = adit.read_trajectory(f"{folder}/a.tum")
        np.testing.assert_array_equal(again.stamps, path.stamps)
        np.testing.assert_allclose(again.poses, path.poses, atol=1e-12)
        np.testing.assert_array_equal(path.positions, path.poses[:, :3, 3])
        self.assertEqual(len(path), 200)
        self.assertAlmostEqual(path.length, 40 * np.pi, delta=0.1)

    def test_what_is_no_trajectory_is_refused(self):
        with self.assertRaisesRegex(ValueError, "ascend"):
            adit.Trajectory([1, 1], [pose(), pose()])
        with self.assertRaisesRegex(ValueError, "one stamp"):
            adit.Trajectory([1, 2], [pose()])
        with self.assertRaises(ValueError):
            adit.Trajectory([1], [2 * pose()])
        with self.assertRaises(ValueError):
            adit.Trajectory([1], [np.full((4, 4), np.nan)])

    def test_seconds_are_no_stamps(self):
        for seconds in ([1.0, 2.0], np.array([1.0, 2.0])):
            with self.assertRaisesRegex(ValueError, "nanoseconds"):
                adit.Trajectory(seconds, [pose(), pose()])
        with self.assertRaisesRegex(ValueError, "nanoseconds"):
            adit.Scan(0, np.zeros((3, 3)), time_offsets=np.linspace(0, 0.1, 3))
        with self.assertRaisesRegex(ValueError, "two seconds"):
            adit.Scan(0, np.zeros((3, 3)), time_offsets=np.array([0, 1, 10**18]))

    def test_a_setting_is_a_scalar(self):
        quick = {"robot.odometry.plane_icp.voxel_size": np.float64(0.5)}
        self.assertIsInstance(adit.Odometry(config=quick), adit.Odometry)
        with self.assertRaises(TypeError):
            adit.Odometry(config={"robot.odometry.method": None})

    def test_ate_is_that_of_the_definition(self):
        truth = circle()
        noise = np.random.default_rng(2).normal(scale=0.1, size=(200, 3))
        moved = pose(3, -2, 0.7, 1) @ truth.poses
        moved[:, :3, 3] += noise
        found = adit.ate(adit.Trajectory(truth.stamps, moved), truth)
        # Umeyama's alignment, without scale.
        a, b = moved[:, :3, 3], truth.positions
        u, _, vt = np.linalg.svd((b - b.mean(0)).T @ (a - a.mean(0)))
        rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
        errors = np.linalg.norm((a - a.mean(0)) @ rotation.T + b.mean(0) - b, axis=1)
        np.testing.assert_allclose(found.errors, errors, atol=1e-9)
        self.assertAlmostEqual(found.rmse, np.sqrt((errors**2).mean()), places=9)
        self.assertAlmostEqual(found.max, errors.max(), places=9)
        aligned = found.T_world_estimate[:3, :3] @ a.T + found.T_world_estimate[:3, 3:]
        np.testing.assert_allclose(aligned.T, found.positions, atol=1e-9)

    def test_one_alignment_shows_that_two_maps_are_apart(self):
        truths = [circle(), circle(radius=30.0)]
        shifted = truths[1].poses.copy()
        shifted[:, 0, 3] += 2.0
        estimates = [truths[0], adit.Trajectory(truths[1].stamps, shifted)]
        self.assertLess(adit.ate(estimates[1], truths[1]).max, 1e-6)
        self.assertGreater(max(result.max for result in adit.joint_ate(estimates, truths)), 0.9)

    def test_rpe_of_a_scale(self):
        truth = circle()
        longer = truth.poses.copy()
        longer[:, :3, 3] *= 1.02
        found = adit.rpe(adit.Trajectory(truth.stamps, longer), truth, segment=5.0)
        self.assertEqual(found.segment, 5.0)
        self.assertAlmostEqual(found.translation_rmse, 0.02 * 5.0, delta=0.02)
        self.assertLess(found.rotation_rmse, 1e-6)
        with self.assertRaisesRegex(adit.Error, "segment|short"):
            adit.rpe(truth, truth, segment=1000.0)
        with self.assertRaises(ValueError):
            adit.rpe(truth, truth, segment=0.0)


class Graphs(unittest.TestCase):
    def ring(self, false_loop=False):
        """A drive around a square, closed by loops, with noise on the odometry."""
        rng = np.random.default_rng(3)
        step = pose(1.0, 0.0, 2 * np.pi / 40)
        truth = [np.eye(4)]
        for _ in range(79):
            truth.append(truth[-1] @ step)
        edges = [(i, i + 1) for i in range(79)] + [(i, i + 40) for i in range(0, 40, 4)]
        measurements = [np.linalg.inv(truth[a]) @ truth[b] for a, b in edges]
        if false_loop:
            edges.append((5, 25))
            measurements.append(np.eye(4))
        poses = [np.eye(4)]
        for i in range(79):
            poses.append(poses[-1] @ measurements[i] @ pose(*rng.normal(scale=0.02, size=2), rng.normal(scale=0.01)))
        is_loop = [i >= 79 for i in range(len(edges))]
        information = np.tile(np.diag([100.0] * 3 + [400.0] * 3), (len(edges), 1, 1))
        return adit.PoseGraph(np.arange(80), poses, edges, measurements, information, is_loop), np.array(truth)

    def test_a_ring_closes(self):
        graph, truth = self.ring()
        solution = adit.solve(graph)
        self.assertEqual(solution.status, "converged")
        self.assertLess(solution.cost_final, 1e-6)
        self.assertGreater(solution.cost_initial, 1.0)
        np.testing.assert_allclose(solution.poses, truth, atol=1e-4)

    def test_a_false_loop_is_rejected(self):
        graph, truth = self.ring(false_loop=True)
        solution = adit.solve(graph, gnc=True)
        self.assertEqual(solution.edge_weights[-1], 0)
        self.assertTrue((solution.edge_weights[:-1] == 1).all())
        np.testing.assert_allclose(solution.poses, truth, atol=1e-4)
        self.assertGreater(np.abs(adit.solve(graph).poses - truth).max(), 0.1)

    def test_a_graph_comes_back(self):
        graph, _ = self.ring()
        with tempfile.TemporaryDirectory() as folder:
            graph.write(f"{folder}/a.g2o")
            again = adit.read_graph(f"{folder}/a.g2o")
        for name in ("keys", "edges", "is_loop"):
            np.testing.assert_array_equal(getattr(again, name), getattr(graph, name))
        for name in ("poses", "measurements", "information"):
            np.testing.assert_allclose(getattr(again, name), getattr(graph, name), atol=1e-9)

    def test_a_graph_of_the_plane(self):
        graph = adit.PoseGraph2([0, 1, 2], [(0, 0, 0), (1.2, 0.1, 0), (2.3, 0, 0)], [(0, 1), (1, 2), (0, 2)],
                                [(1, 0, 0), (1, 0, 0), (2, 0, 0)], np.tile(np.eye(3), (3, 1, 1)), [False, False, True])
        np.testing.assert_allclose(adit.solve(graph).poses, [(0, 0, 0), (1, 0, 0), (2, 0, 0)], atol=1e-6)

    def test_the_graph_that_others_read(self):
        solution = adit.solve(adit.read_graph(CONFORMANCE / "square.g2o"))
        self.assertTrue(solution.reason)
        self.assertLessEqual(solution.cost_final, solution.cost_initial)

    def test_what_is_no_graph_is_refused(self):
        one = np.eye(6)[None]
        with self.assertRaisesRegex(ValueError, "keys"):
            adit.PoseGraph([0], [np.eye(4)] * 2, [(0, 1)], [np.eye(4)], one, [False])
        with self.assertRaises(ValueError):
            adit.PoseGraph([0, 1], [np.eye(4)] * 2, [(0, 2)], [np.eye(4)], one, [False])
        with self.assertRaisesRegex(ValueError, "counted from 0"):
            adit.PoseGraph([0, 1], [np.eye(4)] * 2, [(-1, 1)], [np.eye(4)], one, [False])
        negative = adit.PoseGraph([0, 1], [np.eye(4)] * 2, [(0, 1)], [np.eye(4)], -one, [False])
        with self.assertRaisesRegex(adit.Error, "indefinite"):
            adit.solve(negative)


if __name__ == "__main__":
    unittest.main()
