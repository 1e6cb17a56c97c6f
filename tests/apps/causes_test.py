#!/usr/bin/env python3
"""Extended models as a script sees them: `abbe diagnose -o` writes one, `--causes` of the other commands takes it.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml causes_test.py
"""
import hashlib
import json
import tomllib
import unittest

import numpy as np

from program_case import MACHINE, ProgramCase

HEAD = 'extended_model = 1\nmachine = "demo-mill"\n'


class CausesTest(ProgramCase):
    command = "reduce"

    def model(self, text):
        path = self.path / "mill.causes.toml"
        path.write_text(HEAD + text)
        return path

    def json_of(self, command, *arguments):
        """The result and what was printed."""
        out = self.path / "result.json"
        text = self.done(*arguments, "--machine", MACHINE, "--json", out, command=command)
        return json.loads(out.read_text()), text

    def pair(self, name, hidden, *arguments):
        """The same recording with and without something hidden."""
        return (self.rig_record(f"hidden_{name}", *arguments, "--hide", hidden),
                self.rig_record(name, *arguments))

    def test_a_sweep_is_reduced_without_the_gain_of_a_probe(self):
        hidden, clean = self.pair("x.csv", "probe-gain:object=probe_b:delta=0.05", "--axis", "X",
                                  "--rate", 50)
        model = self.model('[[cause]]\nid = "probe-gain"\nobject = "probe_b"\ndelta = 0.05\n')
        wanted, _ = self.json_of("reduce", clean)
        wrong, _ = self.json_of("reduce", hidden)
        found, text = self.json_of("reduce", hidden, "--causes", model)
        self.assertIn("taken out: probe-gain:probe_b; gaps by", text)
        self.assertEqual(found["causes_taken_out"]["taken_out"], ["probe-gain:probe_b"])
        off = lambda result: np.abs(np.subtract(result["errors"]["EAX"]["value"],
                                                wanted["errors"]["EAX"]["value"])).max()
        self.assertGreater(off(wrong), 1e-7)
        # What is left: the rig's noise comes behind the gain, so it is shown 5 % smaller now.
        self.assertLess(off(found), 0.2 * off(wrong))

    def test_a_circle_is_rid_of_the_instrument_but_not_of_the_machine(self):
        hidden, clean = self.pair("circle.csv", "joint-hysteresis:object=pivot_2:width_urad=60",
                                  "--course", "circle", "--plane", "XY", "--size", "20")
        model = self.model('[[cause]]\nid = "joint-hysteresis"\nobject = "pivot_2"\nwidth_urad = 60.0\n'
                           '[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 6.0\n')
        wanted, _ = self.json_of("circle", clean)
        wrong, _ = self.json_of("circle", hidden)
        found, text = self.json_of("circle", hidden, "--causes", model)
        self.assertIn("taken out: joint-hysteresis:pivot_2; angles by 17.3 urad rms, 30 urad at most", text)
        self.assertIn("left in: backlash:X", text)
        off = lambda result: abs(result["G_b_um"] - wanted["G_b_um"])
        # G is the largest row: where the play is just being taken up something is left.
        self.assertGreater(off(wrong), 3 * off(found))

    def test_a_calibration_sees_no_subdivision(self):
        hidden, clean = self.pair("cube.csv",
                                  "encoder-subdivision:object=pivot_1:order=40:sin_urad=50:cos_urad=0",
                                  "--course", "cube", "--points", "5,5,5", "--dwell", 0.1, "--feed", 6000)
        model = self.model('[[cause]]\nid = "encoder-subdivision"\nobject = "pivot_1"\norder = 40\n'
                           'sin_urad = 50.0\ncos_urad = 0.0\n')
        wanted, _ = self.json_of("calibrate", clean)
        wrong, _ = self.json_of("calibrate", hidden)
        found, _ = self.json_of("calibrate", hidden, "--causes", model)
        self.assertGreater(wrong["after"]["rms_um"], 1.2 * wanted["after"]["rms_um"])
        self.assertAlmostEqual(found["after"]["rms_um"], wanted["after"]["rms_um"],
                               delta=0.05 * wanted["after"]["rms_um"])

    def test_a_map_is_that_of_the_machine_without_its_play(self):
        course = ("--course", "cube", "--size", "58,58,58", "--points", "5,5,5", "--dwell", 0.1,
                  "--feed", 6000)
        hidden, clean = self.pair("volume.csv", "backlash:object=X:width_um=6", *course)
        others = [self.rig_record("line.csv", "--length", "X"),
                  *(self.rig_record(f"{axis}.csv", "--axis", axis, "--mounting", "A", "--rate", 20)
                    for axis in "XYZ")]
        model = self.model('[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 6.0\n'
                           '[[cause]]\nid = "scale-error"\nobject = "Y"\ngain_ppm = 50.0\n')
        options = ("-o", self.path / "map.toml", "--fixed-smoothness")
        wanted, _ = self.json_of("fuse", clean, *others, *options)
        wrong, _ = self.json_of("fuse", hidden, *others, *options)
        found, text = self.json_of("fuse", hidden, *others, *options, "--causes", model)
        error = lambda result: np.array(result["map"]["grid"]["error"])
        off = lambda result: np.sqrt(np.mean((error(result) - error(wanted)) ** 2))
        self.assertGreater(off(wrong), 4 * off(found))
        self.assertIn("not in the map: backlash:X, width_um = 6", text)
        self.assertIn("left in: scale-error:Y", text)
        change = np.linalg.norm(error(found) - error(wrong), axis=0)
        self.assertAlmostEqual(found["map_change_um"]["largest"], 1e6 * change.max(), delta=0.01)

    def test_what_is_found_is_a_model(self):
        campaign = self.path / "campaign"
        self.done("--machine", MACHINE, "--seed", 7, "--campaign", "minimal", "--reduced", "--hide",
                  "backlash:object=X:width_um=6", "--out", campaign,
                  command="rig record")
        runs = sorted(campaign.glob("*.h5"))
        out = self.path / "found.toml"
        self.done(*runs, "--machine", MACHINE, "-o", out, command="diagnose")
        model = tomllib.loads(out.read_text())
        self.assertEqual(model["machine"], "demo-mill")
        self.assertEqual([(data["file"], data["sha256"]) for data in model["data"]],
                         [(run.name, hashlib.sha256(run.read_bytes()).hexdigest()) for run in runs])
        play = next(cause for cause in model["cause"] if cause["id"] == "backlash")
        self.assertEqual(play["object"], "X")
        self.assertAlmostEqual(play["width_um"], 6.0, delta=2 * play["u95"]["width_um"])
        text = self.done(runs[0], "--machine", MACHINE, "--causes", out)
        self.assertIn("backlash:X", text)

    def test_bad_models_are_refused(self):
        sweep = self.rig_record("x.csv", "--axis", "X", "--rate", 20)
        refuse = lambda text, *saying: self.refuse(sweep, "--machine", MACHINE, "--causes",
                                                   self.model(text), saying=saying)
        refuse('[[cause]]\nid = "backlush"\nobject = "X"\n', "causes.toml:4:", '"backlash"')
        refuse('[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 1e9\n', "causes.toml:6:", "at most 1000 um")
        other = self.path / "other.toml"
        other.write_text('extended_model = 1\nmachine = "lathe"\n')
        self.refuse(sweep, "--machine", MACHINE, "--causes", other, saying=["other.toml:2:", "lathe"])
        self.refuse(sweep, "--machine", MACHINE, "--causes", MACHINE, saying=["is no extended model"])


if __name__ == "__main__":
    unittest.main()
