#!/usr/bin/env python3
"""Writes the examples of the headers' comments as one C++ source, so that a compiler reads them.

    header_examples.py SOURCE_FOLDER OUT.cpp

An example is an indented paragraph of a comment in which a statement ends:

    //   const Corrector corrector(map, p_TQ);
    //   const Eigen::Vector3d command = corrector.Command(wanted);

Each becomes a function in the namespace of its folder; classes, templates and functions that it defines stand
beside it. What it takes for granted (here map, p_TQ, wanted) is declared in example_names.toml, as the
parameters of that function. Headers that the table lists under `skipped` wait for their examples to be mended.
The headers of all folders are included.
"""
import pathlib
import re
import sys
import tomllib

import headers

TABLE = pathlib.Path(__file__).with_name("example_names.toml")
DEFINITION = re.compile(r"(template|class|struct|enum)\b|[\w:]+ \w+\(.*\) \{")


def examples(text):
    """Yields (line number, lines of code) of each example in the comments of a header."""
    for number, paragraph in headers.paragraphs(text):
        code = [re.match(r"   ?(.*)", line) for line in paragraph]
        if all(code) and any(re.search(r";(\s*//.*)?$", line) for line in paragraph):
            yield number, [match[1] for match in code]


def parts(lines):
    """Splits an example into the lines that define something at namespace scope and the statements."""
    definitions, statements = [], []
    goes_on = False
    for line in lines:
        goes_on = goes_on or bool(DEFINITION.match(line))
        (definitions if goes_on else statements).append(line)
        goes_on = goes_on and not line.startswith("}") and not (line[0] != " " and line.endswith("}"))
    return definitions, statements


def source(root, table):
    """The C++ source of all examples below `root`, and how many there are."""
    names = [name for name in headers.all_of(root) if not name.startswith("python/")]  # those need pybind11
    defined, stated = [f'#include "{name}"' for name in names], []
    count = 0
    for name in names:
        if name in table.get("skipped", []):
            continue
        folder, file = name.split("/", 1)
        for number, lines in examples((root / name).read_text()):
            count += 1
            definitions, statements = parts(lines)
            place = f'#line {number} "{root / name}"'
            inside = f"namespace abbe::{folder}::examples {{"
            if definitions:
                defined += [inside, place, *definitions, "}"]
            if statements:
                head = f"void Example{count}({table.get(folder, {}).get(file, '')}) {{"
                stated += [inside, head, place, *statements, "}", "}"]
    return "\n".join(defined + stated) + "\n", count


if __name__ == "__main__":
    text, count = source(pathlib.Path(sys.argv[1]), tomllib.loads(TABLE.read_text()))
    out = pathlib.Path(sys.argv[2])
    if not out.exists() or out.read_text() != text:  # else nothing has to be compiled again
        out.write_text(text)
    print(f"{count} examples")
