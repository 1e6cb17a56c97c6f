#!/usr/bin/env python3
"""The sign of life of a long command: a line that moves on a terminal, and nothing in files and pipes.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml working_line_test.py
"""
import fcntl
import os
import pty
import re
import struct
import subprocess
import termios
import unittest

from program_case import MACHINE, PROGRAM, ProgramCase

COLUMNS = 50


class WorkingLineTest(ProgramCase):
    command = "diagnose"

    def setUp(self):
        super().setUp()
        campaign = self.path / "campaign"
        self.done("--machine", MACHINE, "--seed", 7, "--campaign", "standard", "--reduced", "--hide",
                  "backlash:object=X:width_um=4", "--out", campaign, command="rig record")
        self.arguments = [PROGRAM, "diagnose", *map(str, sorted(campaign.glob("*.h5"))), "--machine", MACHINE]

    def on_a_terminal(self, *more, term="xterm"):
        """Standard error on a terminal of so many columns, and the exit code."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
        command = subprocess.Popen([*self.arguments, *more], stdout=subprocess.DEVNULL, stderr=theirs,
                                   env={**os.environ, "TERM": term})
        os.close(theirs)
        seen = b""
        while True:
            try:
                piece = os.read(ours, 4096)
            except OSError:  # the other end is closed
                break
            if not piece:
                break
            seen += piece
        os.close(ours)
        self.assertEqual(command.wait(timeout=250), 0, seen)
        return seen.decode()

    def test_a_line_moves_on_a_terminal(self):
        seen = self.on_a_terminal()
        self.assertNotIn("\n", seen)
        lines = [line for line in seen.split("\r") if line.strip()]
        self.assertGreaterEqual(len(lines), 2, seen)
        for line in lines:
            self.assertLess(len(line), COLUMNS, line)
            self.assertRegex(line, r"^diagnose: .+, \d+ s *$")
        self.assertIn(" (step ", seen)
        seconds = [int(re.search(r", (\d+) s", line)[1]) for line in lines]
        self.assertEqual(seconds, sorted(set(seconds)))
        # In the end it is erased.
        self.assertRegex(seen, r"\r +\r$")

    def test_nothing_where_a_line_cannot_be_written_over(self):
        self.assertEqual(self.on_a_terminal(term="dumb"), "")
        self.assertEqual(self.on_a_terminal("--quiet"), "")
        piped = subprocess.run(self.arguments, capture_output=True, text=True, timeout=250)
        self.assertEqual((piped.returncode, piped.stderr), (0, ""))


if __name__ == "__main__":
    unittest.main()
