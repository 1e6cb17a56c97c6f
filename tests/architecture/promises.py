#!/usr/bin/env python3
"""Holds docs/promises.md against the tests: every test and every file that the page names must exist.

    promises.py SOURCE_FOLDER

The last cell of a row names the tests, one claim after the other with semicolons between: `Suite.Name` with its file
below tests/, `NAME.program` with the functions of its file, `report.page` with the titles of its tests,
`fuzz.unit.NAME` with its target. Prints each that does not exist and exits with 1 when there is one.
"""
import pathlib
import re
import sys

PAGE = "docs/promises.md"
MACRO = re.compile(r"\b(?:TEST|TEST_F|TEST_P|TYPED_TEST|RC_GTEST_PROP|RC_GTEST_FIXTURE_PROP)\(\s*(\w+),\s*(\w+)")
FUNCTION = re.compile(r"\b[a-z]\w*_\w+\b")
FILE = re.compile(r"\(([\w./-]+\.\w+)\)")
TICKED = re.compile(r"`([^`]+)`")


class Tests:
    """What the folder tests/ and the fuzzing targets have."""

    def __init__(self, root):
        self.root = root
        self.of_file = {}
        for file in (root / "tests").glob("**/*.cpp"):
            found = {f"{suite}.{name}" for suite, name in MACRO.findall(file.read_text())}
            self.of_file[file.relative_to(root / "tests").as_posix()] = found
        self.all = set().union(*self.of_file.values())
        self.suites = {name.split(".")[0] for name in self.all}
        self.registered = "\n".join(file.read_text() for file in (root / "tests").glob("**/CMakeLists.txt"))

    def file(self, name):
        return next((file for file in (self.root / "tests" / name, self.root / name) if file.exists()), None)

    def is_registered(self, name):
        first, kind = name.split(".", 1)
        ways = [f"NAME {re.escape(name)}"]
        if kind in ("program", "Guest"):
            ways.append(rf"{kind.lower()}_test\({first}")
        if first == "architecture":
            ways.append(rf"foreach\(check [\w ]*\b{kind}")
        return re.search(rf"\b(?:{'|'.join(ways)})\b", self.registered) is not None


def wrong_of_unit(name, file, tests):
    """Of a test in C++ that stands in `file` (or anywhere)."""
    known = tests.all if file is None else tests.of_file.get(file, set())
    if "." not in name:
        known = {each.split(".")[0] for each in known}
    if name not in known:
        yield f"there is no test {name}" + (f" in {file}" if file else "")


def wrong_of_program(names, text, file, tests):
    """Of tests by a script; `text` has the names of its functions."""
    for name in names:
        script = tests.file(file or f"apps/{name.split('.')[0]}_test.py")
        if not tests.is_registered(name):
            yield f"ctest knows no {name}"
        if script is None:
            yield f"{name} has no script"
            continue
        for function in FUNCTION.findall(text):
            if f"def test_{function}(" not in script.read_text():
                yield f"{script.name} has no test_{function}"


def wrong_of_page(text, file, tests):
    """Of a test of the report by a browser; `text` is its title."""
    script = tests.file(file or "report/page.test.mjs")
    title = " ".join(text.split())
    if script is None or not re.search(rf"[\"'`]{re.escape(title)}", script.read_text()):
        yield f"report.page has no test \"{title}\""


def wrong_of_claim(claim, tests):
    file = next(iter(FILE.findall(claim)), None)
    if file is not None and tests.file(file) is None:
        yield f"there is no file {file}"
        return
    ticked = TICKED.findall(claim)
    text = FILE.sub("", TICKED.sub(" ", claim))
    scripts = [name for name in ticked if re.fullmatch(r"[a-z]\w*\.(program|Guest|pdf)", name)]
    yield from wrong_of_program(scripts, text, file, tests)
    if not scripts and not ticked and FUNCTION.search(text):
        yield f"{FUNCTION.search(text)[0]} has no program before it"
    for name in ticked:
        if name in scripts:
            continue
        if name.startswith("fuzz."):
            target = name.split(".")[2]
            if target != "TARGET" and not (tests.root / "fuzz" / f"{target}.cpp").is_file():
                yield f"there is no fuzzing target {target}"
        elif name == "report.page":
            yield from wrong_of_page(text, file, tests)
        elif "/" in name:
            if tests.file(name) is None:
                yield f"there is no {name}"
        elif name[0].isupper():
            yield from wrong_of_unit(name, file, tests)
        elif not tests.is_registered(name):
            yield f"ctest knows no {name}"


def complaints(root):
    """Yields a line for each name of the page that nothing has."""
    tests = Tests(root)
    for number, line in enumerate((root / PAGE).read_text().split("\n"), 1):
        cells = [cell.strip() for cell in line.split(" | ")]
        if not line.startswith("| ") or len(cells) != 4 or cells[0] == "| promise":
            continue
        for claim in cells[3].removesuffix("|").split("; "):
            for wrong in wrong_of_claim(claim, tests):
                yield f"{PAGE}:{number}: {wrong}"
        for name in TICKED.findall(" ".join(cells[:3])):
            if re.fullmatch(r"(fuzz|tests)/[\w/]+", name) and not (root / name).exists():
                yield f"{PAGE}:{number}: there is no {name}"


if __name__ == "__main__":
    found = list(complaints(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "what the promises name exists")
    sys.exit(1 if found else 0)
