#!/usr/bin/env python3
"""The rig's own encoders on vcan0 and its registers, recorded and evaluated as a user would, in the guest that
tests/hal/uml_run makes.

    ABBE=path/to/abbe uml_run -- python3 encoders_test.py
"""
import csv
import json
import math
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import time
import unittest

ABBE = os.environ["ABBE"]
MILL = pathlib.Path(__file__).parents[2] / "machines" / "demo_mill.toml"
COURSE = ["--course", "circle", "--size", 20, "--feed", 1200, "--passes", 2]
# Nothing is drawn of the linkage and it has no noise: its nominal parameters are the true ones. A
# count is 0.4 urad, 45 nm at the end of a link.
PERFECT = [(rf"(?m)^{key} = .*", f"{key} = 0.0") for key in (
    "link_um", "pivot_urad", "pivot_um", "encoder_offset_urad", "eccentricity_urad", "graduation_urad", "bearing_um",
    "base_um", "base_urad", "ball_um", "compliance_urad", "thermal_ppm_per_c", "encoder_urad", "reference_um")]
CROOKED = [(r"(?m)^squareness_urad = 30.0", "squareness_urad = 300.0")]  # of the machine: it has something to show
# The guest has one virtual processor, which the whole computer shares.
PATIENT = [(r"(?m)^stale_ms = .*", "stale_ms = 5000.0"),
           (r"(?m)^unit = 2", "unit = 2\nresponse_timeout_ms = 2000.0\ndeadline_ms = 4000.0"),
           (r"(?m)^sync_ms = .*", "sync_ms = 1.0\nanswer_timeout_ms = 1000.0\nheartbeat_timeout_ms = 3000.0")]


def rows_of(path):
    lines = path.read_text().splitlines()
    header = [line for line in lines if line.startswith("#")]
    return [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines[len(header):])]


def widest_gap(run):
    """Of both senses, degrees: figures about the least-squares centre need points all round."""
    gaps = []
    for sense in ("ccw", "cw"):
        angles = [math.degrees(angle) for angle in run["profile"][sense]["angle"]]
        gaps += [after - before for before, after in zip(angles, [*angles[1:], angles[0] + 360.0])]
    return max(gaps)


class EncodersTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.machine = self.folder / "machine.toml"

    def describe(self, changes=()):
        text = MILL.read_text()
        for pattern, put in [*PATIENT, *changes]:
            text, count = re.subn(pattern, put, text)
            self.assertGreater(count, 0, pattern)
        self.machine.write_text(text + "\n[rig]\ncap_um = 0.0\ntemperature_drift_c = 0.0\n")

    def serve(self, *arguments):
        ready = self.folder / "port"
        rig = subprocess.Popen([ABBE, "rig", "--machine", self.machine, "--seed", "7", "--ready-file", ready, "--can",
                                *map(str, arguments)], stdout=subprocess.PIPE, text=True)
        self.addCleanup(rig.stdout.close)
        self.addCleanup(rig.wait)
        self.addCleanup(rig.kill)
        while not ready.exists():
            self.assertIsNone(rig.poll(), "the rig ended before it was ready")
            time.sleep(0.05)
        return rig

    def abbe(self, *arguments):
        return subprocess.run([ABBE, *map(str, arguments)], capture_output=True, text=True, timeout=400)

    def run_abbe(self, *arguments):
        done = self.abbe(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def circle(self, recording):
        """None where the good rows are too few, or on a bit of the circle, which abbe refuses."""
        result = self.folder / "circle.json"
        done = self.abbe("circle", recording, "--machine", self.machine, "--radius", 10, "--json", result, "--quiet")
        if done.returncode == 2 and "of 360 degrees" in done.stderr:
            print(done.stderr, end="")
            return None
        self.assertEqual(done.returncode, 0, done.stderr)
        return json.loads(result.read_text())["circles"][0]

    def test_a_circle_is_recorded_and_evaluated_as_the_rig_ran_it(self):
        # At 20 mm/s, 3 ms are 60 um along a circle of 10 mm, and 0.2 um across it.
        self.describe([*PERFECT, *CROOKED, (r"(?m)^max_skew_ms = .*", "max_skew_ms = 3.0")])
        # A computer that does other work tears sets apart: they are flagged and left out, and what is left says the
        # same. Where too little is left the machine runs more slowly.
        for speed in (1, 0.3, 0.1):
            rig = self.serve(*COURSE, "--speed", speed)
            recorded = self.folder / f"circle_{speed}.csv"
            done = self.run_abbe("record", self.machine, "--devices", "machine,linkage", "--start", 4, "--seconds", 23,
                                 "--clock-speed", speed, "--passes-only", "-o", recorded)
            print(done.stdout, end="")
            self.assertIn("# simulated = true", recorded.read_text())
            good = [row for row in rows_of(recorded) if row["flags"] == 0]
            measured = self.circle(recorded) if len(good) > 300 else None
            if measured:
                gap = widest_gap(measured["runs"][0])
                print(f"at {speed} of the speed the widest gap is {gap:.0f} degrees")
                if gap < 12.0 and "D_um" in measured["runs"][0]:  # D is that of a whole circle
                    break
            rig.kill()
            rig.wait()
            (self.folder / "port").unlink()
        else:
            self.fail("no recording goes all round: every set is torn apart")
        self.assertLessEqual(max(row["skew_ms"] for row in good), 3.0)
        rig.send_signal(signal.SIGTERM)
        said = rig.stdout.read()
        rig.wait(20)
        self.assertIn("vcan0 node 1: pivot_1_rad, 16777216 counts a turn (linkage)", said)
        self.assertRegex(said, r"answered \d+ requests and \d+ SYNCs")

        truth = self.folder / "truth.csv"
        self.run_abbe("rig", "record", "--machine", self.machine, "--seed", 7, *COURSE, "--kind", "reference",
                      "--rate", 1000, "--out", truth)
        true = self.circle(truth)
        self.assertEqual(len(measured["runs"]), 1)
        ours, theirs = measured["runs"][0], true["runs"][0]
        self.assertAlmostEqual(measured["radius_mm"], true["radius_mm"], delta=0.1e-3)
        self.assertAlmostEqual(ours["feed_mm_min"], 1200.0, delta=1e-6)
        for figure in ("G_ccw_um", "G_cw_um", "G_b_um", "G_ccw_ls_um", "G_cw_ls_um", "D_um"):
            print(f"{figure}: {ours[figure]:.3f}, the rig's truth {theirs[figure]:.3f}")
            self.assertAlmostEqual(ours[figure], theirs[figure], delta=0.2, msg=figure)
        self.assertGreater(theirs["G_b_um"], 2.0)

    def test_a_course_may_run_from_the_start(self):
        self.describe([(r"(?m)^max_skew_ms = .*", "max_skew_ms = 400.0")])  # it stands for longer
        self.serve("--course", "stepping", "--points", 2, "--dwell", 0.5, "--feed", 3000, "--start", "course")
        recorded = self.folder / "stepping.csv"
        self.run_abbe("record", self.machine, "--devices", "machine,linkage", "--seconds", 4, "-o", recorded)
        rows = [row for row in rows_of(recorded) if row["flags"] == 0]
        self.assertEqual({row["pass"] for row in rows}, {0.0, 1.0})
        stops = {}
        for before, row, after in zip(rows, rows[1:], rows[2:]):
            if all(before[name] == row[name] == after[name] for name in ("pass", "x_mm", "y_mm", "z_mm")) and row["pass"]:
                place = tuple(min((17.5, 42.5), key=lambda at: abs(at - row[name])) for name in ("x_mm", "y_mm", "z_mm"))
                self.assertLess(max(abs(at - row[name]) for at, name in zip(place, ("x_mm", "y_mm", "z_mm"))), 1e-3)
                stops.setdefault(place, []).append(row["pivot_2_rad"])
        self.assertGreater(len(stops), 1)
        for angles in stops.values():
            self.assertLess(max(angles) - min(angles), 30e-6)  # ten deviations of the noise

    def test_a_node_that_is_absent_is_named_with_what_to_do(self):
        self.describe()
        both = self.machine.read_text()
        self.machine.write_text(re.sub(r"(?m)^  \{ id = 2, .*\n", "", both))  # the rig serves two of the three
        self.serve()
        self.machine.write_text(both)
        out = self.folder / "none.csv"
        done = self.abbe("record", self.machine, "--seconds", 1, "-o", out)
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        print(done.stderr, end="")
        for what in ("node 2", "pivot_2_rad", "vcan0", "check that"):
            self.assertIn(what, done.stderr)
        self.assertFalse(out.exists())

    def test_what_cannot_be_recorded_is_refused_in_one_line(self):
        self.describe()
        self.serve()
        for says, options in (("no table [devices.gauge]", ["--devices", "linkage,gauge"]),
                              ("cycle_start", ["--devices", "linkage", "--start", 4]),
                              ('a channel "pass"', ["--devices", "linkage", "--passes-only"])):
            out = self.folder / "refused.csv"
            done = self.abbe("record", self.machine, *options, "--seconds", 1, "-o", out)
            self.assertEqual(done.returncode, 2, (says, done.stderr))
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(says, done.stderr)
            self.assertFalse(out.exists())

    def test_an_interface_that_is_not_there_is_named_with_what_to_do(self):
        done = self.abbe("rig", "--machine", MILL, "--port", 0, "--can", "vcan7")
        self.assertEqual(done.returncode, 3, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("vcan7: there is no such CAN interface", done.stderr)


if __name__ == "__main__":
    unittest.main()
