#!/usr/bin/env python3
"""`abbe align` before the virtual rig over Modbus, by an operator who does what it says.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml align_test.py
"""
import json
import pathlib
import re
import subprocess
import tempfile
import time
import tomllib
import unittest

from program_case import MACHINE, PROGRAM

MOVE = re.compile(r"move (\w) to ([-\d.]+) mm")
TURN = re.compile(r"turn: (\w+) ([\d.]+) turns (clockwise|counter-clockwise)")
SPEED = 20


class Operator:
    """The rig in one pipe, `abbe align` in the other."""

    def __init__(self, folder, seed, *arguments, hide=(), tilt=1500, axis="X", align=(), speed=SPEED):
        self.folder, self.axis, self.speed = folder, axis, speed
        text = pathlib.Path(MACHINE).read_text()
        text = text.replace("passes = 5", "passes = 1").replace("step_mm = 1.0", "step_mm = 20.0")
        text += f"\n[rig]\ntarget_tilt_urad = {tilt}\ngap_setting_um = 15\n"
        ready = folder / "ready"
        ready.unlink(missing_ok=True)
        rig_file = folder / "rig.toml"
        rig_file.write_text(text)
        self.rig = subprocess.Popen(
            [PROGRAM, "rig", "--machine", rig_file, "--seed", str(seed), "--port", "0", "--ready-file", ready,
             "--speed", str(speed), "--hands", *[part for effect in hide for part in ("--hide", effect)]],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while not ready.exists() or not ready.read_text().endswith("\n"):
            time.sleep(0.02)
        if axis != "X":
            self.hand(f"head {axis}")
        self.machine = folder / "machine.toml"
        own = re.sub(r"(?m)^port = .*", f"port = {ready.read_text().strip()}", text)
        # A busy computer answers late; the rig's time runs twenty times faster.
        own = re.sub(r"(?m)^max_skew_ms = .*", "max_skew_ms = 5000.0", own)
        own = re.sub(r"(?m)^stale_ms = .*", f"stale_ms = {200.0 * speed}", own)
        self.machine.write_text(own)
        self.out = folder / "out"
        self.align = self.start_align(*align)
        self.said, self.adjustments, self.at = [], 0, 0.0

    def start_align(self, *arguments):
        return subprocess.Popen(
            [PROGRAM, "align", "--axis", self.axis, "--machine", self.machine, "--out", self.out,
             "--clock-speed", str(self.speed), *arguments],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def hand(self, line):
        self.rig.stdin.write(line + "\n")
        self.rig.stdin.flush()

    def enter(self):
        self.align.stdin.write("\n")
        self.align.stdin.flush()

    def move(self, position):
        self.hand(f"move {self.axis} {position:.4f}")
        # 50 mm/s of the rig's time, and its polling of the hands.
        time.sleep(0.1 + abs(position - self.at) / 50 / self.speed)
        self.at = position

    def work(self):
        """Does what is said until it ends; the exit code."""
        goal, refused = None, False
        for line in self.align.stdout:
            self.said.append(line)
            if move := MOVE.search(line):
                if not refused and float(move[2]) != goal:
                    goal = float(move[2])
                    self.move(goal)
                refused = False
                self.enter()
            elif "shows no gap" in line:  # a third of the way back; the prompt follows
                refused, start = True, 60.0 if goal == 0.0 else 0.0
                self.move(start + 0.7 * (self.at - start))
            elif turn := TURN.search(line):
                self.hand(f"turn {turn[1]} {turn[2] if turn[3] == 'clockwise' else '-' + turn[2]}")
            elif line.startswith("then press Enter"):
                self.adjustments += 1
                time.sleep(0.1)
                self.enter()
        return self.align.wait(timeout=60)

    def close(self):
        for process in (self.align, self.rig):
            process.kill()
            process.communicate()

    def result(self):
        return json.loads((self.out / f"align_{self.axis}.json").read_text())


class AlignTest(unittest.TestCase):
    def operate(self, seed, **options):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        operator = Operator(folder, seed, **options)
        self.addCleanup(operator.close)
        return operator

    def test_three_adjustments_at_most_bring_the_travel_into_range(self):
        for seed, axis in ((1, "X"), (2, "Y"), (4, "Z")):
            operator = self.operate(seed, axis=axis, align=("--mounting", "first"))
            code = operator.work()
            said = "".join(operator.said)
            self.assertEqual(code, 0, said)
            self.assertLessEqual(operator.adjustments, 3, said)
            self.assertGreaterEqual(operator.adjustments, 1, said)
            result = operator.result()
            self.assertEqual((result["command"], result["verdict"], result["axis"]), ("align", "ready", axis))
            self.assertTrue(result["simulated"])
            for gap in result["gaps"].values():
                self.assertGreaterEqual(min(gap["first"], gap["last"]), 20e-6)
                self.assertLessEqual(max(gap["first"], gap["last"]), 180e-6)
            # The noise of the file is 20 nm, the register's step 3 nm.
            for noise in result["noise"].values():
                self.assertTrue(10e-9 < noise["white_m"] < 40e-9, noise)
            mounting = tomllib.loads((operator.out / "mounting.toml").read_text())
            self.assertEqual(mounting["id"], "first")
            self.assertAlmostEqual(mounting["aligned"][axis]["top_tilt_urad"], 1e6 * result["tilt"]["top"]["value"],
                                   delta=0.01 + 1e-3 * abs(1e6 * result["tilt"]["top"]["value"]))

    def test_a_good_set_up_stays_and_keeps_its_name(self):
        operator = self.operate(1, tilt=20, align=["--as-is", "--mounting", "first"])
        self.assertEqual(operator.work(), 0, "".join(operator.said))
        self.assertEqual(operator.adjustments, 0)
        # The folder states a mounting: nothing needs to be proved again.
        operator.align = operator.start_align()
        operator.said = []
        self.assertEqual(operator.work(), 0, "".join(operator.said))
        self.assertEqual(operator.adjustments, 0)
        self.assertEqual(tomllib.loads((operator.out / "mounting.toml").read_text())["id"], "first")
        self.assertEqual(operator.result()["mounting"], "first")
        # The sweep into that folder states it.
        sweep = subprocess.run([PROGRAM, "sweep", "--axis", "X", "--machine", operator.machine, "--out", operator.out,
                                "--clock-speed", str(SPEED)], capture_output=True, text=True, timeout=120)
        self.assertEqual(sweep.returncode, 0, sweep.stderr)
        header = "".join(line[2:] for line in (operator.out / "sweep_X.csv").open() if line.startswith("# "))
        mounting = tomllib.loads(header)["mounting"]
        self.assertEqual(mounting["id"], "first")
        self.assertAlmostEqual(mounting["aligned"]["top_tilt_urad"], 1e6 * operator.result()["tilt"]["top"]["value"],
                               delta=0.1)

    def test_wrong_wiring_is_named(self):
        for hide, name in (("channel-swap:object=probe_b+probe_c", "probe_b and probe_c are swapped"),
                           ("channel-swap:object=probe_a+probe_e", "probe_a and probe_e are swapped"),
                           ("channel-sign:object=probe_b", "the sign of probe_b is wrong"),
                           ("stuck-channel:object=probe_d:from_s=0:to_s=1e6", "probe_d does not move")):
            operator = self.operate(1, hide=[hide])
            code = operator.work()
            said = "".join(operator.said)
            self.assertEqual(code, 1, f"{hide}: {said}")
            self.assertIn(name, "; ".join(operator.result()["wiring"]), said)
            self.assertEqual(operator.result()["verdict"], "wrong wiring")
            self.assertFalse((operator.out / "mounting.toml").exists())

    def test_the_mains_are_seen(self):
        operator = self.operate(1, tilt=20, speed=2, align=["--as-is"], hide=["mains-pickup:object=probe_c:frequency_hz=50:amplitude_um=0.3"])
        code = operator.work()
        said = "".join(operator.said)
        self.assertEqual(code, 0, said)
        self.assertRegex(said, r"probe_c picks up the mains: \d+ nm at 50 Hz")
        self.assertAlmostEqual(operator.result()["noise"]["probe_c"]["mains_m"], 0.3e-6, delta=0.03e-6)

    def test_the_end_of_the_input_ends_it(self):
        operator = self.operate(1)
        said, _ = operator.align.communicate("", timeout=60)
        self.assertEqual(operator.align.returncode, 1)
        self.assertIn("not ready", said)
        self.assertEqual(operator.result()["verdict"], "stopped")


if __name__ == "__main__":
    unittest.main()
