#!/usr/bin/env python3
"""The .comp files of `abbe export --format linuxcnc` in LinuxCNC itself: its simulator loads them, moves,
and what it adds to the commands of the joints is held against the errors that NumPy computes.

    ABBE=path/to/abbe linuxcnc_test.py
"""
import contextlib
import os
import pathlib
import shutil
import socket
import subprocess
import tempfile
import time
import unittest

import numpy as np

from linuxcnc_machine import HAL, joints
from map_machine import TRAVEL, MapMachine

ABBE = os.environ["ABBE"]
PORT = 5007  # of linuxcncrsh
LIMITS = "MIN_LIMIT = -1\nMAX_LIMIT = 100\nMAX_VELOCITY = 500\nMAX_ACCELERATION = 5000\n"
INI = """[EMC]
MACHINE = abbe
VERSION = 1.1
[DISPLAY]
DISPLAY = linuxcncrsh
[TASK]
TASK = milltask
CYCLE_TIME = 0.010
[RS274NGC]
PARAMETER_FILE = sim.var
[EMCMOT]
EMCMOT = motmod
COMM_TIMEOUT = 1.0
SERVO_PERIOD = 1000000
[HAL]
HALFILE = sim.hal
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 500
DEFAULT_LINEAR_VELOCITY = 500
[EMCIO]
EMCIO = io
CYCLE_TIME = 0.100
TOOL_TABLE = tool.tbl
""" + joints(LIMITS, of_joint=lambda axis: f"COMP_FILE = m_{axis.lower()}.comp\nCOMP_FILE_TYPE = 0\n")


class Simulator(contextlib.AbstractContextManager):
    """LinuxCNC without display or real-time kernel in `folder`."""

    def __init__(self, folder):
        for name, text in (("sim.ini", INI), ("sim.hal", HAL), ("tool.tbl", "T1 P1 D1\n")):
            (folder / name).write_text(text)
        folder.chmod(0o777)  # as root it runs as somebody else
        self.environment = {**os.environ, "HOME": str(folder)}
        if os.getuid() == 0:
            self.environment["RTAPI_UID"] = "65534"
        self.folder = folder
        self.process = subprocess.Popen(["timeout", "100", "linuxcnc", "sim.ini"], cwd=folder, env=self.environment,
                                        stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL, start_new_session=True)
        self.socket = self.connect()

    def connect(self):
        for _ in range(150):
            with contextlib.suppress(OSError):
                return socket.create_connection(("127.0.0.1", PORT), timeout=5)
            time.sleep(0.2)
        debug = self.folder / "linuxcnc_debug.txt"
        raise RuntimeError("LinuxCNC did not start: " + (debug.read_text()[-500:] if debug.exists() else ""))

    def say(self, *commands):
        for command in commands:
            self.socket.sendall(command.encode() + b"\r\n")
            time.sleep(0.3)

    def pins(self, name):
        done = subprocess.run(["halcmd", "-s", "show", "pin", f"joint.*.{name}"], capture_output=True, text=True,
                              env=self.environment)
        return np.array([float(line.split()[3]) for line in done.stdout.splitlines() if line.strip()])

    def move(self, place):
        self.say("set mdi g0" + "".join(f"{axis}{value:.9f}" for axis, value in zip("xyz", place)))
        for _ in range(100):
            commanded = self.pins("pos-cmd")
            if len(commanded) == 3 and np.abs(commanded - place).max() < 1e-6:
                time.sleep(0.3)  # the correction follows at the speed of the joint
                return self.pins("motor-pos-cmd")
            time.sleep(0.1)
        raise RuntimeError(f"LinuxCNC stands at {commanded}, not at {place}")

    def __exit__(self, *_):
        with contextlib.suppress(OSError):
            self.say("shutdown")
            self.socket.close()
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            self.process.terminate()
            self.process.wait(20)


@unittest.skipUnless(shutil.which("linuxcnc"), "linuxcnc-uspace is not installed")
class LinuxcncTest(unittest.TestCase):
    def test_linuxcnc_adds_the_correction_of_the_map(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        machine = MapMachine(2, "[w X Y b Z t]", size=3.0)
        done = subprocess.run([ABBE, "export", machine.write(folder / "map.toml"), "--format", "linuxcnc", "--points",
                               "13", "--out", folder / "m.comp"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        with Simulator(folder) as simulator:
            simulator.say("hello EMC x 1", "set echo off", "set enable EMCTOO", "set estop off", "set machine on",
                          "set mode manual", "set home 0", "set home 1", "set home 2", "set mode mdi")
            for place in ((50, 20, 30), (10, 60, 5), (35, 40, 55)):  # stations of the tables
                motor = simulator.move(np.array(place, float))
                for k in range(3):
                    line = np.full(3, TRAVEL / 2)
                    line[k] = 1e-3 * place[k]
                    expected = place[k] - 1e3 * machine.signs[k] * machine.error(line)[k]
                    # halcmd prints seven digits.
                    self.assertAlmostEqual(motor[k], expected, delta=1e-5)
                self.assertGreater(np.abs(motor - place).max(), 1e-3)


if __name__ == "__main__":
    unittest.main()
