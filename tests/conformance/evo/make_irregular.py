#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The adit authors
# SPDX-License-Identifier: MIT
"""Writes irregular_truth.tum, irregular_estimate.tum and irregular_errors.json beside itself.

The steps are 0.6 to 1.4 m long, so that the pose nearest to 10 m is now before and now after 10 m. The errors follow the
definition of evo (`evo_rpe tum TRUTH ESTIMATE --delta 10 --delta_unit m --all_pairs --pairs_from_reference`): for each
pose i but the last one, of all later poses the one whose distance along the truth is nearest to 10 m (the first of several),
left out where that is off by more than a tenth. Plain loops over all pairs, to be read beside that definition.
"""
import json
import math
import random
import statistics
from pathlib import Path

DELTA = 10.0
TOLERANCE = 0.1
NUM_POSES = 90


def product(a, b):
    """Of two poses, each a matrix of four rows."""
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(T):
    R = [[T[j][i] for j in range(3)] for i in range(3)]
    return [R[i] + [-sum(R[i][k] * T[k][3] for k in range(3))] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def step(length, yaw, pitch):
    """Ahead, then turned about z and y."""
    c, s, d, t = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return [[c * d, -s, c * t, length], [s * d, c, s * t, 0.0], [-t, 0.0, d, 0.0], [0.0, 0.0, 0.0, 1.0]]


def quaternion(T):
    """x y z w of a rotation that turns by less than half a turn about any axis; w > 0."""
    w = 0.5 * math.sqrt(1.0 + T[0][0] + T[1][1] + T[2][2])
    return [(T[2][1] - T[1][2]) / (4 * w), (T[0][2] - T[2][0]) / (4 * w), (T[1][0] - T[0][1]) / (4 * w), w]


def matrix(numbers):
    """Of x y z qx qy qz qw, the quaternion made of length 1."""
    x, y, z, a, b, c, w = numbers
    n = math.sqrt(a * a + b * b + c * c + w * w)
    a, b, c, w = a / n, b / n, c / n, w / n
    return [[1 - 2 * (b * b + c * c), 2 * (a * b - c * w), 2 * (a * c + b * w), x],
            [2 * (a * b + c * w), 1 - 2 * (a * a + c * c), 2 * (b * c - a * w), y],
            [2 * (a * c - b * w), 2 * (b * c + a * w), 1 - 2 * (a * a + b * b), z], [0.0, 0.0, 0.0, 1.0]]


def drives():
    rng = random.Random(10)
    truth = estimate = step(0.0, 0.0, 0.0)
    for _ in range(NUM_POSES):
        yield truth, estimate
        length, yaw, pitch = rng.uniform(0.6, 1.4), rng.uniform(-0.05, 0.05), rng.uniform(-0.01, 0.01)
        truth = product(truth, step(length, yaw, pitch))
        estimate = product(estimate, step(length + rng.gauss(0.01, 0.02), yaw + rng.gauss(0.001, 0.002),
                                          pitch + rng.gauss(0.0, 0.001)))


def write(path, poses):
    path.write_text("".join(
        " ".join([f"{1.7e9 + 0.5 * k:.3f}"] + [f"{v:.9f}" for v in [T[0][3], T[1][3], T[2][3]] + quaternion(T)]) + "\n"
        for k, T in enumerate(poses)))


def read(path):
    return [matrix([float(word) for word in line.split()[1:]]) for line in path.read_text().splitlines()]


def distance(a, b):
    return math.sqrt(sum((a[i][3] - b[i][3]) ** 2 for i in range(3)))


def pairs(truth):
    driven = [0.0]
    for before, after in zip(truth, truth[1:]):
        driven.append(driven[-1] + distance(before, after))
    for i in range(len(truth) - 1):
        off = [abs(driven[j] - driven[i] - DELTA) for j in range(i + 1, len(truth))]
        if min(off) <= TOLERANCE * DELTA:
            yield i, i + 1 + off.index(min(off))


def errors(truth, estimate):
    for i, j in pairs(truth):
        E = product(inverse(product(inverse(truth[i]), truth[j])), product(inverse(estimate[i]), estimate[j]))
        axis = [E[2][1] - E[1][2], E[0][2] - E[2][0], E[1][0] - E[0][1]]
        angle = math.atan2(math.sqrt(sum(v * v for v in axis)), E[0][0] + E[1][1] + E[2][2] - 1.0)
        yield math.sqrt(sum(E[k][3] ** 2 for k in range(3))), angle


def summary(values):
    return {"rmse": math.sqrt(sum(v * v for v in values) / len(values)), "median": statistics.median(values),
            "max": max(values)}


def main():
    here = Path(__file__).resolve().parent
    files = [here / "irregular_truth.tum", here / "irregular_estimate.tum"]
    for path, poses in zip(files, zip(*drives())):
        write(path, poses)
    found = list(errors(*map(read, files)))  # of the files, whose digits are few
    translations, rotations = zip(*found)
    lines = {"rpe_translation_m": {"segments": len(found), **summary(translations)},
             "rpe_rotation_rad": summary(rotations)}
    body = ",\n".join(f"  {json.dumps(key)}: {json.dumps(value)}" for key, value in lines.items())
    (here / "irregular_errors.json").write_text("{\n" + body + "\n}\n")


if __name__ == "__main__":
    main()
