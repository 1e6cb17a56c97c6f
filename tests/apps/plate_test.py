#!/usr/bin/env python3
"""`abbe plate` as a script sees it: the rig's plate in five set-ups becomes 21 errors, held against the rig's truth.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml plate_test.py
"""
import json
import math
import unittest

from program_case import MACHINE, ProgramCase

HEADER = '# abbe-recording = 1\n# kind = "plate"\n# u_probing_um = 0.5\n'
NAMES = "x_mm,y_mm,z_mm,setup,hole,plate_x_mm,plate_y_mm\n"
# Three holes of a plate in XY: the table carries it, so the axes go the other way.
ROWS = ["50,50,30,1,1,0,0", "10,50,30,1,2,40,0", "50,10,30,1,3,0,40"]
MOTIONS = [f"E{motion}{axis}" for axis in "XYZ" for motion in "XYZABC"]


class PlateTest(ProgramCase):
    command = "plate"

    def write(self, rows, header=HEADER, names=NAMES):
        path = self.path / "holes.csv"
        path.write_text(header + names + "\n".join(rows) + "\n")
        return path

    def test_five_set_ups_give_21_errors(self):
        truth_file = self.path / "truth.json"
        plate = self.rig_record("plate.csv", "--plate", "--truth", truth_file)
        line = self.rig_record("line.csv", "--length", "X")
        map_file, json_file = self.path / "map.toml", self.path / "plate.json"
        text = self.done(plate, "--machine", MACHINE, "--fixed-smoothness", "--holdout", 4, "--specimen", line,
                         "-o", map_file, "--json", json_file)
        for words in ("by diagonals", "network with bias", "specimen", "calibrated", "plate.csv set-up 5"):
            self.assertIn(words, text)
        self.assertNotIn("prior only", text)
        result, truth = json.loads(json_file.read_text()), json.loads(truth_file.read_text())
        self.assertTrue(result["simulated"])
        self.assertEqual(sorted(result["errors"]), sorted(MOTIONS))
        pulls = []
        for name, curve in result["errors"].items():
            axis = truth["axes"][name[-1]]
            for at, value, u in zip(curve["stations"], curve["value"], curve["u"]):
                there = [t for x, t in zip(axis["stations_m"], axis[name]) if abs(x - at) < 1e-9]
                if there and u > 0:
                    pulls.append((value - there[0]) / u)
        self.assertGreater(len(pulls), 18 * 6)
        # 12 stations of 18 smooth functions are some 70 independent numbers: 1 +- 0.1, widely.
        self.assertLess(abs(math.sqrt(sum(p * p for p in pulls) / len(pulls)) - 1), 0.5)
        for name, found in result["squareness"].items():
            off = found["value"] - truth["squareness"][name]
            self.assertLess(abs(off), 4 * found["u"], name)
            # Of the same machine by four holes of the same readings: off by no more than it says,
            # and never known better than by all holes.
            by = found["diagonals"]
            self.assertLess(abs(by["value"] - truth["squareness"][name]), 4 * by["u"], name)
            self.assertGreaterEqual(by["u"], found["u"], name)
            # Below what was known before: the tolerance of the machine file.
            self.assertLess(by["u"], 30e-6, name)
        before = sum((s["before_mm"] - s["length_mm"]) ** 2 for s in result["specimen"])
        after = sum((s["after_mm"] - s["length_mm"]) ** 2 for s in result["specimen"])
        self.assertLess(after, before / 4)
        for s in result["specimen"]:  # two steps of 0.1 um each, a scale of 2 ppm, and what the map leaves
            u = math.hypot(s["u_um"], 0.1 * math.sqrt(2), 2e-3 * s["length_mm"])
            self.assertLess(abs(1e3 * (s["after_mm"] - s["length_mm"])), 4 * u, s)
        self.assertLess(result["interpolation"]["b-spline"]["heldout_rms_um"], 1.2)
        self.done(map_file, "--format", "csv", command="export")

        # abbe fuse takes the same recording and finds the same machine.
        fused = self.path / "fuse.json"
        self.done(plate, "--machine", MACHINE, "--fixed-smoothness", "-o", map_file, "--json", fused, command="fuse")
        for name, seen in json.loads(fused.read_text())["observability"].items():
            self.assertEqual(seen, result["observability"][name])

    def test_networks_can_be_written(self):
        plate = self.rig_record("plate.csv", "--plate")
        map_file = self.path / "map.toml"
        self.done(plate, "--machine", MACHINE, "--fixed-smoothness", "--network", "--quiet", "-o", map_file)
        text = map_file.read_text()
        self.assertIn('form = "network with bias"', text)
        self.assertNotIn("[covariance]", text)

    def test_too_few_set_ups_leave_errors_to_the_prior(self):
        text = self.done(self.write(ROWS), "--machine", MACHINE, "--fixed-smoothness", "-o", self.path / "map.toml")
        rows = {line.split()[0]: line for line in text.splitlines() if line}
        for motion in "XYZABC":
            self.assertIn("prior only", rows[f"E{motion}Z"])
        self.assertIn("prior only", rows["A0Z"])

    def test_refusals_take_one_line(self):
        machine = ("--machine", MACHINE, "-o", self.path / "map.toml")
        without = [row.rsplit(",", 1)[0] for row in ROWS]
        self.refuse(self.write(without, names=NAMES.replace(",plate_y_mm", "")), *machine,
                    saying=["holes.csv:4: plate_y_mm", "is missing"])
        flat = [",".join(word for i, word in enumerate(row.split(",")) if i != 2) for row in ROWS]
        self.refuse(self.write(flat, names=NAMES.replace("z_mm,", "")), *machine, saying=["holes.csv", "z_mm"])
        self.refuse(self.write(ROWS + ["12,10,30,2,3,41,40"]), *machine,
                    saying=["holes.csv: row 4: hole 3 is at 41.0000, 40.0000 mm here and at 0.0000, 40.0000 mm in row 3"])
        self.refuse(self.write(ROWS[:2]), *machine, saying=["holes.csv set-up 1: 2 holes do not say how the plate lay"])
        self.refuse(self.write(ROWS[:2] + ["50,17,30,1,3,0,40"]), *machine,
                    saying=["holes.csv set-up 1: row", "correct the numbers of holes"])
        self.refuse(self.write(ROWS, HEADER + "# [setup.2]\n# tool_mm = [0.0, 0.0, -50.0]\n"), *machine,
                    saying=["row 1: the header knows no set-up 1; add [setup.1]"])
        self.refuse(self.write(ROWS, HEADER.replace("# u_probing_um = 0.5\n", "")), *machine,
                    saying=["state u_probing_um above 0"])
        self.refuse(self.write(ROWS, HEADER + '# machine = "other"\n'), *machine, saying=['the machine "other"'])
        self.refuse(self.write(ROWS[:2] + ["50,-10,30,1,3,0,60"]), *machine, saying=["row 3: y = -10.0000 mm lies outside"])
        self.refuse(self.write(ROWS), "--holdout", 2, *machine, saying=["holes are left when some are held out"])
        line = self.rig_record("line.csv", "--length", "X")
        self.refuse(line, *machine, saying=["kind is \"length\", not \"plate\""])

    def test_a_table_of_holes_becomes_a_recording(self):
        table = self.path / "holes.txt"
        table.write_text("Plug Plate: 1\n\n  Meas X  Meas Y  Nom X  Nom Y\n" +
                         "".join(f"{x + 30} {y + 30} {x} {y}\n" for x in (-20, 0, 20) for y in (-20, 0, 20)))
        self.done(table, self.path / "plain.csv", command="convert")
        machine = ("--machine", MACHINE, "--fixed-smoothness", "-o", self.path / "map.toml")
        self.refuse(self.path / "plain.csv", *machine, saying=["state u_probing_um"])
        self.done(table, self.path / "stated.csv", "--probing-um", 3, command="convert")
        self.done(self.path / "stated.csv", *machine)
        # A measuring machine has neither head nor devices.
        alone = self.path / "cmm.toml"
        alone.write_text('name = "cmm"\nchain = "[w b Y X Z t]"\n' +
                         "".join(f"[axis.{axis}]\ntravel_mm = [0.0, 60.0]\n" for axis in "XYZ") +
                         "[population]\nsmoothness_mm = 30.0\n")
        self.done(self.path / "stated.csv", "--machine", alone, "-o", self.path / "map.toml")
        alone.write_text(alone.read_text() + "smothness_mm = 30.0\n")
        self.refuse(self.path / "stated.csv", "--machine", alone, saying=["cmm.toml", "smothness_mm", "smoothness_mm"])


if __name__ == "__main__":
    unittest.main()
