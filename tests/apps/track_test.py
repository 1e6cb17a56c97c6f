#!/usr/bin/env python3
"""`abbe track` as a user runs it: a map of the rig a fortnight later, and what it refuses.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml track_test.py
"""
import json
import math
import pathlib
import random
import re
import unittest

from program_case import MACHINE, ProgramCase

DRIFT = """
[limits]
EYX = { straightness_um = 1.0 }
EAX = { range_urad = 60.0 }
volumetric_um = 40.0
XY = { circularity_um = 5.0 }
[drift]
straightness_um = 0.05
pitch_urad = 1.0
yaw_urad = 1.0
roll_urad = 1.0
smoothness_mm = 30.0
[drift.temperature.column]
lag_s = 3600.0
[rig.ageing]
straightness_um = 0.05
pitch_urad = 1.0
yaw_urad = 1.0
roll_urad = 1.0
lag_s = 3600.0
swing_c = 2.0
[rig.ageing.by_kelvin]
straightness_um = 0.1
scale_ppm = 12.0
"""


class TrackTest(ProgramCase):
    command = "track"

    @classmethod
    def machine_text(cls, drift=DRIFT):
        text = pathlib.Path(MACHINE).read_text().replace("step_mm = 1.0", "step_mm = 6.0")
        return text.replace("passes = 5", "passes = 2").replace("smoothness_mm = 15.0", "smoothness_mm = 30.0") + drift

    def record(self, name, *arguments):
        return self.rig_record(name, *arguments, "--rate", 50, machine=self.machine)

    def setUp(self):
        super().setUp()
        self.machine = self.path / "mill.toml"
        self.machine.write_text(self.machine_text())
        sweeps = [self.record(f"{axis}.csv", "--axis", axis, "--mounting", "A") for axis in "XYZ"]
        self.first = sweeps[0]
        self.line = self.record("line.csv", "--length", "X")
        self.map = self.path / "mill.map.toml"
        self.done(*sweeps, self.line, "--machine", self.machine, "--fixed-smoothness", "-o", self.map, command="fuse")

    def later(self, days, axis="X"):
        return self.record(f"{axis}_{days}.csv", "--axis", axis, "--mounting", "A", "--after-days", days)

    def test_a_short_test_narrows_the_map_and_every_command_reads_it(self):
        test = self.later(7)
        before = self.map.read_text()
        self.assertIn("[state]", before)
        result = self.result(self.map, test, "--machine", self.machine, "-o", self.map)
        self.assertNotEqual(before, self.map.read_text())
        self.assertEqual([one["test"] for one in result["tests"]], [test.name])
        one = result["tests"][0]
        self.assertGreater(one["agreement"]["p"], 1e-3)
        self.assertLess(one["U95_after_um"], one["U95_before_um"])
        self.assertEqual(list(result["temperatures"]), ["column"])
        # Only limits of what a map states.
        self.assertEqual([one["name"] for one in result["limits"]],
                         ["EYX.straightness_um", "EAX.range_urad", "volumetric_um"])
        part = self.path / "part.csv"
        part.write_text("x_mm,y_mm,z_mm\n20,20,30\n40,20,30\n")
        self.done(self.map, part, "--out", self.path / "corrected.csv", command="correct")
        self.done(self.map, "--format", "csv", "--points", 5, "--out", self.path / "map.csv", command="export")
        self.done(self.map, "--test", "circle", command="simulate")
        folder = self.path / "out"
        folder.mkdir()
        (folder / "track.json").write_text((self.path / "result.json").read_text())
        self.done(folder, command="report")

    def test_a_circle_and_three_lengths_are_a_short_test(self):
        circle = self.record("circle.csv", "--course", "circle", "--feed", 600, "--after-days", 3)
        lines = [self.record(f"line_{axis}.csv", "--length", axis, "--after-days", 4 + "XYZ".index(axis)) for axis in "XYZ"]
        result = self.result(self.map, circle, *lines, "--machine", self.machine, "--temperature", "column=20",
                             "-o", self.path / "later.map.toml")
        self.assertEqual([one["kind"] for one in result["tests"]], ["linkage", "length", "length", "length"])
        for one in result["tests"]:
            self.assertLessEqual(one["U95_after_um"], one["U95_before_um"] * 1.001, one)
        # Without a length of Y and Z their scales were those of the population: 20 ppm of 60 mm.
        self.assertLess(result["tests"][-1]["U95_after_um"], 0.7 * result["tests"][0]["U95_before_um"])

    def test_the_walk_is_learned_from_the_history(self):
        folder = self.path / "weeks"
        folder.mkdir()
        for week in range(1, 5):
            self.later(7 * week).rename(folder / f"week_{week}.csv")
        store = self.path / "history.db"
        self.done(folder, "--machine", self.machine, "--store", store, command="history add")
        learned = self.path / "learned.map.toml"
        text = self.done(self.map, "--machine", self.machine, "--learn", "--history", "--store", store, "-o", learned)
        self.assertIn("learned from the tests", text)
        self.assertIn("week_4.csv", text)
        self.assertIn("walk = [", learned.read_text())
        (folder / "week_2.csv").unlink()
        self.refuse(self.map, "--machine", self.machine, "--learn", "--history", "--store", store,
                    saying=["week_2.csv", "is no longer the recording"])

    def test_time_widens_and_a_temperature_moves(self):
        started = re.search(r'time = "(\d{4})', self.map.read_text())[1]
        at = ["--machine", self.machine, "--at", "30,20,10"]
        soon = self.result(self.map, *at, "--time", f"{int(started) + 1}-01-01T00:00:00Z", "--temperature", "column=20")
        late = self.result(self.map, *at, "--time", f"{int(started) + 2}-01-01T00:00:00Z", "--temperature", "column=20")
        warm = self.result(self.map, *at, "--time", f"{int(started) + 1}-01-01T00:00:00Z", "--temperature", "column=25")
        for k in range(3):
            self.assertGreater(late["at"]["U95_um"][k], soon["at"]["U95_um"][k])
            self.assertGreaterEqual(warm["at"]["U95_um"][k], soon["at"]["U95_um"][k])
        # Growth is not known yet: 12 ppm for each kelvin over 30 mm is in the U95 of X, and little else.
        first = float(re.search(r"lagged_c = ([\d.]+)", self.map.read_text())[1])
        grown = warm["at"]["U95_um"][0] ** 2 - soon["at"]["U95_um"][0] ** 2
        expected = (2 * 12e-6 * 30e3) ** 2 * ((25 - first) ** 2 - (20 - first) ** 2)
        self.assertAlmostEqual(grown / expected, 1.0, delta=0.1)
        self.assertEqual(warm["tests"], [])

    def test_next_names_the_shortest_test_that_keeps_the_limits(self):
        text = self.done(self.map, "--machine", self.machine, "--next", self.first, "--next", self.line, "--days", 100)
        self.assertRegex(text, r"EYX\.straightness_um +1 ")
        self.assertRegex(text, r"next: .*X\.csv|no test is needed|none of these tests")

    def test_bad_input(self):
        machine = ["--machine", self.machine]
        self.refuse(self.map, self.first, *machine, saying=["X.csv", "a clock jumped back, or the test is part of the map"])
        self.refuse(self.map, *machine, "--time", "2000-01-01T00:00:00Z", saying=["a clock jumped back"])
        self.refuse(self.map, *machine, "--time", "tomorrow", saying=["--time tomorrow", "is no instant"])
        self.refuse(self.map, *machine, "--temperature", "spindle=30", saying=['no temperature "spindle"', "it follows column"])
        self.refuse(self.map, *machine, "--temperature", "spindle", saying=["NAME=DEGREES"])
        test = self.later(7)
        other = self.path / "other.csv"
        other.write_text(test.read_text().replace('machine = "demo-mill"', 'machine = "lathe"'))
        self.refuse(self.map, other, *machine, saying=["other.csv", "lathe"])
        bare = self.path / "bare.map.toml"
        text = self.map.read_text()
        bare.write_text(text[:text.index("[covariance]")])
        self.refuse(bare, test, *machine, saying=["has no covariance"])
        stale = self.path / "stale.map.toml"
        stale.write_text(text[:text.index("[state]")])
        self.refuse(stale, test, *machine, saying=["when it was measured", "--measured"])
        self.done(stale, test, *machine, "--measured", "2026-01-01T00:00:00Z", "--then", "column=20")
        broken = self.path / "broken.map.toml"
        broken.write_text(text.replace("[state]\ntime = ", "[state]\ntime = 5 #"))
        self.refuse(broken, test, *machine, saying=["broken.map.toml", "time"])
        wrong = self.path / "wrong.toml"
        wrong.write_text(self.machine_text(DRIFT.replace("EYX =", "EQX =")))
        self.refuse(self.map, test, "--machine", wrong, saying=["wrong.toml", "EQX", "there is no such error"])
        still = self.path / "still.toml"
        still.write_text(self.machine_text())
        still.write_text(self.machine_text(DRIFT.replace("straightness_um = 0.05\npitch_urad = 1.0\nyaw_urad = 1.0\nroll_urad = 1.0\n", "", 1)))
        self.refuse(self.map, test, "--machine", still, saying=["nothing says how much the machine changes", "--learn"])
        jumps = self.path / "jumps.csv"
        lines = test.read_text().splitlines()
        head = max(i for i, line in enumerate(lines) if line.startswith("#")) + 1
        lines[head + 5], lines[head + 40] = lines[head + 40], lines[head + 5]
        jumps.write_text("\n".join(lines) + "\n")
        self.refuse(self.map, jumps, *machine, saying=["jumps.csv", "row"])
        shorn = self.path / "shorn.csv"
        shorn.write_text(test.read_text().replace("temp_column_c", "temp_else_c"))
        self.refuse(self.map, shorn, *machine, saying=["no column temp_column_c", "--temperature column=DEGREES"])
        self.refuse(self.map, test, *machine, "--learn", saying=["--learn takes at least 4"])

    def changed(self, test, name, probes, change):
        """The recording with `change(x)` um in the gaps of some probes."""
        lines = test.read_text().splitlines()
        head = max(i for i, line in enumerate(lines) if line.startswith("#")) + 1
        names = lines[head].split(",")
        x = names.index("x_mm")
        for i in range(head + 1, len(lines)):
            cells = lines[i].split(",")
            for probe in probes:
                at = names.index(f"probe_{probe}_um")
                cells[at] = str(float(cells[at]) + change(float(cells[x])))
            lines[i] = ",".join(cells)
        changed = self.path / name
        changed.write_text("\n".join(lines) + "\n")
        return changed

    def test_a_collision_is_no_drift(self):
        test = self.later(7)
        # A bow of EZX by 3 um, where a week of drift makes 0.13 um.
        bow = self.changed(test, "bow.csv", "abc", lambda x: 3.0 * math.sin(math.pi * x / 60.0) ** 2)
        self.refuse(self.map, bow, "--machine", self.machine, saying=["bow.csv", "contradicts the map", "collision"])
        # One probe that steps: no motion of the machine does that.
        step = self.changed(test, "step.csv", "a", lambda x: 20.0 if x > 30.0 else 0.0)
        self.refuse(self.map, step, "--machine", self.machine, saying=["step.csv", "times the noise", "diagnose"])
        self.done(self.map, test, "--machine", self.machine)


class FollowTest(ProgramCase):
    command = "follow"

    def series(self, change=lambda row, value: value):
        """A gap that follows a column by -2 um for each kelvin, 300 s later."""
        draw, lines, lagged = random.Random(8), ['# abbe-recording = 1', '# kind = "dwell"', "time_s,probe_a_um,temp_column_c"], 20.0
        for second in range(0, 7200):
            column = 20.0 + 6.0 * (1.0 - math.exp(-second / 1500)) + 0.5 * math.sin(second / 200)
            lagged += (column - lagged) / 300
            if second % 30 == 0:
                value = change(second // 30, 100 - 2 * lagged + draw.gauss(0, 0.05))
                lines.append(f"{second},{value:.4f},{column:.4f}")
        path = self.path / "warm_up.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_gain_and_lag_are_found(self):
        result = self.result(self.series(), "--value", "probe_a_um")
        column = result["sensors"][0]
        self.assertAlmostEqual(column["gain_per_c"], -2.0, delta=2 * column["U95_per_c"])
        self.assertLess(column["U95_per_c"], 0.1)
        self.assertAlmostEqual(column["lag_s"] / 300, 1.0, delta=0.1)
        self.assertLess(result["held_out"]["rms"], 0.1)
        self.assertGreater(result["held_out"]["within_U95"], 0.88)

    def test_bad_input(self):
        self.refuse(self.series(lambda row, value: value + (500 if row > 100 else 0)), "--value", "probe_a_um",
                    saying=["warm_up.csv", "row 102", "jumps by", "lost steps"])
        self.refuse(self.series(), "--value", "probe_z_um", saying=["warm_up.csv", "probe_z_um"])
        self.refuse(self.series(), "--value", "probe_a_um", "--sensor", "room", saying=["temp_room_c"])


if __name__ == "__main__":
    unittest.main()
