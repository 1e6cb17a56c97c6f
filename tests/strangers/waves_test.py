#!/usr/bin/env python3
"""Tables of a laser on axes of strangers, with waves of a screw between the targets and without: is U95 true on a fine
stage, a long axis, a coarse router, where the machine file knows nothing of waves?

    ABBE=path/to/abbe ABBE_SEEDS=12 waves_test.py
"""
import dataclasses
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

PROGRAM = os.environ["ABBE"]
SEEDS = int(os.environ.get("ABBE_SEEDS", 2))
FILE = """name = "axis"
chain = "[w X b t]"
reference_mm = [0.0, 0.0, 0.0]
[axis.X]
travel_mm = [0, {travel}]
positive = "tool"
[population]
positioning_um = {stated}
straightness_um = 3.0
roll_urad = 20.0
pitch_urad = 20.0
yaw_urad = 20.0
squareness_urad = 50.0
scale_ppm = 20.0
smoothness_mm = {smoothness}
"""


@dataclasses.dataclass
class Axis:
    """Lengths in mm, errors in um."""
    says: str
    travel: float
    stated: float  # of the positioning, in the machine file
    smoothness: float  # the same
    targets: int
    off: float  # from even steps, at most
    error: float  # as it is
    length: float  # over which it changes
    wave: float  # amplitude
    pitch: float
    noise: float

    def smooth(self, draw):
        """A sum of 60 sines: near enough to a Gaussian process of this correlation length."""
        k, phase = draw.normal(size=60) / self.length, draw.uniform(0, 2 * np.pi, 60)
        return lambda x: self.error * np.sqrt(2 / 60) * np.sin(np.outer(x, k) + phase).sum(axis=1)


AXES = (
    Axis("a long axis, screw of 10 mm", 500, 5, 80, 80, 1.5, 5, 80, 3, 10, 0.3),
    Axis("a long axis, no wave", 500, 5, 80, 80, 1.5, 5, 80, 0, 10, 0.3),
    Axis("a stage of 50 nm, no wave", 100, 0.05, 20, 40, 1, 0.05, 20, 0, 5, 0.005),
    Axis("a stage of 50 nm, stated as 5 um", 100, 5, 20, 40, 1, 0.05, 20, 0, 5, 0.005),
    Axis("a router, waves of 40 um", 1000, 30, 150, 90, 4, 30, 150, 40, 20, 2),
    Axis("25 even targets, screw of 4.7 mm", 60, 2, 15, 25, 0, 2, 15, 2, 4.7, 0.1),
    Axis("25 even targets, no wave", 60, 2, 15, 25, 0, 2, 15, 0, 4.7, 0.1))


class WavesOfStrangers(unittest.TestCase):
    def fused(self, axis, seed, folder):
        """(inside U95, error, u, named) of the map, between the targets too."""
        draw = np.random.default_rng(seed)
        smooth, phase = axis.smooth(draw), draw.uniform(0, 2 * np.pi)
        truth = lambda x: smooth(x) + axis.wave * np.sin(2 * np.pi * x / axis.pitch + phase)
        (folder / "axis.toml").write_text(
            FILE.format(travel=axis.travel, stated=axis.stated, smoothness=axis.smoothness))
        x = np.linspace(0.01, 0.99, axis.targets) * axis.travel + draw.uniform(-axis.off, axis.off, axis.targets)
        x = np.clip(np.concatenate([x, x[::-1]]), 0, axis.travel)
        read = x + 1e-3 * (truth(x) + axis.noise * draw.normal(size=len(x)))
        table = "".join(f"{5 * i},{a:.7f},{b:.7f}\n" for i, (a, b) in enumerate(zip(x, read)))
        (folder / "laser.csv").write_text(f'# abbe-recording = 1\n# u_reference_um = {axis.noise}\n# kind = "reference"\n'
                                          "time_s,x_mm,ref_x_mm\n" + table)
        run = subprocess.run([PROGRAM, "fuse", folder / "laser.csv", "--machine", folder / "axis.toml", "-o",
                              folder / "map.toml", "--json", folder / "fuse.json", "--force", "--quiet"],
                             capture_output=True, text=True, check=False)
        self.assertEqual(run.returncode, 0, run.stderr)
        result = json.loads((folder / "fuse.json").read_text())
        found = result["map"]["errors"]["EXX"]
        q, value, u = 1e3 * np.array(found["positions"]), 1e6 * np.array(found["value"]), 1e6 * np.array(found["u"])
        off = value - truth(q) + truth(q[[np.argmin(u)]])
        stated = u > 1e-3 * u.max()
        return np.mean(np.abs(off) <= 1.96 * u, where=stated), off[stated], u[stated], bool(result["scatter"])

    def test_u95_holds_on_axes_that_no_file_knows(self):
        print(f"\n{'axis':36}inside U95    rms      u, um  named")
        with tempfile.TemporaryDirectory() as folder:
            for axis in AXES:
                inside, off, u, named = zip(*(self.fused(axis, seed, pathlib.Path(folder)) for seed in range(SEEDS)))
                rms = [np.sqrt(np.mean(np.square(np.concatenate(each)))) for each in (off, u)]
                print(f"{axis.says:36}{np.mean(inside):10.3f}{rms[0]:8.3f}{rms[1]:8.3f}{sum(named):7}")
                with self.subTest(axis.says):
                    self.assertGreater(np.mean(inside), 0.85)
                    self.assertLess(rms[1], 3 * max(rms[0], axis.noise))  # nor says too little
                    self.assertTrue(axis.wave > 0 or not any(named))


if __name__ == "__main__":
    unittest.main()
