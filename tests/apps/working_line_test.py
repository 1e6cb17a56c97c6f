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

    def diagnosis_of(self, kind):
        """The command that diagnoses a campaign."""
        campaign = self.path / kind
        self.done("--machine", MACHINE, "--seed", 7, "--campaign", kind, "--reduced", "--hide",
                  "backlash:object=X:width_um=4", "--out", campaign, command="rig record")
        return [PROGRAM, "diagnose", *map(str, sorted(campaign.glob("*.h5"))), "--machine", MACHINE]

    def on_a_terminal(self, *arguments, term="xterm"):
        """Standard error on a terminal of so many columns, and the exit code."""
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, COLUMNS, 0, 0))
        command = subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=theirs,
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
        seen = self.on_a_terminal(*self.diagnosis_of("standard"))
        self.assertNotIn("\n", seen)
        lines = [line for line in seen.split("\r") if line.strip()]
        self.assertGreaterEqual(len(lines), 2, seen)
        for line in lines:
            self.assertLess(len(line), COLUMNS, line)
            self.assertRegex(line, r"^diagnose: .+, (\d+ min )?\d+ s *$")
        self.assertIn(" (step ", seen)
        times = [re.search(r", (?:(\d+) min )?(\d+) s", line) for line in lines]
        seconds = [60 * int(time[1] or 0) + int(time[2]) for time in times]
        self.assertEqual(seconds, sorted(set(seconds)))
        # In the end it is erased.
        self.assertRegex(seen, r"\r +\r$")

    def test_nothing_where_a_line_cannot_be_written_over(self):
        diagnosis = self.diagnosis_of("minimal")
        dumb, quiet = self.on_a_terminal(*diagnosis, term="dumb"), self.on_a_terminal(*diagnosis, "--quiet")
        piped = subprocess.run(diagnosis, capture_output=True, text=True, timeout=250)
        self.assertEqual(piped.returncode, 0, piped.stderr)
        for said in (dumb, quiet, piped.stderr):
            self.assertNotIn("diagnose: ", said)


if __name__ == "__main__":
    unittest.main()
