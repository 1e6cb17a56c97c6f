#!/usr/bin/env python3
"""`abbe sweep` against machines that abbe did not write, well-behaved and not.

    ABBE=path/to/abbe sweep_test.py
"""
import json
import os
import pathlib
import re
import signal
import subprocess
import tempfile
import threading
import time
import unittest

from modbus_machine import Machine, RawServer, serve_with_pymodbus

ABBE = os.environ["ABBE"]
MACHINE_FILE = pathlib.Path(__file__).parents[2] / "machines" / "demo_mill.toml"
SWEEP = """passes = 2
dwell_s = 0.25
settle_s = 0.02
window_um = 20.0
feed_mm_min = 600.0
idle_s = 30.0
[sweep.X]
first_mm = 0.0
last_mm = 30.0
step_mm = 10.0
"""


class SweepTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.out = self.folder / "out"

    def machine_file(self, port, **replace):
        """The demonstration machine on `port`, with the short sweep of the test machine."""
        text = MACHINE_FILE.read_text()
        text = re.sub(r"(?m)^port = .*", f"port = {port}", text)
        # The machine's time stands still between the devices of a set, however long a busy computer takes.
        text = re.sub(r"(?m)^max_skew_ms = .*", "max_skew_ms = 2000.0", text)
        text = re.sub(r"(?m)^unit = (\d)", r"unit = \1\nresponse_timeout_ms = 2000.0\ndeadline_ms = 4000.0", text)
        text = re.sub(r"(?ms)^\[sweep\]\n.*?(?=^\[devices\])", "[sweep]\n" + SWEEP + "\n", text)
        for key, value in replace.items():
            text, count = re.subn(rf"(?m)^{key} = .*", f"{key} = {value}", text)
            self.assertGreater(count, 0, key)
        path = self.folder / "machine.toml"
        path.write_text(text)
        return path

    def start(self, port, *arguments, **replace):
        return subprocess.Popen(
            [ABBE, "sweep", "--axis", "X", "--machine", self.machine_file(port, **replace), "--out", self.out,
             "--quiet", *arguments],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def finish(self, sweep):
        out, err = sweep.communicate(timeout=200)
        return sweep.returncode, out, err

    def await_rows(self, count):
        """Until the recording has so many rows: sooner or later, as the computer has time."""
        path = self.out / "sweep_X.csv"
        for _ in range(1200):
            if path.exists() and len(path.read_text().splitlines()) > count + 20:  # 20: more than the header has
                return
            time.sleep(0.05)
        self.fail(f"no {count} rows within a minute")

    def result(self):
        return json.loads((self.out / "sweep_X.json").read_text())

    def rows(self):
        lines = (self.out / "sweep_X.csv").read_text().splitlines()
        names, *rows = [line.split(",") for line in lines if not line.startswith("#")]
        return [dict(zip(names, row)) for row in rows]

    def assert_one_line(self, err, *words):
        self.assertEqual(len(err.strip().splitlines()), 1, err)
        for word in words:
            self.assertIn(word, err)

    def assert_truth(self):
        """The five errors, in the gauge of the result, within what 16-bit words and rounding allow."""
        result = self.result()
        stations = [1000 * station for station in result["stations"]]
        truth = [Machine.errors(d) for d in stations]
        for name in ("EAX", "EBX", "ECX"):
            for measured, true in zip(result["errors_at_target"][name]["value"], truth):
                self.assertAlmostEqual(measured, true[name], delta=1e-6)
        for name in ("EYX", "EZX"):
            values = [true[name] for true in truth]
            mean_d, mean_v = sum(stations) / len(stations), sum(values) / len(values)
            slope = sum((d - mean_d) * (v - mean_v) for d, v in zip(stations, values)) / sum(
                (d - mean_d) ** 2 for d in stations)
            for measured, d, value in zip(result["errors_at_target"][name]["value"], stations, values):
                self.assertAlmostEqual(1e6 * measured, value - mean_v - slope * (d - mean_d), delta=0.02)

    def test_reads_an_independent_server(self):
        machine, port = Machine(), 15602
        serve_with_pymodbus(machine, port)
        code, _, err = self.finish(self.start(port, "--operator", "A. Smith"))
        self.assertEqual(code, 0, err)
        self.assert_truth()
        self.assertEqual(self.result()["protocol"], {"operator": "A. Smith"})

    def test_a_server_that_vanishes_and_returns_costs_only_flagged_rows(self):
        server = RawServer(Machine())
        sweep = self.start(server.port)
        self.await_rows(200)
        server.vanish()
        time.sleep(0.5)
        server.come_back()
        code, _, err = self.finish(sweep)
        self.assertEqual(code, 0, err)
        rows = self.rows()
        flagged = [row for row in rows if int(row["flags"]) & 4]
        self.assertGreater(len(flagged), 3)
        self.assertTrue(all("nan" in row.values() for row in flagged))
        self.assertEqual(rows[-1]["flags"], "0")
        self.assert_truth()

    def test_nobody_listens(self):
        server = RawServer(Machine())
        server.vanish()
        code, _, err = self.finish(self.start(server.port))
        self.assertEqual(code, 3)
        self.assert_one_line(err, "127.0.0.1", str(server.port))

    def test_another_unit_answers(self):
        server = RawServer(Machine())
        server.fault = "other_unit"
        code, _, err = self.finish(self.start(server.port))
        self.assertEqual(code, 3)
        self.assert_one_line(err, "unit")

    def test_the_device_answers_with_an_exception(self):
        server = RawServer(Machine())
        server.fault = "exception"
        code, _, err = self.finish(self.start(server.port))
        self.assertEqual(code, 3)
        self.assert_one_line(err, "exception")

    def test_a_frozen_register_is_never_good(self):
        server = RawServer(Machine(dwell_s=0.4))
        server.machine.frozen_at = 1.0
        code, _, err = self.finish(self.start(server.port, stale_ms="300.0"))
        stale = [int(row["flags"]) & 1 for row in self.rows()]
        self.assertIn(1, stale)
        self.assertNotIn(0, stale[stale.index(1):])
        self.assertIn(code, (2, 3))
        self.assertIn("probe_a", err)

    def test_a_machine_that_stops_moving_ends_the_sweep_and_keeps_the_data(self):
        server = RawServer(Machine())
        server.machine.stop_after = 1.0
        code, _, err = self.finish(self.start(server.port, idle_s="4.0"))
        self.assertEqual(code, 3)
        self.assertIn("stands still", err)
        self.assertGreater(len(self.rows()), 20)

    def test_ctrl_c_ends_cleanly(self):
        server = RawServer(Machine())
        sweep = self.start(server.port)
        self.await_rows(20)
        sweep.send_signal(signal.SIGINT)
        code, _, err = self.finish(sweep)
        self.assertEqual(code, 3, err)
        self.assertIn("interrupted", err)
        self.assertGreater(len(self.rows()), 20)
        self.assertTrue((self.out / "sweep_X.csv").read_text().endswith("\n"))

    def test_what_a_killed_sweep_leaves_can_be_read(self):
        server = RawServer(Machine())
        sweep = self.start(server.port)
        self.await_rows(200)
        sweep.kill()
        sweep.communicate()
        self.assertEqual(subprocess.run([ABBE, "convert", self.out / "sweep_X.csv", self.out / "kept.h5"]).returncode, 0)

    def test_slips_are_refused_before_the_machine_moves(self):
        for changed, says in ((("order = \"ABCD\"", "order = \"CDAB\""), "the travel is 0 to 60 mm"),
                              (("scale = 0.0030517578125", "scale = 3.0517578125"), "range is 0 to 200 um"),
                              (("scale = 0.0030517578125", "scale = 0.0000030517578125"), "close to zero")):
            server = RawServer(Machine())
            path = self.machine_file(server.port)
            path.write_text(path.read_text().replace(*changed))
            done = subprocess.run([ABBE, "sweep", "--axis", "X", "--machine", path, "--out", self.out],
                                  capture_output=True, text=True, timeout=100)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assert_one_line(done.stderr, says, "machine file")
            self.assertIsNone(server.machine.started)
            self.assertEqual(list(self.out.glob("*.csv")), [])

    def test_a_position_that_turns_impossible_is_flagged_and_named(self):
        server = RawServer(Machine())
        sweep = self.start(server.port, idle_s="3.0")
        self.await_rows(100)
        server.machine.position = lambda: -20363.0
        server.machine.gaps = lambda: [100.0 + 0.01 * (server.machine.ticks % 7)] * 5
        code, _, err = self.finish(sweep)
        self.assertEqual(code, 3, err)
        self.assertIn("x_mm reads -20363, and the travel is 0 to 60 mm", err)
        last = self.rows()[-1]
        self.assertEqual((last["x_mm"], last["flags"]), ("nan", "2"))

    def test_prompt_looks_at_the_position(self):
        server = RawServer(Machine(passes=1))
        server.machine.position = lambda: 20.0  # mm, wherever the operator is asked to go
        sweep = subprocess.Popen(
            [ABBE, "sweep", "--axis", "X", "--prompt", "--machine", self.machine_file(server.port), "--out", self.out],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        out, err = sweep.communicate("\n\n\n", timeout=100)  # thrice, at the first station
        self.assertEqual(sweep.returncode, 3, err)
        self.assertEqual(out.count("move X to 0.000 mm"), 4)
        self.assertEqual(err.count("X stands at 20.0000 mm, not within 0.02 mm of 0.0000 mm"), 3)
        self.assertEqual(self.rows(), [])

    def test_a_folder_that_cannot_be_written(self):
        server = RawServer(Machine())
        self.out = pathlib.Path("/proc/abbe")
        code, _, err = self.finish(self.start(server.port))
        self.assertEqual(code, 2)
        self.assert_one_line(err, "/proc/abbe")

    def test_nothing_measured_is_overwritten(self):
        self.out.mkdir()
        (self.out / "sweep_X.csv").write_text("precious")
        server = RawServer(Machine(passes=1))
        code, _, err = self.finish(self.start(server.port, passes="1"))
        self.assertEqual(code, 0, err)
        self.assertEqual((self.out / "sweep_X.csv").read_text(), "precious")
        self.assertTrue((self.out / "sweep_X_2.csv").exists())

    def test_an_unknown_key_names_the_nearest(self):
        server = RawServer(Machine())
        path = self.machine_file(server.port)
        path.write_text(path.read_text().replace("settle_s", "setle_s"))
        line = 1 + path.read_text()[: path.read_text().index("setle_s")].count("\n")
        sweep = subprocess.run([ABBE, "sweep", "--axis", "X", "--machine", path, "--out", self.out],
                               capture_output=True, text=True)
        self.assertEqual(sweep.returncode, 2)
        self.assert_one_line(sweep.stderr, f":{line}:", "setle_s", "settle_s")


if __name__ == "__main__":
    unittest.main(verbosity=0)
