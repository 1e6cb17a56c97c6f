#!/usr/bin/python3
"""The volumetric error, exact and on a grid: abbe against SciPy and NumPy on whole arrays, in one run, on one core.

Usage: volumetric_numpy.py BUILD/bench/volumetric

The same column machine, 18 cubic B-splines of 12 coefficients, gauged once before the clock starts.
"""
import json
import subprocess
import sys
import time

import numpy as np
from scipy.interpolate import BSpline, RegularGridInterpolator
from scipy.spatial.transform import Rotation

TRAVEL, COEFFICIENTS, POINTS = 0.5, 12, 1 << 14
TOOL = np.array([0.05, -0.04, 0.1])


def machine():
    """One vector-valued spline per axis, and [A0Z B0Z C0Y]."""
    p = 20e-6 * np.cos(1.7 * np.arange(18 * COEFFICIENTS + 3))
    knots = np.r_[[0] * 3, np.linspace(0, TRAVEL, COEFFICIENTS - 2), [TRAVEL] * 3]
    greville = np.array([knots[i + 1:i + 4].mean() for i in range(COEFFICIENTS)])
    u, w = np.polynomial.legendre.leggauss(400)
    x = TRAVEL / 2 * (1 + u)
    c = p[:-3].reshape(3, 6, COEFFICIENTS).copy()
    for axis in range(3):
        for motion in range(6):
            if motion < 3 and motion != axis:
                values = BSpline(knots, c[axis, motion], 3)(x)
                c[axis, motion] -= 1.5 * (w * u * values).sum() / (TRAVEL / 2) * greville
            c[axis, motion] -= c[axis, motion, 0]
    return [BSpline(knots, c[axis].T, 3) for axis in range(3)], p[-3:]


def errors(splines, squareness, positions):
    a0z, b0z, c0y = squareness
    lines = (np.eye(3)[0], Rotation.from_rotvec([0, 0, c0y]).apply(np.eye(3)[1]),
             Rotation.from_rotvec([a0z, b0z, 0]).apply(np.eye(3)[2]))
    motions = [splines[axis](positions[:, axis]) for axis in range(3)]
    turns = [Rotation.from_rotvec(m[:, 3:]) for m in motions]
    shifts = [m[:, :3] + positions[:, [axis]] * lines[axis] for axis, m in enumerate(motions)]
    point = turns[2].apply(TOOL) + shifts[2]
    for axis in (1, 0):  # the bed carries Y, Y carries X
        point = turns[axis].inv().apply(point - shifts[axis])
    return point - (TOOL + positions * [-1, -1, 1])


def least_time(work):
    least = np.inf
    for _ in range(5):
        begin = time.process_time()
        work()
        least = min(least, time.process_time() - begin)
    return least


def main():
    done = subprocess.run([sys.argv[1], "--benchmark_repetitions=5", "--benchmark_format=json"],
                          capture_output=True, text=True, check=True)
    lines = [line for line in json.loads(done.stdout)["benchmarks"] if line["run_type"] == "iteration"]
    best = {line["name"]: max(other["items_per_second"] for other in lines if other["name"] == line["name"]) / 1e6
            for line in lines}
    means = {line["name"]: line["mean_um"] for line in lines if "mean_um" in line}
    i = np.arange(POINTS)[:, None]
    positions = TRAVEL / 2 * (1 + np.sin((np.arange(3) + 1.1) * i))
    splines, squareness = machine()
    stations = np.linspace(0, TRAVEL, 51)
    places = np.stack(np.meshgrid(*[stations] * 3, indexing="ij"), -1)
    grid = RegularGridInterpolator([stations] * 3, errors(splines, squareness, places.reshape(-1, 3)).reshape(places.shape))
    print("million points/s, one core      abbe   SciPy   ratio")
    for name, bench, work in (("exact volumetric error", "Exact", lambda: errors(splines, squareness, positions)),
                              ("on a grid, trilinear", "OnGrid", lambda: grid(positions))):
        theirs = 1e6 * work().mean()
        assert abs(theirs - means[bench]) < 1e-7, (bench, theirs, means[bench])
        peer = POINTS / least_time(work) / 1e6
        print(f"{name:27}{best[bench]:9.2f}{peer:8.2f}{best[bench] / peer:8.1f}")
    for name, bench in (("with all derivatives, batch", "WithDerivativesInBatch"),
                        ("one by one, and parameters", "WithDerivatives")):
        print(f"{name:27}{best[bench]:9.2f}       -       -")


if __name__ == "__main__":
    main()
