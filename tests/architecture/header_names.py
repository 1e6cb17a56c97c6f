#!/usr/bin/env python3
"""Holds what the headers' comments name against what there is.

    header_names.py SOURCE_FOLDER

Types and functions (CamelCase), constants (kConstant), files (folder/file.h, or file.h of the same folder) and pages
(docs/page.md) that a comment of a header names must exist; NAME stands for any. The examples are left to the compiler
(header_examples.py). Prints each that does not exist and exits with 1 when there is one.
"""
import pathlib
import re
import sys

import headers
from header_examples import examples

NAME = re.compile(r"(?<![\w:.\"'-])(?:[A-Z][a-z0-9]+(?:[A-Z]\w*)+|[A-Z][a-z]\w*(?=\()|k[A-Z]\w+)\b")
FILE = re.compile(r"[\w/.-]+\.(?:h|cpp|py|md)\b")
# Names of others, and of mathematics.
FOREIGN = {"CiA", "LinuxCNC", "MacKay", "NumPy", "OpenBLAS", "SocketCAN", "Phi", "Rx", "Ry", "Rz", "Tx", "Ty", "Tz"}


def identifiers(root):
    """Every identifier in the code of the tree, comments left out."""
    found = set()
    for folder in (*headers.ARROWS, "tests"):
        for file in (root / folder).glob("**/*"):
            if file.suffix in (".h", ".cpp") and "node_modules" not in file.parts:
                found |= set(re.findall(r"\w+", headers.code(file.read_text())))
    return found


def is_there(root, header, named):
    """Whether a file that a header names exists: from the root, or beside it in its folder."""
    inside = "/" in named or named.endswith(".md")
    return (root / named).is_file() or (not inside and any((root / header.split("/")[0]).glob("**/" + named)))


def strangers(root):
    """Yields a line for each name in a comment of a header that nothing has."""
    known = identifiers(root) | FOREIGN
    for header in headers.all_of(root):
        text = (root / header).read_text()
        compiled = {first + i for first, lines in examples(text) for i in range(len(lines))}
        for number, comment in headers.comments(text):
            if number in compiled:
                continue
            for file in FILE.findall(comment):
                if "NAME" not in file and not is_there(root, header, file):
                    yield f"{header}:{number}: there is no {file}"
            for name in NAME.findall(FILE.sub("", comment)):
                if "NAME" not in name and name not in known:
                    yield f"{header}:{number}: nothing is called {name}"


if __name__ == "__main__":
    found = list(strangers(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "what the headers' comments name exists")
    sys.exit(1 if found else 0)
