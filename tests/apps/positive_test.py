#!/usr/bin/env python3
"""Which way a control counts, as a user meets it: the machine file must say it, the virtual rig counts
that way, and `abbe correct` moves the right way with tables that were made by hand.

    ABBE=path/to/abbe ABBE_MACHINE=machines/demo_mill.toml positive_test.py
"""
import json
import pathlib
import re
import unittest

import numpy as np

from map_machine import MapMachine
from program_case import MACHINE, ProgramCase


def counted(text, word):
    """The demonstration machine, its X and Y counted so."""
    text = text.replace('positive = "carriage"', f'positive = "{word}"')
    if word == "tool":
        text = re.sub(r"(\[axis\.[XY]\]\ntravel_mm = )\[0.0, 60.0\]", r"\1[-60.0, 0.0]", text)
        text = re.sub(r"(\[sweep\.[XY]\]\n)first_mm = 0.0\nlast_mm = 60.0", r"\1first_mm = -60.0\nlast_mm = 0.0", text)
    return text


class PositiveTest(ProgramCase):
    command = "reduce"

    def test_a_file_that_does_not_say_it_is_refused_with_what_to_write(self):
        silent = self.path / "silent.toml"
        silent.write_text(pathlib.Path(MACHINE).read_text().replace('positive = "carriage"\n', "", 1))
        recording = self.rig_record("x.csv", "--axis", "X")
        line = silent.read_text().splitlines().index("[axis.X]") + 1
        self.refuse(recording, "--machine", silent,
                    saying=[f"silent.toml:{line}: axis.X.positive: is missing", 'write positive = "tool"', "ISO 841"])

    def test_a_sweep_is_right_whichever_way_it_counts(self):
        for word in ("carriage", "tool"):
            machine, truth = self.path / f"{word}.toml", self.path / f"{word}.json"
            machine.write_text(counted(pathlib.Path(MACHINE).read_text(), word))
            for axis in "XY":
                sweep = self.rig_record(f"{word}_{axis}.h5", "--axis", axis, "--truth", truth, machine=machine)
                result = self.result(sweep, "--machine", machine)
                self.assertEqual((result["positive"], result["moves"]), (word, "target"))
                self.assertAlmostEqual(result["stations"][0], -0.06 if word == "tool" else 0.0, 7)
                stations, true = np.array(result["stations"]), json.loads(truth.read_text())["axes"][axis]
                for name, error in result["errors"].items():
                    off = np.array(error["value"]) - np.interp(stations, true["stations_m"], true[name])
                    off -= np.polyval(np.polyfit(stations, off, 1), stations) if name[1] in "XYZ" else off[0]
                    self.assertLess(np.abs(off).max(), 5 * np.max(error["u"]), (word, name))

    def write_table(self, sections):
        table = self.path / "hand.etalon"
        table.write_text("".join(f"[{name}]\nGridpoints = {{\n" + "".join(f"{x} {value}\n" for x, value in points) + "}\n"
                                 for name, points in sections.items()))
        return table

    def corrected(self, table, point, *options):
        """Where the axes are sent, in um from where the program says."""
        program = self.path / "part.ngc"
        program.write_text("G21 G90\nG0 X{} Y{} Z{}\n".format(*point))
        self.done(table, program, "--out", self.path / "out.ngc", "--quiet", *options, command="correct")
        words = re.findall(r"[XYZ](-?[\d.]+)", (self.path / "out.ngc").read_text())
        return 1e3 * (np.array(list(map(float, words))) - point)

    def test_correct_goes_the_right_way_with_a_table_made_by_hand(self):
        ends = {name: [(0, 0), (100, 0)] for name in ("EXX", "EYY", "EZZ")}
        # 10 um at X 50: the axis stands further along its count, whatever carries what.
        table = self.write_table({**ends, "EXX": [(0, 0), (50, 0.010), (100, 0.010)], "EYX": [(0, 0), (50, 0.004), (100, 0.004)]})
        for chain, positive, expected in (
                # Axes of the tool: + is the tool towards +, so it is sent towards -.
                ("[w b X Y Z t]", (), (-10, -4, 0)),
                # X carries the workpiece and counts as its carriage goes: the workpiece stands 4 um towards +Y,
                # the tool 4 um towards -Y in it, and Y sends the tool towards +.
                ("[w X b Y Z t]", ("--positive", "carriage"), (-10, 4, 0)),
                # X counts as the tool goes: EXX along the count, EYX of the carriage.
                ("[w X b Y Z t]", ("--positive", "tool"), (-10, 4, 0))):
            off = self.corrected(table, (60, 50, 50), "--chain", chain, *positive)
            np.testing.assert_allclose(off, expected, atol=2e-3, err_msg=f"{chain} {positive}")
        self.command = "correct"
        self.refuse(table, self.path / "part.ngc", "--chain", "[w X b Y Z t]", saying=["which way X counts", "--positive"])

    def test_measured_coordinates_follow_the_count_of_the_map(self):
        places = np.random.default_rng(2).uniform(0.001, 0.059, (20, 3))
        table = self.path / "read.csv"
        table.write_text("x_mm,y_mm,z_mm\n" + "".join("{!r},{!r},{!r}\n".format(*map(float, 1e3 * p)) for p in places))
        for chain in ("[w X Y b Z t]", "[w Y b X Z t]", "[w Z X b Y t]"):
            for positive in ("carriage", "tool", "tool carriage tool"):
                machine = MapMachine(4, chain, positive=positive)
                self.done(machine.write(self.path / "map.toml"), table, "--out", self.path / "out.csv", command="correct")
                found = np.loadtxt(self.path / "out.csv", delimiter=",", skiprows=1)
                np.testing.assert_allclose(found, 1e3 * np.array([machine.made(p) for p in places]), atol=1e-10)

    def test_a_zero_that_was_touched_off_stays(self):
        machine = MapMachine(3, size=4.0)
        table, zero, place = machine.write(self.path / "map.toml"), np.array([30, 25, 20]), np.array([50, 45, 50])
        self.assertGreater(np.abs(self.corrected(table, zero)).max(), 3.0)
        keep = ("--zero", ",".join(map(str, zero)))
        np.testing.assert_allclose(self.corrected(table, zero, *keep), 0.0, atol=1e-3)
        # Any other place has its true distance from the zero, on the machine as it is.
        sent = 1e-3 * place + 1e-6 * self.corrected(table, place, *keep)
        np.testing.assert_allclose(machine.made(sent) - machine.made(1e-3 * zero), 1e-3 * (place - zero), atol=2e-9)

    def test_the_end_of_a_travel_can_be_corrected_as_far_as_the_soft_limit(self):
        machine = MapMachine(5, size=2.0)
        table = machine.write(self.path / "map.toml")
        ends = [np.array([x, y, z]) for x in (0, 60) for y in (0, 60) for z in (0, 60)]
        sent = {tuple(end): self.corrected(table, end) for end in ends}
        beyond = [end for end in ends if np.any((sent[tuple(end)] > 0) & (end == 60) | (sent[tuple(end)] < 0) & (end == 0))]
        self.assertTrue(beyond)
        # A control whose soft limits are the travel itself.
        hard = self.path / "hard.toml"
        hard.write_text(table.read_text().replace("[travel]\n", "".join(
            ["[limit]\n"] + [f"{k} = [0.0, 0.06]\n" for k in "xyz"] + ["[travel]\n"]), 1))
        (self.path / "part.ngc").write_text("G21 G90\nG0 X{} Y{} Z{}\n".format(*beyond[0]))
        self.command = "correct"
        self.refuse(hard, self.path / "part.ngc", saying=["part.ngc", "line 2", "beyond the soft limits", "limit_mm"])


if __name__ == "__main__":
    unittest.main()
