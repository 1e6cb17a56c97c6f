#!/usr/bin/python3
"""Array calls of 10^5 rows from Python against the same in C++, in turns, on one core: at most 5 % over.

    PYTHONPATH=build/dev/python array_calls.py build/dev/bench/array_calls build/dev/apps/abbe
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import time

import numpy as np

import abbe

ROWS, TURNS, CALLS = 100_000, 8, 25
MACHINE = pathlib.Path(__file__).resolve().parents[1] / "machines/demo_mill.toml"


def numbers(columns):
    return np.fmod(0.618033988749895 * (np.arange(ROWS * columns) + 1.0), 1.0).reshape(ROWS, columns)


def mean_time(call):
    """Of so many calls, as the program takes it too."""
    call()
    begin = time.process_time()
    for _ in range(CALLS):
        call()
    return (time.process_time() - begin) / CALLS


def main(program, abbe_program):
    with tempfile.TemporaryDirectory() as folder:
        sweep, file = pathlib.Path(folder, "sweep.csv"), pathlib.Path(folder, "map.toml")
        subprocess.run([abbe_program, "rig", "record", "--machine", MACHINE, "--seed", "7", "--axis", "X", "--out", sweep],
                       check=True, capture_output=True)
        abbe.fuse([abbe.read_recording(sweep)], abbe.read_machine(MACHINE)).map.write(file)
        map_ = abbe.read_map(file)
        low, high = map_.travels_m.T
        positions, angles = low + (high - low) * numbers(3), numbers(3)
        readings, travel = 1e-6 * numbers(5), 0.06 * numbers(1)[:, 0]
        linkage = abbe.PivotLinkage(0.12, 0.12)
        calls = {"VolumetricError": lambda: map_.error(positions), "LinkageTips": lambda: linkage.tips(angles),
                 "HeadInversion": lambda: abbe.invert_head(readings, travel),
                 "HeadSmallAngles": lambda: abbe.invert_head(readings, travel, model="small-angle")}
        least = {name: [np.inf, np.inf] for name in calls}
        for _ in range(TURNS):
            done = subprocess.run([program, file, "--benchmark_format=json", "--benchmark_min_time=0.2"], check=True,
                                  capture_output=True, text=True)
            for each in json.loads(done.stdout)["benchmarks"]:
                least[each["name"]][0] = min(least[each["name"]][0], 1e-9 * each["cpu_time"])
            for name, call in calls.items():
                least[name][1] = min(least[name][1], mean_time(call))
    print(f"{'10^5 rows':<18}{'C++, ms':>10}{'Python, ms':>12}{'over':>9}")
    for name, (of_cpp, of_python) in least.items():
        print(f"{name:<18}{1e3 * of_cpp:>10.3f}{1e3 * of_python:>12.3f}{100 * (of_python / of_cpp - 1):>8.1f}%")
    return max(of_python / of_cpp for of_cpp, of_python in least.values()) <= 1.05


if __name__ == "__main__":
    sys.exit(0 if main(*sys.argv[1:3]) else 1)
