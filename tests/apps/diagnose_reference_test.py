"""`abbe diagnose` on the table of a positioning test, with a file that holds the machine alone."""
import math
import random
import unittest

from program_case import ProgramCase

MACHINE = """name = "stage"
chain = "[w X Y b Z t]"
[axis.X]
travel_mm = [0.0, 60.0]
positive = "carriage"
[axis.Y]
travel_mm = [0.0, 60.0]
positive = "carriage"
[axis.Z]
travel_mm = [0.0, 60.0]
[population]
positioning_um = 10.0
straightness_um = 10.0
roll_urad = 100.0
pitch_urad = 100.0
yaw_urad = 100.0
squareness_urad = 100.0
scale_ppm = 100.0
smoothness_mm = 10.0
"""
TARGETS, CYCLES, WIDTH_UM, NOISE_UM = 11, 5, 8.0, 0.4


def table():
    """The axis errs smoothly, lags by half of its play, and is read with noise."""
    noise = random.Random(4)
    lines = ["UNIT=mm", f"CYCLES={CYCLES}", f"POSITIONS={TARGETS}"]
    for i in range(TARGETS):
        target = 5 + 5 * i
        lines.append(f"TGT_DATA[{i + 1}]={target}")
        for name, sign in (("FWD", 1), ("BWD", -1)):
            for cycle in range(1, CYCLES + 1):
                off = 6 * math.sin(target / 12) - sign * WIDTH_UM / 2 + noise.gauss(0, NOISE_UM)
                lines.append(f"REF_DATA_{name}[{i + 1},{cycle}]={target + 1e-3 * off:.7f}")
    return "\n".join(lines) + "\n"


class DiagnoseReference(ProgramCase):
    command = "diagnose"

    def setUp(self):
        super().setUp()
        (self.path / "stage.toml").write_text(MACHINE)
        (self.path / "x.dat").write_text(table())
        self.recording = self.path / "x.csv"
        self.done(self.path / "x.dat", self.recording, command="convert")

    def test_the_play_is_found_with_its_size(self):
        result = self.result(self.recording, "--machine", self.path / "stage.toml")
        self.assertEqual(result["verdict"], "explained")
        self.assertEqual([(f["cause"], f["object"]) for f in result["findings"]], [("backlash", "X")])
        width, = result["findings"][0]["parameters"]
        self.assertEqual(width["name"], "width_um")
        self.assertAlmostEqual(width["value"], WIDTH_UM, delta=2 * width["u95"])
        self.assertLess(width["u95"], 4 * NOISE_UM / math.sqrt(TARGETS * CYCLES / 2))
        self.assertGreater(result["heldout"]["rms_before"], 5 * result["heldout"]["rms_after"])

    def test_what_the_table_does_not_say_is_said(self):
        notes = " ".join(self.result(self.recording, "--machine", self.path / "stage.toml")["notes"])
        self.assertIn("72 degrees of freedom", notes)
        self.assertIn("results in s count readings", notes)
        self.assertIn("Note: ", self.done(self.recording, "--machine", self.path / "stage.toml"))

    def test_runs_that_need_more_of_the_machine_are_refused(self):
        dwell = self.path / "dwell.csv"
        dwell.write_text('# abbe-recording = 1\n# kind = "dwell"\ntime_s,x_mm,y_mm,z_mm,probe_a_um\n0,0,0,0,1\n')
        self.refuse(dwell, "--machine", self.path / "stage.toml", saying=["dwell.csv", "[head]"])
        once = self.path / "once.csv"
        rows = self.recording.read_text().splitlines(keepends=True)
        header = [row for row in rows if row.startswith("#")]
        once.write_text("".join(rows[:len(header) + 1 + 2 * TARGETS]))
        self.refuse(once, "--machine", self.path / "stage.toml", saying=["once.csv", "u_reference_um"])


if __name__ == "__main__":
    unittest.main()
