#!/usr/bin/env python3
"""Holds every include of the project against the arrows that the architecture allows, and every source
but those of a transport against its name.

    arrows.py SOURCE_FOLDER

A header that a folder's CMakeLists.txt names INTERNAL is for that folder alone.

Prints each include or name that is not allowed and exits with 1 when there is one.
"""
import pathlib
import re
import sys

# folder -> the folders it may include. Arrows point one way: from a line to the names in it.
ARROWS = {
    "failure": "",
    "random": "",
    "geometry": "failure",
    "estimation": "failure random",
    "standards": "failure",
    "settings": "failure",
    "recording": "failure settings",
    "hal": "failure settings recording",
    "machine": "failure settings geometry estimation",
    "control": "",
    "map": "control failure standards settings recording geometry estimation machine",
    "compensation": "failure random standards settings geometry estimation machine map",
    "probes": "failure random settings recording geometry estimation standards machine",
    "paths": "failure random settings recording geometry standards machine",
    "relm": "failure random settings recording geometry estimation machine",
    "simulation": "failure random settings recording geometry estimation machine probes paths relm",
    "fusion": "failure settings recording geometry estimation standards machine map probes paths relm simulation",
    "certificate": "failure standards settings recording estimation machine map relm fusion",
    "diagnosis": "failure standards settings recording estimation machine probes relm simulation fusion",
    "learned": "failure random settings recording standards estimation simulation diagnosis",
    "investigate": "failure random settings recording machine simulation diagnosis",
    "history": "failure standards settings recording",
    "track": "failure settings recording standards estimation machine map simulation fusion history",
    "fleet": "failure standards machine map fusion",
    "report": "failure",
    "live": "failure recording report",
    "rig": "failure random settings recording hal",
    "study": "failure random settings recording hal estimation machine probes paths relm simulation fusion diagnosis rig",
    "apps": "failure random settings recording geometry estimation standards hal machine map compensation probes paths relm simulation fusion certificate diagnosis learned investigate history track fleet report live rig study",
    "python": "failure settings recording estimation machine map compensation probes paths relm simulation fusion diagnosis learned fleet apps",
}

# header of a library or of a transport -> the files that may include it; everybody else goes through them.
GATES = {
    "hal/modbus/": r"hal/(modbus/.*|transports\.cpp)|rig/register_server\..*",
    "hal/can/": r"hal/(can/.*|transports\.cpp)|rig/encoder_.*|apps/convert\.cpp",
    "modbus.h": r"hal/modbus/.*",
    "modbus/modbus.h": r"hal/modbus/.*",
    "linux/can.h": r"hal/can/can_socket.*",
    "hdf5.h": r"(recording|map)/hdf5_.*",
    "ceres/": r"estimation/.*",
    "Random123/": r"random/.*",
    "toml++/": r"(settings|recording)/.*\.cpp",
    "soci/": r"history/database\.cpp",
    "openssl/": r"recording/file_hash\.cpp",
    "libxml/": r"certificate/xml\.cpp",
    "boost/math/distributions/": r"standards/.*|study/rate\.cpp",
    "mpi.h": r"study/ranks_mpi\.cpp",
    "httplib.h": r"live/page_server\.cpp",
}

TRANSPORT = re.compile(r'\{"([\w-]+)", Read\w+\}')  # a line of hal/transports.cpp
INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^">]+)[">]', re.M)


def sources(root, folder):
    """Yields the name and the text of each source of a folder."""
    for file in sorted((root / folder).glob("**/*")):
        if file.suffix in (".h", ".cpp") and "node_modules" not in file.parts:
            yield file.relative_to(root).as_posix(), file.read_text()


def broken_arrows(root):
    """Yields one line for each include below `root` that the architecture forbids."""
    root = pathlib.Path(root)
    for folder, allowed in ARROWS.items():
        reachable = set(allowed.split()) | {folder}
        for name, text in sources(root, folder):
            for header in INCLUDE.findall(text):
                target = header.split("/")[0]
                if target in ARROWS and "/" in header and target not in reachable:
                    yield f'{name}: includes "{header}", but {folder} may not use {target}'
                for gate, may in GATES.items():
                    is_gated = header.startswith(gate) if gate.endswith("/") else header == gate
                    if is_gated and not re.fullmatch(may, name):
                        yield f"{name}: includes <{header}>, which only {may} may"


def named_transports(root):
    """Yields a line for each source outside of the transports' folders that knows one by its name."""
    root = pathlib.Path(root)
    registry = "hal/transports.cpp"
    names = TRANSPORT.findall((root / registry).read_text())
    for folder in ARROWS:
        for name, text in sources(root, folder):
            if name != registry and not re.match("hal/[a-z]+/", name):
                yield from (f'{name}: names the transport "{one}"' for one in names if f'"{one}"' in text)


def internal(root):
    """The headers that the folders keep to themselves, as "folder/file.h"."""
    for folder in ARROWS:
        lists = root / folder / "CMakeLists.txt"
        for names in re.findall(r"INTERNAL((?:\s+[\w/]+\.h)+)", lists.read_text() if lists.exists() else ""):
            yield from (f"{folder}/{name}" for name in names.split())


def open_doors(root):
    """Yields a line for each include of an internal header by another folder or by a header that is installed."""
    root = pathlib.Path(root)
    kept = set(internal(root))
    for folder in ARROWS:
        for name, text in sources(root, folder):
            if name in kept or re.fullmatch(GATES["hdf5.h"], name):  # those share how HDF5 is read
                continue
            for header in sorted(kept & set(INCLUDE.findall(text))):
                if name.endswith(".h") or not header.startswith(folder + "/"):
                    yield f"{name}: includes {header}, which is INTERNAL"


def strangers(root):
    """Yields a line for each folder with sources that has no line in ARROWS."""
    outside = {"tests", "bench", "build", "cmake", "fuzz", "out"}
    for folder in sorted(pathlib.Path(root).iterdir()):
        if folder.is_dir() and folder.name not in outside and not folder.name.startswith("."):
            if folder.name not in ARROWS and any(folder.glob("*.h")):
                yield f"{folder.name}: has no line in ARROWS"


if __name__ == "__main__":
    found = [*broken_arrows(sys.argv[1]), *named_transports(sys.argv[1]), *open_doors(sys.argv[1]), *strangers(sys.argv[1])]
    print("\n".join(found) or "every include follows the arrows")
    sys.exit(1 if found else 0)
