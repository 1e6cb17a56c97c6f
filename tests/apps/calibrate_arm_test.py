"""`abbe calibrate` on an arm of four joints before a tracker, whose rows are known to the test alone."""
import json
import math
import random
import unittest

import numpy as np

import arm_fit
from program_case import ProgramCase

NOMINAL = [(0.0, 300.0, 80.0, -90.0), (-90.0, 0.0, 350.0, 0.0), (0.0, 0.0, 300.0, 90.0), (0.0, 100.0, 60.0, 0.0)]
# theta, d, a, alpha, and the tilt of axis 3 beside axis 2; of the first row theta and d are the tracker's.
TRUE = [(0.0, 300.0, 80.4, -90.03, 0.0), (-89.95, 0.0, 349.7, 0.02, 0.015), (0.04, 0.3, 300.2, 90.02, 0.0),
        (0.0, 100.0, 60.0, 0.0, 0.0)]
BALLS = {"1": (0.6, -0.3, 0.2), "2": (-35.0, 60.0, 20.0)}
MACHINE = """name = "small-arm"  # kept
[linkage]
form = "{form}"
{rows}
[linkage.base]
position_mm = [0.0, 0.0, 0.0]
[linkage.tolerance]
link_um = 1000
ball_um = 1000
pivot_urad = 1000
encoder_offset_urad = 2000
[linkage.noise]
encoder_urad = 2.0
reference_um = 5.0
"""
NOISE = 5e-3  # mm
# What the file should have then. Row 3 is the tilt; 90 degrees of theta go from it to row 4.
WRITTEN = {("row 1", "a_mm"): 80.4, ("row 1", "alpha_deg"): -90.03, ("row 2", "theta_deg"): -89.95,
           ("row 2", "a_mm"): 349.7, ("row 2", "alpha_deg"): 0.02, ("row 3", "alpha_deg"): 0.015,
           ("row 4", "theta_deg"): 0.04 - 90.0, ("row 4", "d_mm"): 0.3, ("row 4", "a_mm"): 300.2,
           ("row 4", "alpha_deg"): 90.02, ("ball", "x_mm"): 0.6, ("ball", "y_mm"): -0.3, ("ball", "z_mm"): 0.2}


def in_radians(rows):
    return [(math.radians(theta), d, a, math.radians(alpha), math.radians(beta)) for theta, d, a, alpha, beta in rows]


def rows_text(rows):
    return "".join("[[linkage.joint]]\ntheta_deg = {}\nd_mm = {}\na_mm = {}\nalpha_deg = {}\n".format(*row)
                   for row in rows)


def axes_text():
    """The nominal lines: a turn of each joint leaves the points of its axis."""
    text, R, p = "ball_mm = [{}, {}, {}]\n", np.eye(3), np.zeros(3)
    for theta, d, a, alpha in NOMINAL:
        text += f"[[linkage.axis]]\npoint_mm = {[float(v) for v in p]}\ndirection = {[float(v) for v in R[:, 2]]}\n"
        R = R @ arm_fit.turned(2, math.radians(theta))
        p = p + R @ [a, 0, 0] + R @ [0, 0, d]
        R = R @ arm_fit.turned(0, math.radians(alpha))
    return text.format(*p)


class CalibrateArm(ProgramCase):
    command = "calibrate"

    def setUp(self):
        super().setUp()
        self.machine = self.path / "arm.toml"
        self.machine.write_text(MACHINE.format(form="denavit-hartenberg", rows=rows_text(NOMINAL)))

    def record(self, name, ball="1", poses=80, seed=1, header="", joints=4, gives=0.0):
        """gives: rad by which joints 2 and 3 turn under the weight in the ball, over its lever in m."""
        draw = random.Random(seed)
        q = np.array([[draw.uniform(-2.0, 2.0) for _ in NOMINAL] for _ in range(poses)])
        turned = q + gives * 1e-3 * self.levers(q, ball) @ np.array([[0, 1, 0, 0], [0, 0, 0.6, 0]])
        x = arm_fit.tips(in_radians(TRUE), BALLS[ball], turned) @ np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1.0]])
        lines = ["# abbe-recording = 1", '# kind = "linkage"', '# time = "order"', *header.splitlines(),
                 ",".join(["time_s", *(f"pivot_{i}_rad" for i in range(1, joints + 1)), "ref_x_mm", "ref_y_mm",
                           "ref_z_mm"])]
        for n, (angles, place) in enumerate(zip(q, x + [1500.0, -700.0, 50.0])):
            numbers = [*(a + draw.gauss(0, 2e-6) for a in angles[:joints]), *(p + draw.gauss(0, NOISE) for p in place)]
            lines.append(",".join([str(n), *(f"{number:.9f}" for number in numbers)]))
        (self.path / name).write_text("\n".join(lines) + "\n")
        return self.path / name

    def levers(self, q, ball):
        """Of the ball about the horizontal axes 2 and 3, along the arm, mm: poses x 2."""
        rows = in_radians(TRUE)
        along = np.column_stack([np.cos(q[:, 0]), np.sin(q[:, 0]), np.zeros(len(q))])
        places = [arm_fit.tips(rows[:n], np.zeros(3), q[:, :n]) for n in (1, 2)]
        tip = arm_fit.tips(rows, BALLS[ball], q)
        return np.column_stack([((tip - place) * along).sum(axis=1) for place in places])

    def numbers(self, result):
        return {(number["of"], number["key"]): number for number in result["numbers"]}

    def pulls(self, found):
        """By how many standard uncertainties each is off the truth."""
        for key in WRITTEN:
            self.assertGreater(found[key]["u95"], 0.0, key)
        return [(found[key]["value"] - true) / (0.5 * found[key]["u95"]) for key, true in WRITTEN.items()]

    def test_u95_contains_what_the_geometry_takes_of_joints_that_give(self):
        pulls = []
        for seed in range(1, 7):
            # 20 to 100 um in the ball, beside a noise of 5 um.
            poses = self.record("poses.csv", seed=seed, poses=60, gives=(-1.0)**seed * 200e-6)
            result = self.result(poses, "--machine", self.machine)
            self.assertGreater(result["residuals_no_noise"], 0.99)
            pulls += self.pulls(self.numbers(result))
        inside = np.mean(np.abs(pulls) < 2.0)
        self.assertGreater(inside, 0.9, pulls)
        self.assertLess(max(map(abs, pulls)), 4.0, pulls)
        self.assertIn("goes with the posture", self.done(poses, "--machine", self.machine))

    def test_rows_are_found_with_their_uncertainty_and_written_into_a_new_file(self):
        old = self.machine.read_text()
        out = self.path / "now.toml"
        poses, test = self.record("poses.csv"), self.record("test.csv", seed=2)
        result = self.result(poses, "--check", test, "--machine", self.machine, "-o", out)
        self.assertEqual(self.machine.read_text(), old)
        found = self.numbers(result)
        pulls = self.pulls(found)
        # Thirteen normal numbers: none beyond four deviations, and neither all tiny nor all large.
        self.assertLess(max(abs(pull) for pull in pulls), 4.0, pulls)
        self.assertGreater(np.sqrt(np.mean(np.square(pulls))), 0.3, pulls)
        for key, number in found.items():
            if key in WRITTEN:
                continue
            self.assertAlmostEqual(number["value"], number.get("nominal", 90.0 if key[1] == "theta_deg" else 0.0), 9, key)
        # Noise alone: nothing in it goes with the posture.
        self.assertLess(result["residuals_no_noise"], 0.5)
        test_set, = result["tests"]
        self.assertGreater(test_set["before"]["rms_mm"], 0.2)
        self.assertLess(test_set["after"]["rms_mm"], 1.2 * math.sqrt(3.0) * NOISE)
        text = out.read_text()
        self.assertIn('name = "small-arm"  # kept', text)
        self.assertIn("U95", text)
        # The new file needs no correction.
        again = self.result(poses, "--machine", out, "--force")["recordings"][0]
        self.assertLess(again["before"]["rms_mm"], 1.2 * math.sqrt(3.0) * NOISE)

    def test_axes_do_the_same_for_a_test_set(self):
        axes, out = self.path / "axes.toml", self.path / "now.toml"
        axes.write_text(MACHINE.format(form="axes", rows=axes_text()))
        poses, test = self.record("poses.csv"), self.record("test.csv", seed=2)
        result = self.result(poses, "--check", test, "--machine", axes, "-o", out)
        self.assertLess(result["tests"][0]["after"]["rms_mm"], 1.2 * math.sqrt(3.0) * NOISE)
        self.assertIn("point_mm", out.read_text())
        again = self.result(poses, "--machine", out, "--force")["recordings"][0]
        self.assertLess(again["before"]["rms_mm"], 1.2 * math.sqrt(3.0) * NOISE)

    def test_a_second_ball_has_an_unknown_place_of_its_own(self):
        header = '# mounting = {{ ball = "{}" }}'
        runs = [self.record(f"ball_{n}.csv", n, header=header.format(n), seed=7, poses=60) for n in "12"]
        result = self.result(*runs, "--machine", self.machine)
        ball, = result["balls"]
        self.assertEqual(ball["ball"], "2")
        for found, true in zip(ball["place_mm"], BALLS["2"]):
            self.assertAlmostEqual(found, true, delta=0.02)
        for run in result["recordings"]:
            self.assertLess(run["after"]["rms_mm"], 1.2 * math.sqrt(3.0) * NOISE)

    def test_what_does_not_go_is_refused(self):
        poses = self.record("poses.csv")
        arm = ("--machine", self.machine)
        self.refuse(poses, *arm, "-o", self.machine, "--force", saying=["arm.toml", "name another file"])
        self.refuse(poses, *arm, "--check", poses, saying=["poses.csv", "other poses"])
        self.refuse(poses, *arm, "--mapped", saying=["poses.csv", "--mapped", "leave"])
        self.refuse(self.record("few.csv", poses=8), *arm, saying=["few.csv", "8 poses", "record at least"])
        self.refuse(self.record("three.csv", joints=3), *arm, saying=["three.csv", "pivot_4_rad"])
        other = self.record("other.csv", header='# mounting = { base = "moved" }', seed=3)
        self.refuse(poses, *arm, "--check", other, saying=["other.csv", "mounting.base", '"moved"'])
        second = self.record("second.csv", "2", header='# mounting = { ball = "2" }', seed=3)
        self.refuse(poses, *arm, "--check", second, saying=["poses.csv", "mounting.ball", "name the ball of each"])
        pivots = self.path / "pivots.toml"
        pivots.write_text(MACHINE.format(form="pivots", rows=""))
        self.refuse(self.record("relm.csv", joints=3), "--machine", pivots, saying=["denavit-hartenberg", "axes"])


if __name__ == "__main__":
    unittest.main()
