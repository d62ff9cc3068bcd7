# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Odometry of one robot, then the shared map of two, in Python. Cells (# %%) run one by one in most editors.

Usage: python3 examples/maps_in_python.py [PICTURE [RECORDING RECORDING]]
Without recordings two simulated robots drive through the tunnels zab. PYTHONPATH=build/release/python finds the module
where it is not installed.
"""
# %% The recordings: bags or folders of clouds, or robots that are simulated
import sys

import matplotlib

matplotlib.use("Agg")  # without a display; leave it out in a notebook
import matplotlib.pyplot as plt

import adit

picture = sys.argv[1] if len(sys.argv) > 1 else "maps_in_python.png"
if len(sys.argv) > 3:
    recordings = [adit.open_recording(path) for path in sys.argv[2:4]]
else:
    zab = adit.simulate({"simulation.lidars": "os2-32"})
    recordings = [zab[1][1050:1450:2], zab[3][1130:1530:2]]
for recording in recordings:
    print(f"{recording.name}: {len(recording)} scans, {len(recording[0])} points in the first; mount: {recording.mount_source}")

# %% Odometry of the first robot
run = adit.odometry(recordings[0])
print(f"{run.trajectory.length:.1f} m, {run.statuses.count('ok')} of {len(run.statuses)} scans fixed all directions")
if recordings[0].truth:
    print(f"greatest error {adit.ate(run.trajectory, recordings[0].truth).max:.3f} m")

# %% Both map, meet, and share one map where tested evidence says so
session = adit.slam(recordings)
for pair in session.pairs:
    print(f"{pair.a} and {pair.b}: " + (f"merged by {pair.num_loops} loops" if pair.merged else f"not merged: {pair.reason}"))

# %% What it looks like
figure, (side, above) = plt.subplots(1, 2, figsize=(13, 5.5), layout="constrained")
scan = recordings[0][len(recordings[0]) // 2]
side.scatter(scan.points[:, 0], scan.points[:, 1], c=scan.points[:, 2], s=1, cmap="viridis")
side.set_title(f"One scan of {recordings[0].name}, coloured by height")
shared = session.components[0]
for robot, colour in zip(shared, ("tab:blue", "tab:orange")):
    points = session.points(robot, voxel=0.3)
    path = session.trajectory(robot).positions
    above.scatter(points[:, 0], points[:, 1], s=0.5, color=colour, alpha=0.25)
    above.plot(path[:, 0], path[:, 1], color=colour, linewidth=2, label=robot)
above.set_title("The shared map from above" if len(shared) > 1 else f"The map of {shared[0]} from above")
above.legend(markerscale=8)
for axes in (side, above):
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x / m")
    axes.set_ylabel("y / m")
figure.savefig(picture, dpi=110)
print(f"picture: {picture}")
