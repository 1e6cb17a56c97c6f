"""`abbe convert` and `abbe harmonics` on the log of a channel monitor, as a user runs them."""
import json
import math
import os
import pathlib
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["ABBE"]
COLUMNS = ("--column", "shaft_deg=W:angle", "--column", "gap_mm=W:gap")


def moment(seconds):
    return f"2026-11-21 09:{int(seconds) // 60:02}:{seconds % 60:09.6f}"


def monitor_log(turns=3.0, period=10.0):
    """A shaft at 6 rpm: 0.5 mm and 30 um cos(angle) and 4 um sin(2 angle); the channels take turns."""
    lines = []
    for i in range(int(turns * period * 20)):
        time = i / 20
        lines.append(f"W:angle {moment(time)} {360 * (time / period % 1):.9f}")
        angle = 2 * math.pi * (time + 0.02) / period
        gap = 0.5 + 0.030 * math.cos(angle) + 0.004 * math.sin(2 * angle)
        lines.append(f"W:gap {moment(time + 0.02)} {gap:.12f} HIGH MINOR")
    return "\n".join(lines) + "\n"


class Harmonics(unittest.TestCase):
    def setUp(self):
        self.path = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (self.path / "turn.log").write_text(monitor_log())

    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)

    def converted(self):
        run = self.run_program("convert", self.path / "turn.log", self.path / "turn.csv", *COLUMNS)
        self.assertEqual(run.returncode, 0, run.stderr)
        return self.path / "turn.csv"

    def refusal(self, *arguments):
        run = self.run_program(*arguments)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertEqual(len(run.stderr.strip().splitlines()), 1, run.stderr)
        return run.stderr

    def test_finds_the_harmonics_of_the_log(self):
        run = self.run_program("harmonics", self.converted(), "--angle", "shaft_deg", "--of", "gap_mm", "--json",
                               self.path / "out.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        channel = json.loads((self.path / "out.json").read_text())["channels"][0]
        first, second = channel["harmonics"]
        self.assertAlmostEqual(channel["mean_um"], 500, places=4)
        self.assertAlmostEqual(first["cos_um"], 30, places=4)
        self.assertAlmostEqual(second["sin_um"], 4, places=4)
        self.assertLess(channel["held_out_rms_um"], 1e-3)
        self.assertGreater(channel["held_out_rms_without_um"], 20)
        self.assertIn("the second half by a fit of the first", run.stdout)

    def test_each_column_keeps_its_kind_of_unit(self):
        # The same wave as a length, an angle, a voltage and a plain number.
        rows = ["time_s,shaft_deg,flag,gap_mm,tilt_deg,tilt_mrad,supply_v,counts"]
        for i in range(400):
            angle = 0.05 * i
            wave = 0.030 * math.cos(angle)
            rows.append(f"{i / 10},{math.degrees(angle) % 360!r},0,{wave!r},{wave!r},{wave!r},{wave!r},{wave!r}")
        path = self.path / "units.csv"
        path.write_text("# abbe-recording = 1\n# kind = \"dwell\"\n" + "\n".join(rows) + "\n")
        run = self.run_program("harmonics", path, "--angle", "shaft_deg", "--of",
                               "gap_mm,tilt_deg,tilt_mrad,supply_v,counts", "--json", self.path / "out.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        channels = json.loads((self.path / "out.json").read_text())["channels"]
        self.assertEqual([channel["unit"] for channel in channels], ["um", "urad", "urad", "V", ""])
        cosines = [channel["harmonics"][0][key] for channel, key in
                   zip(channels, ("cos_um", "cos_urad", "cos_urad", "cos_v", "cos"))]
        for found, true in zip(cosines, (30.0, 1e6 * math.radians(0.030), 30.0, 0.030, 0.030)):
            self.assertAlmostEqual(found, true, delta=1e-9 * true)
        self.assertIn("tilt_deg: 400 readings, in urad", run.stdout)
        self.assertIn("residuals 0.00 V rms", run.stdout)

    def test_refuses_in_one_line(self):
        log = self.path / "turn.log"
        self.assertIn("name the channels as columns", self.refusal("convert", log, self.path / "a.csv"))
        self.assertIn("is not NAME=CHANNEL", self.refusal("convert", log, self.path / "a.csv", "--column", "gap_mm"))
        self.assertIn("the log has W:angle, W:gap",
                      self.refusal("convert", log, self.path / "a.csv", "--column", "gap_mm=W:gab"))
        self.assertIn("is no angle by its name",
                      self.refusal("harmonics", self.converted(), "--angle", "gap_mm", "--of", "gap_mm"))
        self.assertIn("other_mm", self.refusal("harmonics", self.path / "turn.csv", "--angle", "shaft_deg", "--of", "other_mm"))


if __name__ == "__main__":
    unittest.main()
