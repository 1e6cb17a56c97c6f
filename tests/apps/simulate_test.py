#!/usr/bin/env python3
"""`abbe simulate` as a script sees it: figures as a table and as data, held against NumPy.

    ABBE=path/to/abbe simulate_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

from map_machine import MapMachine

ABBE = os.environ["ABBE"]


class SimulateTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.machine = MapMachine(4)
        self.map = self.machine.write(self.folder / "map.toml")

    def simulate(self, *options):
        return subprocess.run([ABBE, "simulate", self.map, *options], capture_output=True, text=True)

    def test_lengths_are_those_of_the_machine(self):
        out = self.folder / "length.json"
        done = self.simulate("--test", "length", "--corrected", "--draws", "40", "--json", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("corrected (95 %)", done.stdout)
        result = json.loads(out.read_text())
        self.assertEqual([result[key] for key in ("command", "machine", "map", "test")],
                         ["simulate", "numpy-mill", "map.toml", "length"])
        ends = np.array([(0.0006, 0.03, 0.03), (0.0594, 0.03, 0.03)])
        made = np.array([self.machine.made(end) for end in ends])
        expected = 1e6 * (np.linalg.norm(made[1] - made[0]) - np.linalg.norm(ends[1] - ends[0]))
        self.assertAlmostEqual(result["as_is"]["length X um"], expected, 6)
        self.assertEqual(result["as_is"].keys(), result["corrected_95"].keys())
        self.assertLess(max(result["corrected_95"].values()), max(map(abs, result["as_is"].values())))

    def test_a_path_of_ones_own(self):
        path = self.folder / "path.csv"
        points = np.array([(10, 20, 30), (40, 50, 5.5)])
        path.write_text("# two\nname,x_mm,y_mm,z_mm\n" + "".join(f"p,{x},{y},{z}\n" for x, y, z in points))
        out = self.folder / "path.json"
        done = self.simulate("--test", "freeform", "--path", path, "--json", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        errors = [1e6 * np.linalg.norm(self.machine.error(1e-3 * p)) for p in points]
        self.assertAlmostEqual(json.loads(out.read_text())["as_is"]["largest um"], max(errors), 6)

    def test_refusals_take_one_line(self):
        path = self.folder / "path.csv"
        path.write_text("x_mm,y_mm\n1,2\n")
        for words, *options in (("is not a test", "--test", "cone"), ("--path", "--test", "freeform"),
                                ("no column z_mm", "--test", "freeform", "--path", path),
                                ("does not fit", "--test", "circle", "--radius-mm", "31")):
            done = self.simulate(*options)
            self.assertEqual(done.returncode, 2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)


if __name__ == "__main__":
    unittest.main()
