#!/usr/bin/env python3
"""A learned term from recordings to another command: found, written, read, refused where it is broken.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml learned_test.py
"""
import json
import tomllib
import unittest

from program_case import MACHINE, ProgramCase

FEED = 600  # mm/min, at which the rig states the height


class LearnedTest(ProgramCase):
    command = "diagnose"

    def test_a_term_from_recordings_to_another_command(self):
        campaign, model, result = self.path / "campaign", self.path / "mill.causes.toml", self.path / "d.json"
        self.done("--machine", MACHINE, "--seed", 5, "--campaign", "standard", "--reduced", "--out", campaign,
                  "--hide", "unknown-feed-square:object=X:height_um=8", command="rig record")
        runs = sorted(campaign.glob("*.h5"))
        text = self.done(*runs, "--machine", MACHINE, "--learn", "-o", model, "--json", result)
        told = json.loads(result.read_text())
        self.assertEqual(told["verdict"], "learned", text)
        self.assertEqual(told["unexplained"], [])
        self.assertTrue(told["left_before_learning"])
        (term,) = told["learned"]
        self.assertIn(f"LEARNED: {term['words']}", text)
        self.assertEqual((term["expression"], term["found"], term["unit"]), ("feed^2", True, "um"))
        self.assertIn(term["object"], ("X", "EXY", "EXZ"))
        self.assertLess(abs(term["coefficients"][0] * FEED**2 - 8.0), term["u95"][0] * FEED**2 + 0.05)
        self.assertLess(term["certificate"]["by_chance"], 1e-3)

        with model.open("rb") as file:
            written = tomllib.load(file)
        self.assertEqual(written["diagnosis"]["verdict"], "learned")
        self.assertEqual(written["learned"][0]["expression"], "feed^2")
        self.assertAlmostEqual(written["learned"][0]["coefficients_um"][0], term["coefficients"][0], delta=1e-12)

        moving = [run for run in runs if "sweep" in run.name or "circle" in run.name]
        out = self.path / "map.h5"
        fused = self.done(*moving, "--machine", MACHINE, "--causes", model, "-o", out, command="fuse")
        self.assertIn(f"feed^2:{term['object']}", fused)

        broken = self.path / "broken.toml"
        broken.write_text(model.read_text().replace('"feed^2"', '"feed^3"'))
        run = self.run_program(*moving, "--machine", MACHINE, "--causes", broken, "-o", out, "--force", command="fuse")
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("learned", run.stderr)
        self.assertIn("is no variable", run.stderr)


if __name__ == "__main__":
    unittest.main()
