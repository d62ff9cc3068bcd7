# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Multi-robot LiDAR SLAM for tunnels, mines and caves.

Arrays are numpy's. Poses are 4 x 4 matrices T_a_b, p_a = T_a_b p_b; stamps are integer nanoseconds; points are (n, 3),
metres. What adit refuses raises adit.Error with its one line: the file, the place and the remedy; an argument that
cannot be right raises ValueError. Odometry, registration, SLAM and solving let other
threads run, and Ctrl-C ends them.
"""

from . import _adit
from ._adit import *  # noqa: F403
from ._adit import __version__

__all__ = [name for name in dir(_adit) if not name.startswith("_")]
for _name in __all__:  # classes and errors say where users find them
    if isinstance(getattr(_adit, _name), type):
        getattr(_adit, _name).__module__ = __name__
del _name
