#!/usr/bin/env python3
"""The programs of docs/library.md, and whether they print what the page shows.

    library_page.py write PAGE FOLDER              writes them as FOLDER/program_1.cpp, program_2.cpp, ...
    library_page.py run PAGE PROGRAMS ABBE FOLDER  makes the page's recordings in FOLDER with the program ABBE, then runs
                                                   PROGRAMS/program_1, ... there; exits with 1 when one prints other lines
"""
import pathlib
import re
import shlex
import subprocess
import sys

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```\n", re.M | re.S)


def programs(page):
    """[(program, what it prints)] of a page: each block of C++ and the block after it."""
    blocks = BLOCK.findall(page)
    return [(text, after[1]) for (language, text), after in zip(blocks, blocks[1:]) if language == "cpp"]


def commands(page):
    """The command lines of the page that call abbe."""
    return [line for language, text in BLOCK.findall(page) if not language
            for line in text.split("\n") if line.startswith("abbe ")]


def printed(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else f"exit code {done.returncode}: {done.stdout}{done.stderr}\n"


def run(page, folder, abbe, built):
    """Yields a line for each program that prints something else than the page shows."""
    for command in commands(page):
        printed([abbe, *shlex.split(command)[1:], "--force"], folder)
    for number, (_, shown) in enumerate(programs(page), 1):
        got = printed([built / f"program_{number}"], folder)
        if got != shown:
            yield f"program {number} of the page prints\n{got}and the page shows\n{shown}"


if __name__ == "__main__":
    page = pathlib.Path(sys.argv[2]).read_text()
    if sys.argv[1] == "write":
        for number, (text, _) in enumerate(programs(page), 1):
            pathlib.Path(sys.argv[3], f"program_{number}.cpp").write_text(text)
        sys.exit(0 if programs(page) else "the page shows no program")
    built, abbe, folder = map(pathlib.Path, sys.argv[3:6])
    wrong = list(run(page, folder, abbe.resolve(), built.resolve()))
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)
