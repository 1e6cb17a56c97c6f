#!/usr/bin/env python3
"""The table of causes in the manual is the one that the program prints.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml causes_page_test.py
"""
import pathlib
import unittest

from program_case import ProgramCase

PAGE = pathlib.Path(__file__).parents[2] / "docs/causes.md"
BEGIN, END = "<!-- causes: begin -->\n", "<!-- causes: end -->"


class CausesTest(ProgramCase):
    command = "causes"

    def test_the_manual_has_the_table(self):
        page = PAGE.read_text()
        written = page[page.index(BEGIN) + len(BEGIN):page.index(END)]
        self.maxDiff = None
        self.assertEqual(written.strip(), self.done().strip(),
                         "put the output of `abbe causes` between the markers of docs/causes.md")

    def test_a_stray_argument_is_refused(self):
        self.refuse("backlash", saying=["backlash"])


if __name__ == "__main__":
    unittest.main()
