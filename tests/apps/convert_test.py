#!/usr/bin/env python3
"""`abbe convert` as a script sees it: the files, the messages, the exit codes.

    ABBE=path/to/abbe convert_test.py
"""
import os
import pathlib
import subprocess
import tempfile
import unittest

ABBE = os.environ["ABBE"]
TABLE = "UNIT=mm\nCYCLES=2\nPOSITIONS=2\n" + "".join(
    f"TGT_DATA[{i}]={10 * i}\n"
    + "".join(f"REF_DATA_{way}[{i},{j}]={10 * i + 0.001 * j}\n" for j in (1, 2) for way in ("FWD", "BWD"))
    for i in (1, 2)
)
RECORDING = "# abbe-recording = 1\n# kind = \"dwell\"\n# by = \"hand\"\ntime_s,mood,flags\n"
ROWS = "0,0.1,0\n0.5,-1e-07,0\n1,nan,2\n"


class ConvertTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))

    def convert(self, source, target, *options):
        paths = [self.folder / source, self.folder / target]
        return subprocess.run([ABBE, "convert", *paths, *options], capture_output=True, text=True)

    def put(self, name, text):
        (self.folder / name).write_text(text)

    def assert_refused(self, done, *words):
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

    def test_there_and_back_is_the_same_file(self):
        self.put("a.csv", RECORDING + ROWS)
        for source, target in (("a.csv", "b.h5"), ("b.h5", "c.csv"), ("c.csv", "d.hdf5"), ("d.hdf5", "e.csv")):
            done = self.convert(source, target)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("dwell, 3 rows, 3 columns", done.stdout)
        for name in ("c.csv", "e.csv"):
            self.assertEqual((self.folder / name).read_text(), RECORDING + ROWS)

    def test_what_exists_is_not_overwritten(self):
        self.put("a.csv", RECORDING + ROWS)
        self.put("b.csv", "precious")
        self.assert_refused(self.convert("a.csv", "b.csv"), "b.csv: exists already")
        self.assert_refused(self.convert("a.csv", "a.csv"), "a.csv: exists already")
        self.assertEqual((self.folder / "b.csv").read_text(), "precious")

    def test_a_log_of_candump_needs_the_machine_file_and_names_its_wrong_line(self):
        self.put("bus.log", "(1763716801.000000) vcan0 080#\n(1763716801.000200) vcan0 181#00000400\n")
        self.assert_refused(self.convert("bus.log", "a.csv"), "--machine")
        machine = ("--machine", os.environ["ABBE_MACHINE"])
        done = self.convert("bus.log", "a.csv", *machine)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.put("bus.log", "(1763716801.000000) vcan0 080#\n(1763716801.000200) vcan0 18#00000400\n")
        self.assert_refused(self.convert("bus.log", "b.csv", *machine), "bus.log:2: ")
        self.put("bus.log", "(1763716801.000000) can5 080#\n")
        self.assert_refused(self.convert("bus.log", "b.csv", *machine), "has no frames of vcan0, but of can5")
        self.assertFalse((self.folder / "b.csv").exists())

    def test_a_cut_file_is_converted_with_a_warning(self):
        self.put("a.csv", RECORDING + ROWS + "1.5,0.")
        done = self.convert("a.csv", "b.csv", "--quiet")
        self.assertEqual((done.returncode, done.stdout), (0, ""))
        self.assertIn("a.csv:8: ", done.stderr)
        self.assertEqual((self.folder / "b.csv").read_text(), RECORDING + ROWS)

    def test_bad_input_is_one_line(self):
        self.put("a.csv", RECORDING + "0,1\n")
        self.assert_refused(self.convert("a.csv", "b.h5"), "a.csv:5: ", "2 fields")
        self.assert_refused(self.convert("none.csv", "b.h5"), "No such file")
        self.put("c.csv", RECORDING + ROWS)
        self.assert_refused(self.convert("c.csv", "b.txt"), "b.txt", ".csv, .h5 or .hdf5")
        self.assert_refused(self.convert("c.csv", "none/b.csv"), "cannot be created")
        self.assertEqual(sorted(p.name for p in self.folder.iterdir()), ["a.csv", "c.csv"])

    def test_an_option_of_another_program_s_file_is_not_ignored(self):
        self.put("poses.csv", "S,T\n1,2\n")
        self.assert_refused(self.convert("poses.csv", "b.csv", "--column", "a_rad=S", "--axis", "Y"), "--axis", "--column")

    def test_a_table_becomes_a_recording(self):
        self.put("a.dat", TABLE)
        done = self.convert("a.dat", "a.csv", "--axis", "Y")
        self.assertEqual(done.returncode, 0, done.stderr)
        lines = (self.folder / "a.csv").read_text().splitlines()
        self.assertEqual(lines[0], "# abbe-recording = 1")
        names, *rows = [line.split(",") for line in lines if not line.startswith("#")]
        rows = [dict(zip(names, map(float, row))) for row in rows]
        self.assertEqual(len(rows), 8)
        self.assertEqual({row["y_mm"] for row in rows}, {10.0, 20.0})
        for row in rows:
            self.assertAlmostEqual(row["ref_y_mm"], row["y_mm"] + 0.001 * row["pass"], delta=1e-9)


if __name__ == "__main__":
    unittest.main()
