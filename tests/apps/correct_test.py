#!/usr/bin/env python3
"""`abbe correct`: LinuxCNC's interpreter reads the program and the corrected program, and the moves of
the second, made by a machine with the errors (NumPy, map_machine.py), are the moves of the first.

    ABBE=path/to/abbe correct_test.py
"""
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

from map_machine import MapMachine

ABBE = os.environ["ABBE"]
NUMBER = r"(-?\d+\.\d+)"
MOVE = re.compile(rf"USE_LENGTH_UNITS\((\w+)\)|(STRAIGHT_TRAVERSE|STRAIGHT_FEED)\({NUMBER}, {NUMBER}, {NUMBER}")
PROGRAM = """%
(pocket)
N10 G21 G90 G17 G40 G49 G80
N20 T1 M6
N30 G0 X5 Y5 Z10
M3 S8000
G1 Z8 F200
X25 F600 (long line)
Y20.5
G3 X20 Y25.5 I-5
G1 X10
G2 X5 Y20.5 R5
G91 G1 X0 Y-15.5
X1.2345 Y0.001
G90 G20
G1 X0.5 Y0.3 Z0.35
G21 G18 G2 X18.7 Z12.89 I3 K2
G19 G3 Y12 Z15 R8
G17 G2 I4 J0 Z18
G4 P0.1
M5
G0 Z25
M30
%
"""


class CorrectTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def correct(self, machine, name, *options):
        return subprocess.run([ABBE, "correct", machine.write(self.folder / "map.toml"), self.folder / name, *options],
                              capture_output=True, text=True)

    def canonical(self, name):
        """What LinuxCNC would do: kind, end in mm and printed resolution in mm of every straight move."""
        done = subprocess.run(["rs274", "-g", self.folder / name], capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, env={**os.environ, "HOME": str(self.folder)}, cwd=self.folder)
        self.assertEqual(done.stderr.strip(), "executing")  # and nothing else: no complaint
        unit, moves = 1.0, []
        for units, kind, *point in MOVE.findall(done.stdout):
            if units:
                unit = 25.4 if units == "CANON_UNITS_INCHES" else 1.0
            else:
                moves.append((kind, unit * np.array(list(map(float, point))), unit * 1e-4))
        return done.stdout, moves

    @unittest.skipUnless(shutil.which("rs274"), "linuxcnc-uspace is not installed")
    def test_the_machine_makes_what_linuxcnc_reads_in_the_original(self):
        for chain in ("[w X Y b Z t]", "[w Y b X Z t]"):
            machine = MapMachine(11, chain, size=3.0)
            (self.folder / "part.ngc").write_text(PROGRAM)
            done = self.correct(machine, "part.ngc", "--work-offset", "8,9,7")
            self.assertEqual(done.returncode, 0, done.stderr)
            before, asked = self.canonical("part.ngc")
            after, commanded = self.canonical("part_corrected.ngc")
            offset = np.array([8.0, 9.0, 7.0])
            # Every end of a straight move of the original is made, in order, as far as rs274 prints digits.
            made = [(kind, 1e3 * machine.made(1e-3 * (p + offset)) - offset) for kind, p, _ in commanded]
            at, largest = 0, 0.0
            for kind, point, digit in asked:
                while at < len(made) and (made[at][0] != kind or np.abs(made[at][1] - point).max() > 1.5 * digit):
                    at += 1
                self.assertLess(at, len(made), f"{chain}: {kind} to {point} is not made")
                largest = max(largest, np.abs(commanded[at][1] - point).max())
            self.assertGreater(largest, 5e-3)
            self.assertGreater(len(made), 5 * len(asked))
            # The rest is the same: spindle, tool, feed, dwell, comment, end.
            def others(text):
                kept = re.findall(r"(?:START_SPINDLE\w*|STOP_SPINDLE\w*|SET_SPINDLE_SPEED|SET_FEED_RATE|DWELL|COMMENT|"
                                  r"CHANGE_TOOL|SELECT_TOOL|USE_LENGTH_UNITS|SELECT_PLANE|PROGRAM_END)\([^)]*\)", text)
                return kept
            mark = 'COMMENT("corrected by abbe with the map map.toml")'
            self.assertEqual([call for call in others(after) if call != mark], others(before))
            self.assertEqual(others(after).count(mark), 1)
            self.assertIn('COMMENT("long line")', after)
            self.assertNotIn("ARC_FEED", after)
            self.assertIn("ARC_FEED", before)

    def test_coordinates_are_corrected_to_rounding(self):
        machine = MapMachine(3)
        points = np.random.default_rng(1).uniform(1, 59, (50, 3))
        rows = [f"{i},{x},{y},{z},ok" for i, (x, y, z) in enumerate(points)]
        (self.folder / "cmm.csv").write_text("\n".join(["point,x_mm,y_mm,z_mm,flag", *rows]) + "\n")
        done = self.correct(machine, "cmm.csv")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("50 positions, corrected by up to", done.stdout)
        lines = (self.folder / "cmm_corrected.csv").read_text().splitlines()
        self.assertEqual(lines[0], "point,x_mm,y_mm,z_mm,flag")
        for line, point in zip(lines[1:], points):
            words = line.split(",")
            self.assertEqual(words[4], "ok")
            np.testing.assert_allclose([float(w) for w in words[1:4]], 1e3 * machine.made(1e-3 * point), atol=1e-11)

    def test_a_corrected_program_is_made_to_its_last_digit(self):
        machine = MapMachine(5)
        (self.folder / "a.nc").write_text("G0 X10 Y20 Z30\nG1 X50 Y40 Z35 F100\n")
        done = self.correct(machine, "a.nc", "--json", self.folder / "a.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        result = json.loads((self.folder / "a.json").read_text())
        self.assertEqual([result[key] for key in ("command", "kind", "out", "lines", "moves")],
                         ["correct", "program", "a_corrected.nc", 2, 2])
        last = (self.folder / "a_corrected.nc").read_text().splitlines()[-1]
        command = np.array([float(word[1:]) for word in last.split()])
        self.assertLess(np.abs(1e3 * machine.made(1e-3 * command) - (50, 40, 35)).max(), 0.6e-6)

    def test_a_corrected_program_is_known_and_not_corrected_again(self):
        machine = MapMachine(5)
        (self.folder / "a.nc").write_bytes(b"%\r\nG21 G90 G17\r\nG0 X10 Y20 Z30\r\nM2\r\n%\r\n")
        self.assertEqual(self.correct(machine, "a.nc").returncode, 0)
        written = (self.folder / "a_corrected.nc").read_bytes()
        self.assertTrue(written.startswith(b"%\r\n(corrected by abbe with the map map.toml)\r\nG21 G90 G17\r\nG0 X"), written)
        self.assertEqual(written.count(b"\n"), written.count(b"\r\n"))
        self.refused(machine, "a_corrected.nc", "a_corrected.nc: line 2: the program is corrected already", "--again")
        self.assertEqual(self.correct(machine, "a_corrected.nc", "--again").returncode, 0)
        (self.folder / "b.nc").write_bytes(b"G21 G90 G17\nG0 X10 Y20 Z30\nM2\n")
        self.assertEqual(self.correct(machine, "b.nc").returncode, 0)
        self.assertNotIn(b"\r", (self.folder / "b_corrected.nc").read_bytes())

    def test_what_is_wrong_with_the_options_is_not_the_maps_fault(self):
        machine = MapMachine(5)
        (self.folder / "a.nc").write_text("G21 G90 G17\nG0 X10 Y20 Z30\nM2\n")
        done = self.correct(machine, "a.nc", "--tool", "nan,0,0")
        self.assertEqual((done.returncode, done.stderr), (2, "abbe: --tool nan,0,0: give three numbers in mm, x,y,z\n"))
        done = subprocess.run([ABBE, "correct", self.folder, self.folder / "a.nc"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn(f"{self.folder}: is a folder; name a file", done.stderr)

    def test_what_cannot_be_corrected_leaves_no_file(self):
        machine = MapMachine(5)
        for text, words in (("G0 X1 Y1 Z1\nG41 D1 X5\n", "part.ngc: line 2: length and radius of a tool"),
                            ("G0 X1 Y1 Z1\nG33 Z0 K1\n", "line 2: G33"),
                            ("G0 X1 Y1 Z99\n", "line 1: Z = 99 mm lies outside")):
            (self.folder / "part.ngc").write_text(text)
            done = self.correct(machine, "part.ngc")
            self.assertEqual(done.returncode, 2)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["map.toml", "part.ngc"])

    def refused(self, machine, name, *words):
        """One line that says all of `words`, in small memory and little time; no file is left."""
        program = [ABBE, "correct", machine.write(self.folder / "map.toml"), self.folder / name,
                   "--out", self.folder / "out.ngc", "--start", "30,30,30"]
        limit = lambda: resource.setrlimit(resource.RLIMIT_CPU, (10, 10))
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss
        done = subprocess.run(program, capture_output=True, text=True, preexec_fn=limit, errors="replace")
        self.assertEqual(done.returncode, 2, (name, done.stdout, done.stderr))
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)
        self.assertLess(max(before, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss), 300e3)  # kB
        self.assertEqual([p.name for p in self.folder.iterdir() if p.name.startswith("out.ngc")], [])

    def test_a_program_that_would_take_the_memory_is_refused_at_once(self):
        machine = MapMachine(5)
        for text, *words in (("G1 X1000000000\n", "line 1: X = ", "outside its travel"),
                             ("G2 X30 Y30 I1000000000 J0\n", "line 1: ", "an arc of radius 1e+09 mm"),
                             ("G2 X30 Y30 I1000000 J0\n", "line 1: X = ", "outside its travel"),
                             ("G2 X30 Y30 Z1000000000 I5 J0\n", "line 1: Z = ", "outside its travel"),
                             ("GnanX10 Y10 Z10\n", 'line 1: "GnanX10', "not a letter with a number"),
                             ("G99999999999999999999 X10\n", "line 1: G99999999999999999999 is not supported"),
                             ("G429496730.6 X10\n", "line 1: G429496730.6 is not supported"),
                             ("Minf\n", 'line 1: "Minf"', "not a letter with a number"),
                             ("G1 Xinf\n", 'line 1: "Xinf"'), ("G1 X nan\n", 'line 1: "X nan"'),
                             ("G0 X1\n" + 100000 * "(" + "\n", "line 2: longer than 65534 characters"),
                             ("", "part.ngc: is empty"),
                             ("%\nG0 X30\n", "line 2: ", "it is truncated")):
            (self.folder / "part.ngc").write_text(text)
            self.refused(machine, "part.ngc", "part.ngc: ", *words)

    def test_what_cannot_be_read_is_no_end_of_a_program(self):
        machine = MapMachine(5)
        (self.folder / "folder.ngc").mkdir()
        self.refused(machine, "folder.ngc", "folder.ngc: cannot be read beyond line 0: Is a directory")
        self.refused(machine, "/proc/self/mem", "/proc/self/mem: cannot be read beyond line 0")
        self.refused(machine, "/dev/zero", "/dev/zero: line 1: longer than")
        self.refused(machine, "missing.ngc", "missing.ngc: cannot be read")
        # What was there stays.
        (self.folder / "kept.ngc").write_text("kept\n")
        done = self.correct(machine, "folder.ngc", "--out", self.folder / "kept.ngc")
        self.assertEqual(done.returncode, 2)
        self.assertEqual((self.folder / "kept.ngc").read_text(), "kept\n")

    def test_it_tells_what_it_assumes(self):
        machine = MapMachine(5)
        (self.folder / "a.ngc").write_text("G0 X10 Y20 Z30\nG2 X14 I2 F100\n")
        done = self.correct(machine, "a.ngc", "--json", self.folder / "a.json")
        self.assertEqual(done.returncode, 0, done.stderr)
        for words in ("millimetres (G21) from line 1 on", "absolute positions (G90) from line 1 on",
                      "arcs and cycles in XY (G17) from line 2 on", "ends with neither M2, M30 nor %"):
            self.assertIn(words, done.stderr)
        self.assertEqual(len(json.loads((self.folder / "a.json").read_text())["assumed"]), 3)
        (self.folder / "b.ngc").write_text("G21 G90 G17\nG0 X10 Y20 Z30\nG2 X14 I2 F100\nM30\n")
        done = self.correct(machine, "b.ngc")
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_a_cause_that_follows_time_does_not_act_on_coordinates(self):
        machine = MapMachine(3)
        points = np.linspace(1, 59, 30)
        (self.folder / "cmm.csv").write_text(
            "x_mm,y_mm,z_mm\n" + "".join(f"{x},{x / 2},{30}\n" for x in points))
        plain = self.correct(machine, "cmm.csv", "--out", self.folder / "plain.csv")
        self.assertEqual(plain.returncode, 0, plain.stderr)
        name = re.search(r'machine = "(.*)"', (self.folder / "map.toml").read_text())[1]
        (self.folder / "causes.toml").write_text(
            f'extended_model = 1\nmachine = "{name}"\n'
            '[[cause]]\nid = "vibration"\nobject = "X"\nfrequency_hz = 7.3\namplitude_um = 5.0\nphase_rad = 0.4\n'
            '[[cause]]\nid = "warm-up-drift"\nobject = "Y"\namplitude_um = 9.0\ntime_constant_s = 40.0\n')
        done = self.correct(machine, "cmm.csv", "--out", self.folder / "causes.csv", "--feed-mm-min", "600",
                            "--causes", self.folder / "causes.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("in addition to the map, from causes.toml: nothing; left out, because a path has no time and no "
                      "temperature: vibration:X, warm-up-drift:Y", done.stdout)
        self.assertEqual((self.folder / "causes.csv").read_text(), (self.folder / "plain.csv").read_text())


if __name__ == "__main__":
    unittest.main()
