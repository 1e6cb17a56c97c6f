#!/usr/bin/python3
"""Simulation I of the five-probe head: abbe against NumPy, in one run, on one core.

Usage: simulation_i_numpy.py BUILD/bench/simulation_i [DRAWS]

NumPy does the same work twice: on whole arrays, as one would first write it, and in blocks that stay in
the cache. Each figure is the least of three repetitions, in processor time, so that other work on the
machine disturbs it little. Targets: 10 times whole arrays, 4 times blocks, at 10^7 draws.
"""
import json
import subprocess
import sys
import time

import numpy as np

ARM, HEIGHT, TRAVEL, STATIONS = 10e-3, 20e-3, 60e-3, 61
BLOCK = 61 * 128  # draws; the best of 488 ... 31232


def top(a, b, c, y, z, u, s, d):
    lever = d - u
    c2 = 1 + c * c
    return (a * (s - y + lever * c) + b * (lever + (y - s) * c) + z * c2) / c2


def side(a, b, c, y, z, u, n, d):
    lever = d - u
    b2 = 1 + b * b
    return (a * (z - n + lever * b) + y * b2 - (lever + (n - z) * b) * c) / b2


def errors(random, d):
    """Estimated minus true of the five components for one draw at each place d."""
    a, b, c = random.uniform(-1e-3, 1e-3, (3, d.size))
    y, z = random.uniform(-50e-6, 50e-6, (2, d.size))
    e = (a, b, c, y, z)
    pa, pb, pc = top(*e, ARM, 0, d), top(*e, 0, ARM, d), top(*e, 0, -ARM, d)
    pd, pe = side(*e, 0, HEIGHT, d), side(*e, ARM, HEIGHT, d)
    eax = (pb - pc) / (2 * ARM)
    ebx = ((pb + pc) / 2 - pa) / ARM
    ecx = (pe - pd) / ARM
    eyx = pd + HEIGHT * eax + d * ecx
    ezx = (pb + pc) / 2 - d * ebx
    return eax - a, ebx - b, ecx - c, eyx - y, ezx - z


def simulate(draws, block):
    """Worst, mean and standard deviation of each component."""
    random = np.random.default_rng(1)
    worst, total, squares = np.zeros(5), np.zeros(5), np.zeros(5)
    for first in range(0, draws, block):
        count = min(block, draws - first)
        d = TRAVEL / (STATIONS - 1) * ((first + np.arange(count)) % STATIONS)
        for k, error in enumerate(errors(random, d)):
            worst[k] = max(worst[k], np.abs(error).max())
            total[k] += error.sum()
            squares[k] += error @ error
    mean = total / draws
    return worst, mean, np.sqrt(squares / draws - mean**2)


def numpy_ns(draws, block):
    best = np.inf
    for _ in range(3):
        begin = time.process_time()
        worst, _, std = simulate(draws, block)
        best = min(best, time.process_time() - begin)
    return best / draws * 1e9, worst, std


def abbe_ns(program):
    command = [program, "--benchmark_filter=simplified", "--benchmark_repetitions=3",
               "--benchmark_format=json"]
    runs = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)["benchmarks"]
    per_draw = [run["cpu_time"] / 10_000_000 * 1e6 for run in runs if run["run_type"] == "iteration"]
    return min(per_draw)


def main():
    draws = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000_000
    ours = abbe_ns(sys.argv[1])
    print(f"Simulation I, {draws} draws, one core, NumPy {np.__version__}")
    print(f"{'':<20}{'ns/draw':>9}{'ratio':>8}{'worst EYX um':>14}{'std EYX um':>12}")
    print(f"{'abbe':<20}{ours:>9.1f}{1:>8.2f}")
    for name, block in (("NumPy whole arrays", draws), ("NumPy in blocks", BLOCK)):
        ns, worst, std = numpy_ns(draws, block)
        print(f"{name:<20}{ns:>9.1f}{ns / ours:>8.2f}{worst[3] * 1e6:>14.4f}{std[3] * 1e6:>12.4f}")


if __name__ == "__main__":
    main()
