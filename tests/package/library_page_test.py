#!/usr/bin/env python3
"""The run of docs/library.md must bark: at a program that prints something else, and at one that fails."""
import pathlib
import tempfile
import unittest

import library_page

PAGE = "```cpp\nint main() {}\n```\n\n```\n2.37 um\n```\n"


class LibraryPageTest(unittest.TestCase):
    def wrong(self, script):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        (folder / "program_1").write_text("#!/bin/sh\n" + script)
        (folder / "program_1").chmod(0o755)
        return len(list(library_page.run(PAGE, folder, "abbe", folder)))

    def test_what_the_page_shows_passes(self):
        self.assertEqual(self.wrong("echo 2.37 um"), 0)

    def test_another_figure_is_found(self):
        self.assertEqual(self.wrong("echo 2.38 um"), 1)

    def test_a_program_that_fails_is_found(self):
        self.assertEqual(self.wrong("echo 2.37 um; exit 2"), 1)


if __name__ == "__main__":
    unittest.main()
