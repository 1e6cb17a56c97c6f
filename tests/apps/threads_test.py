#!/usr/bin/env python3
"""What a command works out is the same to the last bit on one processor and on all of them.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml threads_test.py
"""
import os
import subprocess
import unittest

from program_case import MACHINE, PROGRAM, ProgramCase


class ThreadsTest(ProgramCase):
    def on(self, processors, arguments, files):
        """Standard output and files of a run that may use these processors only."""
        folder = self.path / f"on_{len(processors)}"
        folder.mkdir(exist_ok=True)
        run = subprocess.run([PROGRAM, *map(str, arguments), "--machine", MACHINE], cwd=folder, timeout=250,
                             capture_output=True, preexec_fn=lambda: os.sched_setaffinity(0, processors))
        self.assertEqual(run.returncode, 0, run.stderr)
        return [run.stdout] + [(folder / name).read_bytes() for name in files]

    def same(self, *arguments, files):
        processors = os.sched_getaffinity(0)
        if len(processors) < 2:
            self.skipTest("has one processor only")
        one = self.on({min(processors)}, arguments, files)
        self.assertTrue(all(one))
        self.assertEqual(one, self.on(processors, arguments, files))

    def campaign(self, *hidden):
        folder = self.rig_record("campaign", "--campaign", "standard", "--reduced", *hidden)
        return sorted(folder.glob("*.h5"))

    def test_diagnose(self):
        recordings = self.campaign("--hide", "backlash:object=X:width_um=6")
        self.same("diagnose", *recordings, "--json", "d.json", "-o", "causes.toml", files=["d.json", "causes.toml"])

    def test_plan(self):
        self.same("diagnose", *self.campaign(), "--plan", "--json", "plan.json", files=["plan.json"])

    def test_fuse(self):
        runs = [run for run in self.campaign() if "dwell" not in run.name]
        self.same("fuse", *runs, "--json", "fuse.json", "-o", "map.toml", files=["fuse.json", "map.toml"])

    def test_plate(self):
        plate = self.rig_record("plate.csv", "--plate")
        self.same("plate", plate, "--holdout", 4, "--network", "--json", "plate.json", "-o", "map.toml",
                  files=["plate.json", "map.toml"])


if __name__ == "__main__":
    unittest.main()
