#!/usr/bin/env python3
"""`abbe record` over lines that lie, and a recorder that is suspended: nothing bad is recorded as good, and every
good row was measured within the time that it states.

    ABBE=path/to/abbe modbus_faults_test.py
"""
import csv
import math
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from modbus_clockwork import Clockwork, RtuDevice, Spoiler, TcpDevice, mark, now

ABBE = os.environ["ABBE"]
ABBE_MACHINE = pathlib.Path(os.environ["ABBE_MACHINE"])
DEVICE = """
[devices]
rate_hz = 200.0
max_skew_ms = {max_skew_ms}
stale_ms = 1000.0
[devices.clockwork]
{way}
unit = 5
response_timeout_ms = {response_ms}
byte_timeout_ms = 50
deadline_ms = 1000
backoff_first_ms = 5
backoff_most_ms = 10
wait_ms = 0
[[devices.clockwork.block]]
function = "{function}"
address = 0
count = 2
channel = [{{ name = "n", at = 0, type = "uint16" }}, {{ name = "mark", at = 1, type = "uint16" }}]
"""
CLOCK_JUMP, DEVICE_ERROR = 16, 4


class ModbusFaults(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.out = self.folder / "out.csv"

    def machine(self, way, max_skew_ms=1000.0, response_ms=100, function="input"):
        text = ABBE_MACHINE.read_text()
        path = self.folder / "machine.toml"
        path.write_text(text[:text.index("[devices]")] + DEVICE.format(
            way=way, max_skew_ms=max_skew_ms, response_ms=response_ms, function=function))
        return path

    def tcp(self, device, **more):
        return self.machine(f'host = "127.0.0.1"\nport = {device.port}', **more)

    def record(self, machine, seconds):
        return subprocess.Popen([ABBE, "record", machine, "--seconds", str(seconds), "--out", self.out, "--quiet"],
                                stderr=subprocess.PIPE, text=True)

    def finish(self, recorder):
        err = recorder.communicate(timeout=100)[1]
        self.assertEqual(recorder.returncode, 0, err)
        with self.out.open() as file:
            rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
        return [{name: float(value) for name, value in row.items()} for row in rows]

    def check(self, rows, when=None):
        """Good rows: each number with its own mark, none twice, and all times possible at once."""
        good = [row for row in rows if row["flags"] == 0]
        for row in rows:
            self.assertEqual(math.isnan(row["n"]) or math.isnan(row["mark"]), bool(int(row["flags"]) & ~CLOCK_JUMP)
                             or math.isnan(row["n"]), row)
        for row in good:
            self.assertEqual(row["mark"], mark(int(row["n"])), row)
        numbers = [row["n"] for row in good]
        self.assertEqual(numbers, sorted(set(numbers)))
        times = [row["time_s"] for row in rows]
        self.assertEqual(times, sorted(times))
        if when:
            # The start of the recording, by the device's clock: after each of `low`, before each of `high`.
            low = max(when[int(row["n"])] - row["time_s"] - 0.0005 * row["skew_ms"] for row in good)
            high = min(when[int(row["n"])] - row["time_s"] + 0.0005 * row["skew_ms"] for row in good)
            self.assertLess(low, high + 2e-6)
        return good

    def test_spoiled_tcp_replies_are_never_good(self):
        # TCP itself keeps registers whole: what may be corrupt is all before them.
        clockwork, spoiler = Clockwork(), Spoiler(seed=3, share=0.3, corruptible=9)
        rows = self.finish(self.record(self.tcp(TcpDevice(clockwork, spoiler.spoil)), 8))
        good = self.check(rows, clockwork.when)
        self.assertGreater(min(spoiler.done.values()), 0, spoiler.done)
        self.assertGreater(len(good), 30)
        self.assertGreater(sum(int(row["flags"]) & DEVICE_ERROR != 0 for row in rows), 10)

    def test_spoiled_serial_replies_are_never_good(self):
        # Serial replies carry no number: a stale or doubled one in time cannot be told from the right one.
        clockwork, spoiler = Clockwork(), Spoiler(seed=4, share=0.3)
        spoiler.DEEDS = ("late", "dropped", "split", "corrupt", "shortened")
        device = RtuDevice(clockwork, spoiler.spoil)
        rows = self.finish(self.record(self.machine(
            f'transport = "modbus-rtu"\nserial = {{ device = "{device.name}", baud = 115200, parity = "none" }}'), 8))
        good = self.check(rows, clockwork.when)
        self.assertGreater(sum(spoiler.done.values()), 10, spoiler.done)
        self.assertGreater(len(good), 10)

    def test_a_recorder_that_is_suspended_flags_what_it_does_not_know(self):
        clockwork, draw = Clockwork(), random.Random(5)
        slow = lambda reply, send: (time.sleep(0.02 * draw.random()), send(reply))
        recorder = self.record(self.tcp(TcpDevice(clockwork, slow), max_skew_ms=60.0, response_ms=150), 16)
        time.sleep(1.0)
        for _ in range(16):
            time.sleep(0.05 + 0.1 * draw.random())
            recorder.send_signal(signal.SIGSTOP)
            time.sleep(draw.choice((0.03, 0.1, 0.3, 0.8)))
            recorder.send_signal(signal.SIGCONT)
        rows = self.finish(recorder)
        good = self.check(rows, clockwork.when)
        self.assertGreater(len(good), 20)
        self.assertLessEqual(max(row["skew_ms"] for row in good), 60.0)
        self.assertGreater(sum(int(row["flags"]) & CLOCK_JUMP != 0 for row in rows), 3)

    def test_a_device_that_is_stopped_costs_flagged_rows(self):
        device = subprocess.Popen([sys.executable, pathlib.Path(__file__).parent / "modbus_clockwork.py"],
                                  stdout=subprocess.PIPE, text=True)
        self.addCleanup(device.stdout.close)
        self.addCleanup(device.wait)
        self.addCleanup(device.kill)
        port = int(device.stdout.readline())
        recorder = self.record(self.machine(f'host = "127.0.0.1"\nport = {port}'), 6)
        time.sleep(1.5)
        device.send_signal(signal.SIGSTOP)  # its kernel still takes connections and requests
        time.sleep(2.0)
        device.send_signal(signal.SIGCONT)
        rows = self.finish(recorder)
        good = self.check(rows)
        bad = [row["time_s"] for row in rows if int(row["flags"]) & DEVICE_ERROR]
        self.assertGreater(max(bad) - min(bad), 1.0)
        self.assertGreater(max(row["time_s"] for row in good), max(bad))


    def test_kill_9_loses_at_most_the_last_second(self):
        clockwork = Clockwork()
        recorder = self.record(self.tcp(TcpDevice(clockwork)), 60)
        while clockwork.n < 300:
            self.assertIsNone(recorder.poll())
            time.sleep(0.01)
        killed = now()
        recorder.kill()
        recorder.communicate()
        lines = [line for line in self.out.read_text().splitlines(True) if not line.startswith("#")]
        kept = {int(float(row["n"])) for row in csv.DictReader(line for line in lines if line.endswith("\n"))
                if row["flags"] == "0"}
        due = {n for n, when in clockwork.when.items() if n >= min(kept) and when < killed - 1.0}
        self.assertGreater(len(due), 10)
        self.assertEqual(due - kept, set())


if __name__ == "__main__":
    unittest.main(verbosity=0)
