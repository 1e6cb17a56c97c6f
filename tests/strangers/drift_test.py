#!/usr/bin/env python3
"""References that drift, warm up or have waves of their own, on machines of strangers: is U95 of the map true, and is a
drift named where there is one, and there alone?

    ABBE=path/to/abbe ABBE_SEEDS=12 drift_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

import judge
from machine import TRAVEL
from world import World, walk

PROGRAM = os.environ["ABBE"]
SEEDS = int(os.environ.get("ABBE_SEEDS", 1))
MACHINE = pathlib.Path(__file__).resolve().parents[2] / "machines" / "demo_mill.toml"
NOISE = 0.5e-6  # m


def snake(draw):
    """343 places of a grid, row by row and back, each a little off."""
    grid = [(x if (y + z) % 2 == 0 else 6 - x, y if z % 2 == 0 else 6 - y, z)
            for z in range(7) for y in range(7) for x in range(7)]
    return np.clip((np.array(grid) / 6 + draw.uniform(-0.015, 0.015, (343, 3))) * TRAVEL, 0, TRAVEL)


def anywhere(draw):
    return draw.uniform(0, TRAVEL, (300, 3))


def nothing(draw, t, q):
    return 0.0


def ramp(draw, t, q):
    return 4e-6 * np.outer(t / t[-1], draw.normal(size=3))


def warming(draw, t, q):
    return 5e-6 * np.outer(1 - np.exp(-t / (0.2 * t[-1])), draw.normal(size=3))


def wandering(draw, t, q):
    return np.stack([walk(draw, t, 2e-6, 0.3 * t[-1]) for _ in range(3)], axis=1)


def wave(draw, t, q):
    """An encoder of a tracker 1 m away: 1.5 um across its line of sight, five periods over the travel."""
    angle = q @ np.array([0.8, 0.6, 0.0]) / TRAVEL
    return np.outer(1.5e-6 * np.sin(2 * np.pi * (5 * angle + draw.uniform())), [0.8, 0.6, 0.0])


class ReferencesThatDrift(unittest.TestCase):
    def fused(self, order, drift, seed, folder):
        world, draw = World(seed, MACHINE), np.random.default_rng(seed)
        q = order(draw)
        t = 5.0 * np.arange(len(q))
        read = world.tip(q) * [-1, -1, 1] + NOISE * draw.normal(size=q.shape) + drift(draw, t, q)
        np.savetxt(folder / "tracker.csv", np.column_stack([t, 1e3 * q, 1e3 * read]), "%.7f", ",", comments="", header=(
            f'# abbe-recording = 1\n# kind = "reference"\n# u_reference_um = {1e6 * NOISE}\n'
            "time_s,x_mm,y_mm,z_mm,ref_x_mm,ref_y_mm,ref_z_mm"))
        done = subprocess.run([PROGRAM, "fuse", folder / "tracker.csv", "--machine", MACHINE, "-o", folder / "map.toml",
                               "--json", folder / "fuse.json", "--force", "--quiet"],
                              capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((folder / "fuse.json").read_text())
        return judge.volume_error(result, world), bool(result["drifts"])

    def test_u95_of_the_map_holds(self):
        print(f"\n{'order':10}{'drift':12}inside U95  rms, um  u, um")
        with tempfile.TemporaryDirectory() as folder:
            for order in (snake, anywhere):
                for drift in (nothing, ramp, warming, wandering, wave):
                    found = [self.fused(order, drift, 500 + seed, pathlib.Path(folder)) for seed in range(SEEDS)]
                    inside = np.mean([f["inside"] for f, _ in found])
                    rms, u = (1e6 * np.sqrt(np.mean([f[key] ** 2 for f, _ in found])) for key in ("rms", "u"))
                    told = sum(says for _, says in found)
                    print(f"{order.__name__:10}{drift.__name__:12}{inside:10.3f}{rms:9.3f}{u:7.3f}  told {told}")
                    with self.subTest(f"{order.__name__} {drift.__name__}"):
                        self.assertGreater(inside, 0.85)
                        self.assertTrue(told == (0 if drift is nothing else SEEDS) or drift is wave)


if __name__ == "__main__":
    unittest.main()
