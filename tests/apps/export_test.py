#!/usr/bin/env python3
"""`abbe export` as other programs see it: HDF5 read by h5py, .vtr by VTK's own reader, and the rest by a
few lines of Python, each held against the errors that NumPy computes for the same machine.

    ABBE=path/to/abbe export_test.py
"""
import json
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np

from map_machine import TRAVEL, MapMachine

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLRectilinearGridReader
except ImportError:
    vtkXMLRectilinearGridReader = None

ABBE = os.environ["ABBE"]
ROUNDING_UM = 1e-9  # of a chain of full rotations in two ways, lengths of 0.1 m


class ExportTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.machine = MapMachine(7)
        self.map = self.machine.write(self.folder / "map.toml")

    def export(self, format, name, *options):
        out = self.folder / name
        done = subprocess.run([ABBE, "export", self.map, "--format", format, "--out", out, *options],
                              capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn(f"{format} drops: ", done.stdout)
        self.assertIn("differs from the map by up to", done.stdout)
        return out

    def errors_um(self, count, tool=None):
        axis = np.linspace(0, TRAVEL, count)
        return np.array([1e6 * self.machine.error((x, y, z), tool) for z in axis for y in axis for x in axis])

    def test_csv_and_json_hold_the_errors_of_the_machine(self):
        expected = self.errors_um(4)
        rows = [line for line in self.export("csv", "m.csv", "--points", "4").read_text().splitlines()
                if not line.startswith("#")]
        self.assertEqual(rows[0], "x_mm,y_mm,z_mm,ex_um,ey_um,ez_um,u95x_um,u95y_um,u95z_um")
        table = np.array([[float(word) for word in row.split(",")] for row in rows[1:]])
        self.assertLess(np.abs(table[:, 3:6] - expected).max(), ROUNDING_UM)
        self.assertGreater(np.abs(expected).max(), 5)
        np.testing.assert_allclose(table[1, :3], (20, 0, 0), atol=1e-12)
        data = json.loads(self.export("json", "m.json", "--points", "4").read_text())
        self.assertLess(np.abs(np.array(data["error_um"]) - expected).max(), ROUNDING_UM)

    def test_the_limit_counts_what_is_written(self):
        for format in ("isg", "etalon", "sinumerik"):
            self.export(format, "many." + format, "--points", "300")
        for format, points, words in (("linuxcnc", "300", "300 points for X: a .comp of LinuxCNC takes 2 to 256"),
                                      ("csv", "300", "--points: 2.7e+07 points in all"),
                                      ("isg", "4000000", "--points: 1.2e+07 points in all")):
            done = subprocess.run([ABBE, "export", self.map, "--format", format, "--out", self.folder / "x", "--points",
                                   points], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, format)
            self.assertIn(words, done.stderr)

    def test_another_tool_is_another_grid(self):
        data = json.loads(self.export("json", "m.json", "--points", "3", "--tool", "0,0,-150").read_text())
        expected = self.errors_um(3, np.array([0, 0, -0.150]))
        self.assertLess(np.abs(np.array(data["error_um"]) - expected).max(), ROUNDING_UM)

    def test_h5py_reads_the_hdf5(self):
        import h5py
        with h5py.File(self.export("hdf5", "m.h5", "--points", "4")) as file:
            self.assertEqual(file["error_um"].shape, (4, 4, 4, 3))
            self.assertLess(np.abs(file["error_um"][:].reshape(-1, 3) - self.errors_um(4)).max(), ROUNDING_UM)
            self.assertEqual(file.attrs["chain"].decode(), self.machine.chain)
            np.testing.assert_allclose(file["tool_mm"][:], 1e3 * self.machine.tool, rtol=1e-15)

    def test_the_grid_for_linuxcnc_holds_the_error_for_every_tool(self):
        out = self.export("linuxcnc-hal", "m.hal", "--points", "4")
        self.assertIn("loadrt abbe_map grid=m.grid\n", out.read_text())
        lines = [line for line in (self.folder / "m.grid").read_text().splitlines() if not line.startswith("#")]
        self.assertEqual(lines[0], "abbe-map-grid 1")
        np.testing.assert_array_equal(np.array(lines[1].split()[1:], float), self.machine.signs)
        np.testing.assert_allclose(np.array(lines[2].split()[1:], float), 1e3 * self.machine.tool, rtol=1e-12)
        np.testing.assert_allclose(np.array(lines[3].split()[1:], float), (0, 60, 4, -0.1, 60.1), atol=1e-9)
        self.assertEqual(lines[-1], "end")
        table = np.array([line.split() for line in lines[6:-1]], float)
        # Written to 1e-6 um and urad. For another tool the grid leaves out turn^2 times the difference: some nm.
        turn = 1e-6 * np.linalg.norm(table[:, 3:], axis=1).max()
        self.assertLess(turn, 1e-3)
        for tool in (self.machine.tool, np.array([0.1, 0.05, -0.3])):
            second = 1e6 * turn ** 2 * np.linalg.norm(tool - self.machine.tool)
            errors = table[:, :3] + np.cross(table[:, 3:], tool)
            self.assertLess(np.abs(errors - self.errors_um(4, tool)).max(), 2e-6 + second)

    @unittest.skipIf(vtkXMLRectilinearGridReader is None, "python3-vtk9 is not installed")
    def test_vtk_reads_the_vtr(self):
        reader = vtkXMLRectilinearGridReader()
        reader.SetFileName(str(self.export("vtk", "m.vtr", "--points", "4")))
        reader.Update()
        grid = reader.GetOutput()
        self.assertEqual(grid.GetDimensions(), (4, 4, 4))
        np.testing.assert_allclose(grid.GetBounds(), (0, 60, 0, 60, 0, 60), atol=1e-12)
        values = vtk_to_numpy(grid.GetPointData().GetArray("error_um"))
        self.assertLess(np.abs(values - self.errors_um(4)).max(), ROUNDING_UM)
        self.assertEqual(grid.GetPointData().GetVectors().GetName(), "error_um")
        self.assertEqual(grid.GetPointData().GetArray("u95_um").GetNumberOfTuples(), 64)

    def test_isg_and_etalon_hold_the_motions_and_are_taken_as_maps(self):
        for format in ("isg", "etalon"):
            file = self.export(format, "m." + format, "--points", "25")
            text = file.read_text()
            place = np.linspace(0, 60, 25)[7]
            if format == "isg":
                header, *rows = text[text.index("Y EXY"):].splitlines()
                self.assertEqual(header, "Y EXY EYY EZY EAY EBY ECY")
                row = [float(word) for word in rows[7].split()]
                self.assertAlmostEqual(row[0], place, 12)
                for name, value in zip(("EXY", "EYY", "EZY"), row[1:4]):
                    self.assertAlmostEqual(value, 1e3 * self.machine.motion(name, place / 1e3), 12)
                self.assertAlmostEqual(row[5], self.machine.motion("EBY", place / 1e3), 15)
            else:
                lines = text[text.index("[EBY]"):].splitlines()
                self.assertEqual(lines[1], "Gridpoints = {")
                self.assertAlmostEqual(float(lines[9].split()[1]), self.machine.motion("EBY", place / 1e3), 15)
            done = subprocess.run([ABBE, "export", file, "--format", "json", "--points", "4", "--out",
                                   self.folder / "back.json"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)
            back = json.loads((self.folder / "back.json").read_text())
            self.assertNotIn("u95_um", back)
            # Chords of 2.5 mm across a polynomial of degree 5 over 60 mm, with arms of 0.1 m.
            self.assertLess(np.abs(np.array(back["error_um"]) - self.errors_um(4)).max(), 0.5)

    def test_sinumerik_and_linuxcnc_correct_along_their_lines(self):
        self.export("sinumerik", "m.ini", "--points", "13")
        text = (self.folder / "m.ini").read_text()
        middle, end = np.full(3, TRAVEL / 2), np.array([TRAVEL, TRAVEL / 2, TRAVEL / 2])
        step = self.machine.error(end) - self.machine.error(middle)
        value = float(next(line for line in text.splitlines() if line.startswith("$AN_CEC[1,12]=")).split("=")[1])
        self.assertAlmostEqual(value, -self.machine.signs[1] * step[1] * 1e3, 8)  # written to 1e-9 mm
        self.export("linuxcnc", "m.comp", "--points", "13")
        nominal, actual, _ = map(float, (self.folder / "m_x.comp").read_text().splitlines()[-1].split())
        self.assertAlmostEqual(actual - nominal, self.machine.signs[0] * self.machine.error(end)[0] * 1e3, 8)

    def test_what_cannot_be_done_is_refused_in_one_line(self):
        def refused(words, *arguments):
            done = subprocess.run([ABBE, "export", *arguments], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
            self.assertIn(words, done.stderr)
        refused("xls not in {", self.map, "--format", "xls")
        refused("cannot be read", self.folder / "none.toml", "--format", "csv")
        refused("2 to 256", self.map, "--format", "linuxcnc", "--points", "300,2,2")
        refused("at least 2 points", self.map, "--format", "csv", "--points", "1")
        (self.folder / "cut.toml").write_text(self.map.read_text()[:2000])
        refused("cut.toml", self.folder / "cut.toml", "--format", "csv")


if __name__ == "__main__":
    unittest.main()
