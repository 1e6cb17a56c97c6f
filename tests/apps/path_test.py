"""`abbe path` as a user runs it, on paths whose errors are known."""
import math
import pathlib
import unittest

import linkage_runs
from program_case import MACHINE, ProgramCase


class PathTest(ProgramCase):
    command = "path"

    def test_stepping(self):
        """0, 5, ... 25 mm along X, Y and Z; X is 100 ppm too long and rolls 1 um of Z in 25 mm."""
        def actual(p):
            return p[0] * (1 + 100e-6), p[1], p[2] + p[0] / 25 * 0.001
        rows = []

        def go(a, b):
            for k in range(1, 20):
                rows.append([u + (v - u) * k / 20 for u, v in zip(a, b)])

        for axis in range(3):
            stops = [[5.0 * n if i == axis else 0.0 for i in range(3)] for n in range(6)]
            for number, stop in enumerate(stops):
                rows.extend([stop] * 40)
                go(stop, stops[number + 1] if number < 5 else [0.0, 0.0, 0.0])
        recording = linkage_runs.write(self.path / "steps.csv",
                                       [(p, actual(p), 1, 0, 100) for p in rows], reference=True)
        linkage, reference = self.result(recording, "--test", "stepping", "--machine",
                                         MACHINE)["tests"]
        for test in (linkage, reference):
            self.assertEqual([line["axis"] for line in test["lines"]], ["X", "Y", "Z"])
            x, y, z = test["lines"]
            self.assertAlmostEqual(x["largest_along_um"], 2.5, delta=1e-5)
            self.assertAlmostEqual(x["largest_um"], math.hypot(2.5, 1.0), delta=1e-5)
            self.assertAlmostEqual(x["stops"][2]["commanded_mm"], 10, delta=1e-9)
            self.assertAlmostEqual(x["stops"][2]["deviation_um"][2], 0.4, delta=1e-5)
            self.assertLess(y["largest_um"] + z["largest_um"], 1e-5)
            self.assertEqual(len(z["stops"]), 6)

    def square(self, actual, side=50.0):
        corners = [(0, 0), (side, 0), (side, side), (0, side), (0, 0)]
        rows = []
        for (ax, ay), (bx, by) in zip(corners, corners[1:]):
            for k in range(200):
                place = (5 + ax + (bx - ax) * k / 200, 5 + ay + (by - ay) * k / 200, 30.0)
                rows.append((place, actual(*place), 1, 1, 100))
        return rows

    def test_square(self):
        """Out of square by 150 urad (more than 90 degrees at the origin), X long by 80 ppm, the
        lower side bowed by 3 um, all of it 0.4 mm out of place."""
        centre = 30.0

        def actual(x, y, z):
            u, v = x - centre, y - centre
            bow = 0.003 * (u / 25) ** 2 if y == 5.0 else 0.0
            return x + 80e-6 * u - 150e-6 * v + 0.4, y + bow, z
        recording = linkage_runs.write(self.path / "square.csv", self.square(actual), reference=True)
        for test in self.result(recording, "--test", "square", "--machine", MACHINE)["tests"]:
            lower, right, upper, left = test["sides"]
            self.assertEqual([side["axis"] for side in test["sides"]], ["X", "Y", "X", "Y"])
            # Of the bow, 96 % of the side (corners are left out): 3 um * 0.96^2, and the pieces are
            # averages; minimum zone and least squares of a parabola are as wide as it is high.
            self.assertAlmostEqual(lower["straightness_mz_um"], 3 * 0.96**2, delta=0.07)
            self.assertLess(right["straightness_ls_um"] + upper["straightness_ls_um"], 1e-5)
            for side in (lower, upper):
                self.assertAlmostEqual(side["length_error_um"], 80e-6 * 50e3, delta=2e-3)
            # Corner 3, at the origin, is where both axes begin: 90 degrees + 150 urad.
            # The rows of the bowed side lie a quarter of a millimetre off the middle, where a bow
            # of 3 um has a slope of 2 * 3 um / (25 mm)^2 * 0.25 mm = 2.4 urad.
            for corner, sign, off in zip(test["corners_urad"], (-1, 1, -1, 1), (2.4, 0, 0, 2.4)):
                self.assertAlmostEqual(corner, sign * 150, delta=0.02 + off)
            self.assertAlmostEqual(test["largest_um"], 400, delta=20)
            # Aligned: what is left is half of the square and the scale, a few micrometres.
            self.assertLess(test["aligned_largest_um"], 8)

    def test_path_from_a_file(self):
        """A helix seen 2 um beside its path, late by no matter what."""
        nominal = [(30 + 10 * math.cos(t / 50), 30 + 10 * math.sin(t / 50), 20 + t / 60)
                   for t in range(600)]
        (self.path / "helix.csv").write_text(
            "# a helix\nx_mm,y_mm,z_mm\n" + "\n".join(f"{x!r}, {y!r}, {z!r}" for x, y, z in nominal))
        rows = []
        for number, (x, y, z) in enumerate(nominal[:-10]):
            late = nominal[number + 3]  # somewhere else on the path
            out = 0.002 / 10
            rows.append(((x, y, z), (late[0] + (late[0] - 30) * out, late[1] + (late[1] - 30) * out,
                                     late[2]), 1, 1, 100))
        recording = linkage_runs.write(self.path / "run.csv", rows, reference=True)
        for test in self.result(recording, "--test", self.path / "helix.csv", "--machine",
                                MACHINE)["tests"]:
            # The chord between nominal points 0.2 mm apart lies up to 0.5 um inside: points are on
            # its ends, so the distance is that of the points themselves.
            self.assertAlmostEqual(test["largest_um"], 2.0, delta=0.05)
            self.assertAlmostEqual(test["rms_um"], 2.0, delta=0.05)

    def cap(self, columns, value, force=8.5, feeds=(100, 500), strokes=4):
        lines = [*linkage_runs.HEADER, "time_s,x_mm,y_mm,z_mm,pass,direction,feed_mm_min," +
                 ",".join(columns) + ",cap_force_n,flags"]
        lines[1] = '# kind = "reference"' if columns[0].startswith("ref") else '# kind = "dwell"'
        time, x = 0.0, 0.0
        for feed in feeds:
            for stroke in range(strokes):
                sign = 1 if stroke % 2 == 0 else -1
                for _ in range(200):
                    dt = 0.005
                    x += sign * feed / 60 * dt
                    time += dt
                    values = [time, x, 10, 10, stroke, sign, feed, *value(x, sign, feed), force, 0]
                    lines.append(",".join(repr(float(v)) for v in values))
        path = self.path / f"{columns[0]}.csv"
        path.write_text("\n".join(lines) + "\n")
        return path

    def test_tool_cap(self):
        """Dragged by 1.2 um at 100 mm/min and 1.5 um at 500, on gauges with an offset of 80 um and a
        form of the cap; then by a reference."""
        def drag(feed):
            return 1.2 if feed == 100 else 1.5
        gauges = self.cap(["probe_d_um", "probe_e_um"],
                          lambda x, sign, feed: (80 + sign * drag(feed) + 0.1 * math.sin(9 * x), 50))
        # The gap grows when the ball stays behind a cap that moves along X: it falls with the
        # ball's displacement.
        result = self.result(gauges, "--test", "cap", "--gauge", "X=-probe_d_um", "--gauge",
                             "Y=probe_e_um")
        slow, fast = result["tests"][0]["displacements"]
        self.assertEqual((slow["force_n"], slow["feed_mm_min"]), (8.5, 100))
        # The turns of the strokes are taken over 7 rows of 200, where the velocity passes zero.
        self.assertAlmostEqual(slow["displacement_um"], 1.2, delta=0.02)
        self.assertAlmostEqual(fast["displacement_um"], 1.5, delta=0.02)
        # Each stroke repeats the one before, but for the rows at its turns; the form of the cap is the same
        # to and fro. Four strokes on one line leave two degrees of freedom: Student's t is 4.30.
        self.assertLess(slow["u_um"], 0.02)
        self.assertAlmostEqual(slow["coverage"], 4.303, delta=0.001)
        seen = self.cap(["ref_x_mm"], lambda x, sign, feed: (x - sign * drag(feed) / 1000,))
        slow, fast = self.result(seen, "--test", "cap")["tests"][0]["displacements"]
        self.assertAlmostEqual(slow["displacement_um"], 1.2, delta=0.02)
        one_way = self.cap(["ref_y_mm"], lambda x, sign, feed: (0.0,), strokes=1)
        self.refuse(one_way, "--test", "cap", saying=["ref_y_mm.csv", "one direction"])

    def test_articulation(self):
        """Five poses of a redundant story: the same seat, seen 1 um off to either side."""
        rows = []
        for number, off in enumerate((0, 0.001, -0.001, 0.001, -0.001), 1):
            rows += [((30, 30, 30), (30 + off, 30, 30), number, 0, 0)] * 10
        recording = linkage_runs.write(self.path / "seat.csv", rows)
        test = self.result(recording, "--test", "articulation", "--machine", MACHINE)["tests"][0]
        self.assertEqual(test["poses"], 5)
        self.assertAlmostEqual(test["location_um"], 2.0, delta=1e-6)
        self.assertAlmostEqual(test["largest_um"], 1.0, delta=1e-6)
        self.assertAlmostEqual(test["two_sigma_um"], 2 * math.sqrt(4 / 4), delta=1e-6)

    def test_on_the_rig_with_a_calibration(self):
        """Each course of the rig, by the calibrated linkage beside a grid encoder without noise."""
        exact = self.path / "exact.toml"
        exact.write_text(pathlib.Path(MACHINE).read_text().replace("reference_um = 0.3", "reference_um = 0.0001"))
        cube = self.rig_record("cube.csv", "--course", "cube", "--size", "45,45,45", "--points", "5,5,5",
                               "--dwell", 0.2, "--feed", 2000, "--reference")
        linkage = self.path / "linkage.toml"
        self.done(cube, "--machine", MACHINE, "-o", linkage, "--quiet", "--folds", 1, command="calibrate")
        (self.path / "way.csv").write_text("x_mm,y_mm,z_mm\n10,10,10\n20,10,10\n40,30,25\n")

        def tests(course, test, *options):
            run = self.rig_record("run.csv", "--course", course, "--reference", "--feed", 1200, *options,
                                  machine=exact)
            return self.result(run, "--test", test, "--machine", MACHINE, "--calibration", linkage)["tests"]

        seen, true = tests("stepping", "stepping")
        for line, expected, u in zip(seen["lines"], true["lines"], seen["u_calibration"]["lines"]):
            self.assertEqual((line["axis"], len(line["stops"])), (expected["axis"], 6))
            for stop, other, known in zip(line["stops"], expected["stops"], u["stops"]):
                for one, truth, of in zip(stop["deviation_um"], other["deviation_um"], known["deviation_um"]):
                    # Of 54 numbers none should be 3.5 standard uncertainties off.
                    self.assertLess(abs(one - truth), 3.5 * math.hypot(of, stop["u_um"]))
        seen, true = tests("square", "square")
        for side, expected, u in zip(seen["sides"], true["sides"], seen["u_calibration"]["sides"]):
            # Lines through 2000 rows of 0.5 um: 0.05 um at a corner.
            self.assertLess(abs(side["length_error_um"] - expected["length_error_um"]),
                            3 * math.hypot(u["length_error_um"], 0.05))
        self.assertLess(true["aligned_largest_um"], true["largest_um"])
        # The noise of a row, 0.5 um in each direction, four or five times.
        self.assertLess(seen["aligned_largest_um"], true["aligned_largest_um"] + 3)
        seen, true = tests(self.path / "way.csv", self.path / "way.csv")
        self.assertLess(seen["largest_um"], true["largest_um"] + 3)
        self.assertLess(true["largest_um"], 20)

    def test_tool_cap_by_the_linkage(self):
        """On the rig the ball trails by 1 um feed / (feed + 10 mm/min) at 8.5 N, more at less force."""
        cube = self.rig_record("cube.csv", "--course", "cube", "--size", "45,45,45", "--points", "5,5,5",
                               "--dwell", 0.2, "--feed", 2000, "--reference")
        linkage = self.path / "linkage.toml"
        self.done(cube, "--machine", MACHINE, "-o", linkage, "--quiet", "--folds", 1, command="calibrate")
        for feed, force in ((100, 8.5), (500, 8.5), (500, 4.25)):
            run = self.rig_record("cap.csv", "--course", "square", "--feed", feed, "--cap-force", force, "--reference")
            one = self.result(run, "--test", "cap", "--machine", MACHINE, "--calibration",
                              linkage)["tests"][0]["displacements"][0]
            # A row has 0.6 um of noise, and there are thousands; the calibration errs alike to and fro. U95
            # holds the truth (three times: not by accident; 0.02 um for rows at the corners) and is no wider than such noise makes it.
            U95 = one["coverage"] * one["u_um"]
            self.assertLess(abs(one["displacement_um"] - feed / (feed + 10) * 8.5 / force), 1.5 * U95 + 0.02)
            self.assertLess(U95, 5 * 0.6 / math.sqrt(one["rows"] / 2))
        alone = self.rig_record("alone.csv", "--course", "square")
        self.refuse(alone, "--test", "cap", "--machine", MACHINE, "--calibration", linkage,
                    saying=["alone.csv", "record a reference beside it"])

    def test_bad_input(self):
        rows = self.square(lambda x, y, z: (x, y, z))
        recording = linkage_runs.write(self.path / "square.csv", rows)
        self.refuse(recording, "--test", "stepping", "--machine", MACHINE, saying=["stepping test"])
        self.refuse(recording, "--test", "circles", "--machine", MACHINE,
                    saying=["circles", "articulation"])
        self.refuse(recording, "--test", "square", saying=["--machine FILE"])
        self.refuse(recording, "--test", "cap", saying=["--gauge"])
        self.refuse(recording, "--test", "cap", "--gauge", "X=probe_z_um", saying=["probe_z_um"])
        self.refuse(recording, "--test", "articulation", "--machine", MACHINE, saying=["moves by 50 mm", "one seat"])
        turn = [((30 + 10 * math.cos(t / 50), 30 + 10 * math.sin(t / 50), 30),) * 2 + (1, 1, 100)
                for t in range(314)]
        self.refuse(linkage_runs.write(self.path / "turn.csv", turn), "--test", "square", "--machine", MACHINE,
                    saying=["turn.csv", "% of the rows", "abbe circle"])
        (self.path / "bad.csv").write_text("x_mm,y_mm,z_mm\n1,2,3\n4,five,6\n")
        self.refuse(recording, "--test", self.path / "bad.csv", "--machine", MACHINE,
                    saying=["bad.csv:3", '"five"'])
        three = [(p, p, 1, 1, 100) for p in ([0, 0, 0], [1, 2, 3], [5, 1, 2])] * 5
        self.refuse(linkage_runs.write(self.path / "space.csv", three), "--test", "square",
                    "--machine", MACHINE, saying=["space.csv", "mm"])


if __name__ == "__main__":
    unittest.main()
