#!/usr/bin/env python3
"""A laser beside trackers on a machine of strangers: a laser that is right is neither overruled nor turned.

    ABBE=path/to/abbe laser_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

PROGRAM = os.environ["ABBE"]
TRAVEL = np.array([500.0, 400.0, 300.0])  # mm
MACHINE = """name = "stranger"
chain = "[w b X Y Z t]"
reference_mm = [0.0, 0.0, 0.0]
axis.X.travel_mm = [0, 500]
axis.Y.travel_mm = [0, 400]
axis.Z.travel_mm = [0, 300]
[population]
positioning_um = 5
straightness_um = 3
roll_urad = 15
pitch_urad = 15
yaw_urad = 15
squareness_urad = 30
scale_ppm = 30
smoothness_mm = 120
"""


class LaserOfStrangers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        (self.folder / "machine.toml").write_text(MACHINE)

    def table(self, name, draw, places, noise, scale, shown="xyz", header=""):
        """Readings, mm, of a machine whose EXX alone is not zero, by an instrument that is too long by `scale`."""
        true = places.copy()
        true[:, 0] += 1e-3 * self.exx(places[:, 0])
        read = (1 - scale) * true + 1e-3 * noise * draw.normal(size=true.shape)
        columns = np.column_stack([np.arange(len(places)), places, read[:, ["xyz".index(a) for a in shown]]])
        names = f'# abbe-recording = 1\n# kind = "reference"\n# u_reference_um = {noise}\n{header}time_s,x_mm,y_mm,z_mm,' + (
            ",".join(f"ref_{a}_mm" for a in shown))
        np.savetxt(self.folder / name, columns, "%.7f", ",", header=names, comments="")
        return self.folder / name

    def exx(self, x):
        return self.slope * x + 4.0 * np.sin(x / 80 + self.phase) - 4.0 * np.sin(self.phase)

    def fused(self, seed, tracker_scale, header=""):
        draw = np.random.default_rng(seed)
        self.slope, self.phase = 1e-2 * draw.normal(), draw.uniform(0, 6)  # um/mm
        line = np.zeros((41, 3))
        line[:, 0] = np.linspace(0, 500, 41)
        files = [self.table("laser.csv", draw, line, 0.3, 0.0, "x")]
        for number in (1, 2):
            places = draw.uniform(0, 1, (150, 3)) * TRAVEL
            files.append(self.table(f"tracker_{number}.csv", draw, places, 1.5, tracker_scale, header=header))
        done = subprocess.run([PROGRAM, "fuse", *files, "--machine", self.folder / "machine.toml", "--json",
                               self.folder / "fuse.json", "-o", self.folder / "map.toml", "--force", "--quiet"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "fuse.json").read_text())
        found = result["map"]["errors"]["EXX"]
        x, u = 1e3 * np.array(found["positions"]), 1e6 * np.array(found["u"])
        off = 1e6 * np.array(found["value"]) - self.exx(x)
        return off, u, result

    def test_a_laser_that_trackers_contradict_is_not_overruled(self):
        for seed in range(4):
            for scale in (2e-5, -2e-5):
                off, u, result = self.fused(seed, scale)
                says = bool(result["contradictions"] + result["misfits"] + result["scatter"] + result["drifts"])
                print(f"seed {seed}, {1e6 * scale:+.0f} ppm: off {np.abs(off).max():.2f} um, U95 {2 * u.max():.2f}, told: {says}")
                self.assertGreater(np.mean(np.abs(off) <= 2 * u + 0.05), 0.85)
                self.assertTrue(says or np.abs(off).max() < 1.0)

    def test_a_tracker_whose_scale_is_stated_as_unsure_leaves_it_to_the_laser(self):
        for seed in range(4):
            off, u, result = self.fused(seed, 2e-5, "# u_scale_ppm = 20\n")
            self.assertGreater(np.mean(np.abs(off) <= 2 * u + 0.05), 0.85)
            self.assertLess(np.abs(off).max(), 1.0)
            self.assertEqual(result["contradictions"] + result["misfits"], [])


if __name__ == "__main__":
    unittest.main()
