"""A test case for one subcommand of the program: runs it in a folder of its own, as a user would."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["ABBE"]
MACHINE = os.environ["ABBE_MACHINE"]


class ProgramCase(unittest.TestCase):
    command = None  # of the subclass

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = pathlib.Path(folder.name)

    def run_program(self, *arguments, command=None):
        return subprocess.run([PROGRAM, *(command or self.command).split(), *map(str, arguments)],
                              capture_output=True, text=True, timeout=250)

    def done(self, *arguments, command=None):
        """What the program prints; it must succeed."""
        run = self.run_program(*arguments, command=command)
        self.assertEqual(run.returncode, 0, run.stderr)
        return run.stdout

    def result(self, *arguments):
        self.done(*arguments, "--json", self.path / "result.json")
        return json.loads((self.path / "result.json").read_text())

    def refuse(self, *arguments, saying):
        """Bad input: one line that says all of `saying`."""
        run = self.run_program(*arguments)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        for text in saying:
            self.assertIn(text, run.stderr)

    def rig_record(self, name, *arguments, machine=MACHINE, seed=7):
        """A recording of the virtual rig."""
        path = self.path / name
        self.done("--machine", machine, "--seed", seed, "--out", path, "--force", *arguments, command="rig record")
        return path
