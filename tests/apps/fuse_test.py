#!/usr/bin/env python3
"""`abbe fuse` as a script sees it: recordings of the virtual rig become one map, held against the rig's truth.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml fuse_test.py
"""
import json
import pathlib
import unittest

import numpy as np

from program_case import MACHINE, ProgramCase


class FuseTest(ProgramCase):
    command = "fuse"

    def record(self):
        """A small campaign: sweeps at 5 mm, the linkage at 125 places, one line of lengths."""
        text = pathlib.Path(MACHINE).read_text().replace("step_mm = 1.0", "step_mm = 5.0")
        text = text.replace("passes = 5", "passes = 2")
        self.machine = self.path / "machine.toml"
        self.machine.write_text(text)
        make = lambda name, *arguments: self.rig_record(name, *arguments, machine=self.machine)
        sweeps = [make(f"{axis}.csv", "--axis", axis, "--mounting", "A", "--rate", 50, "--truth",
                       self.path / "truth.json") for axis in "XYZ"]
        volume = make("volume.csv", "--course", "cube", "--size", "58,58,58", "--points", "5,5,5",
                      "--dwell", 0.1, "--feed", 6000)
        return [*sweeps, volume, make("line.csv", "--length", "X")]

    def same_as_the_table(self, result, table):
        """The map in the result is that of `abbe export`: x_mm,y_mm,z_mm, errors and U95 in um."""
        self.assertEqual((result["command"], result["chain"]), ("fuse", "[w X Y b Z t]"))
        rows = np.array([line.split(",") for line in table.read_text().splitlines()
                         if line[0] not in "#x"], float)
        grid = result["map"]["grid"]
        z, y, x = np.meshgrid(grid["z"], grid["y"], grid["x"], indexing="ij")
        ours = np.array([x.ravel() * 1e3, y.ravel() * 1e3, z.ravel() * 1e3,
                         *(1e6 * np.array(grid["error"])), *(2e6 * np.array(grid["u"]))]).T
        np.testing.assert_allclose(ours, rows[:, :9], rtol=1e-4, atol=1e-5)
        errors = result["map"]["errors"]
        self.assertEqual(len(errors), 21)
        for name, error in errors.items():
            self.assertEqual(np.ravel(error["value"]).shape, np.ravel(error["u"]).shape, name)
            self.assertGreater(np.max(error["u"]), 0.0, name)

    def test_recordings_of_two_balls_are_refused(self):
        runs = []
        for number in "12":
            runs.append(self.rig_record(f"cube_{number}.csv", "--course", "cube", "--size", "40,40,40", "--points",
                                        "2,2,2", "--dwell", 0.05, "--feed", 6000))
            text = runs[-1].read_text()
            runs[-1].write_text(text.replace('kind = "linkage"', f'kind = "linkage"\n# mounting = {{ ball = "{number}" }}', 1))
        self.refuse(*runs, "--machine", MACHINE, "-o", self.path / "map.toml",
                    saying=["cube_2.csv", 'mounting.ball is "2", and "1" in', "one ball at a time"])

    def test_a_copy_of_a_recording_would_count_twice(self):
        run = self.rig_record("line.csv", "--length", "X")
        copy = self.path / "line again.csv"
        copy.write_bytes(run.read_bytes())
        self.refuse(run, copy, "--machine", MACHINE, "-o", self.path / "map.toml",
                    saying=["line again.csv: is a copy of", "line.csv", "would count twice"])
        diagnosis = self.run_program(run, run, "--machine", MACHINE, command="diagnose")
        self.assertEqual(diagnosis.returncode, 2)
        self.assertIn("is given twice", diagnosis.stderr)

    def test_a_squareness_without_a_prior_is_refused_with_its_line(self):
        machine = self.path / "square.toml"
        machine.write_text(pathlib.Path(MACHINE).read_text().replace("squareness_urad = 30.0", "squareness_urad = 0.0", 1))
        line = machine.read_text().splitlines().index("squareness_urad = 0.0") + 1
        sweep = self.rig_record("X.csv", "--axis", "X", "--rate", 20)
        self.refuse(sweep, "--machine", machine, saying=[f"square.toml:{line}: population.squareness_urad", "above 0"])

    def test_a_zero_that_moves_is_taken_out_and_told(self):
        """Of one probe, in one of three sweeps: a step at 40 % of the time, a warming up within a quarter of it."""
        runs = self.record()[:3]
        plain = self.path / "plain.json"
        self.done(*runs, "--machine", self.machine, "--json", plain)
        self.assertEqual(json.loads(plain.read_text())["notes"], [])
        before = json.loads(plain.read_text())["map"]["errors"]
        for move, words in ((lambda share: 1.0 * (share > 0.4), "the zero of probe_b jumps by "),
                            (lambda share: 1.5 * (1 - np.exp(-4 * share)), "the zero of probe_b drifts like one that warms up, by ")):
            lines = runs[0].read_text().splitlines()
            head = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
            column = lines[head].split(",").index("probe_b_um")
            rows = [line.split(",") for line in lines[head + 1:]]
            for i, row in enumerate(rows):
                row[column] = repr(float(row[column]) + move(i / len(rows)))
            moved = self.path / "moved.csv"
            moved.write_text("\n".join([*lines[:head + 1], *(",".join(row) for row in rows)]) + "\n")
            found = self.path / "moved.json"
            text = self.done(moved, *runs[1:], "--machine", self.machine, "--json", found)
            self.assertIn("moved.csv: " + words, text.replace("\n", " "))
            result = json.loads(found.read_text())
            self.assertEqual(len(result["notes"]), 1, result["notes"])
            self.assertEqual(result["contradictions"] + result["misfits"], [])
            for name in ("EAX", "EBX", "EYX", "EZX"):
                now, then = result["map"]["errors"][name], before[name]
                off = np.abs(np.subtract(now["value"], then["value"]))
                self.assertTrue(np.all(off < 2 * np.array(now["u"]) + 1e-12), (name, off))
                self.assertTrue(np.all(np.array(now["u"]) < 1.5 * np.array(then["u"]) + 1e-12), name)

    def test_a_campaign_becomes_a_map(self):
        runs = self.record()
        map_file = self.path / "map.toml"
        json_file = self.path / "fuse.json"
        text = self.done(*runs, "--machine", self.machine, "-o", map_file, "--json", json_file)
        self.assertIn("calibrated", text)
        self.assertNotIn("PRIOR ONLY", text)
        result = json.loads(json_file.read_text())
        self.assertEqual(result["contradictions"], [])
        self.assertTrue(result["simulated"])
        self.assertEqual([run["kind"] for run in result["chi2"]], 3 * ["sweep"] + ["linkage", "length"])
        self.assertEqual(len(result["observability"]), 21)
        truth = json.loads((self.path / "truth.json").read_text())
        for parameter in result["parameters"]:
            block, _, name = parameter["name"].partition(".")
            if block != "squareness":
                continue
            off = parameter["value"] - 1e6 * truth["squareness"][name]
            self.assertLess(abs(off), 4 * parameter["uncertainty"], parameter)
            self.assertLess(parameter["uncertainty"], 4.0)  # 30 urad before the data
        self.assertEqual(result["misfits"], [])
        self.assertNotIn("held_out", result)
        self.done(map_file, "--format", "csv", "--points", 11, command="export")
        self.same_as_the_table(result, map_file.with_suffix(".csv"))

        without = self.path / "without.json"
        text = self.done(*runs[:4], "--machine", self.machine, "-o", map_file, "--json", without)
        self.assertIn("PRIOR ONLY; give a run of kind length", text)
        self.assertEqual(json.loads(without.read_text())["scale"]["statement"], "prior only")

        held = self.path / "held.json"
        text = self.done(*runs, "--machine", self.machine, "-o", map_file, "--json", held, "--holdout", 4)
        self.assertIn("held out, predicted", text)
        for run in json.loads(held.read_text())["held_out"]:
            self.assertAlmostEqual(run["chi2"] / run["expected"], 1.0, delta=4 * (2 / run["rows"]) ** 0.5, msg=run)
        self.refuse(*runs, "--machine", self.machine, "--holdout", 1, saying=["hold out every 2nd or fewer"])

    def test_what_does_not_belong_together_is_said(self):
        runs = self.record()
        map_file, json_file = self.path / "map.toml", self.path / "fuse.json"
        # An axis without a run.
        text = self.done(runs[0], runs[2], "--machine", self.machine, "-o", map_file, "--json", json_file)
        names = [f"E{motion}Y" for motion in "XYZABC"]
        self.assertIn("PRIOR ONLY: no run determines", text)
        self.assertLessEqual(set(names), set(json.loads(json_file.read_text())["prior_only"]))
        # Another chain: the linkage sees it at once; a sweep alone has no rows to spare for it.
        other = self.path / "other.toml"
        other.write_text(self.machine.read_text().replace("[w X Y b Z t]", "[w b X Y Z t]"))
        self.refuse(runs[3], "--machine", other, saying=["volume.csv", "go different ways", "[w b X Y Z t]"])
        # A gauge 50 um too long.
        lines = pathlib.Path(runs[4]).read_text().splitlines()
        names = next(line for line in lines if line.startswith("time_s")).split(",")
        at = names.index("length_mm")
        wrong = self.path / "wrong.csv"
        with wrong.open("w") as out:
            for line in lines:
                fields = line.split(",")
                if len(fields) == len(names) and fields != names:
                    fields[at] = repr(float(fields[at]) * (1 + 0.05 / 60))
                print(",".join(fields), file=out)
        text = self.done(*runs[:4], wrong, "--machine", self.machine, "-o", map_file, "--json", json_file)
        self.assertIn("CONTRADICTION: ", text)
        self.assertIn("wrong.csv", json.loads(json_file.read_text())["contradictions"][0])
        # Encoders that are five times as noisy as the machine file says.
        quiet = self.path / "quiet.toml"
        stated = self.machine.read_text().replace("encoder_urad = 3.0", "encoder_urad = 0.6", 1)
        self.assertNotEqual(stated, self.machine.read_text())
        quiet.write_text(stated)
        text = self.done(*runs, "--machine", quiet, "-o", map_file, "--json", json_file)
        self.assertEqual(text.count("DOES NOT FIT: "), 1)
        self.assertIn("volume.csv", text.partition("DOES NOT FIT: ")[2].splitlines()[0])
        self.assertEqual([pathlib.Path(name).name for name in json.loads(json_file.read_text())["misfits"]],
                         ["volume.csv"])
        # Nothing to map.
        empty = self.path / "empty.toml"
        empty.write_text(self.machine.read_text().replace("travel_mm = [0.0, 60.0]", "travel_mm = [30.0, 30.0]", 1))
        self.refuse(runs[0], "--machine", empty, saying=["empty.toml", "travel_mm"])

    def test_refusals_take_one_line(self):
        dwell = self.path / "dwell.csv"
        dwell.write_text('# abbe-recording = 1\n# kind = "dwell"\ntime_s\n0\n1\n')
        self.refuse(dwell, "--machine", MACHINE, saying=["dwell.csv", "an error map is made of sweep, linkage"])
        foreign = self.path / "foreign.csv"
        foreign.write_text('# abbe-recording = 1\n# kind = "length"\n# machine = "other"\n'
                           "x_mm,y_mm,z_mm,pass,length_mm,u_length_um\n0,0,0,1,0,0.1\n10,0,0,1,10,0.1\n")
        self.refuse(foreign, "--machine", MACHINE, saying=['machine "other"', "give the file of that machine"])
        self.refuse(foreign, self.path / "." / "foreign.csv", "--machine", MACHINE, saying=["foreign.csv", "given twice"])
        header = '# abbe-recording = 1\n# kind = "length"\nx_mm,y_mm,z_mm,pass,length_mm,u_length_um\n'
        for rows, saying in (("0,0,0,1,5,0.1\n9,0,0,1,10,0.1\n", "row 1: the first length of a pass must be 0"),
                             ("0,0,0,1,0,0.1\n", "a pass of one row"),
                             ("0,0,0,1,0,0.1\n9,0,0,1,9,0\n", "row 2: u_length_um must be above 0"),
                             ("0,0,0,1,0,0.1\n0,0,0,1,9,0.1\n", "row 2: stands where the pass began"),
                             ("0,0,0,1,0,0.1\n90,0,0,1,90,0.1\n", "row 2: x = 90.0000 mm lies outside")):
            lengths = self.path / "lengths.csv"
            lengths.write_text(header + rows)
            self.refuse(lengths, "--machine", MACHINE, saying=["lengths.csv", saying])


if __name__ == "__main__":
    unittest.main()
