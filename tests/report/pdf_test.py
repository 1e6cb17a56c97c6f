#!/usr/bin/env python3
"""`abbe report --pdf`: a page printed by Chromium, where headings stand with their figures, and the refusal without a
browser.

    ABBE=path/to/abbe ABBE_MACHINE=machine.toml pdf_test.py
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ABBE, MACHINE = os.environ["ABBE"], os.environ["ABBE_MACHINE"]
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
# A heading, and what stands in the first figure below it.
TOGETHER = (("Slices of the map", "Error, XY"), ("The 21 errors", "Positioning EXX"), ("Error motions", "Roll EAX"),
            ("Uncertainty budget", "Shares of the variance"), ("Residuals and noise", "Residual of each dwell"))
SKIPPED = 77


class PrintedReport(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory()))
        cls.out = cls.folder / "a report"  # a name with a blank
        abbe = lambda *words: subprocess.run([ABBE, *map(str, words)], cwd=cls.folder, check=True, capture_output=True)
        record = ("rig", "record", "--machine", MACHINE, "--seed", 7)
        abbe(*record, "--plate", "--out", "plate.csv")
        abbe(*record, "--axis", "X", "--rate", 50, "--out", "sweep_X.csv")
        abbe("reduce", "sweep_X.csv", "--machine", MACHINE, "--out", cls.out, "--quiet")
        abbe("plate", "plate.csv", "--machine", MACHINE, "-o", "map.toml", "--json", cls.out / "plate.json", "--quiet")

    def report(self, *words, **environment):
        return subprocess.run([ABBE, "report", self.out, *words], capture_output=True, text=True, timeout=200,
                              env={**os.environ, **environment})

    def test_headings_stand_with_their_figures(self):
        pdf = self.folder / "report.pdf"
        done = self.report("--pdf", pdf)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stdout.splitlines(), [str(self.out / "report.html"), str(pdf)])
        text = subprocess.run(["pdftotext", "-layout", pdf, "-"], capture_output=True, text=True, check=True).stdout
        pages = [" ".join(page.split()) for page in text.split("\f")]
        self.assertIn("demo-mill", pages[0])
        for heading, figure in TOGETHER:
            on = [page for page in pages if heading in page]
            self.assertTrue(on, heading)
            self.assertTrue(any(figure in page for page in on), f"{heading} stands without its figure")
        # A4, and nothing of the browser's own in the margins.
        size = subprocess.run(["pdfinfo", pdf], capture_output=True, text=True, check=True).stdout
        self.assertIn("A4", size)
        self.assertNotIn("file://", text)

    def test_without_a_browser_it_says_so(self):
        pdf = self.folder / "none.pdf"
        done = self.report("--pdf", pdf, PATH="/nowhere")
        self.assertEqual(done.returncode, 2)
        self.assertIn("apt-get install chromium", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1)
        self.assertFalse(pdf.exists())


if __name__ == "__main__":
    if not any(map(shutil.which, BROWSERS)) or not shutil.which("pdftotext"):
        print("SKIPPED: no Chromium or no pdftotext: apt-get install chromium poppler-utils")
        sys.exit(SKIPPED)
    unittest.main()
