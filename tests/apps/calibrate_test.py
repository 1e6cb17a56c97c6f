"""`abbe calibrate` as a user runs it: the figures of SciPy, and one line for every bad input."""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
from scipy.optimize import least_squares

import linkage_world as lw

PROGRAM = os.environ["ABBE"]
MACHINE = os.environ["ABBE_MACHINE"]
CUBE = (0.025, 0.025, 0.050)

# The parameters of model "pivots" in the program's order: name, prior, place in the world.
PARAMETERS = [("base.x", 5e-4, "base", 0), ("base.y", 5e-4, "base", 1), ("base.z", 5e-4, "base", 2),
              ("base_turn.a", 2e-3, "turn", 0), ("base_turn.b", 2e-3, "turn", 1), ("base_turn.c", 2e-3, "turn", 2),
              ("link.link_1", 1e-4, "link_1", None), ("link.link_2", 1e-4, "link_2", None),
              ("tilt.pivot_1_x", 5e-4, "tilt", 0), ("tilt.pivot_1_y", 5e-4, "tilt", 1),
              ("twist.pivot_2", 5e-4, "twist_2", None), ("twist.link_1", 5e-4, "twist_link", None),
              ("divergence.pivot_2_x", 2e-5, "divergence", 0), ("divergence.pivot_2_y", 2e-5, "divergence", 1),
              ("encoder_offset.pivot_1", 1e-3, "offset", 0), ("encoder_offset.pivot_2", 1e-3, "offset", 1),
              ("encoder_offset.pivot_3", 1e-3, "offset", 2)]
SI = {"um": 1e-6, "mm": 1e-3, "urad": 1e-6}


def world_of(x):
    world = {key: np.array(value, dtype=float) for key, value in lw.NOMINAL.items()}
    for (_, prior, key, place), value in zip(PARAMETERS, x):
        if place is None:
            world[key] = world[key] + prior * value
        else:
            world[key][place] += prior * value
    return world


def scipy_calibration(path):
    """Estimates and standard uncertainties in units of the priors."""
    lines = [line for line in pathlib.Path(path).read_text().splitlines() if not line.startswith("#")]
    names = lines[0].split(",")
    table = np.array([[float(value) for value in line.split(",")] for line in lines[1:]])
    column = {name: table[:, i] for i, name in enumerate(names)}
    q = np.stack([column[f"pivot_{i}_rad"] for i in (1, 2, 3)], axis=1)
    p_MT = 1e-3 * np.stack([-column["ref_x_mm"], -column["ref_y_mm"], column["ref_z_mm"]], axis=1)
    J = np.stack([(lw.ball(lw.NOMINAL, q + 1e-6 * e) - lw.ball(lw.NOMINAL, q - 1e-6 * e)) / 2e-6
                  for e in np.eye(3)], axis=2)
    noise = np.linalg.cholesky(3e-6**2 * J @ J.transpose(0, 2, 1) + 0.3e-6**2 * np.eye(3))

    def residuals(x):
        gaps = lw.ball(world_of(x), q) - p_MT
        return np.concatenate([np.linalg.solve(noise, gaps[:, :, None]).ravel(), x])

    fit = least_squares(residuals, np.zeros(len(PARAMETERS)), jac="3-point", x_scale="jac", xtol=1e-14, ftol=1e-14)
    return fit.x, np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))


class Calibrate(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def record(self, name="cube.csv", n=(5, 5, 5), size=CUBE, seed=1, **options):
        return lw.record(self.path / name, lw.draw(seed), lw.cube(n, size), seed, **options)

    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, "calibrate", *map(str, arguments), "--machine", MACHINE], capture_output=True,
                              text=True, timeout=120)

    def refusal(self, *arguments):
        run = self.run_program(*arguments)
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        return run.stderr

    def result(self, *arguments):
        run = self.run_program(*arguments, "--json", self.path / "result.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        return json.loads((self.path / "result.json").read_text()), run.stdout

    def test_estimates_and_uncertainties_are_those_of_scipy(self):
        recording = self.record(size=(0.05, 0.05, 0.05))
        result, _ = self.result(recording, "--model", "pivots")
        value, uncertainty = scipy_calibration(recording)
        self.assertEqual([entry["name"] for entry in result["parameters"]], [name for name, *_ in PARAMETERS])
        for (name, prior, *_), entry, x, u in zip(PARAMETERS, result["parameters"], value, uncertainty):
            si = SI[entry["unit"]]
            self.assertAlmostEqual(entry["uncertainty"] * si / (u * prior), 1.0, delta=0.01, msg=name)
            # Rows beyond three deviations, one in 370, pull less here: a few hundredths of u.
            self.assertLess(abs((entry["value"] - entry["nominal"]) * si - x * prior), 0.3 * u * prior, name)

    def test_recordings_of_two_balls_are_refused(self):
        """Stated in the header; or the same angles with distances that no base can make."""
        one, other = self.record("one.csv"), self.record("other.csv")
        for number, recording in enumerate((one, other), 1):
            text = pathlib.Path(recording).read_text()
            pathlib.Path(recording).write_text(
                text.replace('kind = "linkage"', f'kind = "linkage"\n# mounting = {{ ball = "{number}" }}', 1))
        self.assertIn('other.csv: header: mounting.ball is "2", and "1" in', self.refusal(one, other))
        one, other = self.record("one.csv"), self.record("other.csv")
        lines = pathlib.Path(other).read_text().splitlines()
        names = next(line for line in lines if line[0] != "#").split(",")
        at = names.index("ref_x_mm")
        for i, line in enumerate(lines):
            if line[0] == "#" or line.startswith(names[0]):
                continue
            words = line.split(",")
            turn = float(words[names.index("pivot_1_rad")]) + float(words[names.index("pivot_2_rad")])
            words[at] = repr(float(words[at]) + 30 * np.sin(5 * turn))
            lines[i] = ",".join(words)
        pathlib.Path(other).write_text("\n".join(lines) + "\n")
        self.assertIn("two balls", self.refusal(one, other))

    def test_cube_of_the_document_leaves_combinations_unseen_and_names_them(self):
        result, text = self.result(self.record(n=(7, 7, 12)), "--model", "published-with-bearing")
        self.assertEqual(result["combinations"], 30)  # 24 and the base
        unseen = [entry["words"] for entry in result["unseen"]]
        self.assertEqual(result["combinations_seen"] + len(unseen), 30)
        for pair in (("tilt.head_x", "base_turn.a"), ("tilt.head_y", "base_turn.b"),
                     ("radial_angle.pivot_1", "base_turn.c")):  # the base can do what the head does
            self.assertTrue(any(all(name in words for name in pair) for words in unseen), pair)
        self.assertIn(f"see {result['combinations_seen']} of 30 combinations", text)
        self.assertLess(result["held_out"]["rms_um"], 1.5)
        self.assertGreater(result["before"]["rms_um"], 50)

    def test_cube_of_the_document_is_reported_before_it_is_measured(self):
        measured, _ = self.result(self.record(n=(7, 7, 12)), "--model", "published-with-bearing")
        run = self.run_program("--model", "published-with-bearing", "--volume", "25,25,50")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("588 poses in 25 x 25 x 50 mm", run.stdout)
        seen = int(run.stdout.split("The data see ")[1].split(" of 30 ")[0])
        self.assertLessEqual(abs(seen - measured["combinations_seen"]), 1)  # one may stand on the limit
        self.assertIn("radial_angle.pivot_1", run.stdout)

    def test_models_are_compared_on_a_recording_that_took_no_part(self):
        check = pathlib.Path(self.record(n=(3, 3, 3))).rename(self.path / "check.csv")
        cube = self.record(n=(5, 5, 5))
        run = self.run_program(cube, "--compare", "--check", check, "--folds", 1, "--json", self.path / "models.json")
        self.assertEqual(run.returncode, 0, run.stderr)
        models = {row["name"]: row for row in json.loads((self.path / "models.json").read_text())["models"]}
        largest = {name: row["checks"][0]["distance"]["max_um"] for name, row in models.items() if name != "reference"}
        self.assertGreater(largest["nominal"], 50)
        self.assertLess(largest["complete"], 3)
        self.assertGreater(largest["complete, one cell"], largest["complete"])
        self.assertIn("5.10 (3D), circle 5.29 (2D)", run.stdout)

    def test_calibration_file_is_written(self):
        run = self.run_program(self.record(), "-o", self.path / "linkage.toml")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn('model = "complete"', (self.path / "linkage.toml").read_text())

    def test_plan_names_positions_inside_the_travel(self):
        run = self.run_program("--poses", 20, "-o", self.path / "plan.csv")
        self.assertEqual(run.returncode, 0, run.stderr)
        plan = np.genfromtxt(self.path / "plan.csv", delimiter=",", skip_header=1)
        self.assertEqual(plan.shape, (20, 3))
        self.assertEqual(len({tuple(row) for row in plan}), 20)
        self.assertTrue((plan >= 0).all() and (plan <= 60).all())

    def test_without_a_reference_instrument_the_machine_is_the_reference_and_it_is_said(self):
        _, text = self.result(self.record(with_reference=False))
        self.assertIn("no reference instrument in every direction: errors of the machine itself went into", text)

    def test_no_reference_position_at_all(self):
        path = pathlib.Path(self.record(with_reference=False))
        lines = path.read_text().splitlines()
        lines[3] = lines[3].replace("x_mm,y_mm,z_mm", "place_1,place_2,place_3")
        path.write_text("\n".join(lines) + "\n")
        self.assertIn("x_mm: is missing; a linkage recording needs this column", self.refusal(path))

    def test_wrap_through_zero(self):
        message = self.refusal(self.record(change=lambda q: np.mod(q, 2 * np.pi)))
        self.assertIn("cube.csv: row", message)
        self.assertIn("pivot_1_rad jumps by 6.2", message)
        self.assertIn("the encoder's counter has wrapped", message)

    def test_swapped_encoders(self):
        message = self.refusal(self.record(change=lambda q: q[:, [1, 0, 2]]))
        self.assertIn("the encoders of pivot_1 and pivot_2 are swapped", message)

    def test_wrong_counts_per_turn(self):
        message = self.refusal(self.record(change=lambda q: q * [1, 1, 2]))
        self.assertIn("pivot_3", message)
        self.assertIn("counts_per_turn", message)

    def test_missing_encoder(self):
        message = self.refusal(self.record(columns=("pivot_1_rad", "pivot_2_rad", "other_rad")))
        self.assertIn("pivot_3_rad: this column is missing", message)

    def test_too_few_poses(self):
        self.assertIn("record at least", self.refusal(self.record(n=(2, 2, 2))))

    def test_pose_out_of_reach_of_the_planned_linkage(self):
        text = pathlib.Path(MACHINE).read_text()
        far = self.path / "far.toml"
        far.write_text(text.replace("position_mm = [-180.0, -30.0, -30.0]", "position_mm = [-500.0, -30.0, -30.0]"))
        run = subprocess.run([PROGRAM, "calibrate", "--study", "--machine", str(far)], capture_output=True, text=True,
                             timeout=60)
        self.assertIn(run.returncode, (2, 4))
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        self.assertIn("the linkage does not reach", run.stderr)
        self.assertIn("move its base", run.stderr)

    def test_other_kind_of_recording(self):
        path = pathlib.Path(self.record())
        path.write_text(path.read_text().replace('# kind = "linkage"', '# kind = "sweep"'))
        self.assertIn("cube.csv", self.refusal(path))

    def test_nothing_to_do(self):
        self.assertIn("name recordings of kind linkage", self.refusal())


if __name__ == "__main__":
    unittest.main()
