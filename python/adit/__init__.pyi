# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
import os
from typing import Any, Mapping, Sequence, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

__version__: str

_Floats = NDArray[np.float64]
_Points = NDArray[np.float32]
_Stamps = NDArray[np.int64]
_StrPath = str | os.PathLike[str]
_Config = Mapping[str, bool | int | float | str] | str | None
"""Settings: a dict of dotted keys ("robot.cloud_voxel": 0.2) or a text in TOML, as 'adit config' prints them."""

class Error(RuntimeError):
    """What adit refuses: one line that names the file, the place and the remedy."""

def set_num_threads(num_threads: int) -> None:
    """How many threads the process may use. Results never depend on it."""

def configuration(config: _Config = None, profile: str = "default") -> dict[str, bool | int | float | str]:
    """Every field of the configuration with its value. Profiles: default, paper, lidar-only."""

# ---- clouds and trajectories ----------------------------------------------------------------------------------

def read_cloud(path: _StrPath) -> _Points:
    """The points of a .pcd, .ply or .bin file, (n, 3). Points that are not finite are left out."""

def write_cloud(path: _StrPath, points: ArrayLike) -> None:
    """Writes points (n, 3) as .pcd, .ply or .bin."""

class Trajectory:
    """Poses of one body with their stamps, which ascend strictly."""
    def __init__(self, stamps: ArrayLike, poses: ArrayLike) -> None: ...
    def __len__(self) -> int: ...
    @property
    def stamps(self) -> _Stamps:
        """(n), nanoseconds."""
    @property
    def poses(self) -> _Floats:
        """(n, 4, 4), T_world_body."""
    @property
    def positions(self) -> _Floats:
        """(n, 3), metres."""
    @property
    def length(self) -> float:
        """Of the line through the positions, metres."""
    def write(self, path: _StrPath) -> None:
        """As TUM, or by ending as .csv or .kitti."""

def read_trajectory(path: _StrPath) -> Trajectory:
    """A trajectory of a TUM or .csv file."""

# ---- recordings -----------------------------------------------------------------------------------------------

class Scan:
    """One sweep, in the frame of the LiDAR. A point's time is the stamp plus its offset, nanoseconds."""
    def __init__(
        self, stamp: int, points: ArrayLike, intensities: ArrayLike | None = None, time_offsets: ArrayLike | None = None
    ) -> None: ...
    def __len__(self) -> int: ...
    @property
    def stamp(self) -> int: ...
    @property
    def points(self) -> _Points: ...
    @property
    def intensities(self) -> NDArray[np.float32] | None: ...
    @property
    def time_offsets(self) -> NDArray[np.int32] | None: ...

class Motion:
    """What wheels and IMU measured from one scan to the next.

    Made of wheels alone: duration in seconds; covariance of T_base0_base1 (6, 6), right perturbation,
    translation first, metres and radians.
    """
    def __init__(self, T_base0_base1: ArrayLike, duration: float, covariance: ArrayLike) -> None: ...

class Recording:
    """All that one robot measured. Scans are read when they are asked for: recording[i], or for scan in recording.

    A slice, recording[first:last:step], is a recording of these scans. The constructor makes one of arrays.
    """
    name: str
    def __init__(
        self,
        name: str,
        scans: Sequence[Scan],
        T_base_lidar: ArrayLike = ...,
        wheel: Trajectory | None = None,
        imu: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
        T_base_imu: ArrayLike = ...,
        truth: Trajectory | None = None,
    ) -> None: ...
    def __len__(self) -> int: ...
    @overload
    def __getitem__(self, index: int) -> Scan: ...
    @overload
    def __getitem__(self, part: slice) -> Recording: ...
    @property
    def lidar(self) -> str:
        """The name of the sensor, "" when unknown."""
    @property
    def T_base_lidar(self) -> _Floats:
        """The mount (4, 4): where the LiDAR sits on the robot."""
    @property
    def mount_source(self) -> str:
        """How the mount is known."""
    @property
    def assumptions(self) -> list[str]:
        """What the reader assumed, a sentence each with its remedy."""
    @property
    def warnings(self) -> list[str]:
        """What could not be read, a sentence each."""
    @property
    def stamps(self) -> _Stamps:
        """Of the scans, nanoseconds."""
    @property
    def wheel(self) -> Trajectory | None:
        """Wheel odometry, T_wheelodom_base."""
    @property
    def truth(self) -> Trajectory | None:
        """T_world_base where the recording knows it; nothing but evaluation reads it."""
    @property
    def imu(self) -> tuple[_Stamps, _Floats, _Floats] | None:
        """Stamps (n), angular velocities (n, 3) in rad/s, specific forces (n, 3) in m/s^2, in the IMU's frame."""
    @property
    def T_base_imu(self) -> _Floats:
        """The mount of the IMU (4, 4)."""
    def motion_before(self, index: int) -> Motion:
        """What wheels and IMU measured since the scan before."""

def open_recording(path: _StrPath, config: _Config = None) -> Recording:
    """Opens a bag (.mcap, .db3, .bag, or a folder of them) or a folder of clouds.

    recording.* of the configuration says how: {"recording.points": "/husky1/points"}.
    """

def simulate(config: _Config = None) -> list[Recording]:
    """Drives robots through a generated world (world.*, simulation.*); scans are cast when asked for."""

# ---- odometry -------------------------------------------------------------------------------------------------

class OdometryStep:
    """The answer to one scan."""
    @property
    def stamp(self) -> int: ...
    @property
    def T_odom_base(self) -> _Floats: ...
    @property
    def information(self) -> _Floats:
        """Of T_odom_base (6, 6), right perturbation, translation first; zero along open directions."""
    @property
    def status(self) -> str:
        """ok, no_map, too_few_points, degenerate or diverged; but for ok the pose is, at least in part, a prediction."""
    @property
    def num_correspondences(self) -> int: ...
    @property
    def iterations(self) -> int: ...

class Odometry:
    """Follows one robot, scan by scan, by the method that robot.odometry.method names."""
    def __init__(self, T_base_lidar: ArrayLike = ..., config: _Config = None, profile: str = "default") -> None: ...
    def register_scan(self, scan: Scan, motion: Motion | None = None) -> OdometryStep:
        """Stamps ascend strictly. motion is that since the scan before."""
    @property
    def points_of_last_scan(self) -> _Points:
        """Deskewed, at full density, in the frame of the base."""

class OdometryRun:
    @property
    def trajectory(self) -> Trajectory:
        """T_odom_base of every scan."""
    @property
    def statuses(self) -> list[str]:
        """Of every scan, as OdometryStep.status."""
    @property
    def notes(self) -> list[str]:
        """What was found of wheels and IMU, a sentence each."""

def odometry(recording: Recording, config: _Config = None, profile: str = "default") -> OdometryRun:
    """The odometry of a recording, as 'adit odometry' computes it. Wheels and IMU are checked first."""

# ---- registration ---------------------------------------------------------------------------------------------

class Registration:
    """The relative pose of two clouds with its evidence."""
    @property
    def accepted(self) -> bool: ...
    @property
    def reason(self) -> str:
        """Why it is accepted or not."""
    @property
    def T_a_b(self) -> _Floats | None:
        """p_a = T_a_b p_b. Where it is not accepted, the best guess, for display only."""
    @property
    def information(self) -> _Floats:
        """Of T_a_b (6, 6), right perturbation, translation first; zero along open directions."""
    @property
    def num_inliers(self) -> int: ...
    @property
    def num_correspondences(self) -> int: ...
    @property
    def overlap(self) -> float:
        """Share of points with a neighbour in the other cloud, the smaller of both ways."""
    @property
    def weak_axis(self) -> float:
        """0 where the clouds can slide along an axis, 1/3 where all directions are held alike."""
    @property
    def weak_direction(self) -> _Floats: ...

def register(a: ArrayLike, b: ArrayLike, config: _Config = None) -> Registration:
    """The relative pose of two clouds (n, 3) without a guess (fields loops.adaptive.registration.*)."""

# ---- maps of several robots -----------------------------------------------------------------------------------

class Pair:
    """What became of two robots."""
    @property
    def a(self) -> str: ...
    @property
    def b(self) -> str: ...
    @property
    def merged(self) -> bool: ...
    @property
    def reason(self) -> str:
        """Why they are not merged; "" where they are."""
    @property
    def num_loops(self) -> int: ...

class Loop:
    """A loop that registration accepted."""
    @property
    def from_robot(self) -> str: ...
    @property
    def to_robot(self) -> str: ...
    @property
    def from_stamp(self) -> int: ...
    @property
    def to_stamp(self) -> int: ...
    @property
    def T_from_to(self) -> _Floats: ...
    @property
    def information(self) -> _Floats: ...
    @property
    def in_use(self) -> bool:
        """Whether the joint solution holds it."""

class Session:
    """What slam or merge made of robots."""
    @property
    def robots(self) -> list[str]: ...
    @property
    def components(self) -> list[list[str]]:
        """Robots that share a frame: that of the odometry of the first."""
    @property
    def pairs(self) -> list[Pair]: ...
    @property
    def loops(self) -> list[Loop]: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def failures(self) -> list[str]:
        """Recordings that could not be mapped, a sentence each; the others went on."""
    @property
    def metrics(self) -> dict[str, Any]:
        """What metrics.json of the session holds."""
    def trajectory(self, robot: str) -> Trajectory:
        """Its keyframes in the frame of its component."""
    def odometry(self, robot: str) -> Trajectory:
        """T_odom_base of every scan."""
    def points(self, robot: str, voxel: float = 0.1) -> _Points:
        """Its map in the frame of its component, one point a voxel (metres)."""
    def save(self, path: _StrPath) -> None:
        """Writes the session directory, as 'adit slam --out' does."""

class SavedSession:
    """A session directory."""
    @property
    def robots(self) -> list[str]: ...
    @property
    def components(self) -> list[list[str]]: ...
    def trajectory(self, robot: str) -> Trajectory: ...
    def odometry(self, robot: str) -> Trajectory: ...
    def points(self, robot: str, voxel: float = 0.1) -> _Points: ...
    def evaluate(self, truths: Mapping[str, Trajectory]) -> dict[str, Any]:
        """Errors of trajectories and classes of loops, as 'adit evaluate --json' prints them."""

def slam(recordings: Sequence[Recording], config: _Config = None, profile: str = "default") -> Session:
    """Maps every robot, lets each meet every other, and merges what tested evidence joins."""

def merge(
    sessions: Sequence[_StrPath],
    recordings: Sequence[Recording] = ...,
    *,
    veto: Sequence[tuple[str, str]] = ...,
    confirm: Sequence[tuple[str, str]] = ...,
    withdraw: Sequence[tuple[str, str]] = ...,
) -> Session:
    """Goes on from saved sessions: joins them, and adds robots or later visits. veto and confirm overrule the test,
    until withdraw lets its own verdict count again."""

def read_session(path: _StrPath) -> SavedSession: ...

# ---- pose graphs ----------------------------------------------------------------------------------------------

class PoseGraph:
    """Poses in space, (n, 4, 4), and measured relative poses, (m, 4, 4), between those that edges (m, 2) counts."""
    def __init__(
        self,
        keys: ArrayLike,
        poses: ArrayLike,
        edges: ArrayLike,
        measurements: ArrayLike,
        information: ArrayLike,
        is_loop: ArrayLike,
    ) -> None: ...
    @property
    def keys(self) -> NDArray[np.uint64]: ...
    @property
    def poses(self) -> _Floats: ...
    @property
    def edges(self) -> NDArray[np.int64]: ...
    @property
    def measurements(self) -> _Floats:
        """T_from_to."""
    @property
    def information(self) -> _Floats:
        """(m, 6, 6), translation first."""
    @property
    def is_loop(self) -> NDArray[np.bool_]:
        """False: odometry, which is trusted."""
    def write(self, path: _StrPath) -> None:
        """As g2o."""

class PoseGraph2:
    """The same in the plane: poses and measurements are x, y and heading, (n, 3); information is (m, 3, 3)."""
    def __init__(
        self,
        keys: ArrayLike,
        poses: ArrayLike,
        edges: ArrayLike,
        measurements: ArrayLike,
        information: ArrayLike,
        is_loop: ArrayLike,
    ) -> None: ...
    @property
    def keys(self) -> NDArray[np.uint64]: ...
    @property
    def poses(self) -> _Floats: ...
    @property
    def edges(self) -> NDArray[np.int64]: ...
    @property
    def measurements(self) -> _Floats: ...
    @property
    def information(self) -> _Floats: ...
    @property
    def is_loop(self) -> NDArray[np.bool_]: ...
    def write(self, path: _StrPath) -> None: ...

class Solution:
    @property
    def poses(self) -> _Floats:
        """One for each of the graph's, in its order and shape."""
    @property
    def cost_initial(self) -> float:
        """chi2 at the graph's own poses, unhalved."""
    @property
    def cost_final(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def edge_weights(self) -> _Floats:
        """One for each edge; 0: rejected."""

class Solution2:
    @property
    def poses(self) -> _Floats: ...
    @property
    def cost_initial(self) -> float: ...
    @property
    def cost_final(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def reason(self) -> str: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def edge_weights(self) -> _Floats: ...

def read_graph(path: _StrPath) -> PoseGraph | PoseGraph2:
    """The pose graph of a g2o file."""

@overload
def solve(graph: PoseGraph, *, gnc: bool = False, config: _Config = None) -> Solution: ...
@overload
def solve(graph: PoseGraph2, *, gnc: bool = False, config: _Config = None) -> Solution2:
    """Minimises chi2 over all poses (fields back_end.gnc.*); with gnc it finds and rejects false loops."""

# ---- errors of trajectories -----------------------------------------------------------------------------------

class Ate:
    """Absolute trajectory error after a rigid alignment, metres."""
    @property
    def stamps(self) -> _Stamps: ...
    @property
    def errors(self) -> _Floats:
        """One for each stamp."""
    @property
    def positions(self) -> _Floats:
        """The aligned estimate, (n, 3)."""
    @property
    def T_world_estimate(self) -> _Floats: ...
    @property
    def max(self) -> float: ...
    @property
    def rmse(self) -> float: ...
    @property
    def mean(self) -> float: ...
    @property
    def median(self) -> float: ...
    @property
    def num_unmatched(self) -> int:
        """Poses without a truth."""

class Rpe:
    """Relative pose error over segments of one length, metres and radians."""
    @property
    def translation_errors(self) -> _Floats: ...
    @property
    def rotation_errors(self) -> _Floats: ...
    @property
    def segment(self) -> float: ...
    @property
    def translation_rmse(self) -> float: ...
    @property
    def translation_median(self) -> float: ...
    @property
    def rotation_rmse(self) -> float: ...
    @property
    def rotation_median(self) -> float: ...

def ate(estimate: Trajectory, truth: Trajectory) -> Ate: ...
def joint_ate(estimates: Sequence[Trajectory], truths: Sequence[Trajectory]) -> list[Ate]:
    """ATE of robots that share a frame, after one alignment of all together."""
def rpe(estimate: Trajectory, truth: Trajectory, segment: float = 10.0, tolerance: float = 0.1) -> Rpe: ...
