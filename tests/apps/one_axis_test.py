#!/usr/bin/env python3
"""A machine of one axis: written, recorded, reduced, fused and diagnosed like any other.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml one_axis_test.py
"""
import json
import math
import pathlib
import random
import re
import unittest

from program_case import MACHINE, ProgramCase

LAG = 1.5e-3  # s


def one_axis(text):
    """The demonstration machine without Y and Z, and without the linkage, which needs them."""
    text = re.sub(r'(?m)^chain = .*', 'chain = "[w X b t]"', text)
    for table in (r"axis\.[YZ]", r"sweep\.[YZ]", r"head\.axis_[YZ]", r"linkage[^\]]*", r"devices\.linkage"):
        text = re.sub(rf"(?ms)^\[{table}\]\n.*?(?=^\[|\Z)", "", text)
    return re.sub(r'(?m)^.*"[yz]_mm".*\n', "", text)


class OneAxisTest(ProgramCase):
    command = "diagnose"

    def setUp(self):
        super().setUp()
        self.machine = self.path / "stage.toml"
        text = one_axis(pathlib.Path(MACHINE).read_text())
        self.machine.write_text(text.replace("step_mm = 1.0", "step_mm = 4.0").replace("passes = 5", "passes = 3"))

    def sweep(self, *arguments):
        return self.rig_record("x.csv", "--axis", "X", "--rate", 50, "--truth", self.path / "truth.json", *arguments,
                               machine=self.machine)

    def test_a_sweep_is_reduced_to_its_errors(self):
        recording, result_file = self.sweep(), self.path / "x.json"
        self.done(recording, "--machine", self.machine, "--json", result_file, command="reduce")
        result = json.loads(result_file.read_text())
        self.assertEqual(result["chain"], "[w X b t]")
        compared = self.done(self.path / "truth.json", result_file, command="rig compare")
        self.assertIn("EYX", compared)
        self.assertEqual(list(json.loads((self.path / "truth.json").read_text())["axes"]), ["X"])

    def test_fusing_gives_a_map_of_the_axis(self):
        map_file = self.path / "map.toml"
        text = self.done(self.sweep(), "--machine", self.machine, "-o", map_file, "--fixed-smoothness", command="fuse")
        self.assertIn("EYX", text)
        self.assertIn('chain = "[w X b t]"', map_file.read_text())
        run = self.run_program(map_file, "--test", "circle", command="simulate")
        self.assertEqual(run.returncode, 2)
        self.assertIn("the machine has no axis Y", run.stderr)
        run = self.run_program(map_file, "--format", "linuxcnc", command="export")
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertIn("map.toml: the machine has no axis Y", run.stderr)

    def late(self, columns):
        """X to and fro at two feeds before an instrument that sees it LAG behind; other axes stand at 30 mm."""
        draw = random.Random(4)
        lines = ['# abbe-recording = 1', '# kind = "reference"', f'# machine = "demo-mill"', '# u_reference_um = 0.2',
                 ",".join(["time_s", *columns, "pass", "direction", "ref_x_mm"])]
        time, step = 0.0, 0.1
        for number in range(12):
            sense, speed = (1, -1)[number % 2], (10.0, 25.0)[number // 2 % 2]
            for row in range(int(40.0 / (speed * step)) + 1):
                x = 30 + sense * (-20 + speed * step * row)
                seen = x - sense * speed * LAG + 2e-3 * math.sin(x / 9) + draw.gauss(0, 0.2e-3)
                lines.append(",".join(f"{value:.7f}" for value in (time, x, *[30.0] * (len(columns) - 1))) +
                             f",{number // 2 + 1},{sense},{seen:.7f}")
                time += step
            time += 2.0
        path = self.path / "late.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_a_lag_is_found_and_not_its_own_rival(self):
        """A mismatch of X and an axis that stands is the lag of X, twice named: no candidate."""
        for machine, columns in ((self.machine, ["x_mm"]), (MACHINE, ["x_mm", "y_mm", "z_mm"])):
            result = self.result(self.late(columns), "--machine", machine)
            found = {f'{one["cause"]}:{one["object"]}': one for one in result["findings"]}
            self.assertEqual(list(found), ["servo-lag:X"], result)
            delay, = [key for key in found["servo-lag:X"]["parameters"] if key["name"] == "delay_ms"]
            self.assertAlmostEqual(delay["value"], 1e3 * LAG, delta=delay["u95"])
            for group in result["rivals"]:
                self.assertFalse([name for name in group["causes"] if "mismatch" in name], group)
            standing = {name for name in result["cannot_show"] if re.search(":[XYZ]{2}$", name)}
            self.assertEqual(bool(standing), len(columns) > 1)
            if standing:
                self.assertLessEqual({"servo-lag-mismatch:XY", "servo-lag-mismatch:XZ", "servo-lag-mismatch:YZ"}, standing)

    def test_what_does_not_fit_the_chain_is_refused(self):
        recording = self.sweep()
        good = self.machine.read_text()
        self.machine.write_text(good + "[axis.Y]\ntravel_mm = [0.0, 60.0]\n")
        self.refuse(recording, "--machine", self.machine, saying=["stage.toml", "axis.Y", "is not an axis of the chain [w X b t]"])
        self.machine.write_text(good + "[sweep.Z]\nfirst_mm = 0.0\nlast_mm = 60.0\nstep_mm = 1.0\n")
        self.refuse(recording, "--machine", self.machine, saying=["stage.toml", "sweep.Z", "is not an axis of the chain [w X b t]"])
        self.machine.write_text(good.replace("[w X b t]", "[w b t]"))
        self.refuse(recording, "--machine", self.machine, saying=["names none of the axes"])
        self.machine.write_text(good)
        # A recording that says where Y stood.
        lines = recording.read_text().splitlines()
        names = next(line for line in lines if line[0] != "#").split(",")
        moved = [line if line[0] == "#" or line.split(",") == names else
                 ",".join("30.0" if name == "y_mm" else word for name, word in zip(names, line.split(",")))
                 for line in lines]
        recording.write_text("\n".join(moved) + "\n")
        self.refuse(recording, "--machine", self.machine, saying=["x.csv", "y = 30", "lies outside the travel"])


if __name__ == "__main__":
    unittest.main()
