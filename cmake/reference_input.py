#!/usr/bin/env python3
"""Copies for Doxygen what the reference shows: the manual, and the headers that the package installs, their plain //
comments made Doxygen's: what stands before #pragma once becomes the page of the file, what stands before or behind a
declaration that of the declaration.

    reference_input.py SOURCE_FOLDER OUT_FOLDER
"""
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "tests/architecture"))
import headers


def escaped(text):
    """The text with what Doxygen would take for commands, tags and links made plain."""
    return re.sub(r'([\\@<>#%&"|$])', r"\\\1", text).replace("`", "'")


def paragraph(indent, lines, file=""):
    """A run of comment lines as Doxygen's; indented ones, an example or a table, stay as they are."""
    out, is_verbatim = [], False
    for line in lines:
        if line.startswith("   ") != is_verbatim and line:
            is_verbatim = not is_verbatim
            out.append("@verbatim" if is_verbatim else "@endverbatim")
        out.append(line if is_verbatim else escaped(line))
    if is_verbatim:
        out.append("@endverbatim")
    return [f"{indent}/**{f' @file {file}' if file else ''}", *(f"{indent} {line}" for line in out), f"{indent} */"]


def shown(text, name):
    out, comment = [], []
    is_page = True
    for line in text.split("\n"):
        alone = re.match(r"(\s*)//(.*)$", line)
        if alone:
            comment.append(alone)
            continue
        if comment:
            out += paragraph(comment[0][1], [each[2] for each in comment], name if is_page else "")
            comment, is_page = [], False
        behind = re.match(r'((?:[^"/]|"(?:[^"\\]|\\.)*"|/(?!/))*[;,])\s*// ?(.*)$', line)
        out.append(f"{behind[1]}  ///< {escaped(behind[2])}" if behind else line)
    return "\n".join(out)


def page(text):
    """A page of the manual without what Doxygen stumbles over: links into the page itself, code over two lines, and
    the word operator as code."""
    text = re.sub(r"\[((?:[^\[\]]|\[[^\]]*\])*)\]\(#[^)]*\)", r"\1", text)
    paragraphs = text.replace("operator`", "opera\u200btor`").split("\n\n")
    return "\n\n".join(each if "```" in each else re.sub(r"`[^`]*`", lambda code: code[0].replace("\n", " "), each)
                       for each in paragraphs)


def write(file, text):
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


if __name__ == "__main__":
    source, out = map(pathlib.Path, sys.argv[1:])
    for name in headers.installed(source):
        write(out / name, shown((source / name).read_text(), name))
    for file in (source / "README.md", *sorted((source / "docs").glob("*.md"))):
        write(out / file.relative_to(source), page(file.read_text()))
