#!/usr/bin/env python3
"""import abbe: arrays in and out, failures, Ctrl-C, and the same results as the program's.

    PYTHONPATH=build/dev/python ABBE=path/to/abbe ABBE_MACHINE=machine.toml module_test.py
"""
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

import numpy as np

import abbe

PROGRAM = os.environ["ABBE"]
MACHINE = pathlib.Path(os.environ["ABBE_MACHINE"])


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.path = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.machine = abbe.read_machine(MACHINE)

    @classmethod
    def program(cls, *arguments):
        done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
        if done.returncode != 0:
            raise AssertionError(done.stderr)
        return done.stdout

    @classmethod
    def record(cls, name, *options, seed=7):
        cls.program("rig", "record", "--machine", MACHINE, "--seed", seed, "--out", cls.path / name, *options)
        return cls.path / name


class FailureTest(Folder):
    def test_kinds_and_texts_are_those_of_the_program(self):
        for kind, base in ((abbe.InputError, ValueError), (abbe.DeviceError, RuntimeError),
                           (abbe.NumericalError, RuntimeError)):
            self.assertTrue(issubclass(kind, abbe.Failure) and issubclass(kind, base))
            self.assertEqual(kind.__module__, "abbe")
        bad = self.path / "bad.csv"
        bad.write_text("# kind = \"sweep\"\ntime_s,x_mm\n0,1\n1,2,3\n")
        said = subprocess.run([PROGRAM, "reduce", bad, "--machine", MACHINE], capture_output=True, text=True).stderr
        with self.assertRaises(abbe.InputError) as caught:
            abbe.read_recording(bad)
        self.assertIn(str(caught.exception), said)

    def test_a_machine_file_that_is_wrong_names_line_and_key(self):
        wrong = self.path / "wrong.toml"
        wrong.write_text(MACHINE.read_text().replace("[head]", "[head]\nnonsense = 1", 1))
        with self.assertRaisesRegex(abbe.InputError, r"wrong\.toml:\d+: head\.nonsense"):
            abbe.read_machine(wrong)

    def test_readings_of_no_small_motion_are_a_numerical_failure(self):
        with self.assertRaisesRegex(abbe.NumericalError, "."):
            abbe.invert_head([[1.0, -1.0, 2.0, 5.0, -5.0]], [0.0])

    def test_shapes_are_named(self):
        with self.assertRaisesRegex(abbe.InputError, r"travel_m: has the shape \(3,\); give \(2,\)"):
            abbe.head_readings(np.zeros((2, 6)), np.zeros(3))
        with self.assertRaisesRegex(abbe.InputError, r"angles_rad: has the shape \(2, 4\).*\(n, 3\)"):
            abbe.PivotLinkage(0.1, 0.1).tips(np.zeros((2, 4)))


class RecordingTest(Folder):
    def test_columns_are_views(self):
        recording = abbe.Recording('kind = "dwell"', {"time_s": [0.0, 1.0, 2.0], "probe_a_um": [1.0, 2.0, 3.0]})
        recording["probe_a_um"][1] = 7.0
        self.assertEqual(recording["probe_a_um"].tolist(), [1.0, 7.0, 3.0])
        self.assertFalse(recording["time_s"].flags.owndata)
        column = recording.to_dict()["probe_a_um"]
        del recording
        self.assertEqual(column[1], 7.0)

    def test_both_forms_give_back_what_was_written(self):
        rng = np.random.default_rng(1)
        columns = {"time_s": np.arange(50) / 10, "x_mm": rng.normal(size=50), "probe_a_um": rng.uniform(size=50)}
        made = abbe.Recording('kind = "dwell"\nmachine = "m"', columns)
        for name in ("r.csv", "r.h5"):
            abbe.write_recording(made, self.path / name)
            read = abbe.read_recording(self.path / name)
            self.assertEqual((read.kind, len(read), read.columns), ("dwell", 50, list(columns)))
            for column, values in columns.items():
                np.testing.assert_array_equal(read[column], values)

    def test_repr_says_what_it_is(self):
        made = abbe.Recording('kind = "dwell"', {"time_s": [0.0, 1.0]})
        self.assertEqual(repr(made), '<abbe.Recording "recording": dwell, 2 rows of 1 columns>')


class HeadTest(unittest.TestCase):
    def test_inversions_give_back_the_errors(self):
        rng = np.random.default_rng(2)
        errors = rng.normal(size=(200, 6)) * [1e-4, 1e-4, 1e-4, 5e-6, 5e-6, 0]
        travel = rng.uniform(0, 0.06, size=200)
        for moving in ("target", "head"):
            for model in ("rigid", "small-angle"):
                readings = abbe.head_readings(errors, travel, moving, model)
                np.testing.assert_allclose(abbe.invert_head(readings, travel, moving, model), errors, rtol=0,
                                           atol=1e-14)

    def test_readings_that_no_small_motion_gives_are_refused_in_any_row(self):
        readings = abbe.head_readings(np.full((1000, 6), 1e-6), np.zeros(1000), model="small-angle")
        readings[700, 2] = np.nan
        for model in ("rigid", "small-angle"):
            with self.assertRaises(abbe.NumericalError):
                abbe.invert_head(readings, np.zeros(1000), model=model)
        self.assertEqual(abbe.invert_head(readings[:0], [], model="small-angle").shape, (0, 6))

    def test_the_positioning_that_is_known_is_taken(self):
        """Moving target: a reading depends on travel and positioning by their sum alone."""
        rng = np.random.default_rng(6)
        errors = rng.normal(size=(700, 6)) * [1e-4, 1e-4, 1e-4, 5e-6, 5e-6, 20e-6]
        travel = rng.uniform(0, 0.06, size=700)
        for model in ("rigid", "small-angle"):
            readings = abbe.head_readings(errors, travel, model=model)
            np.testing.assert_allclose(
                abbe.invert_head(readings, travel, model=model, positioning_m=errors[:, 5]), errors, rtol=0, atol=1e-14)

    def test_small_errors_are_those_of_the_published_equations(self):
        """To first order, target moving: A reads EZX + y EAX + (d - x) EBX, D reads EYX - z EAX - (d - x) ECX."""
        eax, ebx, ecx, eyx, ezx = 1e-9, 2e-9, -3e-9, 4e-9, -5e-9
        d = 0.03
        readings = abbe.head_readings([[eax, ebx, ecx, eyx, ezx, 0]], [d])[0]
        at = abbe.nominal_layout()
        expected = [ezx + s * eax + (d - u) * ebx for u, s in at[:3]] + [eyx - n * eax - (d - u) * ecx
                                                                          for u, n in at[3:]]
        np.testing.assert_allclose(readings, expected, rtol=0, atol=1e-16)


class LinkageTest(Folder):
    def test_the_model_without_errors_is_the_closed_form(self):
        rng = np.random.default_rng(3)
        angles = rng.uniform(-0.4, 0.4, size=(50, 3))
        model = abbe.LinkageModel(self.machine)
        lengths = [0.0, 0.0]
        # The links of the demo's file: those for which both agree at one pose must agree at all.
        straight = model.tips([[0.0, 0.0, 0.0]])[0]
        lengths = straight[0], straight[2]
        closed = abbe.PivotLinkage(*lengths)
        np.testing.assert_allclose(model.tips(angles), closed.tips(angles), rtol=0, atol=1e-12)

    def test_angles_reach_and_do_not(self):
        linkage = abbe.PivotLinkage(0.12, 0.12)
        angles, reached = linkage.angles([[0.1, 0.05, 0.05], [0.3, 0.0, 0.0]])
        self.assertEqual(reached.tolist(), [True, False])
        np.testing.assert_allclose(linkage.tips(angles[:1]), [[0.1, 0.05, 0.05]], atol=1e-15)

    def test_jacobians_are_differences(self):
        linkage, q, h = abbe.PivotLinkage(0.12, 0.10), np.array([[0.3, -0.2, 0.1]]), 1e-6
        jacobian = linkage.jacobian(q)[0]
        for joint in range(3):
            step = h * np.eye(3)[joint]
            slope = (linkage.tips(q + step) - linkage.tips(q - step))[0] / (2 * h)
            np.testing.assert_allclose(jacobian[:, joint], slope, atol=1e-9)
        model = abbe.LinkageModel(self.machine, "published")
        x = model.values
        jacobian = model.jacobian(q, parameters=x)
        self.assertEqual(jacobian.shape, (1, 3, len(model.names)))
        step = h * np.eye(len(x))[2]
        slope = (model.tips(q, parameters=x + step) - model.tips(q, parameters=x - step))[0] / (2 * h)
        np.testing.assert_allclose(jacobian[0, :, 2], slope, atol=1e-8)


class MachineTest(Folder):
    def test_a_key_is_changed_and_all_else_stays(self):
        key, (first, last) = "axis.X.travel_mm", self.machine["axis.X.travel_mm"]
        longer = self.machine.changed({key: np.array([first, last + 20])})
        self.assertEqual(longer.travels_m.tolist()[0], [first / 1e3, (last + 20) / 1e3])
        self.assertEqual(self.machine.travels_m.tolist()[0], [first / 1e3, last / 1e3])
        self.assertIn(key, longer.keys())
        lines = zip(self.machine.text.splitlines(), longer.text.splitlines(), strict=True)
        (pair,) = [(old, new) for old, new in lines if old != new]
        self.assertEqual(pair, (f"travel_mm = [{first}, {last}]", f"travel_mm = [{first}, {last + 20}]"))

    def test_what_is_written_is_read_again(self):
        changed = self.machine.changed({"name": "other mill", "population.smoothness_mm": 33})
        changed.write(self.path / "other.toml")
        self.assertEqual((self.path / "other.toml").read_text(), changed.text)
        read = abbe.read_machine(self.path / "other.toml")
        self.assertEqual((read.name, read["population.smoothness_mm"], read.path), ("other mill", 33, self.path / "other.toml"))
        self.assertEqual(abbe.parse_machine(changed.text, "a text").path, pathlib.Path("a text"))

    def test_what_would_be_refused_is_refused(self):
        with self.assertRaisesRegex(abbe.InputError, r"demo_mill\.toml:\d+: axis\.X\.travel_m: "):
            self.machine.changed({"axis.X.travel_m": 1.0})
        with self.assertRaisesRegex(abbe.InputError, "axis.X.travel_mm"):
            self.machine.changed({"axis.X.travel_mm": "far"})
        with self.assertRaisesRegex(abbe.InputError, "did you mean axis.X.travel_mm"):
            self.machine["axis.X.travel_m"]


class ResultTest(Folder):
    """Against the program: the same recording gives the same numbers."""

    def json_of(self, *arguments):
        self.program(*arguments, "--json", self.path / "result.json", "--quiet", "--force")
        return json.loads((self.path / "result.json").read_text())

    def test_a_sweep(self):
        file = self.record("sweep.csv", "--axis", "X")
        result = abbe.reduce_sweep(abbe.read_recording(file), self.machine)
        by_program = self.json_of("reduce", file, "--machine", MACHINE)
        self.assertEqual(result.to_dict()["errors"], by_program["errors"])
        np.testing.assert_array_equal(result.value("EYX"), by_program["errors"]["EYX"]["value"])
        np.testing.assert_array_equal(result.u("EYX"), by_program["errors"]["EYX"]["u"])
        self.assertFalse(result.value("EYX").flags.owndata)
        with self.assertRaisesRegex(abbe.InputError, "EAX, EBX, ECX, EYX, EZX"):
            result.value("EXX")

    def test_a_map_its_points_and_its_correction(self):
        files = [self.record(f"s{axis}.csv", "--axis", axis) for axis in "XY"]
        report = abbe.fuse([abbe.read_recording(file) for file in files], self.machine)
        self.program("fuse", *files, "--machine", MACHINE, "-o", self.path / "map.toml", "--quiet", "--force")
        by_program = abbe.read_map(self.path / "map.toml")
        rng = np.random.default_rng(4)
        low, high = by_program.travels_m.T
        at = rng.uniform(low, high, size=(300, 3))
        np.testing.assert_array_equal(report.map.error(at), by_program.error(at))
        np.testing.assert_array_equal(report.map.standard_uncertainty(at[:5]), by_program.standard_uncertainty(at[:5]))
        np.testing.assert_allclose(np.sqrt(np.diagonal(report.map.covariance(at[:5]), axis1=1, axis2=2)),
                                   report.map.standard_uncertainty(at[:5]), rtol=1e-12)
        inside, h = at[:5] * 0.9 + 0.05 * (low + high), 1e-7
        for axis in range(3):
            step = h * np.eye(3)[axis]
            slope = (report.map.error(inside + step) - report.map.error(inside - step)) / (2 * h)
            np.testing.assert_allclose(report.map.gradient(inside)[:, :, axis], slope, atol=2e-9)
        corrector = abbe.Corrector(report.map)
        np.testing.assert_allclose(corrector.made(corrector.command(inside)), inside, rtol=0, atol=1e-12)
        (self.path / "wanted.csv").write_text("x_mm,y_mm,z_mm\n" + "".join(
            f"{x:.9f},{y:.9f},{z:.9f}\n" for x, y, z in 1e3 * inside))
        report.map.write(self.path / "again.toml")
        self.assertEqual(abbe.read_map(self.path / "again.toml").error(at).tobytes(), by_program.error(at).tobytes())
        done = report.map.export(self.path / "map.csv", "csv", points=(5, 5, 5))
        self.assertTrue(all(pathlib.Path(file).exists() for file in done["files"]))
        with self.assertRaisesRegex(abbe.InputError, "X"):
            report.map.error([[1.0, 0.0, 0.0]])

    def test_a_calibration_and_a_circle(self):
        cube = self.record("cube.csv", "--course", "cube", "--size", "45", "--points", "4,4,4", "--dwell", "0.2",
                           "--feed", "2000", "--reference")
        calibration = abbe.calibrate([abbe.read_recording(cube)], self.machine, folds=2)
        by_program = self.json_of("calibrate", cube, "--machine", MACHINE, "--folds", "2")
        self.assertEqual(calibration.to_dict()["held_out"], by_program["held_out"])
        self.assertEqual(len(calibration.names), len(calibration.u))
        calibration.write(self.path / "linkage.toml")
        circle = self.record("circle.csv", "--course", "circle", "--feed", "600")
        path = abbe.linkage_path(abbe.read_recording(circle), self.machine, self.path / "linkage.toml")
        figures = abbe.circles([path], filter=50)[0].figures_m
        of_program = self.json_of("circle", circle, "--machine", MACHINE, "--calibration", self.path / "linkage.toml",
                                  "--filter", "50")
        self.assertAlmostEqual(1e6 * figures["G_b_m"], of_program["G_b_um"], places=9)
        self.assertEqual(path.measured_m.shape, (len(path), 3))

    def test_an_arm(self):
        """Against the program, on poses of the file's arm with encoders that are off."""
        machine_file = MACHINE.parent / "motoman_left.toml"
        machine = abbe.read_machine(machine_file)
        model, rng = abbe.LinkageModel(machine), np.random.default_rng(5)
        angles = rng.uniform(-1, 1, size=(60, model.joints))
        seen_mm = 1e3 * (model.tips(angles + 1e-3 * np.arange(6)) + [1, 2, 3]) + rng.normal(scale=0.02, size=(60, 3))
        recording = abbe.Recording('kind = "linkage"\ntime = "order"',
                                   {"time_s": np.arange(60.0),
                                    **{f"pivot_{i + 1}_rad": angles[:, i] for i in range(6)},
                                    **{f"ref_{axis}_mm": seen_mm[:, i] for i, axis in enumerate("xyz")}}, "arm.csv")
        abbe.write_recording(recording, self.path / "arm.csv")
        found = abbe.calibrate_arm([recording], machine)
        by_program = self.json_of("calibrate", self.path / "arm.csv", "--machine", machine_file)
        self.assertEqual(found.to_dict()["numbers"], by_program["numbers"])
        self.assertLess(found.rms_m[0], 0.1 * found.rms_before_m[0])
        found.write(self.path / "arm.toml")
        self.assertIn("motoman-left", repr(abbe.read_machine(self.path / "arm.toml")))

    def test_a_diagnosis(self):
        file = self.record("hidden.csv", "--kind", "reference", "--course", "circle", "--passes", "2", "--rate", "20",
                           "--hide", "backlash:object=X:width_um=8", seed=3)
        diagnosis = abbe.diagnose([abbe.read_recording(file)], self.machine)
        by_program = self.json_of("diagnose", file, "--machine", MACHINE)
        self.assertEqual(diagnosis.to_dict()["findings"], by_program["findings"])
        self.assertEqual([finding.object for finding in diagnosis.findings], ["X"])
        self.assertIn("backlash:X", repr(diagnosis))
        # The model as a file is that of the program, and gives what it took out back.
        self.program("diagnose", file, "--machine", MACHINE, "-o", self.path / "by_program.toml", "--quiet", "--force")
        diagnosis.write(self.path / "causes.toml", [file])
        self.assertEqual((self.path / "causes.toml").read_text(), (self.path / "by_program.toml").read_text())
        model = abbe.read_model(self.path / "causes.toml", self.machine)
        self.assertEqual((model.verdict, [cause.name for cause in model.causes]), ("explained", ["backlash:X"]))
        width, u95 = model.causes[0].parameters["width_um"]
        self.assertLess(abs(width - 8), 2 * u95)
        model.write(self.path / "again.causes.toml")
        self.assertEqual((self.path / "again.causes.toml").read_text(), (self.path / "causes.toml").read_text())
        other = self.machine.changed({"name": "other"})
        with self.assertRaisesRegex(abbe.InputError, "other"):
            abbe.read_model(self.path / "causes.toml", other)
        recording = abbe.read_recording(file)
        corrected = abbe.correct_recording(recording, self.machine, self.path / "causes.toml")
        moved_um = 1e3 * (corrected["x_mm"] - recording["x_mm"])
        self.assertAlmostEqual(np.ptp(moved_um), width, delta=0.01)
        self.assertFalse(abbe.diagnose([corrected], self.machine).findings)
        with self.assertRaisesRegex(abbe.InputError, "calibrating"):
            abbe.correct_recording(recording, self.machine, self.path / "causes.toml", "all")

    def test_a_plan(self):
        files = [self.record(f"p{axis}.csv", "--axis", axis) for axis in "XY"]
        plan = abbe.plan([abbe.read_recording(file) for file in files], self.machine)
        by_program = self.json_of("diagnose", "--plan", *files, "--machine", MACHINE)
        self.assertEqual(plan.to_dict(), {key: by_program[key] for key in plan.to_dict()})
        seen = {cause.name for cause in plan.causes if cause.seen}
        # A cable with the wrong sign turns every error round.
        self.assertIn("channel-sign:probe_a", seen)
        self.assertTrue(seen.isdisjoint(plan.cannot_show))
        self.assertTrue(all({first, second} <= seen for first, second, _ in plan.alike))
        with self.assertRaisesRegex(abbe.InputError, "standard"):
            abbe.plan([], self.machine, campaign="large")
        with self.assertRaisesRegex(abbe.InputError, "runs to plan with"):
            abbe.plan([], self.machine)

    def test_a_plan_of_a_campaign(self):
        plan = abbe.plan([], self.machine, campaign="minimal")
        by_program = self.json_of("diagnose", "--plan", "--campaign", "minimal", "--machine", MACHINE)
        self.assertEqual(plan.to_dict(), {key: by_program[key] for key in plan.to_dict()})

    def test_a_plate(self):
        file = self.record("plate.csv", "--plate")
        heard = []
        report = abbe.evaluate_plate([abbe.read_recording(file)], self.machine, holdout=4,
                                     progress=lambda *step: heard.append(step))
        by_program = self.json_of("plate", file, "--machine", MACHINE, "--holdout", "4", "-o", self.path / "plate.toml")
        finite = re.sub(r"\b(NaN|Infinity)\b", "null", json.dumps(report.to_dict()))
        self.assertEqual(json.loads(finite), {key: by_program[key] for key in report.to_dict()})
        at = 0.5 * self.machine.travels_m.sum(axis=1)[None, :]
        np.testing.assert_array_equal(report.map.error(at), abbe.read_map(self.path / "plate.toml").error(at))
        self.assertEqual(len(report.noise), 5)
        self.assertIn("holes held out", [what for _, _, what in heard])


class FleetTest(Folder):
    def test_it_is_that_of_the_program(self):
        given, campaigns = [], []
        for seed in (1, 2, 3):
            folder = self.path / f"fleet{seed}"
            folder.mkdir()
            files = [self.record(folder / f"{axis}.csv", "--axis", axis, seed=seed) for axis in "XY"]
            given.append(f"M{seed}={folder}")
            campaigns.append(abbe.campaign_of([abbe.read_recording(file) for file in files], self.machine, f"M{seed}",
                                              str(folder)))
        campaigns.append(campaigns[0])  # said again of the same machine
        fleet = abbe.fit_fleet(campaigns, self.machine)
        self.assertEqual(fleet.machines, ["M1", "M2", "M3"])
        self.program("fleet", "fit", *given, "--machine", MACHINE, "--store", self.path / "fleet.store", "--json",
                     self.path / "fleet.json", "--quiet")
        by_program = json.loads((self.path / "fleet.json").read_text())
        self.assertEqual({key.split(".", 1)[1] for key in fleet.population}, set(by_program["population"]))
        for key, (stated, seen, factor) in fleet.population.items():
            line = by_program["population"][key.split(".", 1)[1]]
            self.assertEqual(stated, line["file"])
            self.assertEqual(math.isfinite(factor), "fleet" in line)
            if math.isfinite(factor):  # the sums are in another order
                self.assertAlmostEqual(seen / line["fleet"], 1.0, places=5)
                self.assertAlmostEqual(math.log(factor) / (2 * line["u_log"]), 1.0, places=5)
        self.assertEqual([(odd["machine"], odd["error"]) for odd in fleet.odd_errors],
                         [(odd["machine"], odd["error"]) for odd in by_program["odd_errors"]])
        self.assertEqual(fleet.odd_identities(), [])
        information = campaigns[0].information
        self.assertFalse(information.flags.owndata)
        np.testing.assert_allclose(information, information.T, rtol=0, atol=1e-9 * np.abs(information).max())


class ProgressTest(Folder):
    @classmethod
    def setUpClass(cls):
        """Each long call, with the recording that it takes."""
        super().setUpClass()
        sweep = abbe.read_recording(cls.record("sweep.csv", "--axis", "X"))
        cube = abbe.read_recording(cls.record("cube.csv", "--course", "cube", "--size", "45", "--points", "4,4,4",
                                              "--dwell", "0.2", "--feed", "2000", "--reference"))
        cls.calls = [(abbe.fuse, sweep), (abbe.diagnose, sweep), (abbe.calibrate, cube)]

    def test_each_long_call_says_how_far_it_is(self):
        for call, recording in self.calls:
            heard = []
            call([recording], self.machine, progress=lambda *step, heard=heard: heard.append(step))
            self.assertGreater(len(heard), 2, call)
            done, total, what = zip(*heard)
            self.assertTrue(all(a <= b for a, b in zip(done, total)))
            self.assertEqual((list(done), list(total)), (sorted(done), sorted(total)))
            self.assertEqual((done[0], done[-1], what[-1]), (0, total[-1], "done"))

    def test_what_it_throws_ends_the_call(self):
        for call, recording in self.calls:
            with self.assertRaisesRegex(KeyError, "enough"):
                call([recording], self.machine, progress=lambda done, total, what: {}["enough"])


class LongCallTest(Folder):
    def test_ctrl_c_ends_a_diagnosis(self):
        folder = self.record("campaign", "--campaign", "standard", "--reduced")
        recordings = [abbe.read_recording(file) for file in sorted(folder.iterdir()) if file.suffix == ".h5"]
        threading.Timer(1.5, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
        begun = time.monotonic()
        with self.assertRaises(KeyboardInterrupt):
            abbe.diagnose(recordings, self.machine)
        print(f"Ctrl-C ended it {time.monotonic() - begun - 1.5:.2f} s later")
        # The module is as it was.
        self.assertEqual(abbe.PivotLinkage(0.1, 0.1).tips([[0, 0, 0]]).tolist(), [[0.1, 0.0, 0.1]])

    def test_other_threads_run_meanwhile(self):
        """A long call on one thread, counting on another: both run, whatever the number of cores."""
        linkage, angles, counted = abbe.PivotLinkage(0.12, 0.12), np.zeros((3_000_000, 3)), 0
        done = threading.Event()

        def work():
            for _ in range(5):
                linkage.tips(angles)
            done.set()

        # With the lock held, this thread would count nothing within a call; the switch interval is far longer.
        before = sys.getswitchinterval()
        self.addCleanup(sys.setswitchinterval, before)
        sys.setswitchinterval(1000.0)
        worker = threading.Thread(target=work)
        worker.start()
        while not done.is_set():
            counted += 1
            time.sleep(0)
        worker.join()
        self.assertGreater(counted, 5)


if __name__ == "__main__":
    unittest.main()
