#!/usr/bin/env python3
"""Holds the table of the header of docs/recordings.md against the readers: the page has every key that they ask for,
with the number that holds where it is absent (0, which is nothing, may be unsaid), and every key of the page is in
the code.

    recording_keys.py SOURCE_FOLDER

Prints each that is missing and exits with 1 when there is one.
"""
import pathlib
import re
import sys

import headers

PAGE = "docs/recordings.md"
ASKED = re.compile(r"\bHeader(?:Text|Numbers?)\(\s*(\"[\w.]+\"|k\w+)[^;]*?\)(?:\s*\.value_or\(([\w.]+)\))?")
CONSTANT = re.compile(r"\bconstexpr (?:const char\*(?: const)?|double|std::string_view) (k\w+) = (\"[\w.]+\"|[\d.e-]+)")
# Asked for, and no key of a recording's own: the table that setup.N.tool_mm stands in, and one that files of old have.
TABLES = {"setup", "mounting", "rig"}


def asked(root):
    """Yields (file, key, number that holds without it or None) of every call of a reader."""
    for folder in headers.ARROWS:
        for file in sorted((root / folder).glob("**/*.cpp")):
            text = file.read_text()
            constants = dict(CONSTANT.findall(text))
            for key, number in ASKED.findall(text):
                key = constants.get(key, key)
                if key.startswith('"'):
                    number = constants.get(number, number)
                    yield file.relative_to(root), key.strip('"'), number if re.match(r"[\d.]", number) else None


def rows(root):
    """Of the page: key -> the text of its row."""
    found = {}
    text = (root / PAGE).read_text().split("## The header")[1].split("\n## ")[0]
    for line in text.split("\n"):
        if line.startswith("| `"):
            keys, _, meaning = line.strip("| ").partition(" | ")
            for key in re.findall(r"`([\w.]+)`", keys):
                found[key] = meaning
    return found


def says(row, number):
    """Whether a row of the page has a number of its own."""
    return re.search(rf"(?<![\d.]){re.escape(f'{number:g}')}(?![\d.])", row) is not None


def complaints(root):
    page = rows(root)
    for file, key, number in asked(root):
        if key in TABLES:
            continue
        if key not in page:
            yield f"{PAGE} lacks `{key}`, which {file} asks for"
        elif number is not None and float(number) != 0.0 and not says(page[key], float(number)):
            yield f"{PAGE}: `{key}` is {float(number):g} where it is absent ({file}), and the page does not say so"
    code = "\n".join(file.read_text() for folder in headers.ARROWS for file in (root / folder).glob("**/*.cpp"))
    for key in page:
        last = key.split(".")[-1]
        if last not in ("NAME", "N") and not re.search(rf"[\"\\n\s.{{]{last}[\"\s]", code):
            yield f"{PAGE}: `{key}` is nowhere in the code"


if __name__ == "__main__":
    found = list(complaints(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "the keys of a recording's header are those of the page")
    sys.exit(1 if found else 0)
