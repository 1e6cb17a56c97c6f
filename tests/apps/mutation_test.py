#!/usr/bin/env python3
"""Every command that reads a file, on files that were damaged: nothing may come of it but a result or one line.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml mutation_test.py
    ABBE_MUTATIONS=100 ABBE_MUTATION_SEED=7 ...    many more of them, other ones

Each file is damaged in the ways of KINDS. The program must end by itself with an exit code of 0 to 4, in bounded
time and memory; a refusal is one line that names the file and says nothing of C++; and only a result that was asked
for is left behind.
"""
import dataclasses
import os
import pathlib
import random
import resource
import shutil
import subprocess
import tempfile
import unittest

from map_machine import MapMachine
from program_case import MACHINE, PROGRAM

PER_FILE = int(os.environ.get("ABBE_MUTATIONS", "6"))  # of each command and file
SEED = int(os.environ.get("ABBE_MUTATION_SEED", "1"))
CPU_S = 60
MEMORY = 4 << 30

# What a person never reads.
INTERNAL = ("bad_alloc", "std::", "vector::", "basic_string", "json.exception", "terminate called", "stod", "stoi",
            "Assertion", "map::at", "out_of_range")
# Written in place of a number.
NUMBERS = (b"1e308", b"-1e308", b"1e-308", b"nan", b"inf", b"-1", b"0", b"99999999999999999999", b"1e400", b"",
           b"2147483648", b"1,5")


def lines_of(data):
    return data.splitlines(keepends=True)


def flip_bits(data, draw):
    data = bytearray(data)
    for _ in range(draw.randint(1, 4)):
        data[draw.randrange(len(data))] ^= 1 << draw.randrange(8)
    return bytes(data)


def cut(data, draw):
    return data[:draw.randrange(len(data))]


def double_a_line(data, draw):
    lines = lines_of(data)
    at = draw.randrange(len(lines))
    return b"".join(lines[:at + 1] + lines[at:])


def leave_out_a_line(data, draw):
    lines = lines_of(data)
    at = draw.randrange(len(lines))
    return b"".join(lines[:at] + lines[at + 1:])


def crlf(data, draw):
    return data.replace(b"\n", b"\r\n")


def byte_order_mark(data, draw):
    return b"\xef\xbb\xbf" + data


def put_nul(data, draw):
    at = draw.randrange(len(data))
    return data[:at] + b"\0" + data[at:]


def another_number(data, draw):
    """In place of a run of digits."""
    places = [i for i in range(len(data)) if 48 <= data[i] < 58]
    if not places:
        return flip_bits(data, draw)
    first = last = draw.choice(places)
    while first > 0 and data[first - 1:first] in b"0123456789.-":
        first -= 1
    while last < len(data) and data[last:last + 1] in b"0123456789.":
        last += 1
    return data[:first] + draw.choice(NUMBERS) + data[max(last, first + 1):]


def swap_pieces(data, draw):
    first, second = sorted(draw.randrange(len(data)) for _ in range(2))
    return data[second:] + data[first:second] + data[:first]


KINDS = (flip_bits, another_number, cut, double_a_line, another_number, leave_out_a_line, put_nul, another_number, crlf,
         byte_order_mark, swap_pieces, flip_bits)


@dataclasses.dataclass
class Job:
    """A command line; {file} of the words stand in the folder, outputs are the files that it may leave."""
    words: str
    damaged: tuple
    outputs: tuple = ()


JOBS = (
    Job("convert sweep.csv {out}.h5", ("sweep.csv",), ("{out}.h5",)),
    Job("convert sweep.h5 {out}.csv", ("sweep.h5",), ("{out}.csv",)),
    Job("convert targets.dat {out}.csv", ("targets.dat",), ("{out}.csv",)),
    Job("convert holes.txt {out}.csv --probing-um 3", ("holes.txt",), ("{out}.csv",)),
    Job("convert table.csv {out}.csv --column shaft_deg=counts*0.005 --column gap_1_mm=gap --kind shaft", ("table.csv",),
        ("{out}.csv",)),
    Job("convert monitor.log {out}.csv --column gap_mm=W:gap --column shaft_deg=W:angle", ("monitor.log",),
        ("{out}.csv",)),
    Job("convert can.log {out}.csv --machine mill.toml", ("can.log", "mill.toml"), ("{out}.csv",)),
    Job("reduce sweep.csv --machine mill.toml --json {out}.json", ("sweep.csv", "mill.toml"), ("{out}.json",)),
    Job("reduce sweep.h5 --machine mill.toml --json {out}.json", ("sweep.h5",), ("{out}.json",)),
    Job("reduce sweep.csv --machine mill.toml --causes causes.toml --json {out}.json", ("causes.toml",),
        ("{out}.json",)),
    Job("reduce targets.csv --json {out}.json", ("targets.csv",), ("{out}.json",)),
    Job("circle circle.csv --json {out}.json", ("circle.csv",), ("{out}.json",)),
    Job("harmonics turn.csv --angle shaft_deg --of gap_mm --json {out}.json", ("turn.csv",), ("{out}.json",)),
    Job("calibrate cube.csv --machine mill.toml --folds 1 -o {out}.toml", ("cube.csv",), ("{out}.toml",)),
    Job("circle linkage.csv --machine mill.toml --calibration linkage.toml --json {out}.json", ("linkage.toml",),
        ("{out}.json",)),
    Job("path square.csv --machine mill.toml --test square --json {out}.json", ("square.csv",), ("{out}.json",)),
    Job("path square.csv --machine mill.toml --test path.csv --json {out}.json", ("path.csv",), ("{out}.json",)),
    Job("diagnose sweep.csv --machine mill.toml -o {out}.toml --json {out}.json", ("sweep.csv", "mill.toml"),
        ("{out}.toml", "{out}.json")),
    Job("fuse sweep.csv --machine mill.toml --fixed-smoothness -o {out}.toml --json {out}.json",
        ("sweep.csv", "mill.toml"), ("{out}.toml", "{out}.json")),
    Job("fuse sweep.csv --machine mill.toml --fixed-smoothness --causes causes.toml -o {out}.toml", ("causes.toml",),
        ("{out}.toml",)),
    Job("plate holes.csv --machine mill.toml -o {out}.toml", ("holes.csv",), ("{out}.toml",)),
    Job("export map.toml --format csv --points 3 --out {out}.csv", ("map.toml",), ("{out}.csv",)),
    Job("export map.isg --chain [w.X.Y.b.Z.t] --format csv --points 3 --out {out}.csv", ("map.isg",), ("{out}.csv",)),
    Job("export map.etalon --chain [w.X.Y.b.Z.t] --format csv --points 3 --out {out}.csv", ("map.etalon",),
        ("{out}.csv",)),
    Job("simulate map.toml --test freeform --path path.csv --json {out}.json", ("path.csv",), ("{out}.json",)),
    Job("correct map.toml points.csv --out {out}.csv", ("points.csv",), ("{out}.csv",)),
    Job("correct map.toml part.ngc --start 30,30,30 --out {out}.ngc", ("part.ngc",), ("{out}.ngc",)),
    Job("report results --out {out}.html", ("results/sweep.json",), ("{out}.html",)),
    Job("rig compare truth.json results/sweep.json", ("truth.json", "results/sweep.json")),
    Job("rig record --machine mill.toml --course path.csv --out {out}.csv", ("path.csv",), ("{out}.csv",)),
    Job("sensitivity --linkage mill.toml --draws 16 --points 2 --json {out}.json", ("mill.toml",), ("{out}.json",)),
)


def limits():
    resource.setrlimit(resource.RLIMIT_CPU, (CPU_S, CPU_S))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def words_of(job, out):
    return [word.replace(".", " ") if word.startswith("[w") else word.replace("{out}", out)
            for word in job.words.split()]


class MutationTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.make_inputs()

    @classmethod
    def abbe(cls, *words):
        done = subprocess.run([PROGRAM, *map(str, words)], cwd=cls.folder, capture_output=True, text=True, timeout=250)
        if done.returncode != 0:
            raise AssertionError(f"{words}: {done.stderr}")

    @classmethod
    def make_inputs(cls):
        put = lambda name, text: (cls.folder / name).write_text(text)
        (cls.folder / "results").mkdir()
        text = pathlib.Path(MACHINE).read_text().replace("step_mm = 1.0", "step_mm = 15.0").replace(
            "passes = 5", "passes = 2")
        put("mill.toml", text)
        record = lambda name, *words: cls.abbe("rig", "record", "--machine", "mill.toml", "--out", name, *words)
        record("sweep.csv", "--axis", "X", "--rate", 20, "--truth", "truth.json")
        cls.abbe("convert", "sweep.csv", "sweep.h5")
        record("cube.csv", "--course", "cube", "--points", "4,3,3", "--dwell", 0.01, "--reference", "--feed", 6000)
        record("linkage.csv", "--course", "circle", "--size", 10, "--rate", 20)
        record("circle.csv", "--course", "circle", "--size", 10, "--rate", 20, "--kind", "reference")
        record("square.csv", "--course", "square", "--kind", "reference", "--size", 10, "--rate", 20)
        record("holes.csv", "--plate")
        cls.abbe("calibrate", "cube.csv", "--machine", "mill.toml", "--folds", 1, "-o", "linkage.toml", "--quiet")
        cls.abbe("reduce", "sweep.csv", "--machine", "mill.toml", "--json", "results/sweep.json", "--quiet")
        MapMachine(7).write(cls.folder / "map.toml")
        for form in ("isg", "etalon"):
            cls.abbe("export", "map.toml", "--format", form, "--points", 7, "--out", f"map.{form}", "--quiet")
        put("causes.toml", 'extended_model = 1\nmachine = "demo-mill"\n'
                           '[[cause]]\nid = "probe-gain"\nobject = "probe_b"\ndelta = 0.05\n')
        put("targets.dat", "UNIT=mm\nCYCLES=2\nPOSITIONS=3\n" + "".join(
            f"TGT_DATA[{i}]={10 * i}\n" + "".join(f"REF_DATA_{way}[{i},{j}]={10 * i + 0.001 * j}\n"
                                                   for j in (1, 2) for way in ("FWD", "BWD")) for i in (1, 2, 3)))
        cls.abbe("convert", "targets.dat", "targets.csv")
        put("holes.txt", "Plug Plate: 1597A\n    Meas X    Meas Y     Nom X     Nom Y\n" + "".join(
            f"   {10.1 * i:.3f}   {-9.9 * i:.3f}   {10 * i:.3f}   {-10 * i:.3f}\n" for i in range(1, 9)))
        put("table.csv", "counts,gap,note\n" + "".join(f"{100 * i},{0.5 + 0.001 * i},fine\n" for i in range(20)))
        put("monitor.log", "".join(f"W:angle 2026-11-21 09:00:{i:02}.000000 {12.5 * i}\n"
                                   f"W:gap 2026-11-21 09:00:{i:02}.500000 {0.5 + 0.01 * i} HIGH\n" for i in range(40)))
        put("turn.csv", '# abbe-recording = 1\n# kind = "dwell"\ntime_s,shaft_deg,gap_mm,flags\n' + "".join(
            f"{0.1 * i:.1f},{12 * i % 360},{0.5 + 0.01 * (i % 30)},0\n" for i in range(120)))
        put("can.log", "".join(f"(17637168{i:02}.000000) vcan0 080#\n" + "".join(
            f"(17637168{i:02}.000{node}00) vcan0 18{node}#0{i % 10}000400\n" for node in (1, 2, 3)) for i in range(20)))
        put("path.csv", "x_mm,y_mm,z_mm\n" + "".join(f"{20 + i},{30 - i},{25 + 0.5 * i}\n" for i in range(8)))
        shutil.copy(cls.folder / "path.csv", cls.folder / "points.csv")
        put("part.ngc", "%\n(a part)\nG21 G90 G17\nG0 X10 Y10 Z20\nG1 Z10 F300\nG1 X20\nG2 X30 Y20 I0 J10\n"
                        "G3 X20 Y30 R10\nG91\nG1 X-5 Y1.5\nG90\nM2\n%\n")

    def run_job(self, job, out):
        return subprocess.run([PROGRAM, *words_of(job, out)], cwd=self.folder, capture_output=True, timeout=10 * CPU_S,
                              preexec_fn=limits, env={**os.environ, "OPENBLAS_NUM_THREADS": "1"})

    def files(self):
        return {path for path in self.folder.rglob("*") if path.is_file()}

    def judge(self, job, name, done, before):
        """What is wrong with this run, or nothing."""
        error = done.stderr.decode(errors="replace")
        allowed = {self.folder / output.replace("{out}", "new") for output in job.outputs}
        left = self.files() - before
        if not 0 <= done.returncode <= 4:
            return f"ended with {done.returncode}: {error}"
        for word in INTERNAL:
            if word in error:
                return f"says {word}: {error}"
        if done.returncode in (0, 1):
            return f"left {left - allowed}" if left - allowed else None
        if left:
            return f"refused, but left {left}"
        refusal = error.strip().splitlines()[-1:] or [""]
        if not refusal[0].startswith("abbe: "):
            return f"no line of its own: {error}"
        # A report names the folder in which it found no result.
        named = pathlib.Path(name).name in refusal[0] or f"abbe: {pathlib.Path(name).parent}:" in refusal[0]
        if done.returncode == 2 and not named:
            return f"does not name the file: {refusal[0]}"
        return None

    def test_the_jobs_are_good(self):
        for job in JOBS:
            with self.subTest(job.words):
                before = self.files()
                done = self.run_job(job, "new")
                self.assertIn(done.returncode, (0, 1), done.stderr.decode())
                for path in self.files() - before:
                    path.unlink()

    def test_nothing_comes_of_damage_but_a_result_or_one_line(self):
        runs = 0
        for number, job in enumerate(JOBS):
            for name in job.damaged:
                whole = (self.folder / name).read_bytes()
                for i in range(PER_FILE):
                    draw = random.Random(f"{SEED} {number} {name} {i}")
                    kind = KINDS[(i + number) % len(KINDS)]
                    (self.folder / name).write_bytes(kind(whole, draw))
                    before = self.files()
                    with self.subTest(job.words, file=name, kind=kind.__name__, number=i):
                        wrong = self.judge(job, name, self.run_job(job, "new"), before)
                        if wrong:
                            self.fail(wrong)
                    runs += 1
                    for path in self.files() - before:
                        path.unlink()
                (self.folder / name).write_bytes(whole)
        print(f"{runs} damaged files")


if __name__ == "__main__":
    unittest.main()
