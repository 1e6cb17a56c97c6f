#!/usr/bin/env python3
"""Holds what each header uses against what it includes: alone, it must know every name of abbe that it uses.

    header_includes.py SOURCE_FOLDER

A unity build compiles a folder's sources together, and hides an include that a header lacks. To compile each header
alone takes minutes; this takes seconds and reads names only: types, constants and, with their namespace before them,
functions that a header of the project declares must come with that header, one that it includes, or one that those
include. A declaration in advance (class Recording;) will do; a macro counts as a name. For names of the standard
library, of Eigen, fmt and nlohmann, one of the headers that have them must be among the includes found so.

Prints each name that is missing and exits with 1 when there is one.
"""
import functools
import pathlib
import re
import sys

import headers

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.M)
TYPE = re.compile(r"^(?:template <[^\n]*>\s*)?(?:class|struct|enum(?: class)?|union) (?:\[\[\w+\]\] )?(\w+)\b(?!::)", re.M)
ALIAS = re.compile(r"^(?:template <[^\n]*>\s*)?using (\w+)\s*=", re.M)
CONSTANT = re.compile(r"^(?:inline |extern |static )*(?:constexpr|const) [^;=(]*?\b(k[A-Z]\w*)\b", re.M)
FUNCTION = re.compile(r"^(?!using|return|namespace|#)[A-Za-z_][\w:<>,&*\[\] \n]*?[ &*>](\w+)\(", re.M)
MACRO = re.compile(r"^\s*#\s*define (\w+)", re.M)
NAMESPACE = re.compile(r"^namespace ([\w:]+) \{", re.M)
MEMBERS = re.compile(r"\b(?:class|struct|enum(?: class)?|using|typename|concept) (\w+)|\b([A-Z]\w*)\(|\b(k[A-Z]\w*)\b\s*(?:=|,|\})")

# Names of others -> the headers of which one must come with them; <string> of libstdc++ has the integers too.
OTHERS = {
    r"std::(?:vector)\b": "vector", r"std::(?:map|multimap)\b": "map", r"std::(?:set|multiset)\b": "set",
    r"std::(?:string|to_string)\b": "string", r"std::string_view\b": "string_view string",
    r"std::(?:optional|nullopt)\b": "optional", r"std::variant\b": "variant", r"std::array\b": "array",
    r"std::function\b": "functional", r"std::filesystem\b": "filesystem", r"std::span\b": "span",
    r"std::(?:unique_ptr|shared_ptr|weak_ptr|make_unique|make_shared)\b": "memory", r"std::thread\b": "thread",
    r"std::(?:mutex|lock_guard|scoped_lock|unique_lock)\b": "mutex", r"std::atomic\b": "atomic",
    r"std::chrono\b": "chrono", r"std::deque\b": "deque", r"std::unordered_map\b": "unordered_map",
    r"std::u?int\d+_t\b": "cstdint string", r"std::(?:ofstream|ifstream)\b": "fstream", r"std::numeric_limits\b": "limits",
    r"\bEigen::": "Eigen/", r"\bfmt::": "fmt/", r"\bnlohmann::": "nlohmann/",
}


class House:
    """The headers of a tree: what each declares, includes and uses."""

    def __init__(self, root):
        self.root = root
        self.names = headers.all_of(root)
        self.code = {}
        for name in self.names:
            text = re.sub(r'#include\s*"', '#include "', (root / name).read_text())
            self.code[name] = headers.code(text).replace("\\\n", " ")
        self.declared = {}  # namespace -> name -> headers that declare it
        for name in self.names:
            for where, declared in declarations(self.code[name], names_of):
                self.declared.setdefault(where, {}).setdefault(declared, set()).add(name)
        self.types = {}  # the same without functions
        for name in self.names:
            for where, declared in declarations(self.code[name], types_of):
                self.types.setdefault(where, {}).setdefault(declared, set()).add(name)

    @functools.cache
    def reached(self, name):
        """All headers of the project that come with one, and the others' that they include."""
        inside, outside, open_ = set(), set(), [name]
        while open_:
            header = open_.pop()
            if header in inside:
                continue
            inside.add(header)
            for target in INCLUDE.findall(self.code[header]):
                beside = f"{header.split('/')[0]}/{target}"
                found = next((each for each in (target, beside) if each in self.code), None)
                if found:
                    open_.append(found)
                else:
                    outside.add(target)
        return inside, outside

    def missing(self, name):
        """Yields each name that a header uses and does not bring."""
        inside, outside = self.reached(name)
        code = re.sub(r'"(?:[^"\\\n]|\\.)*"|^\s*#.*$', "", self.code[name], flags=re.M)
        own = {each for match in MEMBERS.findall(code) for each in match if each}
        spaces = [where for where in dict.fromkeys(NAMESPACE.findall(code))]
        at_hand = {"abbe"} | {"::".join(space.split("::")[:depth]) for space in spaces
                              for depth in range(1, len(space.split("::")) + 1)}
        for space, word in sorted(set(re.findall(r"(?<![\w:])((?:\w+::)+)(\w+)\b", code))):
            space = space[:-2].removeprefix("abbe::")
            declaring = self.declared.get("abbe::" + space, {}).get(word, set())
            if declaring and not declaring & inside:
                yield f"{space}::{word}", sorted(declaring)
        for word in sorted(set(re.findall(r"(?<![\w:.])[A-Zk]\w+\b(?!\()", code)) - own):
            for where in at_hand:
                declaring = self.types.get(where, {}).get(word, set())
                if declaring and not declaring & inside:
                    yield word, sorted(declaring)
        for pattern, wanted in OTHERS.items():
            if re.search(pattern, code) and not any(
                    target == one or (one.endswith("/") and target.startswith(one))
                    for target in outside for one in wanted.split()):
                yield re.search(pattern, code)[0], [f"<{one}>" for one in wanted.split()]


def types_of(code):
    return [*TYPE.findall(code), *ALIAS.findall(code), *CONSTANT.findall(code), *MACRO.findall(code)]


def names_of(code):
    return [*types_of(code), *FUNCTION.findall(code)]


def declarations(code, names):
    """Yields (namespace, name) of what a header declares at the scope of a namespace."""
    parts = re.split(NAMESPACE, code)
    for where, part in zip(["", *parts[1::2]], parts[::2]):
        for name in names(part):
            yield where, name


def complaints(root):
    """Yields a line for each name that a header lacks."""
    house = House(root)
    for header in house.names:
        for name, declaring in house.missing(header):
            yield f"{header}: uses {name} and includes none of {', '.join(declaring)}"


if __name__ == "__main__":
    found = list(complaints(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "each header brings the names that it uses")
    sys.exit(1 if found else 0)
