#!/usr/bin/env python3
"""`abbe sensitivity` as a script sees it: the file, the table, the exit codes.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml sensitivity_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

ABBE = os.environ["ABBE"]
MACHINE = os.environ["ABBE_MACHINE"]
MODELS = {"pivots": 11, "published": 12, "published-with-bearing": 24, "complete": 64}  # parameters
BOUNDS = {"I": (1.01e-6, 0.0902e-6), "II": (1.5e-5, 0.6e-6)}  # rad, m; I to third order in the errors


def run(*arguments):
    return subprocess.run([ABBE, "sensitivity", *arguments], capture_output=True, text=True)


class SensitivityTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def result(self, *arguments):
        path = self.folder / "new" / "result.json"
        done = run(*arguments, "--json", path)
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(path.read_text()), done.stdout

    def test_keys_and_bounds(self):
        for simulation, (angle, translation) in BOUNDS.items():
            result, table = self.result("--simulation", simulation, "--draws", "20000")
            self.assertEqual(result["simulation"], simulation)
            self.assertEqual(result["draws"], 20000)
            self.assertEqual(list(result["components"]), ["EAX", "EBX", "ECX", "EYX", "EZX"])
            for name, component in result["components"].items():
                self.assertEqual(set(component), {"worst", "mean", "std"})
                self.assertLess(component["worst"], angle if name in ("EAX", "EBX", "ECX") else translation)
                self.assertGreater(component["worst"], component["std"])
                self.assertIn(name, table)
            self.assertLess(result["calibrated"]["EYX"]["worst"], 1e-18)

    def test_threads_do_not_matter(self):
        arguments = ["--simulation", "II", "--draws", "150000", "--seed", "3"]
        one, _ = self.result(*arguments, "--threads", "1")
        three, _ = self.result(*arguments, "--threads", "3")
        self.assertEqual(one, three)

    def test_linkage(self):
        arguments = ["--linkage", MACHINE, "--draws", "64", "--points", "2", "--seed", "5"]
        for model, count in MODELS.items():
            result, table = self.result(*arguments, "--model", model)
            self.assertEqual(len(result["parameters"]), count)
            self.assertEqual(result["poses"], 9)
            for parameter in result["parameters"]:
                self.assertIn(parameter["name"], table)
                self.assertGreaterEqual(parameter["worst"], 0.999999 * parameter["alone"])
            # Together is the root of the sum of squares, but for the scatter of 64 draws.
            squares = sum(parameter["alone"] ** 2 for parameter in result["parameters"])
            self.assertLess(abs(result["together"] / squares ** 0.5 - 1), 5 * (2 / 64) ** 0.5)
            # An uncalibrated linkage is off by a few 100 um.
            self.assertTrue(50e-6 < result["together"] < 1e-3)

    def test_linkage_as_displacement_and_warm(self):
        arguments = ["--linkage", MACHINE, "--draws", "16", "--points", "2", "--model", "complete"]
        position, _ = self.result(*arguments)
        displacement, _ = self.result(*arguments, "--displacement", "--warmth", "10", "--volume", "10", "10", "10")
        self.assertLess(displacement["together"], position["together"] / 2)
        grown = {p["name"]: p["alone"] for p in displacement["parameters"]}
        self.assertGreater(grown["expansion.after_pivot_2"], 0)
        self.assertEqual({p["name"]: p["alone"] for p in position["parameters"]}["expansion.after_pivot_2"], 0)

    def test_linkage_threads_do_not_matter(self):
        arguments = ["--linkage", MACHINE, "--draws", "200", "--model", "published", "--points", "2"]
        one, _ = self.result(*arguments, "--threads", "1")
        two, _ = self.result(*arguments, "--threads", "2")
        self.assertEqual(one, two)

    def test_linkage_out_of_reach(self):
        done = run("--linkage", MACHINE, "--volume", "900", "25", "50")
        self.assertEqual(done.returncode, 4)
        self.assertIn("out of reach", done.stderr)

    def test_bad_input(self):
        for arguments in (["--simulation", "III"], [], ["--simulation", "I", "--draws", "0"],
                          ["--simulation", "I", "--threads", "-2"], ["--simulation", "I", "--draws", "many"],
                          ["--simulation", "I", "--linkage", MACHINE], ["--simulation", "I", "--points", "3"],
                          ["--linkage", "no_such.toml"], ["--linkage", MACHINE, "--points", "1"],
                          ["--linkage", MACHINE, "--model", "best"], ["--linkage", MACHINE, "--volume", "1", "2"]):
            done = run(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertTrue(done.stderr)


if __name__ == "__main__":
    unittest.main()
