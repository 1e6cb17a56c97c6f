#!/usr/bin/python3
"""`abbe correct` of a program of a million short lines, from file to file, beside what the disk takes.

Usage: nc_program.py ABBE

The machine of the tests (18 polynomials); a spiral of lines of up to 0.13 mm. The peer only writes the corrected program
once more and brings it to the disk; so does the time of abbe.
"""
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "tests/apps"))
from map_machine import MapMachine  # noqa: E402

LINES = 1_000_000


def program():
    turn = np.linspace(0, 1600 * np.pi, LINES)
    radius = np.linspace(1, 25, LINES)
    places = np.stack([30 + radius * np.cos(turn), 30 + radius * np.sin(turn), 10 + 20 * turn / turn[-1]], -1)
    return "G21 G90 G17 F1000\nG0 X31 Y30 Z10\n" + "".join(f"G1 X{x:.4f} Y{y:.4f} Z{z:.4f}\n" for x, y, z in places)


def timed(work):
    """Wall and processor seconds of the quickest of three, the file brought to the disk included."""
    best = (np.inf, np.inf)
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        begin = time.perf_counter()
        work()
        wall = time.perf_counter() - begin
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        best = min(best, (wall, processor))
    return best


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        chart = MapMachine(1).write(folder / "map.toml")
        (folder / "part.ngc").write_text(program())
        out = folder / "out.ngc"

        def correct():
            subprocess.run([sys.argv[1], "correct", chart, folder / "part.ngc", "--out", out, "--quiet"], check=True)
            with out.open("rb") as file:
                os.fsync(file.fileno())

        wall, processor = timed(correct)
        content = out.read_bytes()

        def write():
            with (folder / "copy.ngc").open("wb") as file:
                file.write(content)
                os.fsync(file.fileno())

        disk, _ = timed(write)
        lines = content.count(b"\n") / 1e6
        print(f"abbe correct, {LINES} lines in, {lines:.2f} million out, {len(content) / 1e6:.0f} MB")
        print(f"{'':16}{'s':>8}{'processor s':>14}{'million lines/s':>18}")
        print(f"{'abbe correct':16}{wall:8.2f}{processor:14.2f}{LINES / 1e6 / wall:18.2f}")
        print(f"{'the disk alone':16}{disk:8.2f}{'':14}{lines / disk:18.2f}")


if __name__ == "__main__":
    main()
