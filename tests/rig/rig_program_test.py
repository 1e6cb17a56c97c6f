#!/usr/bin/env python3
"""abbe rig as a program, read and started by pymodbus: rig_program_test.py ABBE MACHINE_FILE."""
import json
import math
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest

from pymodbus.client import ModbusTcpClient

ABBE, MACHINE = sys.argv[1:3]


class RigProgram(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.path = pathlib.Path(self.folder.name)
        self.addCleanup(self.folder.cleanup)

    def run_abbe(self, *arguments):
        return subprocess.run([ABBE, "rig", *map(str, arguments)], capture_output=True, text=True, timeout=60)

    def serve(self, *arguments):
        ready = self.path / "port"
        rig = subprocess.Popen([ABBE, "rig", "--machine", MACHINE, "--port", "0", "--ready-file", ready,
                                *map(str, arguments)], stdout=subprocess.PIPE, text=True)
        self.addCleanup(rig.stdout.close)
        self.addCleanup(rig.kill)
        while not ready.exists():
            self.assertIsNone(rig.poll(), "the rig ended before it was ready")
            time.sleep(0.02)
        client = ModbusTcpClient("127.0.0.1", port=int(ready.read_text()))
        self.assertTrue(client.connect())
        self.addCleanup(client.close)
        return rig, client

    def test_serves_sweeps_and_ends_cleanly(self):
        truth = self.path / "truth.json"
        rig, client = self.serve("--seed", 5, "--speed", 20, "--truth", truth)
        gaps = client.read_input_registers(0, 5, slave=1).registers
        self.assertTrue(all(0 < gap < 65535 for gap in gaps), gaps)
        self.assertEqual(client.read_holding_registers(100, 2, slave=2).registers, [0, 0])
        self.assertFalse(client.write_register(100, 2, slave=2).isError())
        self.assertEqual(client.read_holding_registers(100, 2, slave=2).registers, [2, 1])
        self.assertEqual(client.write_register(100, 1, slave=2).exception_code, 6)
        rig.send_signal(signal.SIGTERM)
        self.assertEqual(rig.wait(10), 0)
        said = rig.stdout.read()
        self.assertIn("listening on 127.0.0.1 port", said)
        self.assertIn("unit 1 input registers 0 to 4 (head)", said)
        self.assertEqual(json.loads(truth.read_text())["seed"], 5)

    def test_what_is_recorded_from_it_says_so(self):
        _, client = self.serve("--seed", 5)
        machine = self.path / "mill.toml"
        port = client.params.port
        machine.write_text(re.sub(r"(?m)^port = .*", f"port = {port}", pathlib.Path(MACHINE).read_text()))
        out = self.path / "live.csv"
        done = subprocess.run([ABBE, "record", machine, "--devices", "head,machine", "--seconds", "0.5", "--out", out],
                              capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        header = [line for line in out.read_text().splitlines() if line.startswith("#")]
        self.assertIn("# simulated = true", header)
        self.assertTrue(any(line.startswith('# "head" = "modbus, abbe virtual rig (simulated): probe_a_um')
                            for line in header), header)

    def test_records_directly(self):
        out = self.path / "x.csv"
        done = self.run_abbe("record", "--machine", MACHINE, "--axis", "X", "--rate", 10, "--out", out)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue(out.read_text().startswith('# abbe-recording = 1\n# kind = "sweep"\n'))

    def test_hides_what_only_the_truth_says(self):
        plain, hidden, truth = self.path / "plain.csv", self.path / "hidden.csv", self.path / "truth.json"
        arguments = ["record", "--machine", MACHINE, "--axis", "X", "--rate", 5]
        self.assertEqual(self.run_abbe(*arguments, "--out", plain).returncode, 0)
        done = self.run_abbe(*arguments, "--out", hidden, "--truth", truth, "--hide",
                             "warm-up-drift:object=probe_b:amplitude_um=2:time_constant_s=100")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(json.loads(truth.read_text())["hidden"],
                         [{"cause": "warm-up-drift", "object": "probe_b",
                           "parameters": {"amplitude_um": 2.0, "time_constant_s": 100.0}}])
        def last(path):
            lines = path.read_text().splitlines()
            names = next(line for line in lines if not line.startswith("#")).split(",")
            return dict(zip(names, map(float, lines[-1].split(","))))
        before, after = last(plain), last(hidden)
        self.assertAlmostEqual(after["probe_b_um"] - before["probe_b_um"],
                               2 * (1 - math.exp(-before["time_s"] / 100)), places=6)
        self.assertEqual(after["probe_a_um"], before["probe_a_um"])

    def test_writes_a_campaign_with_its_truth(self):
        out, truth = self.path / "campaign", self.path / "truth.json"
        done = self.run_abbe("record", "--machine", MACHINE, "--campaign", "minimal", "--reduced", "--out", out,
                             "--hide", "outliers:object=pivot_1:count=4", "--truth", truth)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(sorted(path.name for path in out.iterdir()),
                         ["01_sweep_X.h5", "02_sweep_Y.h5", "03_sweep_Z.h5", "04_circle_XY_20mm_600.h5"])
        self.assertEqual(json.loads(truth.read_text())["hidden"][0]["parameters"], {"count": 4.0})

    def test_refuses_in_one_line(self):
        truth = self.path / "truth.json"
        truth.write_text("{}")
        for arguments in ([], ["--machine", "nowhere.toml"], ["compare", truth, truth],
                          ["--machine", MACHINE, "--rtu", "head"],
                          ["--machine", MACHINE, "--hide", "backlsh:object=X"],
                          ["record", "--machine", MACHINE, "--out", "x", "--axis", "X", "--hide", "backlash"]):
            done = self.run_abbe(*arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
