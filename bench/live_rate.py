#!/usr/bin/env python3
"""Eight channels at 1 kHz, recorded with the live page and two browsers, and without: is a row lost, in the file or on
the page, and what does the page cost?

    live_rate.py PROGRAM [SECONDS]

Exit status 1 when a row is missing on a page, or the page took more than 5 % of a core.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import threading
import urllib.request

PROGRAM = sys.argv[1]
SECONDS = float(sys.argv[2]) if len(sys.argv) > 2 else 180.0


class Browser(threading.Thread):
    """Counts the rows of the events, and their bytes."""

    def __init__(self, url):
        super().__init__()
        self.url, self.rows, self.bytes = url, 0, 0
        self.start()

    def run(self):
        name = None
        with urllib.request.urlopen(self.url + "events") as events:
            for line in events:
                self.bytes += len(line)
                if line.startswith(b"event: "):
                    name = line[7:].strip()
                elif line.startswith(b"data: ") and name == b"rows":
                    self.rows += json.loads(line[6:])["n"]
                elif line.startswith(b"data: ") and name == b"end":
                    return


def run(folder, mode):
    path = pathlib.Path(folder) / f"{mode}.csv"
    process = subprocess.Popen([PROGRAM, path, str(SECONDS), mode], stdout=subprocess.PIPE, text=True)
    browsers = []
    if mode == "page":
        url = process.stdout.readline().strip()
        browsers = [Browser(url), Browser(url)]
    numbers = [float(word) for word in process.stdout.read().split()]
    process.wait()
    for browser in browsers:
        browser.join(10)
    names = ("rows", "flagged", "seconds", "cpu", "memory", "longest", "published", "from_file")
    found = dict(zip(names, numbers))
    with open(path) as file:
        found["in_file"] = sum(line[0].isdigit() for line in file)
    return found, browsers


with tempfile.TemporaryDirectory() as folder:
    alone, _ = run(folder, "alone")
    page, browsers = run(folder, "page")
# By the row: a busy computer reaches less than 1 kHz, and not the same twice.
share = 1000.0 * (page["cpu"] / page["rows"] - alone["cpu"] / alone["rows"])
print("| | alone | with the page, two browsers |\n|---|---|---|")
for name, key, form in (("rows recorded", "rows", ".0f"), ("rows in the file", "in_file", ".0f"),
                        ("processor time for one row, us", "each", ".1f"), ("longest time for one row, ms", "longest", ".2f"),
                        ("memory, MB", "memory", ".1f")):
    for found in (alone, page):
        found["each"] = 1e6 * found["cpu"] / found["rows"]
    print(f"| {name} | {alone[key]:{form}} | {page[key]:{form}} |")
print(f"| rows on the pages | | {browsers[0].rows}, {browsers[1].rows} |")
print(f"| of them from the file | | {page['from_file']:.0f} |")
rate = browsers[0].bytes / page["seconds"]
print(f"At 1 kHz the page takes {share:.2%} of a core; its events are {rate * 3600 / 1e6:.1f} MB an hour.")
whole = all(browser.rows == page["rows"] for browser in browsers) and page["rows"] == page["in_file"]
sys.exit(0 if whole and share < 0.05 else 1)
