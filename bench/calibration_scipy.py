#!/usr/bin/python3
"""Calibration of the linkage: abbe against SciPy's least_squares, in one run, on one core.

Usage: calibration_scipy.py BUILD/bench/calibration

Both fit the 24 published parameters to the same 588 poses with the same whitening and priors, from the nominal
linkage; the estimates are compared. SciPy works on whole arrays, once with a numeric and once with an analytic
Jacobian, at its default tolerances. Each figure is the least of five repetitions, in processor time. Targets: 10
times the numeric, 3 times the analytic; mapping of the cube below 1 s.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"  # before NumPy starts its threads

import numpy as np
from scipy.optimize import least_squares


def turn(axis, angle):
    """Rotations and their derivatives by the angle, n x 3 x 3."""
    angle = np.atleast_1d(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    c, s = np.cos(angle), np.sin(angle)
    R, D = np.zeros((2, len(angle), 3, 3))
    R[:, 3 - i - j, 3 - i - j] = 1
    R[:, i, i] = R[:, j, j] = c
    R[:, i, j], R[:, j, i] = -s, s
    D[:, i, i] = D[:, j, j] = -s
    D[:, i, j], D[:, j, i] = -c, c
    return R, D


class Linkage:
    """p = product of turns and shifts; the places of the 24 parameters are those of docs/theory-linkage.md."""

    def __init__(self, q, names):
        self.q, self.names = q, names
        waves = lambda a: np.stack([np.sin(a), np.cos(a), np.sin(2 * a), np.cos(2 * a)], axis=1)
        run_out = [[f"bearing.pivot_{i}_{w}" for w in ("sin_1", "cos_1", "sin_2", "cos_2")] for i in (1, 2, 3)]
        right = np.pi / 2
        segment = lambda name, i=None: ("s", name, None if i is None else (run_out[i], waves(q[:, i])))
        self.moves = [("x", "tilt.head_x", 0), ("y", "tilt.head_y", 0), ("z", "radial_angle.pivot_1", q[:, 0]),
                      ("y", None, right), segment("link.segment_1", 0), ("z", "radial_angle.pivot_2_twist", 0),
                      ("y", "radial_angle.pivot_2", q[:, 1]), segment("link.segment_2", 1),
                      ("z", "radial_angle.pivot_3_twist", 0), ("y", None, -right), segment("link.segment_3"),
                      ("y", "radial_angle.pivot_3", q[:, 2]), segment("link.segment_4", 2), ("z", None, right),
                      ("y", None, right), segment("link.segment_5")]

    def ball(self, x, jacobian=False):
        """Ball positions n x 3; derivatives n x 3 x parameters."""
        at = dict(zip(self.names, range(len(x))))
        p, J = np.zeros((len(self.q), 3)), np.zeros((len(self.q), 3, len(x)))
        for kind, name, data in reversed(self.moves):
            if kind == "s":
                p = p.copy()
                p[:, 2] += x[at[name]]
                J[:, 2, at[name]] = 1
                if data:
                    columns = [at[entry] for entry in data[0]]
                    p[:, 2] += data[1] @ x[columns]
                    J[:, 2, columns] = data[1]
                continue
            R, D = turn(kind, data + (x[at[name]] if name else 0))
            if jacobian:
                J = R @ J
                if name:
                    J[:, :, at[name]] = (D @ p[:, :, None])[:, :, 0]
            p = (R @ p[:, :, None])[:, :, 0]
        return p, J


def least(task, repetitions=5):
    times = []
    for _ in range(repetitions):
        start = time.process_time()
        value = task()
        times.append(time.process_time() - start)
    return min(times), value


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "poses.csv"
        out = subprocess.run([sys.argv[1], str(path), "--benchmark_format=json", "--benchmark_repetitions=5"],
                             capture_output=True, text=True, check=True).stdout
        table = np.loadtxt(path, delimiter=",", comments="#")
        rows = [line[2:].split() for line in path.read_text().splitlines() if line.startswith("#")]
    seconds = {}
    for run in json.loads(out)["benchmarks"]:
        if run["run_type"] == "iteration":
            name = run["run_name"].split("/")[0]
            seconds[name] = min(seconds.get(name, np.inf), 1e-3 * run["cpu_time"])
    names = [row[0] for row in rows]
    nominal, prior, value, uncertainty = np.array([[float(v) for v in row[1:]] for row in rows]).T
    W = table[:, 6:15].reshape(-1, 3, 3)
    linkage = Linkage(table[:, :3], names)

    def residuals(y):
        gap = linkage.ball(nominal + prior * y)[0] - table[:, 3:6]
        return np.concatenate([(W @ gap[:, :, None]).ravel(), y])

    def jacobian(y):
        J = W @ linkage.ball(nominal + prior * y, True)[1] * prior
        return np.concatenate([J.reshape(-1, len(y)), np.eye(len(y))])

    start = np.zeros(len(names))
    numeric, found = least(lambda: least_squares(residuals, start))
    analytic, exact = least(lambda: least_squares(residuals, start, jac=jacobian))
    abbe = seconds["Calibrate588x24"]
    apart = np.abs((nominal + prior * exact.x - value) / uncertainty).max()
    print(f"588 poses, 24 parameters; estimates agree within {apart:.1e} standard uncertainties")
    print(f"  abbe                        {1e3 * abbe:9.2f} ms")
    print(f"  SciPy, numeric Jacobian     {1e3 * numeric:9.2f} ms  {numeric / abbe:6.1f} times, target 10")
    print(f"  SciPy, analytic Jacobian    {1e3 * analytic:9.2f} ms  {analytic / abbe:6.1f} times, target 3")
    print(f"mapping of the cube, 250 cells {1e3 * seconds['MapTheCube']:8.0f} ms, target 1000")


if __name__ == "__main__":
    main()
