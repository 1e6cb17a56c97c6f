#!/usr/bin/env python3
"""`abbe sensitivity` as a script sees it: the file, the table, the exit codes.

    ABBE=path/to/abbe sensitivity_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

ABBE = os.environ["ABBE"]
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

    def test_bad_input(self):
        for arguments in (["--simulation", "III"], [], ["--simulation", "I", "--draws", "0"],
                          ["--simulation", "I", "--threads", "-2"], ["--simulation", "I", "--draws", "many"]):
            done = run(*arguments)
            self.assertEqual(done.returncode, 2, arguments)
            self.assertTrue(done.stderr)


if __name__ == "__main__":
    unittest.main()
