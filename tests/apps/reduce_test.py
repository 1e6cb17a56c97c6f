"""`abbe reduce` as a user runs it: results, and for every bad input one line that says where, and the code."""
import json
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

PROGRAM = os.environ["ABBE"]
MACHINE = os.environ["ABBE_MACHINE"]
HEADER = ["# abbe-recording = 1", '# kind = "sweep"', '# machine = "demo-mill"', '# axis = "X"',
          '# mounting = "M1"']
COLUMNS = ("time_s,x_mm,y_mm,z_mm,pass,direction,feed_mm_min,"
           "probe_a_um,probe_b_um,probe_c_um,probe_d_um,probe_e_um,flags")


def rows(axis="X", stations=5, dwell=60):
    """A machine without error under a target tilted by 100 urad about Y: the top gaps grow with x."""
    lines, time = [], 0.0
    for number in (1, 2):
        for direction in (1, -1):
            order = range(stations) if direction > 0 else reversed(range(stations))
            for station in order:
                for k in range(dwell):
                    position = {"X": [10.0 * station, 0, 0], "Y": [0, 10.0 * station, 0]}[axis]
                    noise = 0.02 * ((7 * k) % 11 - 5) / 5
                    gaps = [100 + station + noise] * 3 + [90 - noise] * 2
                    values = [f"{time:.3f}", *position, number, direction, 600, *gaps, 0]
                    lines.append(",".join(str(value) for value in values))
                    time += 0.005
    return lines


class Reduce(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, lines, header=None):
        path = self.path / name
        path.write_text("\n".join([*(header or HEADER), COLUMNS, *lines]) + "\n")
        return str(path)

    def run_program(self, *arguments):
        return subprocess.run([PROGRAM, "reduce", *map(str, arguments)], capture_output=True,
                              text=True, timeout=60)

    def refuse(self, *arguments, saying):
        done = self.run_program(*arguments)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        for text in saying:
            self.assertIn(text, done.stderr)

    def test_result_and_table(self):
        recording = self.write("sweep_X.csv", rows())
        done = self.run_program(recording, "--machine", MACHINE, "--out", self.path / "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("EBX pitch", done.stdout)
        result = json.loads((self.path / "out" / "sweep_X.json").read_text())
        # The tilt is a slope of EZX and no error: 1 um in 10 mm, towards the head's back.
        self.assertAlmostEqual(result["slopes"]["EZX"]["value"], -100e-6, delta=1e-9)
        for name in ("EAX", "EBX", "ECX", "EYX", "EZX"):
            for value in result["errors"][name]["value"]:
                self.assertLess(abs(value), 1e-9)

    def test_numbers_have_the_decimals_of_their_uncertainty(self):
        done = self.run_program(self.write("sweep_X.csv", rows()), "--machine", MACHINE)
        self.assertEqual(done.returncode, 0, done.stderr)
        number = r"-?\d+(?:\.(\d+))?"
        lines = re.findall(rf"(?m)^  E[ABC]X \w+ +{number} +({number}) ", done.stdout)
        self.assertEqual(len(lines), 3, done.stdout)
        lines += re.findall(rf"(?m)^  E[YZ]X +{number} +({number}) ", done.stdout)
        self.assertEqual(len(lines), 5, done.stdout)
        uncertain = [line for line in lines if float(line[1]) > 0]  # a range of 0 has no uncertainty here
        self.assertGreater(len(uncertain), 1, done.stdout)
        for decimals, U, of_U in uncertain:
            self.assertEqual(len(decimals), len(of_U))
            digits = U.replace(".", "").lstrip("0")
            self.assertTrue(len(digits) == 2 or (of_U == "" and len(digits) > 2), U)

    def test_the_protocol_goes_into_the_result(self):
        header = [*HEADER[:-1], "# [protocol]", '# operator = "A. Smith"', '# serial = "mill 4711, head P-12"']
        recording = self.write("sweep_X.csv", rows(), header)
        self.assertEqual(self.run_program(recording, "--machine", MACHINE, "--json", self.path / "a.json").returncode, 0)
        result = json.loads((self.path / "a.json").read_text())
        self.assertEqual(result["protocol"], {"operator": "A. Smith", "serial": "mill 4711, head P-12"})
        plain = self.write("plain.csv", rows())
        self.assertEqual(self.run_program(plain, "--machine", MACHINE, "--json", self.path / "b.json").returncode, 0)
        self.assertNotIn("protocol", json.loads((self.path / "b.json").read_text()))

    def test_bad_rows(self):
        good = rows()
        bad = list(good)
        bad[100] = bad[100].replace(bad[100].split(",")[9], "250.0")
        self.refuse(self.write("range.csv", bad), "--machine", MACHINE,
                    saying=["range.csv", "row 101", "250 um", "range_um"])
        bad = list(good)
        fields = bad[10].split(",")
        fields[7] = "-3.0"
        bad[10] = ",".join(fields)
        self.refuse(self.write("negative.csv", bad), "--machine", MACHINE,
                    saying=["negative.csv:17", "probe_a_um", "-3"])

    def test_bad_files_and_options(self):
        recording = self.write("sweep_X.csv", rows())
        self.refuse(recording, saying=["--machine FILE"])
        self.refuse(self.path / "none.csv", "--machine", MACHINE, saying=["none.csv"])
        dwell = self.write("dwell.csv", rows(), [HEADER[0], '# kind = "dwell"'])
        self.refuse(dwell, "--machine", MACHINE, saying=["dwell.csv", "sweep or reference"])
        other = self.write("other.csv", rows(), [*HEADER[:2], '# machine = "b"', HEADER[3]])
        self.refuse(other, "--machine", MACHINE, saying=['"b"', '"demo-mill"'])
        machine = self.path / "typo.toml"
        machine.write_text(pathlib.Path(MACHINE).read_text().replace("range_um", "rnge_um"))
        self.refuse(recording, "--machine", machine, saying=["typo.toml:", "rnge_um", "range_um"])
        self.refuse(recording, recording, "--machine", MACHINE, "--json", self.path / "a.json",
                    saying=["--json"])

    def test_slips_of_positions_and_gaps_are_refused(self):
        def changed(name, column, change):
            lines = [line.split(",") for line in rows()]
            for fields in lines:
                for at in column:
                    fields[at] = change(fields[at])
            return self.write(name, [",".join(fields) for fields in lines])

        gaps = range(7, 12)
        self.refuse(changed("far.csv", [1], lambda x: str(float(x) + 6e7)), "--machine", MACHINE,
                    saying=["far.csv: row 1", "x_mm", "far outside the travel of 0 to 60 mm"])
        self.refuse(changed("order.csv", [3], lambda z: "-20363"), "--machine", MACHINE,
                    saying=["z_mm is -20363", "word order"])
        self.refuse(changed("still.csv", gaps, lambda gap: "100"), "--machine", MACHINE,
                    saying=["still.csv", "probe_a_um shows 100 um in every dwell"])
        self.refuse(changed("zero.csv", gaps, lambda gap: "0.0"), "--machine", MACHINE,
                    saying=["zero.csv", "touch the target"])

    def test_needs_no_devices(self):
        text = pathlib.Path(MACHINE).read_text()
        machine = self.path / "bare.toml"
        machine.write_text(text[:text.index("[devices]")])
        recording = self.write("sweep_X.csv", rows())
        done = self.run_program(recording, "--machine", machine, "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        done = subprocess.run([PROGRAM, "sweep", "--axis", "X", "--machine", machine, "--out", self.path / "out"],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("has no table [devices.NAME]", done.stderr)

    def test_squareness_needs_one_mounting(self):
        x = self.write("sweep_X.csv", rows())
        y_header = [*HEADER[:3], '# axis = "Y"']
        y = self.write("sweep_Y.csv", rows("Y"), [*y_header, HEADER[4]])
        done = self.run_program(x, y, "--squareness", "--machine", MACHINE)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("squareness C0Y", done.stdout)
        moved = self.write("moved_Y.csv", rows("Y"), [*y_header, '# mounting = "M2"'])
        done = self.run_program(x, moved, "--squareness", "--machine", MACHINE)
        self.assertEqual(done.returncode, 2)
        self.assertIn("mounted anew", done.stderr)


if __name__ == "__main__":
    unittest.main()
