#!/usr/bin/env python3
"""docs/python.md: its recordings are made, its examples print what they show, and it lists everything that there is.

    PYTHONPATH=build/dev/python ABBE=path/to/abbe page_test.py
"""
import doctest
import inspect
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import tempfile
import unittest

import abbe

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "python.md"


class PageTest(unittest.TestCase):
    def test_examples_print_what_they_show(self):
        folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        shutil.copytree(ROOT / "machines", folder / "machines")
        for line in re.findall(r"^abbe (rig record .*)$", PAGE.read_text(), re.M):
            subprocess.run([os.environ["ABBE"], *shlex.split(line)], cwd=folder, check=True, capture_output=True)
        before = os.getcwd()
        os.chdir(folder)
        self.addCleanup(os.chdir, before)
        # The blocks end where their fence does, not with an empty line alone.
        text = re.sub(r"^```.*$", "", PAGE.read_text(), flags=re.M)
        test = doctest.DocTestParser().get_doctest(text, {}, PAGE.name, str(PAGE), 0)
        runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
        runner.run(test)
        self.assertGreater(runner.summarize().attempted, 15)
        self.assertEqual(runner.summarize().failed, 0)

    def test_every_function_is_named(self):
        for name, thing in vars(abbe).items():
            if inspect.isroutine(thing):
                self.assertRegex(PAGE.read_text(), rf"`(abbe\.)?{name}\b")


if __name__ == "__main__":
    unittest.main()
