#!/usr/bin/env python3
"""A term that was learned on one machine of the rig, named, is found by its name on another one.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml carried_test.py
"""
import json
import tomllib
import unittest

from program_case import MACHINE, ProgramCase

FEED = 600  # mm/min, at which the rig states the height
NAME, WORDS = "cover-drag", "the cover drags the axis along"


class CarriedTest(ProgramCase):
    command = "diagnose"

    def campaign(self, name, seed, height, axis="X"):
        folder = self.path / name
        self.done("--machine", MACHINE, "--seed", seed, "--campaign", "standard", "--reduced", "--out", folder,
                  "--hide", f"unknown-feed-square:object={axis}:height_um={height}", command="rig record")
        return sorted(folder.glob("*.h5"))

    def test_a_term_is_found_by_name_on_another_machine(self):
        model, plain = self.path / "one.causes.toml", self.path / "plain.toml"
        self.done(*self.campaign("one", 5, 8), "--machine", MACHINE, "--learn", "-o", model)
        before = tomllib.loads(model.read_text())["learned"][0]
        self.done(model, "feed^2", "--name", NAME, "--words", WORDS, command="learned name")
        after = tomllib.loads(model.read_text())["learned"][0]
        self.assertEqual(after, {**before, "name": NAME, "words": WORDS})
        self.done(model, 1, "--name", "drag", command="learned name")  # again; the words stay
        self.assertEqual(tomllib.loads(model.read_text())["learned"][0], {**after, "name": "drag"})
        self.done(model, "drag", "--name", NAME, command="learned name")

        other = self.campaign("two", 11, 5)
        found, told = self.path / "two.causes.toml", self.path / "two.json"
        text = self.done(*other, "--machine", MACHINE, "--learned", model, "-o", found, "--json", told)
        result = json.loads(told.read_text())
        self.assertEqual(result["verdict"], "explained", text)
        self.assertIn(WORDS, text)
        # The ball of the rig's machine trails in its cap, which is a cause of its own.
        finding = next(each for each in result["findings"] if each["cause"] == NAME)
        (size,) = finding["parameters"]
        self.assertGreaterEqual(finding["probability"], 0.99)
        self.assertLess(abs(size["value"] * FEED**2 - 5.0), size["u95"] * FEED**2 + 0.05)
        written = tomllib.loads(found.read_text())["learned"][0]
        self.assertEqual((written["name"], written["words"]), (NAME, WORDS))
        circles = [run for run in other if "circle_XY" in run.name]
        fused = self.done(*circles, *[run for run in other if "sweep" in run.name], "--machine", MACHINE,
                          "--causes", found, "-o", self.path / "map.h5", command="fuse")
        self.assertIn(f"{NAME}:", fused)  # the file is one that other commands take

        # Refused, each with one line.
        plain.write_text(f'extended_model = 1\nmachine = "demo-mill"\n')
        self.refuse(*other, "--machine", MACHINE, "--learned", plain, saying=["plain.toml", "no learned term"])
        self.refuse(*other, "--machine", MACHINE, "--learned", MACHINE, saying=["demo_mill.toml", "no extended model"])
        bare = self.path / "bare.toml"
        bare.write_text(model.read_text().replace("by_chance = ", "by_chance = 0.5 # "))
        self.refuse(*other, "--machine", MACHINE, "--learned", bare, saying=["bare.toml", "certified"])
        self.command = "learned name"
        self.refuse(model, 7, "--name", "x", saying=['no learned term "7"', "1: feed^2"])
        self.refuse(model, 1, "--name", "backlash", saying=['"backlash" is a known cause'])


if __name__ == "__main__":
    unittest.main()
