#!/usr/bin/env python3
"""import abbe: arrays in and out, failures, Ctrl-C, and the same results as the program's.

    PYTHONPATH=build/dev/python ABBE=path/to/abbe ABBE_MACHINE=machine.toml module_test.py
"""
import json
import math
import os
import pathlib
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
