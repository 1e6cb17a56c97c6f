#!/usr/bin/env python3
"""An investigation from nothing, as a user would make it: by the rig, by an operator, killed on the way.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml investigate_test.py
"""
import json
import pathlib
import signal
import subprocess
import time
import unittest

from program_case import MACHINE, PROGRAM, ProgramCase

WORLD = "seed=7,hide=backlash:object=X:width_um=3"


def decisions(folder):
    """What was chosen and what came; without the instants of the clock."""
    journal = json.loads((folder / "investigation.json").read_text())
    return [(step["text"], step["bits"], step["minutes"], step["after"]) for step in journal["steps"]], journal["ended"]


class InvestigateTest(ProgramCase):
    command = "investigate"

    def setUp(self):
        super().setUp()
        self.mill = self.path / "mill.toml"  # the ball does not trail in its cap: that is a cause of its own
        self.mill.write_text(pathlib.Path(MACHINE).read_text().replace("[devices]\n", "[rig]\ncap_um = 0.0\n[devices]\n", 1))

    def arguments(self, folder, *more):
        return ("--machine", self.mill, "--budget", "31min", "--out", folder, *more)

    def test_finds_the_cause_and_writes_down_why(self):
        found = self.path / "found"
        text = self.done(*self.arguments(found, "--rig", WORLD))
        steps, ended = decisions(found)
        self.assertEqual((ended["verdict"], ended["certain"]), ("explained", True), text)
        self.assertEqual([each["name"] for each in steps[-1][3]["findings"]], ["backlash:X"])
        told = (found / "investigation.txt").read_text()
        for words in ("expected:", "weighed:", "came: explained", "the verdict is certain"):
            self.assertIn(words, told)
        self.assertLessEqual(ended["minutes"], 31.0)
        self.assertEqual(json.loads((found / "diagnosis.json").read_text())["verdict"], "explained")
        # The truth is in no file of the folder.
        for file in found.iterdir():
            self.assertNotIn(b"hide", file.read_bytes(), file)
        self.done(found, command="report")
        self.assertIn("investigation.json", (found / "report.html").read_text())

        self.refuse(*self.arguments(found, "--rig", "seed=8"), saying=["investigation.json", "another folder"])

    def test_goes_on_after_a_kill(self):
        whole, broken = self.path / "whole", self.path / "broken"
        clean = "seed=7"  # two runs in 31 minutes
        self.done(*self.arguments(whole, "--rig", clean))
        process = subprocess.Popen([PROGRAM, "investigate", *map(str, self.arguments(broken, "--rig", clean))],
                                   stdout=subprocess.DEVNULL)
        deadline = time.monotonic() + 120
        while not list(broken.glob("01_*.h5")) and time.monotonic() < deadline:
            time.sleep(0.005)
        process.send_signal(signal.SIGKILL)
        process.wait()
        self.assertFalse((broken / "diagnosis.json").exists())
        first = next(broken.glob("01_*.h5"))
        made = first.stat().st_mtime_ns
        noted = "file" in json.loads((broken / "investigation.json").read_text())["steps"][0]
        self.done(*self.arguments(broken, "--rig", clean))
        if noted:  # what was recorded stays
            self.assertEqual(first.stat().st_mtime_ns, made)
        self.assertEqual(decisions(broken), decisions(whole))

    def test_an_operator_records(self):
        machine = self.path / "machine"
        begin = self.done(*self.arguments(machine, "--devices"))  # nobody answers
        self.assertIn("call the same command again", begin)
        program = (machine / "01.ngc").read_text()
        self.assertIn("G21", program)
        self.assertTrue(program.endswith("M2\n"))
        step = json.loads((machine / "investigation.json").read_text())["steps"][0]
        self.assertNotIn("file", step)
        self.assertIn("circle in XY", step["text"])

        recorded = self.rig_record("made.h5", "--course", "circle", "--feed", 120, "--rate", 5,
                                   "--hide", "backlash:object=X:width_um=3", machine=self.mill)
        sweep = self.rig_record("sweep.h5", "--axis", "X", "--rate", 20, machine=self.mill)
        run = subprocess.run([PROGRAM, "investigate", *map(str, self.arguments(machine, "--devices"))],
                             input=f"{sweep}\n{recorded}\n", capture_output=True, text=True, timeout=250)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('is of kind "sweep"; this run is a "linkage"', run.stderr)
        steps, ended = decisions(machine)
        self.assertEqual((ended["verdict"], ended["certain"]), ("explained", True), run.stdout)
        self.assertEqual([each["name"] for each in steps[-1][3]["findings"]], ["backlash:X"])

    def test_refuses_what_it_cannot_do(self):
        self.refuse(*self.arguments(self.path / "x"), saying=["--devices", "--rig"])
        self.refuse(*self.arguments(self.path / "x", "--rig", "sed=7"), saying=['"sed=7"', "seed=NUMBER"])
        self.refuse("--machine", self.mill, "--budget", "soon", "--out", self.path / "x", "--rig", "seed=7",
                    saying=["--budget soon", "45min"])


if __name__ == "__main__":
    unittest.main()
