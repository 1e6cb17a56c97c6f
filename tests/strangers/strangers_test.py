#!/usr/bin/env python3
"""A few fixed worlds of strangers: nothing certain is wrong in them, and clean worlds are called clean.

    ABBE=path/to/abbe strangers_test.py
"""
import os
import pathlib
import tempfile
import unittest

import numpy as np

import judge
import run
from effects import EFFECTS
from instruments import Head, Linkage, Target
from machine import turn
from usual import USUAL
from world import World

PROGRAM = os.environ["ABBE"]


class Nominal:
    """A random generator that draws what is nominal: zeros."""

    def normal(self, size=()):
        return np.zeros(size)

    def uniform(self, low, high, size=()):
        return np.zeros(size)


class TheWorldItself(unittest.TestCase):
    """Against the first-order equations of the sources, which it does not use."""

    def setUp(self):
        self.world = World(1, run.MACHINE)
        self.nothing = Nominal()

    def test_gaps_of_a_moving_target(self):
        head = Head(self.nothing, self.world.settings["head"])
        target = Target(self.nothing, self.world.settings["target"], 0.0)
        turned, moved = np.array([2e-5, -3e-5, 4e-5]), np.array([1e-6, 2e-6, -3e-6])
        d, origin = 0.06, head.origin["X"]
        # The errors are those of the target at the head's origin, not at the machine's.
        R = turn(turned)
        work = R, (origin + [d, 0, 0] + moved)[None] - R @ origin
        tool = np.eye(3)[None], np.zeros((1, 3))
        change = 1e-4 - head.gaps("X", work, tool, target)[0]
        (ea, eb, ec), (_, ey, ez) = turned, moved
        top = [ez + y * ea + (d - x) * eb for x, y in ((0.01, 0), (0, 0.01), (0, -0.01))]
        side = [ey - z * ea - (d - x) * ec for x, z in ((0, 0.02), (0.01, 0.02))]
        # Second order: a product of two angles times 60 mm, or an angle times a shift.
        np.testing.assert_allclose(change, top + side, atol=2e-10)

    def test_angles_of_a_perfect_linkage(self):
        linkage = Linkage(self.nothing, self.world.settings["linkage"])
        q, (L1, L2) = np.array([[0.1, -0.9, -2.9], [-0.2, -1.2, -3.0]]), (0.12, 0.12)
        t1, t2, t3 = q.T
        reach = L2 * np.cos(t3) * np.sin(t2) + np.cos(t2) * (L1 + L2 * np.sin(t3))
        tip = np.stack([np.cos(t1) * reach, np.sin(t1) * reach,
                        L2 * np.cos(t2) * np.cos(t3) - np.sin(t2) * (L1 + L2 * np.sin(t3))], axis=1)
        np.testing.assert_allclose(linkage.tip(q, np.zeros(2)), tip, atol=1e-15)
        bed = np.broadcast_to(np.eye(3), (2, 3, 3)), np.zeros((2, 3))
        held = bed[0], tip + linkage.base[1]
        np.testing.assert_allclose(linkage.angles(bed, held, np.full(2, 20.0)), q, atol=1e-11)


class DiagnosisOfStrangers(unittest.TestCase):
    def diagnosed(self, seed, effect, wide=False):
        with tempfile.TemporaryDirectory() as folder:
            world = World(seed, run.MACHINE, {**EFFECTS, **USUAL}.get(effect), wide)
            return run.diagnosed(PROGRAM, world, pathlib.Path(folder))

    def test_clean_worlds_stay_clean(self):
        for seed in (2, 3, 4):
            with self.subTest(seed=seed):
                self.assertEqual(self.diagnosed(seed, "clean")["verdict"], "clean")

    def test_gap_steps_and_a_second_mounting_stay_clean(self):
        self.assertEqual(self.diagnosed(5, "clean", wide=True)["verdict"], "clean")

    def test_a_column_of_the_user_and_a_motion_are_named(self):
        found = self.diagnosed(26, "heavy_workpiece")
        self.assertEqual(found["verdict"], "unexplained", found)
        told = [variable for variable, _ in found["unexplained"] + found["or"]]
        self.assertIn("column load_n", told, found)

    def test_what_is_usual_is_named_with_its_size(self):
        # Axes stand on either side of their play; the phase of the mains is another one in each recording.
        for seed, effect in ((31, "play"), (32, "mains"), (33, "late_axis")):
            with self.subTest(seed=seed, effect=effect):
                found = self.diagnosed(seed, effect)
                self.assertEqual(found["verdict"], "explained", found)
                self.assertTrue(found["right"], found)
                self.assertEqual(found["wrong"], [], found)

    def test_nothing_certain_is_wrong(self):
        for seed, effect in ((21, "bend_with_rate"), (22, "beyond_threshold"), (23, "unequal_probes"),
                             (24, "speed_squared"), (25, "encoder_noise_with_memory")):
            with self.subTest(seed=seed, effect=effect):
                found = self.diagnosed(seed, effect)
                self.assertNotEqual(found["verdict"], "refused", found)
                self.assertEqual(found["wrong"], [], found)


class MapsOfStrangers(unittest.TestCase):
    def fused(self, seed, effect):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            world = World(seed, run.MACHINE, EFFECTS.get(effect))
            files = [f for f in world.write_all(folder) if any(word in f.name for word in run.MAPPED)]
            result, message, code, _ = run.abbe(PROGRAM, "fuse", *files, "--machine", run.MACHINE,
                                                "-o", folder / "map.toml")
            self.assertEqual(code, 0, message)
            return result, world

    def test_a_yaw_that_reverses_is_stated_and_the_map_is_the_mean_of_both_directions(self):
        result, world = self.fused(91000, "angular_play")  # EBX jumps by 13.2 urad
        self.assertEqual(result["contradictions"] + result["misfits"], [])
        (found,) = result["reversals"]
        self.assertEqual((found["error"], found["unit"]), ("EBX", "urad"))
        self.assertLess(abs(found["value"] - 13.2), 0.05 + 3 * found["u"])
        volume = judge.volume_error(result, world)
        self.assertLess(volume["rms"], 2 * volume["u"])
        self.assertGreater(judge.coverage(sum(judge.map_pulls(result, world.machine).values(), [])), 0.9)

    def test_a_short_test_of_a_machine_that_reverses_is_taken(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            world = World(91000, run.MACHINE, EFFECTS["angular_play"])
            files = world.write_all(folder)
            machine, volume = folder / "mill.toml", folder / "map.toml"
            machine.write_text(run.MACHINE.read_text() + "\n[drift]\npositioning_um = 0.1\nyaw_urad = 0.5\n")
            fused, message, code, _ = run.abbe(
                PROGRAM, "fuse", *(f for f in files if any(word in f.name for word in run.MAPPED)),
                "--machine", machine, "-o", volume)
            self.assertEqual(code, 0, message)
            # The same sweep three days later: rows as noisy as stated, and hardly a surprise.
            sweep = next(f for f in files if "sweep_X" in f.name)
            later = folder / "later.csv"
            later.write_text(sweep.read_text().replace("2026-11-21T", "2026-11-24T"))
            tracked, message, code, _ = run.abbe(PROGRAM, "track", volume, later, "--machine", machine)
            self.assertEqual(code, 0, message)
            (test,) = tracked["tests"]
            self.assertLess(test["noise"], 1.3)
            self.assertGreater(test["agreement"]["p"], 1e-3)

    def test_nothing_reverses_where_nothing_does(self):
        self.assertEqual(self.fused(91000, "clean")[0]["reversals"], [])

    def test_a_contradiction_widens_every_uncertainty(self):
        result, world = self.fused(91044, "beyond_threshold")
        self.assertEqual(len(result["contradictions"]), 1)
        told = next(c["agreement"] for c in result["chi2"] if c["run"] == result["contradictions"][0])
        self.assertAlmostEqual(result["widened"] ** 2, told["statistic"] / told["directions"], places=6)
        volume = judge.volume_error(result, world)
        self.assertLess(volume["rms"], 2 * volume["u"])

    def test_a_sharp_bend_in_the_rotations_ends_with_a_map(self):
        result, _ = self.fused(91006, "beyond_threshold")  # its knots change until the last fit
        for error in result["map"]["errors"].values():
            self.assertTrue(np.all(np.isfinite(error["u"])) and np.all(np.asarray(error["u"]) >= 0))


if __name__ == "__main__":
    unittest.main()
