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
LEFT_UM = 0.3
UNEXPLAINED = f'''[diagnosis]
verdict = "unexplained"
next_runs = ["an hour later and 3 K warmer"]
[[diagnosis.unexplained]]
object = "probe_a"
variable = "time"
amplitude = {LEFT_UM}
unit = "um"
in_space_um = {LEFT_UM}
'''


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
        play = "backlash:object=X:width_um=6"
        hidden, clean = zip(self.pair("volume.csv", play, *course), self.pair("line.csv", play, "--length", "X"))
        others = [self.rig_record(f"{axis}.csv", "--axis", axis, "--mounting", "A", "--rate", 50) for axis in "XYZ"]
        model = self.model('[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 6.0\n'
                           '[[cause]]\nid = "scale-error"\nobject = "Y"\ngain_ppm = 50.0\n')
        options = ("-o", self.path / "map.toml", "--fixed-smoothness")
        wanted, _ = self.json_of("fuse", *clean, *others, *options)
        wrong, _ = self.json_of("fuse", *hidden, *others, *options)
        found, text = self.json_of("fuse", *hidden, *others, *options, "--causes", model)
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
        self.assertIn(model["diagnosis"]["verdict"], ("explained", "ambiguous"))
        self.assertEqual([(data["file"], data["sha256"]) for data in model["data"]],
                         [(run.name, hashlib.sha256(run.read_bytes()).hexdigest()) for run in runs])
        play = next(cause for cause in model["cause"] if cause["id"] == "backlash")
        self.assertEqual(play["object"], "X")
        self.assertGreater(play["probability"], 0.9)
        self.assertAlmostEqual(play["width_um"], 6.0, delta=2 * play["u95"]["width_um"])
        text = self.done(runs[0], "--machine", MACHINE, "--causes", out)
        self.assertIn("backlash:X", text)

    def test_beside_what_is_unexplained_every_command_refuses_the_causes(self):
        table = self.path / "positions.csv"
        table.write_text("x_mm,y_mm,z_mm\n10,10,10\n20,10,10\n")
        sweep = self.rig_record("x.csv", "--axis", "X", "--rate", 20)
        circle = self.rig_record("circle.csv", "--course", "circle", "--plane", "XY", "--size", "20")
        volume = self.path / "map.toml"
        self.done(sweep, "--machine", MACHINE, "-o", volume, "--fixed-smoothness", command="fuse")
        model = self.model('[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 6.0\n' + UNEXPLAINED)
        machine = ("--machine", MACHINE)
        for command, arguments in {
                "reduce": (sweep, *machine), "circle": (circle, *machine), "calibrate": (circle, *machine),
                "fuse": (sweep, *machine, "-o", volume), "path": (circle, *machine, "--test", "stepping"),
                "simulate": (volume, "--test", "circle"), "correct": (volume, table)}.items():
            with self.subTest(command):
                run = self.run_program(*arguments, "--causes", model, command=command)
                self.assertEqual(run.returncode, 2, run.stderr)
                for word in ("mill.causes.toml", "probe_a over time, 0.3 um", "an hour later and 3 K warmer",
                             "--although-unexplained"):
                    self.assertIn(word, run.stderr)
        self.done(volume, table, "--causes", model, "--although-unexplained", command="correct")

    def doubted(self, command, recordings, cause, *options):
        """Results without the cause, with it as certain, and with it beside something unexplained."""
        certain = self.model(cause + '[diagnosis]\nverdict = "explained"\n')
        results = [self.json_of(command, *recordings, *options)[0],
                   self.json_of(command, *recordings, *options, "--causes", certain)[0]]
        result, text = self.json_of(command, *recordings, *options, "--causes",
                                    self.model(cause + UNEXPLAINED), "--although-unexplained")
        self.assertIn("not certain: ", text + str(result.get("notes")))
        return *results, result

    def test_the_u95_of_a_sweep_contains_the_change_and_what_is_left(self):
        sweep = self.rig_record("x.csv", "--axis", "X", "--rate", 50)
        without, certain, doubted = self.doubted(
            "reduce", [sweep], '[[cause]]\nid = "probe-gain"\nobject = "probe_b"\ndelta = 0.05\n')
        arm = 0.010  # the nearest probes of the head
        for name, error in doubted["errors"].items():
            self.assertEqual(error["value"], certain["errors"][name]["value"])
            change = np.subtract(error["value"], without["errors"][name]["value"])
            left = 1e-6 * LEFT_UM / (arm if error["unit"] == "rad" else 1.0)
            np.testing.assert_allclose(np.square(error["u"]),
                                       np.square(certain["errors"][name]["u"]) + change**2 + left**2, rtol=1e-9)

    def test_the_u95_of_a_map_contains_the_change_and_what_is_left(self):
        runs = [self.rig_record("volume.csv", "--course", "cube", "--size", "58,58,58", "--points", "5,5,5",
                                "--dwell", 0.1, "--feed", 6000),
                *(self.rig_record(f"{axis}.csv", "--axis", axis, "--mounting", "A", "--rate", 20) for axis in "XYZ")]
        without, certain, doubted = self.doubted(
            "fuse", runs, '[[cause]]\nid = "probe-gain"\nobject = "probe_b"\ndelta = 0.05\n',
            "-o", self.path / "map.toml", "--fixed-smoothness")
        of = lambda result, key: np.array(result["map"]["grid"][key])
        np.testing.assert_array_equal(of(doubted, "error"), of(certain, "error"))
        change = of(doubted, "error") - of(without, "error")
        self.assertGreater(np.abs(change).max(), 1e-6)
        added = of(doubted, "u")**2 - of(certain, "u")**2 - change**2
        # The numbers of the grid are rounded to 1 pm.
        self.assertAlmostEqual(1e6 * np.sqrt(added.mean()), LEFT_UM, delta=1e-4)
        self.assertTrue((np.abs(change) <= 1.96 * of(doubted, "u")).all())

    def test_the_u95_of_a_circle_contains_the_change_and_what_is_left(self):
        circle = self.rig_record("circle.csv", "--course", "circle", "--plane", "XY", "--size", "20")
        without, certain, doubted = self.doubted(
            "circle", [circle], '[[cause]]\nid = "joint-hysteresis"\nobject = "pivot_2"\nwidth_urad = 60.0\n')
        for name in ("G_b_um", "D_um"):
            self.assertEqual(doubted[name], certain[name])
            change = doubted[name] - without[name]
            self.assertAlmostEqual(doubted["u"][name]**2, certain["u"][name]**2 + change**2 + LEFT_UM**2, delta=1e-9)

    def test_the_uncertainties_of_a_calibration_contain_the_change_and_what_is_left(self):
        cube = self.rig_record("cube.csv", "--course", "cube", "--points", "5,5,5", "--dwell", 0.1, "--feed", 6000)
        without, certain, doubted = self.doubted(
            "calibrate", [cube],
            '[[cause]]\nid = "joint-hysteresis"\nobject = "pivot_2"\nwidth_urad = 60.0\n')
        of = lambda result, key: np.array([one[key] for one in result["parameters"]], dtype=float)
        change = of(doubted, "value") - of(without, "value")
        free = of(certain, "uncertainty") > 0
        grown = (of(doubted, "uncertainty")**2 - change**2)[free] / of(certain, "uncertainty")[free]**2
        # All by one factor, which is that of the ball.
        self.assertGreater(grown.min(), 1.0)
        np.testing.assert_allclose(grown, grown[0], rtol=1e-5)

    def test_only_the_cause_that_is_not_certain_widens_the_u95(self):
        sweep = self.rig_record("x.csv", "--axis", "X", "--rate", 50)
        gain = lambda probe, more="": f'[[cause]]\nid = "probe-gain"\nobject = "{probe}"\ndelta = 0.05\n{more}'
        ambiguous = self.model(gain("probe_a", 'probability = 1.0\n') +
                               gain("probe_d", 'probability = 0.6\nrivals = ["probe-gain:probe_e"]\n') +
                               '[diagnosis]\nverdict = "ambiguous"\n')
        found, text = self.json_of("reduce", sweep, "--causes", ambiguous)
        self.assertIn("not certain: probe-gain:probe_d (probability 0.600; or probe-gain:probe_e)", text)
        both, _ = self.json_of("reduce", sweep, "--causes", self.model(gain("probe_a") + gain("probe_d")))
        one, _ = self.json_of("reduce", sweep, "--causes", self.model(gain("probe_a")))
        for name, error in found["errors"].items():
            change = np.subtract(error["value"], one["errors"][name]["value"])
            np.testing.assert_allclose(np.square(error["u"]),
                                       np.square(both["errors"][name]["u"]) + change**2, rtol=1e-9)

    def test_a_model_without_a_verdict_is_told(self):
        sweep = self.rig_record("x.csv", "--axis", "X", "--rate", 20)
        model = self.model('[[cause]]\nid = "backlash"\nobject = "X"\nwidth_um = 6.0\n')
        run = self.run_program(sweep, "--machine", MACHINE, "--causes", model)
        self.assertEqual(run.returncode, 0)
        self.assertIn("states no verdict", run.stderr)

    def test_what_is_unexplained_stands_in_the_model_and_gives_no_advice(self):
        campaign = self.path / "campaign"
        self.done("--machine", MACHINE, "--seed", 7, "--campaign", "minimal", "--reduced", "--hide",
                  "unknown-hum:object=probe_a:amplitude_um=0.3", "--hide", "backlash:object=Y:width_um=6",
                  "--out", campaign, command="rig record")
        out, result = self.path / "found.toml", self.path / "found.json"
        run = self.run_program(*sorted(campaign.glob("*.h5")), "--machine", MACHINE, "-o", out, "--json", result,
                               command="diagnose")
        self.assertEqual(run.returncode, 0, run.stderr)
        told = json.loads(result.read_text())
        self.assertEqual(told["verdict"], "unexplained")
        self.assertIn("other commands will refuse it", run.stderr)
        self.assertIn("What would explain part of it", run.stdout)
        self.assertNotIn("what to do", run.stdout)
        for finding in told["findings"]:
            self.assertEqual(set(finding["words"]), {"what", "shows"})
        diagnosis = tomllib.loads(out.read_text())["diagnosis"]
        self.assertEqual(diagnosis["verdict"], "unexplained")
        for left, same in zip(told["unexplained"], diagnosis["unexplained"], strict=True):
            for key in ("object", "variable", "amplitude", "unit"):
                self.assertEqual(left[key], same[key])
            self.assertGreater(same["in_space_um"], 0.0)

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
