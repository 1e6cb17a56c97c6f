#!/usr/bin/python3
"""The linkage's kinematics: abbe against NumPy on whole arrays and in blocks, in one run, on one core.

Usage: linkage_forward_numpy.py BUILD/bench/linkage_forward [POSES]

Each figure is the least of five repetitions, in processor time. Targets for abbe: forward 10, inverse 5 million poses a
second, and twice NumPy's better figure, on each width of vectors (ABBE_WIDTH in bench/width.h, NPY_DISABLE_CPU_FEATURES
for NumPy).
"""
import json
import subprocess
import sys
import time

import numpy as np

LINK = 0.120
BLOCK = 4096  # poses: the arrays stay in the cache


def forward(q):
    s1, s2, s3 = np.sin(q)
    c1, c2, c3 = np.cos(q)
    a, b = LINK + LINK * s3, LINK * c3
    r = b * s2 + a * c2
    return np.array((c1 * r, s1 * r, b * c2 - a * s2))


def inverse(p):
    x, y, z = p
    square = x * x + y * y
    r = np.sqrt(square)
    sine = (square + z * z - 2 * LINK * LINK) / (2 * LINK * LINK)
    cosine = -np.sqrt(1 - sine * sine)
    a, b = LINK + LINK * sine, LINK * cosine
    return np.array((np.arctan2(y, x), np.arctan2(b * r - a * z, a * r + b * z), np.arctan2(sine, cosine)))


def rate(function, array, block):
    best = np.inf
    for _ in range(5):
        begin = time.process_time()
        for first in range(0, array.shape[1], block):
            function(array[:, first:first + block])
        best = min(best, time.process_time() - begin)
    return array.shape[1] / best / 1e6


def main():
    poses = int(sys.argv[2]) if len(sys.argv) > 2 else 1 << 20
    done = subprocess.run([sys.argv[1], "--benchmark_filter=Batch", "--benchmark_repetitions=5",
                           "--benchmark_format=json"], capture_output=True, text=True, check=True)
    ours = {}
    for line in json.loads(done.stdout)["benchmarks"]:
        if line["run_type"] == "iteration":
            name = line["name"]
            ours[name] = max(ours.get(name, 0), line["items_per_second"] / 1e6)
    random = np.random.default_rng(1)
    p = random.uniform(-0.05, 0.05, (3, poses)) + [[0.15], [0], [0]]
    q = inverse(p)
    assert np.abs(forward(q) - p).max() < 1e-14
    print("million poses/s, one core   abbe   NumPy whole   NumPy blocks   ratio   ratio")
    for name, function, array, own in (("forward", forward, q, ours["ForwardBatch"]),
                                       ("inverse", inverse, p, ours["InverseBatch"])):
        whole, blocks = rate(function, array, poses), rate(function, array, BLOCK)
        print(f"{name:24}{own:8.1f}{whole:14.1f}{blocks:15.1f}{own / whole:8.1f}{own / blocks:8.1f}")


if __name__ == "__main__":
    main()
