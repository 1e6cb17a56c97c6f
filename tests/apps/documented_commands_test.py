#!/usr/bin/env python3
"""Every command line of the README and the manual runs as it stands, on small data like the demo's.

The lines of code blocks that begin with `abbe`, `build/release/apps/abbe` or `echo`. Each page has a folder of
its own with the files that its lines name; its lines run in their order. What cannot run here stands below
with its reason, and what would take minutes with less data in its place: an entry that fits no line fails.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml documented_commands_test.py
"""
import collections
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import tempfile
import tomllib
import unittest

from certificate_case import DATA
from program_case import MACHINE, PROGRAM

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
COMMAND = re.compile(r"\s*((?:build/release/apps/)?abbe\s.*|echo\s.*)")

# (page, beginning of the line): why it does not run here.
NOT_HERE = {
    ("README.md", "build/release/apps/abbe align"): "waits for a machine: align_test.py",
    ("README.md", "build/release/apps/abbe sweep"): "waits for a machine: sweep_test.py",
    ("README.md", "build/release/apps/abbe doctor"): "looks at devices: first_minutes_test.py",
    ("first-minutes.md", "abbe doctor"): "looks at devices: first_minutes_test.py",
    ("align.md", "abbe align"): "waits for a machine: align_test.py",
    ("align.md", "abbe rig"): "serves until Ctrl-C",
    ("live.md", "abbe sweep"): "waits for a machine: tests/report/live.test.mjs",
    ("live.md", "abbe record"): "waits for a machine: record_test.py",
    ("live.md", "abbe live"): "serves until Ctrl-C: live_test.py",
    ("sweep.md", "abbe sweep"): "waits for a machine: sweep_test.py",
    ("fleet.md", "abbe fleet fit"): "needs a fleet: fleet_test.py",
    ("investigate.md", "abbe investigate --machine mill.toml"): "asks an operator: investigate_test.py",
    ("devices.md", "abbe record"): "waits for a machine: record_test.py",
    ("virtual-rig.md", "abbe rig --machine machines/demo_mill.toml --seed 7 --port"): "serves until Ctrl-C",
    ("virtual-rig.md", "abbe rig --machine machines/demo_mill.toml --seed 7 --can"): "needs CAN: encoders_test.py",
    ("virtual-rig.md", "abbe record"): "needs CAN: encoders_test.py",
    ("virtual-rig.md", "abbe rig --machine machines/demo_mill.toml --seed 7 --hide"): "serves until Ctrl-C",
}
# (page, text of a line): what stands there here, so that it takes seconds.
SMALLER = {
    ("diagnose.md", "--campaign standard"): "--campaign minimal",
    ("results.md", "--course cube --dwell 0.2 --rate 5"): "--course cube --points 4,4,4 --dwell 0.2 --rate 5",
    ("virtual-rig.md", "--course cube --reference"): "--course cube --points 3,3,3 --reference",
    ("virtual-rig.md", "--campaign standard"): "--campaign standard --reduced",
}


def commands():
    """[(page, line number, command)], without comments and with continued lines joined."""
    found = []
    for page in PAGES:
        fenced, joined = False, ""
        for number, line in enumerate(page.read_text().splitlines(), 1):
            if line.startswith("```"):
                fenced = not fenced
            elif fenced or line.startswith("    ") or joined:
                match = COMMAND.fullmatch(joined + line)
                if match and match[1].endswith("\\"):
                    joined = match[1][:-1]
                    continue
                if match:
                    found.append((page.name, number, re.sub(r"\s+#\s.*", "", match[1])))
            joined = ""
    return found


def monitor_log():
    """A shaft at 6 rpm that three sensors see out of centre by 0.5 mm."""
    draw, lines = random.Random(3), []
    moment = lambda s: f"2026-11-21 09:{int(s) // 60:02}:{s % 60:09.6f}"
    for row in range(1600):
        time = row / 20
        lines.append(f"W:Rotation-PosAct {moment(time)} {36 * time % 360:.9f}")
        for number in range(3):
            angle = math.radians(36 * time - 120 * number)
            lines.append(f"W:AI{number + 1:02} {moment(time)} {5 + 0.5 * math.cos(angle) + draw.gauss(0, 1e-3):.6f}")
    return "\n".join(lines) + "\n"


def target_table():
    """Nine targets in five cycles, with 4 um of lost motion."""
    draw = random.Random(4)
    lines = ["TEST_DATA=# a table", "UNIT=mm", "CYCLES=5", "POSITIONS=9"]
    for i in range(1, 10):
        target = -20 + 5 * (i - 1)
        lines.append(f"TGT_DATA[{i}]={target}")
        for j in range(1, 6):
            for way, side in (("FWD", -0.002), ("BWD", 0.002)):
                lines.append(f"REF_DATA_{way}[{i},{j}]={target + side + draw.gauss(0, 2e-4):.5f}")
    return "\n".join(lines) + "\n"


def laser_table():
    """Five targets in three cycles of an axis Y."""
    draw, targets = random.Random(6), range(-100, 101, 50)
    lines = ["HEADER::", "File type  : rtl", "", "TARGET DATA::", "Filetype  : ISO", "Target-count: 5", "Targets :",
             "  ".join(f"{target:.3f}" for target in targets), "Flags: 0 0 2 0", "", "USER-TEXT::", "Axis:Y", "",
             "RUNS::", "Run-count:6", "", "DEVIATIONS::", "Run Target Data:"]
    for run in range(1, 7):
        order = range(1, 6) if run % 2 else range(5, 0, -1)
        lines += [f"{run}   {i}      {0.8 * i + (run % 2) + draw.gauss(0, 0.2):.3f}" for i in order]
    return "\n".join([*lines, "", "EOF::", ""])


def ballbar_table():
    """Both senses of a circle of axes that are not square, with lost motion in X."""
    draw, turn = random.Random(7), [*range(0, 361), *range(359, -1, -1)]
    lines = ["angle;deviation"]
    for i, degrees in enumerate(turn):
        t, sense = math.radians(degrees), 1 if i <= 360 else -1
        lost = 2.0 * sense * math.cos(t) * (1 if math.sin(t - 1e-3 * sense) > 0 else -1)  # as X came there
        lines.append(f"{degrees};{-8.0 * math.sin(2 * t) + lost + 1.5 + draw.gauss(0, 0.1):.3f}".replace(".", ","))
    return "\n".join(lines) + "\n"


def hole_table():
    """A plate of holes that is 100 ppm too long in X, in the columns of a measuring machine."""
    draw, lines = random.Random(5), ["    Meas X    Meas Y     Nom X     Nom Y     Err X     Err Y  Meas D   Nom D   Round"]
    for x in range(-250, 251, 50):
        for y in range(-250, 251, 50):
            dx, dy = 1e-4 * x + draw.gauss(0, 3e-3), draw.gauss(0, 3e-3)
            lines.append(f"{x + dx:10.3f}{y + dy:10.3f}{x:10.3f}{y:10.3f}{dx:10.3f}{dy:10.3f}   2.170   2.167   0.003")
    return "\n".join(lines) + "\n"


def arm_table():
    """Poses of the arm of motoman_left.toml by its own Denavit and Hartenberg, before a tracker."""
    arm = tomllib.loads((ROOT / "machines/motoman_left.toml").read_text())["linkage"]
    draw = random.Random(6)

    def tip(turned):
        place, turned = list(arm["ball_mm"]), list(turned)
        for joint in reversed(arm["joint"]):
            angle = math.radians(joint.get("theta_deg", 0.0)) + (0.0 if joint.get("fixed") else turned.pop())
            alpha = math.radians(joint.get("alpha_deg", 0.0))
            x, y, z = place
            x, y, z = (x + joint.get("a_mm", 0.0), math.cos(alpha) * y - math.sin(alpha) * z,
                       math.sin(alpha) * y + math.cos(alpha) * z + joint.get("d_mm", 0.0))
            place = [math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y, z]
        return place

    lines = ["arm,lS,lL,lU,lR,lB,lT,leica_x_m,leica_y_m,leica_z_m,unc_m"]
    for _ in range(120):
        turned = [draw.uniform(-0.8, 0.8) for _ in range(6)]
        place = [1e-3 * (p + draw.gauss(0, 0.02)) for p in tip(turned)]
        lines.append("2," + ",".join(f"{number:.9f}" for number in [*turned, *place]) + ",6e-06")
    return "\n".join(lines) + "\n"


PART = """%
G21 G90 G17
G0 X-10 Y-10 Z5
G1 Z1 F300
X10
G3 X10 Y10 J10
G1 X-10
Y-10
G0 Z5
M30
%
"""
BARE = 'name = "{}"\nchain = "[w X Y b Z t]"\n' + "".join(f"axis.{a}.travel_mm = [-350.0, 350.0]\n" for a in "XYZ") + (
    'axis.X.positive = "carriage"\naxis.Y.positive = "carriage"\n')


def warm_up():
    """A gap that follows a column by -2 um for each kelvin, 300 s later."""
    draw, lines, lagged = random.Random(8), ['# abbe-recording = 1', '# kind = "dwell"', "time_s,probe_a_um,temp_column_c"], 20.0
    for second in range(0, 7200):
        column = 20.0 + 6.0 * (1.0 - math.exp(-second / 1500)) + 0.5 * math.sin(second / 200)
        lagged += (column - lagged) / 300
        if second % 30 == 0:
            lines.append(f"{second},{100 - 2 * lagged + draw.gauss(0, 0.05):.4f},{column:.4f}")
    return "\n".join(lines) + "\n"


DRIFT = """[drift]
straightness_um = 0.05
scale_ppm = 1.0
[rig.ageing]
straightness_um = 0.05
scale_ppm = 1.0
"""


class DocumentedCommands(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.root = pathlib.Path(folder.name)
        cls.data = cls.root / "data"
        (cls.data / "build/release/apps").mkdir(parents=True)
        (cls.data / "build/release/apps/abbe").symlink_to(PROGRAM)
        shutil.copytree(ROOT / "machines", cls.data / "machines")
        mill = pathlib.Path(MACHINE).read_text()
        (cls.data / "mill.toml").write_text(mill.replace("step_mm = 1.0", "step_mm = 5.0").replace("passes = 5", "passes = 2") +
                                            "\n[limits]\nEYX = { straightness_um = 50.0 }\n" + DRIFT + DATA)
        for name, text in (("turn.log", monitor_log()), ("b02_target_x.dat", target_table()),
                           ("axis_y.rtl", laser_table()), ("ballbar.csv", ballbar_table()), ("part.ngc", PART),
                           ("linuxcnc.var", "5220\t1\n5221\t30\n5222\t30\n5223\t20\n"), ("tool.tbl", "T1 P1 Z50 D6 ;\n"),
                           ("D1597A_redrilled_meas_2011.txt", hole_table()),
                           ("leica_left_hand_6x6x6_dataset_poses.csv", arm_table()), ("stage.toml", BARE.format("stage")),
                           ("cmm.toml", BARE.format("cmm") + "population.smoothness_mm = 100.0\n"),
                           ("measured.csv", "x_mm,y_mm,z_mm\n20,30,25\n40,35,25\n"),
                           ("part.csv", "x_mm,y_mm,z_mm\n20,20,30\n40,20,30\n40,40,30\n")):
            (cls.data / name).write_text(text)
        cls.make_recordings()
        cls.make_results()

    @classmethod
    def abbe(cls, *arguments):
        run = subprocess.run([PROGRAM, *map(str, arguments)], cwd=cls.data, capture_output=True, text=True)
        assert run.returncode == 0, (arguments, run.stderr)

    @classmethod
    def make_recordings(cls):
        record = lambda name, *options: cls.abbe("rig", "record", "--machine", "mill.toml", "--seed", 7, "--out", name, *options)
        for axis in "XYZ":
            record(f"sweep_{axis}.csv", "--axis", axis, "--mounting", "A", "--rate", 50)
        cube = ("--course", "cube", "--dwell", 0.1, "--feed", 6000)
        for week in range(1, 5):
            record(f"week_{week}.csv", "--axis", "XYZX"[week - 1], "--mounting", "A", "--rate", 50, "--after-days", 7 * week)
        (cls.data / "warm_up.csv").write_text(warm_up())
        record("cube.csv", *cube, "--size", 45, "--points", "4,4,4", "--reference")
        record("volume.csv", *cube, "--size", 57, "--points", "5,5,5")
        for name, feed in (("circle", 600), ("slow", 300), ("fast", 2000)):
            record(f"{name}.csv", "--course", "circle", "--feed", feed, "--rate", 30)
        record("grid.csv", "--course", "circle", "--kind", "reference", "--rate", 30)
        record("square.csv", "--course", "square", "--feed", 1200, "--rate", 30)
        record("plate.csv", "--plate")
        record("line_X.csv", "--length", "X")
        for name, same in (("line_X", "line"), ("slow", "circle_slow"), ("fast", "circle_fast")):
            shutil.copy(cls.data / f"{name}.csv", cls.data / f"{same}.csv")

    @classmethod
    def make_results(cls):
        cls.abbe("calibrate", "cube.csv", "--machine", "mill.toml", "-o", "linkage.toml", "--folds", 1, "--quiet")
        for folder in ("out", "measured"):
            (cls.data / folder).mkdir()
        shutil.copy(cls.data / "sweep_X.csv", cls.data / "measured/sweep_X.csv")
        for folder in ("out", "measured"):
            cls.abbe("reduce", "sweep_X.csv", "--machine", "mill.toml", "--out", folder, "--quiet")
        cls.abbe("fuse", *(f"sweep_{axis}.csv" for axis in "XYZ"), "volume.csv", "line.csv", "--machine", "mill.toml",
                 "--fixed-smoothness", "-o", "out/map.toml")
        shutil.copy(cls.data / "out/map.toml", cls.data / "first.map.toml")

    def of_page(self, page):
        """A folder with all files; what the lines of a page make is not there yet, but for what others made."""
        folder = self.root / page
        if not folder.exists():
            shutil.copytree(self.data, folder, symlinks=True)
        return folder

    def test_every_line_runs(self):
        lines = commands()
        self.assertGreater(len(lines), 50)
        left = collections.Counter()
        for page, number, line in lines:
            exception = next((key for key in NOT_HERE if key[0] == page and line.startswith(key[1])), None)
            if exception:
                left[exception] += 1
                continue
            for key, smaller in SMALLER.items():
                if key[0] == page and key[1] in line:
                    left[key] += 1
                    line = line.replace(key[1], smaller)
            # What a line writes is new there.
            folder = self.of_page(page)
            for name in re.findall(r"(?:-o|--out|--json|--pdf|--truth) (\S+\.\w+)|convert \S+ (\S+)", line):
                if line.count("".join(name)) == 1:  # else it is read too
                    (folder / "".join(name)).unlink(missing_ok=True)
            with self.subTest(f"{page}:{number}"):
                run = subprocess.run(["bash", "-c", line.replace("abbe ", "build/release/apps/abbe ", 1)
                                      if line.startswith("abbe ") else line],
                                     cwd=folder, capture_output=True, text=True,
                                     env={**os.environ, "XDG_DATA_HOME": str(folder / "data")})
                self.assertEqual(run.returncode, 0, f"{page}:{number}: {line}\n{run.stdout[-500:]}{run.stderr}")
        for key in [*NOT_HERE, *SMALLER]:
            self.assertGreater(left[key], 0, f"{key}: no line of the manual is so; take it out")


if __name__ == "__main__":
    unittest.main()
