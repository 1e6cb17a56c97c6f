"""`abbe convert` and `abbe diagnose` on poses of an arm of four joints before a tracker."""
import math
import random
import unittest

from program_case import ProgramCase

ROWS = [(0.0, 300.0, 80.0, -90.0), (-90.0, 0.0, 350.0, 0.0), (0.0, 0.0, 300.0, 90.0),
        (0.0, 100.0, 60.0, 0.0)]  # theta, d, a, alpha
JOINT = "[[linkage.joint]]\ntheta_deg = {}\nd_mm = {}\na_mm = {}\nalpha_deg = {}\n"
MACHINE = """name = "small-arm"
[linkage]
form = "denavit-hartenberg"
{joints}
[linkage.base]
position_mm = [0.0, 0.0, 0.0]
[linkage.tolerance]
link_um = 500
ball_um = 1000
pivot_urad = 1000
[linkage.noise]
encoder_urad = 5.0
reference_um = 5.0
"""
GAIN, POSES = 800e-6, 90
COLUMNS = [f"--column=pivot_{i}_rad=q{i}" for i in range(1, 5)] + [
    f"--column=ref_{axis}_mm={axis}_m" for axis in "xyz"]


def machine(rows):
    return MACHINE.format(joints="".join(JOINT.format(*row) for row in rows))


def tip(angles, ball=(0.0, 0.0, 0.0)):
    x, y, z = ball
    for (theta, d, a, alpha), angle in reversed(list(zip(ROWS, angles))):
        c, s = math.cos(math.radians(alpha)), math.sin(math.radians(alpha))
        x, y, z = x + a, c * y - s * z, s * y + c * z + d
        c, s = math.cos(math.radians(theta) + angle), math.sin(math.radians(theta) + angle)
        x, y = c * x - s * y, s * x + c * y
    return x, y, z


def table(ball=(0.0, 0.0, 0.0), poses=POSES, seed=6, wave=0.0):
    """The encoder of the first joint shows more than the joint turns; arm 2 has other rows. `wave`: rad, of the third
    joint, of an order below that of any encoder."""
    draw = random.Random(seed)
    lines = ["arm,q1,q2,q3,q4,x_m,y_m,z_m"]
    for _ in range(poses):
        turned = [draw.uniform(-2.0, 2.0) for _ in ROWS]
        x, y, z = tip([*turned[:2], turned[2] + wave * math.cos(7.0 * turned[2]), turned[3]], ball)
        place = [-y + 1500.0, x - 700.0, z + 50.0]  # the tracker is turned and stands aside
        shown = [q + draw.gauss(0, 5e-6) for q in turned]
        shown[0] += GAIN * turned[0]
        numbers = shown + [1e-3 * (p + draw.gauss(0, 5e-3)) for p in place]
        lines.append("1," + ",".join(f"{number:.9f}" for number in numbers))
        lines.append("2,0,0,0,0,0,0,0")
    return "\n".join(lines) + "\n"


class DiagnoseArm(ProgramCase):
    command = "diagnose"

    def setUp(self):
        super().setUp()
        (self.path / "arm.toml").write_text(machine(ROWS))
        (self.path / "poses.csv").write_text(table())
        self.recording = self.path / "arm.csv"
        self.done(self.path / "poses.csv", self.recording, "--where=arm=1", *COLUMNS, command="convert")

    def test_rows_in_any_order_are_the_same_where_an_index_tells_it(self):
        lines = (self.path / "poses.csv").read_text().splitlines()
        table = [f"n,{lines[0]}"] + [f"{n},{line}" for n, line in enumerate(lines[1:])]
        draw = random.Random(1)
        texts = []
        for name in ("sorted.csv", "shuffled.csv"):
            (self.path / "table.csv").write_text("\n".join(table) + "\n")
            self.done(self.path / "table.csv", self.path / name, "--where=arm=1", "--column=order=n", *COLUMNS,
                      command="convert")
            texts.append((self.path / name).read_text())
            rows = table[1:]
            draw.shuffle(rows)
            table = table[:1] + rows
        self.assertEqual(*texts)
        self.done(self.path / "table.csv", self.path / "unknown.csv", "--where=arm=1", "--shuffled", *COLUMNS,
                  command="convert")
        told = self.done(self.path / "unknown.csv", "--machine", self.path / "arm.toml")
        self.assertIn("a drift cannot be seen", told)
        self.assertIn("joint-gain", told)

    def test_the_gain_of_a_joint_is_found_with_its_size(self):
        result = self.result(self.recording, "--machine", self.path / "arm.toml")
        self.assertEqual(result["verdict"], "explained")
        self.assertEqual([(f["cause"], f["object"]) for f in result["findings"]],
                         [("joint-gain", "pivot_1")])
        gain, = result["findings"][0]["parameters"]
        self.assertAlmostEqual(gain["value"], 1e6 * GAIN, delta=2 * gain["u95"])
        self.assertGreater(result["heldout_arm"]["rms_before_mm"], 2 * result["heldout_arm"]["rms_after_mm"])

    def test_few_poses_explain_no_more_than_their_degrees_of_freedom(self):
        """25 poses have 75 numbers, of which the geometry takes 25 or more: half as much again as the noise in the rest
        is unexplained, though it is not more than the noise of 75."""
        unexplained = 0
        for seed in range(8):
            (self.path / "few.csv").write_text(table(poses=25, seed=seed, wave=52e-6))
            self.done(self.path / "few.csv", self.recording, "--where=arm=1", *COLUMNS, "--force", command="convert")
            unexplained += self.result(self.recording, "--machine", self.path / "arm.toml")["verdict"] == "unexplained"
            (self.path / "result.json").unlink()
        self.assertGreater(unexplained, 5)

    def test_balls_are_told_apart_by_their_names(self):
        runs = []
        for number, ball in enumerate(((0, 0, 0), (20, -30, 10), (-25, 5, 30)), 1):
            table_file, recording = self.path / f"poses_{number}.csv", self.path / f"ball_{number}.csv"
            table_file.write_text(table(ball))
            self.done(table_file, recording, "--where=arm=1", *COLUMNS, command="convert")
            runs.append(recording)
        arm = ("--machine", self.path / "arm.toml")
        self.refuse(*runs, *arm, saying=["ball_2.csv", "ball_1.csv", "two balls", "mounting.ball"])
        for number, recording in list(enumerate(runs, 1))[1:]:
            text = recording.read_text()
            recording.write_text(text.replace('kind = "linkage"', f'kind = "linkage"\n# mounting = {{ ball = "{number}" }}', 1))
        self.refuse(*runs, *arm, saying=["ball_1.csv", "mounting.ball", "name the ball of each"])
        text = runs[0].read_text()
        runs[0].write_text(text.replace('kind = "linkage"', 'kind = "linkage"\n# mounting = { ball = "1" }', 1))
        result = self.result(*runs[:2], *arm)
        self.assertEqual([(f["cause"], f["object"]) for f in result["findings"]], [("joint-gain", "pivot_1")])
        gain, = result["findings"][0]["parameters"]
        self.assertAlmostEqual(gain["value"], 1e6 * GAIN, delta=2 * gain["u95"])

    def test_what_does_not_belong_together_is_refused(self):
        (self.path / "three.toml").write_text(machine(ROWS[:3]))
        self.refuse(self.recording, "--machine", self.path / "three.toml",
                    saying=["arm.csv", "pivot_4_rad", "3 pivots"])
        (self.path / "five.toml").write_text(machine(ROWS + ROWS[-1:]))
        self.refuse(self.recording, "--machine", self.path / "five.toml", saying=["arm.csv", "pivot_5_rad"])
        (self.path / "other.toml").write_text(machine([ROWS[1], ROWS[0], ROWS[3], ROWS[2]]))
        self.refuse(self.recording, "--machine", self.path / "other.toml", saying=["arm.csv", "[linkage]"])
        blind = self.path / "blind.csv"
        run = self.run_program(self.path / "poses.csv", blind, *COLUMNS[:4], command="convert")
        self.assertEqual(run.returncode, 2, run.stdout)
        self.assertIn("ref_x_mm: is missing; a linkage recording needs this column", run.stderr)
        test = self.path / "dwell.csv"
        test.write_text('# abbe-recording = 1\n# kind = "dwell"\ntime_s,x_mm\n0,0\n')
        self.refuse(test, "--machine", self.path / "arm.toml", saying=["dwell.csv", "has no axes"])


if __name__ == "__main__":
    unittest.main()
