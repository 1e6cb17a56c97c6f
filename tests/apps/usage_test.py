#!/usr/bin/env python3
"""What the program says to words that it does not know.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml usage_test.py
"""
import os
import subprocess
import unittest
from unittest import mock

from program_case import MACHINE, PROGRAM, ProgramCase


class UsageTest(ProgramCase):
    command = "diagnose"

    def test_misspelt_option(self):
        self.refuse("a.h5", "--machin", "m.toml",
                    saying=["--machin: abbe diagnose has no such option", "did you mean --machine?", "abbe diagnose --help"])
        self.refuse("a.h5", "--machine", "m.toml", "--jsn=x", saying=["--jsn:", "did you mean --json?"])

    def test_misspelt_option_of_an_inner_command(self):
        run = self.run_program("--sed", "3", command="rig record")
        self.assertEqual(run.returncode, 2)
        self.assertIn("--sed: abbe rig record has no such option; did you mean --seed?", run.stderr)

    def test_misspelt_command(self):
        run = self.run_program(command="diagnoze")
        self.assertEqual(run.returncode, 2)
        self.assertIn('did you mean "abbe diagnose"?', run.stderr)

    def test_a_word_that_is_near_to_nothing(self):
        run = self.run_program("a.csv", "--axis", "X", command="reduce")
        self.assertEqual(run.returncode, 2)
        self.assertIn("--axis: abbe reduce has no such option; see abbe reduce --help", run.stderr)

    def test_a_place_that_cannot_be_written_is_refused_before_any_work(self):
        folder = self.path / "read_only"
        folder.mkdir()
        folder.chmod(0o555)
        self.path.chmod(0o755)
        nobody = {"user": 65534} if os.geteuid() == 0 else {}  # root may write everywhere
        for place in (folder / "d.json", folder / "new" / "d.json"):
            run = subprocess.run([PROGRAM, "diagnose", "missing.h5", "--machine", MACHINE, "--json", place],
                                 capture_output=True, text=True, timeout=60, **nobody)
            self.assertEqual(run.returncode, 2, run.stderr)
            self.assertIn(f"{place}: cannot be created: Permission denied; choose a folder", run.stderr)

    def test_a_message_brings_no_control_characters_of_a_file(self):
        (self.path / "a.dat").write_bytes(b"CYCLES=2\x1b[31m\x07\x0b\n")
        run = self.run_program(self.path / "a.dat", self.path / "b.csv", command="convert")
        self.assertEqual(run.returncode, 2)
        self.assertIn("a.dat:1: ", run.stderr)
        self.assertTrue(run.stderr.rstrip("\n").isprintable(), repr(run.stderr))

    def test_a_number_that_is_none_is_named_in_one_line(self):
        for word in ("abc", "-3", "0", "nan"):
            run = self.run_program("a.csv", f"--radius={word}", command="circle")
            self.assertEqual(run.returncode, 2)
            self.assertIn(f"--radius: {word} is no number above 0; see abbe circle --help", run.stderr)

    def test_missing_option(self):
        self.refuse("a.h5", saying=["--machine is required", "abbe diagnose --help"])

    def test_openblas_without_threads(self):
        with mock.patch.dict(os.environ, LD_PRELOAD=os.environ["OPENBLAS_WITHOUT_THREADS"]):
            self.refuse("a.h5", saying=["built without threads", "install libopenblas0-pthread"])


if __name__ == "__main__":
    unittest.main()
