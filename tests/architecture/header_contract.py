#!/usr/bin/env python3
"""Counts how many public headers keep the contract of CONTRIBUTING.md, and holds the figures recorded there.

    header_contract.py SOURCE_FOLDER

A header keeps a part when its comment has a paragraph or a sentence that says so: "Units: m, rad." A function has a
line of its own when a comment stands above its declaration, a template line between or not, or behind it. Prints the
figures and exits with 1 when one is below the recorded one.
"""
import pathlib
import re
import sys

import headers

PARTS = {"frames": "Frames?", "units": "Units?", "shapes": "Shapes?", "failure": "Failures?", "source": "Sources?",
         "validity": "Validity"}


def parts_of(text):
    """Which parts of the contract the comment of a header has."""
    comment = "\n".join(line for _, line in headers.comments(text.split("#pragma once")[0]))
    return {part for part, word in PARTS.items() if re.search(rf"\b{word}\b[^.:]{{0,30}}:", comment)}


def functions(text):
    """Yields (name, whether a comment stands by it) of each public function that a header declares."""
    lines = text.split("#pragma once")[-1].split("\n")
    public = {}
    for number, line in enumerate(lines):
        opened = re.match(r"( *)(class|struct) \w+.*\{$", line)
        if opened:
            public[len(opened[1]) + 2] = opened[2] == "struct"
        label = re.match(r"( *) (public|private|protected):", line)
        if label:
            public[len(label[1]) + 2] = label[2] == "public"
        match = re.match(r"( *)(?!explicit|return|using|if|for|while|static_assert|throw|else|friend)[A-Za-z][\w:<>,&* \[\]]*?[ &*]([A-Z]\w+)\(",
                         line)
        if match and public.get(len(match[1]), len(match[1]) == 0) and "=" not in line[:match.end()]:
            declaration = []
            for following in lines[number:]:
                declaration.append(following)
                if re.search(r"[;{]\s*(//.*)?$", following) or "}" in following:
                    break
            first = number
            while lines[first - 1].strip().startswith("template"):
                first -= 1
            above = lines[first - 1].strip()
            yield match[2], above.startswith("//") or any("//" in each for each in declaration)


def figures(root):
    """Share of the public headers, in per cent, that have each part, and of the functions that have a line."""
    texts = [(root / name).read_text() for name in headers.installed(root)]
    found = [parts_of(text) for text in texts]
    result = {part: 100 * sum(part in each for each in found) // max(1, len(texts)) for part in PARTS}
    told = [by_it for text in texts for _, by_it in functions(text)]
    result["function"] = 100 * sum(told) // max(1, len(told))
    return result


def recorded(text):
    """The figures of the table in CONTRIBUTING.md: lines like "| units | 48 |"."""
    return {part: int(figure) for part, figure in re.findall(r"^\| (\w+) \| .*?(\d+) % \|$", text, re.M)}


def shortfalls(found, wanted):
    """Yields a line for each figure that fell, or that nobody recorded."""
    for part, figure in found.items():
        if part not in wanted:
            yield f"{part}: CONTRIBUTING.md records no figure"
        elif figure < wanted[part]:
            yield f"{part}: {figure} %, recorded {wanted[part]} %"


if __name__ == "__main__":
    root = pathlib.Path(sys.argv[1])
    found = figures(root)
    print("  ".join(f"{part} {figure} %" for part, figure in found.items()))
    below = list(shortfalls(found, recorded((root / "CONTRIBUTING.md").read_text())))
    print("\n".join(below))
    sys.exit(1 if below else 0)
