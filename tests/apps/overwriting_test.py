#!/usr/bin/env python3
"""What no command destroys: what it reads, what was recorded, files of another kind, devices and links.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml overwriting_test.py
"""
import os
import pathlib
import resource
import signal
import stat
import subprocess
import threading
import unittest

from map_machine import MapMachine
from program_case import MACHINE, PROGRAM, ProgramCase


class OverwritingTest(ProgramCase):
    command = ""

    def setUp(self):
        super().setUp()
        text = pathlib.Path(MACHINE).read_text().replace("step_mm = 1.0", "step_mm = 15.0")
        self.machine = self.path / "mill.toml"
        self.machine.write_text(text.replace("passes = 5", "passes = 2"))
        MapMachine(7).write(self.path / "map.toml")
        (self.path / "pts.csv").write_text("x_mm,y_mm,z_mm\n10,10,10\n")
        (self.path / "p.ngc").write_text("G21 G90\nG1 X10 F100\n")
        self.run_in("rig", "record", "--machine", "mill.toml", "--axis", "X", "--rate", "20", "--out", "sX.csv")

    def run_in(self, *words, **options):
        return subprocess.run([PROGRAM, *words], cwd=self.path, capture_output=True, text=True, timeout=250, **options)

    def everything(self):
        return {path.relative_to(self.path): path.read_bytes() for path in self.path.rglob("*") if path.is_file()}

    def refused(self, line, saying, code=2):
        before = self.everything()
        run = self.run_in(*line.split())
        self.assertEqual(run.returncode, code, f"{line}: {run.stdout}{run.stderr}")
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        self.assertIn(saying, run.stderr)
        self.assertEqual(self.everything(), before, line)

    def test_nothing_that_matters_is_written_over(self):
        for line in ("reduce sX.csv --machine mill.toml --json sX.csv",
                     "reduce sX.csv --machine mill.toml --json ./mill.toml",
                     "fuse sX.csv --machine mill.toml -o sX.csv",
                     "calibrate sX.csv --machine mill.toml -o sX.csv",
                     "convert sX.csv sX.csv",
                     "correct map.toml p.ngc --start 1,1,1 --out ./p.ngc",
                     "correct map.toml pts.csv --out map.toml",
                     "rig record --machine mill.toml --axis X --truth mill.toml --out x.csv"):
            self.refused(line, "this command reads it")
        for line in ("rig record --machine mill.toml --axis Y --out sX.csv",
                     "correct map.toml pts.csv --out sX.csv",
                     "export map.toml --format csv --out sX.csv",
                     "simulate map.toml --test diagonals --json sX.csv"):
            self.refused(line, "nothing recorded is overwritten")
        for line in ("simulate map.toml --test diagonals --json mill.toml",
                     "export map.toml --format csv --out mill.toml",
                     "simulate map.toml --test diagonals --json p.ngc",
                     "correct map.toml pts.csv --out mill.toml"):
            self.refused(line, "exists already and holds")
        (self.path / "out").mkdir()
        self.run_in("reduce", "sX.csv", "--machine", "mill.toml", "--json", "out/x.json")
        for line, saying in (("report out --out sX.csv", "nothing recorded is overwritten"),
                             ("report out --out out/x.json", "holds JSON, but a page"),
                             ("report out --out mill.toml", "holds your settings")):
            self.refused(line, saying)

    def test_its_own_kind_and_force(self):
        for _ in range(2):
            run = self.run_in("simulate", "map.toml", "--test", "diagonals", "--json", "result.json")
            self.assertEqual(run.returncode, 0, run.stderr)
        run = self.run_in("simulate", "map.toml", "--test", "diagonals", "--json", "sX.csv", "--force")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertTrue((self.path / "sX.csv").read_text().startswith("{"))

    def test_a_link_is_followed_and_a_pipe_is_written_through(self):
        (self.path / "far").mkdir()
        (self.path / "near.json").symlink_to("far/result.json")
        simulate = ("simulate", "map.toml", "--test", "diagonals", "--quiet", "--json")
        self.assertEqual(self.run_in(*simulate, "near.json").returncode, 0)
        self.assertTrue((self.path / "near.json").is_symlink())
        self.assertTrue((self.path / "far/result.json").read_text().startswith("{"))
        os.mkfifo(self.path / "pipe")
        got = []
        reader = threading.Thread(target=lambda: got.append((self.path / "pipe").read_text()))
        reader.start()
        self.assertEqual(self.run_in(*simulate, "pipe").returncode, 0)
        reader.join()
        self.assertTrue(stat.S_ISFIFO((self.path / "pipe").stat().st_mode))
        self.assertEqual(got[0], (self.path / "far/result.json").read_text())

    def test_a_device_stays(self):
        device = self.path / "null"  # of our own: never risk that of the computer
        try:
            os.mknod(device, stat.S_IFCHR | 0o600, os.makedev(1, 3))
            device.write_bytes(b"")
        except OSError:
            self.skipTest("needs root and a folder with devices")
        for words in (("simulate", "map.toml", "--test", "diagonals", "--json", "null"),
                      ("correct", "map.toml", "p.ngc", "--start", "1,1,1", "--out", "null"),
                      ("rig", "record", "--machine", "mill.toml", "--axis", "X", "--rate", "20", "--out", "sY.csv",
                       "--truth", "null")):
            self.assertEqual(self.run_in(*words).returncode, 0, words)
            self.assertTrue(stat.S_ISCHR(device.stat().st_mode), words)

    def test_a_full_disk_is_3_and_leaves_nothing(self):
        """A limit on the size of files stands for it; the kernel refuses both the same way."""
        def full():
            resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
        before = self.everything()
        for line in ("simulate map.toml --test diagonals --json new.json",
                     "export map.toml --format csv --out new.csv",
                     "export map.toml --format hdf5 --out new.h5",
                     "correct map.toml pts.csv --out map2.csv --json new.json",
                     "convert sX.csv new.csv", "convert sX.csv new.h5",
                     "rig record --machine mill.toml --axis X --rate 20 --out new.csv"):
            run = self.run_in(*line.split(), preexec_fn=full)
            (self.path / "map2.csv").unlink(missing_ok=True)
            self.assertEqual(run.returncode, 3, f"{line}: {run.stderr}")
            self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
            self.assertIn("disk full", run.stderr)
            self.assertEqual(self.everything(), before, line)

    def test_what_is_printed_may_not_fit_either(self):
        with open("/dev/full", "w") as full:
            run = subprocess.run([PROGRAM, "simulate", "map.toml", "--test", "diagonals"], cwd=self.path, stdout=full,
                                 stderr=subprocess.PIPE, text=True, timeout=250)
        self.assertEqual(run.returncode, 3, run.stderr)
        self.assertIn("standard output: cannot be written", run.stderr)

    def test_out_of_memory_is_said_in_words(self):
        def small():
            size = 300 << 20  # the program, but not the grid
            resource.setrlimit(resource.RLIMIT_AS, (size, size))
        run = self.run_in("export", "map.toml", "--format", "csv", "--points", "210", "--out", "new.csv", preexec_fn=small)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertNotIn("bad_alloc", run.stderr)
        self.assertFalse((self.path / "new.csv").exists())

    def test_sizes_are_bounded(self):
        record = "rig record --machine mill.toml --out new.csv "
        for line, saying in (("export map.toml --format csv --points 2000 --out new.csv", "take fewer"),
                             ("export map.toml --format csv --points=-5 --out new.csv", "at least 2 points"),
                             (record + "--course circle --feed 1e-9", "take a higher feed"),
                             (record + "--course cube --points 1000,1000,1000", "take fewer"),
                             (record + "--course cube --dwell 1e300", "take a higher feed"),
                             ("sensitivity --simulation I --draws 100 --threads 1000000", "--threads")):
            self.refused(line, saying)
        text = self.machine.read_text()
        self.machine.write_text(text.replace("[devices]", "[devices]\nmax_skew_ms = 1e300", 1))
        self.refused("reduce sX.csv --machine mill.toml", "max_skew_ms")

    def test_wrong_files_are_told_what_they_are(self):
        for name, saying in (("a.xlsx", "save its sheet as CSV"), ("a.mat", "writetable"),
                             ("mill.toml", "are two arguments swapped?"), ("p.ngc", "are two arguments swapped?")):
            if not (self.path / name).exists():
                (self.path / name).write_text("x")
            self.refused(f"reduce {name} --machine mill.toml", saying)
        self.refused("reduce mill.toml --machine sX.csv", "are two arguments swapped?")
        self.refused("convert pts.csv new.csv", "--column")


if __name__ == "__main__":
    unittest.main()
