#!/usr/bin/env python3
"""The examples of python/gallery run on data of the virtual rig and say what that rig holds.

    PYTHONPATH=build/dev/python ABBE=path/to/abbe gallery_test.py
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

GALLERY = pathlib.Path(__file__).resolve().parents[2] / "python" / "gallery"


class GalleryTest(unittest.TestCase):
    def printed(self, name):
        """What an example prints; it must draw a picture of its name."""
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        done = subprocess.run([sys.executable, GALLERY / f"{name}.py", folder], capture_output=True, text=True,
                              timeout=150)
        self.assertEqual(done.returncode, 0, done.stderr)
        picture = (folder / f"{name}.png").read_bytes()
        self.assertTrue(picture.startswith(b"\x89PNG"))
        self.assertGreater(len(picture), 10_000)
        return done.stdout

    def test_every_example_is_tested(self):
        examples = {file.stem for file in GALLERY.glob("*.py")} - {"rig"}
        self.assertEqual(examples, {name[len("test_"):] for name in dir(self) if name.startswith("test_")}
                         - {"every_example_is_tested"})

    def test_sweep(self):
        errors = re.findall(r"^(E\w\w)  largest ([\d.]+), U95 ([\d.]+)$", self.printed("sweep"), re.M)
        self.assertEqual([name for name, _, _ in errors], ["EAX", "EBX", "ECX", "EYX", "EZX"])

    def test_linkage(self):
        text = self.printed("linkage")
        before, after, held_out = map(float, re.search(r"poses: ([\d.]+) .* ([\d.]+) um calibrated, ([\d.]+)",
                                                       text).groups())
        # The tolerances of the machine file are tenths of a millimetre; its noise is below a micrometre.
        self.assertGreater(before, 20)
        self.assertLess(max(after, held_out), 3)
        by = dict(re.findall(r"circle by the (\w+): G\(b\) ([\d.]+) um", text))
        self.assertLess(abs(float(by["linkage"]) - float(by["reference"])), 3)

    def test_map(self):
        text = self.printed("map")
        figures = re.findall(r"circle .*: (-?[\d.]+) um as it is, below ([\d.]+) um corrected", text)
        self.assertTrue(figures)
        # The deviation of the circle; a correction by the map leaves less of it.
        as_is, corrected = max((abs(float(a)), float(b)) for a, b in figures)
        self.assertLess(corrected, as_is)

    def test_arm(self):
        """150 poses determine a geometry of 30 numbers: the test is left with a fifth more than the tracker's noise."""
        sizes = re.findall(r"^(\d+) poses: the test is off by ([\d.]+) mm, calibrated ([\d.]+) mm$", self.printed("arm"),
                           re.M)
        self.assertEqual(sizes[-1][0], "150")
        before, after = float(sizes[-1][1]), float(sizes[-1][2])
        self.assertGreater(before, 0.3)
        self.assertLess(after, 1.2 * 0.020 * 3 ** 0.5)

    def test_diagnosis(self):
        text = self.printed("diagnosis")
        width, u95 = map(float, re.search(r"Finding backlash:X.*\n  width_um = ([\d.]+) \+- ([\d.]+)", text).groups())
        # 8 um are hidden; U95 is exceeded by one in twenty, twice of it by one in ten thousand.
        self.assertLess(abs(width - 8.0), 2 * u95)

    def test_learned(self):
        verdict, *terms = self.printed("learned").splitlines()
        self.assertEqual(verdict, "learned")
        (term,) = terms
        self.assertIn("feed", term)  # hidden is a displacement by the square of the feed


if __name__ == "__main__":
    unittest.main()
