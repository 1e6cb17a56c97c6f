#!/usr/bin/env python3
"""The table of what makes learned terms in the manual is the one that the program prints.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml learned_page_test.py
"""
import pathlib
import unittest

from program_case import ProgramCase

PAGE = pathlib.Path(__file__).parents[2] / "docs/learned.md"
BEGIN, END = "<!-- makers: begin -->\n", "<!-- makers: end -->"


class LearnedPageTest(ProgramCase):
    command = "learned"

    def test_the_manual_has_the_table(self):
        page = PAGE.read_text()
        written = page[page.index(BEGIN) + len(BEGIN):page.index(END)]
        self.maxDiff = None
        self.assertEqual(written.strip(), self.done().strip(),
                         "put the output of `abbe learned` between the markers of docs/learned.md")

    def test_a_stray_argument_is_refused(self):
        self.refuse("backlash", saying=["backlash"])


if __name__ == "__main__":
    unittest.main()
