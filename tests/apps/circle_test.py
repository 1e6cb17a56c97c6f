"""`abbe circle` as a user runs it, on circles whose errors are known."""
import math
import pathlib
import unittest

import linkage_runs
from program_case import MACHINE, ProgramCase

CENTRE = (30.0, 30.0, 30.0)
OF_10_MM = ["# radius_mm = 10"]


def circle(machine, senses=(1, -1), radius=10.0, feed=100.0, plane="XY", points=720, run_in=False):
    """Rows of a circle; `machine` tells where it goes for position (mm, from the centre) and velocity (mm/s)."""
    first, second = ("XYZ".index(axis) for axis in plane)
    rows = []
    for turn, sense in enumerate(senses, 1):
        for number in range(points):
            t = 2 * math.pi * (number + 0.5) / points
            t *= sense
            w = sense * feed / 60 / radius
            place = (radius * math.cos(t), radius * math.sin(t))
            speed = (-w * place[1], w * place[0])
            gone = machine(*place, *speed)
            commanded, actual = list(CENTRE), list(CENTRE)
            commanded[first] += place[0]
            commanded[second] += place[1]
            actual[first] += gone[0]
            actual[second] += gone[1]
            if run_in and number == 0:
                for step in range(1, 50):  # from the centre to the circle
                    way = [c + (p - c) * step / 50 for c, p in zip(CENTRE, commanded)]
                    rows.append((way, way, turn, sense, feed))
            rows.append((commanded, actual, turn, sense, feed))
    return rows


def perfect(x, y, vx, vy):
    return x, y


def worn(x, y, vx, vy):
    """Backlash of 4 um on X, 200 urad out of square, Y too long by 100 ppm."""
    x -= 0.002 * (1 if vx > 0 else -1)
    y *= 1 + 100e-6
    return x - y * 200e-6, y


class Circle(ProgramCase):
    command = "circle"

    def test_perfect_circle_in_every_plane(self):
        for plane in ("XY", "YZ", "ZX"):
            recording = linkage_runs.write(self.path / f"{plane}.csv", circle(perfect, plane=plane), header=OF_10_MM)
            result = self.result(recording, "--machine", MACHINE)
            self.assertEqual(result["plane"], plane)
            self.assertEqual((result["radius_mm"], result["radius_is"]), (10.0, "programmed"))
            for key in ("G_cw_um", "G_ccw_um", "G_b_um", "F_max_um", "F_min_um", "D_um"):
                self.assertLess(abs(result[key]), 1e-6, (plane, key))

    def test_linkage_and_reference_side_by_side(self):
        recording = linkage_runs.write(self.path / "both.csv", circle(worn), reference=True, header=OF_10_MM)
        done = self.run_program(recording, "--machine", MACHINE)
        self.assertIn("linkage XY", done.stdout)
        self.assertIn("reference XY", done.stdout)
        result = self.result(recording, "--machine", MACHINE)
        linkage, reference = result["circles"]
        self.assertEqual((linkage["instrument"], reference["instrument"]), ("linkage", "reference"))
        for key, value in reference["runs"][0].items():
            if key.endswith("_um") and not isinstance(value, list):
                self.assertAlmostEqual(linkage["runs"][0][key], value, delta=1e-5, msg=key)
        truth = {("backlash", "X"): 4e-6, ("backlash", "Y"): 0, ("squareness", "XY"): 200e-6,
                 ("servo_mismatch", "XY"): 0, ("straightness", "EYX"): 0}
        for one in linkage["causes"]:
            expected = truth.get((one["cause"], one["object"]))
            if expected is not None:
                # Second order: (1 um)^2 over the radius, and the backlash times 200 urad.
                scale = one["effect_um"] / abs(one["value"])
                self.assertAlmostEqual(one["value"] * scale, expected * scale, delta=5e-3, msg=one)

    def test_no_small_cause_is_certain_beside_what_no_cause_does(self):
        """1 um of a fifth harmonic that turns with the sense: 4 um of backlash may come from it, 40 um do not."""
        def lobed(backlash):
            def machine(x, y, vx, vy):
                sense, t = math.copysign(1, x * vy - y * vx), math.atan2(y, x)
                by = 0.001 * sense * math.cos(5 * t)
                return x - backlash / 2 * math.copysign(1, vx) + by * math.cos(t), y + by * math.sin(t)
            return machine
        for backlash, certain in ((0.004, False), (0.04, True)):
            recording = linkage_runs.write(self.path / f"{backlash}.csv", circle(lobed(backlash)), reference=True,
                                           linkage=False, header=OF_10_MM)
            result = self.result(recording)["circles"][0]
            self.assertGreater(result["unexplained_over_noise"], 3)
            found = {(c["cause"], c["object"]): c for c in result["causes"]}
            self.assertEqual(found["backlash", "X"]["certain"], certain)
            self.assertEqual(found["straightness", "EYX"]["or"], "-EYY")
            self.assertEqual("um *" in self.run_program(recording).stdout, certain)

    def test_offset_senses_and_set_up(self):
        """Senses in two recordings, radii 10.002 and 9.999 mm, 5 um off centre, with run-in."""
        def grown(by):
            return lambda x, y, vx, vy: (x * (1 + by / 10) + 0.005, y * (1 + by / 10))
        ccw = linkage_runs.write(self.path / "ccw.csv", circle(grown(0.002), (1,), run_in=True),
                                 reference=True, linkage=False, header=OF_10_MM)
        cw = linkage_runs.write(self.path / "cw.csv", circle(grown(-0.001), (-1,), run_in=True),
                                reference=True, linkage=False, header=OF_10_MM)
        result = self.result(ccw, cw)
        self.assertAlmostEqual(result["G_b_um"], 3.0, delta=1e-3)
        self.assertAlmostEqual(result["G_cw_um"], 0.0, delta=1e-3)
        self.assertAlmostEqual(result["D_um"], 0.5, delta=1e-3)
        self.assertAlmostEqual(result["F_max_um"], 7.0, delta=2e-3)
        self.assertAlmostEqual(result["F_min_um"], -6.0, delta=2e-3)
        run = result["circles"][0]["runs"][0]
        self.assertAlmostEqual(run["setup_offset_um"][0], 5.0, delta=1e-3)
        self.assertEqual(run["recordings"], ["ccw.csv", "cw.csv"])
        self.assertGreaterEqual(run["left_out_rows"], 98 - 2)

    def test_the_lag_of_the_servo_is_against_the_programmed_radius(self):
        """Axes that lag by a first order of 15 ms go round a circle of R / sqrt(1 + (v T / R)^2), and their
        scales say so: only the programmed radius shows it."""
        radius, feed, lag = 20.0, 2000.0, 0.015
        smaller = radius / math.sqrt(1 + (feed / 60 * lag / radius) ** 2)
        true = 1e3 * (smaller - radius)
        self.assertLess(true, -6.0)
        rows = circle(perfect, radius=smaller, feed=feed)
        plain = linkage_runs.write(self.path / "plain.csv", rows, reference=True, linkage=False)
        said = linkage_runs.write(self.path / "said.csv", rows, reference=True, linkage=False,
                                  header=["# radius_mm = 20.0"])
        for result in (self.result(said), self.result(plain, "--radius", 20)):
            self.assertEqual(result["radius_is"], "programmed")
            for key in ("D_um", "F_max_um", "F_min_um", "F_max_ls_um", "F_min_ls_um"):
                self.assertAlmostEqual(result[key], true, delta=1e-6, msg=key)
            self.assertEqual(result["notes"], [])
        result, text = self.result(plain), self.done(plain)
        self.assertEqual(result["radius_is"], "recorded")
        for key in ("D_um", "F_max_um", "F_min_um", "F_max_ls_um", "F_min_ls_um"):
            self.assertNotIn(key, result)
            self.assertNotIn(key, result["circles"][0]["runs"][0]["u"])
        self.assertAlmostEqual(result["mean_beyond_recorded_um"], 0.0, delta=1e-6)
        self.assertAlmostEqual(result["radius_mm"], smaller, places=9)
        self.assertIn("no F max, F min and D of ISO 230-4", text)
        self.assertIn("write radius_mm into its header, or give --radius", text)
        self.assertNotIn("F max, set-up centre", text)

    def test_a_radius_of_another_circle_is_refused(self):
        plain = linkage_runs.write(self.path / "plain.csv", circle(perfect), reference=True, linkage=False)
        self.refuse(plain, "--radius", 20, saying=["plain.csv", "--radius states a radius of 20 mm", "10 mm"])
        for said, saying in (("5", "radius_mm of the header states a radius of 5 mm"), ("-5", "radius_mm = -5"),
                             ('"ten"', "radius_mm")):
            wrong = linkage_runs.write(self.path / "wrong.csv", circle(perfect), reference=True, linkage=False,
                                       header=[f"# radius_mm = {said}"])
            self.refuse(wrong, saying=["wrong.csv", saying])

    def test_the_rig_says_its_radius_and_where_it_starts(self):
        run = self.rig_record("run.csv", "--course", "circle", "--size", 30, "--feed", 1200, "--kind", "reference")
        self.assertIn("# radius_mm = 15\n", run.read_text())
        result = self.result(run)
        self.assertEqual((result["radius_mm"], result["radius_is"]), (15.0, "programmed"))
        starts = result["circles"][0]["runs"][0]["start_deg"]
        self.assertEqual(set(starts), {"ccw", "cw"})
        for start in starts.values():  # on the first axis
            self.assertLess(abs((start + 180) % 360 - 180), 5.0)

    def test_inclined_plane(self):
        tilt = math.radians(30)
        rows = []
        for commanded, _, *rest in circle(perfect):
            x, y = commanded[0] - 30, commanded[1] - 30
            place = [30 + x, 30 + y * math.cos(tilt), 30 + y * math.sin(tilt)]
            rows.append((place, place, *rest))
        result = self.result(linkage_runs.write(self.path / "tilted.csv", rows), "--machine", MACHINE)
        self.assertEqual(result["plane"], "inclined")
        self.assertLess(result["G_b_um"], 1e-6)
        self.assertNotIn("causes", result)

    def test_part_of_a_circle(self):
        """Half a turn in each sense: its figures, stated as partial, and what one arc cannot tell."""
        rows = circle(worn)
        half = linkage_runs.write(self.path / "half.csv", rows[:360] + rows[1080:], reference=True,
                                  linkage=False, header=OF_10_MM)
        self.assertIn("PART OF THE CIRCLE, degrees ccw, cw", self.done(half))
        result = self.result(half)
        self.assertTrue(result["partial"])
        self.assertNotIn("D_um", result)
        whole = self.result(linkage_runs.write(self.path / "whole.csv", rows, reference=True, linkage=False,
                                               header=OF_10_MM))
        self.assertFalse(whole["partial"])
        self.assertLess(result["G_ccw_um"], whole["G_ccw_um"])
        # About the set-up centre the arc is what it is: 0 to 180 degrees hold the largest radius of
        # the circle, where the backlash of 2 um a side and the scale of Y are.
        self.assertAlmostEqual(result["F_max_um"], whole["F_max_um"], delta=1e-3)

    def test_with_a_calibration_the_figures_are_those_of_the_machine(self):
        """The rig's linkage with encoder noise, calibrated on the rig; the truth is a grid encoder
        without noise. Without the calibration the figures are far off."""
        exact = self.path / "exact.toml"
        exact.write_text(pathlib.Path(MACHINE).read_text().replace("reference_um = 0.3", "reference_um = 0.0001"))
        good = wrong = judged = 0
        for seed in (7, 8):
            cube = self.rig_record("cube.csv", "--course", "cube", "--size", "45,45,45", "--points", "5,5,5",
                                   "--dwell", 0.2, "--feed", 2000, "--reference", seed=seed)
            linkage = self.path / "linkage.toml"
            self.done(cube, "--machine", MACHINE, "-o", linkage, "--quiet", "--folds", 1, command="calibrate")
            for plane in ("XY", "ZX"):
                run = self.rig_record("circle.csv", "--course", "circle", "--plane", plane, "--feed", 1200,
                                      "--reference", machine=exact, seed=seed)
                with_it = self.result(run, "--machine", MACHINE, "--filter", 50, "--calibration", linkage)
                self.assertEqual(with_it["linkage"]["file"], "linkage.toml")
                without = self.result(run, "--machine", MACHINE, "--filter", 50)
                truth = with_it["circles"][1]["runs"][0]
                measured = with_it["circles"][0]["runs"][0]
                nominal = without["circles"][0]["runs"][0]
                for key in ("G_ccw_um", "G_cw_um", "G_b_um", "F_max_um", "F_min_um", "D_um"):
                    judged += 1
                    U = 2 * measured["u"][key]
                    self.assertLess(U, 1.0, key)
                    good += abs(measured[key] - truth[key]) < U
                    # Its own uncertainty says nothing of tolerances: ten times that of the calibrated.
                    wrong += abs(nominal[key] - truth[key]) > 10 * U
                    self.assertLess(abs(measured[key] - truth[key]), 2 * U, (seed, plane, key))
        self.assertGreaterEqual(good, 0.85 * judged, (good, judged))
        self.assertGreaterEqual(wrong, 0.85 * judged, (wrong, judged))

    def test_refuses_a_calibration_that_does_not_fit(self):
        recording = linkage_runs.write(self.path / "good.csv", circle(perfect), reference=True)
        missing = self.path / "none.toml"
        self.refuse(recording, "--machine", MACHINE, "--calibration", missing, saying=["none.toml"])
        cube = self.rig_record("cube.csv", "--course", "cube", "--points", "3,3,3", "--dwell", 0.1, "--reference")
        linkage = self.path / "linkage.toml"
        self.done(cube, "--machine", MACHINE, "-o", linkage, "--quiet", "--folds", 1, command="calibrate")
        reference = linkage_runs.write(self.path / "grid.csv", circle(perfect), reference=True, linkage=False)
        self.refuse(reference, "--machine", MACHINE, "--calibration", linkage, saying=["none of the recordings"])
        self.refuse(recording, "--calibration", linkage, saying=["good.csv", "--machine FILE"])
        text = linkage.read_text()
        linkage.write_text(text.replace('machine = "demo-mill"', 'machine = "another"'))
        self.refuse(recording, "--machine", MACHINE, "--calibration", linkage, saying=['"another"', '"demo-mill"'])
        linkage.write_text(text[:len(text) // 2])
        self.refuse(recording, "--machine", MACHINE, "--calibration", linkage, saying=["linkage.toml"])

    def test_limit(self):
        recording = linkage_runs.write(self.path / "worn.csv", circle(worn), reference=True,
                                       linkage=False)
        self.assertEqual(self.run_program(recording, "--limit", "50").returncode, 0)
        done = self.run_program(recording, "--limit", "2")
        self.assertEqual(done.returncode, 1)
        self.assertIn("limit", done.stderr)

    def test_bad_input(self):
        rows = circle(perfect)
        recording = linkage_runs.write(self.path / "good.csv", rows)
        self.refuse(recording, saying=["good.csv", "--machine FILE"])
        self.refuse(recording, "--machine", MACHINE, "--plane", "XX", saying=['"XX"'])
        self.refuse(recording, "--machine", MACHINE, "--pitch", "5", saying=["--pitch"])
        line = [((x / 10, 0, 0), (x / 10, 0, 0), 1, 1, 100) for x in range(100)]
        self.refuse(linkage_runs.write(self.path / "line.csv", line), "--machine", MACHINE,
                    saying=["line.csv", "no circle"])
        bit = linkage_runs.write(self.path / "bit.csv", rows[:144] + rows[720:])
        self.refuse(bit, "--machine", MACHINE,
                    saying=["bit.csv", "144 points counter-clockwise", "72 of 360", "a quarter turn"])
        few = linkage_runs.write(self.path / "few.csv", circle(perfect, points=8))
        self.refuse(few, "--machine", MACHINE, saying=["few.csv", "8 points", " 0 of 360"])
        self.refuse(recording, "--machine", MACHINE, "--plane", "YZ",
                    saying=["good.csv", "commanded path in YZ", "no circle"])
        other = pathlib.Path(recording).read_text().replace('"demo-mill"', '"another"')
        (self.path / "other.csv").write_text(other)
        self.refuse(self.path / "other.csv", "--machine", MACHINE, saying=['"another"', '"demo-mill"'])
        plane = linkage_runs.write(self.path / "grid.csv", rows, reference=True, linkage=False)
        text = pathlib.Path(plane).read_text().replace("ref_z_mm", "spare")
        (self.path / "grid.csv").write_text(text)
        self.refuse(plane, "--plane", "YZ", saying=["ref_z_mm", "--plane"])
        text = pathlib.Path(recording).read_text().replace("pivot_1_rad", "spare")
        (self.path / "spare.csv").write_text(text)
        self.refuse(self.path / "spare.csv", "--machine", MACHINE, saying=["spare.csv", "pivot_1_rad: is missing"])


if __name__ == "__main__":
    unittest.main()
