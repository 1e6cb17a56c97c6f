#!/usr/bin/env python3
"""`abbe correct` on the programs that Debian's linuxcnc-uspace installs, read from where the package has them.

Every program that LinuxCNC's interpreter (rs274) runs is corrected or refused with its line. What is corrected is run
by rs274 again: the moves, made by a machine with the errors of the map (NumPy, map_machine.py), are those of the
program as it was, everything else that happens is the same. Files that hold a subroutine only are called with the
defaults that they state.

    ABBE=path/to/abbe programs_of_linuxcnc_test.py         the test
    ABBE=path/to/abbe programs_of_linuxcnc_test.py table   the table of docs/results.md
"""
import collections
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

from map_machine import MapMachine
from rs274_path import canonical, follows

ABBE = os.environ["ABBE"]
CHORD_MM = 1.2e-3  # of an arc, and the rest of the map on lines
# rs274 by itself starts in millimetres with tables in inches; offsets of every coordinate system, G28 and G30.
PARAMETERS = {5161: 3, 5162: -4, 5163: 5, 5181: -3.5, 5182: 4.5, 5183: 6, 5210: 0, 5211: 0, 5212: 0, 5213: 0, 5220: 1,
              **{5221 + 20 * i + k: 0 for i in range(9) for k in range(3, 10)},
              **{5221 + 20 * i + k: (1 + 0.3 * i, 2 - 0.2 * i, -0.5 + 0.1 * i)[k] for i in range(9) for k in range(3)}}
START = "-25.4,-50.8,12.7"  # the axes at 0 in G54
TOOLS = [*range(1, 100), 2345]
COPIED = ["M128", "M129"]  # of a mill-turn: soft limits by the kinematics in force
# rs274 by itself, without a machine: does not load a tool with M61; gives no value of the time of a probe.
NOT_COMPARED = {"offsets.ngc": "M61", "roparams.ngc": "_vmajor and others of the control in messages"}


def programs():
    listed = subprocess.run(["dpkg", "-L", "linuxcnc-uspace"], capture_output=True, text=True).stdout
    return [pathlib.Path(name) for name in listed.splitlines() if name.lower().endswith((".ngc", ".nc"))]


def for_standalone(text):
    """What rs274 by itself cannot: M6 and G43 in one line (it takes the place of the axes for that in the program),
    values of the machine's pins."""
    text = re.sub(r"(?im)^([^(;\n]*\bM0?6\b[^(;\n]*?)(G43\s*(?:H\d+)?)", r"\1\n\2", text)
    return re.sub(r"#<_hal\[[^\]]*rate\]>", "1000", text)


def call_of(path, text):
    """A program that calls the subroutine of a file with the defaults "(=0.5 ...)" that it states; none: nothing."""
    name = re.search(r"(?im)^\s*o<([^>]+)>\s*sub", text)
    if not name or name[1] != path.stem:
        return None
    values = {}
    for number, default in re.findall(r"(?m)^\s*#<\w+>\s*=\s*#(\d+)\s*(?:\(\s*=\s*([-+]?[\d.]+))?", text):
        values[int(number)] = default or "0"
    arguments = "".join(f"[{values.get(i, '0')}]" for i in range(1, max(values, default=0) + 1))
    units = "G20" if re.search(r"(?i)in_std|inch", text) and not re.search(r"(?i)_mm", path.stem) else "G21"
    return f"{units} G90 G17 G40 G49 G80 G94 G98 G64\nF100 S1000 M3\nG0 X0 Y0 Z0\no<{name[1]}> call {arguments}\nM2\n"


class Bench:
    """Corrects and runs programs in a folder."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.machine = MapMachine(11, size=3.0, travel=(-4.0, 4.0))
        self.map = self.machine.write(self.folder / "map.toml")
        self.parameters = "".join(f"{k}\t{v:.6f}\n" for k, v in sorted(PARAMETERS.items()))
        (self.folder / "control.var").write_text(self.parameters)
        (self.folder / "tool.tbl").write_text("".join(
            f"T{n} P{n} Z{1 + 0.1 * (n % 20):.3f} D{0.01 + 0.01 * (n % 5):.3f} ;\n" for n in TOOLS))

    def run(self, path):
        """Canon of a program in rs274, and its complaint."""
        (self.folder / "rs274.var").write_text(self.parameters)
        return canonical(path, self.folder, "-t", "tool.tbl", "-v", "rs274.var", "-i", "rs274.ini")

    def judge(self, path, text):
        """(outcome, reason, moves): right, wrong, refused, or not run by rs274."""
        (self.folder / "rs274.ini").write_text(
            f"[RS274NGC]\nSUBROUTINE_PATH={path.parent}\n[DISPLAY]\nPROGRAM_PREFIX={path.parent}\n")
        source, out = self.folder / "source.ngc", self.folder / "out.ngc"
        source.write_text(for_standalone(text))
        before, complaint = self.run(source)
        out.unlink(missing_ok=True)
        source.write_text(re.sub(r"(?im)^([^(;\n]*\bM0?6\b[^(;\n]*?)(G43\s*(?:H\d+)?)", r"\1\n\2", text))
        done = subprocess.run(
            [ABBE, "correct", self.map, source, "--out", out, "--tools", self.folder / "tool.tbl", "--parameters",
             self.folder / "control.var", "--control-units", "inch", "--tool", "10,-20,-80", f"--start={START}",
             "--block-delete", "off", "--rotary", "table", "--subroutines", path.parent, "--ini",
             self.folder / "rs274.ini", *(word for code in COPIED for word in ("--copy", code))],
            capture_output=True, text=True, errors="replace", timeout=100)
        if done.returncode != 0:
            lines = done.stderr.strip().splitlines()
            if done.returncode != 2 or len(lines) != 1 or out.exists():
                return "wrong", f"refused badly: {done.stderr}", 0
            # rs274 shows the structure of a file only where it runs; a line or the name of a subroutine is said.
            if not re.search(r"line \d+: .{12}|defines the subroutine", lines[0]):
                return "wrong", f"no line in {lines[0]}", 0
            return "not run" if complaint else "refused", lines[0], len(before.moves)
        corrected = out.read_text(errors="replace")
        out.write_text(for_standalone(corrected))
        after, complaint_after = self.run(out)
        if complaint:
            same = complaint_after != ""
            return ("not run", complaint, 0) if same else ("wrong", f"runs, but before: {complaint}", 0)
        if complaint_after:
            return "wrong", f"rs274 refuses the corrected program: {complaint_after}", 0
        commands = np.array([move.line[-1] for move in after.moves]).reshape(-1, 3)
        tools = np.array([move.tool for move in after.moves]).reshape(-1, 3)
        made = commands
        if len(commands):
            made = 1e3 * self.machine.made_many(
                1e-3 * commands, self.machine.tool - self.machine.signs * 1e-3 * tools)
        wrong = follows(before.moves, after.moves, made, CHORD_MM)
        # In G93 the feed that rs274 prints follows from the length of a line.
        if not wrong and before.others != after.others and "G93" not in text.upper():
            pairs = [pair for pair in zip(before.others, after.others) if pair[0] != pair[1]]
            wrong = f"{len(before.others)} other calls became {len(after.others)}: {pairs[:1]}"
        if len(commands) > 10 and not wrong and np.abs(made - commands).max() < 5e-3:
            wrong = "nothing was corrected"
        return "wrong" if wrong else "right", wrong or done.stderr.strip(), len(before.moves)


def reason_of(text):
    """A refusal in a few words."""
    for words, reason in (("probe stops", "probe (G38)"), ("#5070", "sets the result of a probe"),
                          ("geared to the spindle", "thread or tap"), ("turning cycle", "turning cycle (G70 to G72)"),
                          ("splines", "spline (G5.1)"), ("only at the control", "a value of the control"),
                          ("effect on the machine", "M code of the machine's own"),
                          ("no subroutine", "missing subroutine"), ("ends itself", "the program aborts"),
                          ("tool table of the control", "writes the tool table"),
                          ("moves nothing by itself", "subroutines alone"), ("Om103 ends", "endsub of another name"),
                          ("has no value", "name without a value")):
        if words in text:
            return reason
    return re.sub(r".*line \d+: ", "", text)[:60]


def judge_all(folder):
    """Counts of outcomes by kind of file, reasons of refusals, everything wrong."""
    bench, counts, reasons, wrong = Bench(folder), collections.Counter(), collections.Counter(), []
    for path in programs():
        if path.name in NOT_COMPARED:
            counts["all", "not compared"] += 1
            continue
        text = path.read_text(errors="replace")
        outcome, reason, moves = bench.judge(path, text)
        kind = "program"
        if outcome == "refused" and "defines the subroutine" in reason or outcome == "not run":
            call = call_of(path, text)
            if call:
                kind = "subroutine"
                outcome, reason, moves = bench.judge(path, call)
        counts[kind, outcome, "moves" if moves else "none"] += 1
        if outcome == "wrong":
            wrong.append(f"{path}: {reason}")
        if outcome == "refused":
            reasons[reason_of(reason)] += 1
    return counts, reasons, wrong


@unittest.skipUnless(shutil.which("rs274"), "linuxcnc-uspace is not installed (apt-get install linuxcnc-uspace)")
class ProgramsOfLinuxcncTest(unittest.TestCase):
    def test_programs_are_made_as_they_were_or_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            counts, reasons, wrong = judge_all(folder)
        print(dict(counts), dict(reasons))
        self.assertEqual(wrong, [])
        judged = {key: n for key, n in counts.items() if "moves" in key and {"right", "refused"} & set(key)}
        right = sum(n for key, n in judged.items() if "right" in key)
        self.assertGreaterEqual(right, 0.9 * sum(judged.values()))


if __name__ == "__main__":
    if sys.argv[1:] == ["table"]:
        with tempfile.TemporaryDirectory() as scratch:
            for result in judge_all(scratch):
                for item in (sorted(result.items()) if isinstance(result, dict) else result):
                    print(item)
    else:
        unittest.main()
