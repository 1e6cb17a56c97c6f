#!/usr/bin/env python3
"""`abbe record` and logs of CAN traffic, in the guest that tests/hal/uml_run makes: a Modbus machine and
CANopen encoders that are not abbe's, candump and canplayer beside them.

    ABBE=path/to/abbe uml_run -- python3 record_test.py
"""
import csv
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

from modbus_machine import Machine, RawServer

ABBE = os.environ["ABBE"]
HERE = pathlib.Path(__file__).parent
PER_TURN = 1 << 24  # of the demonstration machine
STEP = 2 * math.pi / PER_TURN


def rows_of(path):
    lines = path.read_text().splitlines()
    header = [line for line in lines if line.startswith("#")]
    return header, list(csv.DictReader(lines[len(header):]))


def counts_of(row):
    """The counts of the three encoders, as sent: 1000 * node + 7 * SYNCs since the start."""
    return [round(float(row[f"pivot_{node}_rad"]) / STEP) for node in (1, 2, 3)]


class RecordTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.machine = self.folder / "machine.toml"
        server = RawServer(Machine())
        text = (HERE.parents[1] / "machines" / "demo_mill.toml").read_text()
        text = re.sub(r"(?m)^port = .*", f"port = {server.port}", text)
        text = re.sub(r"(?m)^max_skew_ms = .*", "max_skew_ms = 1000.0", text)
        # The guest has one virtual processor, which the whole computer shares.
        self.machine.write_text(text.replace(
            "sync_ms = 1.0", "sync_ms = 1.0\nanswer_timeout_ms = 300.0\nheartbeat_timeout_ms = 5000.0"))

    def start(self, *command):
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def serve_encoders(self):
        encoders = self.start(sys.executable, HERE.parent / "hal" / "can_encoders.py", "vcan0", PER_TURN, 1, 2, 3)
        self.assertEqual(encoders.stdout.readline(), "ready\n")

    def abbe(self, *arguments):
        return subprocess.run([ABBE, *map(str, arguments)], capture_output=True, text=True, timeout=120)

    def listen(self, path):
        with open(path, "w") as log:
            candump = subprocess.Popen(["candump", "-L", "vcan0"], stdout=log)
        time.sleep(1.0)  # it opens its socket
        return candump

    def test_probes_and_encoders_in_one_recording_on_one_clock(self):
        self.serve_encoders()
        candump = self.listen(self.folder / "bus.log")
        recording = self.folder / "all.csv"
        done = self.abbe("record", self.machine, "--seconds", 4, "-o", recording)
        candump.terminate()
        candump.wait()
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"recorded \d+ rows .* skew [\d.]+ ms on average, [\d.]+ ms at worst")
        print(done.stdout, end="", file=sys.stderr)

        header, rows = rows_of(recording)
        self.assertIn('# kind = "linkage"', header)
        self.assertIn('# "linkage" = "canopen: pivot_1_rad, pivot_2_rad, pivot_3_rad"', header)
        good = [row for row in rows if row["flags"] == "0"]
        self.assertGreater(len(good), 20)
        times = [float(row["time_s"]) for row in rows]
        self.assertEqual(times, sorted(times))
        for row in good:
            syncs = {(count - 1000 * node) / 7 for node, count in enumerate(counts_of(row), 1)}
            self.assertEqual(len(syncs), 1, row)  # all three answered the same SYNC
            self.assertGreater(float(row["skew_ms"]), 0.0)
            self.assertGreater(float(row["probe_a_um"]), 0.0)

        # What candump heard meanwhile holds the same angles, at the same distances in time.
        done = self.abbe("convert", self.folder / "bus.log", self.folder / "log.csv", "--machine", self.machine)
        self.assertEqual(done.returncode, 0, done.stderr)
        logged = {tuple(counts_of(row)): float(row["time_s"])
                  for row in rows_of(self.folder / "log.csv")[1] if row["flags"] == "0"}
        for row in good:
            self.assertIn(tuple(counts_of(row)), logged)

    def test_setting_the_calendar_changes_no_time_and_no_reading(self):
        """As a service that keeps the computer's time does, or an operator: an hour on, two hours back."""
        self.serve_encoders()
        recording = self.folder / "all.csv"
        began, calendar = time.monotonic(), time.time()
        recorder = self.start(ABBE, "record", self.machine, "--seconds", 6, "-o", recording, "--quiet")
        while not recording.exists() and time.monotonic() < began + 60:
            time.sleep(0.05)
        for seconds in (3600, -7200):
            time.sleep(2)
            time.clock_settime(time.CLOCK_REALTIME, time.time() + seconds)
        recorder.wait(timeout=100)
        took = time.monotonic() - began
        self.assertLess(time.time() - calendar, -3000)  # it was set
        self.assertEqual(recorder.returncode, 0)

        header, rows = rows_of(recording)
        times = [float(row["time_s"]) for row in rows]
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[-1] - times[0], 5.0)
        self.assertLess(times[-1] - times[0], min(took, 7.0))
        good = [row for row in rows if row["flags"] == "0"]
        self.assertGreater(len(good), 0.8 * len(rows))
        for row in good:
            self.assertEqual(len({(count - 1000 * node) / 7 for node, count in enumerate(counts_of(row), 1)}), 1, row)
            self.assertLess(float(row["skew_ms"]), 1000.0)

    def test_canplayer_sends_a_recording_again(self):
        recording = self.folder / "angles.csv"
        angles = [(20 * i, -30 * i, 7 * i) for i in range(50)]
        recording.write_text(
            '# abbe-recording = 1\n# kind = "dwell"\n# started = 2026-11-21T09:00:00Z\n'
            "time_s,pivot_1_rad,pivot_2_rad,pivot_3_rad\n"
            + "".join(f"{0.01 * i},{a * STEP},{b * STEP},{c * STEP}\n" for i, (a, b, c) in enumerate(angles)))
        log, heard = self.folder / "angles.log", self.folder / "heard.log"
        done = self.abbe("convert", recording, log, "--machine", self.machine)
        self.assertEqual(done.returncode, 0, done.stderr)
        candump = self.listen(heard)
        subprocess.run(["canplayer", "-I", log], check=True)
        time.sleep(0.5)
        candump.terminate()
        candump.wait()
        frames = [[line.split()[2] for line in path.read_text().splitlines()] for path in (log, heard)]
        self.assertEqual(len(frames[0]), 200)
        self.assertEqual(frames[0], frames[1])
        done = self.abbe("convert", heard, self.folder / "again.h5", "--machine", self.machine)
        self.assertEqual(done.returncode, 0, done.stderr)
        done = self.abbe("convert", self.folder / "again.h5", self.folder / "again.csv")
        self.assertEqual([tuple(counts_of(row)) for row in rows_of(self.folder / "again.csv")[1]], angles)

    def test_an_encoder_that_is_not_there_is_named(self):
        done = self.abbe("record", self.machine, "--seconds", 1, "-o", self.folder / "none.csv")
        self.assertEqual(done.returncode, 3)
        self.assertEqual(len(done.stderr.strip().splitlines()), 1, done.stderr)
        self.assertIn("node 1 (pivot_1_rad): no heartbeat for 5000 ms", done.stderr)
        self.assertFalse((self.folder / "none.csv").exists())


if __name__ == "__main__":
    unittest.main()
