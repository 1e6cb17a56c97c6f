#!/usr/bin/env python3
"""What the program says to words that it does not know.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml usage_test.py
"""
import os
import unittest
from unittest import mock

from program_case import ProgramCase


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

    def test_missing_option(self):
        self.refuse("a.h5", saying=["--machine is required", "abbe diagnose --help"])

    def test_openblas_without_threads(self):
        with mock.patch.dict(os.environ, LD_PRELOAD=os.environ["OPENBLAS_WITHOUT_THREADS"]):
            self.refuse("a.h5", saying=["built without threads", "install libopenblas0-pthread"])


if __name__ == "__main__":
    unittest.main()
