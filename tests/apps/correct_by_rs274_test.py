#!/usr/bin/env python3
"""Cutter compensation, branches that the control chooses and offsets of rotary axes, against LinuxCNC's interpreter.

Contours beside which the tool goes are drawn at random: lines and arcs that turn to either side, by little, by much
and back, with moves along the normal between them. rs274 says where the tool's centre goes, and refuses those into
which the tool does not fit.
"""
import collections
import math
import pathlib
import random
import shutil
import subprocess
import tempfile
import unittest

from programs_of_linuxcnc_test import ABBE, START, Bench

CONTOURS = 120
BRANCHES = """G21 G90 G94 F200
G0 X1 Y2 Z3
O10 if [EXISTS[#<_ini[TEST]LAMP>]]
O11 if [#<_ini[TEST]LAMP> GT #<_metric>]
(debug, bright)
O11 elseif [#<_ini[TEST]LAMP> EQ 1]
(debug, on #<_metric>)
O11 else
(debug, off)
M2
O11 endif
O10 else
(debug, none)
O10 endif
o<wait> call [2]
G1 X4 Y1
M2
o<wait> sub
o20 if [EXISTS[#<_ini[TEST]DOOR>]]
(debug, door)
o20 return [-1]
o20 endif
#<level> = [#1 + 1]
M68 E0 Q#<level>
(debug, level #<level>)
o<wait> endsub
"""
ROTARY = """G21 G90 G94 F200
G0 X1 Y2 Z3 A10 B0
G92 X0 A0
G1 X20 A30 B5
G10 L20 P1 Y0 A3 C1
G1 Y9 A-3 C2 B7
G92.1
G0 X2 Y2 A0 B0 C0
G1 X30 A1
M2
"""


class Contour:
    """A program with compensation beside a random contour."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.plane = self.draw.choice(["G17", "G18"])
        self.first, self.second, self.normal = "XYZ" if self.plane == "G17" else "ZXY"
        self.at, self.heading = (0.0, 0.0), 0.0

    def text(self):
        draw, side = self.draw, self.draw.choice(["G41", "G42"])
        by_diameter = draw.random() < 0.7
        tool = f"{side}.1 D{2 * draw.choice([0.3, 1.0, 2.5])}" if by_diameter else f"{side} D{draw.randrange(9)}"
        start = f"G0 {self.first}0 {self.second}0 {self.normal}1"
        lines = ["T3 M6", "G21 G90 G94 F200", self.plane, start, tool, self.line("G1")]
        if draw.random() < 0.2:
            lines[-1] = self.arc()
        lines += [self.move() for _ in range(draw.randrange(2, 8))]
        return "\n".join([*lines, "G40", self.line("G1"), "M2", ""])

    def move(self):
        kind = self.draw.random()
        if kind < 0.1:
            return f"G1 {self.normal}{self.draw.uniform(-2, 2):.3f}"
        if kind < 0.15:
            return f"F{self.draw.randrange(100, 300)} (another feed)"
        turn = self.draw.choice([0.0, 1.0, 2.0, 20.0, 60.0, 90.0, 120.0, 150.0, 170.0])
        self.heading += math.radians(turn) * self.draw.choice([-1, 1])
        return self.line("G0" if kind < 0.25 else "G1") if kind < 0.6 else self.arc()

    def to(self, x, y):
        self.at = round(x, 4), round(y, 4)
        return f"{self.first}{self.at[0]:.4f} {self.second}{self.at[1]:.4f}"

    def line(self, code):
        length = self.draw.uniform(3, 20)
        return f"{code} " + self.to(self.at[0] + length * math.cos(self.heading),
                                    self.at[1] + length * math.sin(self.heading))

    def arc(self):
        draw, start = self.draw, self.at
        radius, left = draw.uniform(1.5, 12), draw.choice([-1, 1])
        centre = (start[0] - left * radius * math.sin(self.heading), start[1] + left * radius * math.cos(self.heading))
        sweep = 2 * math.pi if draw.random() < 0.1 else draw.uniform(0.2, 5.5)
        self.heading += left * sweep
        end = self.to(*start) if sweep > 6.0 else self.to(centre[0] + left * radius * math.sin(self.heading),
                                                          centre[1] - left * radius * math.cos(self.heading))
        rise = f" {self.normal}{draw.uniform(-2, 2):.3f}" if draw.random() < 0.2 else ""
        if draw.random() < 0.3 and 0.4 < sweep < 3.0:
            how = f"R{radius:.5f}"
        else:
            letter = {"X": "I", "Y": "J", "Z": "K"}
            how = f"{letter[self.first]}{centre[0] - start[0]:.5f} {letter[self.second]}{centre[1] - start[1]:.5f}"
        return f"{'G3' if left > 0 else 'G2'} {end}{rise} {how}"


@unittest.skipUnless(shutil.which("rs274"), "linuxcnc-uspace is not installed (apt-get install linuxcnc-uspace)")
class CorrectByRs274Test(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)
        self.bench = Bench(self.folder)

    def judge(self, text):
        return self.bench.judge(self.folder / "program.ngc", text)

    def test_tools_go_beside_contours_as_in_linuxcnc(self):
        counts = collections.Counter()
        for seed in range(CONTOURS):
            outcome, reason, _ = self.judge(Contour(seed).text())
            if outcome == "wrong" and "without gouging" in reason:
                outcome = "refused by rs274 alone"
            counts[outcome] += 1
            self.assertNotEqual(outcome, "wrong", f"{seed}: {reason}\n{Contour(seed).text()}")
        print(dict(counts))
        self.assertGreater(counts["right"], CONTOURS // 2)
        # Where the tool would go back between two corners, or lose a full circle, abbe is stricter.
        self.assertLess(counts["refused"], 0.1 * counts["right"])
        self.assertLess(counts["refused by rs274 alone"], 0.05 * counts["right"])

    def test_offsets_of_rotary_axes_are_the_controls(self):
        outcome, reason, moves = self.judge(ROTARY)
        self.assertEqual((outcome, moves), ("right", 5), reason)

    def correct(self, text, *options):
        source, out = self.folder / "source.ngc", self.folder / "out.ngc"
        source.write_text(text)
        out.unlink(missing_ok=True)
        return source, out, subprocess.run([ABBE, "correct", self.bench.map, source, "--out", out, f"--start={START}",
                                            *options], capture_output=True, text=True)

    def test_the_control_chooses_the_branches_that_it_alone_can(self):
        source, out, done = self.correct(BRANCHES)
        self.assertEqual(done.returncode, 0, done.stderr)
        said = set()
        for entries in ("", "LAMP = 0", "LAMP = 1", "LAMP = 7", "LAMP = 1\nDOOR = 1", "DOOR = 2"):
            (self.folder / "rs274.ini").write_text(f"[RS274NGC]\n[TEST]\n{entries}\n")
            before, complaint = self.bench.run(source)
            after, complaint_after = self.bench.run(out)
            self.assertEqual((complaint, complaint_after), ("", ""), entries)
            self.assertEqual(before.others, after.others, entries)
            self.assertEqual(len(before.moves), 1 if entries == "LAMP = 0" else 2)
            self.assertEqual(after.moves[-1].kind, before.moves[-1].kind)
            said.update(text for name, text in before.others if name == "MESSAGE")
        self.assertEqual(len(said), 6, said)  # every branch was taken

    def test_the_ini_file_of_the_control_decides_where_it_is_given(self):
        ini = self.folder / "mill.ini"
        ini.write_text("[EMC]\nMACHINE = mill\n[TEST]\nLAMP = 7\nLAMP = 1\n# DOOR = 3\nTEXT = door\n")
        _, out, done = self.correct(BRANCHES, "--ini", ini)
        self.assertEqual(done.returncode, 0, done.stderr)
        text = out.read_text()
        self.assertIn("bright", text)
        self.assertIn("level 3", text)
        self.assertNotIn("kept", text)

    def test_what_depends_on_the_way_taken_is_refused(self):
        for inside, why in (("G1 X2", "line 3: whether this acts is known only at the control"),
                            ("#100 = 1", "line 3: whether this acts"), ("G91", "line 3: whether this acts"),
                            ("M3", "line 3: whether this acts"), ("o<sub> call", "line 3: whether this acts"),
                            ("M0", "")):
            _, out, done = self.correct(f"G21 G90 G0 X0 Y0 Z0\no1 if [#5399 GT 0]\n{inside}\no1 endif\nM2\n")
            self.assertEqual(out.exists(), why == "", done.stderr)
            self.assertIn(why, done.stderr)
        # The corrected program sets no parameters: it has not what this compares.
        _, _, done = self.correct("G21 G90 G0 X0 Y0 Z0\n#<a> = #5399\no1 if [#<a> GT 0]\nM0\no1 endif\nM2\n")
        self.assertIn("line 3: the way of the program depends on #<a>", done.stderr)


if __name__ == "__main__":
    unittest.main()
