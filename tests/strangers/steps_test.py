#!/usr/bin/env python3
"""Sweeps of strangers whose probes read in steps, up to twenty times their noise: is U95 of the errors true?

    ABBE=path/to/abbe ABBE_SEEDS=6 steps_test.py
"""
import os
import pathlib
import tempfile
import unittest

import numpy as np

import judge
import run
from world import World

PROGRAM = os.environ["ABBE"]
SEEDS = int(os.environ.get("ABBE_SEEDS", 2))


class Coarse(World):
    def readings(self, r):
        gaps, angles = super().readings(r)
        return np.round(gaps / self.step) * self.step if gaps is not None else gaps, angles


class StepsOfStrangers(unittest.TestCase):
    def test_u95_contains_what_steps_hide(self):
        for times in (2, 5, 10, 20):
            inside, notes = [], 0
            for seed in range(700, 700 + SEEDS):
                world = Coarse(seed, run.MACHINE)
                world.step = times * world.settings["noise"]["probe_nm"] * 1e-9
                with tempfile.TemporaryDirectory() as folder:
                    for one in (r for r in world.runs if r.kind == "sweep"):
                        path = world.write(one, pathlib.Path(folder))
                        result, message, _, _ = run.abbe(PROGRAM, "reduce", path, "--machine", run.MACHINE)
                        self.assertIsNotNone(result, message)
                        inside.append(judge.coverage(sum(judge.sweep_pulls(result, world.machine, one.axis).values(), [])))
                        notes += "reads in steps" in " ".join(result["notes"])
            print(f"steps of {times:2} times the noise: {np.mean(inside):.3f} inside U95, told in {notes} of {len(inside)}")
            self.assertGreater(np.mean(inside), 0.9)
            self.assertEqual(notes, 0 if times == 2 else len(inside))


if __name__ == "__main__":
    unittest.main()
