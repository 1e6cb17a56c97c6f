#!/usr/bin/env python3
"""The site of the manual: complete, searchable, closed to the network, and refused where a link leads nowhere.

    site_test.py path/to/abbe
"""
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "docs/site"))
sys.dont_write_bytecode = True
import build_site

PROGRAM = pathlib.Path(sys.argv.pop())


def build(out, *options):
    return subprocess.run([sys.executable, "-B", ROOT / "docs/site/build_site.py", "--abbe", PROGRAM, "--out", out,
                           *options], capture_output=True, text=True, check=False)


class SiteTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.site = pathlib.Path(cls.folder.name) / "site"
        reference = pathlib.Path(cls.folder.name) / "reference"
        reference.mkdir()
        (reference / "index.html").write_text("<title>headers</title>")
        done = build(cls.site, "--reference", reference)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_has_every_page(self):
        for page in (ROOT / "docs").glob("*.md"):
            name = "index" if page.stem == "README" else page.stem
            self.assertTrue((self.site / f"{name}.html").exists(), name)
        self.assertTrue((self.site / "reference/index.html").exists())

    def test_menu_names_every_page(self):
        listed = {page for _, links in build_site.sections() for _, page in links}
        self.assertEqual({page.name for page in (ROOT / "docs").glob("*.md")} - {"README.md"}, listed)

    def test_shows_each_cause(self):
        text = subprocess.run([PROGRAM, "causes"], capture_output=True, text=True, check=True).stdout
        names = set(re.findall(r"^\| `([\w-]+)` \|", text, re.M))
        self.assertGreater(len(names), 40)
        overview = (self.site / "causes.html").read_text()
        for name in names:
            self.assertIn(f"causes/{name}.html", overview)
            self.assertTrue((self.site / f"causes/{name}.html").exists(), name)
        hidden = set(build_site.objects()) & names
        self.assertGreater(len(hidden), 25)
        for name in hidden:
            points = xml.parse(self.site / f"causes/{name}.svg").iter("{http://www.w3.org/2000/svg}use")
            self.assertGreater(len(list(points)), 10, name)

    def test_finds_words(self):
        index = json.loads((self.site / "search/search_index.json").read_text())
        found = {page["location"] for page in index["docs"] if "lost motion" in page["text"].lower()}
        self.assertIn("glossary.html", " ".join(found))

    def test_every_page_can_search_as_a_file(self):
        for page in (self.site / "index.html", self.site / "causes/backlash.html"):
            (base,) = re.findall(r'<script src="([./]*)search/search_of_files.js" data-base="\1">', page.read_text())
            self.assertTrue((page.parent / base / "search/search_index.js").exists())

    @unittest.skipUnless(shutil.which("chromium"), "needs chromium")
    def test_a_browser_finds_words_in_files(self):
        with tempfile.TemporaryDirectory() as profile:
            shown = subprocess.run(
                ["chromium", "--headless", "--no-sandbox", "--disable-gpu", f"--user-data-dir={profile}",
                 "--virtual-time-budget=20000", "--dump-dom", f"{self.site.as_uri()}/index.html?q=lost+motion"],
                capture_output=True, text=True, check=False, timeout=120).stdout
        self.assertRegex(shown, r"\d+ matching documents")
        self.assertRegex(shown, r'href="[^"]*glossary\.html\?h=lost\+motion')

    def test_loads_nothing_from_the_network(self):
        for page in self.site.rglob("*.html"):
            loaded = re.findall(r"<(?:script|img|link)[^>]*(?:src|href)=\"(https?:[^\"]*)\"", page.read_text())
            self.assertEqual(loaded, [], page.name)

    def test_refuses_a_link_that_leads_nowhere(self):
        with tempfile.TemporaryDirectory() as folder:
            pages = pathlib.Path(folder) / "pages"
            pages.mkdir()
            (pages / "README.md").write_text("[nowhere](nowhere.md)")
            error = build_site.build(pages, pathlib.Path(folder) / "site", {"nav": [{"The manual": "README.md"}]})
            self.assertIn("nowhere.md", error)


if __name__ == "__main__":
    unittest.main()
