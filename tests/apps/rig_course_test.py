#!/usr/bin/env python3
"""abbe rig record --course as a user runs it."""
import csv
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

ABBE, MACHINE = os.environ["ABBE"], os.environ["ABBE_MACHINE"]


class RigCourse(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)
        self.out = self.path / "out.csv"

    def record(self, *arguments, machine=MACHINE):
        return subprocess.run([ABBE, "rig", "record", "--machine", str(machine), "--out", str(self.out), "--force",
                               *map(str, arguments)], capture_output=True, text=True, timeout=60)

    def rows(self, *arguments):
        done = self.record(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = [line for line in self.out.read_text().splitlines() if not line.startswith("#")]
        return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]

    def test_circle_runs_both_senses_in_the_plane(self):
        rows = self.rows("--course", "circle", "--plane", "ZX", "--size", 20, "--centre", "30,20,30", "--reference")
        self.assertEqual({row["direction"] for row in rows}, {1.0, -1.0})
        for row in rows:
            self.assertAlmostEqual(row["y_mm"], 20.0, places=9)
            # the lag makes it smaller: 10 mm of radius at 10 mm/s, 15 ms
            self.assertAlmostEqual(math.hypot(row["z_mm"] - 30, row["x_mm"] - 30), 10 / math.hypot(1, 0.015), places=5)
            # the machine's own errors: some um in 60 mm
            self.assertLess(abs(row["ref_x_mm"] - row["x_mm"]), 0.05)
        self.assertGreater(max(abs(row["ref_x_mm"] - row["x_mm"]) for row in rows), 1e-4)

    def test_cube_stands_at_each_place(self):
        rows = self.rows("--course", "cube", "--size", 10, "--points", "2,3,2", "--dwell", 0.1)
        places = {tuple(round(row[name], 3) for name in ("x_mm", "y_mm", "z_mm")) for row in rows}
        self.assertEqual(len(places), 12)
        self.assertEqual({place[1] for place in places}, {25.0, 30.0, 35.0})

    def test_stepping_and_square(self):
        stops = {round(row["x_mm"], 3) for row in self.rows("--course", "stepping", "--dwell", 0.1)}
        self.assertEqual(stops, {17.5, 22.5, 27.5, 32.5, 37.5, 42.5})
        square = self.rows("--course", "square", "--kind", "reference", "--size", 30)
        self.assertNotIn("pivot_1_rad", square[0])
        self.assertAlmostEqual(min(row["x_mm"] for row in square), 15.0, places=3)

    def test_a_path_from_a_file(self):
        path = self.path / "path.csv"
        path.write_text("x_mm,y_mm,z_mm\n10,10,10\n20,10,10\n20,30,10\n")
        rows = self.rows("--course", path)
        self.assertAlmostEqual(rows[-1]["y_mm"], 30.0, places=3)

    def test_the_same_seed_gives_the_same_data(self):
        first = self.rows("--course", "square", "--seed", 4)
        self.assertEqual(first, self.rows("--course", "square", "--seed", 4))
        self.assertNotEqual(first, self.rows("--course", "square", "--seed", 5))

    def test_the_truth_has_the_linkage(self):
        truth = self.path / "truth.json"
        self.rows("--course", "square", "--truth", truth)
        self.assertEqual(len(json.loads(truth.read_text())["linkage"]["pivot_3"]["encoder_rad"]), 3)

    def test_refuses_in_one_line(self):
        text = pathlib.Path(MACHINE).read_text()
        bare = self.path / "bare.toml"
        bare.write_text(text[:text.index("[linkage]")] + text[text.index("\n[devices]"):])
        far = self.path / "far.toml"
        far.write_text(text.replace("position_mm = [-180.0,", "position_mm = [-300.0,"))
        for says, arguments, machine in (
                ("no such file", ["--course", "kube"], MACHINE),
                ("nothing to record", [], MACHINE),
                ("nothing to record", ["--axis", "X", "--course", "cube"], MACHINE),
                ("beyond the travel of 0 to 60 mm", ["--course", "circle", "--size", 80], MACHINE),
                ("2 numbers, but the course cube has 3", ["--course", "cube", "--size", "1,2"], MACHINE),
                ("--points: 3 numbers, but the course stepping has 1",
                 ["--course", "stepping", "--points", "2,2,2"], MACHINE),
                ("rig.update_hz", ["--course", "circle", "--rate", 5000], MACHINE),
                ("has no linkage", ["--course", "circle"], bare),
                ("does not reach", ["--course", "circle"], far)):
            done = self.record(*arguments, machine=machine)
            self.assertEqual(done.returncode, 2, (says, done.stderr))
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertFalse(self.out.exists())


if __name__ == "__main__":
    unittest.main()
